#include "analysis/estimate.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "settings/options.h"
#include "sim/fast/fast.h"
#include "sim/sim.h"

int estimate_options(const SimOptions *o, SimOptions *finer)
{
    const double steps = sim_steps_per_contact(o);
    *finer = *o;
    finer->steps_per_contact = 2 * (steps > 0 ? steps : fast_tolerances(o->accuracy).steps_per_contact);
    return o->engine == ENGINE_FAST;
}

void estimate_errors(const SimResult *result, const SimResult *finer, double error[])
{
    const int known = result->outcome == RUN_OK && finer->outcome == RUN_OK;
    for (int k = 0; k < N_MEASURES; k++)
        error[k] = known ? ESTIMATE_FACTOR * fabs(measure_value(result, k) - measure_value(finer, k)) : NAN;
}

Status estimate_designs(const Settings *s, size_t n, const SimTask tasks[], const SimResult results[], double error[],
                        Err *err)
{
    Settings finer = *s;
    Problem p;
    SimResult *again = calloc(n, sizeof *again);
    if (!again)
        return fail(err, STATUS_NO_MEMORY, "no memory for the estimated errors of %zu simulations", n);
    estimate_options(&s->sim, &finer.sim);
    Status status = tower_open(&p, &finer, TOWER_SINGLE, n, err);
    if (status == STATUS_OK) {
        status = tower_simulate(&p, n, tasks, again, err);
        problem_close(&p);
    }
    for (size_t i = 0; i < n && status == STATUS_OK; i++)
        estimate_errors(&results[i], &again[i], error + i * N_MEASURES);
    free(again);
    return status;
}
