#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/units.h"
#include "cmd/commands.h"
#include "cmd/designs.h"
#include "cmd/show.h"
#include "report/heights.h"
#include "scene/frame.h"
#include "settings/settings.h"
#include "analysis/estimate.h"
#include "evaluate/tower.h"
#include "store/run_read.h"
#include "study/record_paths.h"

enum { REDUCED, FULL, MODELS };
static const char *const WORDS[MODELS] = {"reduced", "full"};

/* Above the degrees of freedom of any frame. */
static const long ALL_MODES = 100000;

typedef struct {
    const Settings *s;
    SceneKind kind;
    Designs designs;
    size_t n;
    DesignSpace space;
    int n_floors, dofs[MODELS]; /* degrees of freedom of the building */
    double z[FLOORS_MAX];       /* [m] of the floors */
    SimResult *results[MODELS]; /* (n) under the record at hand */
    double *error;              /* (n, N_MEASURES) estimated integration errors of the reduced model; NULL: not known */
    char motion[sizeof((Motion){0}).name];
    double pga_g, scale, stretch;
    json_t *list; /* NULL: a table */
    const char *svg;
    MeasureOrder order;
} Job;

/* ---- both models ------------------------------------------------------------------------------------------------- */

static void note_scene(Job *job, const Scenario *w, int model)
{
    const Building *b = scene_building(w->scene);
    double z = 0;
    job->dofs[model] = b->model.n;
    for (int j = 0; j < b->n; j++)
        job->z[j] = z += b->storey_m[j];
    snprintf(job->motion, sizeof job->motion, "%s", w->motion.name);
    job->pga_g = motion_peak(&w->motion) / GRAVITY;
    job->scale = w->motion.scale;
    job->stretch = w->motion.stretch;
}

static Status simulate(Job *job, const Settings *s, const Problem *p, int model, Err *err)
{
    SimTask *tasks = calloc(job->n, sizeof *tasks);
    if (!tasks)
        return fail(err, STATUS_NO_MEMORY, "no memory for %zu simulations", job->n);
    for (size_t i = 0; i < job->n; i++)
        tasks[i] = (SimTask){job->kind, job->designs.x ? job->designs.x + i * (size_t)job->space.n_var : NULL};
    Status status = tower_simulate(p, job->n, tasks, job->results[model], err);
    if (status == STATUS_OK && model == REDUCED && job->error)
        status = estimate_designs(s, job->n, tasks, job->results[model], job->error, err);
    free(tasks);
    for (size_t i = 0; i < job->n && status == STATUS_OK; i++)
        if (job->results[model][i].outcome != RUN_OK)
            fprintf(stderr, "design %zu, %s model: failed: %s\n", i + 1, WORDS[model], job->results[model][i].reason);
    return status;
}

static Status simulate_model(Job *job, const Settings *s, int model, Err *err)
{
    Problem p;
    Settings own = *s;
    if (model == FULL)
        own.building.modes = ALL_MODES;
    TRY(tower_open(&p, &own, TOWER_SINGLE, job->n, err));
    note_scene(job, tower_record(tower_of(&p), 0), model);
    const Status status = simulate(job, &own, &p, model, err);
    problem_close(&p);
    return status;
}

/* ---- what is shown ----------------------------------------------------------------------------------------------- */

static double relative(double reduced, double full)
{
    return full == 0 && reduced == 0 ? 0 : reduced / full - 1;
}

static json_t *describe(const Job *job, size_t i)
{
    const SimResult *reduced = &job->results[REDUCED][i], *full = &job->results[FULL][i];
    json_t *o = json_object(), *error = json_object();
    if (job->designs.x)
        json_object_set_new(o, "design", json_integer(job->designs.id ? job->designs.id[i] : (long)i + 1));
    json_object_set_new(o, "record", json_string(job->motion));
    json_object_set_new(o, "pga_g", json_number(job->pga_g));
    json_object_set_new(o, "scale", json_number(job->scale));
    json_object_set_new(o, "stretch", json_number(job->stretch));
    json_object_set_new(o, "degrees_of_freedom",
                        json_pack("{s:i, s:i}", WORDS[REDUCED], job->dofs[REDUCED], WORDS[FULL], job->dofs[FULL]));
    for (int m = 0; m < MODELS; m++)
        json_object_set_new(o, WORDS[m], json_result(job->kind, &job->results[m][i]));
    for (int k = 0; k < N_MEASURES; k++)
        json_object_set_new(error, measure(k)->name,
                            json_number(relative(measure_value(reduced, k), measure_value(full, k))));
    json_object_set_new(o, "error", error);
    return o;
}

static void print_peaks(const Job *job, size_t i)
{
    const SimResult *r = &job->results[REDUCED][i], *f = &job->results[FULL][i];
    printf("\n%5s %8s  %30s  %30s  %30s\n", "", "", "peak displacement [m]", "peak interstorey drift [m]",
           "peak acceleration [g]");
    printf("%5s %8s", "floor", "z [m]");
    for (int k = 0; k < 3; k++)
        printf("  %10s %10s %8s", WORDS[REDUCED], WORDS[FULL], "error");
    putchar('\n');
    for (int j = job->n_floors - 1; j >= 0; j--) {
        const double of[3][MODELS] = {{r->peak_displacement_m[j], f->peak_displacement_m[j]},
                                      {r->peak_drift_m[j], f->peak_drift_m[j]},
                                      {r->peak_acceleration_g[j], f->peak_acceleration_g[j]}};
        printf("%5d %8.2f", j + 1, job->z[j]);
        for (int k = 0; k < 3; k++)
            printf("  %10.4g %10.4g %6.2f %%", of[k][REDUCED], of[k][FULL],
                   100 * relative(of[k][REDUCED], of[k][FULL]));
        putchar('\n');
    }
}

static void print_design(const Job *job, size_t i)
{
    char label[64];
    const double *known = job->error ? job->error + i * N_MEASURES : NULL;
    for (int m = 0; m < MODELS; m++) {
        if (job->designs.x)
            snprintf(label, sizeof label, "design %ld, %s (%d)", job->designs.id ? job->designs.id[i] : (long)i + 1,
                     WORDS[m], job->dofs[m]);
        else
            snprintf(label, sizeof label, "no core, %s (%d)", WORDS[m], job->dofs[m]);
        show_result(label, &job->order, &job->results[m][i], known);
    }
    if (known)
        show_result_errors(&job->order, known);
    printf("%-28s", "  error of the reduced [%]");
    for (int o = 0; o < job->order.n_obj; o++) {
        const int k = job->order.of[o];
        printf(" %10.3f",
               100 * relative(measure_value(&job->results[REDUCED][i], k), measure_value(&job->results[FULL][i], k)));
    }
    putchar('\n');
}

static void print_table(const Job *job)
{
    printf("%s: %.4g g, time x %.4g\n", job->motion, job->pga_g, job->stretch);
    show_result_names("model (degrees of freedom)", &job->order);
    for (size_t i = 0; i < job->n; i++)
        print_design(job, i);
    if (job->n == 1)
        print_peaks(job, 0);
    putchar('\n');
}

static Status draw(const Job *job, Err *err)
{
    const char *slash = strrchr(job->motion, '/');
    const SimResult *r = job->results[REDUCED], *f = job->results[FULL];
    const HeightPanel panels[] = {
        {.title = "peak displacement [m]",
         .curve = {r->peak_displacement_m, f->peak_displacement_m},
         .name = {WORDS[REDUCED], WORDS[FULL]},
         .from_ground = 1},
        {.title = "peak interstorey drift [m]", .curve = {r->peak_drift_m, f->peak_drift_m}},
        {.title = "peak acceleration [g]", .curve = {r->peak_acceleration_g, f->peak_acceleration_g}},
    };
    return heights_draw(&(Heights){.title = slash ? slash + 1 : job->motion,
                                   .n = job->n_floors,
                                   .z = job->z,
                                   .columns = 3,
                                   .n_panels = 3,
                                   .panel = panels},
                        job->svg, err);
}

/* ---- designs and records ----------------------------------------------------------------------------------------- */

static Status verify_under(Job *job, const Settings *s, Err *err)
{
    for (int m = 0; m < MODELS; m++)
        TRY(simulate_model(job, s, m, err));
    if (job->svg)
        TRY(draw(job, err));
    for (size_t i = 0; i < job->n && job->list; i++)
        json_array_append_new(job->list, describe(job, i));
    if (!job->list)
        print_table(job);
    return STATUS_OK;
}

static Status verify_all(const Args *args, Job *job, Err *err)
{
    Settings s = *job->s;
    const char *path;
    if (!args_has(args, "--record"))
        return verify_under(job, &s, err);
    for (int i = 0; (path = args_next(args, "--record", &i));) {
        TRY(option_put_path(s.motion.record, path, err));
        TRY(verify_under(job, &s, err));
        job->svg = NULL; /* the first one is drawn */
    }
    return STATUS_OK;
}

static Status show(const Args *args, Job *job, Err *err)
{
    job->list = args_has(args, "--json") ? json_array() : NULL;
    Status status = verify_all(args, job, err);
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
    Building b;
    Job job = {.s = s, .kind = SCENE_IMPACT, .n = 1, .svg = args_value(args, "--svg")};
    if (s->problem.kind != PROBLEM_TOWER)
        return fail(err, STATUS_BAD_DATA, "problem.kind: only a tower has a full model");
    s->sim.forces = args_has(args, "--json");
    TRY(building_load(&b, &s->building, err));
    job.n_floors = b.n;
    building_free(&b);
    if (!frame_is(s->building.model))
        return fail(err, STATUS_BAD_DATA,
                    "building.model: %s has nothing fuller than its floors to verify with; only a plane frame "
                    "(nodes.csv) and guyan have",
                    s->building.model);
    TRY(design_space_make(&job.space, &s->design, s->core.section, job.n_floors, err));
    TRY(measures_order(&job.order, s->search.objectives, job.n_floors, err));
    Status status = take_designs(args, folder, &job, err);
    for (int m = 0; m < MODELS && status == STATUS_OK; m++) {
        job.results[m] = calloc(job.n, sizeof *job.results[m]);
        status = job.results[m] ? STATUS_OK : fail(err, STATUS_NO_MEMORY, "no memory for %zu results", job.n);
    }
    if (status == STATUS_OK && s->sim.engine == ENGINE_FAST && !args_has(args, "--json")) {
        job.error = calloc(job.n, N_MEASURES * sizeof *job.error);
        status = job.error ? STATUS_OK : fail(err, STATUS_NO_MEMORY, "no memory for %zu results", job.n);
    }
    if (status == STATUS_OK)
        status = show(args, &job, err);
    free(job.error);
    for (int m = 0; m < MODELS; m++)
        free(job.results[m]);
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

static Status run(const Args *args, Err *err)
{
    Settings s;
    char database[PATH_MAX];
    const int is_run = run_path(args->operand, database, sizeof database);
    TRY(is_run ? settings_of_run(args, &s, err) : args_settings(args, &s, NULL, NULL, err));
    return verify_by(args, &s, is_run ? args->operand : NULL, err);
}

static const ArgOption OPTIONS[] = {
    {"--design", "ID", NULL, 0, DESIGN_WORDS "; of a RUN also ID, knee (default); none: the building alone"},
    {"--record", "FILE", NULL, 1, "ground motion; may be repeated"},
    OPTION_CHANNEL,
    OPTION_PGA,
    OPTION_STRETCH,
    OPTION_UNIT,
    OPTION_DURATION,
    OPTION_ENGINE,
    OPTION_SET,
    {"--svg", "FILE", NULL, 0, "peaks over the height of the first design under the first record, drawn by gnuplot"},
    OPTION_JSON,
    OPTION_END,
};

const Command CMD_VERIFY = {
    .name = "verify",
    .operand = "CONFIG|RUN",
    .summary = "designs on the full model of the building, beside the reduced one",
    .example = "imtet verify results/quick --design knee",
    .details =
        "Simulates designs on the building as the settings reduce it (building.modes, by default the floors alone) "
        "and\n"
        "on all degrees of freedom of its frame, with the contacts at the floors and all modes: 106 of the built-in\n"
        "tower. Shares by mode are booked by shape. --json: objects reduced and full with the keys of `simulate "
        "--json`,\n"
        "error: reduced / full - 1; one object, or a list of them for several designs or records.",
    .options = OPTIONS,
    .run = run,
};
