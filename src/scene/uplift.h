/* scene/uplift.h -- a core on a rotational spring whose mat may lift: what it adds to the core on its linear springs.
 *
 *   M = K theta up to theta_up, beyond it M = sign M_up (3 - 2 sqrt(theta_up / |theta|)),  M_up = K theta_up
 *
 * elastic, without hysteresis: a rigid disc held down by its load (Wolf 1976). The mat has no mass, so that theta
 * follows from the nodes v of the core. With Kc its stiffness while the mat does not turn, z the heights, a = z' Kc z,
 * d = z' Kc v / (K + a) the rotation on the linear spring, and g = theta - d
 *
 *   M(theta) + a theta + L = (K + a) d,   force on the nodes  -K_lin v - (dd/dv) F,  F = -(K + a) g
 *
 * one more spring along d, slack while the mat is down. L is what the ground's dashpot C does beyond its part in the
 * damping of the modes, which follows d: it sees g, and acts between the mat and the cone's inertia C z/c, of speed s,
 *
 *   L = C (g' - s),   C (z/c) s' = L        (z/c = 0: s = 0), so that C is C b^2 / (1 + b^2) at frequency w, b = w z/c
 *
 * Energy   H = (K + a) g^2 / 2 + U(theta) - K theta^2 / 2 + C (z/c) s^2 / 2, U of the spring: what modes hold too much
 * Threads  pure functions
 * Source   J. P. Wolf, Nucl. Eng. Des. 38 (1976) 357-384 */
#pragma once

#include <math.h>

typedef struct {
    double theta_up, rotation; /* [rad] 0: it never lifts; [N m/rad] K */
    double whole;              /* [N m/rad] K + a */
    double dashpot, cone_s;    /* [N m s/rad] C, 0: L is left out; [s] z/c */
} Uplift;

/* [rad], [rad/s] g and s; int F d' dt since the start [J]. Without a dashpot the first alone, and it follows from d. */
enum { MAT_LIFTED, MAT_CONE, MAT_WORK, MAT_STATES };

/* [rad] g where there is no dashpot, by Newton's method from below. */
static inline double uplift_lifted(const Uplift *u, double d)
{
    const double lambda = fabs(d) / u->theta_up, whole = u->whole / u->rotation, a = whole - 1;
    double x = lambda;
    if (!(lambda > 1))
        return 0;
    for (int i = 0; i < 60; i++) {
        const double per_root = 1 / sqrt(x), step = (whole * lambda - 3 + 2 * per_root - a * x) / (per_root / x + a);
        x += step;
        if (!(step > 1e-9 * x)) /* what is left is of its square */
            break;
    }
    return copysign((x - lambda) * u->theta_up, d);
}

/* Rates of the states where there is a dashpot. */
static inline void uplift_rates(const Uplift *u, double d, double d_dot, const double y[MAT_STATES],
                                double rate[MAT_STATES])
{
    const double g = y[MAT_LIFTED], theta = d + g, x = fabs(theta) / u->theta_up;
    const double spring = x > 1 ? copysign(u->rotation * u->theta_up * (3 - 2 / sqrt(x)), theta) : u->rotation * theta;
    const double L = u->rotation * d - (u->whole - u->rotation) * g - spring;
    rate[MAT_LIFTED] = y[MAT_CONE] + L / u->dashpot;
    rate[MAT_CONE] = u->cone_s > 0 ? L / (u->dashpot * u->cone_s) : 0;
    rate[MAT_WORK] = -u->whole * g * d_dot;
}

/* [J] H */
static inline double uplift_held(const Uplift *u, double d, const double y[MAT_STATES])
{
    const double g = y[MAT_LIFTED], x = fabs(d + g) / u->theta_up, scale = u->rotation * u->theta_up * u->theta_up;
    const double own = x > 1 ? scale * (0.5 + 3 * (x - 1) - 4 * (sqrt(x) - 1) - 0.5 * x * x) : 0;
    return 0.5 * u->whole * g * g + own + 0.5 * u->dashpot * u->cone_s * y[MAT_CONE] * y[MAT_CONE];
}
