#include "moga/normalisation.h"

#include <float.h>
#include <lapacke.h>

/* Best and worst of each objective; width = worst - best, 1 where all are equal. */
void normalisation_fit_range(Normalisation *q, size_t n, const size_t list[], const double F[])
{
    const size_t m = q->n_obj;
    for (size_t k = 0; k < m; k++) {
        double min = DBL_MAX, max = -DBL_MAX;
        for (size_t i = 0; i < n; i++) {
            min = fmin(min, F[list[i] * m + k]);
            max = fmax(max, F[list[i] * m + k]);
        }
        q->ideal[k] = min;
        q->width[k] = max > min ? max - min : 1.0;
    }
}

/* 1 / w_j of the achievement function off the axis: Deb and Jain 2014, section IV.C. A plane that cuts an axis nearer
 * than this is none: its intercepts are rounding. */
static const double OFF_AXIS = 1e6;

void normalisation_fit(Normalisation *q, size_t n, const size_t list[], const double F[])
{
    const size_t m = q->n_obj;
    double *b = q->plane + m * m;
    normalisation_fit_range(q, n, list, F);

    /* Extreme point of axis k: it minimises the achievement function max_j z_j / w_j with w = 1 on the axis. */
    for (size_t k = 0; k < m; k++) {
        double min = INFINITY;
        size_t extreme = *list;
        for (size_t i = 0; i < n; i++) {
            double worst = 0.0;
            for (size_t j = 0; j < m && worst < min; j++) {
                const double z = normalised(q, j, F[list[i] * m + j]) * (j == k ? 1.0 : OFF_AXIS);
                worst = MAX_OF(z, worst);
            }
            if (worst < min) {
                min = worst;
                extreme = list[i];
            }
        }
        for (size_t j = 0; j < m; j++)
            q->plane[j * m + k] = normalised(q, j, F[extreme * m + j]);
        b[k] = 1.0;
    }
    if (LAPACKE_dgesv_work(LAPACK_COL_MAJOR, (int)m, 1, q->plane, (int)m, q->pivot, b, (int)m) != 0)
        return;
    for (size_t k = 0; k < m; k++) /* the plane sum_k z_k b_k = 1 cuts axis k at 1 / b_k, in units of the box */
        if (!(b[k] < OFF_AXIS && b[k] > 0.0))
            return;
    for (size_t k = 0; k < m; k++)
        q->width[k] *= fmin(1.0 / b[k], 1.0);
}
