/* tests/functions.h -- a problem whose objectives and limits are a function of the test's own. */
#pragma once

#include "check.h"

#include "evaluate/queue.h"
#include "evaluate/tasks.h"

/* One evaluation of design x (n_var), of which `draw` were made before. The function sets f (n_obj), which is minimised,
 * g (n_con) and, where it fails or the search shall end, ok and status. */
typedef struct {
    const double *x;
    size_t draw;
    double *f, *g;
    int ok;        /* 1 before */
    Status status; /* STATUS_OK before */
    Err *why;
} FunctionCall;

typedef void (*FunctionFn)(FunctionCall *q, void *user);

typedef struct {
    FunctionFn evaluate;
    void *user;
    size_t n_obj, n_con;
} Function;

/* A part is f, g and whether it is ok. */
static inline Status function_simulate(void *self, size_t worker, const Task *task, Err *why)
{
    const Function *function = self;
    double *f = task->result;
    FunctionCall q = {task->x, task->repeat, f, f + function->n_obj, 1, STATUS_OK, why};
    (void)worker;
    function->evaluate(&q, function->user);
    q.g[function->n_con] = q.ok;
    return q.status;
}

static inline void function_combine(const Problem *p, size_t n, const void *parts, Evaluation *e)
{
    (void)n;
    const Function *function = p->self;
    const double *f = parts, *g = f + function->n_obj;
    memcpy(e->f, f, function->n_obj * sizeof *f);
    if (function->n_con > 0)
        memcpy(e->extra, g, function->n_con * sizeof *g);
    if (g[function->n_con] == 0.0)
        evaluation_set_outcome(e, OUTCOME_ERROR, "fails");
}

static inline void function_judge(const Evaluation *e, double f[], double g[], const void *user)
{
    const Function *function = user;
    memcpy(f, e->f, function->n_obj * sizeof *f);
    if (function->n_con > 0)
        memcpy(g, e->extra, function->n_con * sizeof *g);
}

static const Simulator FUNCTION = {.simulate = function_simulate, .combine = function_combine};

/* One worker, the client itself. `function` must stay where it is. */
static inline Problem function_problem(Function *function, size_t n_var, size_t n_obj, size_t n_con,
                                       const double *lower, const double *upper, FunctionFn evaluate, void *user)
{
    *function = (Function){evaluate, user, n_obj, n_con};
    return (Problem){.n_var = n_var,
                     .n_obj = n_obj,
                     .n_con = n_con,
                     .n_extra = n_con,
                     .lower = lower,
                     .upper = upper,
                     .judge = function_judge,
                     .user = function,
                     .simulator = &FUNCTION,
                     .self = function,
                     .n_parts = 1,
                     .part_size = (n_obj + n_con + 1) * sizeof(double),
                     .n_workers = 1};
}

/* n evaluations of before, whose numbers begin with first_id; G and generation may be NULL. */
static inline EvaluationTable evaluations_of(const Problem *p, long first_id, size_t n, const double X[],
                                             const double F[], const double G[], const unsigned char ok[],
                                             const unsigned char kind[], const size_t generation[])
{
    EvaluationTable t = evaluation_table(p->n_var, p->n_obj, p->n_con);
    for (size_t i = 0; i < n; i++) {
        const Evaluation e = {.id = first_id + (long)i,
                              .generation = generation ? (long)generation[i] : 0,
                              .kind = (EvaluationKind)kind[i],
                              .outcome = ok[i] ? OUTCOME_OK : OUTCOME_ERROR,
                              .x = (double *)X + i * p->n_var,
                              .f = (double *)F + i * p->n_obj,
                              .extra = G ? (double *)G + i * p->n_con : NULL};
        CHECK_OK(evaluation_table_append(&t, &e, &err), &err);
    }
    return t;
}
