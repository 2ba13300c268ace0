#include "sim/fast/fast.h"

#include <stdlib.h>

#include "base/carve.h"
#include "base/denormal.h"
#include "sim/fast/kernel.h"

static void layout(FastWork *k, Carve *c)
{
    const size_t n = (size_t)k->n, n_pad = (size_t)k->n_pad, m_max = 2 * n_pad;
    vec **const modes[] = {&k->omega, &k->zeta,      &k->gamma, &k->wd_inverse, &k->decay,  &k->flex,
                           &k->q,     &k->v,         &k->load,  &k->work,       &k->ground, &k->q1,
                           &k->v1,    &k->amplitude, &k->qa,    &k->va,         &k->qb,     &k->vb,
                           &k->za,    &k->ja,        &k->zb,    &k->jb,         &k->bound,  &k->bound_a,
                           &k->work1, &k->ground1,   &k->drift, &k->drift1,     &k->most,   &k->most_drift};
    vec **const floors[] = {&k->w,      &k->wd,     &k->w1,  &k->wd1, &k->f0,  &k->f1,      &k->fb,
                            &k->gap,    &k->u0,     &k->u0d, &k->u1,  &k->u1d, &k->a0,      &k->a0d,
                            &k->a1,     &k->a1d,    &k->e_u, &k->e_w, &k->e_a, &k->reach_a, &k->peak_u,
                            &k->peak_d, &k->peak_a, &k->c0,  &k->c0d, &k->c1,  &k->c1d};
    for (size_t i = 0; i < sizeof modes / sizeof modes[0]; i++)
        *modes[i] = carve(c, m_max, sizeof(double));
    for (size_t i = 0; i < sizeof floors / sizeof floors[0]; i++)
        *floors[i] = carve(c, n_pad, sizeof(double));
    for (int i = 0; i < 9; i++)
        k->seen[i / 3][i % 3] = carve(c, n_pad, sizeof(double));
    k->R = carve(c, m_max * n_pad, sizeof(double));
    k->R_abs = carve(c, m_max * n_pad, sizeof(double));
    k->D_abs = carve(c, m_max * n_pad, sizeof(double));
    k->RT = carve(c, m_max * n_pad, sizeof(double));
    for (int i = 0; i <= LEVEL_MAX; i++) {
        Level *l = &k->level[i];
        l->coef = carve(c, FLOW_ROWS * m_max, sizeof(double));
        l->slow = carve(c, m_max, sizeof(double));
        l->kappa = carve(c, m_max, sizeof(double));
        l->kappa_accel = carve(c, m_max, sizeof(double));
        l->cubic = carve(c, m_max, sizeof(double));
        l->parabola = carve(c, m_max, sizeof(double));
        l->parabola_accel = carve(c, m_max, sizeof(double));
        l->response = carve(c, RESPONSES * n * n_pad, sizeof(double));
        l->reply = carve(c, n * n, sizeof(v4));
    }
}

Status fast_create(FastWork **out, int n_floors, Err *err)
{
    *out = NULL;
    FastWork *k = calloc(1, sizeof *k);
    if (!k)
        return fail(err, STATUS_NO_MEMORY, "fast: no memory for its work space");
    k->n = n_floors;
    k->n_pad = (n_floors + PAD - 1) / PAD * PAD;
    Carve count = {0};
    layout(k, &count);
    k->store = carve_store(&count);
    if (!k->store) {
        free(k);
        return fail(err, STATUS_NO_MEMORY, "fast: no memory for %zu bytes of work space", count.used);
    }
    layout(k, &(Carve){.base = k->store});
    *out = k;
    return STATUS_OK;
}

void fast_free(FastWork *work)
{
    if (work)
        free(work->store);
    free(work);
}

typedef struct {
    const char *name;
    FastKernel *run;
} Kernel;

/* The widest vectors that this processor has. */
static Kernel best_kernel(void)
{
#ifdef __x86_64__
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq"))
        return (Kernel){"avx512", fast_kernel_avx512};
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
        return (Kernel){"avx2", fast_kernel_avx2};
#endif
    return (Kernel){"base", fast_kernel_base};
}

const char *fast_kernel_name(void)
{
    return best_kernel().name;
}

FastKnobs fast_knobs(Accuracy accuracy)
{
    static const FastKnobs KNOBS[] = {
        [ACCURACY_COARSE] = {0.5, 1e-2, 3e-5, 2e7, 3e-3, 0.1},
        [ACCURACY_STANDARD] = {1, 2e-3, 3e-6, 2e7, 1e-3, 0.005},
        [ACCURACY_FINE] = {80, 1e-12, 0, 2e8, 1e-6, 0},
    };
    return KNOBS[accuracy];
}

FastKnobs fast_knobs_finer(Accuracy accuracy, double times)
{
    FastKnobs knobs = fast_knobs(accuracy);
    knobs.steps_per_contact *= times;
    knobs.solver_tolerance /= times * times;
    knobs.energy_tolerance /= times * times * times;
    knobs.peak_tolerance /= times;
    knobs.flexibility_left_out /= times * times;
    return knobs;
}

void fast_run(FastWork *work, const SimModel *model, const Motion *motion, const EngineOptions *options,
              const FastKnobs *knobs, SimResult *result)
{
    const unsigned mode = denormal_off();
    best_kernel().run(work, model, motion, options, knobs, result);
    denormal_restore(mode);
}

/* q and q' of every mode where the last run ended: state (2 m). */
static void end_state(const FastWork *work, double state[])
{
    const int nb = work->model->nb, kept = nb + work->nc, m = work->model->m;
    const double *q = (const double *)work->q, *v = (const double *)work->v;
    for (int i = 0; i < m; i++) {
        const int at = i < nb ? i : work->nb_pad + i - nb;
        state[i] = i < kept ? q[at] : 0;
        state[m + i] = i < kept ? v[at] : 0;
    }
}

/* At ACCURACY_FINE the other tolerances are at rounding: EngineOptions.tolerance sets the steps alone. */
static FastKnobs tolerances_of(const EngineOptions *options)
{
    FastKnobs knobs = fast_knobs(options->accuracy);
    double times = options->refinement > 0 ? options->refinement : 1;
    if (options->steps_per_contact > 0)
        times *= options->steps_per_contact / knobs.steps_per_contact;
    if (options->tolerance > 0 && options->accuracy != ACCURACY_FINE)
        times *= options->tolerance / knobs.steps_per_contact;
    knobs = fast_knobs_finer(options->accuracy, times);
    if (options->tolerance > 0 && options->accuracy == ACCURACY_FINE)
        knobs.steps_per_contact = options->tolerance;
    return knobs;
}

Status engine_fast(const SimModel *model, const Motion *motion, const EngineOptions *options, SimResult *result,
                   Err *err)
{
    FastWork *own = NULL, *work = options->work;
    if (!work)
        TRY(fast_create(&own, model->n, err));
    if (!work)
        work = own;
    const FastKnobs knobs = tolerances_of(options);
    fast_run(work, model, motion, options, &knobs, result);
    if (options->end_state)
        end_state(work, options->end_state);
    fast_free(own);
    return STATUS_OK;
}

Status engine_fast_create(void **work, int n_floors, Err *err)
{
    FastWork *fast;
    TRY(fast_create(&fast, n_floors, err));
    *work = fast;
    return STATUS_OK;
}

void engine_fast_free(void *work)
{
    fast_free(work);
}
