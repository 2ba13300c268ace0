/* bench/engines/modal_solver.h -- a SUNLinearSolver that knows the model: (I - gamma J) x = b in O(m) operations.
 *
 * J is 2 x 2 per mode plus rank one per floor in contact (left out where the contacts are integrated explicitly):
 *
 *   x_q - g x_v = b_q,   g w^2 x_q + (1 + 2 g zeta w) x_v + sum_j R_ij phi_j = b_v,
 *   phi_j = g (dF/dp R_j x_q + dF/dp' R_j x_v)
 *
 * Life cycle  modal_solver_create -> (SUNDIALS) -> SUNLinSolFree; the ModalSolver must outlive it */
#ifndef IMTET_BENCH_MODAL_SOLVER_H
#define IMTET_BENCH_MODAL_SOLVER_H

#include <sundials/sundials_linearsolver.h>

#include "sim/cvode/ode.h"

typedef struct {
    const Ode *ode;
    int with_contacts;
    int (*current)(void *memory, double *gamma, N_Vector *y); /* of the integrator */
} ModalSolver;

/* NULL: no memory. */
SUNLinearSolver modal_solver_create(ModalSolver *s, const Ode *ode, int with_contacts,
                                    int (*current)(void *memory, double *gamma, N_Vector *y));

#endif
