#include "study/study.h"

#include <inttypes.h>
#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include <omp.h>

#include "base/clock.h"
#include "base/json.h"
#include "moga/hypervolume.h"
#include "study/advance.h"
#include "study/given.h"
#include "store/provenance.h"
#include "polish/refine.h"
#include "store/store.h"
#include "simulator/adapter.h"
#include "settings/settings.h"

typedef struct {
    Settings used;
    const StudyOptions *options;
    Adapter *adapter;
    RunStore *store;
    StudySummary *summary;
    FILE *differences;
    double start;            /* [s] of the clock */
    double seconds_before;   /* of earlier sessions */
    size_t generation;       /* that is under way */
    size_t first_generation; /* of this session */
    int asked, late;         /* why it stopped */
    pthread_mutex_t lock;    /* of an asynchronous search: results come while a generation is written */
    int has_new_limits;
    Status status; /* of writing; ends the search */
    Err *err;
} Study;

static double session_seconds(const Study *study)
{
    return clock_seconds() - study->start;
}

/* -- settings ------------------------------------------------------------------------------------------------------ */

static Settings settings_as_used(const Settings *s, const char *folder)
{
    Settings used = *s;
    settings_make_absolute(&used);
    snprintf(used.run.out, sizeof used.run.out, "%.*s", OPTION_TEXT_MAX - 1, folder);
    return used;
}

typedef struct {
    FILE *lines;
    size_t n_limits, n_others;
    char first[200]; /* of the others, else of the limits */
} Differences;

static void add_difference(Differences *d, const char *key, int is_limit, const char *was, const char *is)
{
    if (d->n_others == 0 && (!is_limit || d->n_limits == 0))
        snprintf(d->first, sizeof d->first, "%s is %.60s there, now %.60s", key, was, is);
    d->n_limits += is_limit;
    d->n_others += !is_limit;
    if (d->lines)
        fprintf(d->lines, "%s: %s in the run, now %s%s\n", key, was, is, is_limit ? " (a limit)" : "");
}

static void compare_one(const char *key, unsigned flags, const char *was, const char *is, void *user)
{
    if (!(flags & SETTING_FREE))
        add_difference(user, key, (flags & SETTING_LIMIT) != 0, was, is);
}

static uint64_t stored_hash(const json_t *provenance, const char *key)
{
    const char *text = json_string_value(json_object_get(json_object_get(provenance, "inputs"), key));
    return text ? strtoull(text, NULL, 16) : 0;
}

static void compare_hash(Differences *d, const char *key, uint64_t was, uint64_t is)
{
    char before[40], after[40];
    snprintf(before, sizeof before, "content %016" PRIx64, was);
    snprintf(after, sizeof after, "content %016" PRIx64, is);
    if (was != is)
        add_difference(d, key, 0, before, after);
}

static Status compare_inputs(Study *study, Differences *d, Err *err)
{
    Inputs now;
    TRY(provenance_inputs(&now, study->adapter, err));
    json_t *provenance = json_loads(store_run(study->store)->provenance, 0, NULL);
    compare_hash(d, "motion.record", stored_hash(provenance, "record_fnv1a"), now.record);
    if (now.record == stored_hash(provenance, "record_fnv1a"))
        compare_hash(d, "motion.records", stored_hash(provenance, "records_fnv1a"), now.records);
    compare_hash(d, "building.model", stored_hash(provenance, "matrices_fnv1a"), now.matrices);
    json_decref(provenance);
    return STATUS_OK;
}

/* A limit below what is there already would leave a run that is neither finished nor can go on. */
static Status check_limit(const Study *study, size_t n_there, Err *err)
{
    const long was = store_run(study->store)->settings->search.max_evals, now = study->used.search.max_evals;
    return now == was || now >= (long)n_there
               ? STATUS_OK
               : fail(err, STATUS_BAD_DATA, "%s: search.max_evals = %ld is less than the %zu simulations that it holds",
                      study->summary->folder, now, n_there);
}

/* The run goes on with its own settings; limits are taken over where that is wanted. */
static Status settle_settings(Study *study, Err *err)
{
    const char *folder = study->summary->folder;
    Differences d = {.lines = study->differences};
    settings_compare(store_run(study->store)->settings, &study->used, compare_one, &d);
    TRY(compare_inputs(study, &d, err));
    const size_t n = d.n_limits + d.n_others;
    study->has_new_limits = d.n_limits > 0;
    if (n == 0 || (d.n_others == 0 && study->options->force))
        return STATUS_OK;
    return fail(err, STATUS_BAD_DATA, "%s: holds a run with other settings: %s%s; %s", folder, d.first,
                n > 1 ? ", and more" : "",
                d.n_others == 0 ? "--force-settings changes limits" : "choose another --out, or --new");
}

/* -- what the search is told and tells ----------------------------------------------------------------------------- */

static int may_go_on(void *user)
{
    Study *study = user;
    const StudyOptions *o = study->options;
    const double hours = study->used.search.max_hours;
    if (o->stop && o->stop(o->user)) {
#pragma omp atomic write
        study->asked = 1;
        return 0;
    }
    if (hours > 0.0 && session_seconds(study) >= 3600.0 * hours) {
#pragma omp atomic write
        study->late = 1;
        return 0;
    }
    return 1;
}

static Status evaluation_done(const Evaluation *e, void *user, Err *err)
{
    Study *study = user;
    pthread_mutex_lock(&study->lock);
    study->summary->n_simulated++;
    study->summary->n_failed += e->outcome != OUTCOME_OK;
    if (isfinite(e->seconds))
        study->summary->busy_s += e->seconds;
    Evaluation row = *e; /* of a generation that is not finished */
    row.generation = (long)study->generation;
    row.kind = KIND_UNFINISHED;
    const Status status = store_evaluation(study->store, &row, err);
    pthread_mutex_unlock(&study->lock);
    return status;
}

static json_t *generation_event(const SearchView *v, double hypervolume, double igd, double seconds)
{
    return json_pack("{s:s, s:I, s:I, s:I, s:I, s:I, s:o, s:o, s:o, s:o, s:f, s:f, s:f, s:f}", "event", "generation",
                     "number", (json_int_t)v->generation_now, "simulated", (json_int_t)v->n, "repeats",
                     (json_int_t)v->n_replicates, "failed", (json_int_t)v->n_failed, "front", (json_int_t)v->n_front,
                     "surrogate_error", json_number(v->surrogate_error), "hypervolume", json_number(hypervolume),
                     "hypervolume_error", json_number(hypervolume_error(hypervolume)), "igd_plus", json_number(igd),
                     "seconds", seconds, "search_s", v->seconds, "waited_s", v->waited_s, "surrogate_s",
                     v->surrogate_s);
}

static Status write_generation(Study *study, const SearchView *view, Err *err)
{
    const double session = session_seconds(study), seconds = study->seconds_before + session;
    TRY(store_generation(study->store, view, seconds, session, err));
    const double hypervolume = store_hypervolume(study->store);
    double igd;
    TRY(advance_lately(view, &igd, err));
    TRY(store_event(study->store, generation_event(view, hypervolume, igd, seconds), err));
    char advance[32];
    number_words(igd, 4, advance);
    char surface[24] = "-", repeats[40] = "";
    if (view->n_replicates > 0)
        snprintf(repeats, sizeof repeats, " (%zu repeats)", view->n_replicates);
    if (isfinite(view->surrogate_error))
        snprintf(surface, sizeof surface, "%.3g", view->surrogate_error);
    return store_log(
        study->store, err,
        "generation %zu: %zu simulated%s, %zu failed, front %zu, hypervolume %.4f (standard error %.4f), IGD+ since "
        "nine tenths %s, predictions kept %zu, surrogate error %s, %.1f s",
        view->generation_now, view->n, repeats, view->n_failed, view->n_front, hypervolume,
        hypervolume_error(hypervolume), advance, view->n_predicted, surface, seconds);
}

static int observe(const SearchView *view, void *user)
{
    Study *study = user;
    StudySummary *sum = study->summary;
    pthread_mutex_lock(&study->lock);
    study->status = write_generation(study, view, study->err);
    study->generation = view->generation_now + 1;
    if (!view->is_asynchronous) {
        sum->n_simulated = view->n;
        sum->n_failed = view->n_failed;
    }
    pthread_mutex_unlock(&study->lock);
    sum->n_front = view->n_front;
    sum->n_repeats = view->n_replicates;
    sum->simulation_s = view->simulation_s;
    sum->own_s = view->own_s;
    sum->search_s = view->seconds;
    sum->waited_s = view->waited_s;
    sum->surrogate_s = view->surrogate_s;
    sum->is_aside = view->is_aside;
    const StudyProgress p = {view, store_hypervolume(study->store),
                             (Pace){.simulated = view->n,
                                    .generations = study->generation,
                                    .session_simulated = view->n > sum->n_before ? view->n - sum->n_before : 0,
                                    .session_generations = study->generation - study->first_generation,
                                    .session_s = session_seconds(study),
                                    .all_s = study->seconds_before + session_seconds(study)},
                             &study->used};
    if (study->options->progress)
        study->options->progress(&p, study->options->user);
    return study->status != STATUS_OK || !may_go_on(study);
}

/* -- beginning ----------------------------------------------------------------------------------------------------- */

static Status simulate_without_core(Study *study, Err *err)
{
    const SimTask task = {SCENE_NO_CORE, NULL};
    study->summary->has_no_core = adapter_tower(study->adapter) != NULL;
    return study->summary->has_no_core
               ? tower_simulate(adapter_problem(study->adapter), 1, &task, &study->summary->no_core, err)
               : STATUS_OK;
}

static Status log_start(Study *study, Err *err)
{
    const Schema *schema = adapter_schema(study->adapter);
    const Settings *used = &study->used;
    const int threads = adapter_threads(study->adapter);
    const size_t n = study->summary->n_before;
    char program[96];
    if (study->options->started)
        study->options->started(study->summary->folder, n, study->options->user);
    snprintf(program, sizeof program, "imtet %s (%s)", program_version(), program_revision());
    TRY(store_session(study->store, program, threads, n, err));
    TRY(store_event(study->store,
                    json_pack("{s:s, s:s, s:i, s:I, s:I}", "event", n ? "goes on" : "starts", "program", program,
                              "threads", threads, "simulated", (json_int_t)n, "max_evals",
                              (json_int_t)used->search.max_evals),
                    err));
    if (n > 0)
        TRY(store_log(study->store, err, "goes on after %zu simulations", n));
    if (adapter_tower(study->adapter))
        return store_log(study->store, err, "%s: %zu floors, %s, pga %g g, stretch %g, %d threads, seed %ld", program,
                         schema->n_var - 2, used->motion.record, used->motion.pga_g, used->motion.stretch, threads,
                         used->search.seed);
    return store_log(study->store, err, "%s: %zu variables, %zu objectives, %d threads, seed %ld", program,
                     schema->n_var, schema->n_obj, threads, used->search.seed);
}

static Status begin(Study *study, Err *err)
{
    char *provenance;
    TRY(provenance_text(&provenance, &study->used, study->adapter, err));
    const Status status = store_begin(study->store, adapter_schema(study->adapter), &study->used, provenance, err);
    free(provenance);
    return status;
}

static void sum_up(StudySummary *sum, const Run *h)
{
    for (size_t i = 0; i < h->table.n; i++)
        if (h->table.row[i].id < POLISHED_FIRST) {
            sum->n_before++;
            sum->n_failed += !h->place[i].ok;
        }
    sum->n_simulated = sum->n_before;
    sum->n_front = h->n_front;
    sum->n_repeats = h->n_repeats;
    for (size_t i = 0; i < h->n_sessions; i++)
        sum->seconds += isfinite(h->session[i].seconds) ? h->session[i].seconds : 0.0;
}

static Status go_on(Study *study, Err *err)
{
    const Run *h = store_run(study->store);
    StudySummary *sum = study->summary;
    TRY(settle_settings(study, err));
    sum_up(sum, h);
    study->seconds_before = sum->seconds;
    study->generation = h->n_generations > 0 ? (size_t)h->generation[h->n_generations - 1].number + 1 : 0;
    study->first_generation = study->generation;
    TRY(check_limit(study, sum->n_before, err));
    snprintf(study->used.run.out, OPTION_TEXT_MAX, "%s", h->settings->run.out);
    return store_resume(study->store, adapter_schema(study->adapter), &study->used, err);
}

static Status prepare(Study *study, const Settings *s, Err *err)
{
    TRY(adapter_open(&study->adapter, s, err));
    if (!study->store)
        TRY(store_open(&study->store, s->run.out, study->options->fresh, err));
    TRY(store_forget_empty(study->store, err));
    snprintf(study->summary->folder, sizeof study->summary->folder, "%s", store_folder(study->store));
    study->summary->max_evals = s->search.max_evals;
    study->used = settings_as_used(s, study->summary->folder);
    TRY(store_run(study->store) ? go_on(study, err) : begin(study, err));
    return simulate_without_core(study, err);
}

SearchConfig study_search_config(const Settings *s)
{
    const long initial = s->search.initial < s->search.max_evals ? s->search.initial : s->search.max_evals;
    return (SearchConfig){
        .seed = (uint32_t)s->search.seed,
        .population = (size_t)s->search.population,
        .initial = (size_t)initial,
        .generations = (size_t)s->search.generations,
        .max_evals = (size_t)s->search.max_evals,
        .surrogate_max = (size_t)s->search.surrogate_max,
        .surrogate = s->search.surrogate,
        .selection = s->search.survival,
        .asynchronous = s->search.asynchronous == SWITCH_ON,
        .max_seconds = 3600 * s->search.max_hours,
        .nondominated_share = s->search.nondominated_share,
        .trust_error = s->search.trust_error,
        .repeats = s->search.replicate_share,
        .replicates_min = (size_t)s->search.replicates_min,
        .replicates_max = (size_t)s->search.replicates_max,
        .crossover_probability = s->search.crossover_probability,
        .crossover_eta = s->search.crossover_eta,
        .mutation_eta = s->search.mutation_eta,
        .mutation_rate = s->search.mutation_rate,
    };
}

/* -- the search, from where it stands ------------------------------------------------------------------------------ */

/* What the run has of the search, as the search takes it up: the finished generations, then the evaluations of the one
 * that was cut short. */
static Status find_start(const Study *study, SearchStart *start, Err *err)
{
    const Run *h = store_run(study->store);
    size_t n = 0;
    for (; n < h->table.n && h->table.row[n].id < POLISHED_FIRST; n++) {
        start->n += h->state && start->n == n && h->table.row[n].kind != KIND_UNFINISHED;
        if ((start->n > n || study->used.search.asynchronous) && h->table.row[n].id != (long)n + 1)
            return fail(err, STATUS_IO, "%s/run.sqlite: is damaged: evaluation %zu is missing", study->summary->folder,
                        n + 1);
    }
    start->n_later = n - start->n;
    start->row = h->table.row;
    start->state = h->state;
    start->n_state = h->n_state;
    return STATUS_OK;
}

/* Of surrogate and search: beside simulations that go on, a quarter. */
static int search_threads(const Study *study)
{
    const int threads = adapter_threads(study->adapter);
    return study->used.search.asynchronous ? (threads + 3) / 4 : threads;
}

static Status run_search(Study *study, Err *err)
{
    const Run *h = store_run(study->store);
    SearchConfig config = study_search_config(&study->used);
    SearchStart start = {0};
    double *given = NULL;
    config.max_seconds = 0.0; /* the study has a clock of its own, which it looks at more often */
    if (h) {
        const long initial = study->used.search.initial;
        config.planned_evals = (size_t)h->planned_evals;
        config.initial = (size_t)(initial < h->planned_evals ? initial : h->planned_evals);
    }
    omp_set_num_threads(search_threads(study));
    TRY(given_read(study->used.search.start, adapter_schema(study->adapter), &given, &config.n_given, err));
    config.given = given;
    Status status = h ? find_start(study, &start, err) : STATUS_OK;
    adapter_observe(study->adapter, &(Observer){may_go_on, evaluation_done, study});
    if (status == STATUS_OK)
        status = search_resume(adapter_problem(study->adapter), &config,
                               start.row && start.n + start.n_later > 0 ? &start : NULL, observe, study,
                               &study->summary->stopped, err);
    free(given);
    if (status == STATUS_STOPPED)
        study->summary->stopped = STOP_ASKED;
    return status == STATUS_STOPPED ? STATUS_OK : status;
}

/* What surrogate and search cost beside the simulations, and what came of it. */
static Status log_costs(const Study *study, Err *err)
{
    const StudySummary *sum = study->summary;
    char text[160];
    if (sum->search_s > 0.0) {
        const double waiting = sum->waited_s / sum->search_s, surrogate = sum->surrogate_s / sum->search_s;
        const Effort e = {waiting, surrogate, 1.0 - waiting - surrogate,
                          sum->busy_s > 0.0 ? sum->busy_s / sum->search_s / adapter_threads(study->adapter) : NAN};
        effort_words(&e, text);
        TRY(store_log(study->store, err, "%s", text));
    }
    if (!isfinite(sum->own_s) || !isfinite(sum->simulation_s))
        return STATUS_OK;
    return store_log(
        study->store, err,
        "wall time per simulation: %.3g ms in the simulator, %.3g ms of surrogate and search (%.0f %%); %s",
        1e3 * sum->simulation_s, 1e3 * sum->own_s, 100.0 * sum->own_s / (sum->own_s + sum->simulation_s),
        sum->is_aside ? "the surrogate did not pay and stepped aside" : "the surrogate was used");
}

static Status finish(Study *study, Err *err)
{
    StudySummary *sum = study->summary;
    const double session = session_seconds(study);
    const int is_final = sum->stopped != STOP_ASKED;
    if (!is_final && study->late)
        sum->stopped = STOP_TIME;
    const char *why = stop_reason_words(sum->stopped);
    sum->seconds = study->seconds_before + session;
    TRY(store_log(study->store, err, "stopped: %s; %zu simulated, %zu failed, %zu on the front, %.1f s", why,
                  sum->n_simulated, sum->n_failed, sum->n_front, sum->seconds));
    TRY(log_costs(study, err));
    TRY(store_event(study->store,
                    json_pack("{s:s, s:s, s:b, s:I, s:f}", "event", "stops", "why", why, "final", is_final, "simulated",
                              (json_int_t)sum->n_simulated, "seconds", sum->seconds),
                    err));
    RunStore *store = study->store;
    study->store = NULL;
    TRY(store_close(store, why, is_final, session, is_final ? study->options->run : NULL, err));
    return is_final ? STATUS_OK
                    : fail(err, STATUS_STOPPED, "%.200s: %s after %zu of %ld simulations", sum->folder, why,
                           sum->n_simulated, sum->max_evals);
}

/* A run that came to its end, with the limits that it had then: there is nothing to do. */
static int came_to_its_end(const Run *h, StopReason *stopped)
{
    const RunSession *last = h->n_sessions > 0 ? &h->session[h->n_sessions - 1] : NULL;
    if (!last || !last->is_final)
        return 0;
    for (*stopped = STOP_GENERATIONS; *stopped < STOP_ASKED; ++*stopped)
        if (strcmp(stop_reason_words(*stopped), last->stopped) == 0)
            break;
    return 1;
}

static int is_over(const Study *study)
{
    const Run *h = store_run(study->store);
    return h && !study->has_new_limits && came_to_its_end(h, &study->summary->stopped);
}

int study_finished(RunStore *store, StudySummary *summary, Run *run)
{
    const Run *h = store_run(store);
    *summary = (StudySummary){0};
    if (!h || !came_to_its_end(h, &summary->stopped))
        return 0;
    snprintf(summary->folder, sizeof summary->folder, "%s", store_folder(store));
    summary->max_evals = h->settings->search.max_evals;
    sum_up(summary, h);
    *run = store_give_run(store);
    return 1;
}

/* -- polishing ----------------------------------------------------------------------------------------------------- */

enum { POLISH_MEMBERS = 4, POLISH_LEAST = 40, POLISH_SHARE = 10, POLISH_MOST = 32 };

/* Simulations for each design that is polished: together a tenth of all; 0: not worth it. */
static size_t polish_evals(const Settings *s)
{
    const long n = s->search.polish < POLISH_MOST ? s->search.polish : POLISH_MOST;
    const long each = n > 0 ? s->search.max_evals * s->sim.replicates / (POLISH_SHARE * n) : 0;
    return s->problem.kind == PROBLEM_TOWER && each >= POLISH_LEAST ? (size_t)each : 0;
}

/* In all objectives at once, none of which may get worse. The better design is stored with the note that this one has
 * been tried: a run that is cut short goes on behind it. */
static Status polish_one(Study *study, const Run *h, size_t row, size_t n_tried, Err *err)
{
    StudySummary *sum = study->summary;
    const Settings *s = &study->used;
    unsigned char keep[OBJECTIVES_MAX];
    double weight[OBJECTIVES_MAX];
    Refined refined;
    for (size_t k = 0; k < OBJECTIVES_MAX; k++) {
        keep[k] = 1;
        weight[k] = 1.0;
    }
    const RefineConfig config = {.weight = weight,
                                 .keep = keep,
                                 .slack = -1.0,
                                 .members = s->sim.replicates > POLISH_MEMBERS ? s->sim.replicates : POLISH_MEMBERS,
                                 .max_evals = polish_evals(s),
                                 .go_on = may_go_on,
                                 .user = study};
    Status status = refine_design(h, row, &config, &refined, err);
    if (status == STATUS_BAD_DATA) { /* with more members it fails, say: the others are polished all the same */
        Err why = *err;
        status = store_log(study->store, err, "design %zu is not polished: %s", row + 1, why.text);
        if (status == STATUS_OK)
            status = store_polished(study->store, NULL, n_tried, sum->n_simulated, err);
    } else if (status == STATUS_OK) {
        const Evaluation better = refined_evaluation(&refined);
        const int counts = refined_counts(&refined);
        status = store_polished(study->store, counts ? &better : NULL, n_tried, sum->n_simulated, err);
        sum->n_polished += counts != 0;
        sum->n_tried_to_polish++;
    }
    refined_free(&refined);
    return status;
}

/* Some spread-out designs of the finished run. */
static Status polish_chosen(Study *study, const Run *h, Err *err)
{
    size_t rows[POLISH_MOST];
    const long most = study->used.search.polish;
    const size_t n = run_spread_out(h, (size_t)(most < POLISH_MOST ? most : POLISH_MOST), 0, rows);
    const size_t tried = h->polished_at == (long)study->summary->n_simulated ? (size_t)h->tried_to_polish : 0;
    for (size_t i = tried; i < n; i++)
        TRY(polish_one(study, h, rows[i], i + 1, err));
    return STATUS_OK;
}

static Status polish_some(Study *study, Err *err)
{
    Run h;
    if (study->summary->stopped == STOP_ASKED || polish_evals(&study->used) == 0)
        return STATUS_OK;
    TRY(store_read(study->store, &h, err));
    run_drop_polished(&h);
    const Status status = polish_chosen(study, &h, err);
    run_free(&h);
    if (status == STATUS_STOPPED)
        study->summary->stopped = STOP_ASKED;
    return status == STATUS_STOPPED ? STATUS_OK : status;
}

static Status work(Study *study, Err *err)
{
    TRY(log_start(study, err));
    TRY(run_search(study, err));
    TRY(study->status);
    TRY(polish_some(study, err));
    return finish(study, err);
}

Status study_run(const Settings *s, const StudyOptions *options, StudySummary *summary, FILE *differences, Err *err)
{
    memset(summary, 0, sizeof *summary);
    Study study = {
        .options = options, .store = options->store, .summary = summary, .differences = differences, .err = err};
    pthread_mutex_init(&study.lock, NULL);
    study.start = clock_seconds();
    Status status = prepare(&study, s, err);
    if (status == STATUS_OK && !is_over(&study))
        status = work(&study, err);
    else if (status == STATUS_OK && options->run)
        *options->run = store_give_run(study.store);
    if (status != STATUS_OK && study.store) {
        Err ignored; /* the fault itself is what the caller must hear of */
        store_flush(study.store, &ignored);
        store_log(study.store, &ignored, "failed: %s", err->text);
    }
    store_free(study.store);
    adapter_close(study.adapter);
    pthread_mutex_destroy(&study.lock);
    return status;
}
