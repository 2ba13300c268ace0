#include "evaluate/textbook.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/random.h"

void textbook_dtlz2(size_t n_var, size_t n_obj, const double x[], double f[])
{
    double g = 0.0;
    for (size_t d = n_obj - 1; d < n_var; d++)
        g += (x[d] - 0.5) * (x[d] - 0.5);
    for (size_t k = 0; k < n_obj; k++) {
        f[k] = 1.0 + g;
        for (size_t d = 0; d + k + 1 < n_obj; d++)
            f[k] *= cos(x[d] * M_PI_2);
        if (k > 0)
            f[k] *= sin(x[n_obj - 1 - k] * M_PI_2);
    }
}

/* Huband et al., table XI: A minima, hill size B, global minimum at C. */
static double s_multi(double y)
{
    static const double A = 30.0, B = 10.0, C = 0.35;
    const double off = fabs(y - C) / (2.0 * (floor(C - y) + C));
    const double t = (1.0 + cos((4.0 * A + 2.0) * M_PI * (0.5 - off)) + 4.0 * B * off * off) / (B + 2.0);
    return fmin(fmax(t, 0.0), 1.0);
}

static double mean_of(size_t first, size_t end, const double t[])
{
    double sum = 0.0;
    for (size_t i = first; i < end; i++)
        sum += t[i] / (double)(end - first);
    return sum;
}

void textbook_wfg4(size_t n_var, size_t n_obj, size_t n_position, const double z[], double f[])
{
    const size_t group = n_position / (n_obj - 1);
    double t[TEXTBOOK_VAR_MAX], p[TEXTBOOK_OBJ_MAX];
    for (size_t i = 0; i < n_var; i++)
        t[i] = s_multi(z[i] / (2.0 * (double)(i + 1)));
    for (size_t k = 0; k + 1 < n_obj; k++)
        p[k] = mean_of(k * group, (k + 1) * group, t);
    const double far = mean_of(n_position, n_var, t);
    for (size_t k = 0; k < n_obj; k++) {
        double h = 1.0;
        for (size_t d = 0; d + k + 1 < n_obj; d++)
            h *= sin(p[d] * M_PI_2);
        if (k > 0)
            h *= cos(p[n_obj - 1 - k] * M_PI_2);
        f[k] = far + 2.0 * (double)(k + 1) * h;
    }
}

/* 2 (n_obj - 1) position variables, or as much of that as leaves a variable for the distance. */
static void wfg4(size_t n_var, size_t n_obj, const double z[], double f[])
{
    const size_t once = n_obj - 1;
    textbook_wfg4(n_var, n_obj, 2 * once < n_var ? 2 * once : once, z, f);
}

static const Textbook PROBLEMS[] = {{"dtlz2", 0, textbook_dtlz2}, {"wfg4", 1, wfg4}};

const Textbook *textbook(size_t i)
{
    return i < sizeof PROBLEMS / sizeof *PROBLEMS ? &PROBLEMS[i] : NULL;
}

static double textbook_upper(const Textbook *t, size_t j)
{
    return t->widening ? 2.0 * (double)(j + 1) : 1.0;
}

/* -- as a simulator ------------------------------------------------------------------------------------------------ */

typedef struct {
    const Textbook *function;
    size_t n_var, n_obj;
    double noise;
    uint32_t seed;
    double lower[TEXTBOOK_VAR_MAX], upper[TEXTBOOK_VAR_MAX];
} Exercise;

static Status simulate(void *self, size_t worker, const Task *task, Err *err)
{
    const Exercise *e = self;
    double *f = task->result;
    (void)worker;
    (void)err;
    Random noise = random_stream(e->seed, RANDOM_NOISE, 0, (uint32_t)(task->id - 1));
    e->function->evaluate(e->n_var, e->n_obj, task->x, f);
    for (size_t k = 0; e->noise > 0.0 && k < e->n_obj; k++)
        f[k] *= 1.0 + e->noise * random_normal(&noise);
    return STATUS_OK;
}

static void combine(const Problem *p, size_t n, const void *parts, Evaluation *e)
{
    (void)n;
    memcpy(e->f, parts, p->n_obj * sizeof *e->f);
    e->seconds = 0.0;
    e->replicates = 1;
}

static const Simulator TEXTBOOK = {simulate, combine, free};

Status textbook_open(Problem *p, const ProblemOptions *o, uint32_t seed, Err *err)
{
    const long n_var = o->variables, m = o->objectives;
    if (n_var > TEXTBOOK_VAR_MAX || m > TEXTBOOK_OBJ_MAX)
        return fail(err, STATUS_BAD_DATA, "problem.variables: a textbook problem has at most %d, and %d objectives",
                    TEXTBOOK_VAR_MAX, TEXTBOOK_OBJ_MAX);
    if (m < 2 || n_var < m)
        return fail(err, STATUS_BAD_DATA,
                    "problem.objectives: a textbook problem wants 2 at least and no more than %ld", n_var);
    Exercise *e = calloc(1, sizeof *e);
    if (!e)
        return fail(err, STATUS_NO_MEMORY, "no memory for a problem");
    e->function = textbook((size_t)(o->kind - PROBLEM_TEXTBOOK));
    e->n_var = (size_t)n_var;
    e->n_obj = (size_t)m;
    e->noise = o->noise;
    e->seed = seed;
    for (size_t j = 0; j < e->n_var; j++)
        e->upper[j] = textbook_upper(e->function, j);
    *p = (Problem){.n_var = e->n_var,
                   .n_obj = e->n_obj,
                   .lower = e->lower,
                   .upper = e->upper,
                   .simulator = &TEXTBOOK,
                   .self = e,
                   .n_parts = 1,
                   .part_size = e->n_obj * sizeof(double),
                   .n_workers = 1};
    return STATUS_OK;
}

void textbook_exact(const Problem *p, const double x[], double f[])
{
    const Exercise *e = p->self;
    e->function->evaluate(e->n_var, e->n_obj, x, f);
}
