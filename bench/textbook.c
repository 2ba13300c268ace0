#include "bench/textbook.h"

#include "base/random.h"
#include "base/text.h"
#include "evaluate/kinds.h"

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
    VariableKind kind[TEXTBOOK_VAR_MAX];
    double lower[2 * TEXTBOOK_VAR_MAX], *upper; /* behind them */
} Exercise;

/* Where in the width of its variable a number of another kind stands. */
static double share_of(const Exercise *e, size_t j, double x)
{
    const long words = (long)e->upper[j] + 1, stride = words % 3 == 0 ? 4 : 3;
    if (e->kind[j] == VARIABLE_LOG)
        return log(x / e->lower[j]) / log(e->upper[j] / e->lower[j]);
    if (e->kind[j] == VARIABLE_CHOICE)
        return words > 1 ? (double)((long)x * stride % words) / (double)(words - 1) : 0.0;
    return x / e->upper[j];
}

static void evaluate(const Exercise *e, const double x[], double f[])
{
    double real[TEXTBOOK_VAR_MAX];
    for (size_t j = 0; j < e->n_var; j++)
        real[j] = e->kind[j] == VARIABLE_REAL ? x[j] : share_of(e, j, x[j]) * textbook_upper(e->function, j);
    e->function->evaluate(e->n_var, e->n_obj, real, f);
}

static Status simulate(void *self, size_t worker, const Task *task, Err *err)
{
    const Exercise *e = self;
    double *f = task->result;
    (void)worker;
    (void)err;
    Random noise = random_stream(e->seed, RANDOM_NOISE, 0, (uint32_t)(task->id - 1));
    evaluate(e, task->x, f);
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

static void judge(const Evaluation *e, double f[], double g[], const void *user)
{
    (void)g;
    memcpy(f, e->f, ((const Exercise *)user)->n_obj * sizeof *f);
}

static const Simulator TEXTBOOK = {.simulate = simulate, .combine = combine, .close = free};

static Status set_variables(Exercise *e, const char *kinds, Err *err)
{
    Steps *lists;
    e->upper = e->lower + e->n_var;
    for (size_t j = 0; j < e->n_var; j++) {
        e->lower[j] = 1.0;
        e->upper[j] = 10.0;
    }
    const Status status = kinds_read(kinds, e->n_var, e->kind, e->lower, &lists, err);
    free(lists);
    TRY(status);
    for (size_t j = 0; j < e->n_var; j++) {
        if (e->kind[j] == VARIABLE_STEPPED)
            return bad_data(err, "a textbook problem has no lists of numbers");
        if (e->kind[j] != VARIABLE_CHOICE)
            e->lower[j] = e->kind[j] == VARIABLE_LOG ? 1e-3 : 0.0;
        if (e->kind[j] <= VARIABLE_LOG)
            e->upper[j] = e->kind[j] == VARIABLE_LOG ? 1.0 : textbook_upper(e->function, j);
    }
    return STATUS_OK;
}

Status textbook_open(Problem *p, const TextbookOptions *o, Err *err)
{
    const char *names[N_OF(PROBLEMS)];
    for (size_t k = 0; k < N_OF(PROBLEMS); k++)
        names[k] = PROBLEMS[k].name;
    const size_t i = index_of_word(o->name, names, N_OF(PROBLEMS));
    if (i == N_OF(PROBLEMS))
        return fail_no_word(err, STATUS_USAGE, "problem", o->name, "problem", names, N_OF(PROBLEMS));
    if (o->n_var > TEXTBOOK_VAR_MAX || o->n_obj > TEXTBOOK_OBJ_MAX || o->n_obj < 2 || o->n_var < o->n_obj)
        return bad_data(err, "a textbook problem has 2 to %d objectives and up to %d variables, no fewer",
                        TEXTBOOK_OBJ_MAX, TEXTBOOK_VAR_MAX);
    Exercise *e;
    TRY_ROOM(e, 1, "a problem", err);
    *e = (Exercise){&PROBLEMS[i], o->n_var, o->n_obj, o->noise, o->seed, {0}, {0}, NULL};
    const Status status = set_variables(e, o->kinds, err);
    if (status != STATUS_OK) {
        free(e);
        return status;
    }
    *p = (Problem){.n_var = e->n_var,
                   .n_obj = e->n_obj,
                   .lower = e->lower,
                   .upper = e->upper,
                   .kind = kinds_are_real(o->kinds) ? NULL : e->kind,
                   .judge = judge,
                   .user = e,
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
    evaluate(e, x, f);
}
