#include <math.h>
#include <string.h>

#include "bench/sweep.h"
#include "simulator/ensemble.h"

enum { MEMBERS = 16, DESIGNS = 9 };

/* Of the six objectives that the errors are of; the mass has no spread. */
static double largest_spread(const Ensemble *e)
{
    double largest = 0;
    for (int k = 0; k < N_OBJECTIVES; k++)
        if (strcmp(measure(k)->name, "mcore_kg") != 0)
            largest = fmax(largest, e->spread[k] / fabs(e->mean[k]));
    return largest;
}

static Status spread_of(Crew *crew, int n, uint32_t design, double *spread, Err *err)
{
    double x[FLOORS_MAX + 2];
    Ensemble e;
    bench_irregular_gaps(design, n, x);
    x[n] = BENCH_WALL_BASE;
    x[n + 1] = BENCH_WALL_TOP;
    TRY(ensemble_run(crew, n, x, MEMBERS, ENSEMBLE_CHANGE, 1, &e, NULL, err));
    *spread = largest_spread(&e);
    return STATUS_OK;
}

Status sweep_find_noise(Sweep *s, const SceneOptions *settings, const Motion *motion, Err *err)
{
    double spread = 0;
    Scene *scene;
    Crew *crew = NULL;
    TRY(scene_create(&scene, settings, motion, err));
    Status status = crew_create(&crew, scene, 1, err);
    for (int k = 0; k < DESIGNS && status == STATUS_OK; k++) {
        status = spread_of(crew, scene_n_floors(scene), (uint32_t)k, &spread, err);
        s->noise = fmax(s->noise, spread);
    }
    crew_free(crew);
    scene_free(scene);
    return status;
}
