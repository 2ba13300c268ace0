/* Contacts off the centre of the floors: closed forms, two roads to each number, both engines, the limit of none. */
#include "program.h"
#include "one_scene.h"
#include "scene/torsion.h"
#include "sim/samples.h"

/* Of the plan b = 1.2 l: e/r and b/2r of contacts that are so many l off the centre. */
static const double ASPECT = 1.2, SHARE = 0.05;
static double gyration(void)
{
    return sqrt((1 + ASPECT * ASPECT) / 12);
}

/* Three storeys of mass and stiffness over `less`, contacts off the centre. */
static SceneOptions three_floors(const char *name, double less, double share)
{
    write_storeys_in_place(name, brief("4,%.17g,%.17g\n3.5,%.17g,%.17g\n3.5,%.17g,%.17g\n", 2e5 / less, 2e8 / less,
                                       2e5 / less, 1.6e8 / less, 1.5e5 / less, 1.1e8 / less));
    SceneOptions o = scene_defaults();
    snprintf(o.building.model, sizeof o.building.model, "%s", there(name));
    o.contact.eccentricity = LIST_OF(share);
    o.core.width_m = 3;
    o.sim.accuracy = ACCURACY_FINE;
    o.sim.forces = FORCES_YES;
    o.sim.duration_s = 5;
    return o;
}

static const double X[] = {0.004, 0.009, 0.012, 0.01, 0.006};

/* A constant force on a mass from rest; at its new place of rest it meets a neighbour with speed v, off the centre: the
 * impact has the mass 1 / ((1 + (e/r)^2) / m1 + 1 / m2). It turns the floor at r theta' = -J e / (m1 r), so that the far
 * edge, at b/2r, goes on with v - J (1 - e b / 2 r^2) / m1. */
TEST(an_impact_off_the_centre_has_the_effective_mass_of_a_free_body)
{
    const double m1 = 2e5, m2 = 3e5, k1 = 2e6, force = 1e5, rebound = 0.65, share = 0.3;
    const double w1 = sqrt(k1 / m1), rest = force / k1, v = w1 * rest, arm = share / gyration();
    const double edge = 0.5 * ASPECT / gyration(), m = 1 / ((1 + arm * arm) / m1 + 1 / m2);
    const double impulse = m * v * (1 + rebound), far = v - impulse * (1 - arm * edge) / m1;
    double accel[401] = {0}, f[401];
    for (int i = 0; i < 401; i++)
        f[i] = force;
    const Motion motion = {.accel = accel, .force = f, .n_force = 1, .n = 401, .dt_s = 0.01};
    write_storeys_in_place("one", "4,2e5,2e6\n");
    write_storeys_in_place("other", "4,3e5,1e6\n");
    for (Engine engine = 0; engine < ENGINE_COUNT; engine++) {
        SceneOptions o = three_floors("three", 1, share);
        stand_beside(&o, in_place("one"), in_place("other"));
        o.contact.law = LAW_EXACT;
        o.contact.restitution = rebound;
        o.sim.engine = engine;
        o.sim.duration_s = 0.5 * M_PI / w1 + 0.5 * M_PI / sqrt(1e6 / m2) + 0.05; /* until both are at their turns */
        const SimResult r = simulate(&o, SCENE_IMPACT, &motion, &rest);
        assert_int_equal(r.impacts, 1);
        assert_close(r.forces.contact_impulse_ns[0][0], impulse, 3e-3);
        assert_close(r.contact_loss_j, 0.5 * m * v * v * (1 - rebound * rebound), 3e-3);
        assert_close(r.j1_m, rest + far / w1, 3e-3);
        assert_close(r.neighbour.j1_m, impulse / m2 / sqrt(1e6 / m2), 5e-3);
        assert_less(r.energy_balance_error, 1e-6);
    }
}

/* u + psi e/r is the motion of a building of mass and stiffness over 1 + (e/r)^2, psi - u e/r that of -e/r times the
 * building alone: what happens at the contacts is known from the one, what the edges do from both. */
TEST(contacts_and_edges_are_those_of_a_lighter_building_and_of_the_building_alone)
{
    const double arm = SHARE / gyration(), edge = 0.5 * ASPECT / gyration(), less = 1 + arm * arm;
    const Motion motion = motion_of("builtin:elcentro-like", 0, 1);
    for (int rigid = 0; rigid < 2; rigid++) {
        const SceneKind kind = rigid ? SCENE_RIGID : SCENE_IMPACT;
        const SceneOptions o = three_floors("three", 1, SHARE), lighter = three_floors("lighter", less, 0);
        const SimResult r = simulate(&o, kind, &motion, X), of = simulate(&lighter, kind, &motion, X);
        assert_int_equal(r.impacts, of.impacts);
        assert_close_in(r, of, 1e-6, forces.core_base_shear_n, forces.core_stress_pa);
        for (int j = 0; j < 3 && !rigid; j++) {
            assert_less(0, r.closings[j]);
            assert_close(r.forces.contact_force_n[0][j], of.forces.contact_force_n[0][j], 1e-6);
            assert_close(r.forces.contact_impulse_ns[1][j], of.forces.contact_impulse_ns[1][j], 1e-6);
        }

        Scene *scene;
        OWNED(track_free) Track at_contacts, alone;
        CHECK_OK(scene_create(&scene, &lighter, &motion, &err), &err);
        CHECK_OK(track_run(scene, kind, X, &(LinearDevice){0}, 2e-3, &at_contacts, &err), &err);
        CHECK_OK(track_run(scene, SCENE_NO_CORE, X, &(LinearDevice){0}, 2e-3, &alone, &err), &err);
        double j1 = 0, j2 = 0;
        for (size_t i = 0; i < at_contacts.n; i++)
            for (int side = -1; side <= 1; side += 2) {
                const double share = (1 + side * edge * arm) / less;
                double below = 0;
                for (size_t j = 0; j < 3; j++) {
                    const double u =
                        share * track_at(&at_contacts, i, 2 + j) + (1 - share) * track_at(&alone, i, 2 + j);
                    j1 = fmax(j1, fabs(u));
                    j2 = fmax(j2, fabs(u - below));
                    below = u;
                }
            }
        assert_close(r.j1_m, j1, 1e-3);
        assert_close(r.j2_m, j2, 1e-3);
        assert_less(1.02 * of.j1_m, r.j1_m); /* it does turn */
        scene_free(scene);
    }
    motion_free((Motion *)&motion);
}

/* With storeys that yield, links, bumpers, a neighbour, a force on a floor. */
TEST(both_engines_agree_on_floors_that_turn)
{
    OWNED(motion_free) Motion motion = motion_of("builtin:elcentro-like", 0, 1);
    for (int i = 0; i < 4; i++) {
        SimResult r[ENGINE_COUNT];
        for (Engine engine = 0; engine < ENGINE_COUNT; engine++) {
            SceneOptions o = three_floors("three", 1, SHARE);
            const double links[] = {0.004, 0.009, 0.012, 0.01, 0.006, 1e5, 2e5, 1e5};
            o.sim.engine = engine;
            o.building.yield_drift = i == 1 ? 0.002 : 0;
            if (i == 2)
                snprintf(o.design.variables, sizeof o.design.variables, "gaps, thickness, links");
            if (i == 3)
                snprintf(o.core.model, sizeof o.core.model, "%s", o.building.model);
            o.core.damping = 0.05;
            r[engine] = simulate(&o, SCENE_IMPACT, &motion, i == 2 ? links : X);
        }
        const SimResult *a = &r[ENGINE_FAST], *b = &r[ENGINE_CVODE];
        assert_int_equal(a->impacts, b->impacts);
        assert_close_in(*a, *b, 1e-4, j1_m, drift_ratio_max);
        assert_close(a->j3_g, b->j3_g, 2e-3);
        assert_close(a->ed1_pct, b->ed1_pct, 1e-3);
        if (i == 1)
            assert_close(a->ed_hysteresis_pct, b->ed_hysteresis_pct, 1e-3);
        if (i == 1)
            assert_close(a->residual_drift_ratio, b->residual_drift_ratio, 1e-2);
        assert_less(a->energy_balance_error, 1e-6);
    }
}

/* A design of configs/engineer.ini whose building stays linear, 5 % of 30.48 m off the centre, at the corner 18.29 m
 * away, as an independent integrator has it. */
TEST(the_tower_has_its_known_response_at_the_corner)
{
    SimResult r;
    Settings s;
    need_file(KOBE);
    CHECK_OK(known_settings(&s, " anchors=1e9", &err), &err);
    s.building.yield_drift = 0;
    s.contact.eccentricity = LIST_OF(SHARE);
    s.sim.duration_s = 80;
    s.sim.filtered = 1;
    const SceneOptions options = settings_scene(&s);
    CHECK_OK(run_under(&options, &s.motion, SCENE_IMPACT, KNOWN_DESIGN, NULL, &r, &err), &err);
    assert_close(r.j1_m, 1.08, 1e-2);
    assert_close(r.drift_ratio_max, 0.024, 1e-2);
    assert_close(r.j3_g, 1.7, 3e-2);
    assert_close(r.j3_filtered_g, 1.7, 3e-2);
}

TEST(contacts_at_the_centre_and_a_building_alone_do_not_turn)
{
    OWNED(motion_free) Motion motion = motion_of("builtin:elcentro-like", 0, 1);
    const SceneOptions o = three_floors("three", 1, 0), turns = three_floors("three", 1, SHARE);
    SceneOptions none = o;
    none.contact.eccentricity = LIST_OF(0, 3);
    SimResult a = simulate(&o, SCENE_IMPACT, &motion, X), b = simulate(&none, SCENE_IMPACT, &motion, X);
    a.seconds = b.seconds = 0;
    assert_memory_equal(&a, &b, sizeof a);
    a = simulate(&o, SCENE_NO_CORE, &motion, X);
    b = simulate(&turns, SCENE_NO_CORE, &motion, X);
    assert_close_in(a, b, 1e-9, j1_m, j3_g, ed1_pct);
}

TEST(a_contact_beyond_the_edge_is_refused)
{
    expect(65, "contact.eccentricity: 0.7 is more than 0.6, half of the side",
           "simulate configs/quick.ini --design none --set contact.eccentricity=0.7");
    expect(65, "contact.eccentricity: 3 numbers; give",
           "simulate configs/quick.ini --design none --set contact.eccentricity=0.05,1,1");
    expect(65, "contact.eccentricity: 0.3 is more than 0.25",
           "simulate configs/quick.ini --design none --set contact.eccentricity=0.3,0.5");
}

SUITE(make_place, clear_place)
