/* analysis/sensitivity.h -- how much each result of a design changes with each parameter.
 *
 *   D(h) = mean_k (f(p + h, replicate k) - f(p - h, replicate k)) / 2h        slope = D(h/2)
 *
 * with the same replicates on both sides (common random numbers: replicate 0 is the design, the others have its gaps
 * changed as in evaluate/replicates.h), so that what they share cancels. Error: root of (sd / root(n))^2 + (D(h) -
 * D(h/2))^2, sd that of the differences of single replicates; of one replicate the second part alone. J3 jumps with
 * every impact and has no slope: NAN, or 0 where nothing changes.
 *
 * Parameters: every gap, both thicknesses, contact.radius_m, contact.restitution, building.damping, core.damping, the
 * bumper's stiffness, core.foundation_factor and building.yield_drift where there is one. Steps: gaps GAP_STEP (half
 * the gap where that is less), the others SHARE of themselves. Under the first record; forces are computed.
 *
 * Ownership  sensitivity_find allocates *out for free
 * Threads    as search.threads says, or ranks; the numbers do not depend on it */
#pragma once

#include "base/csv.h"
#include "evaluate/tower.h"

typedef struct {
    char name[TABLE_NAME_MAX];
    double value, step;
    double slope[N_MEASURES], error[N_MEASURES]; /* per unit of the parameter; NAN: a simulation failed */
} Sensitivity;

Status sensitivity_find(const Settings *s, const double x[], size_t n_replicates, Sensitivity **out, size_t *n,
                        Err *err);
