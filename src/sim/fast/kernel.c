/* sim/fast/kernel.c -- step control and results of the engine `fast`; see fast.h for the method. Compiled twice per
 * instruction set with FAST_KERNEL naming the entry, FAST_LANES the width of a vector, and PLAIN: 1 where no storey
 * yields, no device is there and no force acts on the floors, so that these cost such scenes nothing. */
#include "sim/fast/kernel.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "base/units.h"
#include "sim/contact.h"
#include "sim/energy_balance.h"
#include "sim/force_monitor.h"

static inline int yields(const FastWork *k)
{
    return !PLAIN && k->yields;
}

static inline int n_devices(const FastWork *k)
{
    return PLAIN ? 0 : k->n_devices;
}

/* Is the last device the mat of a core that lifts? */
static inline int may_lift(const FastWork *k)
{
    return !PLAIN && k->model->may_lift;
}

/* Do devices act, so that nothing is a free flight? A mat acts while it is up. */
static inline int devices_act(const FastWork *k)
{
    return n_devices(k) > may_lift(k) || (may_lift(k) && k->lifting);
}

static inline int is_pushed(const FastWork *k)
{
    return !PLAIN && k->has_push;
}

static inline int n_rows(const FastWork *k)
{
    return PLAIN ? k->n : k->rows;
}

static inline int channel_vectors(const FastWork *k)
{
    return PLAIN ? k->nf : k->cf;
}

/* Are the points to watch others than the floors at the contacts? */
static inline int watches(const FastWork *k)
{
    return !PLAIN && k->model->U != k->model->R;
}

/* The first mode of w that is not in the motion of the points. */
static inline int beside_points(const FastWork *k)
{
    return watches(k) ? 0 : k->nb_pad;
}

/* One unit, in the order of use: static functions alone. */
#include "sim/fast/design.inc"
#include "sim/fast/step_tables.inc"
#include "sim/fast/contact_quadrature.inc"
#include "sim/fast/peaks.inc"
#include "sim/fast/record.inc"
#include "sim/fast/free_flight.inc"
#include "sim/fast/free_interval.inc"
#include "sim/fast/contact_forces.inc"
#include "sim/fast/record_contact.inc"
#include "sim/fast/storey_peaks.inc"
#include "sim/fast/contact_step.inc"

/* What the energy of one step's error is measured by: the input so far. */
static double energy_scale(const FastWork *k)
{
    vec sum = {0};
    for (int i = 0; i < k->mf; i++)
        sum += k->now.ground_work[i];
    return fabs(lanes_sum(sum));
}

/* Will an open gap have closed after h at the present speed? */
static int onset_ahead(const FastWork *k, double h)
{
    mask ahead = {0};
    for (int f = 0; f < k->nf; f++)
        ahead |= (vec_abs(k->now.w[f] + h * k->now.w_dot[f]) > k->gap[f]) & (vec_abs(k->now.w[f]) <= k->gap[f]);
    return any(ahead);
}

/* A sampling interval under way. Time passes in ticks, of which the interval has TICKS: a step of level L takes
 * TICKS >> L of them and begins at a multiple of that, so that every step length is one of LEVEL_MAX + 1. */
static const uint32_t TICKS = UINT32_C(1) << LEVEL_MAX;
typedef struct {
    double start;  /* [s] */
    double a0, a1; /* [m/s2] of the ground at both ends, linear between them */
    uint32_t at;   /* ticks that have passed */
} Interval;

static double ground_at(const Interval *in, uint32_t tick)
{
    return in->a0 + (in->a1 - in->a0) * tick / TICKS;
}

/* The load of the forces on the floors at one end of the step under way. */
static void set_push(FastWork *k, int end, uint32_t tick)
{
    for (int i = 0; i < k->bf && is_pushed(k); i++) {
        k->push[end][i] = k->swing[0][i] + (k->swing[1][i] - k->swing[0][i]) * ((double)tick / TICKS);
        k->push_rise[i] = k->push[1][i] - k->push[0][i];
    }
}

/* The longest step that may begin here. */
static int aligned_level(const Interval *in)
{
    return in->at ? LEVEL_MAX - __builtin_ctz(in->at) : 0;
}

static int later(int level, int than)
{
    return level > than ? level : than;
}

/* The longest free flight that can be certified, of levels above `resolving`, where contacts are resolved; 0: none. */
static int fly_on(FastWork *k, Interval *in, int resolving)
{
    k->step_start = in->start + k->base * in->at / TICKS;
    set_push(k, 0, in->at);
    for (int level = later(k->flight_level, aligned_level(in)); level < resolving; level++) {
        const uint32_t end = in->at + (TICKS >> level);
        set_push(k, 1, end);
        if (!free_flight(k, level_ready(k, level, 0), ground_at(in, in->at), ground_at(in, end))) {
            if (!k->flight.would_yield)
                continue;
            k->contact_level = level;
            return 0;
        }
        in->at = end;
        k->flight_level = level > 0 ? level - 1 : 0;
        k->contact_level = LEVEL_MAX;
        return 1;
    }
    return 0;
}

/* Where several floors meet the core at once the error of one contact is passed on to the others, and grows from impact
 * to impact. A floor counts if it touches the core or may within so long at its present speed [s]. Steps are halved
 * where FastTolerances.crowd floors count, again at twice and at four times as many, and what a step may miss of the
 * energy is divided by CROWD_ENERGY each time; not where it is calm. docs/measured/promise-rule.csv has what each
 * number earns. */
static const double CROWD_S = 0.05, CROWD_ENERGY = 8;
enum { CROWD_HALVINGS = 3 };

static int halvings_in_crowd(FastWork *k)
{
    int near = 0, halvings = 0;
    k->crowd = 1;
    if (k->tolerances->crowd == 0 || k->calm > 1)
        return 0;
    if (!k->state_valid)
        enter_contact(k);
    for (int f = 0; f < k->nf; f++)
        near += __builtin_popcount(lane_bits(vec_abs(k->now.w[f]) + CROWD_S * vec_abs(k->now.w_dot[f]) > k->gap[f]));
    for (; halvings < CROWD_HALVINGS && near >= k->tolerances->crowd << halvings; halvings++)
        k->crowd *= CROWD_ENERGY;
    return halvings;
}

/* The longest contact step that is accurate; 0: none is. */
static int step_on(FastWork *k, Interval *in, int resolving)
{
    k->step_start = in->start + k->base * in->at / TICKS;
    set_push(k, 0, in->at);
    resolving += halvings_in_crowd(k);
    if (resolving > LEVEL_MAX)
        resolving = LEVEL_MAX;
    k->flight_level = resolving > 0 ? resolving - 1 : 0;

    /* First as long as the last one, where no gap is about to close in it. */
    const int is_fixed = k->tolerances->energy_tolerance == 0 && (n_devices(k) == 0 || k->in_contact);
    if (k->contact_level > resolving || is_fixed)
        k->contact_level = resolving;
    while (k->contact_level < resolving && k->state_valid && onset_ahead(k, ldexp(k->base, -k->contact_level)))
        k->contact_level++;
    for (int level = later(k->contact_level, aligned_level(in)); level <= LEVEL_MAX; level++) {
        const uint32_t end = in->at + (TICKS >> level);
        set_push(k, 1, end);
        if (!contact_step(k, level_ready(k, level, 1), ground_at(in, in->at), ground_at(in, end), level - resolving))
            continue;
        in->at = end;
        k->contact_level = k->may_grow && level > 0 ? level - 1 : level;
        return 1;
    }
    return 0;
}

/* Of the speed that the ground can add in an interval: a gap at rest for a moment is no reason for a long step. */
static const double SPEED_GAIN = 0.1;

/* One sampling interval from `start` [s] on, ground acceleration from a0 to a1; 0 when no step is short enough. */
static int interval(FastWork *k, double start, double a0, double a1)
{
    const double gain = SPEED_GAIN * k->base * (fmax(fabs(a0), fabs(a1)) + k->push_accel);
    Interval in = {.start = start, .a0 = a0, .a1 = a1};
    k->energy_scale = energy_scale(k);
    while (in.at < TICKS) {
        if ((double)(k->steps + k->flights) > k->tolerances->steps_max)
            return 0;
        /* The level whose step is the wanted share of the shortest Hertz contact at this speed, or the finest. */
        int resolving = has_core(k) || yields(k) || n_devices(k) > 0 ? k->yielding_level : LEVEL_MAX;
        for (int level = 0; has_core(k) && level < LEVEL_MAX && k->speed + gain > k->level[level].speed_max; level++)
            resolving = later(resolving, level + 1);
        const int longest = has_core(k) || yields(k) ? resolving : LEVEL_MAX;
        if (!(!k->in_contact && !k->yielding && !devices_act(k) && fly_on(k, &in, longest)) &&
            !step_on(k, &in, resolving))
            return 0;
        if (k->options->sample && in.at < TICKS && in.at % (TICKS >> k->sample_level) == 0)
            send_now(k, in.start + k->base * in.at / TICKS, ground_at(&in, in.at));
    }
    return 1;
}

static int state_is_finite(const FastWork *k)
{
    vec sum = {0};
    for (int i = 0; i < k->mf; i++)
        sum += k->now.q[i] * 0.0 + k->now.v[i] * 0.0;
    return lanes_sum(sum) == 0;
}

typedef struct {
    double start, end; /* [m/s2] */
} Ramp;

/* Ground acceleration over interval i; after the last sample it stands still. */
static Ramp ground(const Motion *motion, long i)
{
    return i + 1 < (long)motion->n ? (Ramp){motion->accel[i], motion->accel[i + 1]} : (Ramp){0, 0};
}

/* Do forces act on the floors anywhere from sample first to sample last? */
static int is_forced(const Motion *motion, long first, long last)
{
    int forced = 0;
    for (long i = first * motion->n_force; i < (last + 1) * motion->n_force && !forced; i++)
        forced = motion->force[i] != 0;
    return forced;
}

/* Modal load of the forces on the floors at sample i of the motion. */
static void swing_at(FastWork *k, const Motion *motion, long i, vec *out)
{
    for (int m = 0; m < k->bf; m++)
        out[m] = (vec){0};
    for (int m = 0; m < k->nb_pad; m++) {
        const double *row = scalars_const(k->U) + m * k->pf * LANES;
        for (int j = 0; j < motion->n_force; j++)
            scalars(out)[m] += row[j] * motion->force[i * motion->n_force + j];
    }
}

/* The forces on the floors in the first `share` of interval i; after the last sample there are none. */
static void enter_forces(FastWork *k, const Motion *motion, long i, double share)
{
    const int was_pushed = is_pushed(k);
    const vec zero = {0};
    vec most = zero;
    k->push_accel = 0;
    k->has_push = i + 1 < (long)motion->n && is_forced(motion, i, i + 1);
    for (int m = 0; m < k->bf && was_pushed && !is_pushed(k); m++)
        k->push[0][m] = k->push[1][m] = k->push_rise[m] = zero;
    if (!is_pushed(k))
        return;
    swing_at(k, motion, i, k->swing[0]);
    swing_at(k, motion, i + 1, k->swing[1]);
    for (int m = 0; m < k->bf; m++) {
        k->swing[1][m] = k->swing[0][m] + share * (k->swing[1][m] - k->swing[0][m]);
        most += k->max_shape[m] * vec_max(vec_abs(k->swing[0][m]), vec_abs(k->swing[1][m]));
    }
    k->push_accel = lanes_sum(most);
    set_push(k, 0, 0);
    set_push(k, 1, TICKS);
}

/* Certified free intervals first.. are passed at once; returns how many, 0 where the next one must be integrated. */
static long free_intervals(FastWork *k, const Motion *motion, long first, long end)
{
    double impulse = 0;
    if (!k->oscillatory || k->in_contact || k->yielding || devices_act(k) || first < k->free_from ||
        end - first < FREE_INTERVALS_MIN)
        return 0;
    const long n = k->free_count < end - first ? k->free_count : end - first;
    if (is_forced(motion, first, first + n < (long)motion->n ? first + n : (long)motion->n - 1))
        return 0;
    for (long i = first; i < first + n; i++) {
        const Ramp a = ground(motion, i);
        impulse += 0.5 * motion->dt_s * (fabs(a.start) + fabs(a.end));
    }
    if (!interval_is_free(k, impulse)) {
        k->free_from = n > FREE_INTERVALS_MIN ? first : first + FREE_INTERVALS_MIN;
        k->free_count = FREE_INTERVALS_MIN;
        return 0;
    }
    k->free_count = n < FREE_INTERVALS_MAX ? 2 * n : n;
    const Level *l = level_ready(k, 0, 0);
    for (long i = first; i < first + n; i++) {
        const Ramp a = ground(motion, i);
        if (i > first)
            send_now(k, (double)i * motion->dt_s, a.start);
        k->step_start = (double)i * motion->dt_s;
        flow_to_next(k, l, a.start, a.end);
        record_flight(k, l, a.start, a.end, k->reach.a);
        take_flow(k, l, a.start, a.end);
    }
    k->flights += n;
    leave_free_intervals(k);
    return n;
}

/* Samples of the motion between two looks at what is left. */
enum { SETTLED_EVERY = 16 };

/* Of the largest energy: where no more is left, no peak is to come that was not there with ten times the amplitude. */
static const double PEAK_ENERGY = 0.01;

/* What mode i has dissipated [J]; its energy is added. */
static double damped_by(const FastWork *k, int i, double *energy)
{
    const double q = scalars_const(k->now.q)[i], v = scalars_const(k->now.v)[i], w = scalars_const(k->omega)[i];
    const double own = 0.5 * (v * v + w * w * q * q);
    *energy += own;
    return scalars_const(k->now.ground_work)[i] + scalars_const(k->now.contact_work)[i] - own;
}

/* Shares below this of the input are promised as if they were as large. */
static const double SHARE_MIN = 1e-3;

/* [J] Of what the first mode, modes 5 to 10 and the core have dissipated so far. */
static double smallest_share(const FastWork *k)
{
    double share[3] = {0}, energy = 0;
    for (int i = 0; i < k->m_pad; i++) {
        const int like = i < k->model->nb ? k->model->like[i] : -1;
        const int group = i >= k->nb_pad ? 2 : like == 0 ? 0 : like >= 4 && like < 10 ? 1 : -1;
        if (group >= 0)
            share[group] += damped_by(k, i, &energy);
    }
    const double least = fmin(share[0], share[2]);
    return fmax(k->model->nb > 4 ? fmin(least, share[1]) : least, SHARE_MIN * energy_scale(k));
}

/* About the state of rest under the plastic drifts. */
static double twice_energy_about_rest(const FastWork *k)
{
    vec sum = {0};
    for (int i = 0; i < k->mf; i++) {
        const vec q = yields(k) ? k->now.q[i] - k->held[i] * k->flexibility[i] : k->now.q[i];
        sum += k->now.v[i] * k->now.v[i] + k->omega[i] * k->omega[i] * q * q;
    }
    return lanes_sum(sum);
}

/* Bouc-Wen flows at any drift: of what the drifts still move, no more than this share is left out. */
static const double SETTLED_FLOW = 0.05;

/* Can a storey yield once more, or the mat lift, with so much energy [J] about rest?
 * |d| <= sqrt(2 E sum D_i^2 / w_i^2) */
static int may_go_on(FastWork *k, double energy)
{
    double of_mat = 0;
    const StoreyLaw *law = &k->model->storey_law;
    const double *D = k->E + k->n_pad;
    const double share = law->kind == HYSTERESIS_BILINEAR ? 1 : pow(SETTLED_FLOW, 1 / law->exponent);
    if (yields(k))
        set_rest(k);
    for (int j = 0; yields(k) && j < k->n; j++) {
        double soft = 0;
        for (int i = 0; i < k->model->nb; i++)
            soft += D[i * k->c_pad + j] * D[i * k->c_pad + j] * scalars_const(k->flexibility)[i];
        if (sqrt(2 * energy * soft) + scalars_const(k->rest)[j] > share * k->model->yield_m[j])
            return 1;
    }
    for (int i = 0; may_lift(k) && i < k->m_pad; i++)
        of_mat += pow(scalars_const(mat_row(k))[i], 2) * scalars_const(k->flexibility)[i];
    return may_lift(k) && sqrt(2 * energy * of_mat) > mat_of(k)->theta_up;
}

/* Is so little energy left, and to come from sample i of the motion on, that contacts can change no result? Notes how
 * calm it is. */
static int is_settled(FastWork *k, const Motion *motion, long i)
{
    const double *input = k->options->tail_input;
    if (!input || !has_core(k))
        return 0;
    const double energy = 0.5 * twice_energy_about_rest(k);
    k->most_energy = larger(energy, k->most_energy);
    const double root = sqrt(energy) + sqrt(i < (long)motion->n ? k->mass_ratio * input[i] : 0), left = root * root;

    /* Impacts grow errors while peaks are to come; later they change the shares alone, and those by no more than their
     * part of the energy that is left: what a step may miss grows as it falls below the largest so far, a thousandfold
     * at most. */
    k->calm = k->tolerances->calms_down && left < k->most_energy ? fmin(k->most_energy / left, 1e3) : 1;
    return !k->in_contact && !devices_act(k) && !may_go_on(k, left) &&
           left <= k->tolerances->tail_tolerance * energy_scale(k) && left <= PEAK_ENERGY * k->most_energy &&
           (k->tolerances->tail_share == 0 || left <= k->tolerances->tail_share * smallest_share(k));
}

/* An interval without contacts: linear, so that the energies are exact. Nothing in it can raise a peak. next: ground
 * acceleration after it. */
static void settle(FastWork *k, double start, Ramp a, double next)
{
    const Level *l = level_ready(k, 0, 0);
    const int shown = k->options->sample && !k->options->sample_peaks;
    k->step_start = start;
    flow_to_next(k, l, a.start, a.end);
    if (shown)
        sample_inside(k, l, a.start, a.end, 0);
    take_flow(k, l, a.start, a.end);
    if (shown)
        send_now(k, start + k->base, next);
    k->flights++;
}

/* Steps of `fine`, and the longest that have to be resolved of the others, are no longer than so many to the period of
 * the building's fastest mode. */
static int yielding_level(FastWork *k)
{
    double fastest = 0;
    int level = 0;
    for (int i = 0; i < k->model->nb; i++)
        fastest = fmax(fastest, scalars_const(k->omega)[i]);
    while (level < LEVEL_MAX && ldexp(k->base, -level) * fastest * k->tolerances->steps_per_contact > 2 * M_PI)
        level++;
    k->storey_rate = fastest * fastest / 6; /* of the displacement that a force that grows over the step makes */
    return level;
}

static int integrate(FastWork *k, const Motion *motion, double duration)
{
    const long full = (long)floor(duration / motion->dt_s * (1 + 1e-14));
    k->flight_level = 0;
    k->free_from = 0;
    k->free_count = FREE_INTERVALS_MIN;
    k->contact_level = LEVEL_MAX;
    set_base(k, 0);
    set_base(k, motion->dt_s);
    k->yielding_level = yields(k) ? yielding_level(k) : 0;
    long look = 0; /* at the next sample from this one on */
    k->settled = duration;
    k->calm = k->crowd = 1;
    set_sample_level(k);
    send_now(k, 0, ground(motion, 0).start);
    for (long i = 0; i < full;) {
        if (i >= look && is_settled(k, motion, i)) {
            k->settled = (double)i * motion->dt_s;
            for (; i < full; i++) {
                enter_forces(k, motion, i, 1);
                settle(k, (double)i * motion->dt_s, ground(motion, i), ground(motion, i + 1).start);
            }
            leave_free_intervals(k);
            break;
        }
        look = i >= look ? i + SETTLED_EVERY : look;
        enter_forces(k, motion, i, 1);
        const long passed = free_intervals(k, motion, i, full);
        const Ramp a = ground(motion, i);
        if ((!passed && !interval(k, (double)i * motion->dt_s, a.start, a.end)) || !state_is_finite(k))
            return 0;
        i += passed ? passed : 1;
        send_now(k, (double)i * motion->dt_s, ground(motion, i).start);
    }
    const double rest = duration - (double)full * motion->dt_s;
    if (rest > 1e-9 * motion->dt_s) {
        const Ramp a = ground(motion, full);
        set_base(k, rest);
        enter_forces(k, motion, full, rest / motion->dt_s);
        k->sample_level = 0;
        const double end = a.start + (a.end - a.start) * rest / motion->dt_s;
        k->record.memory = k->record.n_held = 0; /* flights are no longer held */
        if (k->settled < duration)               /* contacts have ended: floors may be deep inside the core */
            settle(k, duration - rest, (Ramp){a.start, end}, end);
        else if (!interval(k, duration - rest, a.start, end))
            return 0;
    }
    return state_is_finite(k);
}

/* Plastic drifts and hysteresis; returns what the storeys have taken from the modes [J]: hysteresis less what the modes
 * hold of it too much. */
static double report_storeys(FastWork *k, SimResult *r)
{
    double too_much = 0;
    enter_contact(k);
    for (int j = 0; j < k->n; j++) {
        const double z = scalars_const(k->now.w)[k->n_pad + j], p = scalars_const(k->middle)[k->n_pad + j];
        too_much += 0.5 * k->model->yield_n_m[j] * p * (2 * z + p);
    }
    r->hysteresis_j = k->hysteresis;
    r->kinetic_strain_j -= too_much;
    model_report_plastic(k->model, scalars_const(k->middle) + k->n_pad, r);
    return k->hysteresis - too_much;
}

static void report_energies(FastWork *k, SimResult *r)
{
    double contact_work = 0, missed = 0;
    double *damped = scalars(k->reach.bound_q);
    for (int i = 0; i < k->m_pad; i++) {
        damped[i] = damped_by(k, i, &r->kinetic_strain_j);
        if (scalars_const(k->zeta)[i] == 0)
            damped[i] = 0; /* what the balance leaves of a mode without damping is rounding */
        r->input_energy_j += scalars_const(k->now.ground_work)[i];
        contact_work += scalars_const(k->now.contact_work)[i];
        missed += scalars_const(k->now.defect)[i] * scalars_const(k->now.defect)[i];
        *(i < k->nb_pad ? &r->damped_building_j : &r->damped_core_j) += damped[i];
    }
    r->contact_loss_j = k->contact_lost;
    r->clamp_j = k->contact_clamped;
    for (int j = 0; j < k->n; j++)
        if (k->side[j])
            r->contact_stored_j +=
                contact_stored(&k->model->contact[j], fabs(scalars_const(k->now.w)[j]) - scalars_const(k->gap)[j]);
    double held = 0; /* by springs of devices */
    for (int e = 0; e < n_devices(k) - may_lift(k); e++)
        held += 0.5 * k->model->device[e].stiffness * pow(scalars_const(k->now.w)[k->at_device + e], 2);
    const double of_mat = held_by_mat(k);
    r->device_loss_j = k->device_taken - held;
    r->kinetic_strain_j += held + of_mat;
    *(k->nc > 0 ? &r->damped_core_j : &r->damped_building_j) += k->mat[MAT_WORK] - of_mat;
    r->mat_rotation_rad = k->mat_turned;
    model_report_devices(k->model, k->device, r);
    const double energy_error = -contact_work - k->now.flexible - r->contact_loss_j - r->clamp_j - r->contact_stored_j -
                                k->device_taken - k->mat[MAT_WORK] - (yields(k) ? report_storeys(k, r) : 0);
    const double scale = energy_balance_scale(r->input_energy_j, r->input_energy_j - energy_error);
    r->energy_balance_error = fabs(energy_error) / scale + sqrt(missed / (2 * scale));
    energy_balance_shares(r, k->model->nb, k->model->like, damped);
}

FastKernel FAST_KERNEL;

void FAST_KERNEL(FastWork *k, const SimModel *model, const Motion *motion, const EngineOptions *options,
                 const FastTolerances *tolerances, SimResult *result)
{
    k->options = options;
    k->tolerances = tolerances;
    k->forced = motion->n_force > 0;
    memset(result, 0, sizeof *result);
    set_design(k, model, motion->dt_s);
    start_at_rest(k);
    record_start(k);
    const int arrived = integrate(k, motion, options->duration);
    result->n_floors = model->n;
    result->n_modes = model->n;
    if (!arrived)
        result->outcome = state_is_finite(k) ? RUN_OUT_OF_STEPS : RUN_NOT_FINITE;
    model_report_peaks(
        model,
        (const double *const[]){scalars_const(k->peak_u), scalars_const(k->peak_d), scalars_const(k->peak_a), NULL},
        result);
    report_energies(k, result);
    result->impacts = k->impacts;
    memcpy(result->closings, k->closings, (size_t)model->n * sizeof *k->closings);
    result->settled_s = k->settled;
    result->v0_limited = k->v0_limited;
    for (int j = 0; j < model->n; j++)
        result_add_approach(result, &model->contact[j], k->approach_max[j]);
    result->steps = k->steps + k->flights;
    result->force_evaluations = k->forces;
}
