#include "study/study_log.h"

#include "base/json.h"
#include "base/hypervolume.h"
#include "store/provenance.h"

Status study_log_start(RunStore *store, int threads, const SearchOptions *used, size_t n, Err *err)
{
    char program[96];
    snprintf(program, sizeof program, "imtet %s (%s)", program_version(), program_revision());
    TRY(store_session(store, program, threads, n, err));
    return store_event(store,
                       json_of("event=%s program=%s threads=%d simulated=%ld max_evals=%ld", n ? "resumes" : "starts",
                               program, threads, n, used->max_evals),
                       err);
}

Status study_log_generation(RunStore *store, const SearchView *v, const SessionTimes *t, Err *err)
{
    const Archive *a = v->all;
    const double hypervolume = store_hypervolume(store);
    return store_event(
        store,
        json_of(
            "event=%s number=%ld simulated=%ld repeats=%ld failed=%ld front=%ld outputs_left_out=%ld "
            "surrogate_error=%g hypervolume=%g hypervolume_error=%g seconds=%g search_s=%g waited_s=%g surrogate_s=%g",
            "generation", v->generation, a->n, a->n_replicates, a->n_failed, a->n_front, v->n_left_out,
            v->surrogate_error, hypervolume, hypervolume_error(hypervolume), t->run, t->search, t->waiting,
            t->choosing),
        err);
}

Status study_log_end(RunStore *store, const StudySummary *sum, int is_final, Err *err)
{
    return store_event(store,
                       json_of("event=%s why=%s final=%c simulated=%ld failed=%ld seconds=%g", "stops",
                               stop_reason_words(sum->stopped), is_final, sum->n_simulated, sum->n_failed,
                               sum->seconds),
                       err);
}
