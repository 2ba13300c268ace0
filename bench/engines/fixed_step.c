#include "bench/engines/fixed_step.h"

#include <string.h>

#include "base/denormal.h"

/* [s] Shortest interval between samples of the peaks. */
static const double PEAKS_EVERY = 1e-3, PEAKS_IN_CONTACT = 1e-4;

static const double STEPS_MAX = 1e9;

ContactPower fixed_step_forces(FixedStep *m, const double q[], const double v[], double g[])
{
    memset(g, 0, sizeof *g * (size_t)m->model->m);
    m->account.evaluations++;
    return contacts_add(&m->contacts, q, v, g);
}

static int is_finite(const FixedStep *m)
{
    double sum = 0;
    for (int i = 0; i < m->model->m; i++)
        sum += 0 * m->q[i] + 0 * m->v[i];
    return sum == 0;
}

/* At the end of a step: contacts as they are now. The peaks' arc ends where one has begun or ended. */
static void settle(FixedStep *m)
{
    double w[FLOORS_MAX];
    int before[FLOORS_MAX];
    if (m->model->nc > 0) {
        memcpy(before, m->contacts.side, sizeof before);
        floors_from_modes(m->model, 0, m->model->m, m->q, w);
        contacts_settle(&m->contacts, w);
        if (memcmp(before, m->contacts.side, sizeof before) != 0)
            peak_monitor_break(&m->account.peaks, 0);
    }
    m->power = fixed_step_forces(m, m->q, m->v, m->contact);
}

/* For the approach speeds of gaps that close in this step. A mode that swings within the step is taken at its speed. */
static void remember_start(FixedStep *m, double a)
{
    const SimModel *model = m->model;
    Contacts *c = &m->contacts;
    c->t_before = m->t;
    for (int i = 0; i < model->m; i++) {
        const double w = model->omega[i], pull = -w * (2 * model->zeta[i] * m->v[i] + w * m->q[i]);
        c->q_before[i] = m->q[i];
        c->v_before[i] = m->v[i];
        c->a_before[i] = w * m->h < 1 ? pull + m->contact[i] - model->gamma[i] * a : 0;
    }
}

/* Contacts and forces at the end of a step, for who asked for them. */
static void record_forces(FixedStep *m, double ground)
{
    const SimModel *model = m->model;
    double force[FLOORS_MAX] = {0};
    const FloorSet in = model->nc > 0 ? contacts_record(&m->contacts, m->t, m->q, m->v, force) : 0;
    force_monitor_point(m->contacts.forces, &(ForcePoint){.t = m->t,
                                                          .ground = ground,
                                                          .building_q = m->q,
                                                          .building_v = m->v,
                                                          .core_q = m->q + model->nb,
                                                          .force = force,
                                                          .in_contact = in});
}

/* From sample to sample (or to the end of the run), ground acceleration from a0 to a1. */
static RunOutcome cross_interval(FixedStep *m, const FixedStepMethod *method, void *work, double length,
                                 double step_max, double a0, double a1)
{
    const long n = (long)fmax(1, ceil(length / step_max * (1 - 1e-12)));
    const double t0 = m->t, h = length / (double)n;
    if (!(fabs(h / m->h - 1) < 1e-12)) {
        m->h = h;
        method->prepare(m, work);
    }
    for (long k = 0; k < n; k++) {
        const double from = a0 + (a1 - a0) * (double)k / (double)n, to = a0 + (a1 - a0) * (double)(k + 1) / (double)n;
        remember_start(m, from);
        energy_account_add(&m->account, method->at_start * h, m->v, from, &m->power);
        if (!method->advance(m, from, to, work))
            return RUN_ENGINE_FAILED;
        m->t = t0 + h * (double)(k + 1);
        m->account.steps++;
        if (!is_finite(m))
            return RUN_NOT_FINITE;
        settle(m);
        if (m->contacts.forces)
            record_forces(m, to);
        energy_account_add(&m->account, method->at_end * h, m->v, to, &m->power);
        const double since = m->t - m->peaks_at;
        if (since > (contacts_any(&m->contacts) ? PEAKS_IN_CONTACT : PEAKS_EVERY) * (1 - 1e-9) || k == n - 1) {
            m->peaks_at = m->t;
            energy_account_peaks(&m->account, m->t, m->q, m->v, m->contact);
        }
    }
    return RUN_OK;
}

/* Every sampling interval in turn; after the last sample the ground is at rest. */
static RunOutcome walk(FixedStep *m, const FixedStepMethod *method, void *work, const Motion *motion, double duration,
                       double step_max)
{
    RunOutcome outcome = RUN_OK;
    if (duration / step_max > STEPS_MAX)
        return RUN_OUT_OF_STEPS;
    energy_account_peaks(&m->account, 0, m->q, m->v, m->contact);
    for (size_t k = 0; m->t < duration * (1 - 1e-14) && outcome == RUN_OK; k++) {
        const int shaking = k + 1 < motion->n;
        const double a0 = shaking ? motion->accel[k] : 0, a1 = shaking ? motion->accel[k + 1] : 0;
        const double left = duration - m->t, length = fmin(left, motion->dt_s);
        outcome = cross_interval(m, method, work, length, step_max, a0, a0 + (a1 - a0) * length / motion->dt_s);
        if (m->t < duration * (1 - 1e-14) && outcome == RUN_OK)
            m->t = (double)(k + 1) * motion->dt_s; /* without the rounding of many steps */
    }
    return outcome;
}

static void explain(const FixedStep *m, SimResult *result)
{
    if (m->model->yields)
        snprintf(result->reason, sizeof result->reason, "follows no storeys that yield");
    else if (result->outcome == RUN_OUT_OF_STEPS)
        snprintf(result->reason, sizeof result->reason, "more than %.0e steps would be needed", STEPS_MAX);
    else if (result->outcome == RUN_NOT_FINITE)
        snprintf(result->reason, sizeof result->reason, "t = %.6g s, step %.3g s: the response is not finite", m->t,
                 m->h);
    else
        snprintf(result->reason, sizeof result->reason, "t = %.6g s, step %.3g s: %s", m->t, m->h, m->trouble);
}

Status fixed_step_run(const FixedStepMethod *method, void *work, const SimModel *model, const Motion *motion,
                      const EngineOptions *options, SimResult *result)
{
    FixedStep m = {.model = model,
                   .contacts = {.model = model, .by_overlap = 1, .log = options->onsets, .forces = options->forces}};
    if (options->forces)
        force_monitor_start(options->forces, model->nc - model->has_mass, options->duration);
    energy_account_start(&m.account, model);
    memset(result, 0, sizeof *result);
    result->n_floors = model->n;
    result->n_modes = model->n;
    const double step_max = options->tolerance > 0 ? options->tolerance : method->step[options->accuracy];
    const unsigned mode = denormal_off();
    result->outcome = model->yields ? RUN_ENGINE_FAILED : walk(&m, method, work, motion, options->duration, step_max);
    denormal_restore(mode);
    if (result->outcome == RUN_OK)
        energy_account_report(&m.account, &m.contacts, options, m.q, m.v, result);
    else
        explain(&m, result);
    return STATUS_OK;
}
