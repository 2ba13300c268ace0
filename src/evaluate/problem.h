/* evaluate/problem.h -- the optimization problem, its simulator and its executor.
 *
 *   minimise f(x),  g(x) <= 0,  lower <= x <= upper
 *
 * A variable is real; real, and searched on the scale of its logarithm; a whole number; a choice, whose numbers 0, 1,
 * ... stand for words and have no order; or one of the values that are sold.
 *
 * One design is n_parts simulations (replicates under every record, say), each a task that any worker can do:
 *
 *   task -> Simulator.simulate -> part (part_size bytes)      all parts of a design -> Simulator.combine -> Evaluation
 *
 * The first n_cheap parts that are taken may be a cheap level of the problem, an approximation of f and g (the first
 * replicates, or a few records).
 *
 * A part is a plain record of fixed size, without pointers: it could come from another machine. What the simulator
 * answers is natural (units and signs of the files); `judge` makes the minimised f and the g of it.
 *
 * Threads  simulate is called by several threads at once, each with its own `worker` (0 .. n_workers-1); combine by any
 *          thread, for one design at a time. judge and repair: pure
 * Errors   a simulation that fails is information about a design, told by its part; Status is for what ends everything.
 *          Of several faults the one of the task asked for first is reported */
#pragma once

#include "base/stat.h"
#include "evaluate/evaluation.h"

typedef struct Pool Pool;
typedef struct Queue Queue;
typedef struct Problem Problem;

enum { CONSTRAINTS_MAX = 100 }; /* that a simulator may answer, beside the user's limits */

typedef enum { VARIABLE_REAL, VARIABLE_LOG, VARIABLE_WHOLE, VARIABLE_CHOICE, VARIABLE_STEPPED } VariableKind;

/* Values that are sold, ascending: those of a list, or multiples of a step. */
typedef struct {
    size_t n;
    const double *at;   /* (n) NULL: (first + i) step */
    double first, step; /* first: a whole number; step: 1e-4 at least */
} Steps;

typedef struct {
    /* Asked from any thread before each task, and during those that take seconds; 0: nothing more is begun. NULL: 1 */
    int (*go_on)(void *user);
    /* A design is finished; calls exclude each other, e holds during the call. A fault ends everything. NULL:
     * nothing */
    Status (*done)(const Evaluation *e, void *user, Err *err);
    void *user;
} Observer;

/* Whether simulations may go on. NULL: they may. */
static inline int goes_on(const Observer *o)
{
    return !o || !o->go_on || o->go_on(o->user);
}

/* A variant to simulate in place of the design; the simulator knows its meaning. {0}: the design as it is. */
typedef struct {
    int kind, is_brief;
    int is_full; /* more of the result is wanted than combine needs: a larger part */
    size_t scene;
    double device[3];
} Variant;

typedef struct {
    long id;       /* of the request, counted in the order of asking: keys random streams */
    size_t part;   /* 0 .. n_parts-1 */
    size_t repeat; /* evaluations of the same design that there are already: its replicates go on behind theirs */
    Variant variant;
    const double *x;          /* (n_var) */
    void *result;             /* where the part goes, Problem.part_size bytes */
    size_t size;              /* so many */
    const Observer *observer; /* where it does not go on they end soon, with STATUS_STOPPED */
    void *slot;               /* the queue's */
} Task;

typedef struct {
    Status (*simulate)(void *self, size_t worker, const Task *task, Err *err);
    /* From the first n parts, in the order of their numbers: outcome, f, sd, extra, seconds, replicates of e; x is
     * there. */
    void (*combine)(const Problem *p, size_t n, const void *parts, Evaluation *e);
    void (*close)(void *self); /* NULL is fine */
    /* In the place of simulate: workers that are elsewhere (evaluate/pool.h), one for each of ours; NULL, or none is
     * returned: there are none */
    Pool *(*pool)(void *self);
} Simulator;

enum { TASKS_MAX = 64 };

/* Who does the tasks in the place of this process, which has a thread for each of several workers; where there is one,
 * the client does them itself while it waits. */
typedef struct {
    Status (*start)(void **self, const Problem *p, size_t *n_workers, Err *err);
    void (*stop)(void *self);   /* none is under way any more */
    const Simulator *simulator; /* asked by two threads for each of n_workers, by one where that is 1 */
} Executor;

/* Minimised f (n_obj) and g (n_con) of an evaluation. */
typedef void (*JudgeFn)(const Evaluation *e, double f[], double g[], const void *user);

/* Moves x into the set of designs that can be built at all (t_top <= t_base, say). */
typedef void (*RepairFn)(double x[], const void *self);

struct Problem {
    size_t n_var, n_obj, n_con, n_extra;
    const double *lower, *upper; /* (n_var) whole ones of whole numbers; of a choice 0 and the last word */
    const VariableKind *kind;    /* (n_var) NULL: all are real */
    const Steps *steps;   /* (n_var) of those that are VARIABLE_STEPPED, whose bounds are the ends; NULL: none is */
    RepairFn repair;      /* NULL: the box is all */
    JudgeFn judge;        /* NULL: f as it is, and no g */
    const void *user;     /* of judge */
    const double *aspire; /* (n_obj) minimised aspiration levels, NAN: of that objective none; NULL: of none */
    int is_noisy;         /* the same design evaluated again gives another answer */
    const Simulator *simulator;
    void *self; /* of simulator and repair */
    size_t n_parts, part_size, n_workers;
    size_t n_cheap;      /* 0: there is no cheap level */
    const size_t *order; /* (n_parts) in which parts are taken, of the cheap level combined too; NULL: as numbered */
    const Executor *executor; /* NULL: this process */
    const void
        *recipe; /* (recipe_size) bytes without pointers, of which another process opens the same problem; NULL: none */
    size_t recipe_size;
    uint64_t inputs; /* hash of the files that it was opened from; 0: none, or not known */
    Observer observer;
};

/* Costs of evaluations, in integers, so that sums are exact. */
typedef struct {
    size_t cheap, rest, whole; /* the cheap level, what is left to the whole evaluation, one asked for at once */
} LevelCosts;

/* Sum of max(0, g). */
static inline double violation_of(size_t n_con, const double g[])
{
    double sum = 0.0;
    for (size_t c = 0; c < n_con; c++)
        sum += MAX_OF(g[c], 0.0);
    return sum;
}

static inline VariableKind problem_kind(const Problem *p, size_t d)
{
    return p->kind ? p->kind[d] : VARIABLE_REAL;
}

static inline int problem_is_discrete(const Problem *p, size_t d)
{
    return problem_kind(p, d) >= VARIABLE_WHOLE;
}

static inline double steps_at(const Steps *s, size_t i)
{
    return s->at ? s->at[i] : round(1e9 * (s->first + (double)i) * s->step) / 1e9; /* 0.415 as it is read */
}

static inline size_t steps_nearest(const Steps *s, double x)
{
    size_t i = 0;
    if (!s->at)
        return (size_t)fmin(fmax(round(x / s->step) - s->first, 0.0), (double)(s->n - 1));
    while (i + 1 < s->n && x > 0.5 * (s->at[i] + s->at[i + 1]))
        i++;
    return i;
}

/* Into the box and the set of designs that can be built; 0 has no sign, as in the run that it is stored in. */
static inline void problem_repair(const Problem *p, double x[])
{
    for (size_t d = 0; d < p->n_var; d++) {
        const double whole = problem_is_discrete(p, d) ? round(x[d]) : x[d];
        x[d] = problem_kind(p, d) == VARIABLE_STEPPED ? steps_at(&p->steps[d], steps_nearest(&p->steps[d], x[d]))
                                                      : fmin(fmax(whole, p->lower[d]), p->upper[d]);
        x[d] += 0.0;
    }
    if (p->repair)
        p->repair(x, p->self);
}

/* The box as the unit cube; a variable without width is 0 there. */
static inline double problem_to_unit(const Problem *p, size_t d, double x)
{
    const double lower = p->lower[d], upper = p->upper[d];
    if (!(upper > lower))
        return 0.0;
    return problem_kind(p, d) == VARIABLE_LOG ? (log(x) - log(lower)) / (log(upper) - log(lower))
                                              : (x - lower) / (upper - lower);
}

static inline void problem_to_cube(const Problem *p, const double x[], double u[])
{
    for (size_t d = 0; d < p->n_var; d++)
        u[d] = problem_to_unit(p, d, x[d]);
}

static inline double problem_from_unit(const Problem *p, size_t d, double u)
{
    const double lower = p->lower[d], upper = p->upper[d];
    const double x = problem_kind(p, d) == VARIABLE_LOG ? exp(log(lower) + u * (log(upper) - log(lower)))
                                                        : lower + u * (upper - lower);
    return fmin(fmax(x, lower), upper);
}

/* Variable d at 0 <= u <= 1 of an even spread: every whole number, word and value that is sold has the same share. */
static inline double problem_spread(const Problem *p, size_t d, double u)
{
    const double lower = p->lower[d], upper = p->upper[d];
    if (problem_kind(p, d) == VARIABLE_STEPPED)
        return steps_at(&p->steps[d], (size_t)fmin(u * (double)p->steps[d].n, (double)(p->steps[d].n - 1)));
    return problem_is_discrete(p, d) ? fmin(floor(lower + u * (upper - lower + 1.0)), upper)
                                     : problem_from_unit(p, d, u);
}

static inline void problem_close(Problem *p)
{
    if (p->simulator && p->simulator->close)
        p->simulator->close(p->self);
    *p = (Problem){0};
}

static inline void problem_judge(const Problem *p, const Evaluation *e, double f[], double g[])
{
    if (p->judge)
        p->judge(e, f, g, p->user);
    else
        copy_values(p->n_obj, e->f, f);
}
