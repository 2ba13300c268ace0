#include <math.h>
#include <string.h>

#include "bench/sweep.h"
#include "evaluate/replicates.h"

enum { REPLICATES = 16, DESIGNS = 9 };

/* Of the six objectives that the errors are of; the mass has no spread. */
static double largest_spread(const ReplicateSummary *e)
{
    double largest = 0;
    for (int k = 0; k < PAPER_OBJECTIVES; k++)
        if (strcmp(measure(k)->name, "mcore_kg") != 0)
            largest = fmax(largest, e->sd[k] / fabs(e->mean[k]));
    return largest;
}

static Status spread_of(SimWorker *worker, int n, uint32_t design, double *spread, Err *err)
{
    const ReplicatePlan plan = {.n_records = 1, .n_replicates = REPLICATES};
    Measured parts[REPLICATES];
    ReplicateSummary e;
    SimResult result;
    for (size_t k = 0; k < REPLICATES; k++) {
        double x[FLOORS_MAX + 2];
        bench_irregular_gaps(design, n, x);
        replicate_design(1, k, 0, (size_t)n, x);
        x[n] = BENCH_WALL_BASE;
        x[n + 1] = BENCH_WALL_TOP;
        TRY(sim_run(worker, SCENE_IMPACT, x, &result, err));
        parts[k] = measured(&result);
    }
    replicates_summarise(&plan, parts, sizeof *parts, 0, &e);
    *spread = largest_spread(&e);
    return STATUS_OK;
}

Status sweep_find_noise(Sweep *s, const SceneOptions *settings, const Motion *motion, Err *err)
{
    double spread = 0;
    Scene *scene;
    SimWorker *worker = NULL;
    TRY(scene_create(&scene, settings, motion, err));
    Status status = sim_worker_create(&worker, scene, err);
    for (int k = 0; k < DESIGNS && status == STATUS_OK; k++) {
        status = spread_of(worker, scene_n_floors(scene), (uint32_t)k, &spread, err);
        s->noise = fmax(s->noise, spread);
    }
    sim_worker_free(worker);
    scene_free(scene);
    return status;
}
