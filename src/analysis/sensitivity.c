#include "analysis/sensitivity.h"

#include <math.h>
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
} Job;

static double setting_of(const Settings *s, size_t key)
{
    const double values[N_KEYS] = {s->contact.radius_m, s->contact.restitution, s->building.damping, s->core.damping,
                                   s->contact.bumper_stiffness_n_m};
    return values[key];
}

/* Sides first .. first + n - 1 of the steps on one tower, whose variable `variable` is changed; none where that is beyond
 * them. */
static Status simulate_sides(Job *job, const Problem *p, size_t variable, double step, size_t first, size_t n, Err *err)
{
    double X[SIDES_OF_TWO_STEPS * DESIGN_VARIABLES_MAX];
    for (size_t i = 0; i < n; i++) {
        double *x = X + i * p->n_var;
        memcpy(x, job->x, p->n_var * sizeof *x);
        if (variable < p->n_var)
            x[variable] += AT[first + i] * step;
    }
    return tower_parts(p, n, X, job->results + first * job->n_replicates, err);
}

/* A tower of its own for every side: whatever follows from the setting follows. */
static Status simulate_setting(Job *job, const char *key, double value, double step, Err *err)
{
    for (size_t side = 0; side < SIDES_OF_TWO_STEPS; side++) {
        Settings s = job->settings;
        Problem p;
        char text[100];
        snprintf(text, sizeof text, "%s=%.17g", key, value + AT[side] * step);
        TRY(settings_set(&s, text, err));
        TRY(tower_open(&p, &s, TOWER_AS_SET, job->n_replicates, err));
        const Status status = simulate_sides(job, &p, SIZE_MAX, 0, side, 1, err);
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

static Status vary_design(Job *job, const Problem *p, Sensitivity *out, Err *err)
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
        TRY(simulate_sides(job, p, j, out[j].step, 0, SIDES_OF_TWO_STEPS, err));
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

static Status find(Job *job, const Problem *p, Sensitivity **out, size_t *n, Err *err)
{
    const size_t parts = SIDES_OF_TWO_STEPS * job->n_replicates;
    job->space = *tower_design(tower_of(p));
    *n = (size_t)job->space.n_var;
    *out = calloc(*n + N_KEYS, sizeof **out);
    job->results = calloc(parts, sizeof *job->results);
    Status status = *out && job->results ? vary_design(job, p, *out, err)
                                         : fail(err, STATUS_NO_MEMORY, "no memory for %zu simulations", parts);
    if (status == STATUS_OK)
        status = vary_settings(job, *out, n, err);
    free(job->results);
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
    job->settings.sim.replicates = (long)n_replicates;
    snprintf(job->settings.motion.records, sizeof job->settings.motion.records, "none");
    Status status = tower_open(&p, &job->settings, TOWER_AS_SET, SIZE_MAX, err);
    if (status == STATUS_OK) {
        status = find(job, &p, out, n, err);
        problem_close(&p);
    }
    free(job);
    if (status != STATUS_OK) {
        free(*out);
        *out = NULL;
    }
    return status;
}
