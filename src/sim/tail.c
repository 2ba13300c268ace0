#include "sim/tail.h"

#include "sim/flow.h"

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
    const double *a = motion->accel;
    double *work, sum = 0, most = 0; /* in the step before sample k, of all modes */
    TRY_ROOM(work, motion->n, "samples", err);
    for (int i = 0; i < b->n; i++) {
        double c[FLOW_ROWS], q = 0, v = 0, f0 = push(b, motion, i, motion->n - 1);
        const double *of_q = c + FLOW_Q, *of_v = c + FLOW_V, *of_mean = c + FLOW_I;
        flow_coefficients(1, &b->omega[i], &b->zeta[i], motion->dt_s, c, 1);
        for (size_t k = motion->n - 1; k > 0; k--) {
            /* The load p0 + p1 x moves the mode on from (q, v), and does work on it. */
            const double f1 = push(b, motion, i, k - 1);
            const double p0 = -b->gamma[i] * a[k] + f0, p1 = -b->gamma[i] * (a[k - 1] - a[k]) + (f1 - f0);
            const double q1 = of_q[0] * q + of_q[1] * v + of_q[2] * p0 + of_q[3] * p1;
            const double mean = of_mean[0] * q + of_mean[1] * v + of_mean[2] * p0 + of_mean[3] * p1;
            work[k - 1] += (p0 + p1) * q1 - p0 * q - p1 * mean;
            v = of_v[0] * q + of_v[1] * v + of_v[2] * p0 + of_v[3] * p1;
            q = q1;
            f0 = f1;
        }
    }
    input[motion->n - 1] = 0;
    for (size_t k = motion->n - 1; k > 0; k--) {
        sum += work[k - 1];
        most = fmax(most, sum);
        input[k - 1] = most;
    }
    free(work);
    return STATUS_OK;
}
