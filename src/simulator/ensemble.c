#include "simulator/ensemble.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/random.h"

/* Welford's running mean and sum of squares. */
static void add_member(Ensemble *e, double squares[N_MEASURES], const SimResult *r)
{
    e->finished++;
    for (int k = 0; k < N_MEASURES; k++) {
        const double value = measure_value(r, k), before = value - e->mean[k];
        e->mean[k] += before / e->finished;
        squares[k] += before * (value - e->mean[k]);
    }
}

static void summarise(int members, const SimResult results[], Ensemble *out)
{
    double squares[N_MEASURES] = {0};
    *out = (Ensemble){.members = members};
    for (int i = 0; i < members; i++)
        if (results[i].outcome == RUN_OK)
            add_member(out, squares, &results[i]);
    for (int k = 0; k < N_MEASURES; k++) {
        out->spread[k] = out->finished > 1 ? sqrt(squares[k] / (out->finished - 1)) : NAN;
        if (out->finished == 0)
            out->mean[k] = NAN;
    }
}

Status ensemble_run(Crew *crew, int n_floors, const double x[], int members, double change, uint32_t seed,
                    Ensemble *out, SimResult *first, Err *err)
{
    const size_t n = (size_t)members, n_var = (size_t)n_floors + 2;
    double *X = calloc(n, n_var * sizeof *X);
    SimTask *tasks = calloc(n, sizeof *tasks);
    SimResult *results = calloc(n, sizeof *results);
    Status status = STATUS_NO_MEMORY;
    if (!X || !tasks || !results) {
        fail(err, status, "no memory for an ensemble of %d", members);
        goto done;
    }
    for (size_t k = 0; k < n; k++) {
        Random r = random_stream(seed, RANDOM_ENSEMBLE, 0, (uint32_t)k);
        memcpy(X + k * n_var, x, n_var * sizeof *X);
        for (int j = 0; k > 0 && j < n_floors; j++)
            X[k * n_var + (size_t)j] *= 1 + change * random_normal(&r);
        tasks[k] = (SimTask){SCENE_IMPACT, X + k * n_var};
    }
    status = crew_run(crew, n, tasks, results, err);
    if (status == STATUS_OK) {
        summarise(members, results, out);
        if (first)
            *first = results[0];
    }
done:
    free(X);
    free(tasks);
    free(results);
    return status;
}
