#include "study/record_race.h"

#include "evaluate/race.h"
#include "moga/variation.h"
#include "settings/settings.h"

typedef struct {
    const Problem *problem;
    size_t n_records;
    Measured *parts, *some; /* (PILOT, n_records) (n_records) */
    Evaluation *combined;
} Pilot;

static void results(size_t n, const size_t records[], double y[], void *user)
{
    Pilot *w = user;
    const Problem *p = w->problem;
    for (size_t i = 0; i < PILOT; i++) {
        for (size_t r = 0; r < n; r++)
            w->some[r] = w->parts[i * w->n_records + records[r]];
        p->simulator->combine(p, n, w->some, w->combined);
        for (size_t k = 0; k < p->n_obj; k++)
            y[i * p->n_obj + k] = w->combined->outcome == OUTCOME_OK ? w->combined->f[k] : NAN;
    }
}

/* A Latin hypercube of its own, simulated under every record; then the records in the order found, and the replicates
 * of all. */
static Status choose(Pilot *w, Adapter *a, uint32_t seed, double X[], size_t order[], Err *err)
{
    const Problem *p = w->problem;
    SimTask tasks[PILOT];
    latin_hypercube(seed, UINT32_MAX, PILOT, p->n_var, X, order); /* which has room for the slices */
    for (size_t i = 0; i < PILOT; i++) {
        double *x = X + i * p->n_var;
        for (size_t d = 0; d < p->n_var; d++)
            x[d] = problem_spread(p, d, x[d]);
        problem_repair(p, x);
        tasks[i] = (SimTask){.x = x, .n_parts = w->n_records, .parts = w->parts + i * w->n_records};
    }
    TRY(tower_run(p, PILOT, tasks, NULL, NULL, err));
    TRY(race_order(w->n_records, PILOT, p->n_obj, results, w, order, err));
    for (size_t i = w->n_records; i < p->n_parts; i++)
        order[i] = i;
    return adapter_order(a, race_first(w->n_records), order, err);
}

Status record_race(Adapter *a, const Settings *s, Err *err)
{
    const Tower *t = adapter_tower(a);
    Pilot w = {.problem = adapter_problem(a), .n_records = t ? tower_n_records(t) : 0};
    if (s->search.fidelity != FIDELITY_RECORDS || !settings_screens(s))
        return STATUS_OK;
    EvaluationTable table = evaluation_table(w.problem->n_var, w.problem->n_obj, w.problem->n_extra);
    double *X = malloc(PILOT * w.problem->n_var * sizeof *X);
    size_t *order = malloc((w.problem->n_parts + PILOT) * sizeof *order);
    w.parts = malloc((PILOT + 1) * w.n_records * sizeof *w.parts);
    w.some = w.parts + PILOT * w.n_records;
    Status status = X && order && w.parts ? evaluation_table_add(&table, &w.combined, err)
                                          : fail_memory(err, PILOT * w.n_records, "simulations");
    THEN(status, evaluation_table_give_room(w.combined, err));
    THEN(status, choose(&w, a, (uint32_t)s->search.seed, X, order, err));
    evaluation_table_free(&table);
    free(w.parts);
    free(order);
    free(X);
    return status;
}
