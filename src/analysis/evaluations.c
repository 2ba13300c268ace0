#include "analysis/evaluations.h"

#include "evaluate/device.h"
#include "analysis/estimate.h"
#include "base/stat.h"
#include "base/units.h"
#include "motion/motion_scale.h"
#include "motion/suite.h"

const char *evaluated_name(const EvaluatedRecord *r)
{
    const char *slash = strrchr(r->path, '/');
    return slash ? slash + 1 : r->path;
}

/* ---- which records ----------------------------------------------------------------------------------------------- */

Status evaluations_add(Evaluations *e, const char *path, int from_folder, Err *err)
{
    EvaluatedRecord *more = realloc(e->record, (e->n_records + 1) * sizeof *more);
    if (!more)
        return fail_memory(err, e->n_records + 1, "records");
    e->record = more;
    more[e->n_records] = (EvaluatedRecord){.path = strdup(path), .from_folder = from_folder};
    if (!more[e->n_records].path)
        return fail(err, STATUS_NO_MEMORY, "no memory for a path");
    e->n_records++;
    return STATUS_OK;
}

typedef struct {
    Evaluations *e;
    const char *suite;
} Added;

/* A record that stands by itself is asked for by name: it has to be there. */
static Status add_of_suite(const char *source, void *user, Err *err)
{
    const Added *a = user;
    return evaluations_add(a->e, source, strcmp(source, a->suite) != 0, err);
}

Status evaluations_add_suite(Evaluations *e, const char *suite, Err *err)
{
    Err why = {0};
    const Status status = suite_each(suite, add_of_suite, &(Added){e, suite}, &why);
    return status == STATUS_OK ? STATUS_OK : fail(err, status, "--record %s", why.text);
}

/* ---- reading ----------------------------------------------------------------------------------------------------- */

Status evaluations_read(Evaluations *e, const Settings *settings, Err *err)
{
    const size_t n = e->n_records * e->n_levels;
    Settings s = *settings;
    const char **paths = calloc(e->n_records, sizeof *paths);
    SceneChange *scenes = calloc(n, sizeof *scenes);
    for (size_t i = 0; paths && i < e->n_records; i++)
        paths[i] = e->record[i].path;
    for (size_t i = 0; scenes && i < n; i++) {
        scenes[i].record = i / e->n_levels;
        if (e->level)
            snprintf(scenes[i].setting, sizeof scenes[i].setting, "motion.%s=%.17g", e->intensity,
                     e->level[i % e->n_levels]);
    }
    if (e->level)
        motion_unscale(&s.motion);
    s.sim.replicates = e->replicates > 0 ? e->replicates : 1;
    const Status status = paths && scenes ? tower_open_scenes(&e->tower, &s, e->n_records, paths, n, scenes, err)
                                          : fail_memory(err, n * N_SCENES, "simulations");
    free(paths);
    free(scenes);
    TRY(status);
    e->is_estimated = s.sim.engine == ENGINE_FAST;
    TRY_ROOM(e->run, n, "records", err);
    for (size_t i = 0; i < n; i++) {
        EvaluatedRecord *r = &e->record[i / e->n_levels];
        Motion m;
        e->run[i].record = r;
        if (r->readable == STATUS_OK && (r->readable = tower_motion(&e->tower, i, &m, &r->why)) == STATUS_OK) {
            e->run[i].pga_g = motion_peak(&m) / GRAVITY;
            e->run[i].scale = m.scale;
            e->run[i].stretch = m.stretch;
            motion_free(&m);
        }
        if (r->readable != STATUS_OK && (!r->from_folder || r->readable == STATUS_NO_MEMORY))
            return fail(err, r->readable, "%s", r->why.text);
    }
    for (size_t i = 0; i < e->n_records; i++)
        e->n_read += e->record[i].readable == STATUS_OK;
    return STATUS_OK;
}

/* ---- all runs ---------------------------------------------------------------------------------------------------- */

int evaluated_has(const Evaluations *e, const EvaluatedRun *run, SceneKind which)
{
    return !case_has_device(which) || (!e->level && !run->record->from_folder) ||
           (which == SCENE_LINKS && e->has_links);
}

/* One building has the same links under every record. */
static Status find_devices(Evaluations *e, const double x[], Err *err)
{
    const size_t n_runs = e->n_records * e->n_levels;
    DeviceSearch *search = calloc(n_runs * N_SCENES, sizeof *search);
    double *links = calloc(n_runs, sizeof *links);
    size_t n = 0, n_links = 0;
    for (size_t i = 0; search && links && i < n_runs; i++)
        for (SceneKind c = 0; c < N_SCENES; c++)
            if (e->run[i].record->readable == STATUS_OK && case_has_device(c) && evaluated_has(e, &e->run[i], c) &&
                (!e->level || i % e->n_levels == e->n_levels / 2))
                search[n++] = (DeviceSearch){.kind = c, .x = x, .scene = i};
    const Status status = !search || !links ? fail_memory(err, n_runs * N_SCENES, "devices")
                          : n > 0           ? devices_find(&e->tower, n, search, err)
                                            : STATUS_OK;
    for (size_t k = 0; k < n; k++) {
        e->run[search[k].scene].device[search[k].kind] = search[k].device;
        if (search[k].kind == SCENE_LINKS)
            links[n_links++] = search[k].device.link_ns_m;
    }
    if (n_links > 0)
        sort_values(n_links, links);
    for (size_t i = 0; i < n_runs && n_links > 0 && e->has_links; i++)
        e->run[i].device[SCENE_LINKS].link_ns_m = 0.5 * (links[(n_links - 1) / 2] + links[n_links / 2]);
    free(search);
    free(links);
    return status;
}

/* Cases without a device, and the design with twice the steps of records of a folder; those with one; replicates. */
typedef enum { FIRST, WITH_DEVICES, REPLICATES } Round;

static Status run_round(Evaluations *e, Round round, const double x[], EvaluationsTold *told, Err *err)
{
    const size_t n = e->n_records * e->n_levels;
    SimTask *tasks;
    size_t n_tasks = 0;
    TRY_ROOM(tasks, n * N_SCENES, "simulations", err);
    for (size_t i = 0; i < n; i++) {
        EvaluatedRun *run = &e->run[i];
        if (run->record->readable != STATUS_OK)
            continue;
        run->error_known = e->is_estimated && !e->level;
        for (SceneKind c = 0; c < N_SCENES && round != REPLICATES; c++)
            if (case_has_device(c) == (round == WITH_DEVICES) && evaluated_has(e, run, c))
                tasks[n_tasks++] =
                    (SimTask){.kind = c, .x = x, .scene = i, .device = run->device[c], .result = &run->result[c]};
        if (round == FIRST && run->error_known && run->record->from_folder)
            tasks[n_tasks++] = (SimTask){.x = x, .scene = i, .level = 1, .parts = &run->finer};
        if (round == REPLICATES && e->replicates > 0)
            tasks[n_tasks++] = (SimTask){.x = x, .scene = i, .n_parts = e->tower.n_parts, .summary = &run->replicates};
    }
    if (told)
        told->n_all = n_tasks;
    const Status status =
        n_tasks > 0 ? tower_run(&e->tower, n_tasks, tasks, told ? told->tell : NULL, told, err) : STATUS_OK;
    free(tasks);
    return status;
}

static Status estimate(const Evaluations *e, size_t i, const double x[], Err *err)
{
    EvaluatedRun *run = &e->run[i];
    const Measured found = measured(run->result);
    if (!run->record->from_folder)
        return estimate_designs(&e->tower, 1, &(SimTask){.x = x, .scene = i}, run->result, run->error, run->sd, err);
    estimate_errors(&found, &run->finer, run->error);
    for (int k = 0; k < N_MEASURES; k++)
        run->sd[k] = NAN;
    return STATUS_OK;
}

Status evaluations_run(Evaluations *e, size_t n_var, const double x[], EvaluationsTold *told, Err *err)
{
    if (e->tower.n_var != n_var)
        return bad_data(err, "the front has designs of %zu variables, this building has %zu", n_var, e->tower.n_var);
    TRY(run_round(e, FIRST, x, told, err));
    TRY(find_devices(e, x, err));
    TRY(run_round(e, WITH_DEVICES, x, NULL, err));
    TRY(run_round(e, REPLICATES, x, told, err));
    for (size_t i = 0; i < e->n_records * e->n_levels; i++)
        if (e->run[i].error_known)
            TRY(estimate(e, i, x, err));
    return STATUS_OK;
}

void evaluations_free(Evaluations *e)
{
    for (size_t i = 0; i < e->n_records; i++)
        free(e->record[i].path);
    problem_close(&e->tower);
    free(e->run);
    free(e->record);
}

/* ---- incremental dynamic analysis -------------------------------------------------------------------------------- */

Status ida_levels(const char *option, const char *text, double levels[IDA_LEVELS_MAX], size_t *n, Err *err)
{
    double from, step, to;
    char more;
    if (sscanf(text, "%lf:%lf:%lf%c", &from, &step, &to, &more) != 3 || !(from > 0 && step > 0 && to >= from) ||
        !isfinite(to) || !(step >= 1e-9 * to))
        return fail(err, STATUS_USAGE, "%s %.60s: a range is FROM:STEP:TO in g, all above 0, as 0.05:0.05:0.6", option,
                    text);
    const double steps = floor((to - from) / step + 1e-6);
    if (!(steps < IDA_LEVELS_MAX))
        return fail(err, STATUS_USAGE, "%s %.60s: more than %d intensities", option, text, IDA_LEVELS_MAX);
    *n = (size_t)steps + 1;
    for (size_t i = 0; i < *n; i++) {
        char digits[32]; /* 0.15, not 0.15000000000000002 */
        snprintf(digits, sizeof digits, "%.9g", from + (double)i * step);
        levels[i] = strtod(digits, NULL);
    }
    return STATUS_OK;
}

double ida_value(const EvaluatedRun *run, SceneKind which, int k)
{
    const SimResult *r = &run->result[which];
    const double value = measure_value(r, k);
    return r->outcome == RUN_OK && isfinite(value) ? value : INFINITY;
}

double ida_fractile(const Evaluations *e, size_t l, SceneKind which, int k, double p)
{
    double *sorted = malloc(e->n_records * sizeof *sorted), value = NAN;
    size_t n = 0;
    for (size_t r = 0; sorted && r < e->n_records; r++)
        if (e->record[r].readable == STATUS_OK)
            sorted[n++] = ida_value(&e->run[r * e->n_levels + l], which, k);
    if (n > 0) {
        sort_values(n, sorted);
        const double place = p * (double)(n - 1), low = floor(place), share = place - low;
        const size_t i = (size_t)low;
        value = share > 0 ? sorted[i] + share * (sorted[i + 1] - sorted[i]) : sorted[i];
        if (share > 0 && !isfinite(sorted[i + 1]))
            value = INFINITY;
    }
    free(sorted);
    return value;
}

Fragility ida_fragility(const Evaluations *e, SceneKind which, int k, const Limit *limit, size_t n_at[],
                        size_t exceeded[])
{
    for (size_t l = 0; l < e->n_levels; l++) {
        n_at[l] = exceeded[l] = 0;
        for (size_t r = 0; r < e->n_records; r++) {
            const SimResult *result = &e->run[r * e->n_levels + l].result[which];
            const double value = measure_value(result, k);
            if (e->record[r].readable != STATUS_OK || (result->outcome == RUN_OK && isnan(value)))
                continue;
            n_at[l]++;
            exceeded[l] += result->outcome != RUN_OK || limit->sign * (value - limit->bound) > 0;
        }
    }
    return fragility_fit(e->n_levels, e->level, n_at, exceeded);
}

AnnualLoss ida_annual_loss(const Evaluations *e, SceneKind which, size_t n_hazard, const double hazard[])
{
    double loss[IDA_LEVELS_MAX], squares = 0;
    const double n = (double)e->n_read;
    AnnualLoss mean = {0};
    for (size_t r = 0; r < e->n_records; r++) {
        if (e->record[r].readable != STATUS_OK)
            continue;
        for (size_t l = 0; l < e->n_levels; l++) {
            loss[l] = ida_value(&e->run[r * e->n_levels + l], which, MEASURE_LOSS);
            mean.n_failed += !isfinite(loss[l]);
            loss[l] = fmin(loss[l], 1);
        }
        const AnnualLoss one = annual_loss(e->n_levels, e->level, loss, n_hazard, hazard);
        mean.per_year += one.per_year / n;
        mean.below += one.below / n;
        mean.above += one.above / n;
        mean.at_begin += one.at_begin / n;
        squares += one.per_year * one.per_year / n;
    }
    mean.error = n > 1 ? sqrt(fmax(squares - mean.per_year * mean.per_year, 0) / (n - 1)) : NAN;
    return mean;
}
