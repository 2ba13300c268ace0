#include <stdlib.h>
#include <string.h>

#include "scene/design.h"
#include "cmd/commands.h"
#include "cmd/show.h"
#include "simulator/crew.h"
#include "simulator/ensemble.h"
#include "store/output.h"
#include "simulator/scenario.h"
#include "settings/settings.h"

typedef struct {
    SceneKind kind;
    Designs designs;
    size_t n;
    SimTask *tasks;      /* (n) */
    SimResult *results;  /* (n) */
    int members;         /* of an ensemble per design; 0: none */
    Ensemble *ensembles; /* (n) or NULL */
} Job;

static Status choose_members(const Args *args, Job *job, Err *err)
{
    long members;
    if (!args_has(args, "--ensemble"))
        return STATUS_OK;
    TRY(args_whole(args, "--ensemble", 2, 100000, 0, &members, err));
    if (job->kind != SCENE_IMPACT)
        return fail(err, STATUS_USAGE,
                    "--ensemble perturbs gaps: it needs a design with gaps, neither none nor --rigid");
    job->members = (int)members;
    return STATUS_OK;
}

static Status choose_kind(const Args *args, Job *job, Err *err)
{
    const char *path = args_value(args, "--design");
    if (!path)
        return fail(err, STATUS_USAGE, "--design FILE is missing (--design none: the building alone)");
    const int none = strcmp(path, "none") == 0, tied = args_has(args, "--rigid");
    if (none && tied)
        return fail(err, STATUS_USAGE, "--rigid needs a core: give --design FILE instead of none");
    job->kind = none ? SCENE_NO_CORE : tied ? SCENE_RIGID : SCENE_IMPACT;
    return choose_members(args, job, err);
}

static void warn_top_heavy(const Designs *d, const char *path)
{
    const size_t n_var = (size_t)d->n_floors + 2;
    for (size_t i = 0; i < d->n; i++) {
        const double *wall = &d->x[i * n_var + n_var - 2];
        if (wall[1] > wall[0])
            fprintf(stderr, "%s:%d: t_top_m %g is thicker than t_base_m %g; the search would not propose this\n", path,
                    d->line[i], wall[1], wall[0]);
    }
}

static Status lay_out_job(const Args *args, Job *job, int n_floors, Err *err)
{
    const char *path = args_value(args, "--design");
    job->n = 1;
    if (job->kind != SCENE_NO_CORE) {
        TRY(design_read(&job->designs, path, n_floors, err));
        warn_top_heavy(&job->designs, path);
        job->n = job->designs.n;
    }
    job->tasks = calloc(job->n, sizeof *job->tasks);
    job->results = calloc(job->n, sizeof *job->results);
    if (job->members)
        job->ensembles = calloc(job->n, sizeof *job->ensembles);
    if (!job->tasks || !job->results || (job->members && !job->ensembles))
        return fail(err, STATUS_NO_MEMORY, "no memory for %zu simulations", job->n);
    for (size_t i = 0; i < job->n; i++)
        job->tasks[i] = (SimTask){job->kind, job->designs.x ? &job->designs.x[i * (size_t)(n_floors + 2)] : NULL};
    return STATUS_OK;
}

static Status simulate(const Settings *s, const World *w, Job *job, Err *err)
{
    Crew *crew;
    const long wanted = s->search.threads;
    TRY(crew_create(&crew, w->scene, job->n == 1 && !job->members ? 1 : wanted, err));
    Status status = STATUS_OK;
    if (!job->members)
        status = crew_run(crew, job->n, job->tasks, job->results, err);
    for (size_t i = 0; job->members && status == STATUS_OK && i < job->n; i++)
        status = ensemble_run(crew, scene_n_floors(w->scene), job->tasks[i].x, job->members, ENSEMBLE_CHANGE,
                              (uint32_t)s->search.seed, &job->ensembles[i], &job->results[i], err);
    crew_free(crew);
    for (size_t i = 0; status == STATUS_OK && i < job->n; i++)
        if (job->results[i].outcome != RUN_OK)
            fprintf(stderr, "design %zu failed: %s\n", i + 1, job->results[i].reason);
    return status;
}

static json_t *describe(const Job *job, size_t i, const Motion *m)
{
    json_t *o = json_object();
    json_object_set_new(o, "design", json_integer((json_int_t)i + 1));
    json_object_set_new(o, "record", json_string(m->name));
    json_object_update_new(o, json_result(job->kind, &job->results[i]));
    if (job->ensembles)
        json_object_set_new(o, "ensemble", json_ensemble(&job->ensembles[i]));
    return o;
}

static Status print_json(const Job *job, const Motion *m, Err *err)
{
    if (job->n == 1)
        return show_json(describe(job, 0, m), err);
    json_t *all = json_array();
    for (size_t i = 0; i < job->n; i++)
        json_array_append_new(all, describe(job, i, m));
    return show_json(all, err);
}

static Status write_csv(const Job *job, const char *path, Err *err)
{
    Output o;
    TRY(output_open(&o, path, err));
    fprintf(o.stream, "design");
    for (int k = 0; k < N_MEASURES; k++)
        fprintf(o.stream, ",%s", measure(k)->name);
    for (int k = 0; job->ensembles && k < N_MEASURES; k++)
        fprintf(o.stream, ",%s_mean,%s_sd", measure(k)->name, measure(k)->name);
    fprintf(o.stream, ",outcome\n");
    for (size_t i = 0; i < job->n; i++) {
        fprintf(o.stream, "%zu", i + 1);
        for (int k = 0; k < N_MEASURES; k++) {
            fputc(',', o.stream);
            print_number(o.stream, measure_value(&job->results[i], k));
        }
        for (int k = 0; job->ensembles && k < N_MEASURES; k++) {
            fputc(',', o.stream);
            print_number(o.stream, job->ensembles[i].mean[k]);
            fputc(',', o.stream);
            print_number(o.stream, job->ensembles[i].spread[k]);
        }
        fprintf(o.stream, ",%s\n", outcome_word(measure_outcome(job->results[i].outcome)));
    }
    return output_close(&o, err);
}

static void print_table(const Job *job, const World *w)
{
    char label[32];
    show_motion(&w->motion, w->options.sim.duration_s);
    putchar('\n');
    show_result_names(job->kind == SCENE_RIGID ? "rigidly connected" : "");
    for (size_t i = 0; i < job->n; i++) {
        snprintf(label, sizeof label, "design %zu", i + 1);
        show_result(job->kind == SCENE_NO_CORE ? "no core" : label, &job->results[i]);
        if (job->ensembles)
            show_ensemble(&job->ensembles[i]);
    }
}

static Status print(const Args *args, const Job *job, const World *w, Err *err)
{
    if (args_has(args, "--json") && args_has(args, "--csv") && strcmp(args_value(args, "--csv"), "-") == 0)
        return fail(err, STATUS_USAGE, "--json and --csv - both want standard output; give --csv a file");
    if (args_has(args, "--csv"))
        TRY(write_csv(job, args_value(args, "--csv"), err));
    if (args_has(args, "--json"))
        return print_json(job, &w->motion, err);
    if (!args_has(args, "--csv"))
        print_table(job, w);
    return STATUS_OK;
}

static Status run(const Args *args, Err *err)
{
    Settings s;
    World w;
    Job job = {0};
    TRY(choose_kind(args, &job, err));
    TRY(args_settings(args, &s, NULL, NULL, err));
    if (job.kind == SCENE_RIGID && s.sim.engine != ENGINE_FAST)
        return fail(err, STATUS_USAGE,
                    "--rigid: a linear building is solved in closed form, no other engine does it; leave sim.engine at "
                    "fast");
    TRY(world_open(&w, &s, err));
    Status status = lay_out_job(args, &job, scene_n_floors(w.scene), err);
    if (status == STATUS_OK)
        status = simulate(&s, &w, &job, err);
    if (status == STATUS_OK)
        status = print(args, &job, &w, err);
    free(job.tasks);
    free(job.results);
    free(job.ensembles);
    design_free(&job.designs);
    world_close(&w);
    return status;
}

static const ArgOption OPTIONS[] = {
    {"--design", "FILE", NULL, 0, "designs to simulate, one per row; none: the building alone"},
    {"--rigid", NULL, NULL, 0, "floors and core rigidly connected (zero gap): a linear building"},
    {"--ensemble", "N", NULL, 0, "N runs with gaps changed by 1e-8 of themselves: mean and spread of every result"},
    OPTION_RECORD,
    OPTION_PGA,
    OPTION_STRETCH,
    OPTION_UNIT,
    OPTION_DURATION,
    OPTION_ENGINE,
    OPTION_JSON,
    OPTION_CSV,
    OPTION_SET,
    OPTION_END,
};

const Command CMD_SIMULATE = {
    .name = "simulate",
    .operand = "CONFIG",
    .summary = "the response of given designs to one ground motion",
    .example = "imtet simulate configs/quick.ini --design none",
    .details =
        "Simulates every row of a design file: CSV with the header gap_01_m..gap_NN_m,t_base_m,t_top_m, one gap\n"
        "per floor from the bottom, then the core's wall in the first and in the last storey [m].\n"
        "--json gives one object for one design and a list of them for several.",
    .options = OPTIONS,
    .run = run,
};
