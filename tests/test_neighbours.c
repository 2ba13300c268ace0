/* Two buildings that pound: closed forms of two single masses, floors by number, what is refused. */
#include "evaluate/consequences.h"
#include "program.h"
#include "scene/neighbour.h"
#include "one_scene.h"

/* A building with a neighbour on its right, both undamped, read from the place. */
static SceneOptions pair_of(const char *building, const char *neighbour, Engine engine)
{
    SceneOptions o = scene_defaults();
    stand_beside(&o, in_place(building), in_place(neighbour));
    o.sim.engine = engine;
    o.sim.accuracy = ACCURACY_FINE;
    o.sim.forces = FORCES_YES;
    return o;
}

/* A constant force F on the first mass of frequency w from rest: at u = F / k it has the speed v = w F / k and meets the
 * other, at rest. One impact of restitution e gives the impulse m v (1 + e), takes m v^2 (1 - e^2) / 2, m = m1 m2 /
 * (m1 + m2), and leaves the other v (1 + e) m1 / (m1 + m2), its amplitude over its frequency (S. A. Anagnostopoulos,
 * Earthquake Engng. Struct. Dyn. 16 (1988) 443). */
TEST(two_single_masses_exchange_the_momentum_of_one_impact)
{
    const double m1 = 2e5, m2 = 3e5, k1 = 2e6, k2 = 1e6, force = 1e5, e = 0.65;
    const double w1 = sqrt(k1 / m1), w2 = sqrt(k2 / m2), rest = force / k1, v = w1 * rest, m = m1 * m2 / (m1 + m2);
    double accel[401] = {0}, f[401];
    for (int i = 0; i < 401; i++)
        f[i] = force;
    const Motion motion = {.accel = accel, .force = f, .n_force = 1, .n = 401, .dt_s = 0.01};
    write_storeys_in_place("one", "4,2e5,2e6\n");
    write_storeys_in_place("other", "4,3e5,1e6\n");
    for (Engine engine = 0; engine < ENGINE_COUNT; engine++) {
        SceneOptions o = pair_of("one", "other", engine);
        o.contact.law = LAW_EXACT;
        o.contact.restitution = e;
        o.sim.duration_s = 0.5 * M_PI / w1 + 0.5 * M_PI / w2 + 0.05; /* until the other is at its turn */
        const SimResult r = simulate(&o, SCENE_IMPACT, &motion, &rest);
        assert_int_equal(r.impacts, 1);
        assert_close(r.forces.contact_impulse_ns[0][0], m * v * (1 + e), 3e-3);
        assert_close(r.contact_loss_j, 0.5 * m * v * v * (1 - e * e), 3e-3);
        assert_close(r.forces.core_top_m, v * (1 + e) * m1 / (m1 + m2) / w2, 5e-3);
        assert_close(r.forces.core_base_shear_n, k2 * v * (1 + e) * m1 / (m1 + m2) / w2, 5e-3);
        assert_close(r.mcore_kg, m2, 1e-12);
        assert_true(!r.forces.stress_known);
    }
}

TEST(joined_and_alone_the_masses_have_their_closed_forms)
{
    Scene *scene;
    SceneModes modes;
    double gap = 0.1;
    write_storeys_in_place("one", "4,2e5,2e6\n");
    write_storeys_in_place("other", "4.2,3e5,1e6\n"); /* 0.2 m higher: within the thickness of a slab */
    const SceneOptions o = pair_of("one", "other", ENGINE_FAST);
    CHECK_OK(scene_create(&scene, &o, NULL, &err), &err);
    assert_int_equal(scene_design(scene)->n_var, 1);
    CHECK_OK(scene_frequencies(scene, &gap, &modes, &err), &err);
    assert_close(modes.building_hz[0], sqrt(2e6 / 2e5) / (2 * M_PI), 1e-9);
    assert_close(modes.core_hz[0], sqrt(1e6 / 3e5) / (2 * M_PI), 1e-9);
    assert_close(modes.joined_hz[0], sqrt(3e6 / 5e5) / (2 * M_PI), 1e-9);
    assert_close(modes.core_mass_kg, 3e5, 1e-12);
    scene_free(scene);
}

TEST(three_floors_meet_three_floors_and_none_above_a_lower_neighbour)
{
    const double x[] = {0.004, 0.009, 0.012};
    OWNED(motion_free) Motion motion = motion_of("builtin:elcentro-like", 0, 1);
    write_storeys_in_place("three", "4,2e5,2e8\n3.5,2e5,1.6e8\n3.5,1.5e5,1.1e8\n");
    write_storeys_in_place("stiff", "4,2.2e5,9e8\n3.5,2.1e5,7e8\n3.5,1.6e5,5e8\n");
    write_storeys_in_place("low", "4,2.2e5,9e8\n");
    for (int i = 0; i < 2; i++) {
        SceneOptions o = pair_of("three", i ? "low" : "stiff", ENGINE_FAST);
        o.building.damping = LIST_OF(0.05);
        o.core.damping = 0.05;
        o.sim.duration_s = 6;
        const SimResult fast = simulate(&o, SCENE_IMPACT, &motion, x), bare = simulate(&o, SCENE_NO_CORE, &motion, x);
        assert_less(0, fast.closings[0]);
        assert_true((fast.closings[2] > 0) == (i == 0));
        assert_true(fast.forces.contacts[1][0] == 0);                  /* nothing stands on the left */
        const SimResult links = simulate(&o, SCENE_LINKS, &motion, x); /* dashpots of nothing */
        assert_close(links.j1_m, bare.j1_m, 1e-3);
        assert_less(simulate(&o, SCENE_RIGID, &motion, x).energy_balance_error, 1e-6);
        o.sim.engine = ENGINE_CVODE;
        const SimResult cvode = simulate(&o, SCENE_IMPACT, &motion, x);
        assert_int_equal(cvode.impacts, fast.impacts);
        assert_close(fast.j1_m, cvode.j1_m, 1e-4);
        assert_close_in(fast, cvode, 2e-3, j3_g, edcs_pct);
        assert_close(fast.forces.core_base_shear_n, cvode.forces.core_base_shear_n, 1e-2); /* as points are spaced */
    }
}

/* The same two with exchanged roles: what one says of itself the other says of its neighbour. */
TEST(either_building_says_the_same_of_the_other)
{
    const double x[] = {0.004, 0.009, 0.012};
    OWNED(motion_free) Motion motion = motion_of("builtin:elcentro-like", 0, 1);
    for (int i = 0; i < 2 * ENGINE_COUNT; i++) {
        const SceneKind kind = i % 2 ? SCENE_RIGID : SCENE_IMPACT;
        SimResult r[2];
        for (int exchanged = 0; exchanged < 2; exchanged++) {
            SceneOptions o = pair_of(exchanged ? "stiff" : "three", exchanged ? "three" : "stiff", (Engine)(i / 2));
            o.building.damping = LIST_OF(0.05);
            o.core.damping = 0.05;
            o.design.gap_sides = exchanged ? GAPS_LEFT : GAPS_RIGHT;
            o.sim.duration_s = 4;
            o.sim.filtered = 1;
            r[exchanged] = simulate(&o, kind, &motion, x);
        }
        const double least = i / 2 == ENGINE_FAST ? 1e-9 : 1e-5;
        for (int k = 0; k < 2; k++) {
            const SimResult *own = &r[k];
            const FloorPeaks *seen = &r[1 - k].neighbour;
            assert_int_equal(seen->n, 3);
            assert_close_in(*seen, *own, least, j1_m, j2_m);
            assert_close(seen->j3_g, own->j3_g, kind == SCENE_IMPACT ? 100 * least : least);
            assert_close_in(*seen, *own, least, j3_filtered_g, drift_ratio_max);
            assert_close(damage_loss_of_neighbour(&r[1 - k]), damage_loss(own), 100 * least);
            assert_close(r[1 - k].forces.core_base_shear_n, own->forces.building_base_shear_n, 1e-2);
            for (int j = 0; j < 3; j++)
                assert_close(seen->drift_m[j], own->peak_drift_m[j], least);
        }
        assert_int_equal(r[0].impacts, r[1].impacts);
        assert_close(r[0].input_energy_j, r[1].input_energy_j, least);
        assert_close(r[0].edcs_pct + r[1].edcs_pct,
                     100 * (r[0].damped_core_j + r[0].damped_building_j) / r[0].input_energy_j, least);
    }
}

TEST(a_neighbour_out_of_reach_is_not_felt)
{
    const double far[] = {5, 5, 5};
    OWNED(motion_free) Motion motion = motion_of("builtin:elcentro-like", 0, 1);
    const SceneOptions o = pair_of("three", "stiff", ENGINE_FAST);
    const SimResult apart = simulate(&o, SCENE_IMPACT, &motion, far), alone = simulate(&o, SCENE_NO_CORE, &motion, far);
    assert_close(apart.j1_m, alone.j1_m, 1e-6);
    assert_close(apart.j3_g, alone.j3_g, 1e-5);
}

#define CHECK_PAIR "check configs/quick.ini --set building.model=@/three --set core.model=@/"

TEST(a_neighbour_that_does_not_fit_is_refused_in_words)
{
    write_storeys_in_place("tall", "4,2e5,2e8\n3.5,2e5,1.6e8\n3.5,1.5e5,1.1e8\n3.5,1.5e5,1.1e8\n");
    write_storeys_in_place("shifted", "4,2e5,2e8\n4.2,2e5,1.6e8\n");
    expect(65, "has 4 floors, the building 3: make the taller one building.model", CHECK_PAIR "tall");
    expect(65, "is at 8.2 m, that of the building at 7.5 m; floors that meet are at one height within 0.3 m",
           CHECK_PAIR "shifted");
    expect(65, "core.foundation: is that of a cantilever", CHECK_PAIR "stiff --set 'core.foundation=soil=C radius=10'");
    expect(65, "design.variables: side is that of core.section = box",
           CHECK_PAIR "stiff --set design.variables=gaps,thickness,side");
}

TEST(the_example_of_neighbours_is_searched_by_its_gaps_alone)
{
    free(output_of("optimize configs/neighbours.ini --out @/run --threads 2 --max-evals 24 --set search.initial=12 "
                   "--set search.population=12 --set search.polish=0"));
    FREED char *front = read_in_place("run/front.csv");
    static const char HEADER[] = "id,gap_right_01_m,gap_right_02_m,gap_right_03_m,gap_right_04_m,gap_right_05_m,"
                                 "gap_right_06_m,j1_m,j2_m,j3_g";
    assert_int_equal(strncmp(front, HEADER, sizeof HEADER - 1), 0);
    free(output_of("report @/run"));
    free(output_of("building configs/neighbours.ini --json"));
    free(output_of("evaluate @/run --design knee"));
}

SUITE(make_place, clear_place)
