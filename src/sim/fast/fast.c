#include "sim/fast/fast.h"

#include <stdlib.h>

#include "base/carve.h"
#include "base/denormal.h"
#include "sim/fast/kernel.h"

/* Room for vectors of `length` numbers each. */
#define CARVE_EACH(c, length, ...)                                                                                     \
    do {                                                                                                               \
        vec **const of[] = {__VA_ARGS__};                                                                              \
        for (size_t i_ = 0; i_ < sizeof of / sizeof of[0]; i_++)                                                       \
            *of[i_] = carve(c, length, sizeof(double));                                                                \
    } while (0)

static void layout_state(State *s, Carve *c, size_t modes, size_t channels)
{
    CARVE_EACH(c, modes, &s->q, &s->v, &s->load, &s->contact_work, &s->ground_work, &s->defect);
    CARVE_EACH(c, channels, &s->w, &s->w_dot, &s->force);
}

static void layout_flight(FlightScratch *f, Carve *c, size_t modes, size_t floors)
{
    CARVE_EACH(c, modes, &f->amplitude, &f->start_q, &f->start_v, &f->start_a, &f->start_j, &f->end_q, &f->end_v,
               &f->end_a, &f->end_j, &f->bound_q, &f->bound_a);
    CARVE_EACH(c, floors, &f->u0, &f->u0_dot, &f->u1, &f->u1_dot, &f->core0, &f->core0_dot, &f->core1, &f->core1_dot,
               &f->a0, &f->a0_dot, &f->a1, &f->a1_dot, &f->error_u, &f->error_core, &f->error_a, &f->reach_a);
}

static int padded(int n)
{
    return (n + PAD - 1) / PAD * PAD;
}

static void layout(void *work, Carve *c)
{
    FastWork *k = work;
    ContactScratch *in_contact = &k->contact;
    StoreyScratch *s = &k->storeys;
    const size_t n = (size_t)k->n, floors = (size_t)k->n_pad, modes = (size_t)k->m_max;
    const size_t points = (size_t)padded(POINTS_OF(k->n));
    const size_t channels = (k->may_yield ? 2 * floors : floors) + (size_t)padded(k->devices_max);
    const size_t rows = n + (size_t)k->devices_max;
    CARVE_EACH(c, modes, &k->omega, &k->zeta, &k->gamma, &k->wd_inverse, &k->decay, &k->flexibility, &k->max_shape,
               &k->max_shape_drift);
    CARVE_EACH(c, modes, &k->held, &k->push[0], &k->push[1], &k->push_rise, &k->swing[0], &k->swing[1]);
    CARVE_EACH(c, floors, &k->rest);
    CARVE_EACH(c, points, &k->peak_u, &k->peak_d, &k->peak_a);
    CARVE_EACH(c, channels, &k->gap, &k->middle, &k->bubble);
    layout_state(&k->now, c, modes, channels);
    layout_state(&k->next, c, modes, channels);
    layout_flight(&k->flight, c, modes, points);
    CARVE_EACH(c, modes, &in_contact->bubble, &in_contact->middle_q, &in_contact->middle_a, &in_contact->end_a,
               &in_contact->bend_q, &in_contact->bend_a, &in_contact->bound_q, &in_contact->bound_a);
    CARVE_EACH(c, points, &in_contact->missed);
    for (int i = 0; i < 9; i++)
        CARVE_EACH(c, points, &in_contact->sample[i / 3][i % 3]);
    CARVE_EACH(c, floors, &s->per_yield, &s->stiff, &s->slope, &s->bend, &s->work, &s->work_next, &s->beside);
    CARVE_EACH(c, modes, &s->load, &s->bubble);
    CARVE_EACH(c, floors * KINKS_MAX, &s->kink);
    CARVE_EACH(c, modes, &k->reach.bound_q, &k->reach.bound_a);
    CARVE_EACH(c, points, &k->reach.u, &k->reach.drift, &k->reach.a, &k->reach.core);
    CARVE_EACH(c, modes, &k->record.q, &k->record.v, &k->record.ground_work, &k->record.contact_work, &k->record.damped,
               &k->record.most, &k->record.per_most);
    CARVE_EACH(c, floors, &k->record.force, &k->record.plastic);
    for (int i = 0; i < HELD_MAX; i++)
        CARVE_EACH(c, modes, &k->record.held[i].q, &k->record.held[i].v);
    for (int i = 0; i < 4; i++) {
        CARVE_EACH(c, modes, &k->record.batch_q[i]);
        CARVE_EACH(c, points, &k->record.batch_u[i]);
    }
    CARVE(c, k->R, modes * floors);
    CARVE(c, k->flex, n * floors);
    CARVE(c, k->R_abs, modes * floors);
    CARVE_EACH(c, modes * points, &k->D_abs);
    for (int i = 0; i < 3; i++)
        CARVE_EACH(c, modes * points, &k->room[i]);
    CARVE(c, k->RT, modes * channels);
    k->E_room = channels > floors ? carve(c, modes * channels, sizeof(double)) : k->R;
    CARVE(c, k->newton_g, rows * rows);
    CARVE(c, k->newton_LU, rows * rows);
    for (Level *l = k->level; l <= k->level + LEVEL_MAX; l++) {
        CARVE_EACH(c, FLOW_ROWS * modes, &l->coef);
        CARVE_EACH(c, modes, &l->slow, &l->kappa, &l->kappa_accel, &l->cubic, &l->parabola, &l->parabola_accel);
        CARVE(c, l->compliance, COMPLIANCES * rows * channels);
        CARVE(c, l->compliance_pair, rows * rows);
        CARVE_EACH(c, channels, &l->own);
    }
}

Status fast_create(FastWork **out, int n_floors, int nb, int yields, int devices, Err *err)
{
    FastWork plain = {.n = n_floors,
                      .n_pad = padded(n_floors),
                      .m_max = padded(nb) + padded(n_floors + (devices > 0)),
                      .may_yield = yields,
                      .devices_max = devices};
    *out = carve_object(layout, &plain, sizeof plain);
    return *out ? STATUS_OK : fail_memory(err, n_floors, "floors");
}

void fast_free(FastWork *work)
{
    free(work);
}

static int processor_has(int set)
{
#ifdef __x86_64__
    if (set == FAST_AVX512)
        return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
               __builtin_cpu_supports("avx512dq");
    if (set == FAST_AVX2)
        return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
#endif
    return set == FAST_BASE;
}

/* Which sets are built, a bit each: the Makefile says it. */
const FastKernels *fast_kernels(int set)
{
    static const FastKernels SETS[FAST_SETS] = {
#if FAST_BUILT & 1
        [FAST_BASE] = {"base", fast_kernel_base, fast_plain_base},
#endif
#if FAST_BUILT & 2
        [FAST_AVX2] = {"avx2", fast_kernel_avx2, fast_plain_avx2},
#endif
#if FAST_BUILT & 4
        [FAST_AVX512] = {"avx512", fast_kernel_avx2, fast_plain_avx512},
#endif
    };
    return SETS[set].plain && processor_has(set) ? &SETS[set] : NULL;
}

static const FastKernels *best_kernels(void)
{
    int set = FAST_SETS - 1;
    while (!fast_kernels(set))
        set--;
    return fast_kernels(set);
}

const char *fast_kernel_name(void)
{
    return best_kernels()->name;
}

FastTolerances fast_tolerances(Accuracy accuracy)
{
    /* clang-format off */
    static const FastTolerances TOLERANCES[] = {
        [ACCURACY_COARSE] =
            {.steps_per_contact = 0.5, .solver_tolerance = 1e-2, .energy_tolerance = 3e-5, .device_error = 1e-4,
             .steps_max = 2e7, .peak_tolerance = 3e-3, .flexibility_left_out = 0.1, .tail_tolerance = 2e-3},
        [ACCURACY_STANDARD] =
            {.steps_per_contact = 2, .solver_tolerance = 3e-5, .energy_tolerance = 2.4e-7, .device_error = 1e-6,
             .steps_max = 2e7, .peak_tolerance = 6e-4, .flexibility_left_out = 0.01, .tail_tolerance = 0.02,
             .tail_share = 0.04, .crowd = 2, .calms_down = 1},
        [ACCURACY_FINE] = /* no energy tolerance, and nothing is left out */
            {.steps_per_contact = 80, .solver_tolerance = 1e-12, .device_error = 1e-10, .steps_max = 2e8,
             .peak_tolerance = 1e-6},
    };
    /* clang-format on */
    return TOLERANCES[accuracy];
}

void fast_run(FastWork *work, const SimModel *model, const Motion *motion, const EngineOptions *options,
              const FastTolerances *tolerances, SimResult *result)
{
    const unsigned mode = denormal_off();
    const FastKernels *kernels = best_kernels();
    const int is_plain = !model->yields && model->n_devices == 0 && motion->n_force == 0 && model->U == model->R;
    (is_plain ? kernels->plain : kernels->run)(work, model, motion, options, tolerances, result);
    denormal_restore(mode);
}

/* q and q' of every mode where the last run ended: state (2 m). */
static void end_state(const FastWork *work, double state[])
{
    const int nb = work->model->nb, kept = nb + work->nc, m = work->model->m;
    const double *q = (const double *)work->now.q, *v = (const double *)work->now.v;
    for (int i = 0; i < m; i++) {
        const int at = i < nb ? i : work->nb_pad + i - nb;
        state[i] = i < kept ? q[at] : 0;
        state[m + i] = i < kept ? v[at] : 0;
    }
}

/* Of the solver with friction: with less what sticks chatters, and steps become short. */
static const double FRICTION_TOLERANCE = 1e-4;

/* Of steps, below `fine`, of a core whose mat may lift: with 1 the promise holds in 55 of 59 scenes, with 2 in all. */
static const double LIFTING_STEPS = 2;

/* At ACCURACY_FINE the other tolerances are at rounding: EngineOptions.tolerance sets the steps alone. */
static FastTolerances tolerances_of(const EngineOptions *options, int lifts)
{
    FastTolerances tolerances = fast_tolerances(options->accuracy);
    double times = options->refinement > 0 ? options->refinement : 1;
    if (lifts && options->accuracy != ACCURACY_FINE)
        times *= LIFTING_STEPS;
    if (options->steps_per_contact > 0)
        times *= options->steps_per_contact / tolerances.steps_per_contact;
    if (options->tolerance > 0 && options->accuracy != ACCURACY_FINE)
        times *= options->tolerance / tolerances.steps_per_contact;

    /* So many times the steps per contact, and tolerances to match. */
    tolerances.steps_per_contact *= times;
    tolerances.solver_tolerance /= times * times;
    tolerances.energy_tolerance /= times * times * times;
    tolerances.device_error /= times * times * times * times;
    tolerances.peak_tolerance /= times;
    tolerances.flexibility_left_out /= times * times;
    tolerances.tail_tolerance /= times * times;
    tolerances.tail_share /= times * times;
    if (options->tolerance > 0 && options->accuracy == ACCURACY_FINE)
        tolerances.steps_per_contact = options->tolerance;
    return tolerances;
}

Status engine_fast(const SimModel *model, const Motion *motion, const EngineOptions *options, SimResult *result,
                   Err *err)
{
    FastWork *own = NULL, *work = options->work;
    if (!work)
        TRY(fast_create(&own, model->n, model->nb, model->yields, model->n_devices, err));
    if (!work)
        work = own;
    const int n = model->n_devices, lifts = n > 0 && model->device[n - 1].floor < 0;
    FastTolerances tolerances = tolerances_of(options, lifts);
    for (int e = 0; e < n; e++)
        if (model->device[e].exponent == 0)
            tolerances.solver_tolerance = fmin(tolerances.solver_tolerance, FRICTION_TOLERANCE);
    fast_run(work, model, motion, options, &tolerances, result);
    if (options->end_state)
        end_state(work, options->end_state);
    fast_free(own);
    return STATUS_OK;
}

Status engine_fast_create(void **work, int n_floors, int nb, int yields, int devices, Err *err)
{
    FastWork *fast;
    TRY(fast_create(&fast, n_floors, nb, yields, devices, err));
    *work = fast;
    return STATUS_OK;
}

void engine_fast_free(void *work)
{
    fast_free(work);
}
