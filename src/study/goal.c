#include "study/goal.h"

#include <math.h>

double goal_value(const Goal *goal, size_t n_obj, const double f[])
{
    double value = 0.0;
    for (size_t k = 0; k < n_obj; k++)
        value += goal->weight[k] * f[k];
    return value;
}

int goal_holds(const Goal *goal, const Problem *problem, const double f[], const double g[])
{
    for (size_t k = 0; k < problem->n_obj; k++)
        if (!isfinite(f[k]) || f[k] > goal->bound[k])
            return 0;
    for (size_t c = 0; c < problem->n_con; c++)
        if (!(g[c] <= 0.0))
            return 0;
    return 1;
}
