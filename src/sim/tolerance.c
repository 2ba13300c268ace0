#include "sim/tolerance.h"

#include <math.h>
#include <string.h>

#include "base/list.h"

/* Standard deviation of a gap [m], relative standard deviation of J3. */
static const double AS_BUILT[][2] = {{1e-5, 1.4e-3}, {1e-4, 9e-3}, {1e-3, 5.6e-2}, {5e-3, 0.10}, {1e-2, 0.15}};
enum { N_AS_BUILT = sizeof AS_BUILT / sizeof AS_BUILT[0] };

static const double TOLERANCE_MIN = 1e-6, TOLERANCE_MAX = 0.2;

double tolerance_as_built(double gap_tolerance_m)
{
    if (!(gap_tolerance_m > 0))
        return 0;
    int i = 0;
    while (i + 2 < N_AS_BUILT && gap_tolerance_m > AS_BUILT[i + 1][0])
        i++;
    const double slope = log(AS_BUILT[i + 1][1] / AS_BUILT[i][1]) / log(AS_BUILT[i + 1][0] / AS_BUILT[i][0]);
    const double spread = AS_BUILT[i][1] * pow(gap_tolerance_m / AS_BUILT[i][0], slope);
    return fmin(fmax(0.1 * spread, TOLERANCE_MIN), TOLERANCE_MAX);
}

Status tolerance_steps(const SimOptions *o, double *steps, Err *err)
{
    *steps = 0;
    if (!o->tolerance[0] || !list_is_given(o->tolerance))
        return STATUS_OK;
    if (o->steps_per_contact > 0)
        return fail(err, STATUS_BAD_DATA, "sim.tolerance: chooses the steps; leave sim.steps_per_contact at 0");
    double tolerance = tolerance_as_built(o->gap_tolerance_m);
    if (strcmp(o->tolerance, "auto") != 0)
        TRY(list_positive(o->tolerance, 0, "sim.tolerance", &tolerance, err));
    else if (tolerance == 0)
        return STATUS_OK;
    if (!(tolerance >= TOLERANCE_MIN && tolerance <= TOLERANCE_MAX))
        return fail(err, STATUS_BAD_DATA, "sim.tolerance: %g is not between %g and %g", tolerance, TOLERANCE_MIN,
                    TOLERANCE_MAX);
    *steps = 2 * pow(0.01 / tolerance, 2.0 / 3);
    return STATUS_OK;
}
