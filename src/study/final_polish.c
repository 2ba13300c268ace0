#include "study/final_polish.h"

#include "base/clock.h"
#include "base/json.h"
#include "base/linalg.h"
#include "evaluate/cluster.h"
#include "evaluate/tasks.h"
#include "settings/settings.h"
#include "study/polish.h"

/* Replicates that a standard deviation is estimated from; simulations below which polishing a design finds nothing; the
 * share of the search, 1 / SHARE, that all of them take; designs. Chosen in docs/polish.md. */
enum { REPLICATES_MIN = 4, EVALS_MIN = 40, SHARE = 10, DESIGNS_MAX = 32 };

typedef struct {
    RunStore *store;
    const FinalPolish *p;
    FinalPolished *out;
} Polishing;

/* status: of polishing the design, n_before have been tried before. One that cannot be polished, one that fails with
 * more replicates say, is logged and left out. */
static Status store_polish(const Polishing *w, long id, size_t n_before, const Improved *polished, Status status,
                           Err *err)
{
    const Evaluation *better = NULL;
    if (status == STATUS_BAD_DATA) {
        TRY(store_event(w->store, json_of("event=%s row=%ld why=%s", "not polished", id, err->text), err));
    } else {
        TRY(status);
        better = polish_counts(polished) ? &polished->designs.row[POLISH_END] : NULL;
        w->out->n_better += better != NULL;
        w->out->n_tried++;
    }
    w->out->cost.n_evaluated += polished->cost.n_evaluated;
    w->out->cost.n_failed += polished->cost.n_failed;
    w->out->cost.n_simulated += polished->cost.n_simulated;
    return store_polished(w->store, better, n_before + 1, w->p->n_simulated, &(long){0}, err);
}

/* The n chosen designs but those tried before; the workers are shared out, and what comes out is stored in the order of
 * the designs. */
static Status polish_chosen(const Polishing *w, const Run *run, size_t n_wanted, const ImproveConfig *config, Err *err)
{
    size_t rows[DESIGNS_MAX];
    const size_t n = run_spread_out(run, n_wanted, 0, rows);
    const size_t first = run->polished_at == (long)w->p->n_simulated ? run->tried_to_polish : 0;
    const Settings *s = w->p->used;
    const size_t threads = threads_wanted(s->search.threads), most = first < n ? MIN_OF(n - first, threads) : 1;
    size_t n_ranks;
    const int elsewhere = /* other processes open one simulator at a time */
        cluster_executor(&n_ranks) || s->run.isolate == SWITCH_ON || s->problem.kind == PROBLEM_EXTERNAL;
    const size_t n_threads = elsewhere || most < 2 || linalg_room(most, &(Err){0}) != STATUS_OK ? 1 : most;
    Settings settings = *run->settings;
    Run own = *run;
    Status all = STATUS_OK;
    own.settings = &settings;
    settings.search.threads = threads / n_threads;
#pragma omp parallel for ordered schedule(dynamic, 1) num_threads((int)n_threads)
    for (size_t i = first; i < n; i++) {
        Improved polished;
        Err why = {0};
        const Status status = improve_design(&own, rows[i], config, polish_design, &polished, &why);
#pragma omp ordered
        if (all == STATUS_OK) {
            all = store_polish(w, run->table.row[rows[i]].id, i, &polished, status, &why);
            if (all != STATUS_OK)
                *err = why;
        }
        improved_free(&polished);
    }
    return all;
}

Status final_polish(RunStore *store, const FinalPolish *p, FinalPolished *out, Err *err)
{
    const Settings *s = p->used;
    const long n = MIN_OF(s->search.polish, DESIGNS_MAX);
    const long each = n > 0 ? s->search.max_evals * s->sim.replicates / (SHARE * n) : 0;
    ImproveConfig config = {
        .replicates = MAX_OF(s->sim.replicates, REPLICATES_MIN), .max_evals = each, .go_on = p->go_on, .user = p->user};
    if (each < EVALS_MIN || config.max_evals < polish_evals_min(s, config.replicates) ||
        polish_allows(s, &(Err){0}) != STATUS_OK)
        return STATUS_OK;
    for (size_t k = 0; k < OBJECTIVES_MAX; k++) { /* in all at once, each of which may lose one deviation */
        config.weight[k] = 1.0;
        config.slack[k] = -1.0;
    }
    Run run;
    const double begun = clock_seconds();
    TRY(store_read(store, RUN_FRONT, &run, err));
    run_drop_polished(&run);
    const Status status = polish_chosen(&(Polishing){store, p, out}, &run, n, &config, err);
    out->cost.seconds += clock_seconds() - begun;
    run_free(&run);
    return status;
}
