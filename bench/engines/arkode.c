/* ARKODE's ARK436L2SA: the modes implicit, one 2 x 2 solve per mode and stage; contacts and ground explicit; contacts
 * located by roots, no stop at samples of the motion.
 *
 * D. R. Reynolds et al., ARKODE, ACM Trans. Math. Softw. 49 (2023) 1-26; C. A. Kennedy and M. H. Carpenter, Appl.
 * Numer. Math. 44 (2003) 139-181. */
#include <arkode/arkode_arkstep.h>
#include <string.h>

#include "base/clones.h"
#include "bench/engines/engines.h"
#include "sim/cvode/ode.h"

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

/* ---- the linear solver: (I - gamma J) x = b, J is 2 x 2 per mode ------------------------------------------------- */

static SUNLinearSolver_Type get_type(SUNLinearSolver s)
{
    (void)s;
    return SUNLINEARSOLVER_MATRIX_EMBEDDED;
}

/* x_q - g x_v = b_q,  g w^2 x_q + (1 + 2 g zeta w) x_v = b_v */
CLONED static void solve_modes(const SimModel *model, double g, const double b[], double x[])
{
    const int m = model->m;
    const double *bv = b + m;
    double *xv = x + m;
#pragma GCC ivdep
    for (int i = 0; i < m; i++) {
        const double w = model->omega[i], damping = 1 + 2 * g * model->zeta[i] * w, det = damping + g * g * w * w;
        const double q = b[i], v = bv[i];
        x[i] = (damping * q + g * v) / det;
        xv[i] = (v - g * w * w * q) / det;
    }
}

static int solve(SUNLinearSolver s, SUNMatrix unused, N_Vector x, N_Vector b, sunrealtype tolerance)
{
    (void)unused;
    (void)tolerance;
    const Ode *o = s->content;
    double gamma;
    if (ARKStepGetCurrentGamma(o->memory, &gamma))
        return SUNLS_PACKAGE_FAIL_UNREC;
    solve_modes(o->model, gamma, ode_values(b), ode_values(x));
    return 0;
}

static int release(SUNLinearSolver s)
{
    s->content = NULL;
    SUNLinSolFreeEmpty(s);
    return 0;
}

static SUNLinearSolver modal_solver(Ode *o)
{
    SUNLinearSolver s = SUNLinSolNewEmpty(o->context);
    if (!s)
        return NULL;
    s->content = o;
    s->ops->gettype = get_type;
    s->ops->solve = solve;
    s->ops->free = release;
    return s;
}

/* ---- the two parts of the right-hand side ------------------------------------------------------------------------ */

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

static int set_method(Ode *o)
{
    return ARKStepSetTableNum(o->memory, ARKODE_ARK436L2SA_DIRK_6_3_4, ARKODE_ARK436L2SA_ERK_6_3_4) ||
           ARKStepSetLinear(o->memory, 0) || ARKStepSetDeduceImplicitRhs(o->memory, 1) ||
           ARKStepSetInterpolantDegree(o->memory, 2) || /* cubics follow the stiff modes' derivatives too eagerly */
           ARKStepSetAdaptivityMethod(o->memory, 5, 1, 0, NULL); /* Gustafsson's controller for both parts */
}

static int prepare(Ode *o, SUNLinearSolver *linear)
{
    static const double RTOL[] = {1e-3, 1e-4, 1e-5}; /* by Accuracy */
    if (ode_prepare(o, RTOL) || !(o->memory = ARKStepCreate(nonlinear_part, linear_part, 0, o->y, o->context)))
        return -1;
    if (ARKStepSetErrHandlerFn(o->memory, ode_keep_message, o) || ARKStepSetUserData(o->memory, o) || set_method(o) ||
        ARKStepWFtolerances(o->memory, ode_error_weights) || ARKStepSetMaxHnilWarns(o->memory, -1) ||
        ARKStepSetMaxStep(o->memory, o->motion->dt_s) || ARKStepSetMaxNumSteps(o->memory, -1) ||
        (ode_n_roots(o) > 0 &&
         (ARKStepRootInit(o->memory, ode_n_roots(o), ode_penetrations) || ARKStepSetNoInactiveRootWarn(o->memory))))
        return -1;
    *linear = modal_solver(o);
    return !*linear || ARKStepSetLinearSolver(o->memory, *linear, NULL);
}

Status engine_arkode_imex(const SimModel *model, const Motion *motion, const EngineOptions *options, SimResult *result,
                          Err *err)
{
    Ode o = {.model = model, .motion = motion, .options = options, .solver = &ARKODE, .panel = 6e-3 /* [s] */};
    SUNLinearSolver linear = NULL;
    Status status;
    memset(result, 0, sizeof *result);
    result->n_floors = model->n;
    result->n_modes = model->n;
    if (prepare(&o, &linear))
        status = fail(err, STATUS_NO_MEMORY, "arkode: could not be set up: %s", o.message[0] ? o.message : "no memory");
    else
        status = ode_run(&o, result);
    ARKStepFree(&o.memory);
    SUNLinSolFree(linear);
    ode_release(&o);
    return status;
}
