/* sim/fast/kernel.c -- time and results of the engine `fast`. Compiled once per instruction set with FAST_KERNEL naming
 * the entry and FAST_LANES the width of a vector; see fast.h for the method. */
#include "sim/fast/kernel.h"

#include <math.h>
#include <string.h>

#include "base/units.h"
#include "sim/fast/contact_step.h"
#include "sim/fast/glide.h"
#include "sim/energy_balance.h"

/* The level whose step is the wanted share of the shortest Hertz contact at the present speed (or the finest). */
static int contact_level(const FastWork *k, double gain)
{
    const double speed = k->speed + gain;
    int level = 0;
    while (level < LEVEL_MAX && speed > k->level[level].speed_max)
        level++;
    return level;
}

/* Duration of the shortest contact at 1 m/s; it goes with speed^-0.2. */
static double shortest_contact(const SimModel *model)
{
    double least = 1e300;
    for (int j = 0; j < model->n; j++)
        least = fmin(least, contact_hertz_duration(model->contact.k, model->mass_eff[j], 1.0));
    return least;
}

/* What the energy of one step's error is measured by: the input so far. */
static double energy_scale(const FastWork *k)
{
    vec sum = {0};
    for (int i = 0; i < k->mf; i++)
        sum += k->ground[i];
    return fabs(lanes_sum(sum));
}

/* Will an open gap have closed after h at the present speed? */
static int closing_ahead(const FastWork *k, double h)
{
    mask ahead = {0};
    for (int f = 0; f < k->nf; f++)
        ahead |= (vec_abs(k->w[f] + h * k->wd[f]) > k->gap[f]) & (vec_abs(k->w[f]) <= k->gap[f]);
    return any(ahead);
}

/* One sampling interval from `start` [s] on, ground acceleration from a0 to a1; 0 when no step is short enough. */
static int interval(FastWork *k, double start, double a0, double a1)
{
    const uint32_t whole = UINT32_C(1) << LEVEL_MAX;
    uint32_t at = 0;
    k->energy_scale = energy_scale(k);
    /* at rest for a moment is no reason for a step in which the ground makes speed again */
    const double gain = 0.1 * k->base * fmax(fabs(a0), fabs(a1));
    while (at < whole) {
        if ((double)(k->steps + k->flights) > k->knobs->steps_max)
            return 0;
        const int aligned = at ? LEVEL_MAX - __builtin_ctz(at) : 0;
        const int finest = k->m_pad > k->nb_pad ? contact_level(k, gain) : LEVEL_MAX;
        int level = k->flight_level > aligned ? k->flight_level : aligned, done = 0;
        for (; !done && !k->touching && level < finest; level++) {
            const uint32_t step = whole >> level;
            done =
                flight(k, level_ready(k, level, 0), a0 + (a1 - a0) * at / whole, a0 + (a1 - a0) * (at + step) / whole);
            if (done) {
                at += step;
                k->flight_level = level > 0 ? level - 1 : 0;
                k->touch_level = LEVEL_MAX;
            }
        }
        if (done)
            continue;
        k->now = start + k->base * at / whole;
        k->flight_level = finest > 0 ? finest - 1 : 0;
        if (k->touch_level > finest || k->knobs->energy_tolerance == 0)
            k->touch_level = finest;
        while (k->touch_level < finest && k->landed && closing_ahead(k, ldexp(k->base, -k->touch_level)))
            k->touch_level++;
        for (level = k->touch_level > aligned ? k->touch_level : aligned; !done && level <= LEVEL_MAX; level++) {
            const uint32_t step = whole >> level;
            done = contact_step(k, level_ready(k, level, 1), a0 + (a1 - a0) * at / whole,
                                a0 + (a1 - a0) * (at + step) / whole, level - finest);
            if (done) {
                at += step;
                k->touch_level = k->may_grow && level > 0 ? level - 1 : level;
            }
        }
        if (!done)
            return 0;
    }
    return 1;
}

static int state_is_finite(const FastWork *k)
{
    vec sum = {0};
    for (int i = 0; i < k->mf; i++)
        sum += k->q[i] * 0.0 + k->v[i] * 0.0;
    double all = 0;
    for (int lane = 0; lane < LANES; lane++)
        all += sum[lane];
    return all == 0;
}

static void show(const FastWork *k, double t)
{
    const SimSample sample = {
        .t = t,
        .n_modes = k->m_pad,
        .n_building = k->nb_pad,
        .omega = scalars_const(k->omega),
        .q = scalars_const(k->q),
        .v = scalars_const(k->v),
        .ground_j = scalars_const(k->ground),
        .contact_j = scalars_const(k->work),
        .contact_loss_j = k->contact_lost,
        .contact_clamp_j = k->contact_clamped,
    };
    if (k->options->sample)
        k->options->sample(&sample, k->options->sample_user);
}

typedef struct {
    double start, end; /* [m/s2] */
} Ramp;

/* Ground acceleration over interval i; after the last sample it stands still. */
static Ramp ground(const Motion *motion, long i)
{
    return i + 1 < (long)motion->n ? (Ramp){motion->accel[i], motion->accel[i + 1]} : (Ramp){0, 0};
}

/* Glides over intervals first.. while it can; returns how many, 0 where the next one must be looked at. */
static long glide(FastWork *k, const Motion *motion, long first, long end)
{
    double impulse = 0;
    if (!k->may_glide || k->touching || first < k->glide_from || end - first < GLIDE_LEAST)
        return 0;
    const long n = k->glide_wish < end - first ? k->glide_wish : end - first;
    for (long i = first; i < first + n; i++) {
        const Ramp a = ground(motion, i);
        impulse += 0.5 * motion->dt_s * (fabs(a.start) + fabs(a.end));
    }
    if (!glides(k, impulse)) {
        k->glide_from = n > GLIDE_LEAST ? first : first + GLIDE_LEAST;
        k->glide_wish = GLIDE_LEAST;
        return 0;
    }
    k->glide_wish = n < GLIDE_MOST ? 2 * n : n;
    const Level *l = level_ready(k, 0, 0);
    for (long i = first; i < first + n; i++) {
        if (i > first)
            show(k, (double)i * motion->dt_s);
        const Ramp a = ground(motion, i);
        glide_interval(k, l, a.start, a.end);
    }
    k->flights += n;
    glide_end(k);
    return n;
}

static int fly(FastWork *k, const Motion *motion, double duration)
{
    k->shortest_at_1 = shortest_contact(k->model);
    const long full = (long)floor(duration / motion->dt_s * (1 + 1e-14));
    k->flight_level = 0;
    k->glide_from = 0;
    k->glide_wish = GLIDE_LEAST;
    k->touch_level = LEVEL_MAX;
    set_base(k, 0);
    set_base(k, motion->dt_s);
    show(k, 0);
    for (long i = 0; i < full;) {
        const long glided = glide(k, motion, i, full);
        const Ramp a = ground(motion, i);
        if ((!glided && !interval(k, (double)i * motion->dt_s, a.start, a.end)) || !state_is_finite(k))
            return 0;
        i += glided ? glided : 1;
        show(k, (double)i * motion->dt_s);
    }
    const double rest = duration - (double)full * motion->dt_s;
    if (rest > 1e-9 * motion->dt_s) {
        const Ramp a = ground(motion, full);
        set_base(k, rest);
        return interval(k, duration - rest, a.start, a.start + (a.end - a.start) * rest / motion->dt_s) &&
               state_is_finite(k);
    }
    return 1;
}

static double still_stored(const FastWork *k)
{
    double stored = 0;
    for (int j = 0; j < k->n; j++)
        if (k->side[j])
            stored += contact_stored(&k->model->contact, fabs(scalars_const(k->w)[j]) - scalars_const(k->gap)[j]);
    return stored;
}

static double share(double part, double whole)
{
    return whole > 0 ? 100 * part / whole : 0;
}

static void sum_energies(const FastWork *k, SimResult *r)
{
    double contact_work = 0, missed = 0;
    double damped[MODES_PAD_MAX + 2 * LANES];
    for (int i = 0; i < k->m_pad; i++) {
        const double q = scalars_const(k->q)[i], v = scalars_const(k->v)[i], w = scalars_const(k->omega)[i];
        const double energy = 0.5 * (v * v + w * w * q * q);
        const double ground = scalars_const(k->ground)[i], contact = scalars_const(k->work)[i];
        damped[i] = ground + contact - energy;
        r->input_energy_j += ground;
        contact_work += contact;
        missed += scalars_const(k->drift)[i] * scalars_const(k->drift)[i];
        r->kinetic_strain_j += energy;
        *(i < k->nb_pad ? &r->damped_building_j : &r->damped_core_j) += damped[i];
    }
    r->contact_loss_j = k->contact_lost;
    r->clamp_j = k->contact_clamped;
    r->contact_stored_j = still_stored(k);
    const double books = -contact_work - r->contact_loss_j - r->clamp_j - r->contact_stored_j;
    const double scale = energy_balance_scale(r->input_energy_j, r->input_energy_j - books);
    r->energy_balance_error = fabs(books) / scale + sqrt(missed / (2 * scale));
    for (int i = 0; i < k->model->nb; i++)
        r->mode_share_pct[i] = share(damped[i], r->input_energy_j);
    r->ed1_pct = r->mode_share_pct[0];
    for (int i = 4; i < 10 && i < k->model->nb; i++)
        r->ed5_10_pct += r->mode_share_pct[i];
    r->edcs_pct = share(r->damped_core_j, r->input_energy_j);
}

static void take_peaks(const FastWork *k, SimResult *r)
{
    for (int j = 0; j < k->n; j++) {
        r->peak_displacement_m[j] = scalars_const(k->peak_u)[j];
        r->peak_drift_m[j] = scalars_const(k->peak_d)[j];
        r->peak_acceleration_g[j] = scalars_const(k->peak_a)[j] / GRAVITY;
        r->j1_m = fmax(r->j1_m, r->peak_displacement_m[j]);
        r->j2_m = fmax(r->j2_m, r->peak_drift_m[j]);
        r->j3_g = fmax(r->j3_g, r->peak_acceleration_g[j]);
    }
}

FastKernel FAST_KERNEL;

void FAST_KERNEL(FastWork *k, const SimModel *model, const Motion *motion, const EngineOptions *options,
                 const FastKnobs *knobs, SimResult *result)
{
    k->options = options;
    k->knobs = knobs;
    memset(result, 0, sizeof *result);
    take_model(k, model, motion->dt_s);
    start_at_rest(k);
    const int arrived = fly(k, motion, options->duration);
    result->n_floors = model->n;
    result->n_modes = model->nb;
    if (!arrived)
        result->outcome = state_is_finite(k) ? RUN_OUT_OF_STEPS : RUN_NOT_FINITE;
    take_peaks(k, result);
    sum_energies(k, result);
    result->impacts = k->impacts;
    result->v0_limited = k->floored;
    result->indentation_max_m = k->deepest;
    result->steps = k->steps + k->flights;
    result->force_evaluations = k->forces;
}
