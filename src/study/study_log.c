#include "study/study_log.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/json.h"
#include "moga/hypervolume.h"
#include "store/provenance.h"
#include "study/progress.h"

static Status log_motions(RunStore *store, const Tower *t, Err *err)
{
    for (size_t i = 0; i < tower_n_records(t); i++) {
        const Motion *m = &tower_record(t, i)->motion;
        char peak[MOTION_PEAK_TEXT_MAX];
        motion_peak_text(m, peak);
        TRY(store_log(store, err, "%s: %.4g s, %s", m->name, (double)(m->n - 1) * m->dt_s, peak));
    }
    return STATUS_OK;
}

static Status log_problem(RunStore *store, const Adapter *adapter, const SearchOptions *used, const char *program,
                          Err *err)
{
    const Schema *schema = adapter_schema(adapter);
    const int threads = adapter_threads(adapter);
    if (adapter_tower(adapter)) {
        const char *missing = measures_missing(&schema->order, used->objectives, schema->design.n_floors);
        TRY(log_motions(store, adapter_tower(adapter), err));
        if (missing)
            TRY(store_log(store, err, "%s", missing));
        return store_log(store, err, "%s: %d floors, %d threads, seed %ld", program, schema->design.n_floors, threads,
                         used->seed);
    }
    return store_log(store, err, "%s: %zu variables, %zu objectives, %d threads, seed %ld", program, schema->n_var,
                     schema->n_obj, threads, used->seed);
}

Status study_log_start(RunStore *store, const Adapter *adapter, const SearchOptions *used, size_t n, Err *err)
{
    const int threads = adapter_threads(adapter);
    char program[96];
    snprintf(program, sizeof program, "imtet %s (%s)", program_version(), program_revision());
    TRY(store_session(store, program, threads, n, err));
    TRY(store_event(store,
                    json_pack("{s:s, s:s, s:i, s:I, s:I}", "event", n ? "resumes" : "starts", "program", program,
                              "threads", threads, "simulated", (json_int_t)n, "max_evals", (json_int_t)used->max_evals),
                    err));
    if (n > 0)
        TRY(store_log(store, err, "resumed after %zu simulations", n));
    return log_problem(store, adapter, used, program, err);
}

static json_t *generation_event(const SearchView *v, double hypervolume, double seconds)
{
    return json_pack("{s:s, s:I, s:I, s:I, s:I, s:I, s:o, s:o, s:o, s:f, s:f, s:f, s:f}", "event", "generation",
                     "number", (json_int_t)v->generation_now, "simulated", (json_int_t)v->n, "repeats",
                     (json_int_t)v->n_replicates, "failed", (json_int_t)v->n_failed, "front", (json_int_t)v->n_front,
                     "surrogate_error", json_number(v->surrogate_error), "hypervolume", json_number(hypervolume),
                     "hypervolume_error", json_number(hypervolume_error(hypervolume)), "seconds", seconds, "search_s",
                     v->seconds, "waited_s", v->waited_s, "surrogate_s", v->surrogate_s);
}

Status study_log_generation(RunStore *store, const SearchView *view, double seconds, Err *err)
{
    const double hypervolume = store_hypervolume(store);
    char surrogate[64] = "-", repeats[40] = "";
    TRY(store_event(store, generation_event(view, hypervolume, seconds), err));
    if (view->n_replicates > 0)
        snprintf(repeats, sizeof repeats, " (%zu repeats)", view->n_replicates);
    if (isfinite(view->surrogate_error))
        snprintf(surrogate, sizeof surrogate, "%.3g", view->surrogate_error);
    if (view->n_left_out > 0)
        snprintf(surrogate + strlen(surrogate), sizeof surrogate - strlen(surrogate), " (without %zu outputs)",
                 view->n_left_out);
    return store_log(store, err,
                     "generation %zu: %zu simulated%s, %zu failed, front %zu, hypervolume %.4f (standard error %.4f), "
                     "surrogate error %s, %.1f s",
                     view->generation_now, view->n, repeats, view->n_failed, view->n_front, hypervolume,
                     hypervolume_error(hypervolume), surrogate, seconds);
}

/* What surrogate and search cost beside the simulations. */
static Status log_costs(RunStore *store, const StudySummary *sum, int threads, Err *err)
{
    char text[160];
    if (sum->search_s > 0.0) {
        const double waiting = sum->waited_s / sum->search_s, surrogate = sum->surrogate_s / sum->search_s;
        const Effort e = {.waiting = waiting,
                          .surrogate = surrogate,
                          .search = 1.0 - waiting - surrogate,
                          .busy = sum->busy_s > 0.0 ? sum->busy_s / sum->search_s / threads : NAN};
        effort_words(&e, text);
        TRY(store_log(store, err, "%s", text));
    }
    return STATUS_OK;
}

void screening_words(const StudySummary *sum, char text[SCREENING_WORDS])
{
    const int n = snprintf(text, SCREENING_WORDS,
                           "%zu designs were screened by their first replicate (search.fidelity), and %zu finished or "
                           "simulated at once, as much as %zu of %ld evaluations; ",
                           sum->n_screened, sum->n_simulated - sum->n_screened, sum->n_evaluations, sum->max_evals);
    if (isnan(sum->level_agreement))
        snprintf(text + n, SCREENING_WORDS - (size_t)n,
                 "too few were finished to know how well the first replicate ranks designs");
    else
        snprintf(text + n, SCREENING_WORDS - (size_t)n,
                 "the first replicate ranks designs as all do by a Kendall's tau of %.2f%s", sum->level_agreement,
                 sum->has_left_screening ? ": too little, so that screening ended" : "");
}

Status study_log_end(RunStore *store, const StudySummary *sum, int threads, int is_final, Err *err)
{
    const char *why = stop_reason_words(sum->stopped);
    TRY(store_log(store, err, "stopped: %s; %zu simulated, %zu failed, %zu on the front, %.1f s", why, sum->n_simulated,
                  sum->n_failed, sum->n_front, sum->seconds));
    TRY(log_costs(store, sum, threads, err));
    if (sum->n_screened > 0) {
        char text[SCREENING_WORDS];
        screening_words(sum, text);
        TRY(store_log(store, err, "%s", text));
    }
    return store_event(store,
                       json_pack("{s:s, s:s, s:b, s:I, s:f}", "event", "stops", "why", why, "final", is_final,
                                 "simulated", (json_int_t)sum->n_simulated, "seconds", sum->seconds),
                       err);
}
