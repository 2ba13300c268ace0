#include <errno.h>
#include <unistd.h>

#include "base/text.h"
#include "cmd/commands.h"
#include "cmd/designs.h"
#include "cmd/improve.h"
#include "cmd/show.h"
#include "cmd/show_model.h"
#include "cmd/signals.h"
#include "report/words.h"
#include "settings/settings.h"
#include "store/export.h"
#include "store/run_read.h"
#include "study/output_place.h"
#include "study/study.h"
#include "study/study_model.h"

typedef struct {
    int terminal, has_line, has_warned;
    double told_s; /* of this session, where no terminal is */
} Telling;

static const double TELL_EVERY_S = 60;

/* One line that changes on a terminal, else a further one every minute. */
static void tell(const StudyProgress *p, void *user)
{
    Telling *t = user;
    const SearchView *v = p->view;
    char left[32], line[160], front[80] = "";
    if (!t->terminal && p->progress.session_s < t->told_s + TELL_EVERY_S)
        return;
    t->told_s = p->progress.session_s;
    duration_words(progress_left(&p->progress, &p->settings->search), left);
    if (v)
        snprintf(front, sizeof front, ", %zu failed, %zu on the front", v->all->n_failed, v->all->n_front);
    snprintf(line, sizeof line, "%zu of %ld simulated, %s left%s", p->progress.simulated, p->settings->search.max_evals,
             left, front);
    if (t->terminal)
        /* A line that fills the last column would wrap; the rest of the line before is erased. */
        fprintf(stderr, "\r%.*s\033[K", terminal_width(STDERR_FILENO) - 1, line);
    else
        fprintf(stderr, "%s\n", line);
    t->has_line = t->terminal;
}

static void tell_start(const char *folder, size_t n_simulated, size_t n_workers, size_t n_busy, void *)
{
    if (n_workers > n_busy)
        fprintf(stderr, "%zu workers, but at most %zu designs are under way at once: raise search.ahead\n", n_workers,
                n_busy);
    if (n_simulated > 0)
        fprintf(stderr, "%s: resumed after %zu simulations\n", folder, n_simulated);
}

static void tell_model(const json_t *chosen, void *)
{
    Document d = {0};
    document_model(&d, chosen);
    document_print(&d, stderr, 0);
}

static void tell_record(const Scenario *w, void *user)
{
    Telling *t = user;
    if (!t->has_warned)
        building_warnings(scene_building(w->scene), warn_on_stderr, NULL);
    t->has_warned = 1;
    Document d = {0};
    document_motion(&d, &w->motion, w->options.sim.duration_s);
    document_print(&d, stderr, 0);
}

/* The best designs beside the baselines, and what the objectives are. */
static void say_front(Document *d, const Run *run, const StudySummary *summary)
{
    const Schema *schema = &run->schema;
    const char *missing = measures_missing(&schema->order, run->settings->search.objectives, schema->design.n_floors);
    char label[TABLE_NAME_MAX + 8], rule[RULE_WORDS_MAX];
    json_t *meaning = json_object();
    words_of_rule(run->settings, rule);
    if (rule[0])
        document_say(d, "each number: %s", rule);
    json_t *table = document_table(d);
    for (size_t k = 0; k < schema->n_obj; k++) {
        const Column *c = schema_objective(schema, k);
        snprintf(label, sizeof label, "best %s", c->name);
        figures_of_run(table, run, label, run_best(run, k));
        if (summary->has_baselines)
            json_object_set_new(meaning, c->name,
                                json_sprintf("%s [%s], %s is better", measure(schema->order.of[k])->what,
                                             measure(schema->order.of[k])->unit, c->sense > 0 ? "lower" : "higher"));
    }
    figures_of_run(table, run, "knee", run_knee(run));
    if (summary->has_baselines) {
        figures_baselines(table, schema, summary->baseline);
        if (run->settings->sim.replicates > 1)
            document_say(d, "replicates exist for designs with impacts only; the other lines are as designed");
    }
    document_list(d, meaning);
    if (summary->has_baselines && missing)
        document_say(d, "%s", missing);
    document_say(d, "knee: nearest to the ideal point when every objective is scaled to 0..1 over the front.");
}

/* Once, of the first constraint of an external problem whose values end at 0: what they leave out. */
static void say_clipped(Document *d, const Run *run)
{
    size_t c = 0;
    while (c < run->schema.n_extra && !(run->extra_min[c] == 0 && run->extra_max[c] > 0))
        c++;
    if (run->schema.order.n == 0 && c < run->schema.n_extra)
        document_say(d,
                     "%s is never below 0: the search learns more from values that also say how far a limit is, "
                     "stress / allowed - 1 and not max(0, ...)",
                     schema_extra(&run->schema, c)->name);
}

static void say_run(Document *d, const Run *run, const StudySummary *sum)
{
    const NamedCost named = named_cost(run);
    char polished[160], folder[4 * PATH_MAX + 3];
    size_t n_failed, most;
    document_say(d, "front: %s/front.csv", sum->folder);
    document_say(d, "%zu nondominated of %zu simulated designs, %zu simulations failed, %.1f s (%s)", run->n_front,
                 sum->n_simulated, sum->n_failed, sum->seconds, stop_reason_words(sum->stopped));
    const char *reason = evaluation_table_failures(&run->table, &n_failed, &most);
    if (n_failed > 0)
        document_say(d,
                     2 * n_failed > sum->n_simulated ? "warning: most simulations failed; %zu of %zu failures: %s"
                                                     : "%zu of %zu failures: %s",
                     most, n_failed, reason);
    if (run->n_repeats > 0)
        document_say(d, "%zu of the simulations repeat a design, to average the noise (search.replicate_share)",
                     run->n_repeats);
    say_clipped(d, run);

    /* Of screened designs: how many, what they cost, and how far the cheap level agrees. */
    if (sum->n_screened > 0)
        document_say(d,
                     "%zu designs were screened by a part of their simulations (search.fidelity), %zu were finished or "
                     "simulated whole; together this is %zu of %ld evaluations",
                     sum->n_screened, sum->n_simulated - sum->n_screened, sum->n_evaluations, sum->max_evals);
    if (sum->n_screened > 0 && isnan(sum->level_agreement))
        document_say(d, "too few designs were finished to know how well their first part ranks them");
    else if (sum->n_screened > 0)
        document_say(d, "rank correlation of screened with full results (Kendall's tau): %.2f%s", sum->level_agreement,
                     sum->has_left_screening ? ": too low, so that screening ended" : "");
    say_front(d, run, sum);
    if (named.n > 0)
        document_say(d, "refined with smaller steps: %zu designs, %zu of them unpredictable", named.n,
                     named.n_unpredictable);
    snprintf(polished, sizeof polished,
             "polished: %zu of %zu designs improved by more than their spread (search.polish); ", sum->polish.n_better,
             sum->polish.n_tried);
    if (sum->polish.n_tried > 0)
        improve_cost(d, polished, &sum->polish.cost);
    json_t *model = study_model_of(run);
    document_model_confirmed(d, model, sum->folder);
    json_decref(model);
    if (sum->n_simulated == sum->n_before)
        document_say(d, "This run was finished before; nothing new was simulated. --new starts another one.");
    document_say(d, "charts and tables:  %s report %s", program_invocation_name, text_shell(sum->folder, folder));
}

static json_t *json_of_design(const Run *run, size_t row)
{
    json_t *o = json_of("design=%ld", run->table.row[row].id);
    for (size_t k = 0; k < run->schema.n_obj; k++)
        json_object_set_new(o, schema_objective(&run->schema, k)->name, json_number(run_f(run, row)[k]));
    return o;
}

static json_t *json_of_run(const Run *run, const StudySummary *summary)
{
    json_t *best = json_object(), *baselines = json_object();
    const Schema *schema = &run->schema;
    for (size_t k = 0; k < schema->n_obj; k++)
        json_object_set_new(best, schema_objective(schema, k)->name, json_of_design(run, run_best(run, k)));
    for (int b = SCENE_IMPACT + 1; b < N_SCENES && summary->has_baselines; b++) {
        json_t *o = json_object();
        for (size_t k = 0; k < schema->n_obj; k++)
            json_object_set_new(o, schema_objective(schema, k)->name,
                                json_number(summary->baseline[b].value[schema->order.of[k]]));
        json_object_set_new(baselines, SCENES[b].key, o);
    }
    return json_of("run=%s stopped=%s simulated=%zu failed=%zu front=%zu seconds=%g knee=%p best=%p baselines=%p "
                   "review=%p model=%p",
                   summary->folder, stop_reason_words(summary->stopped), summary->n_simulated, summary->n_failed,
                   run->n_front, summary->seconds, json_of_design(run, run_knee(run)), best, baselines,
                   json_review(&summary->review), study_model_of(run));
}

static Status show(const Args *args, const Run *run, const StudySummary *sum, Err *err)
{
    const int as_json = args_has(args, "--json");
    Document d = {0};
    size_t rows[NEAREST_MAX];
    if (sum->n_front > 0) {
        TRY(export_inside(run, EXPORT_NEAREST, 0, NULL, err));
        d.data = json_of_run(run, sum);
        say_run(&d, run, sum);
        if (!as_json)
            document_verdict(&d, run, run_knee(run), NULL);
        return document_give(&d, args, err);
    }

    /* Nothing succeeded, or nothing keeps search.limits: then the designs that come nearest. */
    const size_t n = as_json ? 0 : run_nearest(run, rows);
    if (!as_json)
        TRY(export_inside(run, EXPORT_NEAREST, n, rows, err));
    if (n == 0 || !run_has_limits(run))
        return run_why_empty(run, err);
    document_say(&d, "nearest: %s/nearest.csv", sum->folder);
    document_say(&d, "%zu simulated designs, %zu simulations failed, %.1f s (%s)", sum->n_simulated, sum->n_failed,
                 sum->seconds, stop_reason_words(sum->stopped));
    json_t *table = document_table(&d);
    for (size_t i = 0; i < n; i++) {
        const Evaluation *e = &run->table.row[rows[i]];
        char label[48];
        snprintf(label, sizeof label, "misses by %.3g", e->violation);
        figures_design(table, label, e->id, &run->schema, run_f(run, rows[i]), NULL, e->sd, e->extra);
    }
    document_say(&d, "misses by: sum of the relative violations of search.limits and of g > 0.");
    say_clipped(&d, run);
    document_print(&d, stdout, 0);
    return run_why_empty(run, err);
}

/* The operand is a settings file, or the folder of a run, which is resumed with its own settings, there or, with --new
 * and --out, in another folder. */
static Status take_settings(const Args *args, Settings *s, RunStore **store, Err *err)
{
    const int has_out = args_gives(args, "run.out");
    if (!run_is_there(args->operand)) {
        TRY(args_settings(args, s, NULL, NULL, err));
        return has_out ? STATUS_OK : output_place_check(s->run.out, args->operand, err);
    }
    if (args_has(args, "--new") || has_out) {
        Run run;
        TRY(run_read(&run, args->operand, err));
        *s = *run.settings;
        run_free(&run);
    } else {
        TRY(store_open(store, args->operand, 0, err));
        *s = *store_run(*store)->settings;
    }
    TRY(option_put_path(s->run.out, args->operand, err));
    TRY(args_apply(args, s, NULL, NULL, err));
    TRY(settings_check(s, err));
    return record_paths_check(s, NULL, err);
}

static Status optimize(const Args *args, Run *finished, Err *err)
{
    Settings s;
    char folder[4 * PATH_MAX + 3];
    StudySummary summary;
    const char *terminal = getenv("TERM");
    Telling telling = {.terminal = isatty(STDERR_FILENO) && terminal && strcmp(terminal, "dumb") != 0};
    StudyOptions options = {.fresh = args_has(args, "--new"),
                            .stop = signals_asked,
                            .started = tell_start,
                            .model = tell_model,
                            .record = tell_record,
                            .progress = tell,
                            .user = &telling,
                            .run = finished};
    Status status = take_settings(args, &s, &options.store, err);
    if (status != STATUS_OK) { /* once a run is finished records that have gone are not needed */
        if (status == STATUS_MISSING && options.store && args->n_given == 0 &&
            study_finished(options.store, &summary, finished)) {
            fprintf(stderr, "%s\n", err->text);
            status = show(args, finished, &summary, err);
        }
        store_free(options.store);
        return status;
    }
    warn_of_settings(&s, warn_on_stderr, NULL);
    signals_catch();
    status = study_run(&s, &options, &summary, stderr, err);
    if (telling.has_line)
        fputc('\n', stderr);
    if (status == STATUS_STOPPED && summary.n_simulated > 0)
        fprintf(stderr, "Resume it with:  %s optimize %s\n", program_invocation_name,
                text_shell(summary.folder, folder));
    TRY(status);
    return show(args, finished, &summary, err);
}

static Status run(const Args *args, Err *err)
{
    Run finished = {0};
    const Status status = optimize(args, &finished, err);
    run_free(&finished);
    return status;
}

const Command CMD_OPTIMIZE = {
    .name = "optimize",
    .group = GROUP_STUDY,
    .operand = "CONFIG|RUN",
    .summary = "search for the Pareto front of designs",
    .example = "imtet optimize configs/quick.ini",
    .details =

        "Searches gaps and core thicknesses for the nondominated designs in search.objectives and writes them\n"
        "to DIR/front.csv (results/README.md explains every file and column). If DIR already holds a run with\n"
        "the same settings, that run is resumed; the result is the same as if it had never stopped. `imtet\n"
        "optimize RUN` resumes a run with its own settings.\n\n"
        "Ctrl-C, SIGTERM and --max-hours store everything and end with status 75. A second signal, at least\n"
        "0.2 s later, ends at once; it discards running simulations and at most 0.2 s of finished ones.\n"
        "With problem.kind = external your own program is the simulator (docs/external.md).",
    .options =
        {
            OPTIONS_MOTION,
            SETTING("--out", "DIR", "run.out", "folder of the run; a run that it holds is resumed"),
            SWITCH("--new", "begin a new run in any case: if the folder holds one, add a number to its name"),
            SETTING("--threads", "N", "search.threads", "number of threads; 0: one per processor"),
            SETTING("--max-evals", "N", "search.max_evals", "stop after N simulations"),
            SETTING("--max-hours", "H", "search.max_hours",
                    "stop after H hours, to be resumed later; auto: before the Slurm job ends"),
            OPTION_JSON,
            OPTION_SET,
        },
    .run = run,
};
