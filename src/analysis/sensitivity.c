#include "analysis/sensitivity.h"

#include "base/stat.h"
#include "scene/design.h"

enum { SIDES_OF_TWO_STEPS = 4 }; /* -h, h, -h/2, h/2 */
static const double AT[SIDES_OF_TWO_STEPS] = {-1, 1, -0.5, 0.5};
static const double GAP_STEP = 1e-3, SHARE = 0.02; /* [m], [-] */

static const char *const KEYS[] = {
    "contact.radius_m",     "contact.restitution",          "building.damping",
    "core.damping",         "contact.bumper_stiffness_n_m", "core.foundation_factor",
    "building.yield_drift",
};
enum { N_KEYS = sizeof KEYS / sizeof KEYS[0] };

typedef struct {
    size_t n_replicates, n_parameters, n_var;
    const double *x;
    DesignSpace space;
    Sensitivity *out;
    double *X;       /* (n_var, SIDES_OF_TWO_STEPS, n_var) designs of which one variable is changed */
    Measured *parts; /* (n_parameters, SIDES_OF_TWO_STEPS, n_replicates) */
    size_t n_scenes;
    SceneChange scene[1 + SIDES_OF_TWO_STEPS * N_KEYS]; /* as set, then the sides of every setting */
} Job;

/* Mean, and standard error (NAN: one replicate), of the differences over 2h of measure k between two sides. */
static void difference(const Job *job, size_t parameter, int minus, double h, int k, double *mean, double *error)
{
    const size_t n = job->n_replicates;
    const Measured *side = job->parts + (parameter * SIDES_OF_TWO_STEPS + (size_t)minus) * n;
    double v[1000] = {0};
    for (size_t i = 0; i < n; i++) {
        const Measured *below = &side[i], *above = below + n;
        const int ok = below->outcome == RUN_OK && above->outcome == RUN_OK;
        v[i] = ok ? (above->value[k] - below->value[k]) / (2 * h) : NAN;
    }
    mean_and_sd_of(n, v, mean, error);
    *error /= sqrt((double)n);
}

static void conclude(const Job *job, size_t parameter, Sensitivity *out)
{
    for (int k = 0; k < N_MEASURES; k++) {
        double coarse, fine, unused, error;
        difference(job, parameter, 0, out->step, k, &coarse, &unused);
        difference(job, parameter, 2, 0.5 * out->step, k, &fine, &error);
        out->slope[k] = out->step > 0 ? fine : NAN;
        out->error[k] = out->step > 0 ? hypot(isnan(error) && !isnan(fine) ? 0 : error, coarse - fine) : NAN;
    }
    /* J3 jumps with every impact more or less: a slope of it says nothing, unless nothing changes. */
    if (out->slope[MEASURE_J3] != 0)
        out->slope[MEASURE_J3] = out->error[MEASURE_J3] = NAN;
}

/* Names, values and steps; a variable that is 0 has no step. */
static void list_variables(Job *job)
{
    for (size_t j = 0; j < job->n_var; j++) {
        Sensitivity *o = &job->out[j];
        design_variable_name(&job->space, (int)j, o->name);
        o->value = job->x[j];
        o->step = design_word(&job->space, (int)j, o->value) ? 0 /* no slope: the next word is another device */
                  : j < (size_t)job->space.n_gaps            ? fmin(GAP_STEP, 0.5 * o->value)
                                                             : SHARE * o->value;
        for (size_t side = 0; side < SIDES_OF_TWO_STEPS; side++) {
            double *x = job->X + (j * SIDES_OF_TWO_STEPS + side) * job->n_var;
            memcpy(x, job->x, job->n_var * sizeof *x);
            x[j] += AT[side] * o->step;
        }
    }
}

/* A scene of its own for every side: whatever follows from the setting follows. */
static void list_settings(Job *job, const Settings *s)
{
    const double damping = s->building.damping.n == 1 ? s->building.damping.at[0] : 0; /* of a list of them: none */
    const double values[N_KEYS] = {s->contact.radius_m,
                                   s->contact.restitution,
                                   damping,
                                   s->core.damping,
                                   s->contact.bumper_stiffness_n_m,
                                   strcmp(s->core.foundation, "fixed") == 0 ? 0 : s->core.foundation_factor,
                                   s->building.yield_drift};
    job->n_scenes = 1;
    for (size_t i = 0; i < N_KEYS; i++) {
        const double value = values[i];
        if (!(value > 0) || (i == 1 && value * (1 + SHARE) > 1))
            continue;
        Sensitivity *o = &job->out[job->n_parameters++];
        text_copy(o->name, KEYS[i]);
        o->value = value;
        o->step = SHARE * value;
        for (size_t side = 0; side < SIDES_OF_TWO_STEPS; side++) {
            char *setting = job->scene[job->n_scenes++].setting;
            snprintf(setting, sizeof job->scene->setting, "%s=%.17g", KEYS[i], value + AT[side] * o->step);
        }
    }
}

/* One task for every side of every parameter, all of them at once. */
static Status simulate(Job *job, const Settings *s, Err *err)
{
    const size_t n = job->n_parameters * SIDES_OF_TWO_STEPS;
    size_t n_tasks = 0;
    Problem p;
    SimTask *tasks = calloc(n, sizeof *tasks);
    job->parts = calloc(n * job->n_replicates, sizeof *job->parts);
    for (size_t i = 0; tasks && i < n; i++) {
        const size_t j = i / SIDES_OF_TWO_STEPS;
        const int is_setting = j >= job->n_var;
        tasks[n_tasks] = (SimTask){.x = is_setting ? job->x : job->X + i * job->n_var,
                                   .scene = is_setting ? 1 + i - job->n_var * SIDES_OF_TWO_STEPS : 0,
                                   .n_parts = job->n_replicates,
                                   .parts = job->parts + i * job->n_replicates};
        n_tasks += job->out[j].step > 0;
    }
    const char *const record = s->motion.record;
    Status status = job->parts && tasks ? tower_open_scenes(&p, s, 1, &record, job->n_scenes, job->scene, err)
                                        : fail_memory(err, n, "simulations");
    if (status == STATUS_OK) {
        status = tower_run(&p, n_tasks, tasks, NULL, NULL, err);
        problem_close(&p);
    }
    free(tasks);
    return status;
}

static Status find(Job *job, const Settings *s, Err *err)
{
    TRY(tower_space(s, &job->space, err));
    job->n_parameters = job->n_var = (size_t)job->space.n_var;
    job->out = calloc(job->n_var + N_KEYS, sizeof *job->out);
    job->X = calloc(job->n_var * SIDES_OF_TWO_STEPS * job->n_var, sizeof *job->X);
    if (!job->out || !job->X)
        return fail_memory(err, job->n_var + N_KEYS, "parameters");
    list_variables(job);
    list_settings(job, s);
    TRY(simulate(job, s, err));
    for (size_t i = 0; i < job->n_parameters; i++)
        conclude(job, i, &job->out[i]);
    return STATUS_OK;
}

Status sensitivity_find(const Settings *settings, const double x[], size_t n_replicates, Sensitivity **out, size_t *n,
                        Err *err)
{
    Settings s = *settings;
    Job job = {.n_replicates = n_replicates, .x = x};
    s.sim.forces = FORCES_YES;
    s.sim.replicates = (long)n_replicates;
    const Status status = find(&job, &s, err);
    *n = job.n_parameters;
    *out = status == STATUS_OK ? job.out : NULL;
    if (status != STATUS_OK)
        free(job.out);
    free(job.X);
    free(job.parts);
    return status;
}
