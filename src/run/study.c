#include "run/study.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "run/crew.h"
#include "run/measures.h"
#include "run/provenance.h"
#include "run/store.h"
#include "run/world.h"

typedef struct {
    World world;
    Crew *crew;
    RunStore *store;
    int n_floors;
    double lower[FLOORS_MAX + 2], upper[FLOORS_MAX + 2];

    Verdict *pending; /* of the simulations that are not in evaluations.csv yet, in their order */
    size_t n_pending, pending_max, n_stored;

    StudyProgressFn progress;
    void *user;
    StudySummary *summary;
    Status status; /* of writing; ends the search */
    Err *err;
} Study;

static void swap_if_top_heavy(double x[], void *user)
{
    /* Swapping keeps both thicknesses in the box and the sample spread out; clipping would pile designs up on
     * t_top = t_base. */
    const Study *study = user;
    double *t_base = &x[study->n_floors], *t_top = t_base + 1;
    if (*t_top > *t_base) {
        const double thicker = *t_top;
        *t_top = *t_base;
        *t_base = thicker;
    }
}

static Status room_for(Study *study, size_t more, Err *err)
{
    const size_t need = study->n_pending + more;
    if (need <= study->pending_max)
        return STATUS_OK;
    Verdict *wider = realloc(study->pending, 2 * need * sizeof *wider);
    if (!wider)
        return fail(err, STATUS_NO_MEMORY, "no memory for %zu verdicts", 2 * need);
    study->pending = wider;
    study->pending_max = 2 * need;
    return STATUS_OK;
}

static Status simulate_designs(size_t n, const double X[], double F[], double G[], unsigned char ok[], void *user,
                               Err *err)
{
    Study *study = user;
    (void)G; /* no constraints: what cannot be built is repaired, what cannot be simulated has failed */
    TRY(room_for(study, n, err));
    SimTask *tasks = calloc(n, sizeof *tasks);
    SimResult *results = calloc(n, sizeof *results);
    Status status = tasks && results ? STATUS_OK : fail(err, STATUS_NO_MEMORY, "no memory for %zu simulations", n);
    for (size_t i = 0; status == STATUS_OK && i < n; i++)
        tasks[i] = (SimTask){SCENE_IMPACT, &X[i * (size_t)(study->n_floors + 2)]};
    if (status == STATUS_OK)
        status = crew_run(study->crew, n, tasks, results, err);
    for (size_t i = 0; status == STATUS_OK && i < n; i++) {
        ok[i] = (unsigned char)measure_objectives(&results[i], &F[i * N_OBJECTIVES]);
        verdict_of(&results[i], &study->pending[study->n_pending++]);
    }
    free(tasks);
    free(results);
    return status;
}

static Status write_generation(Study *study, const SearchView *view, Err *err)
{
    if (study->n_stored + study->n_pending != view->n)
        return fail(err, STATUS_INTERNAL, "the search knows of %zu simulations, %zu were made", view->n,
                    study->n_stored + study->n_pending);
    TRY(store_evaluations(study->store, view, study->n_stored, study->pending, err));
    study->n_stored = view->n;
    study->n_pending = 0;
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
    Settings used = study->world.settings;
    struct stat there;
    if (strncmp(used.motion.record, "builtin:", 8) != 0)
        make_absolute(used.motion.record);
    const int is_name = !strcmp(used.building.model, "guyan") || !strcmp(used.building.model, "appendix");
    if (!is_name && stat(used.building.model, &there) == 0 && S_ISDIR(there.st_mode))
        make_absolute(used.building.model);
    snprintf(used.run.out, sizeof used.run.out, "%.*s", SETTINGS_TEXT_MAX - 1, store_folder(study->store));
    return used;
}

static Status prepare(Study *study, const Settings *s, int exact, Err *err)
{
    TRY(world_open(&study->world, s, err));
    TRY(crew_create(&study->crew, study->world.scene, s->search.threads, err));
    study->n_floors = scene_n_floors(study->world.scene);
    for (int j = 0; j < study->n_floors + 2; j++) {
        study->lower[j] = j < study->n_floors ? s->design.gap_min_m : s->design.thickness_min_m;
        study->upper[j] = j < study->n_floors ? s->design.gap_max_m : s->design.thickness_max_m;
    }
    TRY(crew_run(study->crew, 1, &(SimTask){SCENE_NO_CORE, NULL}, &study->summary->no_core, err));

    TRY(store_create(&study->store, s->run.out, exact, study->n_floors, err));
    snprintf(study->summary->folder, sizeof study->summary->folder, "%s", store_folder(study->store));
    const Settings used = settings_as_used(study);
    TRY(store_settings(study->store, &used, err));
    TRY(provenance_write(store_folder(study->store), &study->world, crew_size(study->crew), err));
    return store_log(study->store, err, "%d floors, %s, pga %g g, stretch %g, %d threads, seed %ld", study->n_floors,
                     used.motion.record, used.motion.pga_g, used.motion.stretch, crew_size(study->crew),
                     used.search.seed);
}

static SearchConfig search_config(const Settings *s)
{
    const long initial = s->search.initial < s->search.max_evals ? s->search.initial : s->search.max_evals;
    return (SearchConfig){
        .seed = (uint32_t)s->search.seed,
        .population = (size_t)s->search.population,
        .initial = (size_t)initial,
        .generations = (size_t)s->search.generations,
        .max_evals = (size_t)s->search.max_evals,
        .surrogate_max = (size_t)s->search.surrogate_max,
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
    const Problem problem = {
        .n_var = (size_t)study->n_floors + 2,
        .n_obj = N_OBJECTIVES,
        .lower = study->lower,
        .upper = study->upper,
        .evaluate = simulate_designs,
        .repair = swap_if_top_heavy,
        .user = study,
    };
    const SearchConfig config = search_config(&study->world.settings);
    TRY(search_run(&problem, &config, observe, study, &study->summary->stopped, err));
    TRY(study->status);
    return store_log(study->store, err, "stopped: %s; %zu simulated, %zu failed, %zu on the front, %.1f s",
                     stop_reason_words(study->summary->stopped), study->summary->n_simulated, study->summary->n_failed,
                     study->summary->n_front, study->summary->seconds);
}

Status study_run(const Settings *s, int exact, StudyProgressFn progress, void *user, StudySummary *summary, Err *err)
{
    Study *study = calloc(1, sizeof *study);
    if (!study)
        return fail(err, STATUS_NO_MEMORY, "no memory for a study");
    memset(summary, 0, sizeof *summary);
    study->progress = progress;
    study->user = user;
    study->summary = summary;
    study->err = err;
    Status status = prepare(study, s, exact, err);
    if (status == STATUS_OK)
        status = search(study, err);
    if (status != STATUS_OK && study->store) {
        Err ignored; /* the fault itself is what the caller must hear of */
        store_log(study->store, &ignored, "failed: %s", err->text);
    } else if (status == STATUS_OK) {
        status = store_close(study->store, err);
        study->store = NULL;
    }
    store_free(study->store);
    crew_free(study->crew);
    world_close(&study->world);
    free(study->pending);
    free(study);
    return status;
}
