#include "sim/tail.h"

#include "sim/flow.h"

/* Work [J] of the load p0 + p1 x on a mode over one step from (q, v), which it moves on. c: of the mode alone. */
static double load_step(const double c[FLOW_ROWS], double p0, double p1, double *q, double *v)
{
    const double q0 = *q, v0 = *v;
    const double q1 = c[FLOW_Q] * q0 + c[FLOW_Q + 1] * v0 + c[FLOW_Q + 2] * p0 + c[FLOW_Q + 3] * p1;
    const double mean = c[FLOW_I] * q0 + c[FLOW_I + 1] * v0 + c[FLOW_I + 2] * p0 + c[FLOW_I + 3] * p1;
    *v = c[FLOW_V] * q0 + c[FLOW_V + 1] * v0 + c[FLOW_V + 2] * p0 + c[FLOW_V + 3] * p1;
    *q = q1;
    return (p0 + p1) * q1 - p0 * q0 - p1 * mean;
}

/* Of the forces on the floors, on mode i at sample k. */
static double push(const BuildingModel *b, const Motion *motion, int i, size_t k)
{
    double sum = 0;
    for (int j = 0; j < motion->n_force; j++)
        sum += b->phi[j * b->n + i] * motion->force[k * (size_t)motion->n_force + (size_t)j];
    return sum;
}

Status tail_input(const BuildingModel *b, const Motion *motion, double input[], Err *err)
{
    double *work = calloc(motion->n, sizeof *work); /* in the step before sample k, of all modes */
    if (!work)
        return fail_memory(err, motion->n, "samples");
    for (int i = 0; i < b->n; i++) {
        double c[FLOW_ROWS], q = 0, v = 0;
        flow_coefficients(1, &b->omega[i], &b->zeta[i], motion->dt_s, c, 1);
        for (size_t k = motion->n - 1; k > 0; k--) {
            const double f0 = push(b, motion, i, k), f1 = push(b, motion, i, k - 1);
            work[k - 1] += load_step(c, -b->gamma[i] * motion->accel[k] + f0,
                                     -b->gamma[i] * (motion->accel[k - 1] - motion->accel[k]) + (f1 - f0), &q, &v);
        }
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
