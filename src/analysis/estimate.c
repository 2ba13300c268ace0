#include "analysis/estimate.h"

#include "base/random.h"
#include "base/stat.h"

void estimate_errors(const Measured *result, const Measured *finer, double error[])
{
    const int known = result->outcome == RUN_OK && finer->outcome == RUN_OK;
    for (int k = 0; k < N_MEASURES; k++)
        error[k] = known ? fabs(result->value[k] - finer->value[k]) : NAN;
}

/* Runs of a design: with twice the steps, then with the gaps of each pattern. */
enum { AGAIN = 1 + ESTIMATE_PATTERNS };

/* moved (ESTIMATE_PATTERNS). */
static void spread(const Measured *result, const Measured moved[], double sd[])
{
    for (int k = 0; k < N_MEASURES; k++) {
        double v[AGAIN] = {result->outcome == RUN_OK ? result->value[k] : NAN}, mean;
        for (int i = 0; i < ESTIMATE_PATTERNS; i++)
            v[1 + i] = moved[i].outcome == RUN_OK ? moved[i].value[k] : NAN;
        mean_and_sd_of(AGAIN, v, &mean, &sd[k]);
    }
}

Status estimate_designs(const Problem *p, size_t n, const SimTask tasks[], const SimResult results[], double error[],
                        double sd[], Err *err)
{
    Measured *again = calloc(n * AGAIN, sizeof *again);
    SimTask *list = calloc(n * AGAIN, sizeof *list);
    double *x = calloc(n * ESTIMATE_PATTERNS * p->n_var, sizeof *x);
    size_t n_tasks = 0;
    for (size_t i = 0; again && list && x && i < n; i++) {
        const SimTask *task = &tasks[i];
        double *moved = x + i * ESTIMATE_PATTERNS * p->n_var;
        for (uint32_t k = 0; k < (sd && task->kind == SCENE_IMPACT ? AGAIN : 1); k++) {
            SimTask *once = &list[n_tasks++];
            *once = (SimTask){.kind = task->kind, .x = task->x, .scene = task->scene, .parts = &again[i * AGAIN + k]};
            once->level = k == 0;
            if (k == 0)
                continue;
            memcpy(moved, task->x, p->n_var * sizeof *moved);
            Random r = random_stream(1, RANDOM_GRAZING, k - 1, 0);
            for (int j = 0; j < tower_design(tower_of(p))->n_gaps; j++)
                moved[j] = fmax(0, moved[j] + (random_uniform(&r) < 0.5 ? -ESTIMATE_GAP_M : ESTIMATE_GAP_M));
            once->x = moved;
            moved += p->n_var;
        }
    }
    const Status status = n_tasks >= n
                              ? tower_run(p, n_tasks, list, NULL, NULL, err)
                              : fail(err, STATUS_NO_MEMORY, "no memory for the estimated errors of %zu simulations", n);
    for (size_t i = 0; i < n && status == STATUS_OK; i++) {
        const Measured as_set = measured(&results[i]), *runs = again + i * AGAIN;
        estimate_errors(&as_set, runs, error + i * N_MEASURES);
        for (int k = 0; sd && k < N_MEASURES; k++)
            sd[i * N_MEASURES + (size_t)k] = NAN;
        if (sd && tasks[i].kind == SCENE_IMPACT)
            spread(&as_set, runs + 1, sd + i * N_MEASURES);
    }
    free(again);
    free(list);
    free(x);
    return status;
}
