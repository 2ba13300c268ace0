/* scene/uplift.h -- a core on a rotational spring whose mat may lift: what it adds to the core on its linear springs.
 *
 *   M = K theta up to theta_up, beyond it M = sign M_up (3 - 2 sqrt(theta_up / |theta|)),  M_up = K theta_up
 *
 * elastic, without hysteresis: a rigid disc held down by its load (Wolf 1976). The mat has no mass, so that theta follows
 * from the nodes v of the core at every instant. With Kc its stiffness while the mat does not turn, z the heights,
 * a = z' Kc z and d = z' Kc v / (K + a), the rotation on the linear spring,
 *
 *   M(theta) + a theta = (K + a) d,   force on the nodes  -K_lin v - (d theta_lin/dv) F,  F = (K + a) (d - theta)
 *
 * one nonlinear spring of the force F(d) along d. Its energy H(d) = int F dd is negative: the modes hold too much.
 *
 * Threads  pure functions
 * Source   J. P. Wolf, Nucl. Eng. Des. 38 (1976) 357-384 */
#pragma once

#include <math.h>

typedef struct {
    double theta_up, rotation; /* [rad] 0: it never lifts; [N m/rad] K */
    double ratio;              /* [-] a / K */
} Uplift;

/* |theta| / theta_up for |d| / theta_up above 1: Newton's method, from below. */
static inline double uplift_turned(const Uplift *u, double lambda)
{
    double x = lambda;
    for (int i = 0; i < 60; i++) {
        const double per_root = 1 / sqrt(x);
        const double step = ((1 + u->ratio) * lambda - 3 + 2 * per_root - u->ratio * x) / (per_root / x + u->ratio);
        x += step;
        if (!(step > 1e-9 * x)) /* what is left is of its square */
            break;
    }
    return x;
}

/* [N m] F; *slope: dF/dd. */
static inline double uplift_force(const Uplift *u, double d, double *slope)
{
    const double lambda = fabs(d) / u->theta_up, whole = u->rotation * (1 + u->ratio);
    *slope = 0;
    if (lambda <= 1)
        return 0;
    const double x = uplift_turned(u, lambda);
    *slope = whole * (1 - (1 + u->ratio) / (1 / (x * sqrt(x)) + u->ratio));
    return whole * (d - copysign(x * u->theta_up, d));
}

/* [J] H: (K + a) d^2 / 2 - (theta M - U + a theta^2 / 2), U the spring's own. */
static inline double uplift_held(const Uplift *u, double d)
{
    const double lambda = fabs(d) / u->theta_up;
    if (lambda <= 1)
        return 0;
    const double x = uplift_turned(u, lambda), root = sqrt(x), own = 0.5 + 3 * (x - 1) - 4 * (root - 1);
    return u->rotation * u->theta_up * u->theta_up *
           (0.5 * (1 + u->ratio) * lambda * lambda - (3 * x - 2 * root - own + 0.5 * u->ratio * x * x));
}

/* [rad] theta under the moment [N m] that the spring carries. */
static inline double uplift_rotation(const Uplift *u, double moment)
{
    const double share = moment / (u->rotation * u->theta_up), rest = 3 - share;
    return share > 1 ? 4 * u->theta_up / (rest * rest) : moment / u->rotation;
}
