#include "analysis/baselines.h"

#include <math.h>
#include <nlopt.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "scene/core_beam.h"

enum { MODES = 8, GRID_HZ = 13, GRID_DAMPING = 5, GRID_LINKS = 15, SIMPLEX_EVALS = 40 };
static const double STEP = 8e-3, ARIAS = 0.995, PERIODS = 3;

/* The box of a device: tuned mass: frequency over that of the building, damping ratio; links: constant over m w_1 of a mean
 * floor. */
static const double HZ_MIN = 0.4, HZ_MAX = 3.2, DAMPING_MIN = 0.01, DAMPING_MAX = 1, LINK_MIN = 1e-3, LINK_MAX = 1e4;

static const struct {
    const char *words, *key;
    SceneKind scene;
} BASELINES[N_BASELINES] = {
    [BASELINE_NO_CORE] = {"no core", "no_core", SCENE_NO_CORE},
    [BASELINE_RIGID] = {"rigidly connected", "rigid", SCENE_RIGID},
    [BASELINE_TMD] = {"tuned mass damper", "tmd", SCENE_TMD},
    [BASELINE_LINKS] = {"viscous links", "links", SCENE_LINKS},
};

const char *baseline_words(BaselineKind kind)
{
    return BASELINES[kind].words;
}

const char *baseline_key(BaselineKind kind)
{
    return BASELINES[kind].key;
}

void baseline_device_text(BaselineKind kind, const LinearDevice *d, char text[DEVICE_TEXT_MAX])
{
    text[0] = 0;
    if (kind == BASELINE_TMD)
        snprintf(text, DEVICE_TEXT_MAX, "%.3g Hz, damping %.2g", d->tmd_hz, d->tmd_damping);
    if (kind == BASELINE_LINKS)
        snprintf(text, DEVICE_TEXT_MAX, "%.3g MN s/m per floor", 1e-6 * d->link_ns_m);
}

LinearDevice warburton_device(double hz, double mu)
{
    return (LinearDevice){.tmd_hz = hz * sqrt(1 - 0.5 * fmin(mu, 1)) / (1 + mu),
                          .tmd_damping =
                              sqrt(mu * (1 - 0.25 * fmin(mu, 1)) / (4 * (1 + mu) * (1 - 0.5 * fmin(mu, 1))))};
}

/* -- tuning -------------------------------------------------------------------------------------------------------- */

typedef struct {
    const Tower *tower;
    size_t worker;
    SceneKind scene;
    const double *x, *no_core;
    LinearSketch sketch[TOWER_RECORDS_MAX];
    double hz, link; /* of the building; m w_1 of a mean floor */
    double best;
    LinearDevice device; /* of the best goal so far */
    Status status;
    Err *err;
} Tuning;

/* The device at u in the unit square, by logarithms. */
static LinearDevice device_at(const Tuning *t, const double u[])
{
    if (t->scene == SCENE_LINKS)
        return (LinearDevice){.link_ns_m = t->link * LINK_MIN * pow(LINK_MAX / LINK_MIN, u[0])};
    return (LinearDevice){.tmd_hz = t->hz * HZ_MIN * pow(HZ_MAX / HZ_MIN, u[0]),
                          .tmd_damping = DAMPING_MIN * pow(DAMPING_MAX / DAMPING_MIN, u[1])};
}

/* J1, J2, J3 over the records by the rule. */
static void combine(const Tower *t, const SimResult results[], double J[3])
{
    ReplicatePlan plan = tower_plan(t);
    ReplicateSummary sum;
    plan.n_replicates = 1;
    replicates_summarise(&plan, results, &sum);
    J[0] = sum.mean[MEASURE_J1];
    J[1] = sum.mean[MEASURE_J2];
    J[2] = sum.mean[MEASURE_J3];
}

static double goal_of(Tuning *t, const LinearDevice *device)
{
    SimResult results[TOWER_RECORDS_MAX];
    const size_t n = tower_n_records(t->tower);
    double J[3], goal = 0;
    for (size_t r = 0; r < n && t->status == STATUS_OK; r++) {
        SimWorker *worker = tower_worker(t->tower, r, t->worker);
        sim_worker_device(worker, device);
        t->status = sim_sketch(worker, t->scene, t->x, &t->sketch[r], &results[r], t->err);
    }
    if (t->status != STATUS_OK)
        return INFINITY;
    combine(t->tower, results, J);
    for (int k = 0; k < 3; k++)
        goal += J[k] / t->no_core[k];
    if (goal < t->best) {
        t->best = goal;
        t->device = *device;
    }
    return isfinite(goal) ? goal : 1e300;
}

static double goal_at(unsigned n, const double u[], double gradient[], void *user)
{
    (void)n;
    (void)gradient;
    const LinearDevice device = device_at(user, u);
    return goal_of(user, &device);
}

/* Until ARIAS of int a^2 dt has passed, and PERIODS of the building. */
static double strong_part(const Motion *m, double period)
{
    double whole = 0, sum = 0;
    size_t k = 0;
    for (size_t i = 0; i < m->n; i++)
        whole += m->accel[i] * m->accel[i];
    for (; k < m->n && sum < ARIAS * whole; k++)
        sum += m->accel[k] * m->accel[k];
    return (double)k * m->dt_s + PERIODS * period;
}

static void set_sketches(Tuning *t)
{
    const Building *b = scene_building(tower_record(t->tower, 0)->scene);
    double mass = 0;
    for (int i = 0; i < b->n * b->n; i++)
        mass += b->M[i];
    t->hz = b->omega[0] / (2 * M_PI);
    t->link = mass / b->n * b->omega[0];
    for (size_t r = 0; r < tower_n_records(t->tower); r++)
        t->sketch[r] = (LinearSketch){MODES, STEP, strong_part(&tower_record(t->tower, r)->motion, 1 / t->hz)};
}

/* The best of it comes back in u. */
static void search_grid(Tuning *t, double u[2])
{
    const int is_tmd = t->scene == SCENE_TMD, n = is_tmd ? GRID_HZ : GRID_LINKS, rows = is_tmd ? GRID_DAMPING : 1;
    double least = INFINITY;
    for (int i = 0; i < n; i++)
        for (int k = 0; k < rows; k++) {
            const double at[2] = {(i + 0.5) / n, (k + 0.5) / rows}, goal = goal_at(2, at, NULL, t);
            if (goal < least) {
                least = goal;
                memcpy(u, at, sizeof at);
            }
        }
}

/* Warburton's device for the first mode, whose shape says which share of the mass the roof sees. */
static void try_warburton(Tuning *t, double mass, double u[2])
{
    const Building *b = scene_building(tower_record(t->tower, 0)->scene);
    const double roof = b->phi[(b->n - 1) * b->n], before = t->best;
    const LinearDevice device = warburton_device(t->hz, mass * roof * roof);
    goal_of(t, &device);
    if (t->best < before) {
        u[0] = fmin(fmax(log(device.tmd_hz / (t->hz * HZ_MIN)) / log(HZ_MAX / HZ_MIN), 0), 1);
        u[1] = fmin(fmax(log(device.tmd_damping / DAMPING_MIN) / log(DAMPING_MAX / DAMPING_MIN), 0), 1);
    }
}

static void search_simplex(Tuning *t, double u[2])
{
    const double low[2] = {0, 0}, high[2] = {1, 1}, step[2] = {0.05, 0.1};
    double unused;
    nlopt_opt opt = nlopt_create(NLOPT_LN_NELDERMEAD, t->scene == SCENE_TMD ? 2 : 1);
    if (!opt)
        return; /* no memory: the grid's best stays */
    nlopt_set_lower_bounds(opt, low);
    nlopt_set_upper_bounds(opt, high);
    nlopt_set_initial_step(opt, step);
    nlopt_set_min_objective(opt, goal_at, t);
    nlopt_set_maxeval(opt, SIMPLEX_EVALS);
    nlopt_set_xtol_abs1(opt, 1e-4);
    nlopt_optimize(opt, u, &unused);
    nlopt_destroy(opt);
}

Status baseline_tune(const Tower *tower, size_t worker, BaselineKind kind, const double x[], const double no_core[3],
                     LinearDevice *device, Err *err)
{
    Tuning t = {.tower = tower,
                .worker = worker,
                .scene = BASELINES[kind].scene,
                .x = x,
                .no_core = no_core,
                .best = INFINITY,
                .err = err};
    double u[2] = {0.5, 0.5}, building[FLOORS_MAX], core[FLOORS_MAX], both[FLOORS_MAX], mass;
    TRY(scene_frequencies(tower_record(tower, 0)->scene, x, building, core, both, &mass, err));
    set_sketches(&t);
    search_grid(&t, u);
    if (t.scene == SCENE_TMD)
        try_warburton(&t, mass, u);
    search_simplex(&t, u);
    *device = t.device;
    return t.status;
}

/* -- all of them --------------------------------------------------------------------------------------------------- */

typedef struct {
    const Tower *tower;
    const double *x;
    size_t n_records;
    LinearDevice device[N_BASELINES];
    SimResult *results; /* (N_BASELINES, n_records) */
    Status *status;     /* (N_BASELINES n_records) of each */
    Err *why;
} Job;

static void simulate(Job *job, int kind, size_t record, size_t worker)
{
    const size_t i = (size_t)kind * job->n_records + record;
    SimWorker *w = tower_worker(job->tower, record, worker);
    sim_worker_device(w, &job->device[kind]);
    job->status[i] = sim_run(w, BASELINES[kind].scene, job->x, &job->results[i], &job->why[i]);
}

/* Tasks first .. first + n - 1, shared out. */
static Status simulate_all(Job *job, int first_kind, int last_kind, Err *err)
{
    const int n_records = (int)job->n_records, first = first_kind * n_records, last = (last_kind + 1) * n_records;
#pragma omp parallel for schedule(dynamic) num_threads((int)tower_n_workers(job->tower))
    for (int i = first; i < last; i++)
        simulate(job, i / n_records, (size_t)(i % n_records), (size_t)omp_get_thread_num());
    for (int i = first; i < last; i++)
        if (job->status[i] != STATUS_OK)
            return fail(err, job->status[i], "%s", job->why[i].text);
    return STATUS_OK;
}

static Status tune_all(Job *job, Err *err)
{
    double J[3];
    Status status[N_BASELINES] = {STATUS_OK};
    Err why[N_BASELINES] = {{0}};
    combine(job->tower, job->results, J);
#pragma omp parallel for schedule(dynamic, 1) num_threads(tower_n_workers(job->tower) > 1 ? 2 : 1)
    for (int k = BASELINE_TMD; k <= BASELINE_LINKS; k++)
        status[k] = baseline_tune(job->tower, (size_t)omp_get_thread_num(), (BaselineKind)k, job->x, J, &job->device[k],
                                  &why[k]);
    for (int k = BASELINE_TMD; k <= BASELINE_LINKS; k++)
        if (status[k] != STATUS_OK)
            return fail(err, status[k], "%s", why[k].text);
    return STATUS_OK;
}

static void summarise(const Job *job, BaselineKind last, Baseline out[N_BASELINES])
{
    ReplicatePlan plan = tower_plan(job->tower);
    plan.n_replicates = 1;
    ReplicateSummary sum;
    for (int k = last + 1; k < N_BASELINES; k++)
        out[k] = (Baseline){.outcome = OUTCOME_ERROR,
                            .first = {.outcome = RUN_ENGINE_FAILED, .reason = "it was not asked for"}};
    for (int k = 0; k <= (int)last; k++) {
        replicates_summarise(&plan, job->results + (size_t)k * job->n_records, &sum);
        out[k].device = job->device[k];
        out[k].outcome = sum.outcome;
        memcpy(out[k].value, sum.mean, sizeof out[k].value);
        out[k].first = job->results[(size_t)k * job->n_records];
    }
}

Status baselines_find(const Problem *p, const double x[], BaselineKind last, Baseline out[N_BASELINES], Err *err)
{
    const Tower *t = tower_of(p);
    const size_t n = N_BASELINES * tower_n_records(t);
    Job job = {.tower = t,
               .x = x,
               .n_records = tower_n_records(t),
               .results = calloc(n, sizeof *job.results),
               .status = calloc(n, sizeof *job.status),
               .why = calloc(n, sizeof *job.why)};
    Status status = job.results && job.status && job.why ? simulate_all(&job, BASELINE_NO_CORE, BASELINE_NO_CORE, err)
                                                         : fail(err, STATUS_NO_MEMORY, "no memory for baselines");
    if (status == STATUS_OK && last > BASELINE_RIGID)
        status = tune_all(&job, err);
    if (status == STATUS_OK)
        status = simulate_all(&job, BASELINE_RIGID, last, err);
    if (status == STATUS_OK)
        summarise(&job, last, out);
    free(job.results);
    free(job.status);
    free(job.why);
    return status;
}
