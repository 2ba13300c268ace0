/* CVODE with events: the engine that is trusted because it shares no method with the fast one.
 *
 *   y = [q (m), q' (m), damped (m), input, lost, clamp]        energies in joules, integrated beside the motion
 *
 * Adams, fixed-point iteration; every closing and opening is a root, where the integrator starts anew. Between events
 * and samples of the motion the right-hand side is smooth: a floor keeps its flag past the root until the root is
 * found.
 *
 * A. C. Hindmarsh et al., SUNDIALS, ACM Trans. Math. Softw. 31 (2005) 363-396. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include "sim/engine.h"
#include "sim/reference/tally.h"

enum { MODES_MAX = 2 * FLOORS_MAX };

/* Displacements and accelerations are looked at no farther apart than this [s]; shorter steps as they come. */
static const double LOOK_EVERY = 1e-3;

typedef struct {
    const SimModel *model;
    const Motion *motion;
    double duration;

    double t_kink, accel, slope; /* ground acceleration: accel + slope (t - t_kink) */
    int side[FLOORS_MAX];        /* 0 open, else the sign of w while closed */
    double v0[FLOORS_MAX];       /* approach speed when it closed, floored [m/s] */
    long impacts, floored, steps, steps_max, evaluations;
    double rtol;
    int finite; /* what was last evaluated */

    SUNContext context;
    N_Vector y, tolerance, between; /* between: dense output */
    SUNNonlinearSolver iteration;
    void *cvode;
    Peaks peaks;
    char message[120]; /* CVODE's last error */
} Run;

static double *values(N_Vector v)
{
    return N_VGetArrayPointer(v);
}

static double dot(int n, const double a[], const double b[])
{
    double sum[4] = {0};
    int i = 0;
    for (; i + 4 <= n; i += 4)
        for (int k = 0; k < 4; k++)
            sum[k] += a[i + k] * b[i + k];
    for (; i < n; i++)
        sum[0] += a[i] * b[i];
    return sum[0] + sum[1] + sum[2] + sum[3];
}

/* w = u - v at floor j. */
static double relative_displacement(const SimModel *model, int j, const double y[])
{
    return dot(model->m, model->RT + (size_t)j * (size_t)model->m_pad, y);
}

static void relative_motion(const SimModel *model, int j, const double y[], double *w, double *w_dot)
{
    *w = relative_displacement(model, j, y);
    *w_dot = relative_displacement(model, j, y + model->m);
}

/* Adds the contacts' modal forces R_ij f_j to g. Where their power goes [W]:
 *     F p' = k p^1.5 p' (stored) + (F_raw - k p^1.5) p' (lost) + (F - F_raw) p' (clamp, never positive) */
static void add_contacts(const Run *r, const double y[], double g[], double *lost, double *clamp)
{
    const SimModel *model = r->model;
    *lost = *clamp = 0;
    for (int j = 0; model->nc > 0 && j < model->n; j++) {
        if (!r->side[j])
            continue;
        double w, w_dot;
        relative_motion(model, j, y, &w, &w_dot);
        const double p = r->side[j] * w - model->gap[j], p_dot = r->side[j] * w_dot;
        if (p <= 0) /* past the root: the law's continuation, continuous with its first derivative */
            continue;
        const ContactForce f = contact_force(&model->contact, model->mass_eff[j], p, p_dot, r->v0[j]);
        const double *row = model->RT + (size_t)j * (size_t)model->m_pad;
        for (int i = 0; i < model->m; i++)
            g[i] -= r->side[j] * f.force * row[i];
        *lost += (f.raw - f.hertz) * p_dot;
        *clamp += (f.force - f.raw) * p_dot;
    }
}

/* g_i = -2 zeta w q' - w^2 q + contacts: the modal acceleration without the ground's share. */
static void modal_pull(const Run *r, const double y[], double g[], double *lost, double *clamp)
{
    const SimModel *model = r->model;
    const double *q = y, *v = y + model->m;
    for (int i = 0; i < model->m; i++)
        g[i] = -model->omega[i] * (2 * model->zeta[i] * v[i] + model->omega[i] * q[i]);
    add_contacts(r, y, g, lost, clamp);
}

static int right_hand_side(sunrealtype t, N_Vector y_vector, N_Vector y_dot_vector, void *user)
{
    Run *r = user;
    const SimModel *model = r->model;
    const int m = model->m;
    const double *y = values(y_vector), *v = y + m;
    double *dq = values(y_dot_vector), *dv = dq + m, *damped = dv + m, *rest = damped + m;
    const double a = r->accel + r->slope * (t - r->t_kink);
    double moving = 0, check = 0;
    modal_pull(r, y, dv, &rest[1], &rest[2]);
    for (int i = 0; i < m; i++) {
        dq[i] = v[i];
        dv[i] -= model->gamma[i] * a;
        damped[i] = 2 * model->zeta[i] * model->omega[i] * v[i] * v[i];
        moving += model->gamma[i] * v[i];
        check += dv[i] + damped[i];
    }
    rest[0] = -a * moving;
    r->evaluations++;
    r->finite = isfinite(check + rest[0] + rest[1] + rest[2]) != 0;
    return r->finite ? 0 : -1;
}

/* One root per floor, its penetration: rising through zero when open, falling when closed. */
static int penetrations(sunrealtype t, N_Vector y, sunrealtype *p, void *user)
{
    (void)t;
    Run *r = user;
    const SimModel *model = r->model;
    double check = 0;
    for (int j = 0; j < model->n; j++) {
        const double w = relative_displacement(model, j, values(y));
        p[j] = (r->side[j] ? r->side[j] * w : fabs(w)) - model->gap[j];
        check += p[j];
    }
    r->finite = isfinite(check) != 0; /* CVODE takes NaN for "no root" */
    return r->finite ? 0 : -1;
}

static void keep_message(int code, const char *module, const char *function, char *text, void *user)
{
    (void)module;
    (void)function;
    Run *r = user;
    if (code < 0)
        snprintf(r->message, sizeof r->message, "%s", text);
}

/* Debian's vector loops are not vectorized and take two thirds of the run; these are the three that matter. */
static void linear_sum(sunrealtype a, N_Vector x, sunrealtype b, N_Vector y, N_Vector z)
{
    const sunindextype n = N_VGetLength(z);
    const double *px = values(x), *py = values(y);
    double *pz = values(z);
    for (sunindextype i = 0; i < n; i++)
        pz[i] = a * px[i] + b * py[i];
}

static void scaled(sunrealtype c, N_Vector x, N_Vector z)
{
    const sunindextype n = N_VGetLength(z);
    const double *px = values(x);
    double *pz = values(z);
    for (sunindextype i = 0; i < n; i++)
        pz[i] = c * px[i];
}

static sunrealtype weighted_rms(N_Vector x, N_Vector weight)
{
    const sunindextype n = N_VGetLength(x);
    const double *px = values(x), *pw = values(weight);
    double sum[4] = {0};
    sunindextype i = 0;
    for (; i + 4 <= n; i += 4)
        for (int k = 0; k < 4; k++)
            sum[k] += (px[i + k] * pw[i + k]) * (px[i + k] * pw[i + k]);
    for (; i < n; i++)
        sum[0] += (px[i] * pw[i]) * (px[i] * pw[i]);
    return sqrt((sum[0] + sum[1] + sum[2] + sum[3]) / (double)n);
}

static void use_own_loops(N_Vector v)
{
    v->ops->nvlinearsum = linear_sum;
    v->ops->nvscale = scaled;
    v->ops->nvwrmsnorm = weighted_rms;
}

/* weight_i = 1 / (rtol |y_i| + tolerance_i) */
static int error_weights(N_Vector y, N_Vector weight, void *user)
{
    const Run *r = user;
    const sunindextype n = N_VGetLength(y);
    const double *py = values(y), *tolerance = values(r->tolerance);
    double *pw = values(weight);
    for (sunindextype i = 0; i < n; i++)
        pw[i] = 1 / (r->rtol * fabs(py[i]) + tolerance[i]);
    return 0;
}

/* Error allowed in every component, as a share `level` of the scale that the motion sets: speed v = PGA/w_1, so that
 *     q_i' : sqrt(M) v      q_i : sqrt(M) v / w_i      energies : M v^2,        M = sum gamma_i^2  [kg] */
static void set_tolerances(const Run *r, double level)
{
    const SimModel *model = r->model;
    const int m = model->m;
    double mass = 0, pga = 0, slowest = HUGE_VAL, *tolerance = values(r->tolerance);
    for (int i = 0; i < m; i++) {
        mass += model->gamma[i] * model->gamma[i];
        slowest = fmin(slowest, fmax(model->omega[i], 1));
    }
    for (size_t k = 0; k < r->motion->n; k++)
        pga = fmax(pga, fabs(r->motion->accel[k]));
    const double speed = fmax(pga, 1e-6) / slowest, momentum = sqrt(fmax(mass, 1e-6)) * speed;
    for (int i = 0; i < m; i++) {
        tolerance[i] = level * momentum / fmax(model->omega[i], 1);
        tolerance[m + i] = level * momentum;
        tolerance[2 * m + i] = level * momentum * momentum;
    }
    for (int i = 3 * m; i < 3 * m + 3; i++)
        tolerance[i] = level * momentum * momentum;
}

static int prepare(Run *r, const EngineOptions *options)
{
    static const double RTOL[] = {[ACCURACY_COARSE] = 1e-6, [ACCURACY_STANDARD] = 1e-8, [ACCURACY_FINE] = 1e-10};
    const int roots = r->model->nc > 0 ? r->model->n : 0, size = 3 * r->model->m + 3;
    double fastest = 1;
    for (int i = 0; i < r->model->m; i++)
        fastest = fmax(fastest, r->model->omega[i] * (1 + 2 * r->model->zeta[i]));
    r->steps_max = (long)fmin(1e6 + 4 * fastest * r->duration, 1e12); /* fixed-point steps are near 1/fastest long */
    if (SUNContext_Create(NULL, &r->context))
        return -1;
    r->y = N_VNew_Serial(size, r->context);
    r->tolerance = N_VNew_Serial(size, r->context);
    r->between = N_VNew_Serial(size, r->context);
    r->cvode = CVodeCreate(CV_ADAMS, r->context);
    if (!r->y || !r->tolerance || !r->between || !r->cvode)
        return -1;
    use_own_loops(r->y);
    N_VConst(0, r->y);
    r->rtol = options->knob > 0 ? options->knob : RTOL[options->accuracy];
    set_tolerances(r, 0.1 * r->rtol);
    r->iteration = SUNNonlinSol_FixedPoint(r->y, 0, r->context);
    if (!r->iteration || CVodeSetErrHandlerFn(r->cvode, keep_message, r) || CVodeSetUserData(r->cvode, r) ||
        CVodeInit(r->cvode, right_hand_side, 0, r->y) || CVodeWFtolerances(r->cvode, error_weights) ||
        CVodeSetNonlinearSolver(r->cvode, r->iteration) || CVodeSetMaxHnilWarns(r->cvode, -1) ||
        CVodeSetNoInactiveRootWarn(r->cvode) || (roots && CVodeRootInit(r->cvode, roots, penetrations)))
        return -1;
    return 0;
}

static void release(Run *r)
{
    CVodeFree(&r->cvode);
    SUNNonlinSolFree(r->iteration);
    N_VDestroy(r->y);
    N_VDestroy(r->tolerance);
    N_VDestroy(r->between);
    SUNContext_Free(&r->context);
}

static void look(Run *r, double t, const double y[])
{
    const SimModel *model = r->model;
    double g[MODES_MAX], lost, clamp;
    PeakPoint *point = peaks_next(&r->peaks);
    modal_pull(r, y, g, &lost, &clamp);
    memset(point, 0, sizeof *point);
    point->t = t;
    double *u = point->of[PEAK_DISPLACEMENT], *accel = point->of[PEAK_ACCELERATION], *w = point->of[PEAK_RELATIVE];
    for (int i = 0; i < model->nb; i++) {
        const double *row = model->R + (size_t)i * (size_t)model->n_pad;
        for (int j = 0; j < model->n_pad; j++) {
            u[j] += row[j] * y[i];
            accel[j] += row[j] * g[i];
        }
    }
    memcpy(w, u, sizeof(double) * (size_t)model->n_pad);
    for (int i = model->nb; i < model->m; i++) {
        const double *row = model->R + (size_t)i * (size_t)model->n_pad;
        for (int j = 0; j < model->n_pad; j++)
            w[j] += row[j] * y[i];
    }
    peaks_note(&r->peaks);
}

/* The step that CVODE has just made from t_before to t, by its own interpolant. */
static int look_at_step(Run *r, double t_before, double t)
{
    const double parts = ceil((t - t_before) / LOOK_EVERY);
    for (double k = 1; k < parts; k++) {
        const double between = t_before + (t - t_before) * k / parts;
        if (CVodeGetDky(r->cvode, between, 0, r->between))
            return -1;
        look(r, between, values(r->between));
    }
    look(r, t, values(r->y));
    return 0;
}

static void close_gap(Run *r, int j, int side, double p_dot)
{
    r->side[j] = side;
    r->v0[j] = fmax(p_dot, r->model->contact.v0_floor);
    r->impacts++;
    r->floored += p_dot < r->model->contact.v0_floor;
}

/* Flips the floors whose root was found. A floor whose root was not seen, because it was zero when the integrator
 * started or because two roots lay in one step (a graze), is flipped too, at the end of that step. Returns whether any
 * flipped. */
static int switch_contacts(Run *r, const int found[])
{
    const SimModel *model = r->model;
    int flipped = 0;
    for (int j = 0; j < model->n; j++) {
        double w, w_dot;
        relative_motion(model, j, values(r->y), &w, &w_dot);
        const int side = r->side[j] ? r->side[j] : w > 0 ? 1 : -1;
        const double p = side * w - model->gap[j], p_dot = side * w_dot;
        if (!r->side[j] && (found[j] || (p > 0 && p_dot > 0))) {
            close_gap(r, j, side, p_dot);
            flipped = 1;
        } else if (r->side[j] && (found[j] || (p < 0 && p_dot <= 0))) {
            r->side[j] = 0;
            if (!(model->gap[j] > 0)) /* leaves one side onto the other */
                close_gap(r, j, -side, -p_dot);
            flipped = 1;
        }
    }
    return flipped;
}

static int start_anew(Run *r, double t, double t_stop)
{
    int rising[FLOORS_MAX];
    for (int j = 0; j < r->model->n; j++)
        rising[j] = r->side[j] ? -1 : 1;
    const int flag = CVodeReInit(r->cvode, t, r->y);
    if (flag)
        return flag;
    if (r->model->nc > 0)
        CVodeSetRootDirection(r->cvode, rising);
    return CVodeSetStopTime(r->cvode, t_stop);
}

/* From *t to t_stop, between which the ground acceleration is one straight line. */
static RunOutcome cross_interval(Run *r, double *t, double t_stop)
{
    int found[FLOORS_MAX] = {0};
    if (CVodeSetStopTime(r->cvode, t_stop))
        return RUN_ENGINE_FAILED;
    while (t_stop - *t > 1e-12 * (1 + t_stop)) {
        if (r->steps++ >= r->steps_max)
            return RUN_OUT_OF_STEPS;
        const double t_before = *t;
        const int flag = CVode(r->cvode, t_stop, r->y, t, CV_ONE_STEP);
        if (flag < 0) /* CVODE has tried again with shorter steps before it says so */
            return r->finite ? RUN_ENGINE_FAILED : RUN_NOT_FINITE;
        if (look_at_step(r, t_before, *t))
            return RUN_ENGINE_FAILED;
        if (r->model->nc == 0)
            continue;
        if (flag == CV_ROOT_RETURN)
            CVodeGetRootInfo(r->cvode, found);
        else
            memset(found, 0, sizeof found);
        if (switch_contacts(r, found) && start_anew(r, *t, t_stop))
            return RUN_ENGINE_FAILED;
    }
    return RUN_OK;
}

/* Every straight stretch of the motion in turn, then the ground at rest. */
static RunOutcome walk(Run *r)
{
    const Motion *motion = r->motion;
    double t = 0;
    look(r, 0, values(r->y));
    if (start_anew(r, 0, r->duration))
        return RUN_ENGINE_FAILED;
    for (size_t k = 0; k + 1 < motion->n && t < r->duration; k++) {
        const double t_next = (double)(k + 1) * motion->dt_s;
        r->t_kink = (double)k * motion->dt_s;
        r->accel = motion->accel[k];
        r->slope = (motion->accel[k + 1] - motion->accel[k]) / motion->dt_s;
        const RunOutcome outcome = cross_interval(r, &t, fmin(t_next, r->duration));
        if (outcome != RUN_OK)
            return outcome;
    }
    r->accel = r->slope = 0;
    if (t < r->duration && start_anew(r, t, r->duration)) /* the acceleration may jump */
        return RUN_ENGINE_FAILED;
    return cross_interval(r, &t, r->duration);
}

static void report(const Run *r, SimResult *result)
{
    const SimModel *model = r->model;
    const int m = model->m;
    const double *y = values(r->y);
    result->steps = r->steps;
    result->force_evaluations = r->evaluations;
    result->impacts = r->impacts;
    result->floored = r->floored;
    result->input_energy_j = y[3 * m];
    result->contact_loss_j = y[3 * m + 1];
    result->clamp_j = y[3 * m + 2];
    for (int i = 0; i < m; i++)
        result->kinetic_strain_j += 0.5 * (y[m + i] * y[m + i] + pow(model->omega[i] * y[i], 2));
    for (int j = 0; j < model->n && model->nc > 0; j++) {
        double w, w_dot;
        relative_motion(model, j, y, &w, &w_dot);
        if (r->side[j])
            result->contact_stored_j += contact_stored(&model->contact, r->side[j] * w - model->gap[j]);
        result->penetration_max_m = fmax(result->penetration_max_m, r->peaks.peak[PEAK_RELATIVE][j] - model->gap[j]);
    }
    peaks_report(&r->peaks, result);
    books_close(result, model->nb, model->nc, y + 2 * m);
}

static void explain(const Run *r, double t, SimResult *result)
{
    if (result->outcome == RUN_OUT_OF_STEPS)
        snprintf(result->reason, sizeof result->reason, "t = %.6g s: %ld steps did not reach %g s", t, r->steps,
                 r->duration);
    else if (result->outcome == RUN_NOT_FINITE)
        snprintf(result->reason, sizeof result->reason, "t = %.6g s: motion or response is not a finite number", t);
    else
        snprintf(result->reason, sizeof result->reason, "t = %.6g s: CVODE: %s", t, r->message);
}

Status engine_cvode(const SimModel *model, const Motion *motion, const EngineOptions *options, SimResult *result,
                    Err *err)
{
    Run r = {.model = model, .motion = motion, .duration = options->duration, .peaks.n = model->n};
    memset(result, 0, sizeof *result);
    result->n_floors = model->n;
    result->n_modes = model->nb;
    Status status = STATUS_OK;
    if (prepare(&r, options)) {
        status = fail(err, STATUS_NO_MEMORY, "cvode: could not be set up: %s", r.message[0] ? r.message : "no memory");
    } else {
        result->outcome = walk(&r);
        const double reached = r.peaks.count ? r.peaks.ring[(r.peaks.count + 2) % 3].t : 0;
        if (result->outcome == RUN_OK)
            report(&r, result);
        else
            explain(&r, reached, result);
    }
    release(&r);
    return status;
}
