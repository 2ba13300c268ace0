#include "run/study.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include <omp.h>

#include "run/provenance.h"
#include "run/store.h"
#include "run/subject.h"

typedef struct {
    const Settings *settings;
    Subject *subject;
    RunStore *store;
    size_t n_stored; /* simulations in evaluations.csv */

    StudyProgressFn progress;
    void *user;
    StudySummary *summary;
    Status status; /* of writing; ends the search */
    Err *err;
} Study;

static Status write_generation(Study *study, const SearchView *view, Err *err)
{
    size_t n_new;
    const Verdict *verdicts = subject_verdicts(study->subject, &n_new);
    if (study->n_stored + n_new != view->n)
        return fail(err, STATUS_INTERNAL, "the search knows of %zu simulations, %zu were made", view->n,
                    study->n_stored + n_new);
    TRY(store_evaluations(study->store, view, study->n_stored, verdicts, err));
    study->n_stored = view->n;
    subject_forget(study->subject);
    TRY(store_front(study->store, view, err));
    char surface[24] = "-";
    if (isfinite(view->surrogate_error))
        snprintf(surface, sizeof surface, "%.3g", view->surrogate_error);
    return store_log(study->store, err,
                     "generation %zu: %zu simulated, %zu failed, front %zu, predictions kept %zu, "
                     "surrogate error %s, %.1f s",
                     view->generation_now, view->n, view->n_failed, view->n_front, view->n_predicted, surface,
                     view->seconds);
}

static int observe(const SearchView *view, void *user)
{
    Study *study = user;
    study->status = write_generation(study, view, study->err);
    study->summary->n_simulated = view->n;
    study->summary->n_failed = view->n_failed;
    study->summary->n_front = view->n_front;
    study->summary->seconds = view->seconds;
    if (study->progress)
        study->progress(view, study->user);
    return study->status != STATUS_OK;
}

/* A saved path is looked up from anywhere: absolute where it can be. */
static void make_absolute(char path[SETTINGS_TEXT_MAX])
{
    char *absolute = realpath(path, NULL);
    if (absolute && strlen(absolute) < SETTINGS_TEXT_MAX)
        snprintf(path, SETTINGS_TEXT_MAX, "%s", absolute);
    free(absolute);
}

static Settings settings_as_used(const Study *study)
{
    Settings used = *study->settings;
    struct stat there;
    if (strncmp(used.motion.record, "builtin:", 8) != 0)
        make_absolute(used.motion.record);
    const int is_name = !strcmp(used.building.model, "guyan") || !strcmp(used.building.model, "appendix");
    if (!is_name && stat(used.building.model, &there) == 0 && S_ISDIR(there.st_mode))
        make_absolute(used.building.model);
    snprintf(used.run.out, sizeof used.run.out, "%.*s", SETTINGS_TEXT_MAX - 1, store_folder(study->store));
    return used;
}

static Status simulate_without_core(Study *study, Err *err)
{
    Crew *crew = subject_crew(study->subject);
    study->summary->has_no_core = crew != NULL;
    return crew ? crew_run(crew, 1, &(SimTask){SCENE_NO_CORE, NULL}, &study->summary->no_core, err) : STATUS_OK;
}

static Status log_start(Study *study, const Settings *used, Err *err)
{
    const Schema *schema = subject_schema(study->subject);
    const int threads = subject_threads(study->subject);
    if (subject_world(study->subject))
        return store_log(study->store, err, "%zu floors, %s, pga %g g, stretch %g, %d threads, seed %ld",
                         schema->n_var - 2, used->motion.record, used->motion.pga_g, used->motion.stretch, threads,
                         used->search.seed);
    return store_log(study->store, err, "%zu variables, %zu objectives, %d threads, seed %ld", schema->n_var,
                     schema->n_obj, threads, used->search.seed);
}

static Status prepare(Study *study, const Settings *s, int exact, Err *err)
{
    TRY(subject_open(&study->subject, s, err));
    TRY(simulate_without_core(study, err));
    TRY(store_create(&study->store, s->run.out, exact, subject_schema(study->subject), err));
    snprintf(study->summary->folder, sizeof study->summary->folder, "%s", store_folder(study->store));
    const Settings used = settings_as_used(study);
    TRY(store_settings(study->store, &used, err));
    TRY(provenance_write(store_folder(study->store), s, subject_world(study->subject), subject_threads(study->subject),
                         err));
    return log_start(study, &used, err);
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
        .no_surrogate = s->search.surrogate == 1,
        .max_seconds = 3600 * s->search.max_hours,
        .nondominated_share = s->search.nondominated_share,
        .trust_error = s->search.trust_error,
        .crossover_probability = s->search.crossover_probability,
        .crossover_eta = s->search.crossover_eta,
        .mutation_eta = s->search.mutation_eta,
        .mutation_rate = s->search.mutation_rate,
    };
}

static Status search(Study *study, Err *err)
{
    const SearchConfig config = study_search_config(study->settings);
    omp_set_num_threads(subject_threads(study->subject));
    TRY(search_run(subject_problem(study->subject), &config, observe, study, &study->summary->stopped, err));
    TRY(study->status);
    return store_log(study->store, err, "stopped: %s; %zu simulated, %zu failed, %zu on the front, %.1f s",
                     stop_reason_words(study->summary->stopped), study->summary->n_simulated, study->summary->n_failed,
                     study->summary->n_front, study->summary->seconds);
}

Status study_run(const Settings *s, int exact, StudyProgressFn progress, void *user, StudySummary *summary, Err *err)
{
    memset(summary, 0, sizeof *summary);
    Study study = {.settings = s, .progress = progress, .user = user, .summary = summary, .err = err};
    Status status = prepare(&study, s, exact, err);
    if (status == STATUS_OK)
        status = search(&study, err);
    if (status != STATUS_OK && study.store) {
        Err ignored; /* the fault itself is what the caller must hear of */
        store_log(study.store, &ignored, "failed: %s", err->text);
    } else if (status == STATUS_OK) {
        status = store_close(study.store, err);
        study.store = NULL;
    }
    store_free(study.store);
    subject_close(study.subject);
    return status;
}
