#include "problem/textbook.h"

#include <math.h>

void textbook_dtlz2(size_t n_var, size_t n_obj, const double x[], double f[])
{
    double g = 0.0;
    for (size_t d = n_obj - 1; d < n_var; d++)
        g += (x[d] - 0.5) * (x[d] - 0.5);
    for (size_t k = 0; k < n_obj; k++) {
        f[k] = 1.0 + g;
        for (size_t d = 0; d + k + 1 < n_obj; d++)
            f[k] *= cos(x[d] * M_PI_2);
        if (k > 0)
            f[k] *= sin(x[n_obj - 1 - k] * M_PI_2);
    }
}

/* Huband et al., table XI: A minima, hill size B, global minimum at C. */
static double s_multi(double y)
{
    static const double A = 30.0, B = 10.0, C = 0.35;
    const double off = fabs(y - C) / (2.0 * (floor(C - y) + C));
    const double t = (1.0 + cos((4.0 * A + 2.0) * M_PI * (0.5 - off)) + 4.0 * B * off * off) / (B + 2.0);
    return fmin(fmax(t, 0.0), 1.0);
}

static double mean_of(size_t first, size_t end, const double t[])
{
    double sum = 0.0;
    for (size_t i = first; i < end; i++)
        sum += t[i] / (double)(end - first);
    return sum;
}

size_t textbook_wfg4_position(size_t n_var, size_t n_obj)
{
    const size_t once = n_obj - 1;
    return 2 * once < n_var ? 2 * once : once;
}

void textbook_wfg4(size_t n_var, size_t n_obj, size_t n_position, const double z[], double f[])
{
    const size_t group = n_position / (n_obj - 1);
    double t[TEXTBOOK_VAR_MAX], p[TEXTBOOK_OBJ_MAX];
    for (size_t i = 0; i < n_var; i++)
        t[i] = s_multi(z[i] / (2.0 * (double)(i + 1)));
    for (size_t k = 0; k + 1 < n_obj; k++)
        p[k] = mean_of(k * group, (k + 1) * group, t);
    const double far = mean_of(n_position, n_var, t);
    for (size_t k = 0; k < n_obj; k++) {
        double h = 1.0;
        for (size_t d = 0; d + k + 1 < n_obj; d++)
            h *= sin(p[d] * M_PI_2);
        if (k > 0)
            h *= cos(p[n_obj - 1 - k] * M_PI_2);
        f[k] = far + 2.0 * (double)(k + 1) * h;
    }
}
