/* CVODE with located contacts.
 *
 *   cvode            Adams, fixed-point iteration, stops at every sample of the motion: the engine that is trusted
 * because it shares no method with the fast one cvode_bdf        BDF, Newton, dense Jacobian by difference quotients:
 * as a careful user writes it cvode_bdf_tuned  BDF of order 2 at most, which damps nothing, and the modal linear solver
 * (sim/reference/modal.h)
 *
 * A. C. Hindmarsh et al., SUNDIALS, ACM Trans. Math. Softw. 31 (2005) 363-396. */
#include <cvode/cvode.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include "sim/reference/modal.h"
#include "sim/reference/ode.h"

#include <string.h>

typedef struct {
    int method;     /* CV_ADAMS or CV_BDF */
    int order_max;  /* 0: the method's own */
    int own_solver; /* modal instead of dense */
    int with_books, stop_at_samples;
    double panel, rtol[3];
} CvodeKind;

static int step(Ode *o, double t_stop, double *t)
{
    return CVode(o->memory, t_stop, o->y, t, CV_ONE_STEP);
}

static int interpolate(Ode *o, double t, N_Vector y)
{
    return CVodeGetDky(o->memory, t, 0, y);
}

static int restart(Ode *o, double t)
{
    return CVodeReInit(o->memory, t, o->y);
}

static int stop_at(Ode *o, double t_stop)
{
    return CVodeSetStopTime(o->memory, t_stop);
}

static int found(Ode *o, int roots[])
{
    return CVodeGetRootInfo(o->memory, roots);
}

static int look_for(Ode *o, int directions[])
{
    return CVodeSetRootDirection(o->memory, directions);
}

static const OdeSolver CVODE = {"CVODE", step, interpolate, restart, stop_at, found, look_for};

static int current(void *memory, double *gamma, N_Vector *y)
{
    return CVodeGetCurrentGamma(memory, gamma) || CVodeGetCurrentState(memory, y);
}

/* What is freed at the end beside the Ode. */
typedef struct {
    SUNNonlinearSolver iteration;
    SUNMatrix jacobian;
    SUNLinearSolver linear;
    ModalSolver modal;
} Parts;

static int set_solver(Ode *o, Parts *p, const CvodeKind *kind)
{
    if (kind->method == CV_ADAMS) {
        p->iteration = SUNNonlinSol_FixedPoint(o->y, 0, o->context);
        return !p->iteration || CVodeSetNonlinearSolver(o->memory, p->iteration);
    }
    if (kind->own_solver) {
        p->linear = modal_solver_create(&p->modal, o, 1, current);
    } else {
        p->jacobian = SUNDenseMatrix(ode_size(o), ode_size(o), o->context);
        p->linear = p->jacobian ? SUNLinSol_Dense(o->y, p->jacobian, o->context) : NULL;
    }
    return !p->linear || CVodeSetLinearSolver(o->memory, p->linear, p->jacobian);
}

static int prepare(Ode *o, Parts *p, const CvodeKind *kind)
{
    if (ode_prepare(o, kind->rtol) || !(o->memory = CVodeCreate(kind->method, o->context)))
        return -1;
    return CVodeSetErrHandlerFn(o->memory, ode_keep_message, o) || CVodeSetUserData(o->memory, o) ||
           CVodeInit(o->memory, ode_right_hand_side, 0, o->y) || CVodeWFtolerances(o->memory, ode_error_weights) ||
           set_solver(o, p, kind) || CVodeSetMaxHnilWarns(o->memory, -1) || CVodeSetNoInactiveRootWarn(o->memory) ||
           (kind->order_max > 0 && CVodeSetMaxOrd(o->memory, kind->order_max)) ||
           (kind->method == CV_BDF && kind->order_max == 0 && CVodeSetStabLimDet(o->memory, 1)) ||
           (!kind->stop_at_samples && CVodeSetMaxStep(o->memory, o->motion->dt_s)) ||
           (ode_n_roots(o) > 0 && CVodeRootInit(o->memory, ode_n_roots(o), ode_penetrations));
}

static Status run(const CvodeKind *kind, const SimModel *model, const Motion *motion, const EngineOptions *options,
                  SimResult *result, Err *err)
{
    Ode o = {.model = model,
             .motion = motion,
             .options = options,
             .solver = &CVODE,
             .locate = 1,
             .with_books = kind->with_books,
             .stop_at_samples = kind->stop_at_samples,
             .panel = kind->panel};
    Parts p = {0};
    Status status;
    memset(result, 0, sizeof *result);
    result->n_floors = model->n;
    result->n_modes = model->nb;
    if (prepare(&o, &p, kind))
        status = fail(err, STATUS_NO_MEMORY, "cvode: could not be set up: %s", o.message[0] ? o.message : "no memory");
    else
        status = ode_run(&o, result);
    CVodeFree(&o.memory);
    SUNNonlinSolFree(p.iteration);
    SUNLinSolFree(p.linear);
    SUNMatDestroy(p.jacobian);
    ode_release(&o);
    return status;
}

Status engine_cvode(const SimModel *model, const Motion *motion, const EngineOptions *options, SimResult *result,
                    Err *err)
{
    static const CvodeKind KIND = {CV_ADAMS, 0, 0, 1, 1, 2.2e-3, {1e-6, 1e-8, 1e-10}};
    return run(&KIND, model, motion, options, result, err);
}

Status engine_cvode_bdf(const SimModel *model, const Motion *motion, const EngineOptions *options, SimResult *result,
                        Err *err)
{
    static const CvodeKind KIND = {CV_BDF, 0, 0, 0, 0, 2.2e-3, {1e-5, 1e-6, 1e-8}};
    return run(&KIND, model, motion, options, result, err);
}

Status engine_cvode_bdf_tuned(const SimModel *model, const Motion *motion, const EngineOptions *options,
                              SimResult *result, Err *err)
{
    static const CvodeKind KIND = {CV_BDF, 2, 1, 0, 0, 4e-3, {1e-4, 1e-5, 1e-7}};
    return run(&KIND, model, motion, options, result, err);
}
