#include "evaluate/adapter.h"

#include "evaluate/external.h"

struct Adapter {
    Schema schema;
    Limits limits;
    double aspire[OBJECTIVES_MAX];
    Problem problem;
    int threads;
    size_t *order; /* (n_parts) of adapter_order; NULL: none */
    Recipe recipe; /* of an external simulator; without scenes */
};

const Problem *adapter_problem(const Adapter *a)
{
    return &a->problem;
}

const Schema *adapter_schema(const Adapter *a)
{
    return &a->schema;
}

const Tower *adapter_tower(const Adapter *a)
{
    return tower_of(&a->problem);
}

int adapter_threads(const Adapter *a)
{
    return a->problem.executor ? MAX_OF(a->threads, (int)threads_wanted(0)) : a->threads;
}

void adapter_observe(Adapter *a, const Observer *observer)
{
    a->problem.observer = *observer;
}

static void judge(const Evaluation *e, double f[], double g[], const void *user)
{
    const Adapter *a = user;
    limits_apply(&a->limits, a->schema.n_obj, e, g);
    copy_values(a->problem.n_con - a->limits.n, e->extra, g + a->limits.n);
    for (size_t k = 0; k < a->schema.n_obj; k++)
        f[k] = schema_objective(&a->schema, k)->sense * e->f[k];
}

Status simulator_open(Problem *p, const void *recipe, size_t size, Err *err)
{
    const Recipe *r = recipe;
    if (size < sizeof *r || size != recipe_size(r->n_records, r->n_scenes))
        return fail(err, STATUS_INTERNAL, "a problem of %zu bytes", size);
    return r->settings.problem.kind == PROBLEM_TOWER
               ? tower_reopen(p, r, err)
               : external_open(p, &r->settings.problem, threads_wanted(r->settings.search.threads), err);
}

/* Columns, limits and constraints of the simulator that is open. */
static Status describe(Adapter *a, const Settings *s, Err *err)
{
    const Tower *t = adapter_tower(a);
    TRY(schema_of(&a->schema, s, t ? tower_design(t)->n_floors : 0, err));
    if ((a->schema.order.objectives >> MEASURE_DEVICES & 1) && a->schema.design.n_choices == 0)
        return bad_data(err, "search.objectives: all designs have the same devices: set design.devices");
    TRY(limits_read(&a->limits, &a->schema, s->search.limits, err));
    TRY(aspirations_read(&a->problem.aspire, a->aspire, &a->schema, s->search.aspire, err));
    a->problem.n_con = a->limits.n + (t ? 0 : a->schema.n_extra);
    a->problem.judge = judge;
    a->problem.user = a;
    a->problem.is_noisy = schema_is_noisy(s);
    return STATUS_OK;
}

Status adapter_order(Adapter *a, size_t n_cheap, const size_t order[], Err *err)
{
    TRY_ROOM(a->order, a->problem.n_parts, "the order of simulations", err);
    memcpy(a->order, order, a->problem.n_parts * sizeof *order);
    a->problem.order = a->order;
    a->problem.n_cheap = n_cheap;
    return STATUS_OK;
}

Status adapter_constrain(Adapter *a, long n, Err *err)
{
    if (a->problem.recipe != &a->recipe)
        return STATUS_OK;
    a->recipe.settings.problem.constraints = n;
    external_constrain(&a->problem, n);
    schema_free(&a->schema);
    return describe(a, &a->recipe.settings, err);
}

/* The one place that picks a simulator. */
static Status prepare(Adapter *a, const Settings *s, Err *err)
{
    Settings own = *s;
    own.sim.measures_only = 1;
    if (s->problem.kind == PROBLEM_TOWER) {
        TRY(tower_open(&a->problem, &own, TOWER_AS_SET, SIZE_MAX, err));
    } else {
        TRY(external_open(&a->problem, &s->problem, a->threads, err));
        a->recipe.settings = *s;
        a->problem.recipe = &a->recipe;
        a->problem.recipe_size = sizeof a->recipe;
        executor_choose(&a->problem);
    }
    return describe(a, s, err);
}

Status adapter_open(Adapter **out, const Settings *s, Err *err)
{
    *out = NULL;
    Adapter *a;
    TRY_ROOM(a, 1, "a problem", err);
    a->threads = (int)threads_wanted(s->search.threads);
    const Status status = prepare(a, s, err);
    if (status == STATUS_OK)
        *out = a;
    else
        adapter_close(a);
    return status;
}

void adapter_close(Adapter *a)
{
    if (!a)
        return;
    problem_close(&a->problem);
    schema_free(&a->schema);
    free(a->order);
    free(a);
}
