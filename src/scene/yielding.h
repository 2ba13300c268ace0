/* scene/yielding.h -- the part of each storey's stiffness that yields.
 *
 *   f = K phi_1,  V_j = sum_{i >= j} f_i,  k_j = V_j / (phi_1j - phi_1,j-1)       phi_1 without P-delta
 *   c = min(1 - hardening, 0.98 / lambda),  B' diag(k) B x = lambda K x,  B u the drifts
 *
 * so that K - c B' diag(k) B, what is left where all have yielded, stays positive definite.
 *
 * Threads  no state */
#pragma once

#include "base/status.h"

/* K_elastic without P-delta, K with it, M: (n, n); yield_m (n) [m], 0: the storey stays elastic. k (n): c k_j [N/m],
 * 0 where it does. hardening: as wanted; becomes 1 - c. Errors: STATUS_BAD_DATA, a storey without stiffness. */
Status yielding_parts(int n, const double K_elastic[], const double M[], const double K[], const double yield_m[],
                      double *hardening, double k[], Err *err);

/* Adds a spring [N/m] between floor j = 0..n-1 and the one below it, or the ground, to K (n, n). */
void storey_spring(int n, int j, double spring, double K[]);
