/* sim/storey.h -- a storey that yields: the part of its stiffness that is not linear.
 *
 *   d = u_j - u_{j-1} [m] drift,  z = d - p the elastic part of it,  p [m] the plastic
 *   force of the storey beyond K u: -k p, k = c k_j [N/m] (scene/building.h);  y = yield_m [m]
 *
 *   bilinear   |z| <= y: z' = d' while |z| < y, else only towards zero. In terms of p the play operator: over any
 *              stretch on which d is monotone, p becomes min(max(p, d - y), d + y)
 *   bouc_wen   z' = d' (1 - nu |z/y|^n [z d' > 0]) / eta,   nu = 1 + s_s e,  eta = 1 + s_k e,   e = int z d' dt / y^2
 *              which is A = 1, beta = gamma = 1/2 in the usual notation: unloading is elastic. e counts what went into
 *              the storey in units of twice its elastic energy at yield (strength and stiffness degradation s_s, s_k)
 *
 * Energy  int k z d' dt = k z^2/2 (held) + hysteresis, hysteresis = int k z dp
 *
 * Threads  pure functions
 * Source   Y. K. Wen, J. Eng. Mech. Div. 102 (1976) 249-263; T. T. Baber, Y. K. Wen, J. Eng. Mech. Div. 107 (1981)
 *          1069-1087 (degradation); A. Visintin, Differential Models of Hysteresis (1994) (play) */
#pragma once

#include "scene/options.h"

/* The law that all storeys of a building have in common. */
typedef struct {
    Hysteresis kind;
    double exponent, strength, stiffness; /* [-] n, s_s, s_k of bouc_wen */
} StoreyLaw;

/* [-] dz/dd of bouc_wen at z/y, energy e, while d moves to side `sign`. */
static inline double storey_slope(const StoreyLaw *law, double z_over_y, double e, double sign)
{
    const double n = law->exponent, z = fabs(z_over_y), power = n == 2 ? z * z : n == 1 ? z : pow(z, n);
    const double bends = sign * z_over_y > 0 ? (1 + law->strength * e) * power : 0;
    return (1 - bends) / (1 + law->stiffness * e);
}
