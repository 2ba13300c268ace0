#include "simulator/sensitivity.h"

#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/stat.h"
#include "scene/design.h"
#include "settings/settings.h"

enum { SIDES_OF_TWO_STEPS = 4 }; /* -h, h, -h/2, h/2 */
static const double AT[SIDES_OF_TWO_STEPS] = {-1, 1, -0.5, 0.5};
static const double GAP_STEP = 1e-3, SHARE = 0.02; /* [m], [-] */

static const char *const KEYS[] = {"contact.radius_m", "contact.restitution", "building.damping", "core.damping",
                                   "contact.bumper_stiffness_n_m"};
enum { N_KEYS = sizeof KEYS / sizeof KEYS[0] };

typedef struct {
    Settings settings;
    size_t n_replicates;
    DesignSpace space;
    const double *x;
    SimResult *results; /* (SIDES_OF_TWO_STEPS, n_replicates) of a parameter */
    Err *why;           /* the same */
} Job;

static double setting_of(const Settings *s, size_t key)
{
    const double values[N_KEYS] = {s->contact.radius_m, s->contact.restitution, s->building.damping, s->core.damping,
                                   s->contact.bumper_stiffness_n_m};
    return values[key];
}

/* Replicate k of the design whose variable `variable` is changed by `change`; none where that is beyond them. */
static Status simulate(const Job *job, const Tower *t, size_t variable, double change, size_t k, SimResult *out,
                       Err *err)
{
    const uint32_t seed = (uint32_t)job->settings.search.seed;
    const UncertainOptions *u = &job->settings.uncertain;
    SimWorker *w = tower_worker(t, 0, (size_t)omp_get_thread_num());
    const size_t n_var = (size_t)job->space.n_var;
    double x[DESIGN_VARIABLES_MAX];
    Design design;
    memcpy(x, job->x, n_var * sizeof *x);
    if (variable < n_var)
        x[variable] += change;
    design_of(&job->space, x, &design);
    replicate_design(seed, k, job->settings.sim.gap_tolerance_m, (size_t)job->space.n_floors, design.gap);
    const AsBuilt built = replicate_as_built(seed, k, u);
    TRY(sim_worker_as_built(w, k > 0 && is_uncertain(u) ? &built : NULL, err));
    return sim_run_built(w, SCENE_IMPACT, &design, out, err);
}

/* Sides first .. first + n - 1 of the steps on one tower. */
static Status simulate_sides(Job *job, const Tower *t, size_t variable, double step, int first, int n, Err *err)
{
    const int n_replicates = (int)job->n_replicates, end = (first + n) * n_replicates;
    int bad = -1;
#pragma omp parallel for schedule(dynamic) num_threads((int)tower_n_workers(t))
    for (int i = first * n_replicates; i < end; i++) {
        const Status status = simulate(job, t, variable, AT[i / n_replicates] * step, (size_t)(i % n_replicates),
                                       &job->results[i], &job->why[i]);
        job->why[i].code = status;
    }
    for (int i = end; i-- > first * n_replicates;)
        bad = job->why[i].code != STATUS_OK ? i : bad;
    return bad < 0 ? STATUS_OK : fail(err, job->why[bad].code, "%s", job->why[bad].text);
}

/* A tower of its own for every side: whatever follows from the setting follows. */
static Status simulate_setting(Job *job, const char *key, double value, double step, Err *err)
{
    for (int side = 0; side < SIDES_OF_TWO_STEPS; side++) {
        Settings s = job->settings;
        Problem p;
        char text[100];
        snprintf(text, sizeof text, "%s=%.17g", key, value + AT[side] * step);
        TRY(settings_set(&s, text, err));
        TRY(tower_open(&p, &s, TOWER_SINGLE, job->n_replicates, err));
        const Status status = simulate_sides(job, tower_of(&p), SIZE_MAX, 0, side, 1, err);
        problem_close(&p);
        TRY(status);
    }
    return STATUS_OK;
}

/* Mean, and standard error (NAN: one replicate), of the differences over 2h of measure k between two sides. */
static void difference(const Job *job, int minus, double h, int k, double *mean, double *error)
{
    const size_t n = job->n_replicates;
    double v[1000] = {0};
    for (size_t i = 0; i < n; i++) {
        const SimResult *below = &job->results[(size_t)minus * n + i], *above = below + n;
        const int ok = below->outcome == RUN_OK && above->outcome == RUN_OK;
        v[i] = ok ? (measure_value(above, k) - measure_value(below, k)) / (2 * h) : NAN;
    }
    mean_and_sd_of(n, v, mean, error);
    *error /= sqrt((double)n);
}

static void conclude(const Job *job, Sensitivity *out)
{
    for (int k = 0; k < N_MEASURES; k++) {
        double coarse, fine, unused, error;
        difference(job, 0, out->step, k, &coarse, &unused);
        difference(job, 2, 0.5 * out->step, k, &fine, &error);
        out->slope[k] = fine;
        out->error[k] = hypot(isnan(error) && !isnan(fine) ? 0 : error, coarse - fine);
    }
}

static Status vary_design(Job *job, const Tower *t, Sensitivity *out, Err *err)
{
    for (size_t j = 0; j < (size_t)job->space.n_var; j++) {
        design_variable_name(&job->space, (int)j, out[j].name);
        out[j].value = job->x[j];
        out[j].step = j < (size_t)job->space.n_gaps ? fmin(GAP_STEP, 0.5 * job->x[j]) : SHARE * job->x[j];
        if (out[j].step <= 0) {
            for (int k = 0; k < N_MEASURES; k++)
                out[j].slope[k] = out[j].error[k] = NAN;
            continue;
        }
        TRY(simulate_sides(job, t, j, out[j].step, 0, SIDES_OF_TWO_STEPS, err));
        conclude(job, &out[j]);
    }
    return STATUS_OK;
}

static Status vary_settings(Job *job, Sensitivity *out, size_t *n, Err *err)
{
    for (size_t i = 0; i < N_KEYS; i++) {
        const double value = setting_of(&job->settings, i);
        if (!(value > 0) || (i == 1 && value * (1 + SHARE) > 1))
            continue;
        Sensitivity *o = &out[(*n)++];
        snprintf(o->name, sizeof o->name, "%s", KEYS[i]);
        o->value = value;
        o->step = SHARE * value;
        TRY(simulate_setting(job, KEYS[i], value, o->step, err));
        conclude(job, o);
    }
    return STATUS_OK;
}

static Status find(Job *job, const Tower *t, Sensitivity **out, size_t *n, Err *err)
{
    const size_t parts = SIDES_OF_TWO_STEPS * job->n_replicates;
    job->space = *tower_design(t);
    *n = (size_t)job->space.n_var;
    *out = calloc(*n + N_KEYS, sizeof **out);
    job->results = calloc(parts, sizeof *job->results);
    job->why = calloc(parts, sizeof *job->why);
    Status status = *out && job->results && job->why
                        ? vary_design(job, t, *out, err)
                        : fail(err, STATUS_NO_MEMORY, "no memory for %zu simulations", parts);
    if (status == STATUS_OK)
        status = vary_settings(job, *out, n, err);
    free(job->results);
    free(job->why);
    return status;
}

Status sensitivity_find(const Settings *s, const double x[], size_t n_replicates, Sensitivity **out, size_t *n,
                        Err *err)
{
    Problem p;
    Job *job = calloc(1, sizeof *job);
    *out = NULL;
    if (!job)
        return fail(err, STATUS_NO_MEMORY, "no memory for settings");
    *job = (Job){.settings = *s, .n_replicates = n_replicates, .x = x};
    job->settings.sim.forces = FORCES_YES;
    Status status = tower_open(&p, &job->settings, TOWER_SINGLE, SIZE_MAX, err);
    if (status == STATUS_OK) {
        status = find(job, tower_of(&p), out, n, err);
        problem_close(&p);
    }
    free(job);
    if (status != STATUS_OK) {
        free(*out);
        *out = NULL;
    }
    return status;
}
