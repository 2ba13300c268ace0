/* The engine `cvode`: Adams, fixed-point iteration, contacts located by roots, a stop at every sample of the motion.
 * It is trusted because it shares no method with the engine `fast`. */
#include "sim/cvode/cvode.h"

#include <cvode/cvode.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

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

Status cvode_run(const CvodeMethod *method, void *solver, const SimModel *model, const Motion *motion,
                 const EngineOptions *options, SimResult *result, Err *err)
{
    Ode o = {.model = model,
             .motion = motion,
             .options = options,
             .solver = &CVODE,
             .with_energies = method->with_energies,
             .stop_at_samples = method->stop_at_samples,
             .panel = method->panel};
    Status status;
    memset(result, 0, sizeof *result);
    result->n_floors = model->n;
    result->n_modes = model->n;
    if (model->m > MODES_MAX) {
        result->outcome = RUN_ENGINE_FAILED;
        snprintf(result->reason, sizeof result->reason, "%d modes; cvode has room for %d", model->m, MODES_MAX);
        return STATUS_OK;
    }
    if (ode_prepare(&o, method->rtol) || !(o.memory = CVodeCreate(method->method, o.context)) ||
        CVodeSetErrHandlerFn(o.memory, ode_keep_message, &o) || CVodeSetUserData(o.memory, &o) ||
        CVodeInit(o.memory, ode_right_hand_side, 0, o.y) || CVodeWFtolerances(o.memory, ode_error_weights) ||
        method->attach(&o, solver) || CVodeSetMaxHnilWarns(o.memory, -1) || CVodeSetNoInactiveRootWarn(o.memory) ||
        (!method->stop_at_samples && CVodeSetMaxStep(o.memory, motion->dt_s)) ||
        (ode_n_roots(&o) > 0 && CVodeRootInit(o.memory, ode_n_roots(&o), ode_penetrations)))
        status = fail(err, STATUS_NO_MEMORY, "cvode: could not be set up: %s", o.message[0] ? o.message : "no memory");
    else
        status = ode_run(&o, result);
    CVodeFree(&o.memory);
    method->release(solver);
    ode_release(&o);
    return status;
}

static int attach_fixed_point(Ode *o, void *solver)
{
    SUNNonlinearSolver *iteration = solver;
    *iteration = SUNNonlinSol_FixedPoint(o->y, 0, o->context);
    return !*iteration || CVodeSetNonlinearSolver(o->memory, *iteration);
}

static void release_fixed_point(void *solver)
{
    SUNNonlinearSolver *iteration = solver;
    SUNNonlinSolFree(*iteration);
}

Status engine_cvode(const SimModel *model, const Motion *motion, const EngineOptions *options, SimResult *result,
                    Err *err)
{
    static const CvodeMethod METHOD = {.method = CV_ADAMS,
                                       .with_energies = 1,
                                       .stop_at_samples = 1,
                                       .panel = 2.2e-3,
                                       .rtol = {1e-6, 1e-8, 1e-10},
                                       .attach = attach_fixed_point,
                                       .release = release_fixed_point};
    SUNNonlinearSolver iteration = NULL;
    return cvode_run(&METHOD, &iteration, model, motion, options, result, err);
}
