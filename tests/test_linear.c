/* Baselines: floors and core as one, a tuned mass, links. */
#include <complex.h>

#include "scene_options.h"
#include "sim/joined.h"
#include "analysis/baselines.h"
#include "evaluate/device.h"

enum { N = 3 };

typedef struct {
    Building b;
    double K[N * N], M[N * N], phi[N * N], omega[N], gamma[N], zeta[N], storey[N], none[N];
    int like[N];
} Frame;

/* n equal storeys of stiffness k and mass m. */
static void make_frame(Frame *f, int n, double k, double m, double zeta)
{
    memset(f, 0, sizeof *f);
    f->b = (Building){.n = n,
                      .K = f->K,
                      .M = f->M,
                      .phi = f->phi,
                      .omega = f->omega,
                      .gamma = f->gamma,
                      .zeta = f->zeta,
                      .storey_m = f->storey,
                      .yield_m = f->none,
                      .yield_n_m = f->none};
    for (int j = 0; j < n; j++) {
        f->M[j * n + j] = m;
        f->K[j * n + j] = j + 1 < n ? 2 * k : k;
        if (j + 1 < n)
            f->K[j * n + j + 1] = f->K[(j + 1) * n + j] = -k;
        f->zeta[j] = zeta;
        f->storey[j] = 3;
        f->like[j] = j;
    }
    CHECK_OK(linalg_modes(n, f->K, f->M, f->omega, f->phi, &err), &err);
    linalg_participation(n, f->M, NULL, f->phi, f->gamma);
    f->b.model = (BuildingModel){.n = n,
                                 .K = f->K,
                                 .M = f->M,
                                 .phi = f->phi,
                                 .omega = f->omega,
                                 .gamma = f->gamma,
                                 .zeta = f->zeta,
                                 .like = f->like};
}

static void add_devices(SimModel *m, SceneKind kind, double mass, LinearDevice d)
{
    const double w = 2 * M_PI * d.tmd_hz;
    if (kind == SCENE_TMD) {
        const Device device = {
            .floor = m->n - 1, .stiffness = mass * w * w, .damping = 2 * d.tmd_damping * mass * w, .exponent = 1};
        model_add_mass(m, mass);
        model_add_device(m, &device, 1);
    }
    for (int j = 0; j < m->n && kind == SCENE_LINKS && d.link_ns_m > 0; j++)
        model_add_device(m, &(Device){.floor = j, .damping = d.link_ns_m, .exponent = 1}, 0);
}

static SimResult run_system(SceneKind kind, const Frame *f, const CoreBeam *core, LinearDevice device,
                            const Motion *motion)
{
    OWNED(joined_free) Joined both = {.building = f->b};
    const SceneOptions o = paper_scene();
    const EngineOptions fine = {.duration = (double)(motion->n - 1) * motion->dt_s, .accuracy = ACCURACY_FINE};
    OWNED(model_free) SimModel m;
    SimResult r = {0};
    if (kind == SCENE_RIGID)
        CHECK_OK(joined_make(&both, &f->b, core, &err), &err);
    CHECK_OK(model_create(&m, f->b.n, f->b.n, &err), &err);
    CHECK_OK(model_set(&m, &o, &both.building, kind == SCENE_LINKS ? core : NULL, NULL, &err), &err);
    add_devices(&m, kind, core->mass_kg, device);
    CHECK_OK(engine_fast(&m, motion, &fine, &r, &err), &err);
    if (kind == SCENE_RIGID)
        joined_book(&both, &r);
    return r;
}

/* |x1| of an undamped structure of frequency w1 and mass 1 with a tuned mass mu, ground exp(i w t). */
static double amplitude(double w1, double mu, LinearDevice d, double w)
{
    const double wt = 2 * M_PI * d.tmd_hz;
    const double complex link = mu * wt * wt + I * w * 2 * d.tmd_damping * mu * wt;
    const double complex a = w1 * w1 - w * w + link, b = -link, c = link - mu * w * w;
    return cabs((-c + b * mu) / (a * c - b * b));
}

TEST(a_tuned_mass_answers_a_harmonic_as_its_transfer_function)
{
    enum { SAMPLES = 60001 };
    const double w1 = 2 * M_PI, ratios[] = {0.85, 0.95, 1.1, 1.3};
    FREED double *accel = malloc(SAMPLES * sizeof *accel);
    FREED CoreBeam *core = calloc(1, sizeof *core);
    Frame f;
    make_frame(&f, 1, w1 * w1, 1, 0);
    core->mass_kg = 0.05;
    const LinearDevice d = warburton_device(1, 0.05);
    for (size_t k = 0; k < sizeof ratios / sizeof ratios[0]; k++) {
        const double w = ratios[k] * w1, dt = 0.005;
        for (int i = 0; i < SAMPLES; i++) /* slowly risen, so that no transient is larger than the steady state */
            accel[i] = pow(sin(M_PI / 2 * fmin(i * dt / 250, 1)), 2) * sin(w * i * dt);
        const Motion m = {.dt_s = dt, .n = SAMPLES, .accel = accel};
        const SimResult r = run_system(SCENE_TMD, &f, core, d, &m);
        assert_close(r.j1_m, amplitude(w1, 0.05, d, w), 2e-3);
        assert_less(r.energy_balance_error, 1e-6);
    }
}

/* int |x1|^2 dw, white noise at the base. */
static double variance(double mu, LinearDevice d)
{
    double sum = 0;
    for (double w = 1e-3; w < 6 * 2 * M_PI; w += 2e-3) {
        const double a = amplitude(2 * M_PI, mu, d, w);
        sum += a * a;
    }
    return sum;
}

TEST(warburtons_device_has_the_least_variance_under_white_noise)
{
    for (double mu = 0.02; mu < 0.3; mu *= 2) {
        const LinearDevice best = warburton_device(1, mu);
        const double least = variance(mu, best);
        for (int k = 0; k < 4; k++) {
            LinearDevice other = best;
            other.tmd_hz *= k == 0 ? 1.02 : k == 1 ? 0.98 : 1;
            other.tmd_damping *= k == 2 ? 1.1 : k == 3 ? 0.9 : 1;
            assert_less(least, variance(mu, other));
        }
    }
}

/* -- an independent integration: Runge and Kutta in the displacements ------------------------------------------------ */

typedef struct {
    int n; /* displacements */
    double K[4 * N * N], C[4 * N * N], M_inverse[4 * N * N], load[2 * N];
} Physical;

static void rates(const Physical *p, double a, const double z[], double out[])
{
    double force[2 * N];
    for (int i = 0; i < p->n; i++) {
        force[i] = -p->load[i] * a;
        for (int j = 0; j < p->n; j++)
            force[i] -= p->K[i * p->n + j] * z[j] + p->C[i * p->n + j] * z[p->n + j];
    }
    for (int i = 0; i < p->n; i++) {
        out[i] = z[p->n + i];
        out[p->n + i] = 0;
        for (int j = 0; j < p->n; j++)
            out[p->n + i] += p->M_inverse[i * p->n + j] * force[j];
    }
}

static double ground_at(const Motion *m, double t)
{
    const size_t k = (size_t)fmin(t / m->dt_s, (double)(m->n - 2));
    const double part = t / m->dt_s - (double)k;
    return m->accel[k] * (1 - part) + m->accel[k + 1] * part;
}

static void step(const Physical *p, const Motion *m, double t, double h, double z[])
{
    double k[4][4 * N], at[4 * N];
    for (int stage = 0; stage < 4; stage++) {
        const double part = stage == 0 ? 0 : stage < 3 ? 0.5 : 1;
        for (int i = 0; i < 2 * p->n; i++)
            at[i] = z[i] + (stage ? part * h * k[stage - 1][i] : 0);
        rates(p, ground_at(m, t + part * h), at, k[stage]);
    }
    for (int i = 0; i < 2 * p->n; i++)
        z[i] += h / 6 * (k[0][i] + 2 * k[1][i] + 2 * k[2][i] + k[3][i]);
}

/* J1, J2, J3 of the first floors. */
static void integrate(const Physical *p, int floors, const Motion *m, int parts, double J[3])
{
    double z[4 * N] = {0}, rate[4 * N];
    const double h = m->dt_s / parts;
    memset(J, 0, 3 * sizeof *J);
    for (size_t k = 0; k < (m->n - 1) * (size_t)parts; k++) {
        step(p, m, (double)k * h, h, z);
        const double a = ground_at(m, (double)(k + 1) * h);
        rates(p, a, z, rate);
        for (int j = 0; j < floors; j++) {
            J[0] = fmax(J[0], fabs(z[j]));
            J[1] = fmax(J[1], fabs(z[j] - (j ? z[j - 1] : 0)));
            J[2] = fmax(J[2], fabs(rate[p->n + j] + a) / 9.81);
        }
    }
}

/* C = M phi diag(2 zeta w) phi' M into the block at `first` of an (n, n) matrix. */
static void modal_damping(int n, int first, int size, const double M[], const double phi[], const double omega[],
                          double zeta, double C[])
{
    double m_phi[N * N] = {0};
    for (int i = 0; i < size; i++)
        for (int k = 0; k < size; k++)
            for (int j = 0; j < size; j++)
                m_phi[i * size + k] += M[i * size + j] * phi[j * size + k];
    for (int i = 0; i < size; i++)
        for (int j = 0; j < size; j++)
            for (int k = 0; k < size; k++)
                C[(first + i) * n + first + j] += 2 * zeta * omega[k] * m_phi[i * size + k] * m_phi[j * size + k];
}

/* What the masses, written over, add to stiffness and damping. */
static void lay_out_masses(Physical *p, double M[])
{
    const int n = p->n;
    for (int i = 0; i < n * n; i++) {
        p->load[i / n] += M[i];
        p->M_inverse[i] = i / n == i % n;
    }
    CHECK_OK(linalg_solve_spd(n, n, M, p->M_inverse, &err), &err);
}

/* Building and core side by side. */
static void lay_out_pair(Physical *p, const SceneOptions *o, const Frame *f, const CoreBeam *core, double c)
{
    const int n = 2 * N;
    double M[4 * N * N] = {0};
    *p = (Physical){.n = n};
    for (int i = 0; i < N; i++)
        for (int j = 0; j < N; j++) {
            p->K[i * n + j] = f->K[i * N + j];
            p->K[(N + i) * n + N + j] = core->K[i * N + j];
            M[i * n + j] = f->M[i * N + j];
            M[(N + i) * n + N + j] = core->M[i * N + j];
        }
    modal_damping(n, 0, N, f->M, f->phi, f->omega, f->zeta[0], p->C);
    modal_damping(n, N, N, core->M, core->phi, core->omega, o->core.damping, p->C);
    for (int j = 0; j < N; j++) {
        p->C[j * n + j] += c;
        p->C[(N + j) * n + N + j] += c;
        p->C[j * n + N + j] -= c;
        p->C[(N + j) * n + j] -= c;
    }
    lay_out_masses(p, M);
}

static void lay_out_tmd(Physical *p, const Frame *f, double mass, LinearDevice d)
{
    const int n = N + 1;
    const double w = 2 * M_PI * d.tmd_hz, k = mass * w * w, c = 2 * d.tmd_damping * mass * w;
    double M[4 * N * N] = {0};
    *p = (Physical){.n = n};
    for (int i = 0; i < N; i++)
        for (int j = 0; j < N; j++) {
            p->K[i * n + j] = f->K[i * N + j];
            M[i * n + j] = f->M[i * N + j];
        }
    M[N * n + N] = mass;
    modal_damping(n, 0, N, f->M, f->phi, f->omega, f->zeta[0], p->C);
    for (int i = N - 1; i <= N; i++)
        for (int j = N - 1; j <= N; j++) {
            p->K[i * n + j] += i == j ? k : -k;
            p->C[i * n + j] += i == j ? c : -c;
        }
    lay_out_masses(p, M);
}

/* Three floors around a core so slender that its fastest mode needs no tiny steps, and what shakes them. */
static Motion make_pair(Frame *f, CoreBeam *core, SceneOptions *o)
{
    enum { SHAKES = 301 };
    static double accel[SHAKES];
    static const double storey[N] = {3, 3, 3};
    o->core.width_m = 1;
    make_frame(f, N, 4e7, 1e5, 0.03);
    CHECK_OK(core_beam_make(core, &o->core, N, storey, 0.02, 0.01, &err), &err);
    for (int i = 0; i < SHAKES; i++)
        accel[i] = 3 * sin(0.13 * i) * cos(0.031 * i * i * 0.05) * (i < 250 ? 1 : 0);
    return (Motion){.dt_s = 0.05, .n = SHAKES, .accel = accel};
}

static void assert_as_integrated(const SimResult *r, const Physical *p, const Motion *m)
{
    double J[3];
    integrate(p, N, m, 400, J);
    assert_close(r->j1_m, J[0], 1e-6);
    assert_close(r->j2_m, J[1], 1e-6);
    assert_close(r->j3_g, J[2], 1e-5);
    assert_less(r->energy_balance_error, 1e-7);
}

TEST(tuned_mass_and_links_agree_with_runge_and_kutta_in_the_displacements)
{
    SceneOptions o = paper_scene();
    Frame f;
    Physical p;
    FREED CoreBeam *core = calloc(1, sizeof *core);
    const LinearDevice d = {.tmd_hz = 1.3, .tmd_damping = 0.2, .link_ns_m = 4e5};
    const Motion m = make_pair(&f, core, &o);
    for (int is_tmd = 0; is_tmd < 2; is_tmd++) {
        const SimResult r = run_system(is_tmd ? SCENE_TMD : SCENE_LINKS, &f, core, d, &m);
        if (is_tmd)
            lay_out_tmd(&p, &f, core->mass_kg, d);
        else
            lay_out_pair(&p, &o, &f, core, d.link_ns_m);
        assert_as_integrated(&r, &p, &m);
        assert_true(r.stroke_m > 0 && r.dashpot_n > 0);
    }
}

/* Where a storey of frequency w turns next: around F / k beside its rest, without a loss else. */
static double next_turn(double w, double slip, double u, double v)
{
    return hypot((v > 0 ? u : -u) + slip, v / w) - slip;
}

TEST(friction_takes_four_times_its_force_over_the_stiffness_from_every_cycle)
{
    enum { CYCLES = 5 };
    static Status (*const ENGINES[])(const SimModel *, const Motion *, const EngineOptions *, SimResult *,
                                     Err *) = {engine_fast, engine_cvode};
    static const Accuracy ACCURACIES[] = {ACCURACY_COARSE, ACCURACY_STANDARD, ACCURACY_FINE, ACCURACY_FINE};
    const double w = 2 * M_PI, force = 0.4, slip = force / (w * w);
    const SceneOptions o = paper_scene();
    double accel[141] = {0, 10, 10, 10, 10, 10}, turn[2];
    const Motion motion = {.dt_s = 0.05, .n = 141, .accel = accel};
    Frame f;
    OWNED(model_free) SimModel m;
    SimResult r;
    make_frame(&f, 1, w * w, 1, 0);
    CHECK_OK(model_create(&m, 1, 1, &err), &err);
    CHECK_OK(model_set(&m, &o, &f.b, NULL, NULL, &err), &err);
    model_add_device(&m, &(Device){.damping = force}, 0);
    for (int i = 0; i < 4; i++) {
        double ended[2];
        for (int late = 0; late < 2; late++) {
            const EngineOptions run = {.duration = 1 + late * CYCLES, .accuracy = ACCURACIES[i], .end_state = ended};
            memset(&r, 0, sizeof r);
            CHECK_OK(ENGINES[i == 3](&m, &motion, &run, &r, &err), &err);
            turn[late] = next_turn(w, slip, ended[0], ended[1]);
        }
        assert_close(turn[0] - turn[1], CYCLES * 4 * slip, 1e-3);
        assert_close(r.dashpot_n, force, 1e-4);
        assert_close(r.device_loss_j + 0.5 * (pow(w * ended[0], 2) + pow(ended[1], 2)), r.input_energy_j, 1e-3);
        assert_less(r.energy_balance_error, 5e-4);
    }
}

TEST(links_without_damping_are_no_links_and_with_much_of_it_the_rigid_connection)
{
    SceneOptions o = paper_scene();
    double J[3];
    Frame f;
    Physical p;
    FREED CoreBeam *core = calloc(1, sizeof *core);
    const Motion m = make_pair(&f, core, &o);
    const SimResult loose = run_system(SCENE_LINKS, &f, core, (LinearDevice){.link_ns_m = 0}, &m);
    lay_out_tmd(&p, &f, 1e-9, (LinearDevice){.tmd_hz = 1, .tmd_damping = 0.1});
    integrate(&p, N, &m, 200, J);
    assert_close(loose.j1_m, J[0], 1e-6);
    memset(f.zeta, 0, sizeof f.zeta); /* what damping both have together is a matter of its own */
    memset(core->zeta, 0, sizeof core->zeta);
    const SimResult rigid = run_system(SCENE_RIGID, &f, core, (LinearDevice){0}, &m);
    double before = INFINITY;
    for (double c = 1e8; c < 1e12; c *= 10) {
        const SimResult tight = run_system(SCENE_LINKS, &f, core, (LinearDevice){.link_ns_m = c}, &m);
        const double off = fabs(tight.j1_m / rigid.j1_m - 1);
        assert_true(off < 0.3 * before || off < 1e-5);
        before = off;
    }
    assert_less(before, 2e-3);
}

/* Displacements of both as one in their own modes, each with the ratio zeta: C = M phi diag(2 zeta w) phi' M. */
TEST(rigidly_connected_every_mode_of_both_has_the_damping_of_the_building)
{
    enum { NN = N * N };
    SceneOptions o = paper_scene();
    double M[NN], phi[NN], omega[N];
    Frame f;
    Physical p = {.n = N};
    FREED CoreBeam *core = calloc(1, sizeof *core);
    o.core.damping = 0.2; /* has no say */
    const Motion m = make_pair(&f, core, &o);
    for (int i = 0; i < NN; i++) {
        p.K[i] = f.K[i] + core->K[i];
        M[i] = f.M[i] + core->M[i];
    }
    CHECK_OK(linalg_modes(N, p.K, M, omega, phi, &err), &err);
    modal_damping(N, 0, N, M, phi, omega, 0.03, p.C);
    lay_out_masses(&p, M);
    const SimResult r = run_system(SCENE_RIGID, &f, core, (LinearDevice){0}, &m);
    assert_as_integrated(&r, &p, &m);
    assert_true(r.damped_core_j > 0 && r.damped_building_j > r.damped_core_j);
}

/* -- baselines of a tower ------------------------------------------------------------------------------------------ */

/* By an integrator of its own, under record r. */
static void run_alone(const Problem *p, size_t r, SceneKind kind, const double x[], const LinearDevice *device,
                      SimResult *result)
{
    SimWorker *w;
    CHECK_OK(sim_worker_create(&w, tower_record(tower_of(p), r)->scene, &err), &err);
    if (device)
        sim_worker_device(w, device);
    CHECK_OK(sim_run(w, kind, x, result, &err), &err);
    sim_worker_free(w);
}

/* Of six floors or of twenty, elastic where yield_drift is 0. */
static void open_tower(Problem *p, int floors, const char *records, Robust robust, long threads, double yield_drift)
{
    Settings s = paper_settings();
    s.sim.duration_s = 25;
    if (floors == 6) {
        six_floors(&s.building, &s.core);
        s.motion.stretch = 1;
        s.sim.duration_s = 30;
    }
    s.building.yield_drift = yield_drift;
    s.sim.robust = robust;
    s.search.threads = threads;
    CHECK_OK(settings_set(&s, brief("motion.records=%s", records), &err), &err);
    CHECK_OK(tower_open(p, &s, TOWER_AS_SET, SIZE_MAX, &err), &err);
}

static void rigid_design(int floors, double x[22])
{
    for (int j = 0; j < floors; j++)
        x[j] = 1e-6;
    x[floors] = 0.03;
    x[floors + 1] = 0.01;
}

TEST(baselines_are_of_the_records_by_the_rule_of_the_study_on_any_number_of_threads)
{
    Problem p;
    double x[22];
    Baseline *both[4]; /* worst, mean, worst on two and seven threads */
    rigid_design(6, x);
    for (int i = 0; i < 4; i++) {
        both[i] = calloc(N_SCENES, sizeof **both);
        open_tower(&p, 6, "builtin:sylmar-like", i == 1 ? ROBUST_MEAN : ROBUST_WORST, (int[]){1, 1, 2, 7}[i], 0);
        CHECK_OK(baselines_find(&p, x, i != 1, both[i], &err), &err);
        for (int k = SCENE_NO_CORE; k <= SCENE_RIGID; k++) {
            SimResult each[2];
            for (size_t r = 0; r < 2; r++)
                run_alone(&p, r, (SceneKind)k, x, NULL, &each[r]);
            assert_close(both[i][k].value[0],
                         i == 1 ? 0.5 * (each[0].j1_m + each[1].j1_m) : fmax(each[0].j1_m, each[1].j1_m), 1e-12);
        }
        problem_close(&p);
    }
    for (int k = SCENE_NO_CORE; k < N_SCENES; k++)
        for (int i = 2; i < 4; i++) {
            assert_memory_equal(both[0][k].value, both[i][k].value, sizeof both[0]->value);
            assert_memory_equal(&both[0][k].device, &both[i][k].device, sizeof both[0]->device);
        }
    for (int i = 0; i < 4; i++)
        free(both[i]);
}

static double goal(const Baseline *b, const Baseline *no_core)
{
    double sum = 0;
    for (int k = 0; k < 3; k++)
        sum += b->value[k] / no_core->value[k];
    return sum;
}

static void find_devices(const char *records, double yield_drift)
{
    OWNED(problem_close) Problem p;
    double x[22];
    Baseline b[N_SCENES];
    rigid_design(6, x);
    open_tower(&p, 6, records, ROBUST_WORST, 2, yield_drift);
    CHECK_OK(baselines_find(&p, x, 1, b, &err), &err);
    for (SceneKind kind = SCENE_TMD; kind <= SCENE_LINKS; kind++) {
        const double found = goal(&b[kind], &b[SCENE_NO_CORE]);
        SimResult alone;
        assert_less(found, 3);
        run_alone(&p, 0, kind, x, &b[kind].device, &alone);
        if (tower_n_records(tower_of(&p)) == 1) /* of the whole motion, not its strong part */
            assert_same_number(b[kind].value[MEASURE_INPUT], alone.input_energy_j);
        for (int i = 0; i < 6; i++) {
            LinearDevice d = b[kind].device;
            Baseline other;
            ReplicateSummary sum;
            d.tmd_hz *= i == 0 ? 1.3 : i == 1 ? 0.75 : 1;
            d.tmd_damping *= i == 2 ? 2 : i == 3 ? 0.5 : 1;
            d.link_ns_m *= i == 4 ? 2 : i == 5 ? 0.5 : 1;
            const SimTask task = {
                .kind = kind, .x = x, .device = d, .n_parts = tower_n_records(tower_of(&p)), .summary = &sum};
            CHECK_OK(tower_run(&p, 1, &task, NULL, NULL, &err), &err);
            memcpy(other.value, sum.mean, sizeof other.value);
            assert_less(found - 0.01, goal(&other, &b[SCENE_NO_CORE]));
        }
    }
}

/* Forces on floors may come when the ground is at rest. */
TEST(the_strong_part_of_a_motion_ends_with_it_where_floors_are_pushed_and_behind_its_energy_elsewhere)
{
    enum { SAMPLES = 1001 };
    static double accel[SAMPLES] = {[100] = 1}, force[SAMPLES];
    Motion m = {.accel = accel, .n = SAMPLES, .dt_s = 0.01, .force = force};
    assert_close(motion_strong_part(&m, 0.5), 1.01 + 3 * 0.5, 1e-12);
    m.n_force = 1;
    assert_close(motion_strong_part(&m, 0.5), 10, 1e-12);
}

TEST(devices_are_better_than_none_and_than_their_neighbours)
{
    find_devices("none", 0);
}

/* The first grid is by four of them. */
TEST(devices_do_best_under_all_of_many_records)
{
    find_devices("builtin:elcentro-like,builtin:sylmar-like,builtin:suite-02,builtin:suite-03", 0);
}

/* Those of the elastic tower are not: the period of a tower that yields is longer. */
TEST(devices_of_a_tower_that_yields_are_found_for_it)
{
    find_devices("none", 0.001);
}

/* Tight links move floors and core as one, with the sum of what both damp, which is what gaps that vanish leave; the
 * baseline has more. */
TEST(gaps_that_vanish_are_tight_links_and_the_rigid_baseline_is_damped_more)
{
    OWNED(problem_close) Problem p;
    double x[22];
    SimResult rigid, closed, tight;
    rigid_design(20, x);
    open_tower(&p, 20, "none", ROBUST_WORST, 1, 0);
    run_alone(&p, 0, SCENE_RIGID, x, NULL, &rigid);
    run_alone(&p, 0, SCENE_LINKS, x, &(LinearDevice){.link_ns_m = 1e12}, &tight);
    run_alone(&p, 0, SCENE_IMPACT, x, NULL, &closed);
    assert_close(closed.j1_m, tight.j1_m, 0.02);
    assert_close(closed.j2_m, tight.j2_m, 0.05);
    assert_less(rigid.j1_m, 0.97 * tight.j1_m);
}

SUITE(NULL, NULL)
