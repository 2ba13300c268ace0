/* ARKODE with contacts.
 *
 *   arkode_erk           explicit, order 4 (Zonneveld), energies beside the motion, located contacts
 *   arkode_erk_noevents  the same, contacts by overlap inside a step: what a run without event location costs
 *   arkode_dirk          implicit, order 5 (ESDIRK547L2SA), Newton with the modal linear solver, located contacts
 *   arkode_imex          ARK436L2SA: the modes implicit, one 2 x 2 solve per mode and stage; contacts and ground
 *                        explicit; located contacts, no stop at samples of the motion
 *
 * D. R. Reynolds et al., ARKODE, ACM Trans. Math. Softw. 49 (2023) 1-26; C. A. Kennedy and M. H. Carpenter, Appl.
 * Numer. Math. 44 (2003) 139-181. */
#include <arkode/arkode_arkstep.h>

#include "bench/engines/engines.h"
#include "bench/engines/modal_solver.h"
#include "sim/cvode/ode.h"

#include <string.h>

typedef enum { ERK, DIRK, IMEX } Split;

typedef struct {
    Split split;
    int locate, with_energies;
    double panel, rtol[3];
} ArkodeKind;

static int step(Ode *o, double t_stop, double *t)
{
    return ARKStepEvolve(o->memory, t_stop, o->y, t, ARK_ONE_STEP);
}

static int interpolate(Ode *o, double t, N_Vector y)
{
    return ARKStepGetDky(o->memory, t, 0, y);
}

/* Keeps the step size: contact forces grow from zero. */
static int restart(Ode *o, double t)
{
    return t > 0 ? ARKStepReset(o->memory, t, o->y) : 0;
}

static int stop_at(Ode *o, double t_stop)
{
    return ARKStepSetStopTime(o->memory, t_stop);
}

static int found(Ode *o, int roots[])
{
    return ARKStepGetRootInfo(o->memory, roots);
}

static int look_for(Ode *o, int directions[])
{
    return ARKStepSetRootDirection(o->memory, directions);
}

static const OdeSolver ARKODE = {"ARKODE", step, interpolate, restart, stop_at, found, look_for};

static int current(void *memory, double *gamma, N_Vector *y)
{
    return ARKStepGetCurrentGamma(memory, gamma) || ARKStepGetCurrentState(memory, y);
}

/* What the modes do by themselves. */
static int linear_part(sunrealtype t, N_Vector y_vector, N_Vector y_dot_vector, void *user)
{
    (void)t;
    const Ode *o = user;
    const int m = o->model->m;
    const double *y = ode_values(y_vector), *v = y + m;
    double *dq = ode_values(y_dot_vector);
    memcpy(dq, v, sizeof *v * (size_t)m);
    ode_structure(o->model, y, v, dq + m);
    return 0;
}

/* Contacts and ground. */
static int nonlinear_part(sunrealtype t, N_Vector y_vector, N_Vector y_dot_vector, void *user)
{
    Ode *o = user;
    double *dq = ode_values(y_dot_vector), a;
    ContactPower power;
    memset(dq, 0, sizeof *dq * 2 * (size_t)o->model->m);
    return ode_add_loads(o, t, ode_values(y_vector), dq + o->model->m, &a, &power);
}

static void *create(Ode *o, Split split)
{
    switch (split) {
    case ERK:
        return ARKStepCreate(ode_right_hand_side, NULL, 0, o->y, o->context);
    case DIRK:
        return ARKStepCreate(NULL, ode_right_hand_side, 0, o->y, o->context);
    default:
        return ARKStepCreate(nonlinear_part, linear_part, 0, o->y, o->context);
    }
}

static int set_method(Ode *o, Split split)
{
    switch (split) {
    case ERK:
        return ARKStepSetTableNum(o->memory, ARKODE_DIRK_NONE, ARKODE_ZONNEVELD_5_3_4);
    case DIRK:
        return ARKStepSetTableNum(o->memory, ARKODE_ESDIRK547L2SA_7_4_5, ARKODE_ERK_NONE);
    default:
        return ARKStepSetTableNum(o->memory, ARKODE_ARK436L2SA_DIRK_6_3_4, ARKODE_ARK436L2SA_ERK_6_3_4) ||
               ARKStepSetLinear(o->memory, 0) || ARKStepSetDeduceImplicitRhs(o->memory, 1) ||
               ARKStepSetInterpolantDegree(o->memory, 2) || /* cubics follow the stiff modes' derivatives too eagerly */
               ARKStepSetAdaptivityMethod(o->memory, 5, 1, 0, NULL); /* Gustafsson's controller for both parts */
    }
}

static int prepare(Ode *o, ModalSolver *modal, SUNLinearSolver *linear, const ArkodeKind *kind)
{
    if (ode_prepare(o, kind->rtol) || !(o->memory = create(o, kind->split)))
        return -1;
    if (ARKStepSetErrHandlerFn(o->memory, ode_keep_message, o) || ARKStepSetUserData(o->memory, o) ||
        set_method(o, kind->split) || ARKStepWFtolerances(o->memory, ode_error_weights) ||
        ARKStepSetMaxHnilWarns(o->memory, -1) || ARKStepSetMaxStep(o->memory, o->motion->dt_s) ||
        ARKStepSetMaxNumSteps(o->memory, -1) ||
        (ode_n_roots(o) > 0 &&
         (ARKStepRootInit(o->memory, ode_n_roots(o), ode_penetrations) || ARKStepSetNoInactiveRootWarn(o->memory))))
        return -1;
    if (kind->split == ERK)
        return 0;
    *linear = modal_solver_create(modal, o, kind->split == DIRK, current);
    return !*linear || ARKStepSetLinearSolver(o->memory, *linear, NULL);
}

static Status run(const ArkodeKind *kind, const SimModel *model, const Motion *motion, const EngineOptions *options,
                  SimResult *result, Err *err)
{
    Ode o = {.model = model,
             .motion = motion,
             .options = options,
             .solver = &ARKODE,
             .locate = kind->locate,
             .with_energies = kind->with_energies,
             .panel = kind->panel};
    ModalSolver modal;
    SUNLinearSolver linear = NULL;
    Status status;
    memset(result, 0, sizeof *result);
    result->n_floors = model->n;
    result->n_modes = model->n;
    if (prepare(&o, &modal, &linear, kind))
        status = fail(err, STATUS_NO_MEMORY, "arkode: could not be set up: %s", o.message[0] ? o.message : "no memory");
    else
        status = ode_run(&o, result);
    ARKStepFree(&o.memory);
    SUNLinSolFree(linear);
    ode_release(&o);
    return status;
}

Status engine_arkode_erk(const SimModel *model, const Motion *motion, const EngineOptions *options, SimResult *result,
                         Err *err)
{
    static const ArkodeKind KIND = {ERK, 1, 1, 2.2e-3, {1e-5, 1e-6, 1e-8}};
    return run(&KIND, model, motion, options, result, err);
}

Status engine_arkode_erk_noevents(const SimModel *model, const Motion *motion, const EngineOptions *options,
                                  SimResult *result, Err *err)
{
    static const ArkodeKind KIND = {ERK, 0, 1, 2.2e-3, {1e-5, 1e-6, 1e-8}};
    return run(&KIND, model, motion, options, result, err);
}

Status engine_arkode_dirk(const SimModel *model, const Motion *motion, const EngineOptions *options, SimResult *result,
                          Err *err)
{
    static const ArkodeKind KIND = {DIRK, 1, 0, 4e-3, {1e-4, 1e-5, 1e-7}};
    return run(&KIND, model, motion, options, result, err);
}

Status engine_arkode_imex(const SimModel *model, const Motion *motion, const EngineOptions *options, SimResult *result,
                          Err *err)
{
    static const ArkodeKind KIND = {IMEX, 1, 0, 6e-3, {1e-3, 1e-4, 1e-5}};
    return run(&KIND, model, motion, options, result, err);
}
