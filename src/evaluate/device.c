#include "evaluate/device.h"

/* Points of the first grid, for which SUITE records are enough; how many finer ones. */
enum { GRID_HZ = 13, GRID_DAMPING = 5, GRID_LINKS = 15, FINER = 4, SUITE = 4 };
enum { POINTS_MAX = GRID_HZ * GRID_DAMPING + 1 };

/* The box of a device: tuned mass: frequency over that of the building, damping ratio; links: constant over m w_1 of
 * a mean floor. */
static const double HZ_MIN = 0.4, HZ_MAX = 3.2, DAMPING_MIN = 0.01, DAMPING_MAX = 1, LINK_MIN = 1e-3, LINK_MAX = 1e4;

LinearDevice warburton_device(double hz, double mu)
{
    const double share = fmin(mu, 1);
    return (LinearDevice){.tmd_hz = hz * sqrt(1 - 0.5 * share) / (1 + mu),
                          .tmd_damping = sqrt(mu * (1 - 0.25 * share) / (4 * (1 + mu) * (1 - 0.5 * share)))};
}

/* Points in the unit square, by logarithms. */
typedef struct {
    const Tower *tower;
    const Scenario *scenario; /* under the first record */
    DeviceSearch *search;
    SceneKind kind;  /* that is simulated now: the building alone, then that of the search */
    double hz, link; /* of the building; m w_1 of a mean floor */
    size_t n_records, record[TOWER_RECORDS_MAX];
    double no_core[3]; /* under all records */
    double best[2], spacing[2], least;
    size_t n;
    double at[POINTS_MAX][2];
} Tuning;

static LinearDevice device_at(const Tuning *t, const double u[2])
{
    if (t->search->kind == SCENE_LINKS)
        return (LinearDevice){.link_ns_m = t->link * LINK_MIN * pow(LINK_MAX / LINK_MIN, u[0])};
    return (LinearDevice){.tmd_hz = t->hz * HZ_MIN * pow(HZ_MAX / HZ_MIN, u[0]),
                          .tmd_damping = DAMPING_MIN * pow(DAMPING_MAX / DAMPING_MIN, u[1])};
}

/* J1, J2, J3 over n records by the rule; returns their goal. */
static double combine(const Tuning *t, size_t n, const Measured of[], double J[3])
{
    const ReplicatePlan plan = tower_plan(t->tower, n);
    ReplicateSummary sum;
    replicates_summarise(&plan, of, sizeof *of, 0, &sum);
    copy_values(3, &sum.mean[MEASURE_J1], J);
    return J[0] / t->no_core[0] + J[1] / t->no_core[1] + J[2] / t->no_core[2];
}

static void use_all_records(Tuning *t)
{
    t->n_records = tower_n_records(t->tower);
    for (size_t r = 0; r < t->n_records; r++)
        t->record[r] = r;
    t->least = INFINITY;
}

/* -- the points of a grid ------------------------------------------------------------------------------------------ */

static void add_point(Tuning *t, double u0, double u1)
{
    t->at[t->n][0] = fmin(fmax(u0, 0), 1);
    t->at[t->n++][1] = fmin(fmax(u1, 0), 1);
}

/* The first grid, over all of the square; for a tuned mass with Warburton's device for the first mode, whose shape says
 * which share of the mass the roof sees. */
static Status begin(Tuning *t, Err *err)
{
    const Scene *scene = t->scenario->scene;
    const Building *b = scene_building(scene);
    const int is_tmd = t->search->kind == SCENE_TMD, n = is_tmd ? GRID_HZ : GRID_LINKS;
    const int rows = is_tmd ? GRID_DAMPING : 1;
    SceneModes modes;
    double mass = 0;
    for (int i = 0; i < b->n * b->n; i++)
        mass += b->M[i];
    t->hz = b->omega[0] / (2 * M_PI);
    t->link = mass / b->n * b->omega[0];
    t->kind = t->search->kind;
    t->n = 0;
    t->best[0] = t->best[1] = 0.5;
    t->spacing[0] = 1.0 / n;
    t->spacing[1] = 1.0 / rows;
    for (int i = 0; i < n; i++)
        for (int k = 0; k < rows; k++)
            add_point(t, (i + 0.5) / n, (k + 0.5) / rows);
    if (!is_tmd)
        return STATUS_OK;
    TRY(scene_frequencies(scene, t->search->x, &modes, err));
    const double roof = b->phi[(b->n - 1) * b->n];
    const LinearDevice d = warburton_device(t->hz, modes.core_mass_kg * roof * roof);
    add_point(t, log(d.tmd_hz / (t->hz * HZ_MIN)) / log(HZ_MAX / HZ_MIN),
              log(d.tmd_damping / DAMPING_MIN) / log(DAMPING_MAX / DAMPING_MIN));
    return STATUS_OK;
}

/* -- what simulations say ------------------------------------------------------------------------------------------ */

/* Choose the records of the first grid by the building alone, of (n_records) all: of many the strongest, and others
 * evenly spread by their strength. */
static void choose_records(Tuning *t, const Measured of[])
{
    const size_t n = t->n_records;
    double goal[TOWER_RECORDS_MAX], J[3];
    combine(t, n, of, t->no_core);
    for (size_t r = 0; r < n; r++)
        goal[r] = of[r].outcome == RUN_OK ? combine(t, 1, &of[r], J) : INFINITY;
    t->n_records = 0;
    for (size_t r = 0; r < n; r++) {
        size_t n_stronger = 0;
        int counts = n <= SUITE;
        for (size_t s = 0; s < n; s++)
            n_stronger += goal[s] > goal[r] || (s < r && !(goal[s] < goal[r]));
        for (size_t k = 0; k < SUITE; k++)
            counts |= n_stronger == k * n / SUITE;
        if (counts)
            t->record[t->n_records++] = r;
    }
}

/* Simulate every point under every record; of the building alone that chooses the records, of devices the best
 * point. */
static Status simulate(const Problem *p, size_t n, Tuning tuning[], Err *err)
{
    size_t n_tasks = 0, k = 0;
    for (size_t i = 0; i < n; i++)
        n_tasks += tuning[i].n * tuning[i].n_records;
    SimTask *tasks = malloc(n_tasks * sizeof *tasks);
    Measured *of = malloc(n_tasks * sizeof *of);
    for (size_t i = 0; tasks && of && i < n; i++) {
        const Tuning *t = &tuning[i];
        for (size_t j = 0; j < t->n * t->n_records; j++, k++)
            tasks[k] = (SimTask){.kind = t->kind,
                                 .x = t->search->x,
                                 .device = device_at(t, t->at[j / t->n_records]),
                                 .scene = t->search->scene + t->record[j % t->n_records],
                                 .is_brief = 1,
                                 .parts = &of[k]};
    }
    const Status status =
        tasks && of ? tower_run(p, n_tasks, tasks, NULL, NULL, err) : fail_memory(err, n_tasks, "simulations");
    const Measured *own = of;
    for (size_t i = 0; status == STATUS_OK && i < n; i++) {
        Tuning *t = &tuning[i];
        if (t->kind == SCENE_NO_CORE) {
            own += t->n_records;
            choose_records(t, own - t->n_records);
            continue;
        }
        for (size_t j = 0; j < t->n; j++, own += t->n_records) {
            double J[3];
            const double goal = combine(t, t->n_records, own, J);
            if (goal < t->least) {
                t->least = goal;
                memcpy(t->best, t->at[j], sizeof t->best);
            }
        }
    }
    free(tasks);
    free(of);
    return status;
}

Status devices_find(const Problem *p, size_t n, DeviceSearch search[], Err *err)
{
    const int by_few = tower_n_records(tower_of(p)) > SUITE;
    Tuning *tuning;
    Status status = STATUS_OK;
    size_t n_acquired = 0;
    TRY_ROOM(tuning, n, "devices", err);
    for (size_t i = 0; i < n && status == STATUS_OK; i++) {
        Tuning *t = &tuning[i];
        *t = (Tuning){.tower = tower_of(p), .search = &search[i], .n = 1, .kind = SCENE_NO_CORE};
        use_all_records(t);
        status = tower_acquire(p->self, search[i].scene, &t->scenario, err);
        n_acquired += status == STATUS_OK;
    }

    /* The building alone, the first grid, and finer ones, the first of them by all records where few were chosen. */
    THEN(status, simulate(p, n, tuning, err));
    for (size_t i = 0; i < n && status == STATUS_OK; i++)
        status = begin(&tuning[i], err);
    THEN(status, simulate(p, n, tuning, err));
    for (int grid = -by_few; grid < FINER && status == STATUS_OK; grid++) {
        /* About the best point, half as far as before; where that is known by few records alone, as far, and itself, by
         * all. */
        const int by_all = grid < 0;
        for (Tuning *t = tuning; t < tuning + n; t++) {
            const int rows = t->search->kind == SCENE_TMD;
            if (by_all)
                use_all_records(t);
            t->n = 0;
            for (int d = 0; d < 2; d++)
                t->spacing[d] *= by_all ? 1 : 0.5;
            for (int i = -1; i <= 1; i++)
                for (int k = -rows; k <= rows; k++)
                    if (i || k || by_all)
                        add_point(t, t->best[0] + i * t->spacing[0], t->best[1] + k * t->spacing[1]);
        }
        status = simulate(p, n, tuning, err);
    }
    for (size_t i = 0; i < n && status == STATUS_OK; i++)
        search[i].device = device_at(&tuning[i], tuning[i].best);
    for (size_t i = 0; i < n_acquired; i++)
        tower_release(p->self, search[i].scene);
    free(tuning);
    return status;
}
