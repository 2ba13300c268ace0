#include "study/final_polish.h"

#include "base/json.h"
#include "settings/options.h"
#include "study/refine.h"

/* Replicates that a standard deviation is estimated from; simulations below which polishing a design finds nothing; the
 * share of the search, 1 / SHARE, that all of them take; designs. Chosen by scripts/polish (docs/polish.md). */
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

/* n_tried: designs tried so far, this one included. */
static Status store_refined(RunStore *store, const FinalPolish *p, const Refined *refined, size_t n_tried, Err *err)
{
    const Evaluation *better = refined_counts(refined) ? &refined->designs.row[1] : NULL;
    return store_polished(store, better, n_tried, p->n_simulated, &(long){0}, err);
}

/* A design that cannot be polished, one that fails with more replicates say, is logged and left out. */
static Status leave_out(RunStore *store, const FinalPolish *p, size_t row, size_t n_tried, const Err *why, Err *err)
{
    TRY(store_event(store, json_of("event=%s row=%ld why=%s", "not polished", row + 1, why->text), err));
    return store_polished(store, NULL, n_tried, p->n_simulated, NULL, err);
}

static Status polish_chosen(RunStore *store, const FinalPolish *p, const Run *run, size_t *n_tried, size_t *n_better,
                            Err *err)
{
    size_t rows[DESIGNS_MAX];
    const size_t n = run_spread_out(run, n_designs(p->used), 0, rows);
    for (size_t i = run->polished_at == (long)p->n_simulated ? run->tried_to_polish : 0; i < n; i++) {
        Refined refined;
        Err why = {0};
        Status status = refine(p, run, rows[i], &refined, &why);
        if (status == STATUS_BAD_DATA) {
            status = leave_out(store, p, rows[i], i + 1, &why, err);
        } else if (status == STATUS_OK) {
            status = store_refined(store, p, &refined, i + 1, err);
            *n_better += refined_counts(&refined) != 0;
            ++*n_tried;
        } else {
            *err = why;
        }
        refined_free(&refined);
        TRY(status);
    }
    return STATUS_OK;
}

Status final_polish(RunStore *store, const FinalPolish *p, size_t *n_tried, size_t *n_better, Err *err)
{
    Run run;
    if (evals_each(p->used) == 0)
        return STATUS_OK;
    TRY(store_read(store, &run, err));
    run_drop_polished(&run);
    const Status status = polish_chosen(store, p, &run, n_tried, n_better, err);
    run_free(&run);
    return status;
}
