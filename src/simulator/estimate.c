#include "simulator/estimate.h"

#include <math.h>

#include "sim/fast/fast.h"

int estimate_options(const SimOptions *o, SimOptions *finer)
{
    const double steps =
        o->steps_per_contact > 0 ? o->steps_per_contact : fast_tolerances(o->accuracy).steps_per_contact;
    *finer = *o;
    finer->steps_per_contact = 2 * steps;
    return o->engine == ENGINE_FAST;
}

void estimate_errors(const SimResult *result, const SimResult *finer, double error[])
{
    const int known = result->outcome == RUN_OK && finer->outcome == RUN_OK;
    for (int k = 0; k < N_MEASURES; k++)
        error[k] = known ? ESTIMATE_FACTOR * fabs(measure_value(result, k) - measure_value(finer, k)) : NAN;
}
