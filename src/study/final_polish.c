#include "study/final_polish.h"

#include "base/json.h"
#include "base/linalg.h"
#include "evaluate/cluster.h"
#include "evaluate/tasks.h"
#include "settings/settings.h"
#include "study/refine.h"

/* Replicates that a standard deviation is estimated from; simulations below which polishing a design finds nothing; the
 * share of the search, 1 / SHARE, that all of them take; designs. Chosen in docs/polish.md. */
enum { REPLICATES_MIN = 4, EVALS_MIN = 40, SHARE = 10, DESIGNS_MAX = 32 };

static size_t n_designs(const Settings *s)
{
    return MIN_OF(s->search.polish, DESIGNS_MAX);
}

/* Of a tower; other problems are simulated once. */
static long replicates(const Settings *s)
{
    return MAX_OF(s->sim.replicates, REPLICATES_MIN);
}

/* Simulations for each design; 0: not worth it. */
static size_t evals_each(const Settings *s)
{
    const long n = n_designs(s);
    const long each = n > 0 ? s->search.max_evals * s->sim.replicates / (SHARE * n) : 0;
    const int is_possible = refine_allows(s, &(Err){0}) == STATUS_OK;
    return is_possible && each >= EVALS_MIN && (size_t)each >= refine_evals_min(s, replicates(s)) ? each : 0;
}

/* In all objectives at once, each of which may lose one deviation. */
static Status refine(const FinalPolish *p, const Run *run, size_t row, Refined *refined, Err *err)
{
    RefineConfig config = {
        .replicates = replicates(p->used), .max_evals = evals_each(p->used), .go_on = p->go_on, .user = p->user};
    for (size_t k = 0; k < OBJECTIVES_MAX; k++) {
        config.weight[k] = 1.0;
        config.slack[k] = -1.0;
    }
    return refine_design(run, row, &config, refined, err);
}

typedef struct {
    RunStore *store;
    const FinalPolish *p;
    size_t *n_tried, *n_better;
} Polishing;

/* status: of polishing the design, n_before have been tried before. One that cannot be polished, one that fails with
 * more replicates say, is logged and left out. */
static Status store_refined(const Polishing *w, size_t row, size_t n_before, const Refined *refined, Status status,
                            const Err *why, Err *err)
{
    const Evaluation *better = NULL;
    if (status == STATUS_BAD_DATA) {
        TRY(store_event(w->store, json_of("event=%s row=%ld why=%s", "not polished", row + 1, why->text), err));
    } else if (status == STATUS_OK) {
        better = refined_counts(refined) ? &refined->designs.row[1] : NULL;
        *w->n_better += better != NULL;
        ++*w->n_tried;
    } else {
        *err = *why;
        return status;
    }
    return store_polished(w->store, better, n_before + 1, w->p->n_simulated, &(long){0}, err);
}

/* Where other processes simulate, they open one simulator at a time. */
static size_t side_by_side(const Settings *s, size_t n)
{
    size_t n_ranks;
    const size_t most = MIN_OF(n, threads_wanted(s->search.threads));
    const int elsewhere =
        cluster_executor(&n_ranks) || s->run.isolate == SWITCH_ON || s->problem.kind == PROBLEM_EXTERNAL;
    return elsewhere || most < 2 || linalg_room(most, &(Err){0}) != STATUS_OK ? 1 : most;
}

/* The workers are shared out; what comes out is stored in the order of the designs. */
static Status polish_chosen(const Polishing *w, const Run *run, Err *err)
{
    size_t rows[DESIGNS_MAX];
    const size_t n = run_spread_out(run, n_designs(w->p->used), 0, rows);
    const size_t first = run->polished_at == (long)w->p->n_simulated ? run->tried_to_polish : 0;
    const size_t n_threads = first < n ? side_by_side(w->p->used, n - first) : 1;
    Settings settings = *run->settings;
    Run own = *run;
    Status all = STATUS_OK;
    own.settings = &settings;
    settings.search.threads = threads_wanted(w->p->used->search.threads) / n_threads;
#pragma omp parallel for ordered schedule(dynamic, 1) num_threads((int)n_threads)
    for (size_t i = first; i < n; i++) {
        Refined refined;
        Err why = {0};
        const Status status = refine(w->p, &own, rows[i], &refined, &why);
#pragma omp ordered
        if (all == STATUS_OK)
            all = store_refined(w, rows[i], i, &refined, status, &why, err);
        refined_free(&refined);
    }
    return all;
}

Status final_polish(RunStore *store, const FinalPolish *p, size_t *n_tried, size_t *n_better, Err *err)
{
    Run run;
    if (evals_each(p->used) == 0)
        return STATUS_OK;
    TRY(store_read(store, &run, err));
    run_drop_polished(&run);
    const Status status = polish_chosen(&(Polishing){store, p, n_tried, n_better}, &run, err);
    run_free(&run);
    return status;
}
