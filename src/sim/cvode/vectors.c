#include "sim/cvode/vectors.h"

#include <math.h>

#include "base/clones.h"

static double *values(N_Vector v)
{
    return NV_DATA_S(v);
}

CLONED static void add_scaled(long n, double a, const double x[], double b, const double y[], double z[])
{
#pragma GCC ivdep
    for (long i = 0; i < n; i++)
        z[i] = a * x[i] + b * y[i];
}

CLONED static void scale(long n, double c, const double x[], double z[])
{
#pragma GCC ivdep
    for (long i = 0; i < n; i++)
        z[i] = c * x[i];
}

/* z = sum_k c_k x_k, k < count <= 4 */
CLONED static void combine(long n, int count, const double c[], const double *const x[], double z[])
{
    switch (count) {
    case 1:
        scale(n, c[0], x[0], z);
        break;
    case 2:
        add_scaled(n, c[0], x[0], c[1], x[1], z);
        break;
    case 3:
#pragma GCC ivdep
        for (long i = 0; i < n; i++)
            z[i] = c[0] * x[0][i] + c[1] * x[1][i] + c[2] * x[2][i];
        break;
    default:
#pragma GCC ivdep
        for (long i = 0; i < n; i++)
            z[i] = c[0] * x[0][i] + c[1] * x[1][i] + c[2] * x[2][i] + c[3] * x[3][i];
    }
}

/* Eight partial sums, in the same order on every processor. */
CLONED static double weighted_square(long n, const double x[], const double w[])
{
    double sum[8] = {0};
    long i = 0;
    for (; i + 8 <= n; i += 8)
        for (int k = 0; k < 8; k++)
            sum[k] += (x[i + k] * w[i + k]) * (x[i + k] * w[i + k]);
    for (; i < n; i++)
        sum[0] += (x[i] * w[i]) * (x[i] * w[i]);
    return ((sum[0] + sum[4]) + (sum[1] + sum[5])) + ((sum[2] + sum[6]) + (sum[3] + sum[7]));
}

static void linear_sum(sunrealtype a, N_Vector x, sunrealtype b, N_Vector y, N_Vector z)
{
    add_scaled(NV_LENGTH_S(z), a, values(x), b, values(y), values(z));
}

static void scaled(sunrealtype c, N_Vector x, N_Vector z)
{
    scale(NV_LENGTH_S(z), c, values(x), values(z));
}

/* Z may be one of the X, but only the first (as SUNDIALS promises). */
static int linear_combination(int count, sunrealtype *c, N_Vector *X, N_Vector z)
{
    const long n = NV_LENGTH_S(z);
    const double *x[4];
    for (int first = 0; first < count;) {
        double factor[4];
        int k = 0;
        if (first > 0) {
            x[0] = values(z);
            factor[k++] = 1;
        }
        for (; k < 4 && first < count; k++, first++) {
            x[k] = values(X[first]);
            factor[k] = c[first];
        }
        combine(n, k, factor, x, values(z));
    }
    return 0;
}

static sunrealtype weighted_rms(N_Vector x, N_Vector weight)
{
    return sqrt(weighted_square(NV_LENGTH_S(x), values(x), values(weight)) / (double)NV_LENGTH_S(x));
}

void vectors_use_own_loops(N_Vector v)
{
    v->ops->nvlinearsum = linear_sum;
    v->ops->nvscale = scaled;
    v->ops->nvlinearcombination = linear_combination;
    v->ops->nvwrmsnorm = weighted_rms;
}
