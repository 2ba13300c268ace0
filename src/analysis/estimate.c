#include "analysis/estimate.h"

#include <math.h>
#include <stdlib.h>

void estimate_errors(const Measured *result, const Measured *finer, double error[])
{
    const int known = result->outcome == RUN_OK && finer->outcome == RUN_OK;
    for (int k = 0; k < N_MEASURES; k++)
        error[k] = known ? fabs(result->value[k] - finer->value[k]) : NAN;
}

Status estimate_designs(const Problem *p, size_t n, const SimTask tasks[], const SimResult results[], double error[],
                        Err *err)
{
    Measured *again = calloc(n, sizeof *again);
    SimTask *finer = calloc(n, sizeof *finer);
    for (size_t i = 0; finer && i < n; i++)
        finer[i] = (SimTask){
            .kind = tasks[i].kind, .x = tasks[i].x, .scene = tasks[i].scene, .is_finer = 1, .parts = &again[i]};
    const Status status = again && finer
                              ? tower_run(p, n, finer, NULL, NULL, err)
                              : fail(err, STATUS_NO_MEMORY, "no memory for the estimated errors of %zu simulations", n);
    for (size_t i = 0; i < n && status == STATUS_OK; i++) {
        const Measured as_set = measured(&results[i]);
        estimate_errors(&as_set, &again[i], error + i * N_MEASURES);
    }
    free(again);
    free(finer);
    return status;
}
