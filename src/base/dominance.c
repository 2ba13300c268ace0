#include "base/dominance.h"

#include <stdint.h>
#include <stdlib.h>

int dominates(size_t n_obj, const double a[], const double b[])
{
    int better = 0;
    for (size_t k = 0; k < n_obj; k++) {
        if (!(a[k] <= b[k]))
            return 0;
        better |= a[k] < b[k];
    }
    return better;
}

int dominates_surely(size_t n_obj, const double a[], const double error_a[], const double b[], const double error_b[])
{
    int better = 0;
    for (size_t k = 0; k < n_obj; k++) {
        const double worst = a[k] + error_a[k], best = b[k] - error_b[k];
        if (!(worst <= best))
            return 0;
        better |= worst < best;
    }
    return better;
}

int dominates_constrained(size_t n_obj, const double a[], double violation_a, const double b[], double violation_b)
{
    if (violation_a > 0.0 || violation_b > 0.0)
        return violation_a < violation_b;
    return dominates(n_obj, a, b);
}

typedef struct {
    size_t n_obj;
    const double *F, *violation;
} Points;

static double violation_at(const Points *p, size_t i)
{
    return p->violation ? p->violation[i] : 0.0;
}

/* An order in which no point is dominated by a later one: violation, then objectives one after the other, then row. */
static int compare_points(const void *first, const void *second, void *points)
{
    const Points *p = points;
    const size_t a = *(const size_t *)first, b = *(const size_t *)second;
    if (violation_at(p, a) != violation_at(p, b))
        return violation_at(p, a) < violation_at(p, b) ? -1 : 1;
    for (size_t k = 0; k < p->n_obj; k++) {
        const double fa = p->F[a * p->n_obj + k], fb = p->F[b * p->n_obj + k];
        if (fa != fb)
            return fa < fb ? -1 : 1;
    }
    return (a > b) - (a < b);
}

/* Each point in turn goes into the first layer none of whose members dominates it; layers are linked lists. */
size_t nondominated_sort(size_t n, size_t n_obj, const double F[], const double violation[], size_t rank[],
                         size_t scratch[])
{
    Points points = {n_obj, F, violation};
    size_t *order = scratch, *head = scratch + n, *next = scratch + 2 * n, n_layers = 0;
    for (size_t i = 0; i < n; i++)
        order[i] = i;
    qsort_r(order, n, sizeof *order, compare_points, &points);
    for (size_t i = 0; i < n; i++) {
        const size_t a = order[i];
        size_t layer = 0;
        for (; layer < n_layers; layer++) {
            size_t b = head[layer];
            while (b != SIZE_MAX && !dominates_constrained(n_obj, F + b * n_obj, violation_at(&points, b),
                                                           F + a * n_obj, violation_at(&points, a)))
                b = next[b];
            if (b == SIZE_MAX)
                break;
        }
        if (layer == n_layers)
            head[n_layers++] = SIZE_MAX;
        next[a] = head[layer];
        head[layer] = a;
        rank[a] = layer;
    }
    return n_layers;
}
