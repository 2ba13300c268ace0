#include "cmd/asked.h"

#include "cmd/designs.h"
#include "cmd/show.h"
#include "settings/options.h"

/* Rows of out have the designs X (n, n_var), as the workers answer them; the columns of the adapter follow. */
static Status ask(Adapter *a, size_t n, const double X[], EvaluationTable *out, Err *err)
{
    Queue *q;
    Finished done;
    Problem p = *adapter_problem(a);
    p.executor = NULL;
    p.n_workers = MIN_OF(n, p.n_workers);
    *out = evaluation_table(p.n_var, p.n_obj, p.n_extra);
    TRY(queue_open(&q, &p, err));
    Status status = STATUS_OK;
    for (size_t i = 0; i < n && status == STATUS_OK; i++)
        status = queue_ask(q, &(Asked){.x = X + i * p.n_var}, err);
    for (size_t i = 0; i < n && status == STATUS_OK; i++) {
        status = queue_next(q, &done, err);
        THEN(status, evaluation_table_append(out, done.evaluation, err));
    }
    queue_close(q);

    /* Values that the first design which succeeded has, as many as are known from the front: constraint values. */
    size_t first = 0;
    long n_known = 0;
    while (first < out->n && out->row[first].outcome != OUTCOME_OK)
        first++;
    while (first < out->n && n_known < (long)out->n_extra && isfinite(out->row[first].extra[n_known]))
        n_known++;
    return status == STATUS_OK ? adapter_constrain(a, n_known, err) : status;
}

/* A cell for every column that has a value. */
static void put_columns(json_t *o, const Schema *s, const Evaluation *e, int with_variables)
{
    char word[KIND_WORD_MAX];
    for (size_t j = with_variables ? 0 : s->n_var; j < s->n_var + s->n_obj + s->n_extra; j++) {
        const double value = j < s->n_var              ? e->x[j]
                             : j < s->n_var + s->n_obj ? e->f[j - s->n_var]
                                                       : e->extra[j - s->n_var - s->n_obj];
        const int is_word = j < s->n_var && schema_word(s, j, value, word);
        json_object_set_new(o, s->column[j].name, is_word ? json_string(word) : json_number(value));
    }
    json_put(o, "outcome=%s reason=%s seconds=%g", outcome_word(e->outcome), e->reason, e->seconds);
}

/* -- simulate ------------------------------------------------------------------------------------------------------ */

Status asked_simulate(const Args *args, const Settings *s, Err *err)
{
    Adapter *a;
    Settings any = *s;
    Designs designs;
    EvaluationTable t = {0};
    any.problem.constraints = ASKED_CONSTRAINTS(s);
    for (int i = 0; i < args->n_given; i++)
        if (!strstr("--design --csv --json --set", args->given[i].option->name))
            return misused(err, "%s needs problem.kind = tower, the only one with a building, a core and a motion",
                           args->given[i].option->name);
    if (strcmp(args_value(args, "--design"), "none") == 0)
        return bad_data(err, "problem.kind: without a design only problem.kind = tower can be simulated");
    TRY(adapter_open(&a, &any, err));
    Status status = designs_of_problem(&designs, args_value(args, "--design"), adapter_schema(a), err);
    THEN(status, ask(a, designs.n, designs.x, &t, err));
    if (status == STATUS_OK) {
        Document d = {.rows = json_array()};
        for (size_t i = 0; i < t.n; i++)
            put_columns(json_put(figures_row(d.rows), "design=%ld", design_number(&designs, i)), adapter_schema(a),
                        &t.row[i], args_has(args, "--json"));
        d.data = json_incref(d.rows);
        json_array_extend(document_table(&d), d.rows);
        status = document_give(&d, args, err);
        if (t.n == 1 && t.row[0].outcome != OUTCOME_OK)
            THEN(status, fail(err, STATUS_INTERNAL, "the simulation failed: %s", t.row[0].reason));
    }
    evaluation_table_free(&t);
    design_free(&designs);
    adapter_close(a);
    return status;
}

/* -- check --------------------------------------------------------------------------------------------------------- */

static const double QUICK_S = 2.0;

Status asked_check(Adapter *a, json_t *out, double *each_s, Outcome *outcome, Err *why, Err *err)
{
    const Problem *p = adapter_problem(a);
    EvaluationTable t = {0};
    double *x;
    TRY_ROOM(x, p->n_var, "variables", err);
    for (size_t d = 0; d < p->n_var; d++)
        x[d] = problem_spread(p, d, 0.5);
    problem_repair(p, x);
    Status status = ask(a, 1, x, &t, err);
    if (status == STATUS_OK && t.row[0].outcome == OUTCOME_OK && t.row[0].seconds < QUICK_S) {
        evaluation_table_free(&t);
        status = ask(a, 1, x, &t, err);
    }
    if (status == STATUS_OK) {
        json_t *worker = json_object();
        put_columns(worker, adapter_schema(a), t.row, 1);
        json_put(out, "worker=%p", worker);
        *each_s = t.row[0].seconds;
        *outcome = t.row[0].outcome;
        fail(why, STATUS_BAD_DATA, "%s: %s", outcome_word(*outcome), t.row[0].reason);
    }
    free(x);
    evaluation_table_free(&t);
    return status;
}
