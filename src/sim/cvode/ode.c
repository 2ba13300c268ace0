#include "sim/cvode/ode.h"

#include "base/denormal.h"
#include "base/clones.h"
#include "sim/cvode/vectors.h"

/* So many steps in a row, each shorter than this share of the time, get nowhere: events that breed events. */
enum { STUCK_MAX = 2000 };
static const double NOWHERE = 1e-9;

double *ode_values(N_Vector v)
{
    return NV_DATA_S(v);
}

/* Where the storeys' plastic drifts stand in y, and after them their works. */
static int storeys_at(const Ode *o)
{
    return o->with_energies ? 3 * o->model->m + 3 + (o->model->n_devices > 0) : 2 * o->model->m;
}

static const Uplift *mat_of(const Ode *o)
{
    return &o->model->device[o->model->n_devices - 1].lifts;
}

int ode_size(const Ode *o)
{
    return o->contacts.mat_at ? o->contacts.mat_at + MAT_STATES
                              : storeys_at(o) + (o->model->yields ? 2 * o->model->n : 0);
}

int ode_n_roots(const Ode *o)
{
    return o->model->yields ? 2 * o->model->n : o->model->nc > 0 ? o->model->n : 0;
}

/* Ground acceleration; where the integrator stops at samples, the present interval's straight line to both sides. */
static double ground(const Ode *o, double t)
{
    const Motion *motion = o->motion;
    const long last = (long)motion->n - 2;
    const long k = o->stop_at_samples ? o->interval : (long)floor(t / motion->dt_s);
    if (k > last || k < 0)
        return 0;
    const double slope = (motion->accel[k + 1] - motion->accel[k]) / motion->dt_s;
    return motion->accel[k] + slope * (t - (double)k * motion->dt_s);
}

CLONED void ode_structure(const SimModel *model, const double q[], const double v[], double dv[])
{
#pragma GCC ivdep
    for (int i = 0; i < model->m; i++)
        dv[i] = -model->omega[i] * (2 * model->zeta[i] * v[i] + model->omega[i] * q[i]);
}

CLONED static double energy_rates(const SimModel *model, const double v[], double damped[])
{
#pragma GCC ivdep
    for (int i = 0; i < model->m; i++)
        damped[i] = 2 * model->zeta[i] * model->omega[i] * v[i] * v[i];
    return dot_product(model->m, model->gamma, v);
}

/* Modal load [m/s2 sqrt(kg)] of the forces on the floors, added to g (nb); returns its power [W] at q'. */
static __attribute__((noinline)) double add_forces(const Ode *o, double t, const double v[], double g[])
{
    const SimModel *model = o->model;
    const Motion *motion = o->motion;
    const long k = o->stop_at_samples ? o->interval : (long)floor(t / motion->dt_s), width = motion->n_force;
    double power = 0;
    for (int j = 0; j < motion->n_force && k >= 0 && k <= (long)motion->n - 2; j++) {
        const double *f = motion->force + k * width + j;
        const double force = f[0] + (f[width] - f[0]) * (t / motion->dt_s - (double)k);
        for (int i = 0; i < model->nb; i++) {
            const double shape = centre_row(model, i)[j];
            g[i] += force * shape;
            power += force * shape * v[i];
        }
    }
    return power;
}

CLONED int ode_add_loads(Ode *o, double t, const double y[], double dv[], double *a, ContactPower *power)
{
    const SimModel *model = o->model;
    double check = 0;
    *a = ground(o, t);
    *power = contacts_add(&o->contacts, y, y + model->m, dv);
    if (model->yields)
        storeys_add(model, y + storeys_at(o), dv);
    power->pushed = add_forces(o, t, y + model->m, dv);
    for (int i = 0; i < model->m; i++) {
        dv[i] -= model->gamma[i] * *a;
        check += dv[i];
    }
    o->account.evaluations++;
    o->finite = isfinite(check) != 0;
    return o->finite ? 0 : -1;
}

int ode_right_hand_side(sunrealtype t, N_Vector y_vector, N_Vector y_dot_vector, void *user)
{
    Ode *o = user;
    const SimModel *model = o->model;
    const int m = model->m;
    const double *y = ode_values(y_vector), *v = y + m;
    double *dq = ode_values(y_dot_vector), *dv = dq + m, a;
    ContactPower power;
    memcpy(dq, v, sizeof *v * (size_t)m);
    ode_structure(model, y, v, dv);
    const int failed = ode_add_loads(o, t, y, dv, &a, &power);
    if (o->with_energies) {
        double *rest = dv + 2 * m;
        rest[0] = -a * energy_rates(model, v, dv + m) + power.pushed;
        rest[1] = power.lost;
        rest[2] = power.clamp;
        if (model->n_devices > 0)
            rest[3] = power.devices;
    }
    if (o->contacts.mat_at) {
        const double *row = model->B + (model->n_devices - 1) * model->m_pad;
        const int at = o->contacts.mat_at;
        uplift_rates(mat_of(o), dot_product(m, row, y), dot_product(m, row, v), y + at, dq + at);
    }
    if (model->yields) {
        const double *p = y + storeys_at(o);
        double d[FLOORS_MAX], d_dot[FLOORS_MAX], *rate = dq + storeys_at(o);
        storeys_drifts(model, y, d);
        storeys_drifts(model, v, d_dot);
        storeys_rates(&o->storeys, d, d_dot, p, p + model->n, rate, rate + model->n);
    }
    return failed;
}

/* One root per floor, its penetration: rising through zero when open, falling when closed. Of bilinear storeys: beyond
 * yield, rising while they are elastic; the drift's rate, falling while they yield. */
int ode_penetrations(sunrealtype t, N_Vector y_vector, sunrealtype *root, void *user)
{
    (void)t;
    Ode *o = user;
    const SimModel *model = o->model;
    const int n = model->n;
    const double *y = ode_values(y_vector);
    double check = 0, w[FLOORS_MAX], d[FLOORS_MAX], d_dot[FLOORS_MAX];
    if (model->yields) {
        storeys_drifts(model, y, d);
        storeys_drifts(model, y + model->m, d_dot);
    }
    for (int j = 0; j < n && model->yields; j++) {
        const int side = o->storeys.side[j];
        root[n + j] = model->storey_law.kind != HYSTERESIS_BILINEAR || model->yield_n_m[j] == 0 ? -1
                      : side                                                                    ? side * d_dot[j]
                             : fabs(d[j] - y[storeys_at(o) + j]) - model->yield_m[j];
        check += root[n + j];
    }
    floors_from_modes(model, 0, model->m, y, w);
    for (int j = 0; j < n; j++) {
        const int side = o->contacts.side[j];
        root[j] = penetration(model, j, side ? side : w[j] > model->middle[j] ? 1 : -1, w[j]);
        check += root[j];
    }
    o->finite = isfinite(check) != 0; /* SUNDIALS takes NaN for "no root" */
    return o->finite ? 0 : -1;
}

void ode_keep_message(int code, const char *module, const char *function, char *text, void *user)
{
    (void)module;
    (void)function;
    Ode *o = user;
    if (code < 0)
        text_copy(o->message, text);
}

/* weight_i = 1 / (rtol |y_i| + tolerance_i) */
CLONED static void set_weights(long n, double rtol, const double y[], const double tolerance[], double weight[])
{
    for (long i = 0; i < n; i++)
        weight[i] = 1 / (rtol * fabs(y[i]) + tolerance[i]);
}

int ode_error_weights(N_Vector y, N_Vector weight, void *user)
{
    const Ode *o = user;
    set_weights(NV_LENGTH_S(y), o->rtol, ode_values(y), ode_values(o->tolerance), ode_values(weight));
    return 0;
}

int ode_prepare(Ode *o, const double rtol[3])
{
    const SimModel *model = o->model;
    double fastest = 1;
    for (int i = 0; i < model->m; i++)
        fastest = fmax(fastest, model->omega[i] * (1 + 2 * model->zeta[i]));
    o->steps_max = (long)fmin(1e6 + 4 * fastest * o->options->duration, 1e12); /* explicit steps are near 1/fastest */
    o->storeys.model = model;
    o->contacts = (Contacts){.model = model, .log = o->options->onsets, .forces = o->options->forces};
    if (o->with_energies && model->may_lift && mat_of(o)->dashpot > 0)
        o->contacts.mat_at = ode_size(o);
    if (o->contacts.forces)
        force_monitor_start(o->contacts.forces, model->nc - model->has_mass, o->options->duration);
    energy_account_start(&o->account, model);
    if (SUNContext_Create(NULL, &o->context))
        return -1;
    o->y = N_VNew_Serial(ode_size(o), o->context);
    o->tolerance = N_VNew_Serial(ode_size(o), o->context);
    if (!o->y || !o->tolerance)
        return -1;
    vectors_use_own_loops(o->y);
    o->between = N_VClone(o->y);
    if (!o->between)
        return -1;
    N_VConst(0, o->y);
    o->rtol = o->options->tolerance > 0 ? o->options->tolerance : rtol[o->options->accuracy];

    /* Error allowed in every component, as a share of the scale that the motion sets: speed v = PGA/w_1, so that
     *     q_i' : sqrt(M) v      q_i : sqrt(M) v / w_i      energies : M v^2,        M = sum gamma_i^2  [kg] */
    const int m = model->m;
    const double level = 0.1 * o->rtol;
    double mass = 0, pga = 0, slowest = HUGE_VAL, *tolerance = ode_values(o->tolerance);
    for (int i = 0; i < m; i++) {
        mass += model->gamma[i] * model->gamma[i];
        slowest = fmin(slowest, fmax(model->omega[i], 1));
    }
    for (size_t k = 0; k < o->motion->n; k++) {
        double force = 0;
        for (int j = 0; j < o->motion->n_force; j++)
            force += fabs(o->motion->force[k * (size_t)o->motion->n_force + (size_t)j]);
        pga = fmax(pga, fabs(o->motion->accel[k]) + force / fmax(mass, 1e-6));
    }
    const double speed = (pga > 0 ? pga : 1) / slowest, momentum = sqrt(fmax(mass, 1e-6)) * speed;
    for (int i = 0; i < m; i++) {
        tolerance[i] = level * momentum / fmax(model->omega[i], 1);
        tolerance[m + i] = level * momentum;
    }
    for (int i = 2 * m; i < ode_size(o); i++)
        tolerance[i] = level * momentum * momentum;
    for (int i = MAT_LIFTED; o->contacts.mat_at && i <= MAT_CONE; i++)
        tolerance[o->contacts.mat_at + i] = level * mat_of(o)->theta_up;
    for (int j = 0; model->yields && j < model->n; j++)
        if (model->yield_n_m[j] > 0)
            tolerance[storeys_at(o) + j] = level * model->yield_m[j];
    return 0;
}

void ode_release(Ode *o)
{
    N_VDestroy(o->y);
    N_VDestroy(o->tolerance);
    N_VDestroy(o->between);
    SUNContext_Free(&o->context);
}

/* Shows a state to who asked for samples. */
static void send_sample(Ode *o, double t, double spacing, const double y[])
{
    const SimModel *model = o->model;
    const int m = model->m;
    double force[FLOORS_MAX];
    contacts_forces(&o->contacts, y, y + m, force);
    const MatState mat = contacts_mat(&o->contacts, y);
    SimSample s = {.t = t,
                   .spacing = spacing,
                   .ground = ground(o, t),
                   .n_modes = m,
                   .n_building = model->nb,
                   .omega = model->omega,
                   .q = y,
                   .v = y + m,
                   .force = force,
                   .plastic = model->yields ? y + storeys_at(o) : NULL,
                   .mat_nm = mat.force_nm,
                   .input_j = NAN,
                   .contacts_j = NAN};
    if (o->with_energies) {
        s.damped_j = y + 2 * m;
        s.input_j = y[3 * m];
        const double *W = y + storeys_at(o) + model->n;
        double d[FLOORS_MAX], taken = 0; /* [J] by storeys: hysteresis less what the modes hold of them too much */
        if (model->yields)
            storeys_drifts(model, y, d);
        for (int j = 0; model->yields && j < model->n; j++)
            taken += W[j] - 0.5 * model->yield_n_m[j] * d[j] * d[j];
        s.contacts_j = y[3 * m + 1] + y[3 * m + 2] + contacts_stored(&o->contacts, y) + taken;
        if (model->n_devices > 0)
            s.contacts_j += y[3 * m + 3] + devices_look(model, y, y + m, o->account.device);
        s.contacts_j += mat.taken;
    }
    o->options->sample(&s, o->options->sample_user);
}

/* Samples in the step that was just made to t, the motion's sampling interval halved until they are near enough. */
static int send_samples(Ode *o, double t)
{
    const double wanted = o->options->sample_spacing, dt = o->motion->dt_s;
    const double end = floor(o->options->duration / dt * (1 + 1e-14)) * dt; /* of the last whole interval */
    double spacing = dt;
    while (wanted > 0 && spacing > wanted * (1 + 1e-12))
        spacing *= 0.5;
    for (;;) {
        const double at = (double)o->samples * spacing;
        if (at > fmin(t, end) * (1 + 1e-12))
            return 0;
        if (o->samples > 0 && o->solver->interpolate(o, fmin(at, t), o->between))
            return -1;
        send_sample(o, at, spacing, ode_values(o->samples > 0 ? o->between : o->y));
        o->samples++;
    }
}

/* Notes the peaks at a state, and its powers for so many seconds. */
static void sample(Ode *o, double t, const double y[], double seconds)
{
    const SimModel *model = o->model;
    double contact[MODES_MAX] = {0}, force[FLOORS_MAX] = {0};
    o->a_sampled = ground(o, t);
    o->power_sampled = contacts_add(&o->contacts, y, y + model->m, contact);
    if (model->yields)
        storeys_add(model, y + storeys_at(o), contact);
    o->power_sampled.pushed = add_forces(o, t, y + model->m, contact);
    memcpy(o->v_sampled, y + model->m, sizeof *y * (size_t)model->m);
    energy_account_peaks(&o->account, t, y, y + model->m, contact);
    const MatState mat = contacts_mat(&o->contacts, y);
    o->account.mat_turned = fmax(o->account.mat_turned, mat.turned);
    if (o->contacts.forces) {
        const FloorSet in_contact = model->nc ? contacts_record(&o->contacts, t, y, y + model->m, force) : 0;
        force_monitor_point(o->contacts.forces, &(ForcePoint){.t = t,
                                                              .ground = o->a_sampled,
                                                              .building_q = y,
                                                              .building_v = y + model->m,
                                                              .core_q = y + model->nb,
                                                              .force = force,
                                                              .plastic = model->yields ? y + storeys_at(o) : NULL,
                                                              .mat_nm = mat.force_nm,
                                                              .in_contact = in_contact});
    }
    if (!o->with_energies)
        energy_account_add(&o->account, seconds, o->v_sampled, o->a_sampled, &o->power_sampled);
}

/* The step just made from t_before to t, by the integrator's own interpolant: Gauss-Lobatto, four points a panel. */
static int sample_step(Ode *o, double t_before, double t)
{
    static const double X[] = {0.27639320225002103, 0.72360679774997897, 1}, WEIGHT[] = {5 / 12.0, 5 / 12.0, 1 / 12.0};
    const double panels = ceil((t - t_before) / o->panel), h = (t - t_before) / panels;
    for (double k = 0; k < panels; k++) {
        if (!o->with_energies)
            energy_account_add(&o->account, h / 12, o->v_sampled, o->a_sampled, &o->power_sampled);
        for (int i = 0; i < 3; i++) {
            const int at_end = i == 2 && k == panels - 1;
            const double at = at_end ? t : t_before + h * (k + X[i]);
            if (!at_end && o->solver->interpolate(o, at, o->between))
                return -1;
            sample(o, at, ode_values(at_end ? o->y : o->between), h * WEIGHT[i]);
        }
    }
    return 0;
}

/* Behind a change the integrator forgets what was before; each root is looked for in the direction that it has now. */
static int start_anew(Ode *o, double t, double t_stop)
{
    int directions[2 * FLOORS_MAX];
    for (int j = 0; j < o->model->n; j++) {
        directions[j] = o->contacts.side[j] ? -1 : 1;
        directions[o->model->n + j] = o->storeys.side[j] ? -1 : 1;
    }
    if (o->solver->restart(o, t) || (ode_n_roots(o) > 0 && o->solver->look_for(o, directions)))
        return -1;
    return o->solver->stop_at(o, t_stop);
}

/* What the roots are of, at one end of a step: w from the middle of the gap and w' of the floors, then d - p and d' of
 * the storeys that yield. */
typedef struct {
    double w[2 * FLOORS_MAX], w_dot[2 * FLOORS_MAX];
} Floors;

/* At the end of the step that was made last. */
static void floors_now(const Ode *o, Floors *f)
{
    const SimModel *model = o->model;
    const double *y = ode_values(o->y);
    floors_from_modes(model, 0, model->m, y, f->w);
    floors_from_modes(model, 0, model->m, y + model->m, f->w_dot);
    for (int j = 0; j < model->n; j++)
        f->w[j] -= model->middle[j];
    if (!model->yields)
        return;
    storeys_drifts(model, y, f->w + model->n);
    storeys_drifts(model, y + model->m, f->w_dot + model->n);
    for (int j = 0; j < model->n; j++)
        f->w[model->n + j] -= y[storeys_at(o) + j];
}

/* Root j at a state of dense output: w from the middle of the gap or d - p, or its rate. */
static double watched(const Ode *o, int j, int rate, const double y[])
{
    const SimModel *model = o->model;
    const double *q = y + (rate ? model->m : 0);
    double d[FLOORS_MAX];
    if (j < model->n)
        return relative_displacement(model, j, q) - (rate ? 0 : model->middle[j]);
    storeys_drifts(model, q, d);
    return d[j - model->n] - (rate ? 0 : y[storeys_at(o) + j - model->n]);
}

/* What its magnitude is compared with. */
static double bound_of(const Ode *o, int j)
{
    return j < o->model->n ? o->model->gap[j] : o->model->yield_m[j - o->model->n];
}

/* The time in (low, high) where the penetration, or side w' with `speed`, of floor j changes sign, by dense output; the
 * end where it is positive. */
static double change_of_sign(Ode *o, int j, int side, int speed, double low, double high)
{
    for (int i = 0; i < 60 && high - low > 1e-15 * high; i++) {
        const double mid = 0.5 * (low + high);
        if (o->solver->interpolate(o, mid, o->between))
            return high;
        const double now = side * watched(o, j, speed, ode_values(o->between));
        const int past = speed ? now < 0 : now > bound_of(o, j);
        *(past ? &high : &low) = mid;
    }
    return high;
}

/* A top that passes the gap by less than this share of it is rounding, which would open the contact again at once. */
static const double GRAZE = 1e-11;

/* When the gap of an open floor closed, where its path has turned back within the step; else infinity. */
static double unseen_closing(Ode *o, int j, double t_before, double t, const Floors *from, const Floors *to)
{
    const int n = o->model->n, open = j < n
                                          ? !o->contacts.side[j]
                                          : o->model->storey_law.kind == HYSTERESIS_BILINEAR && !o->storeys.side[j - n];
    const double gap = bound_of(o, j), third = (t - t_before) / 3;
    const int side = to->w[j] > 0 ? 1 : -1;
    if (!open || !(side * from->w_dot[j] > 0 && side * to->w_dot[j] < 0) || side * from->w[j] > gap ||
        side * to->w[j] > gap || /* the cubic's control points enclose it */
        fmax(side * (from->w[j] + third * from->w_dot[j]), side * (to->w[j] - third * to->w_dot[j])) <= gap)
        return HUGE_VAL;
    const double top = change_of_sign(o, j, side, 1, t_before, t);
    if (o->solver->interpolate(o, top, o->between) ||
        !(side * watched(o, j, 0, ode_values(o->between)) > gap * (1 + GRAZE)))
        return HUGE_VAL;
    return change_of_sign(o, j, side, 0, t_before, top);
}

/* From *t to t_stop. */
static RunOutcome cross(Ode *o, double *t, double t_stop)
{
    const SimModel *model = o->model;
    const double *y = ode_values(o->y);
    if (o->solver->stop_at(o, t_stop))
        return RUN_ENGINE_FAILED;
    Floors from, to;
    floors_now(o, &from);
    while (t_stop - *t > 1e-12 * (1 + t_stop)) {
        if (o->account.steps++ >= o->steps_max)
            return RUN_OUT_OF_STEPS;
        const double t_before = *t;
        if (o->stuck >= STUCK_MAX)
            return RUN_ENGINE_FAILED;
        const int flag = o->solver->step(o, t_stop, t);
        if (flag < 0) /* it has tried again with shorter steps before it says so */
            return o->finite ? RUN_ENGINE_FAILED : RUN_NOT_FINITE;

        /* A gap that closes and opens again inside one step changes no sign that a root is found by: back to the first
         * such closing, if any. */
        int found[2 * FLOORS_MAX] = {0}, floor = -1;
        double first = HUGE_VAL;
        floors_now(o, &to);
        for (int j = 0; j < ode_n_roots(o); j++) {
            const double closing = unseen_closing(o, j, t_before, *t, &from, &to);
            floor = closing < first ? j : floor;
            first = fmin(closing, first);
        }
        if (floor >= 0 && o->solver->interpolate(o, first, o->y) == 0) {
            found[floor] = 1;
            *t = first;
            floors_now(o, &to);
        } else if (flag == ODE_ROOT)
            o->solver->found(o, found);
        from = to;
        peak_monitor_break(&o->account.peaks, 1);
        if (sample_step(o, t_before, *t) || (o->options->sample && send_samples(o, *t)))
            return RUN_ENGINE_FAILED;
        o->stuck = *t - t_before < NOWHERE * (1 + *t) ? o->stuck + 1 : 0;

        /* Where contacts or yielding have changed, integration starts anew. */
        int flipped = model->nc > 0 && contacts_switch(&o->contacts, *t, y, y + model->m, found);
        if (model->yields)
            flipped |= storeys_switch(&o->storeys, to.w + model->n, to.w_dot + model->n, found + model->n);
        if (flipped && start_anew(o, *t, t_stop))
            return RUN_ENGINE_FAILED;
    }
    return RUN_OK;
}

/* Every straight stretch of the motion in turn, or the motion as a whole; then the ground at rest. */
static RunOutcome walk(Ode *o)
{
    const double duration = o->options->duration, dt = o->motion->dt_s;
    const long samples = (long)o->motion->n;
    double t = 0;
    sample(o, 0, ode_values(o->y), 0);
    if (o->options->sample && send_samples(o, 0))
        return RUN_ENGINE_FAILED;
    if (start_anew(o, 0, duration))
        return RUN_ENGINE_FAILED;
    for (long k = o->stop_at_samples ? 0 : samples - 2; k + 1 < samples && t < duration; k++) {
        o->interval = k;
        const RunOutcome outcome = cross(o, &t, fmin((double)(k + 1) * dt, duration));
        if (outcome != RUN_OK)
            return outcome;
    }
    o->interval = samples;
    if (t < duration && start_anew(o, t, duration)) /* the acceleration may jump */
        return RUN_ENGINE_FAILED;
    return cross(o, &t, duration);
}

Status ode_run(Ode *o, SimResult *result)
{
    const int m = o->model->m;
    const double *y = ode_values(o->y);
    const unsigned mode = denormal_off();
    result->outcome = o->model->yields && !o->with_energies ? RUN_ENGINE_FAILED : walk(o);
    denormal_restore(mode);
    if (result->outcome != RUN_OK) {
        char *why = result->reason;
        const size_t size = sizeof result->reason;
        const PeakMonitor *peaks = &o->account.peaks;
        const double t = peaks->count ? peaks->ring[(peaks->count + 2) % 3].t : 0;
        if (o->model->yields && !o->with_energies)
            snprintf(why, size, "%s: follows no storeys that yield", o->solver->package);
        else if (result->outcome == RUN_OUT_OF_STEPS)
            snprintf(why, size, "t = %.6g s: %ld steps did not reach %g s", t, o->account.steps, o->options->duration);
        else if (result->outcome == RUN_NOT_FINITE)
            snprintf(why, size, "t = %.6g s: motion or response is not a finite number", t);
        else if (o->stuck >= STUCK_MAX)
            snprintf(why, size, "t = %.6g s: %d steps in a row got nowhere", t, STUCK_MAX);
        else
            snprintf(why, size, "t = %.6g s: %s: %s", t, o->solver->package, o->message);
        return STATUS_OK;
    }
    if (o->with_energies) {
        memcpy(o->account.damped, y + 2 * m, sizeof *y * (size_t)m);
        o->account.input = y[3 * m];
        o->account.lost = y[3 * m + 1];
        o->account.clamp = y[3 * m + 2];
        o->account.devices = o->model->n_devices > 0 ? y[3 * m + 3] : 0;
    }
    const double *p = y + storeys_at(o);
    double d[FLOORS_MAX];
    if (o->model->yields) {
        storeys_drifts(o->model, y, d);
        storeys_energies(o->model, d, p, p + o->model->n, result);
    }
    energy_account_report(&o->account, &o->contacts, o->options, y, y + m, result);
    if (o->model->yields)
        model_report_plastic(o->model, p, result);
    return STATUS_OK;
}
