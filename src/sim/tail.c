#include "sim/tail.h"

#include <math.h>
#include <stdlib.h>

#include "sim/flow.h"

/* Work [J] of the ground on a mode over one step from (q, v), which it moves on. c: of the mode alone. */
static double ground_step(const double c[FLOW_ROWS], double gamma, double a0, double a1, double *q, double *v)
{
    const double p0 = -gamma * a0, p1 = -gamma * (a1 - a0), q0 = *q, v0 = *v;
    const double q1 = c[FLOW_Q] * q0 + c[FLOW_Q + 1] * v0 + c[FLOW_Q + 2] * p0 + c[FLOW_Q + 3] * p1;
    const double mean = c[FLOW_I] * q0 + c[FLOW_I + 1] * v0 + c[FLOW_I + 2] * p0 + c[FLOW_I + 3] * p1;
    *v = c[FLOW_V] * q0 + c[FLOW_V + 1] * v0 + c[FLOW_V + 2] * p0 + c[FLOW_V + 3] * p1;
    *q = q1;
    return (p0 + p1) * q1 - p0 * q0 - p1 * mean;
}

Status tail_input(const BuildingModel *b, const Motion *motion, double input[], Err *err)
{
    double *work = calloc(motion->n, sizeof *work); /* in the step before sample k, of all modes */
    if (!work)
        return fail(err, STATUS_NO_MEMORY, "%s: no memory for %zu samples", motion->name, motion->n);
    for (int i = 0; i < b->n; i++) {
        double c[FLOW_ROWS], q = 0, v = 0;
        flow_coefficients(1, &b->omega[i], &b->zeta[i], motion->dt_s, c, 1);
        for (size_t k = motion->n - 1; k > 0; k--)
            work[k - 1] += ground_step(c, b->gamma[i], motion->accel[k], motion->accel[k - 1], &q, &v);
    }
    double sum = 0, most = 0;
    input[motion->n - 1] = 0;
    for (size_t k = motion->n - 1; k > 0; k--) {
        sum += work[k - 1];
        most = fmax(most, sum);
        input[k - 1] = most;
    }
    free(work);
    return STATUS_OK;
}
