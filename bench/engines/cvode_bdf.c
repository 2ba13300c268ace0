/* CVODE by backward differentiation, Newton, dense Jacobian by difference quotients, stability limit detection, contacts
 * located by roots: as a careful user writes it. */
#include <cvode/cvode.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#include "bench/engines/engines.h"
#include "sim/cvode/cvode.h"

typedef struct {
    SUNMatrix jacobian;
    SUNLinearSolver linear;
} Newton;

static int attach(Ode *o, void *solver)
{
    Newton *n = solver;
    n->jacobian = SUNDenseMatrix(ode_size(o), ode_size(o), o->context);
    n->linear = n->jacobian ? SUNLinSol_Dense(o->y, n->jacobian, o->context) : NULL;
    return !n->linear || CVodeSetLinearSolver(o->memory, n->linear, n->jacobian) || CVodeSetStabLimDet(o->memory, 1);
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
        .method = CV_BDF, .panel = 2.2e-3, .rtol = {1e-5, 1e-6, 1e-8}, .attach = attach, .release = release};
    return cvode_run(&METHOD, &(Newton){0}, model, motion, options, result, err);
}
