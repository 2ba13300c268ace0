#include "cmd/full_model.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "analysis/full_model.h"
#include "base/units.h"
#include "cmd/designs.h"
#include "cmd/show.h"
#include "report/heights.h"
#include "scene/frame.h"
#include "settings/settings.h"
#include "store/run_read.h"

static const char *const WORDS[MODELS] = {"reduced", "full"};

typedef struct {
    SceneKind kind;
    Designs designs;
    size_t n;
    DesignSpace space;
    MeasureOrder order;
    int estimates;
    json_t *list;    /* NULL: a table */
    const char *svg; /* of the first record */
    FullModel found; /* under the record at hand */
} Job;

static long number_of(const Job *job, size_t i)
{
    return job->designs.id ? job->designs.id[i] : (long)i + 1;
}

/* ---- what is shown ----------------------------------------------------------------------------------------------- */

static double relative(double reduced, double full)
{
    return full == 0 && reduced == 0 ? 0 : reduced / full - 1;
}

static json_t *describe(const Job *job, size_t i)
{
    const SimResult *reduced = &job->found.result[REDUCED][i], *full = &job->found.result[FULL][i];
    json_t *o = json_object(), *error = json_object();
    if (job->designs.x)
        json_object_set_new(o, "design", json_integer(number_of(job, i)));
    json_object_set_new(o, "record", json_string(job->found.motion.name));
    json_object_set_new(o, "pga_g", json_number(motion_peak(&job->found.motion) / GRAVITY));
    json_object_set_new(o, "scale", json_number(job->found.motion.scale));
    json_object_set_new(o, "stretch", json_number(job->found.motion.stretch));
    json_object_set_new(
        o, "degrees_of_freedom",
        json_pack("{s:i, s:i}", WORDS[REDUCED], job->found.dofs[REDUCED], WORDS[FULL], job->found.dofs[FULL]));
    for (int m = 0; m < MODELS; m++)
        json_object_set_new(o, WORDS[m], json_result(job->kind, &job->found.result[m][i]));
    for (int k = 0; k < N_MEASURES; k++)
        json_object_set_new(error, measure(k)->name,
                            json_number(relative(measure_value(reduced, k), measure_value(full, k))));
    json_object_set_new(o, "error", error);
    return o;
}

static void print_peaks(const Job *job, size_t i)
{
    const SimResult *r = &job->found.result[REDUCED][i], *f = &job->found.result[FULL][i];
    printf("\n%5s %8s  %30s  %30s  %30s\n", "", "", "peak displacement [m]", "peak interstorey drift [m]",
           "peak acceleration [g]");
    printf("%5s %8s", "floor", "z [m]");
    for (int k = 0; k < 3; k++)
        printf("  %10s %10s %8s", WORDS[REDUCED], WORDS[FULL], "error");
    putchar('\n');
    for (int j = job->found.n_floors - 1; j >= 0; j--) {
        const double of[3][MODELS] = {{r->peak_displacement_m[j], f->peak_displacement_m[j]},
                                      {r->peak_drift_m[j], f->peak_drift_m[j]},
                                      {r->peak_acceleration_g[j], f->peak_acceleration_g[j]}};
        printf("%5d %8.2f", j + 1, job->found.z[j]);
        for (int k = 0; k < 3; k++)
            printf("  %10.4g %10.4g %6.2f %%", of[k][REDUCED], of[k][FULL],
                   100 * relative(of[k][REDUCED], of[k][FULL]));
        putchar('\n');
    }
}

static void print_design(const Job *job, size_t i)
{
    char label[64];
    const double *known = job->found.error ? job->found.error + i * N_MEASURES : NULL;
    for (int m = 0; m < MODELS; m++) {
        if (job->designs.x)
            snprintf(label, sizeof label, "design %ld, %s (%d)", number_of(job, i), WORDS[m], job->found.dofs[m]);
        else
            snprintf(label, sizeof label, "no core, %s (%d)", WORDS[m], job->found.dofs[m]);
        show_result(label, &job->order, &job->found.result[m][i], known);
    }
    if (known)
        show_result_errors(&job->order, known);
    printf("%-28s", "  error of the reduced [%]");
    for (int o = 0; o < job->order.n_obj; o++) {
        const int k = job->order.of[o];
        printf(" %10.3f", 100 * relative(measure_value(&job->found.result[REDUCED][i], k),
                                         measure_value(&job->found.result[FULL][i], k)));
    }
    putchar('\n');
}

static void print_table(const Job *job)
{
    printf("%s: %.4g g, time x %.4g\n", job->found.motion.name, motion_peak(&job->found.motion) / GRAVITY,
           job->found.motion.stretch);
    show_result_names("model (degrees of freedom)", &job->order);
    for (size_t i = 0; i < job->n; i++)
        print_design(job, i);
    if (job->n == 1)
        print_peaks(job, 0);
    putchar('\n');
}

static Status draw(const Job *job, Err *err)
{
    const char *slash = strrchr(job->found.motion.name, '/');
    const SimResult *r = job->found.result[REDUCED], *f = job->found.result[FULL];
    const HeightPanel panels[] = {
        {.title = "peak displacement [m]",
         .curve = {r->peak_displacement_m, f->peak_displacement_m},
         .name = {WORDS[REDUCED], WORDS[FULL]},
         .from_ground = 1},
        {.title = "peak interstorey drift [m]", .curve = {r->peak_drift_m, f->peak_drift_m}},
        {.title = "peak acceleration [g]", .curve = {r->peak_acceleration_g, f->peak_acceleration_g}},
    };
    return heights_draw(&(Heights){.title = slash ? slash + 1 : job->found.motion.name,
                                   .n = job->found.n_floors,
                                   .z = job->found.z,
                                   .columns = 3,
                                   .n_panels = 3,
                                   .panel = panels},
                        job->svg, err);
}

/* ---- designs and records ----------------------------------------------------------------------------------------- */

static void tell_failures(const Job *job)
{
    for (int m = 0; m < MODELS; m++)
        for (size_t i = 0; i < job->n; i++)
            if (job->found.result[m][i].outcome != RUN_OK)
                fprintf(stderr, "design %zu, %s model: failed: %s\n", i + 1, WORDS[m], job->found.result[m][i].reason);
}

static Status verify_under(Job *job, const Settings *s, Err *err)
{
    TRY(full_model_find(s, job->kind, job->n, job->designs.x, job->estimates, &job->found, err));
    tell_failures(job);
    const Status status = job->svg ? draw(job, err) : STATUS_OK;
    for (size_t i = 0; i < job->n && job->list; i++)
        json_array_append_new(job->list, describe(job, i));
    if (status == STATUS_OK && !job->list)
        print_table(job);
    full_model_free(&job->found);
    job->svg = NULL;
    return status;
}

static Status verify_all(const Args *args, Job *job, Settings *s, Err *err)
{
    const char *path;
    if (!args_has(args, "--record"))
        return verify_under(job, s, err);
    for (int i = 0; (path = args_next(args, "--record", &i));) {
        TRY(option_put_path(s->motion.record, path, err));
        TRY(verify_under(job, s, err));
    }
    return STATUS_OK;
}

static Status show(const Args *args, Job *job, Settings *s, Err *err)
{
    job->list = args_has(args, "--json") ? json_array() : NULL;
    Status status = verify_all(args, job, s, err);
    if (status != STATUS_OK || !job->list) {
        json_decref(job->list);
        return status;
    }
    json_t *only = json_array_size(job->list) == 1 ? json_incref(json_array_get(job->list, 0)) : NULL;
    if (only)
        json_decref(job->list);
    return show_json(only ? only : job->list, err);
}

/* --design; of a run also ID, knee, best_NAME alone. folder NULL: there is no run. */
static Status take_designs(const Args *args, const char *folder, Job *job, Err *err)
{
    const char *word = args_value(args, "--design");
    char own[PATH_MAX + 64];
    struct stat there;
    if (word && strcmp(word, "none") == 0) {
        job->kind = SCENE_NO_CORE;
        return STATUS_OK;
    }
    if (!word && !folder)
        return fail(err, STATUS_USAGE, "--design is missing: " DESIGN_WORDS "; none: the building alone");
    if (folder && (!word || (!strpbrk(word, "/:") && stat(word, &there) != 0))) {
        snprintf(own, sizeof own, "%s:%s", folder, word ? word : "knee");
        word = own;
    }
    TRY(designs_take(&job->designs, word, &job->space, err));
    job->n = job->designs.n;
    return STATUS_OK;
}

/* folder: of the run that the settings are of; NULL: of none. */
static Status verify_by(const Args *args, Settings *s, const char *folder, Err *err)
{
    const int as_json = args_has(args, "--json");
    Job job = {.n = 1, .svg = args_value(args, "--svg"), .estimates = s->sim.engine == ENGINE_FAST && !as_json};
    if (s->problem.kind != PROBLEM_TOWER)
        return fail(err, STATUS_BAD_DATA, "problem.kind: only a tower has a full model");
    if (!frame_is(s->building.model))
        return fail(err, STATUS_BAD_DATA,
                    "building.model: %s has nothing fuller than its floors to verify with; only a plane frame "
                    "(nodes.csv) and guyan have",
                    s->building.model);
    s->sim.forces = as_json;
    TRY(tower_space(s, &job.space, err));
    TRY(measures_order(&job.order, s->search.objectives, job.space.n_floors, err));
    TRY(take_designs(args, folder, &job, err));
    const Status status = show(args, &job, s, err);
    design_free(&job.designs);
    return status;
}

static Status settings_of_run(const Args *args, Settings *s, Err *err)
{
    Run r;
    TRY(run_read(&r, args->operand, err));
    *s = *r.settings;
    run_free(&r);
    TRY(args_apply(args, s, NULL, NULL, err));
    TRY(settings_check(s, err));
    return args_has(args, "--record") ? STATUS_OK : record_paths_find(s, NULL, &(RecordPaths){NULL, NULL}, err);
}

Status show_full_model(const Args *args, Err *err)
{
    static const char *const OTHERS[] = {"--records", "--csv", "--replicates"};
    Settings s;
    char database[PATH_MAX];
    const char *pga = args_value(args, "--pga");
    const int is_run = run_path(args->operand, database, sizeof database);
    for (size_t i = 0; i < sizeof OTHERS / sizeof OTHERS[0]; i++)
        if (args_has(args, OTHERS[i]))
            return fail(err, STATUS_USAGE, "--full-model: leave %s out", OTHERS[i]);
    TRY(is_run ? settings_of_run(args, &s, err) : args_settings(args, &s, NULL, NULL, err));
    if (pga) {
        char assignment[64];
        snprintf(assignment, sizeof assignment, "motion.pga_g=%.40s", pga);
        TRY(settings_set(&s, assignment, err));
        TRY(settings_check(&s, err));
    }
    return verify_by(args, &s, is_run ? args->operand : NULL, err);
}
