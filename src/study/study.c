#include "study/study.h"

#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>

#include <omp.h>

#include "api/search_config.h"
#include "base/clock.h"
#include "base/hypervolume.h"
#include "base/json.h"
#include "evaluate/cluster.h"
#include "settings/settings.h"
#include "evaluate/adapter.h"
#include "store/provenance.h"
#include "store/run_read.h"
#include "study/differences.h"
#include "study/final_polish.h"
#include "study/initial_designs.h"
#include "study/job_limit.h"
#include "study/named.h"
#include "study/record_race.h"
#include "study/search_loop.h"
#include "study/study_model.h"

typedef struct {
    Settings used;
    const StudyOptions *options;
    Adapter *adapter;
    RunStore *store;
    json_t *model;         /* as it was chosen; NULL: it was not, or is stored */
    EvaluationTable first; /* of a new run: what was asked before it had columns */
    double *given;         /* (n_given, n_var) of search.start; NULL: not read, or none */
    size_t n_given;
    StudySummary *summary;
    FILE *differences;
    double start;              /* [s] of the clock */
    double max_s;              /* of this session */
    double seconds_before;     /* of earlier sessions */
    size_t evaluations_before; /* of search.max_evals */
    size_t generation;         /* that is under way */
    size_t first_generation;   /* of this session */
    double next_shown;         /* [s] of the clock, of the progress within it */
    atomic_int asked, late;    /* why it stopped: the signal, the time */
    long failures[2];          /* in a row up to now: of whole evaluations, of those of the cheap level alone */
    atomic_int failing;        /* search.failures_max of them; 2: of the cheap level */
    char failure[200];         /* why the last one failed */
    char lost[200];            /* what ended the session beside a request: a rank that died, say */
    pthread_mutex_t lock;      /* results come while a generation is written */
    int has_new_limits;
    Status status; /* of writing; ends the search */
    Err *err;
} Study;

static double session_seconds(const Study *study)
{
    return clock_seconds() - study->start;
}

/* -- while the search runs ---------------------------------------------------------------------------------------- */

static int may_go_on(void *user)
{
    Study *study = user;
    const StudyOptions *o = study->options;
    const int asked = o->stop ? o->stop(o->user) : 0;
    if (asked)
        study->asked = asked;
    else if (!study->failing && session_seconds(study) >= study->max_s)
        study->late = 1;
    return !asked && !study->failing && !study->late;
}

/* After `now` evaluations; view NULL: within the first generation of the session. */
static void show_progress(const Study *study, const SearchView *view, size_t now)
{
    const size_t before = study->evaluations_before;
    const StudyProgress p = {.view = view,
                             .hypervolume = store_hypervolume(study->store),
                             .progress = {.simulated = now,
                                          .session_simulated = now > before ? now - before : 0,
                                          .session_s = session_seconds(study),
                                          .all_s = study->seconds_before + session_seconds(study)},
                             .settings = &study->used};
    if (study->options->progress)
        study->options->progress(&p, study->options->user);
}

/* Counts an evaluation and stores it as of a generation that is not finished. */
static Status evaluation_done(const Evaluation *e, void *user, Err *err)
{
    static const double EVERY_S = 0.5;
    Study *study = user;
    const long most = study->used.search.failures_max;
    const int is_cheap = e->kind == KIND_SCREENED, has_failed = e->outcome != OUTCOME_OK;
    pthread_mutex_lock(&study->lock);
    long *in_a_row = &study->failures[is_cheap];
    *in_a_row = has_failed ? *in_a_row + 1 : 0;
    if (has_failed && !study->failing) {
        snprintf(study->failure, sizeof study->failure, "%s: %s", outcome_word(e->outcome), e->reason);
        if (most > 0 && *in_a_row >= most)
            study->failing = 1 + is_cheap;
    }
    study->summary->n_simulated++;
    study->summary->n_failed += has_failed;
    if (isfinite(e->seconds))
        study->summary->busy_s += e->seconds;
    Evaluation row = *e;
    row.generation = study->generation;
    row.kind = KIND_UNFINISHED;
    const Status status = store_evaluation(study->store, &row, err);

    /* Simulations may take minutes, and the first generation is the largest. */
    const double now = clock_seconds();
    if (study->generation <= study->first_generation && now >= study->next_shown) {
        study->next_shown = now + EVERY_S;
        show_progress(study, NULL, study->summary->n_simulated);
    }
    pthread_mutex_unlock(&study->lock);
    return status;
}

/* Stores the end of a generation, in log.jsonl with what it cost; 1: the search is to stop. */
static int observe(const SearchView *view, const SearchTime *t, void *user)
{
    Study *study = user;
    StudySummary *sum = study->summary;
    pthread_mutex_lock(&study->lock);
    const double session = session_seconds(study);
    const SessionTimes times = {study->seconds_before + session, session, t->all, t->waiting, t->choosing};
    study->status = store_generation(study->store, view, &times, study->err);
    const Archive *a = view->all;
    const double hypervolume = store_hypervolume(study->store);
    THEN(study->status,
         store_event(study->store,
                     json_of("event=%s number=%ld simulated=%ld repeats=%ld failed=%ld front=%ld outputs_left_out=%ld "
                             "surrogate_error=%g hypervolume=%g hypervolume_error=%g seconds=%g search_s=%g "
                             "waited_s=%g surrogate_s=%g",
                             "generation", view->generation, a->n, a->n_replicates, a->n_failed, a->n_front,
                             view->n_left_out, view->surrogate_error, hypervolume, hypervolume_error(hypervolume),
                             times.run, times.search, times.waiting, times.choosing),
                     study->err));
    study->generation = view->generation + 1;
    pthread_mutex_unlock(&study->lock);
    sum->n_front = view->all->n_front;
    sum->n_repeats = view->all->n_replicates;
    sum->n_screened = view->n_screened;
    sum->n_evaluations = view->n_evaluations;
    sum->level_agreement = view->level_agreement;
    sum->has_left_screening = view->has_left_screening;
    show_progress(study, view, view->n_evaluations);
    return study->status != STATUS_OK || !may_go_on(study);
}

/* -- beginning ----------------------------------------------------------------------------------------------------- */

static Status search_config(Study *study, SearchConfig *config, Err *err)
{
    const Run *run = store_run(study->store);
    *config = search_config_of(&study->used);
    config->max_seconds = 0.0; /* the study has a clock of its own, which it looks at more often */
    if (!study->given) {
        TRY(initial_designs_read("search.start", study->used.search.start, adapter_schema(study->adapter),
                                 &study->given, &study->n_given, err));
        if (!run || run->n_generations == 0) /* later nobody asks for them again */
            TRY(initial_designs_of_devices(adapter_problem(study->adapter), &study->used.design, &study->given,
                                           &study->n_given, err));
    }
    config->given = study->given;
    config->n_given = study->n_given;
    return STATUS_OK;
}

static void tell_start(const Study *study)
{
    const StudySummary *sum = study->summary;
    const Problem *p = adapter_problem(study->adapter);
    const SearchConfig config = search_config_of(&study->used);
    if (study->options->started)
        study->options->started(sum->folder, sum->n_before, p->n_workers, search_at_once(p, &config) * p->n_parts,
                                study->options->user);
}

static int has_first(const Study *study)
{
    const EvaluationTable *t = &study->first;
    return t->n > 0 && (t->row[t->n - 1].outcome == OUTCOME_OK || (long)t->n == study->used.search.failures_max);
}

static int waits_for_first(void *user)
{
    return !has_first(user) && may_go_on(user);
}

static Status take_first(const Evaluation *e, void *user, Err *err)
{
    return evaluation_table_append(&((Study *)user)->first, e, err);
}

static int end_first(const SearchView *, const SearchTime *, void *)
{
    return 1;
}

/* The search's own first designs, one after another until one succeeds: the run keeps them, and has as many constraint
 * values as that one; where the whole first sample fails, or search.failures_max in a row, none. */
static Status ask_first(Study *study, Err *err)
{
    const EvaluationTable *t = &study->first;
    Problem p = *adapter_problem(study->adapter);
    SearchConfig config;
    StopReason reason;
    long n = 0;
    if (study->used.problem.kind != PROBLEM_EXTERNAL)
        return STATUS_OK;
    study->first = evaluation_table(p.n_var, p.n_obj, p.n_extra);
    p.executor = NULL;
    p.n_workers = 1;
    p.observer = (Observer){waits_for_first, take_first, study};
    TRY(search_config(study, &config, err));
    const Status status = search_run(&p, &config, NULL, end_first, NULL, &reason, err);
    if (status == STATUS_STOPPED && !has_first(study)) {
        study->summary->stopped = study->late ? STOP_TIME : STOP_ASKED;
        return fail(err, status, "%s: stopped before its first design succeeded; nothing is stored",
                    study->summary->folder);
    }
    if (status != STATUS_STOPPED)
        TRY(status);
    while (t->n > 0 && n < CONSTRAINTS_MAX && isfinite(t->row[t->n - 1].extra[n]))
        n++;
    study->used.problem.constraints = n;
    return adapter_constrain(study->adapter, n, err);
}

/* A new run, which has the designs that were asked before it had columns. */
static Status begin(Study *study, Err *err)
{
    char *provenance;
    double f[OBJECTIVES_MAX], g[LIMITS_MAX + CONSTRAINTS_MAX];
    TRY(search_config(study, &(SearchConfig){0}, err)); /* a start that is refused leaves no run */
    tell_start(study);
    TRY(ask_first(study, err));
    TRY(provenance_text(&provenance, &study->used, study->adapter, json_incref(study->model), err));
    const Status status = store_begin(study->store, adapter_schema(study->adapter), &study->used, provenance, err);
    free(provenance);
    TRY(status);
    const Problem *p = adapter_problem(study->adapter);
    for (size_t i = 0; i < study->first.n; i++) {
        Evaluation *e = &study->first.row[i];
        problem_judge(p, e, f, g);
        e->violation = e->outcome == OUTCOME_OK ? violation_of(p->n_con, g) : INFINITY;
        TRY(evaluation_done(e, study, err));
    }
    return STATUS_OK;
}

/* n_later: evaluations behind those of finished generations, n_failed of them failed. */
static void sum_up(StudySummary *sum, const Run *run, size_t n_later, size_t n_failed)
{
    const RunGeneration *last = run->n_generations > 0 ? &run->generation[run->n_generations - 1] : NULL;
    sum->n_simulated = sum->n_before = run->n_finished + n_later;
    sum->n_failed = n_failed + (last ? last->failed : 0);
    sum->n_front = last ? last->front : 0;
    for (size_t i = 0; i < run->n_sessions; i++)
        sum->seconds += isfinite(run->session[i].seconds) ? run->session[i].seconds : 0.0;
}

static int came_to_its_end(const Run *run, StopReason *stopped)
{
    const RunSession *last = run->n_sessions > 0 ? &run->session[run->n_sessions - 1] : NULL;
    if (!last || !last->is_final)
        return 0;
    for (*stopped = STOP_EVALUATIONS; *stopped < STOP_ASKED; ++*stopped)
        if (strcmp(stop_reason_words(*stopped), last->stopped) == 0)
            break;
    return 1;
}

static Status resume(Study *study, Err *err)
{
    const Run *run = store_run(study->store);
    const EvaluationTable *later = store_unfinished(study->store);
    StudySummary *sum = study->summary;
    size_t n_failed = 0;
    for (size_t i = 0; i < later->n; i++)
        n_failed += later->row[i].outcome != OUTCOME_OK;
    sum_up(sum, run, later->n, n_failed);
    study->evaluations_before = sum->n_before;
    if (settings_screens(run->settings)) { /* designs are shares of an evaluation */
        Run all;
        TRY(store_read(study->store, RUN_WHOLE, &all, err));
        study->evaluations_before = run_evaluations(&all, 0);
        run_free(&all);
    }
    TRY(differences_check(
        &(Comparison){.run = run, .used = &study->used, .adapter = study->adapter, .lines = study->differences},
        study->evaluations_before, &study->has_new_limits, err));

    /* Before anything is written: a search of another version stays as it is. */
    StopReason unused;
    const int goes_on = study->has_new_limits || !came_to_its_end(run, &unused);
    if (goes_on && run->state_is_damaged)
        return fail(err, STATUS_IO,
                    "%s: the state of the search is damaged; its evaluations are whole. Begin anew from its front: "
                    "--new --set search.start=%s",
                    sum->folder, sum->folder);
    if (goes_on && run->state && !search_state_is_current(run->state, run->n_state))
        return bad_data(err,
                        "%s: another version of the program interrupted this search, and this one cannot resume it; "
                        "nothing was changed. Resume it with that version, or begin anew from its front: "
                        "--new --set search.start=%s",
                        sum->folder, sum->folder);
    study->used.problem.constraints = run->settings->problem.constraints;
    TRY(adapter_constrain(study->adapter, run->settings->problem.constraints, err));
    study->seconds_before = sum->seconds;
    study->generation = run->n_generations > 0 ? run->generation[run->n_generations - 1].number + 1 : 0;
    study->first_generation = study->generation;
    snprintf(study->used.run.out, OPTION_TEXT_MAX, "%s", run->settings->run.out);
    return store_resume(study->store, adapter_schema(study->adapter), &study->used, study->has_new_limits, err);
}

/* A run in which nothing was simulated is none. */
static Status open_store(Study *study, Err *err)
{
    if (!study->store)
        TRY(store_open(&study->store, study->used.run.out, study->options->fresh, err));
    return store_forget_empty(study->store, err);
}

/* Opens problem and run, which begins or is resumed. */
static Status prepare(Study *study, const Settings *s, Err *err)
{
    const double hours = s->search.max_hours;
    const StudyOptions *o = study->options;
    char *folder = study->summary->folder;
    study->used = *s;
    study->max_s = hours > 0.0 ? 3600.0 * hours : INFINITY;
    TRY(hours == OPTION_WORD ? job_seconds(&study->max_s, err) : STATUS_OK);

    /* 1. A new run chooses its model, where that is open, before there is a folder for it; one that is there has
     * chosen. */
    const int is_there = study->store || (!o->fresh && run_is_there(s->run.out));
    if (s->sim.model == MODEL_AUTO && is_there)
        TRY(open_store(study, err));
    const Status status = study_model(&study->used, study->store ? store_run(study->store) : NULL,
                                      &(Observer){.go_on = may_go_on, .user = study}, &study->model, err);
    if (status == STATUS_STOPPED)
        return fail(err, status, "%s: stopped before its model was chosen; nothing is stored", s->run.out);
    TRY(status);
    if (study->model && o->model)
        o->model(study->model, o->user);

    /* 2. The problem, then the run. */
    Settings open = study->used;
    open.problem.constraints = -1;
    TRY(adapter_open(&study->adapter, &open, err));
    TRY(open_store(study, err));
    snprintf(folder, sizeof study->summary->folder, "%s", store_folder(study->store));
    study->summary->max_evals = s->search.max_evals;
    settings_make_absolute(&study->used);
    snprintf(study->used.run.out, OPTION_TEXT_MAX, "%.*s", OPTION_TEXT_MAX - 1, folder);
    return store_run(study->store) ? resume(study, err) : begin(study, err);
}

/* -- the search, from where it stands ------------------------------------------------------------------------------ */

/* A stop is no error: the session ends as others do. One that nobody here asked for is a loss: of a rank, say. */
static Status note_stop(Study *study, Status status, const Err *err)
{
    if (status != STATUS_STOPPED)
        return status;
    study->summary->stopped = STOP_ASKED;
    if (!study->asked && !study->late && !study->failing)
        snprintf(study->lost, sizeof study->lost, "%.199s", err->text);
    return STATUS_OK;
}

/* The search takes up what the run has of it: the finished generations, then the evaluations of the one that was cut
 * short. */
static Status run_search(Study *study, Err *err)
{
    const Run *run = store_run(study->store);
    const EvaluationTable *later = run ? store_unfinished(study->store) : &study->first;
    SearchStart start = {.n_later = later->n, .row = later->row};
    SearchConfig config;
    TRY(search_config(study, &config, err));
    if (run) {
        start.n = run->n_finished;
        start.state = run->state;
        start.n_state = run->n_state;
        start.each = run->n_finished > 0 ? store_each_finished : NULL;
        start.user = study->store;
        config.planned_evals = run->planned_evals;
        config.initial = MIN_OF(study->used.search.initial, run->planned_evals);
    }
    TRY(record_race(study->adapter, &study->used, err));
    omp_set_num_threads(adapter_threads(study->adapter));
    adapter_observe(study->adapter, &(Observer){may_go_on, evaluation_done, study});
    const Status status =
        search_run(adapter_problem(study->adapter), &config, start.n + start.n_later > 0 ? &start : NULL, observe,
                   study, &study->summary->stopped, err);
    return note_stop(study, status, err);
}

static Status finish(Study *study, Err *err)
{
    StudySummary *sum = study->summary;
    const double session = session_seconds(study);
    const int is_final = sum->stopped != STOP_ASKED;
    if (!is_final)
        sum->stopped = study->failing ? STOP_FAILURES : study->late ? STOP_TIME : STOP_ASKED;
    size_t n_ranks;
    const char *why = *study->lost ? study->lost
                      : sum->stopped == STOP_ASKED && study->asked == SIGTERM && cluster_executor(&n_ranks)
                          ? "stopped by SIGTERM (mpirun: a rank has died, or it was asked to end)"
                          : stop_reason_words(sum->stopped);
    sum->seconds = study->seconds_before + session;
    TRY(store_event(study->store,
                    json_of("event=%s why=%s final=%c simulated=%zu failed=%zu seconds=%g", "stops",
                            stop_reason_words(sum->stopped), is_final, sum->n_simulated, sum->n_failed, sum->seconds),
                    err));
    RunStore *store = study->store;
    study->store = NULL;
    TRY(store_close(store, why, is_final, session, is_final ? study->options->run : NULL, err));
    if (is_final && study->options->run) /* which was formed again */
        sum->n_front = study->options->run->n_front;
    if (sum->stopped == STOP_FAILURES)
        return fail(
            err, STATUS_INTERNAL,
            "%.200s: the last %ld%s of %zu simulations failed (search.failures_max), the last one as %s; mend what "
            "is wrong, then the same command resumes the run",
            sum->folder, study->failures[study->failing - 1],
            study->used.search.fidelity == FIDELITY_OFF ? ""
            : study->failing == 1                       ? " whole evaluations"
                                                        : " cheap evaluations",
            sum->n_simulated, study->failure);
    return is_final ? STATUS_OK
                    : fail(err, STATUS_STOPPED, "%.200s: %s after %zu of %ld simulations", sum->folder, why,
                           sum->n_simulated, sum->max_evals);
}

int study_finished(RunStore *store, StudySummary *summary, Run *run)
{
    *summary = (StudySummary){0};
    if (!store_run(store) || !came_to_its_end(store_run(store), &summary->stopped))
        return 0;
    if (store_read(store, RUN_FRONT, run, &(Err){0}) != STATUS_OK)
        return 0;
    text_copy(summary->folder, store_folder(store));
    summary->max_evals = run->settings->search.max_evals;
    sum_up(summary, run, 0, 0);
    return 1;
}

/* -- all of it ----------------------------------------------------------------------------------------------------- */

/* The search, then the designs of its front polished and those named known. */
static Status work(Study *study, Err *err)
{
    static const double SIMULATIONS = 150.0, MOMENT_S = 5.0; /* some ten for each of fifteen designs */
    const StudyOptions *o = study->options;
    const Problem *p = adapter_problem(study->adapter);
    const Tower *t = adapter_tower(study->adapter);
    StudySummary *sum = study->summary;
    size_t n_ranks;
    char program[96];
    if (store_run(study->store)) /* else it has been told before the first designs were asked */
        tell_start(study);
    for (size_t i = 0; o->record && t && i < tower_n_records(t); i++)
        o->record(tower_record(t, i), o->user);
    const int threads = adapter_threads(study->adapter);
    snprintf(program, sizeof program, "imtet %s (%s)", program_version(), program_revision());
    TRY(store_session(study->store, program, threads, sum->n_before, err));
    TRY(store_event(study->store,
                    json_of("event=%s program=%s threads=%d simulated=%zu max_evals=%ld",
                            sum->n_before ? "resumes" : "starts", program, threads, sum->n_before,
                            study->used.search.max_evals),
                    err));
    TRY(run_search(study, err));
    TRY(study->status);
    if (sum->stopped == STOP_ASKED) { /* who asked for the end waits for the named ones a moment, and no longer */
        const double each = sum->busy_s / (double)(sum->n_simulated - sum->n_before);
        if (!study->failing && !cluster_executor(&n_ranks) && each * SIMULATIONS <= MOMENT_S * threads)
            TRY(named_simulate(study->store, &study->used, p, NULL, NULL, err));
        return finish(study, err);
    }
    const FinalPolish polish = {
        .used = &study->used, .n_simulated = sum->n_simulated, .go_on = may_go_on, .user = study};
    TRY(note_stop(study, final_polish(study->store, &polish, &sum->polish, err), err));
    if (sum->stopped != STOP_ASKED)
        TRY(note_stop(study, named_simulate(study->store, &study->used, p, may_go_on, study, err), err));
    if (sum->stopped != STOP_ASKED)
        TRY(note_stop(study, study_model_confirm(study->store, &(Observer){.go_on = may_go_on, .user = study}, err),
                      err));
    return finish(study, err);
}

Status study_run(const Settings *s, const StudyOptions *options, StudySummary *summary, FILE *differences, Err *err)
{
    memset(summary, 0, sizeof *summary);
    Study study = {
        .options = options, .store = options->store, .summary = summary, .differences = differences, .err = err};
    pthread_mutex_init(&study.lock, NULL);
    study.start = clock_seconds();
    Run unwanted = {0}, *finished = options->run ? options->run : &unwanted;
    Status status = prepare(&study, s, err);
    if (status == STATUS_OK) { /* of a run that has reached its limits before front.csv may have been removed */
        const Run *run = store_run(study.store);
        const int is_over = run && !study.has_new_limits && came_to_its_end(run, &summary->stopped);
        status = is_over ? store_write_front(study.store, finished, err) : work(&study, err);
    }

    /* What the knee is compared with, and what the front says about its gaps. */
    if (status == STATUS_OK && options->run && finished->n_front > 0 && adapter_tower(study.adapter)) {
        const Problem *p = adapter_problem(study.adapter);
        summary->has_baselines = 1;
        status = front_review_closings(p, finished, &summary->review, err);
        THEN(status, baselines_find(p, run_x(finished, run_knee(finished)), 1, summary->baseline, err));
    }
    run_free(&unwanted);
    if (status != STATUS_OK && study.store) {
        Err ignored; /* the fault itself is what is returned */
        store_flush(study.store, &ignored);
        store_event(study.store, json_of("event=%s why=%s", "fails", err->text), &ignored);
    }
    store_free(study.store);
    adapter_close(study.adapter);
    json_decref(study.model);
    evaluation_table_free(&study.first);
    free(study.given);
    pthread_mutex_destroy(&study.lock);
    return status;
}
