/* CVODE by backward differentiation, Newton, contacts located by roots.
 *
 *   cvode_bdf        dense Jacobian by difference quotients, stability limit detection: as a careful user writes it
 *   cvode_bdf_tuned  order 2 at most, which damps nothing, and the modal linear solver
 *                    (bench/engines/modal_solver.h) */
#include <cvode/cvode.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#include "bench/engines/engines.h"
#include "bench/engines/modal_solver.h"
#include "sim/cvode/cvode.h"

typedef struct {
    SUNMatrix jacobian; /* NULL with the modal solver */
    SUNLinearSolver linear;
    ModalSolver modal;
} Newton;

static int current(void *memory, double *gamma, N_Vector *y)
{
    return CVodeGetCurrentGamma(memory, gamma) || CVodeGetCurrentState(memory, y);
}

static int attach_dense(Ode *o, void *solver)
{
    Newton *n = solver;
    n->jacobian = SUNDenseMatrix(ode_size(o), ode_size(o), o->context);
    n->linear = n->jacobian ? SUNLinSol_Dense(o->y, n->jacobian, o->context) : NULL;
    return !n->linear || CVodeSetLinearSolver(o->memory, n->linear, n->jacobian) || CVodeSetStabLimDet(o->memory, 1);
}

static int attach_modal(Ode *o, void *solver)
{
    Newton *n = solver;
    n->linear = modal_solver_create(&n->modal, o, 1, current);
    return !n->linear || CVodeSetLinearSolver(o->memory, n->linear, NULL) || CVodeSetMaxOrd(o->memory, 2);
}

static void release(void *solver)
{
    Newton *n = solver;
    SUNLinSolFree(n->linear);
    SUNMatDestroy(n->jacobian);
}

Status engine_cvode_bdf(const SimModel *model, const Motion *motion, const EngineOptions *options, SimResult *result,
                        Err *err)
{
    static const CvodeMethod METHOD = {
        .method = CV_BDF, .panel = 2.2e-3, .rtol = {1e-5, 1e-6, 1e-8}, .attach = attach_dense, .release = release};
    return cvode_run(&METHOD, &(Newton){0}, model, motion, options, result, err);
}

Status engine_cvode_bdf_tuned(const SimModel *model, const Motion *motion, const EngineOptions *options,
                              SimResult *result, Err *err)
{
    static const CvodeMethod METHOD = {
        .method = CV_BDF, .panel = 4e-3, .rtol = {1e-4, 1e-5, 1e-7}, .attach = attach_modal, .release = release};
    return cvode_run(&METHOD, &(Newton){0}, model, motion, options, result, err);
}
