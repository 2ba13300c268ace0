#include "study/study_log.h"

#include <stdio.h>

#include "base/json.h"
#include "base/hypervolume.h"
#include "store/provenance.h"

Status study_log_start(RunStore *store, int threads, const SearchOptions *used, size_t n, Err *err)
{
    char program[96];
    snprintf(program, sizeof program, "imtet %s (%s)", program_version(), program_revision());
    TRY(store_session(store, program, threads, n, err));
    return store_event(store,
                       json_pack("{s:s, s:s, s:i, s:I, s:I}", "event", n ? "resumes" : "starts", "program", program,
                                 "threads", threads, "simulated", (json_int_t)n, "max_evals",
                                 (json_int_t)used->max_evals),
                       err);
}

Status study_log_generation(RunStore *store, const SearchView *v, double seconds, Err *err)
{
    const double hypervolume = store_hypervolume(store);
    return store_event(store,
                       json_pack("{s:s, s:I, s:I, s:I, s:I, s:I, s:I, s:o, s:o, s:o, s:f, s:f, s:f, s:f}", "event",
                                 "generation", "number", (json_int_t)v->generation_now, "simulated", (json_int_t)v->n,
                                 "repeats", (json_int_t)v->n_replicates, "failed", (json_int_t)v->n_failed, "front",
                                 (json_int_t)v->n_front, "outputs_left_out", (json_int_t)v->n_left_out,
                                 "surrogate_error", json_number(v->surrogate_error), "hypervolume",
                                 json_number(hypervolume), "hypervolume_error",
                                 json_number(hypervolume_error(hypervolume)), "seconds", seconds, "search_s",
                                 v->seconds, "waited_s", v->waited_s, "surrogate_s", v->surrogate_s),
                       err);
}

Status study_log_end(RunStore *store, const StudySummary *sum, int is_final, Err *err)
{
    return store_event(store,
                       json_pack("{s:s, s:s, s:b, s:I, s:I, s:f}", "event", "stops", "why",
                                 stop_reason_words(sum->stopped), "final", is_final, "simulated",
                                 (json_int_t)sum->n_simulated, "failed", (json_int_t)sum->n_failed, "seconds",
                                 sum->seconds),
                       err);
}
