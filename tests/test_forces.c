/* Forces of a response (sim/force_monitor.h) against beam formulas, closed forms of an impact, conservation of momentum,
 * and the engine cvode. */
#include "scene_options.h"

#include "bench/stability/bob.h"
#include "evaluate/measures.h"
#include "sim/fast/fast.h"

enum { N = 20 };

/* ---- a static push ------------------------------------------------------------------------------------------- */

typedef struct {
    SceneOptions options;
    Building building;
    CoreBeam core;
    ForceMonitor *monitor;
    double x[N + 2], height;
} Frame;

static void frame_open(Frame *f, CoreSection section, double t_base, double t_top)
{
    *f = (Frame){.options = paper_scene()};
    f->options.core.section = section;
    CHECK_OK(building_load(&f->building, &f->options.building, &err), &err);
    f->x[N] = t_base;
    f->x[N + 1] = t_top;
    CHECK_OK(core_beam_make(&f->core, &f->options.core, N, f->building.storey_m, t_base, t_top, &err), &err);
    CHECK_OK(force_monitor_create(&f->monitor, N, N, &err), &err);
    force_monitor_set(f->monitor, &f->options, &f->building, &f->core, 0, f->x + N);
    for (int s = 0; s < N; s++)
        f->height += f->building.storey_m[s];
}

static void frame_close(Frame *f)
{
    force_monitor_free(f->monitor);
    building_free(&f->building);
}

/* Modal coordinates of the static answer to nodal forces F: q_i = phi_i' F / w_i^2, of the first `modes`. */
static void static_answer(const double phi[], const double omega[], const double F[], int modes, double q[])
{
    for (int i = 0; i < N; i++) {
        q[i] = 0;
        for (int j = 0; j < N && i < modes; j++)
            q[i] += phi[j * N + i] * F[j] / (omega[i] * omega[i]);
    }
}

/* The core under contact forces `push` (n), the building at rest; so many modes of the core are followed. */
static void push_core(Frame *f, const double push[], int modes, SimForces *out)
{
    double zero[N] = {0}, q[N], force[N];
    FloorSet in_contact = 0;
    static_answer(f->core.phi, f->core.omega, push, modes, q);
    for (int j = 0; j < N; j++) {
        force[j] = -push[j]; /* on the floor */
        in_contact |= (FloorSet)(push[j] != 0) << j;
    }
    force_monitor_start(f->monitor, modes, 1);
    force_monitor_point(
        f->monitor,
        &(ForcePoint){
            .t = 1, .building_q = zero, .building_v = zero, .core_q = q, .force = force, .in_contact = in_contact});
    force_monitor_report(f->monitor, 1, out);
}

TEST(a_push_at_the_top_makes_the_shear_moment_and_stress_of_a_cantilever)
{
    OWNED(frame_close) Frame f;
    SimForces r;
    const double P = 3e6, t = 0.02;
    double push[N] = {[N - 1] = P};
    frame_open(&f, CORE_BOX, t, t);
    push_core(&f, push, N, &r);
    const double B = f.options.core.width_m, b = B - 2 * t, I = (pow(B, 4) - pow(b, 4)) / 12;
    double z = 0;
    for (int s = 0; s < N; s++) {
        assert_close(r.core_shear_n[s], P, 1e-7);
        assert_close(r.core_moment_nm[s], P * (f.height - z), 1e-7);
        assert_close(r.core_storey_stress_pa[s], P * (f.height - z) * 0.5 * B / I, 1e-7);
        z += f.building.storey_m[s];
    }
    assert_close(r.core_base_shear_n, P, 1e-7);
    assert_close(r.core_overturning_nm, P * f.height, 1e-7);
    assert_close(r.base_shear_n, P, 1e-7);
    assert_close(r.overturning_nm, P * f.height, 1e-7);
    assert_close(r.core_stress_pa, P * f.height * 0.5 * B / I, 1e-7);
    assert_int_equal(r.core_stress_storey, 0);
    /* first moment of half the tube: flange B t (B - t)/2, two webs t b/2 * b/4 each */
    const double Q = B * t * 0.5 * (B - t) + 2 * t * 0.5 * b * 0.25 * b;
    assert_close(r.core_shear_stress_pa, P * Q / (2 * t * I), 1e-7);
    const double E = f.options.core.youngs_modulus_pa, nu = f.options.core.poisson;
    const double plate = 4 * M_PI * M_PI * E / (12 * (1 - nu * nu)) * t * t / (b * b);
    assert_close(r.core_buckling_pa[0], plate, 1e-12);
    assert_close(r.core_buckling_ratio, P * f.height * 0.5 * B / I / plate, 1e-7);
}

TEST(a_push_in_the_middle_leaves_the_storeys_above_it_alone)
{
    OWNED(frame_close) Frame f;
    SimForces r;
    double push[N] = {[7] = 2e6, [3] = -5e5}, z = 0, z_of[N + 1] = {0};
    frame_open(&f, CORE_PLATE, 0.5, 0.3);
    for (int s = 0; s < N; s++)
        z_of[s + 1] = z += f.building.storey_m[s];
    push_core(&f, push, N, &r);
    for (int s = 0; s < N; s++) {
        const double shear = s > 7 ? 0 : s > 3 ? 2e6 : 1.5e6;
        const double moment = (s > 7 ? 0 : 2e6 * (z_of[8] - z_of[s])) - (s > 3 ? 0 : 5e5 * (z_of[4] - z_of[s]));
        assert_less(fabs(r.core_shear_n[s] - shear), 1);
        assert_less(fabs(r.core_moment_nm[s] - moment), 10);
    }
    const double t = 0.5, width = f.options.core.width_m;
    assert_close(r.core_stress_pa, r.core_moment_nm[0] / (width * t * t / 6), 1e-9);
    assert_false(r.buckling_known);
}

TEST(modes_that_are_left_out_answer_a_static_push_in_full)
{
    OWNED(frame_close) Frame f;
    SimForces all, few;
    double push[N] = {[2] = 4e6, [11] = 1e6, [18] = -2e6};
    frame_open(&f, CORE_BOX, 0.012, 0.0064);
    push_core(&f, push, N, &all);
    push_core(&f, push, 8, &few);
    for (int s = 0; s < N; s++) {
        assert_less(fabs(few.core_shear_n[s] - all.core_shear_n[s]), 1e-6 * all.core_base_shear_n);
        assert_less(fabs(few.core_moment_nm[s] - all.core_moment_nm[s]), 1e-6 * all.core_overturning_nm);
    }
}

TEST(floors_pushed_by_their_own_weight_have_a_base_shear_of_one)
{
    OWNED(frame_close) Frame f;
    SimForces r;
    double F[N], q[N], zero[N] = {0}, moment = 0, z = 0;
    frame_open(&f, CORE_BOX, 0.012, 0.0064);
    force_monitor_set(f.monitor, &f.options, &f.building, NULL, 0, f.x + N);
    for (int j = 0; j < N; j++) {
        F[j] = 0;
        for (int i = 0; i < N; i++)
            F[j] += 9.81 * f.building.M[j * N + i];
        moment += F[j] * (z += f.building.storey_m[j]);
    }
    static_answer(f.building.phi, f.building.omega, F, N, q);
    force_monitor_start(f.monitor, 0, 1);
    force_monitor_point(
        f.monitor, &(ForcePoint){.t = 0.999, .building_q = zero, .building_v = zero, .force = zero}); /* hides no end */
    force_monitor_point(f.monitor, &(ForcePoint){.t = 1, .building_q = q, .building_v = zero, .force = zero});
    force_monitor_report(f.monitor, 1, &r);
    assert_close(r.base_shear_ratio, 1, 1e-9);
    assert_close(r.building_overturning_nm, moment, 1e-9);
    assert_true(isnan(r.core_base_shear_n) && isnan(r.core_stress_pa) && !r.stress_known);
}

TEST(a_peak_between_points_is_found_by_the_parabola)
{
    OWNED(frame_close) Frame f;
    SimForces r;
    double F[N] = {[N - 1] = 1e6}, q[N], now[N], zero[N] = {0};
    frame_open(&f, CORE_BOX, 0.012, 0.0064);
    static_answer(f.core.phi, f.core.omega, F, N, q);
    force_monitor_start(f.monitor, N, 4);
    for (int k = 0; k < 40; k++) { /* ten points a period: (w h)^4 / 400 = 4e-4, and the sine is no parabola */
        for (int i = 0; i < N; i++)
            now[i] = q[i] * sin(2 * M_PI * (k / 10.0 + 0.033));
        force_monitor_point(
            f.monitor,
            &(ForcePoint){.t = 0.1 * k, .building_q = zero, .building_v = zero, .core_q = now, .force = zero});
    }
    force_monitor_report(f.monitor, 4, &r);
    assert_close(r.core_base_shear_n, 1e6, 1e-3);
}

/* ---- one impact ---------------------------------------------------------------------------------------------- */

typedef struct {
    int n;
    SimContact at[64];
} ContactList;

static void add_contact(const SimContact *c, void *user)
{
    ContactList *list = user;
    if (!c)
        list->n = 0;
    else if (list->n < 64)
        list->at[list->n++] = *c;
}

/* A monitor for bobs: masses without a shape of their own, of which only contacts are asked. */
static ForceMonitor *bobs_monitor(int n, ContactList *list)
{
    static double zero[64 * 64];
    static CoreBeam core;
    ForceMonitor *m;
    const SceneOptions options = paper_scene();
    double storeys[64], one[64];
    for (int i = 0; i < 64; i++)
        storeys[i] = one[i] = core.omega[i] = 1;
    core.n = core.top = n;
    const Building b = {.n = n,
                        .K = zero,
                        .M = zero,
                        .storey_m = storeys,
                        .model = {.n = n, .K = zero, .M = zero, .phi = zero, .omega = one, .gamma = one}};
    double x[66] = {0};
    x[n] = x[n + 1] = 0.01;
    CHECK_OK(force_monitor_create(&m, n, n, &err), &err);
    force_monitor_set(m, &options, &b, &core, 0, x + n);
    force_monitor_on_contact(m, add_contact, list);
    return m;
}

static void bounce(Accuracy accuracy, double speed, double r, int side, ContactList *list, SimForces *f)
{
    OWNED(model_free) SimModel model;
    SimResult result;
    const double m = 280000, k = 4.865e10, duration = contact_hertz_duration(k, m, speed), dt = 7.3 * duration;
    double accel[12] = {0, -side * speed / dt};
    const Motion motion = {.accel = accel, .n = 12, .dt_s = dt};
    bobs_model(&model, 1, &(Bob){.mass = m, .gap = speed * 4.013 * dt}, 0,
               &(Contact){.k = k, .a = 1.5 * (1 - r), .v0_floor = 1e-300});
    ForceMonitor *monitor = bobs_monitor(1, list);
    CHECK_OK(engine_fast(&model, &motion, &(EngineOptions){.duration = 8 * dt, .accuracy = accuracy, .forces = monitor},
                         &result, &err),
             &err);
    force_monitor_report(monitor, 8 * dt, f);
    force_monitor_free(monitor);
}

TEST(an_impact_has_its_closed_force_impulse_duration_and_loss)
{
    const double allowed[] = {[ACCURACY_COARSE] = 0.04, [ACCURACY_STANDARD] = 6e-3, [ACCURACY_FINE] = 1e-5};
    for (int accuracy = ACCURACY_COARSE; accuracy <= ACCURACY_FINE; accuracy++)
        for (int side = -1; side <= 1; side += 2) {
            ContactList list = {0};
            SimForces f;
            const double m = 280000, k = 4.865e10, v = 0.4, e = contact_rebound(0.45), tol = allowed[accuracy];
            const double depth = contact_hertz_indentation(k, m, v);
            bounce((Accuracy)accuracy, v, 0.7, side, &list, &f);
            assert_int_equal(list.n, 1);
            const SimContact *c = &list.at[0];
            assert_true(c->floor == 0 && c->side == side && !c->open);
            assert_close(c->approach, v, tol);
            assert_close(c->rebound, e * v, tol);
            assert_close(c->impulse, m * v * (1 + e), tol);
            assert_close(c->force, 0.911023 * k * pow(depth, 1.5), tol);
            assert_close(c->indentation, 0.902920 * depth, tol);
            assert_close(c->duration, 1.03332 * contact_hertz_duration(k, m, v), tol);
            assert_close(c->lost, 0.5 * m * v * v * (1 - e * e), 2 * tol);
            const int i = side > 0 ? 0 : 1;
            assert_int_equal(f.contacts[i][0], 1);
            assert_int_equal(f.contacts[1 - i][0], 0);
            assert_close(f.contact_force_max_n, c->force, 1e-12);
            assert_close(f.contact_impulse_ns[i][0], c->impulse, 1e-12);
        }
}

/* Two floors strike a core that is a free mass: what they gave it is its momentum. */
TEST(impulses_add_up_to_the_change_of_momentum)
{
    for (int accuracy = ACCURACY_COARSE; accuracy <= ACCURACY_FINE; accuracy++) {
        OWNED(model_free) SimModel model;
        SimResult result;
        SimForces f;
        ContactList list = {0};
        double accel[60] = {0, -8, 0, 0, 0, 6}, end[6];
        const double core_mass = 4e5;
        const Motion motion = {.accel = accel, .n = 60, .dt_s = 0.05};
        const Bob floors[] = {{.mass = 2e5, .gap = 0.02, .omega = 6, .zeta = 0.03},
                              {.mass = 3e5, .gap = 0.031, .omega = 9, .zeta = 0.03}};
        bobs_model(&model, 2, floors, core_mass, &(Contact){.k = 4.865e10, .a = 0.45, .v0_floor = 1e-6});
        ForceMonitor *monitor = bobs_monitor(2, &list);
        const EngineOptions options = {
            .duration = 2.95, .accuracy = (Accuracy)accuracy, .forces = monitor, .end_state = end};
        CHECK_OK(engine_fast(&model, &motion, &options, &result, &err), &err);
        force_monitor_report(monitor, 2.95, &f);
        double impulse = 0;
        for (int j = 0; j < 2; j++)
            impulse += f.contact_impulse_ns[0][j] - f.contact_impulse_ns[1][j];
        assert_at_most(4, result.impacts);
        assert_int_equal(f.contacts[0][0] + f.contacts[0][1] + f.contacts[1][0] + f.contacts[1][1], result.impacts);
        assert_close(impulse, end[3 + 2] * sqrt(core_mass), accuracy == ACCURACY_FINE ? 1e-8 : 1e-3);
        force_monitor_free(monitor);
    }
}

/* ---- the tower ----------------------------------------------------------------------------------------------- */

static void irregular_design(double x[N + 2])
{
    for (int j = 0; j < N + 2; j++)
        x[j] = j < N ? 0.004 * (j + 1) + 0.002 * (j % 3) : j == N ? 0.012 : 0.0064;
}

static SimResult tower_run_of(const SimOptions *sim, SceneKind kind)
{
    SceneOptions options = paper_scene();
    options.sim = *sim;
    double x[N + 2];
    irregular_design(x);
    OWNED(motion_free) Motion motion = motion_of("builtin:elcentro-like", 0.3, 3);
    SimResult r = run_once(&options, &motion, kind, x);
    r.seconds = 0;
    return r;
}

static SimResult tower_run(Engine engine, Accuracy accuracy, SceneKind kind, int forces, double seconds)
{
    SimOptions sim = paper_scene().sim;
    sim.engine = engine;
    sim.accuracy = accuracy;
    sim.duration_s = seconds;
    sim.forces = forces;
    return tower_run_of(&sim, kind);
}

static SimForces tower_forces(int measures_only)
{
    SimOptions sim = paper_scene().sim;
    sim.duration_s = 20;
    sim.forces = FORCES_YES;
    sim.measures_only = measures_only;
    return tower_run_of(&sim, SCENE_IMPACT).forces;
}

static void same_forces(const SimForces *a, const SimForces *b, double tolerance)
{
    double impulse[2] = {0};
    assert_close_in(*a, *b, tolerance, base_shear_n, overturning_nm, core_base_shear_n, core_overturning_nm,
                    core_stress_pa, core_top_m, contact_force_max_n, building_base_shear_n);
    for (int s = 0; s < N; s++) {
        assert_close(a->core_shear_n[s], b->core_shear_n[s], 2 * tolerance);
        assert_close(a->core_moment_nm[s], b->core_moment_nm[s], 2 * tolerance);
        assert_close(a->building_shear_n[s], b->building_shear_n[s], 2 * tolerance);
        assert_close(a->peak_velocity_m_s[s], b->peak_velocity_m_s[s], 0.02 + 2 * tolerance); /* jumps at impacts */
        for (int side = 0; side < SIDES; side++) {
            impulse[0] += a->contact_impulse_ns[side][s];
            impulse[1] += b->contact_impulse_ns[side][s];
        }
    }
    assert_close(impulse[0], impulse[1], tolerance);
}

TEST(fast_and_cvode_agree_in_every_force_before_the_horizon)
{
    const SimResult fine = tower_run(ENGINE_FAST, ACCURACY_FINE, SCENE_IMPACT, 1, 5);
    const SimResult cvode = tower_run(ENGINE_CVODE, ACCURACY_FINE, SCENE_IMPACT, 1, 5);
    assert_less(5, fine.impacts);
    same_forces(&fine.forces, &cvode.forces, 5e-3);
}

TEST(standard_accuracy_is_near_fine_in_every_force)
{
    const SimResult fine = tower_run(ENGINE_FAST, ACCURACY_FINE, SCENE_IMPACT, 1, 8);
    const SimResult standard = tower_run(ENGINE_FAST, ACCURACY_STANDARD, SCENE_IMPACT, 1, 8);
    same_forces(&standard.forces, &fine.forces, 5e-2);
}

/* Every sample as a point of a monitor of its own. */
typedef struct {
    ForceMonitor *monitor;
    long points;
} AllPoints;

static void add_all(const SimSample *s, void *user)
{
    AllPoints *all = user;
    const int kept = s->n_modes - s->n_building;
    FloorSet in_contact = 0;
    if (s->t == 0)
        force_monitor_start(all->monitor, kept < N ? kept : N, HUGE_VAL);
    for (int j = 0; j < N; j++)
        in_contact |= (FloorSet)(s->force[j] != 0) << j;
    force_monitor_point(all->monitor, &(ForcePoint){.t = s->t,
                                                    .ground = s->ground,
                                                    .building_q = s->q,
                                                    .building_v = s->v,
                                                    .core_q = s->q + s->n_building,
                                                    .force = s->force,
                                                    .in_contact = in_contact});
    all->points++;
}

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* What lies between the points of a run and what it leaves out, at standard accuracy. */
TEST(peaks_are_those_of_points_every_quarter_of_a_millisecond)
{
    SimResult r;
    SimForces dense;
    double x[N + 2], apart[4 * N];
    int n = 0;
    OWNED(frame_close) Frame f;
    frame_open(&f, CORE_BOX, 0.012, 0.0064);
    f.options.sim.forces = FORCES_YES;
    f.options.sim.duration_s = 40;
    irregular_design(x);
    OWNED(motion_free) Motion motion = motion_of("builtin:elcentro-like", 0.3, 3);
    OWNED(one_scene_free) OneScene stage = one_scene_of(&f.options, &motion);
    AllPoints all = {.monitor = f.monitor};
    sim_worker_sample(stage.worker, 2.5e-4, add_all, &all);
    CHECK_OK(sim_run(stage.worker, SCENE_IMPACT, x, &r, &err), &err);
    assert_true(r.impacts > 20 && (double)all.points > 0.9 * f.options.sim.duration_s / 2.5e-4);
    force_monitor_report(f.monitor, f.options.sim.duration_s, &dense);
    for (int s = 0; s < N; s++) {
        apart[n++] = fabs(r.forces.core_shear_n[s] / dense.core_shear_n[s] - 1);
        apart[n++] = fabs(r.forces.core_moment_nm[s] / dense.core_moment_nm[s] - 1);
        apart[n++] = fabs(r.forces.building_shear_n[s] / dense.building_shear_n[s] - 1);
        apart[n++] = fabs(r.forces.peak_velocity_m_s[s] / dense.peak_velocity_m_s[s] - 1);
    }
    qsort(apart, (size_t)n, sizeof *apart, by_size);
    if (!(apart[n / 2] < 3e-3 && apart[n * 9 / 10] < 3e-2 && apart[n - 1] < 0.1))
        fail_msg("apart by %g, %g and %g in the middle, of nine in ten and at most", apart[n / 2], apart[n * 9 / 10],
                 apart[n - 1]);
    assert_close(r.forces.core_stress_pa, dense.core_stress_pa, 5e-3);
    assert_close(r.forces.overturning_nm, dense.overturning_nm, 5e-3);
    assert_close(r.forces.base_shear_n, dense.base_shear_n, 5e-2);
}

TEST(what_measures_do_not_need_is_left_out_and_changes_none)
{
    const SimForces whole = tower_forces(0), few = tower_forces(1);
    assert_true(isnan(few.building_shear_n[1]) && isnan(few.peak_velocity_m_s[0]));
    assert_true(few.building_shear_n[0] == whole.building_shear_n[0] && whole.building_shear_n[1] > 0);
    assert_same_number(few.building_overturning_nm, whole.building_overturning_nm);
    assert_true(few.base_shear_n == whole.base_shear_n && few.core_stress_pa == whole.core_stress_pa);
    assert_memory_equal(few.core_shear_n, whole.core_shear_n, sizeof few.core_shear_n);
    assert_memory_equal(few.contact_force_n, whole.contact_force_n, sizeof few.contact_force_n);
    const SimResult of_few = {.forces_known = 1, .forces = few}, of_whole = {.forces_known = 1, .forces = whole};
    for (int k = 0; k < N_MEASURES; k++) {
        const double found = measure_value(&of_few, k), wanted = measure_value(&of_whole, k);
        assert_true(!(measure(k)->needs & NEEDS_FEW_FORCES) || found == wanted || (isnan(found) && isnan(wanted)));
    }
}

TEST(asking_for_forces_changes_no_other_figure)
{
    for (int kind = SCENE_IMPACT; kind <= SCENE_RIGID; kind++) {
        const SimResult without = tower_run(ENGINE_FAST, ACCURACY_STANDARD, (SceneKind)kind, 0, 20);
        SimResult with = tower_run(ENGINE_FAST, ACCURACY_STANDARD, (SceneKind)kind, 1, 20);
        assert_true(with.forces_known && with.forces.base_shear_n > 0);
        with.forces_known = 0;
        with.forces = without.forces;
        assert_memory_equal(&with, &without, sizeof with);
    }
}

TEST(the_rigid_pair_has_the_base_shear_of_its_parts)
{
    const SimResult r = tower_run(ENGINE_FAST, ACCURACY_FINE, SCENE_RIGID, 1, 20);
    const SimForces *f = &r.forces;
    assert_true(f->base_shear_n > 0 && f->base_shear_n <= f->core_base_shear_n + f->building_base_shear_n);
    assert_true(f->core_top_m > 0.999 * r.j1_m && f->core_top_m < 1.001 * r.j1_m);
    assert_true(isnan(f->contact_force_max_n));
}

SUITE(NULL, NULL)
