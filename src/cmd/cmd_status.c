#include <errno.h>

#include "base/json.h"
#include "base/text.h"
#include "cmd/commands.h"
#include "cmd/show.h"
#include "base/hypervolume.h"
#include "settings/settings.h"
#include "store/run_read.h"
#include "study/front_review.h"
#include "study/improvement.h"
#include "study/progress.h"

enum { ROWS_MAX = 12 };

/* -- one run ------------------------------------------------------------------------------------------------------- */

static json_t *json_generations(const Run *run)
{
    json_t *list = json_array();
    for (size_t i = 0; i < run->n_generations; i++) {
        const RunGeneration *g = &run->generation[i];
        json_array_append_new(list,
                              json_of("number=%ld simulated=%ld failed=%ld front=%ld hypervolume=%g "
                                      "hypervolume_error=%g surrogate_error=%g seconds=%g finished=%s",
                                      g->number, g->simulated, g->failed, g->front, g->hypervolume,
                                      hypervolume_error(g->hypervolume), g->surrogate_error, g->seconds, g->finished));
    }
    return list;
}

/* The first, the last, and some evenly between. */
static void say_generations(Document *d, const Run *run)
{
    static const char *const UNSHOWN[] = {"hypervolume_error", "surrogate_error", "finished"};
    const size_t n = run->n_generations, rows = MIN_OF(n, ROWS_MAX);
    json_t *all = json_generations(run), *table = document_table(d);
    for (size_t r = 0; r < rows; r++) {
        const size_t g = rows > 1 ? r * (n - 1) / (rows - 1) : 0;
        const double hypervolume = run->generation[g].hypervolume;
        json_t *row = json_array_get(all, g);
        figures_put(row, "hypervolume", hypervolume, hypervolume_error(hypervolume), NAN);
        for (size_t i = 0; i < N_OF(UNSHOWN); i++)
            json_object_del(row, UNSHOWN[i]);
        json_array_append(table, row);
    }
    json_decref(all);
    if (n > 0 && settings_screens(run->settings))
        document_say(d, "simulated: designs screened or finished; each counts as a part of an evaluation "
                        "(search.fidelity)");
}

static json_t *describe(const char *folder, const Run *run, const Standing *s)
{
    json_t *failures = json_object(); /* by outcome: how many, with the words of the first */
    for (size_t i = 0; i < run->table.n; i++) {
        const Evaluation *e = &run->table.row[i];
        const char *word = outcome_word(e->outcome);
        if (run->place[i].ok)
            continue;
        if (!json_object_get(failures, word))
            json_object_set_new(failures, word, json_of("count=%d first=%s", 0, e->reason));
        json_t *count = json_object_get(json_object_get(failures, word), "count");
        json_integer_set(count, json_integer_value(count) + 1);
    }
    json_t *o = json_of("run=%s state=%s simulated=%ld max_evals=%ld failed=%ld front=%ld polished=%ld repeats=%ld "
                        "hypervolume=%g simulations_per_second=%g seconds=%g seconds_left=%g failures=%p",
                        folder, state_words(s->state), s->progress.simulated, s->max_evals, s->n_failed, run->n_front,
                        s->n_polished, run->n_repeats, s->hypervolume, progress_rate(&s->progress), s->seconds,
                        s->left_s, failures);
    if (s->state == RUN_RUNNING)
        json_put(o, "process=%p", json_of("pid=%ld host=%s", s->holder.pid, s->holder.host));
    if (s->n_lost > 0)
        json_put(o, "lost=%ld", s->n_lost);
    const NamedCost named = named_cost(run);
    return named.n > 0 ? json_put(o, "named=%ld named_unpredictable=%ld named_time_share=%g", named.n,
                                  named.n_unpredictable, named.share)
                       : o;
}

/* -- the runs of a folder ------------------------------------------------------------------------------------------ */

/* A run that cannot be read says why, and the others follow. */
static void add_run(const char *folder, const char *, void *list)
{
    Run run;
    Standing s;
    Err err = {0};
    json_t *row = json_put(figures_row(list), "run=%s", folder);
    if (run_read(&run, folder, &err) != STATUS_OK) {
        json_put(row, "state=%s reason=%s", "unreadable", err.text);
        return;
    }
    standing_of(&s, folder, &run);
    json_put(row, "state=%s simulated=%ld max_evals=%ld failed=%ld front=%ld hypervolume=%g started=%s",
             state_words(s.state), s.progress.simulated, s.max_evals, s.n_failed, run.n_front, s.hypervolume,
             run.n_sessions > 0 ? run.session[run.n_sessions - 1].started : "-");
    run_free(&run);
}

/* In the table without hypervolumes: each is a share of a box of that run alone. */
static Status show_folder(const Args *args, const char *folder, Err *err)
{
    Document d = {.data = json_array()};
    json_t *row;
    size_t i;
    if (runs_each(folder, add_run, d.data) < 0) {
        const Status why = errno == ENOTDIR ? bad_data(err, "%s: is a file, not a run or a folder of runs", folder)
                                            : fail_missing(err, folder);
        document_free(&d);
        return why;
    }
    if (json_array_size(d.data) == 0)
        document_say(&d, "%s: no runs", folder);
    json_t *table = document_table(&d);
    json_array_foreach(d.data, i, row)
    {
        row = json_copy(row);
        json_put(row, "run=%s", basename(json_text(row, "run")));
        json_put(row, " =%s", json_string_value(json_object_get(row, "reason")));
        json_object_del(row, "hypervolume");
        json_object_del(row, "reason");
        json_array_append_new(table, row);
    }
    return document_give(&d, args, err);
}

/* -- one run ------------------------------------------------------------------------------------------------------- */

/* What the JSON says of the run, in lines. */
static void say_run(Document *d, const char *folder, const Run *run, const Standing *s, json_t *described)
{
    char quoted[4 * PATH_MAX + 3];
    const RunSession *last = run->n_sessions > 0 ? &run->session[run->n_sessions - 1] : NULL;
    const Effort e = last ? effort_of(run, run->n_sessions - 1) : (Effort){.waiting = NAN};
    char more[160] = "";
    if (s->state == RUN_RUNNING)
        snprintf(more, sizeof more, " (process %ld on %s)", s->holder.pid, s->holder.host);
    else if (last && last->stopped[0])
        snprintf(more, sizeof more, " (%s)", last->stopped);
    document_add(d, "h1", "%s: %s%s", folder, state_words(s->state), more);
    json_object_del(described, "run");
    json_object_del(described, "state");
    json_object_del(described, "process");
    document_list(d, described);
    if (s->n_lost > 0)
        document_say(d, "its file `lock` says that %zu more evaluations were stored: run.sqlite-wal is missing",
                     s->n_lost);
    *more = '\0';
    if (isfinite(e.busy))
        snprintf(more, sizeof more, "; threads %.1f %% busy", 100.0 * e.busy);
    if (isfinite(e.waiting))
        document_say(d, "wall time: %.1f %% waiting for simulations, %.1f %% surrogate, %.1f %% search%s",
                     100.0 * e.waiting, 100.0 * e.surrogate, 100.0 * e.search, more);
    if (s->state == RUN_PAUSED || s->state == RUN_INTERRUPTED)
        document_say(d, "resume it with: imtet optimize %s", text_shell(folder, quoted));
}

static Status run(const Args *args, Err *err)
{
    Run run;
    Standing standing;
    const char *folder = args->operand ? args->operand : "results";
    if (!run_is_there(folder))
        return show_folder(args, folder, err);
    TRY(run_read(&run, folder, err));
    standing_of(&standing, folder, &run);
    double expected = NAN;
    Status status = improvement_expected(&run, &expected, err);
    Document d = {.data = describe(folder, &run, &standing)};
    say_run(&d, folder, &run, &standing, json_copy(d.data));
    say_generations(&d, &run);
    if (args_has(args, "--json")) { /* what people read in tables, or wait for: designs of the front are simulated */
        FrontReview review = front_review(&run);
        Err why = {0};
        json_t *sessions = json_array(), *front = json_null();
        for (size_t i = 0; i < run.n_sessions; i++) {
            const RunSession *r = &run.session[i];
            const Effort e = effort_of(&run, i);
            json_array_append_new(
                sessions,
                json_of("started=%s ended=%s stopped=%s host=%s pid=%ld threads=%ld simulated_before=%ld seconds=%g "
                        "waiting_share=%g surrogate_share=%g search_share=%g busy_share=%g",
                        r->started, r->ended[0] ? r->ended : NULL, r->stopped[0] ? r->stopped : NULL, r->host, r->pid,
                        r->threads, r->simulated_before, r->seconds, e.waiting, e.surrogate, e.search, e.busy));
        }
        if (review.n_gaps > 0 && standing.state == RUN_FINISHED) /* a run under way has no time for it */
            front_review_of_run(&run, &review, &why);
        if (review.n_gaps > 0)
            front = json_review(&review);
        if (why.code != STATUS_OK)
            json_put(front, "never_closing=%p never_closing_unknown=%s", json_null(), why.text);
        json_put(d.data, "generations=%p sessions=%p front_review=%p expected_gain=%g", json_generations(&run),
                 sessions, front, expected);
    }
    THEN(status, document_give(&d, args, err));
    document_free(&d);
    run_free(&run);
    return status;
}

const Command CMD_STATUS = {
    .name = "status",
    .group = GROUP_STUDY,
    .operand = "[RUN]",
    .summary = "progress of a run, also of a running one; all runs of a folder",
    .example = "imtet status results/quick",
    .details =

        "Shows progress, pace, time left, the hypervolume by generation, and failed simulations by reason.\n"
        "The run is only read, so it may be running in another terminal.\n\n"
        "For a folder of runs (default: `results`) it prints one line per run: running, finished, stopped\n"
        "(can be resumed) or interrupted (was killed, can be resumed too).",
    .options =
        {
            OPTION_JSON,
        },
    .run = run,
    .only_reads = 1,
};
