/* analysis/full_model.h -- designs on the building as the settings reduce it, and on all degrees of freedom of its
 * frame.
 *
 * Ownership  full_model_find allocates, full_model_free releases ({0} is fine)
 * Threads    tasks of the queue */
#pragma once

#include "evaluate/tower.h"

enum { REDUCED, FULL, MODELS };

typedef struct {
    Motion motion; /* scaled */
    int dofs[MODELS], n_floors;
    double z[FLOORS_MAX];      /* [m] of the floors */
    SimResult *result[MODELS]; /* (n) */
    double *error;             /* (n, N_MEASURES) likely integration errors of the reduced model; NULL: not known */
} FullModel;

/* Of n designs X (n, n_var), NULL for SCENE_NO_CORE, under motion.record. estimates 1: errors, by the engine fast. */
Status full_model_find(const Settings *s, SceneKind kind, size_t n, const double X[], int estimates, FullModel *out,
                       Err *err);
void full_model_free(FullModel *m);
