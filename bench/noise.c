#include <math.h>
#include <string.h>

#include "bench/sweep.h"
#include "evaluate/tower.h"

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

static Status spread_of(const Problem *p, int n, uint32_t design, double *spread, Err *err)
{
    double x[FLOORS_MAX + 2];
    ReplicateSummary e;
    SimResult shown;
    bench_irregular_gaps(design, n, x);
    x[n] = BENCH_WALL_BASE;
    x[n + 1] = BENCH_WALL_TOP;
    TRY(tower_replicate(p, 1, x, &shown, &e, err));
    *spread = largest_spread(&e);
    return STATUS_OK;
}

Status sweep_find_noise(Sweep *s, const SceneOptions *settings, const Motion *motion, Err *err)
{
    double spread = 0;
    Scene *scene;
    Problem p = {0};
    TRY(scene_create(&scene, settings, motion, err));
    Status status = tower_open_scene(&p, scene, REPLICATES, 1, 1, err);
    for (int k = 0; k < DESIGNS && status == STATUS_OK; k++) {
        status = spread_of(&p, scene_n_floors(scene), (uint32_t)k, &spread, err);
        s->noise = fmax(s->noise, spread);
    }
    problem_close(&p);
    scene_free(scene);
    return status;
}
