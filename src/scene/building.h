/* scene/building.h -- the steel tower: stiffness and mass of its floors, and its modes.
 *
 *   K phi_i = w_i^2 M phi_i,   phi_i' M phi_i = 1,   gamma_i = phi_i' M 1      (participation [sqrt(kg)])
 *
 * model "guyan"     the 106-DOF frame condensed by Guyan reduction to its 20 floors (0.264 Hz; nearest to the responses
 *                   printed in the paper), "appendix" the paper's Appendix A (0.273 Hz); both are compiled in
 * model FOLDER      K.csv [N/m] and M.csv [kg], square, any number of floors up to FLOORS_MAX, bottom floor first
 *
 * Checked: square, finite, symmetric to rounding (1e-6 of the largest entry), positive definite.
 * Ownership  building_load allocates, building_free releases (an empty Building is fine). Threads  read-only after. */
#ifndef IMTET_SCENE_BUILDING_H
#define IMTET_SCENE_BUILDING_H

#include <stdint.h>

#include "base/status.h"

enum { FLOORS_MAX = 64 };

typedef struct {
    int n;         /* floors */
    double *K, *M; /* (n, n) [N/m], [kg] */
    double *phi;   /* (n, n) column i is mode i [1/sqrt(kg)] */
    double *omega; /* (n) [rad/s] ascending */
    double *gamma; /* (n) [sqrt(kg)] */
    uint64_t hash; /* FNV-1a of the numbers */
} Building;

Status building_load(Building *b, const char *model, Err *err);
void building_free(Building *b);

#endif
