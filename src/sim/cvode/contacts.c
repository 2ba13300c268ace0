#include "sim/cvode/contacts.h"

#include "base/clones.h"

CLONED double dot_product(int n, const double a[], const double b[])
{
    double sum[8] = {0};
    int i = 0;
    for (; i + 8 <= n; i += 8)
        for (int k = 0; k < 8; k++)
            sum[k] += a[i + k] * b[i + k];
    for (; i < n; i++)
        sum[0] += a[i] * b[i];
    return ((sum[0] + sum[4]) + (sum[1] + sum[5])) + ((sum[2] + sum[6]) + (sum[3] + sum[7]));
}

double relative_displacement(const SimModel *model, int j, const double q[])
{
    return dot_product(model->m, model->RT + (size_t)j * (size_t)model->m_pad, q);
}

CLONED static void push_modes(int m, const double row[], double f, double g[])
{
    for (int i = 0; i < m; i++)
        g[i] += f * row[i];
}

static double apart(const SimModel *model, int e, const double x[])
{
    return dot_product(model->m, model->B + (size_t)e * (size_t)model->m_pad, x);
}

/* [N] By which device e pulls its floor back; *power: what it dissipates [W]. */
static double device_pull(const SimModel *model, int e, const double q[], const double v[], double *power)
{
    double slope;
    const double rate = apart(model, e, v), viscous = device_viscous(&model->device[e], rate, &slope);
    *power += rate * viscous;
    return viscous + model->device[e].stiffness * apart(model, e, q);
}

MatState contacts_mat(const Contacts *c, const double q[])
{
    const int e = c->model->n_devices - 1;
    if (!c->model->may_lift)
        return (MatState){0};
    const Uplift *u = &c->model->device[e].lifts;
    const double d = apart(c->model, e, q);
    const double *y = c->mat_at ? q + c->mat_at : (double[MAT_STATES]){uplift_lifted(u, d)};
    const double g = y[MAT_LIFTED], held = uplift_held(u, d, y);
    return (MatState){-u->whole * g, g != 0 ? fabs(d + g) : 0, held, c->mat_at ? y[MAT_WORK] : held};
}

double devices_look(const SimModel *model, const double q[], const double v[], DevicePeak peak[])
{
    double held = 0, power = 0;
    for (int e = 0; e < model->n_devices - model->may_lift; e++) {
        const double d = apart(model, e, q);
        if (peak)
            peak[e] = (DevicePeak){fmax(peak[e].stroke, fabs(d)),
                                   fmax(peak[e].force, fabs(device_pull(model, e, q, v, &power)))};
        held += 0.5 * model->device[e].stiffness * d * d;
    }
    return held;
}

/* Of floor j towards side s when it gets there, by constant acceleration from the start of the step; *wait [s] until.
 */
static double approach(const Contacts *c, int j, int s, double *wait)
{
    const double way = fmax(-penetration(c->model, j, s, relative_displacement(c->model, j, c->q_before)), 0);
    const double v = s * relative_displacement(c->model, j, c->v_before);
    const double square = v * v + 2 * way * s * relative_displacement(c->model, j, c->a_before);
    const double speed = square > 0 ? sqrt(square) : 0;
    *wait = v + speed > 0 ? 2 * way / (v + speed) : 0;
    return v < 0 && way == 0 ? 0 : speed;
}

double contacts_speed(const Contacts *c, int j, int s)
{
    double wait;
    return c->side[j] == s ? c->v0[j] : fmax(approach(c, j, s, &wait), c->model->contact[j].v0_floor);
}

/* The force of a floor that touches on side s with penetration p > 0, added to g. */
static void add_contact(const Contacts *c, int j, int s, double p, const double v[], double g[], ContactPower *power)
{
    const SimModel *model = c->model;
    const double p_dot = s * relative_displacement(model, j, v);
    const ContactForce f = contact_force(&model->contact[j], model->mass_eff[j], p, p_dot, contacts_speed(c, j, s));
    push_modes(model->m, model->RT + (size_t)j * (size_t)model->m_pad, -s * f.force, g);
    power->lost += (f.raw - f.elastic) * p_dot;
    power->clamp += (f.force - f.raw) * p_dot;
}

ContactPower contacts_add(const Contacts *c, const double q[], const double v[], double g[])
{
    const SimModel *model = c->model;
    const int n = model->n_devices - model->may_lift;
    ContactPower power = {0};
    for (int e = 0; e < n; e++)
        push_modes(model->m, model->B + (size_t)e * (size_t)model->m_pad, -device_pull(model, e, q, v, &power.devices),
                   g);
    if (model->may_lift)
        push_modes(model->m, model->B + (size_t)n * (size_t)model->m_pad, -contacts_mat(c, q).force_nm, g);
    if (model->nc == 0)
        return power;
    double w[FLOORS_MAX];
    if (c->by_overlap)
        floors_from_modes(model, 0, model->m, q, w);
    for (int j = 0; j < model->n; j++) {
        if (!c->by_overlap && c->side[j]) {
            const double p = penetration(model, j, c->side[j], relative_displacement(model, j, q));
            if (p > 0) /* past the root: the law's continuation, continuous with its first derivative */
                add_contact(c, j, c->side[j], p, v, g, &power);
        } else if (c->by_overlap) {
            const int s = w[j] > model->middle[j] ? 1 : -1;
            if (penetration(model, j, s, w[j]) > 0)
                add_contact(c, j, s, penetration(model, j, s, w[j]), v, g, &power);
        }
    }
    return power;
}

/* A contact begins: counted, shown to who follows forces and onsets. */
static void close_gap(Contacts *c, int j, int side, double t, double speed)
{
    c->side[j] = side;
    c->v0[j] = fmax(speed, c->model->contact[j].v0_floor);
    c->impacts++;
    c->closings[j]++;
    c->floored += speed < c->model->contact[j].v0_floor;
    c->recorded[j] = c->recorded_loss[j] = 0;
    if (c->forces)
        force_monitor_onset(c->forces, j, side, t, speed);
    if (c->log && c->log->n < c->log->n_max)
        c->log->at[c->log->n++] = (ContactOnset){.floor = j, .t = t, .speed = speed};
}

int contacts_switch(Contacts *c, double t, const double q[], const double v[], const int found[])
{
    const SimModel *model = c->model;
    int flipped = 0;
    for (int j = 0; j < model->n; j++) {
        const double w = relative_displacement(model, j, q), w_dot = relative_displacement(model, j, v);
        const int side = c->side[j] ? c->side[j] : w > model->middle[j] ? 1 : -1;
        const double p = penetration(model, j, side, w), p_dot = side * w_dot;
        if (!c->side[j] && (found[j] || (p > 0 && p_dot > 0))) {
            close_gap(c, j, side, t, p_dot);
            flipped = 1;
        } else if (c->side[j] && (found[j] || (p < 0 && p_dot <= 0))) {
            c->side[j] = 0;
            if (c->forces)
                force_monitor_end(c->forces, j, t, -p_dot);
            if (!(model->gap[j] > 0)) /* leaves one side onto the other */
                close_gap(c, j, -side, t, -p_dot);
            flipped = 1;
        }
    }
    return flipped;
}

void contacts_settle(Contacts *c, const double w[])
{
    double wait;
    for (int j = 0; j < c->model->n && c->model->nc > 0; j++) {
        const int s = w[j] > c->model->middle[j] ? 1 : -1;
        if (!(penetration(c->model, j, s, w[j]) > 0)) {
            c->side[j] = 0;
        } else if (c->side[j] != s) {
            const double speed = approach(c, j, s, &wait);
            close_gap(c, j, s, c->t_before + wait, speed);
        }
    }
}

/* By event: the force of floor j at its penetration p [m] and rate [m/s]; none where it does not touch. */
static ContactForce floor_force(const Contacts *c, int j, const double q[], const double v[], double *p, double *p_dot)
{
    const SimModel *model = c->model;
    const int s = c->side[j];
    *p = penetration(model, j, s, relative_displacement(model, j, q));
    *p_dot = s * relative_displacement(model, j, v);
    return s && *p > 0 ? contact_force(&model->contact[j], model->mass_eff[j], *p, *p_dot, c->v0[j])
                       : (ContactForce){0};
}

FloorSet contacts_record(Contacts *c, double t, const double q[], const double v[], double force[])
{
    const SimModel *model = c->model;
    const double half = 0.5 * (t - c->t_recorded);
    FloorSet in_contact = 0;
    for (int j = 0; j < model->n; j++) {
        const int s = c->side[j];
        double p, p_dot;
        const ContactForce f = floor_force(c, j, q, v, &p, &p_dot);
        const double loss = (f.raw - f.elastic) * p_dot;
        if (s)
            force_monitor_contact(c->forces, j, half * (c->recorded[j] + f.force), half * (c->recorded_loss[j] + loss),
                                  f.force, contact_indentation(&model->contact[j], p));
        c->recorded[j] = f.force;
        c->recorded_loss[j] = loss;
        force[j] = -s * f.force;
        in_contact |= (FloorSet)(f.force > 0) << j;
    }
    c->t_recorded = t;
    return in_contact;
}

void contacts_forces(const Contacts *c, const double q[], const double v[], double force[])
{
    const SimModel *model = c->model;
    for (int j = 0; j < model->n; j++) {
        double p = 0, p_dot;
        const double f = model->nc > 0 ? floor_force(c, j, q, v, &p, &p_dot).force : 0;
        force[j] = c->side[j] && p > 0 ? -c->side[j] * f : 0;
    }
    for (int e = 0; e < model->n_devices - model->may_lift; e++) {
        double power = 0;
        force[model->device[e].floor] -= device_pull(model, e, q, v, &power);
    }
}

int contacts_any(const Contacts *c)
{
    int any = 0;
    for (int j = 0; j < c->model->n; j++)
        any |= c->side[j];
    return any != 0;
}

double contacts_stored(const Contacts *c, const double q[])
{
    double stored = 0;
    for (int j = 0; j < c->model->n && c->model->nc > 0; j++)
        if (c->side[j])
            stored += contact_stored(&c->model->contact[j],
                                     penetration(c->model, j, c->side[j], relative_displacement(c->model, j, q)));
    return stored;
}
