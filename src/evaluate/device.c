#include "evaluate/device.h"

#include <nlopt.h>

enum { GRID_HZ = 13, GRID_DAMPING = 5, GRID_LINKS = 15, SIMPLEX_EVALS = 40 };
static const double ARIAS = 0.995, PERIODS = 3;

/* The box of a device: tuned mass: frequency over that of the building, damping ratio; links: constant over m w_1 of
 * a mean floor. */
static const double HZ_MIN = 0.4, HZ_MAX = 3.2, DAMPING_MIN = 0.01, DAMPING_MAX = 1, LINK_MIN = 1e-3, LINK_MAX = 1e4;

LinearDevice warburton_device(double hz, double mu)
{
    return (LinearDevice){.tmd_hz = hz * sqrt(1 - 0.5 * fmin(mu, 1)) / (1 + mu),
                          .tmd_damping =
                              sqrt(mu * (1 - 0.25 * fmin(mu, 1)) / (4 * (1 + mu) * (1 - 0.5 * fmin(mu, 1))))};
}

typedef struct {
    const ReplicatePlan *plan;
    const Shaken *at;
    SceneKind scene;
    const double *x;
    double no_core[3];
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
static void combine(const ReplicatePlan *plan, const Measured of[], double J[3])
{
    ReplicateSummary sum;
    replicates_summarise(plan, of, sizeof *of, &sum);
    J[0] = sum.mean[MEASURE_J1];
    J[1] = sum.mean[MEASURE_J2];
    J[2] = sum.mean[MEASURE_J3];
}

static double goal_of(Tuning *t, const LinearDevice *device)
{
    Measured of[TOWER_RECORDS_MAX];
    SimResult result;
    double J[3], goal = 0;
    for (size_t r = 0; r < t->plan->n_records && t->status == STATUS_OK; r++) {
        sim_worker_device(t->at[r].worker, device);
        t->status = sim_run(t->at[r].worker, t->scene, t->x, &result, t->err);
        of[r] = measured(&result);
    }
    if (t->status != STATUS_OK)
        return INFINITY;
    combine(t->plan, of, J);
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

double device_strong_part(const Motion *m, double period)
{
    double whole = 0, sum = 0;
    size_t k = 0;
    if (m->n_force > 0) /* they may come late, on a ground that is at rest */
        return motion_duration(m);
    for (size_t i = 0; i < m->n; i++)
        whole += m->accel[i] * m->accel[i];
    for (; k < m->n && sum < ARIAS * whole; k++)
        sum += m->accel[k] * m->accel[k];
    return (double)k * m->dt_s + PERIODS * period;
}

static void set_scales(Tuning *t)
{
    const Building *b = scene_building(t->at[0].scenario->scene);
    double mass = 0;
    for (int i = 0; i < b->n * b->n; i++)
        mass += b->M[i];
    t->hz = b->omega[0] / (2 * M_PI);
    t->link = mass / b->n * b->omega[0];
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
    const Building *b = scene_building(t->at[0].scenario->scene);
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

static Status find_no_core(Tuning *t, Err *err)
{
    Measured of[TOWER_RECORDS_MAX];
    SimResult result;
    for (size_t r = 0; r < t->plan->n_records; r++) {
        TRY(sim_run(t->at[r].worker, SCENE_NO_CORE, NULL, &result, err));
        of[r] = measured(&result);
    }
    combine(t->plan, of, t->no_core);
    return STATUS_OK;
}

static Status tune(Tuning *t, LinearDevice *device)
{
    double u[2] = {0.5, 0.5}, building[FLOORS_MAX], core[FLOORS_MAX], both[FLOORS_MAX], mass;
    TRY(scene_frequencies(t->at[0].scenario->scene, t->x, building, core, both, &mass, t->err));
    TRY(find_no_core(t, t->err));
    set_scales(t);
    search_grid(t, u);
    if (t->scene == SCENE_TMD)
        try_warburton(t, mass, u);
    search_simplex(t, u);
    *device = t->device;
    return t->status;
}

Status device_find(const ReplicatePlan *plan, size_t n, const Shaken at[], SceneKind kind, const double x[],
                   LinearDevice *device, Err *err)
{
    ReplicatePlan alone = *plan;
    Tuning t = {.plan = &alone, .at = at, .scene = kind, .x = x, .best = INFINITY, .err = err};
    alone.n_records = n;
    alone.n_replicates = 1;
    for (size_t r = 0; r < n; r++) {
        const double omega = scene_building(at[r].scenario->scene)->omega[0];
        sim_worker_until(at[r].worker, device_strong_part(&at[r].scenario->motion, 2 * M_PI / omega));
    }
    const Status status = tune(&t, device);
    for (size_t r = 0; r < n; r++)
        sim_worker_until(at[r].worker, INFINITY);
    return status;
}
