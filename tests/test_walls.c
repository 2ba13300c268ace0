/* Walls of the core beyond their buckling stress (scene/wall.h): limits in closed form, the section summed strip by
 * strip, and simulations whose stiffness and stress agree. */
#include "scene/core_beam.h"
#include "scene/wall.h"
#include "scene_options.h"

enum { N = 20 };

static CoreOptions box(double stiffeners)
{
    CoreOptions o = scene_defaults().core;
    o.stiffeners = stiffeners;
    return o;
}

static double bare(const CoreOptions *o, double t)
{
    const double b = o->width_m - 2 * t;
    return 4 * M_PI * M_PI * o->youngs_modulus_pa / (12 * (1 - o->poisson * o->poisson)) * t * t / (b * b);
}

TEST(without_stiffeners_the_plate_buckles_as_a_long_one_between_hinges)
{
    const CoreOptions o = box(0);
    for (double t = 0.004; t < 0.04; t *= 2)
        assert_close(wall_buckling_pa(&o, t, 4), bare(&o, t), 1e-12);
}

/* Floors close together leave the panels between bars, of which there may be 200; floors far apart the bare wall. */
TEST(stiffeners_raise_the_buckling_stress_between_two_limits)
{
    double before = 0;
    for (double share = 0; share < 1; share += 0.1) {
        const CoreOptions o = box(share);
        const double is = wall_buckling_pa(&o, 0.015, 4);
        assert_less(before, is);
        assert_less(wall_buckling_pa(&o, 0.015, 5), is * (1 + 1e-12));
        before = is;
    }
    const CoreOptions o = box(0.3);
    assert_close(wall_buckling_pa(&o, 0.015, 1e-3), 201 * 201 * bare(&o, 0.015), 1e-9);
    assert_close(wall_buckling_pa(&o, 0.015, 1e4), bare(&o, 0.015), 1e-12);
    assert_less(100 * bare(&o, 0.015), wall_buckling_pa(&o, 0.015, 4));
}

/* EN 1993-1-5, table 4.1 and 4.4: the tube in strips, those that have buckled left out. */
static void in_strips(double stress, double critical, double *share, double *raised)
{
    enum { STRIPS = 200000 };
    const double l = sqrt(stress / critical), rho = l > 0.673 ? (l - 0.22) / (l * l) : 1;
    const double axis = (rho + 1) / (rho + 3), under = 1 - axis, psi = -axis / under; /* webs whole */
    const double k = 7.81 - 6.29 * psi + 9.78 * psi * psi, lw = l * sqrt(4 / k);
    const double web = 0.055 * (3 + psi), whole = 0.5 * (1 + sqrt(1 - 4 * web)); /* where rho is 1 */
    const double width = under * (lw > whole ? (lw - web) / (lw * lw) : 1);
    double area = 0, moment = 0, inertia = 0;
    for (int pass = 0; pass < 2; pass++) {
        const double centre = pass ? moment / area : 0;
        area = pass ? area : rho + 1;
        moment = pass ? moment : rho;
        inertia = rho * (1 - centre) * (1 - centre) + centre * centre;
        for (int i = 0; i < STRIPS; i++) {
            const double y = (i + 0.5) / STRIPS;
            if (y > axis + 0.6 * width && y < 1 - 0.4 * width)
                continue;
            area += pass ? 0 : 2.0 / STRIPS;
            moment += pass ? 0 : 2 * y / STRIPS;
            inertia += 2 * (y - centre) * (y - centre) / STRIPS;
        }
    }
    *share = inertia * 1.5;
    *raised = (1 - moment / area) * 2 / *share;
}

TEST(what_is_left_of_a_section_is_the_sum_of_its_strips_at_the_stress_that_it_has)
{
    for (double gross = 0.1; gross < 300; gross *= 1.7) {
        const WallState w = wall_effective(gross * 1e6, 1e6);
        double share, raised;
        in_strips(w.stress, 1e6, &share, &raised);
        assert_close(w.share, share, 1e-4);
        assert_close(w.stress, gross * 1e6 * raised, 1e-4);
    }
    for (double l = 0.01; l < 0.673; l += 0.1) { /* EN 1993-1-5, 4.4(2): up to there a plate is whole */
        const WallState w = wall_effective(l * l * 1e6, 1e6);
        assert_close(w.share, 1, 1e-14);
        assert_close(w.stress, l * l * 1e6, 1e-14);
    }
}

static SimResult simulated(SceneOptions *o, SceneKind kind, Engine engine)
{
    SimResult r;
    double x[N + 2];
    for (int j = 0; j < N; j++)
        x[j] = 0.006 * (j + 1);
    x[N] = 0.03;
    x[N + 1] = 0.0216;
    o->sim.duration_s = o->sim.duration_s > 0 ? o->sim.duration_s : 8;
    o->sim.engine = engine;
    OWNED(motion_free) Motion motion = motion_of("builtin:sylmar-like", 0.3, 1);
    OWNED(one_scene_free) OneScene stage = one_scene_of(o, &motion);
    for (int again = engine == ENGINE_FAST ? 0 : 1; again < 2; again++) /* what a run was before does not matter */
        CHECK_OK(sim_run(stage.worker, kind, x, &r, &err), &err);
    assert_ran(&r);
    return r;
}

/* The shares that it ends with, as a core that has them from the start. */
TEST(walls_that_buckle_bend_as_the_stress_of_their_own_simulation_leaves_them)
{
    for (SceneKind kind = SCENE_IMPACT; kind <= SCENE_RIGID; kind += SCENE_RIGID) {
        SceneOptions s = paper_scene();
        s.sim.forces = FORCES_YES;
        const SimResult full = simulated(&s, kind, ENGINE_FAST);
        s.core.wall = WALL_EFFECTIVE;
        const SimResult left = simulated(&s, kind, ENGINE_FAST);
        const SimResult other =
            kind == SCENE_RIGID ? simulated(&s, kind, ENGINE_CVODE) : left; /* minutes with impacts */
        s.core.stiffeners = 0.4;
        const SimResult stiffened = simulated(&s, kind, ENGINE_FAST);
        print_message("scene %d: J1 %.4g m, left %.4g m, stiffened %.4g m; share at the base %.3g, %.3g\n", kind,
                      full.j1_m, left.j1_m, stiffened.j1_m, left.forces.core_wall_share[0],
                      stiffened.forces.core_wall_share[0]);
        assert_less(left.forces.core_wall_share_off, 0.01);
        assert_less(left.forces.core_wall_share[0], 0.4);
        assert_less(left.forces.core_wall_share[0], left.forces.core_wall_share[N - 1]);
        assert_less(1.5 * left.forces.core_wall_share[0], stiffened.forces.core_wall_share[0]);
        assert_close(other.j1_m, left.j1_m, 1e-2);
        assert_close(other.forces.core_wall_share[0], left.forces.core_wall_share[0], 2e-2);
        assert_close(stiffened.mcore_kg, 1.4 * full.mcore_kg, 1e-12);
        s.core.stiffeners = 0;
        s.core.wall = WALL_FULL;
        for (int j = 0; j < N; j++)
            s.core.wall_share[j] = left.forces.core_wall_share[j];
        assert_close(simulated(&s, kind, ENGINE_FAST).j1_m, left.j1_m, 1e-2);
    }
}

/* Contacts go on long beyond the strong part, which ends at 18.5 s. */
TEST(walls_that_settle_on_the_strong_part_of_a_motion_are_those_of_all_of_it)
{
    SceneOptions s = paper_scene();
    s.sim.forces = FORCES_YES;
    s.core.wall = WALL_EFFECTIVE;
    s.building.yield_drift = 0.003;
    s.building.damping.at[0] = 0.015;
    s.sim.duration_s = 60;
    SceneOptions brief = s;
    brief.sim.duration_s = 18.47;
    const SimResult whole = simulated(&s, SCENE_IMPACT, ENGINE_FAST),
                    strong = simulated(&brief, SCENE_IMPACT, ENGINE_FAST);
    assert_true(whole.settled_s > 37 && whole.forces.core_wall_share_off < 0.01);
    for (int j = 0; j < N; j++)
        assert_same_number(whole.forces.core_wall_share[j], strong.forces.core_wall_share[j]);
}

/* A beam of half the modulus bends and shears by twice as much; a share of 1 changes nothing. */
TEST(a_share_of_the_stiffness_is_a_smaller_modulus_and_1_is_none)
{
    SceneOptions s = paper_scene(), soft = paper_scene();
    s.sim.forces = soft.sim.forces = FORCES_YES;
    const SimResult full = simulated(&s, SCENE_IMPACT, ENGINE_FAST);
    s.core.wall_factor = 1;
    const SimResult one = simulated(&s, SCENE_IMPACT, ENGINE_FAST);
    assert_same_number(full.j1_m, one.j1_m);
    assert_same_number(full.j3_g, one.j3_g);
    assert_same_number(full.forces.core_stress_pa, one.forces.core_stress_pa);
    s.core.wall_factor = 0.5;
    soft.core.youngs_modulus_pa *= 0.5;
    const SimResult half = simulated(&s, SCENE_IMPACT, ENGINE_FAST),
                    other = simulated(&soft, SCENE_IMPACT, ENGINE_FAST);
    assert_close(half.j1_m, other.j1_m, 1e-9);
    assert_close(half.forces.core_stress_pa, 2 * other.forces.core_stress_pa, 1e-6);
    assert_same_number(half.mcore_kg, full.mcore_kg);
}

SUITE(NULL, NULL)
