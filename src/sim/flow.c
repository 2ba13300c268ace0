#include "sim/flow.h"

#include <math.h>

void flow_integrals(double omega, double zeta, double h, double y[FLOW_INTEGRALS])
{
    enum { TERMS = 26, HIGH = FLOW_INTEGRALS - 1 };
    const double b = 2 * zeta * omega, c = omega * omega;
    /* Slow modes: the two highest integrals by power series in h, y_k = h^k sum_j G_j / (j + k)!, where G_j =
     * g_{j+1} h^j of the derivatives of g at 0 obeys G_{j+1} = -2 zeta w h G_j - (w h)^2 G_{j-1}, G_0 = 1; the others
     * by the recursion from above, which loses no digits here. */
    if (omega * h * (zeta > 1 ? 2 * zeta : 1) < 2) {
        double monomial[FLOW_INTEGRALS] = {1};                /* h^k/k! */
        double g = 1, g_before = 0, share = 1, sums[2] = {0}; /* share: (HIGH - 1)! / (j + HIGH - 1)! */
        for (int k = 1; k < FLOW_INTEGRALS; k++)
            monomial[k] = monomial[k - 1] * h / k;
        for (int j = 0; j < TERMS; j++) {
            sums[0] += g * share;
            share /= j + HIGH;
            sums[1] += g * share;
            const double g_next = -b * h * g - c * h * h * g_before;
            g_before = g;
            g = g_next;
        }
        y[HIGH - 1] = monomial[HIGH - 1] * sums[0];
        y[HIGH] = monomial[HIGH - 1] * h * sums[1];
        for (int k = HIGH - 2; k >= 0; k--)
            y[k] = monomial[k] - b * y[k + 1] - c * y[k + 2];
        return;
    }

    /* The others: g and its derivative in closed form, sin(sqrt(z))/sqrt(z) continued to sinh for z < 0; where sinh
     * would overflow, far above critical damping, two real exponentials. The integrals by the recursion from below. */
    const double decay = zeta * omega, wd2 = c * (1 - zeta * zeta), z = wd2 * h * h, angle = sqrt(fabs(z));
    if (z < -400) {
        const double root = sqrt(-wd2), slow = c / (decay + root), fast = decay + root;
        y[1] = (exp(-slow * h) - exp(-fast * h)) / (2 * root);
        y[0] = (fast * exp(-fast * h) - slow * exp(-slow * h)) / (2 * root);
    } else {
        const double e = exp(-decay * h), ratio = fabs(z) < 1e-2
                                                      ? 1 - z / 6 * (1 - z / 20 * (1 - z / 42 * (1 - z / 72)))
                                                  : z > 0 ? sin(angle) / angle
                                                          : sinh(angle) / angle;
        y[1] = e * h * ratio;
        y[0] = e * (z > 0 ? cos(angle) : cosh(angle)) - decay * y[1];
    }
    double monomial = 1;
    for (int k = 0; k + 2 < FLOW_INTEGRALS; k++) {
        y[k + 2] = (monomial - y[k] - b * y[k + 1]) / c;
        monomial *= h / (k + 1);
    }
}

void flow_coefficients(size_t n, const double omega[], const double zeta[], double h, double coef[], size_t stride)
{
    for (size_t i = 0; i < n; i++) {
        double y[FLOW_INTEGRALS];
        flow_integrals(omega[i], zeta[i], h, y);
        const double b = 2 * zeta[i] * omega[i], c = omega[i] * omega[i];
        const double row[FLOW_ROWS] = {
            y[0] + b * y[1],
            y[1],
            y[2],
            y[3] / h,
            2 * y[4] / (h * h),
            -c * y[1],
            y[0],
            y[1],
            y[2] / h,
            2 * y[3] / (h * h),
            (y[1] + b * y[2]) / h,
            y[2] / h,
            y[3] / h,
            y[4] / (h * h),
            2 * y[5] / (h * h * h),
        };
        for (int k = 0; k < FLOW_K; k++)
            coef[(size_t)k * stride + i] = row[k];
        /* int x q = int q - (1/h) int int q, and the double integral is one index further on */
        const double twice[5] = {(y[2] + b * y[3]) / h, y[3] / h, y[4] / h, y[5] / (h * h), 2 * y[6] / (h * h * h)};
        for (int k = 0; k < 5; k++)
            coef[(size_t)(FLOW_K + k) * stride + i] = row[FLOW_I + k] - twice[k] / h;
    }
}
