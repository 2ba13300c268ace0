#include "bench/search/levels.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/random.h"
#include "bench/search/families.h"
#include "moga/search.h"
#include "study/study.h"

enum { WAVES = 4, SAMPLE = 300 };

typedef struct {
    const Problem *whole;
    const Levels *levels;
    double sd[FAMILY_OBJ_MAX];
    double wave[FAMILY_OBJ_MAX][WAVES][FAMILY_VAR_MAX + 1]; /* wave vector, phase */
} World;

/* -- the cheap level ----------------------------------------------------------------------------------------------- */

static double smooth(const World *w, size_t k, const double x[])
{
    double sum = 0.0;
    for (size_t i = 0; i < WAVES; i++) {
        double phase = w->wave[k][i][FAMILY_VAR_MAX];
        for (size_t d = 0; d < w->whole->n_var; d++)
            phase += w->wave[k][i][d] * x[d];
        sum += cos(phase);
    }
    return sum * sqrt(2.0 / WAVES);
}

static void make_cheap(const World *w, const double x[], double f[])
{
    for (size_t k = 0; k < w->whole->n_obj; k++)
        f[k] = 0.8 * f[k] + w->sd[k] * (w->levels->off * smooth(w, k, x) - 3.0);
}

static void sample(const World *w, double X[], double F[])
{
    const Problem *p = w->whole;
    Random r = random_stream(1, RANDOM_TEST, 2, 0);
    for (size_t i = 0; i < SAMPLE; i++) {
        for (size_t d = 0; d < p->n_var; d++)
            X[i * p->n_var + d] = p->lower[d] + (p->upper[d] - p->lower[d]) * random_uniform(&r);
        family_evaluate(p, X + i * p->n_var, F + i * p->n_obj);
    }
}

static void draw(World *w, const double F[])
{
    const Problem *p = w->whole;
    Random r = random_stream(1, RANDOM_TEST, 3, 0);
    for (size_t k = 0; k < p->n_obj; k++) {
        double mean = 0.0, square = 0.0;
        for (size_t i = 0; i < SAMPLE; i++)
            mean += F[i * p->n_obj + k] / SAMPLE;
        for (size_t i = 0; i < SAMPLE; i++)
            square += pow(F[i * p->n_obj + k] - mean, 2.0) / SAMPLE;
        w->sd[k] = sqrt(square);
        for (size_t i = 0; i < WAVES; i++) {
            for (size_t d = 0; d < p->n_var; d++)
                w->wave[k][i][d] = 3.0 * random_normal(&r);
            w->wave[k][i][FAMILY_VAR_MAX] = 2.0 * M_PI * random_uniform(&r);
        }
    }
}

static Status world_open(World *w, const Problem *p, const Levels *levels, double **X, double **F, Err *err)
{
    *w = (World){.whole = p, .levels = levels};
    *X = calloc(SAMPLE * p->n_var, sizeof **X);
    *F = calloc(SAMPLE * p->n_obj, sizeof **F);
    if (!*X || !*F)
        return fail(err, STATUS_NO_MEMORY, "no memory for %d designs", SAMPLE);
    sample(w, *X, *F);
    draw(w, *F);
    return STATUS_OK;
}

/* -- as a problem -------------------------------------------------------------------------------------------------- */

static Status simulate(void *self, size_t worker, const Task *task, Err *err)
{
    const World *w = self;
    TRY(w->whole->simulator->simulate(w->whole->self, worker, task, err));
    if (task->part == 0)
        make_cheap(w, task->x, task->result);
    return STATUS_OK;
}

static void combine_cheap(const void *self, const void *parts, Evaluation *e)
{
    const World *w = self;
    w->whole->simulator->combine(w->whole->self, parts, e);
}

static void combine(const void *self, const void *parts, Evaluation *e)
{
    const World *w = self;
    combine_cheap(self, (const char *)parts + w->whole->part_size, e);
}

static const Simulator LEVELS = {simulate, combine, NULL};

typedef struct {
    Course *c;
    size_t row;
} Noting;

static int note(const SearchView *v, void *user)
{
    Noting *n = user;
    for (; n->row < v->n; n->row++)
        if (v->kind[n->row] != KIND_SCREENED)
            course_add(n->c, v->Y + n->row * v->n_obj,
                       v->ok[n->row] && violation_of(v->n_con, v->H + n->row * v->n_con) == 0.0);
    return 0;
}

Status run_levels(const Settings *settings, const Problem *p, const Levels *levels, Course *c, Err *err)
{
    World w;
    double *X, *F;
    StopReason reason;
    Settings s = *settings;
    Noting noting = {.c = c};
    Problem both = *p;
    Status status = world_open(&w, p, levels, &X, &F, err);
    s.search.max_evals = (long)c->n_max;
    s.search.generations = 1000000;
    SearchConfig config = study_search_config(&s);
    config.fidelity = FIDELITY_LEVELS;
    both.self = &w;
    both.simulator = &LEVELS;
    both.n_parts = 2;
    both.n_cheap = 1;
    both.cheap_cost = levels->cost;
    both.combine_cheap = combine_cheap;
    if (status == STATUS_OK)
        status = search_run(&both, &config, note, &noting, &reason, err);
    for (size_t k = 0; status == STATUS_OK && c->n < c->n_max;)
        course_add(c, F + k, 0);
    free(X);
    free(F);
    return status;
}

Status levels_agreement(const Problem *p, const Levels *levels, double *tau, Err *err)
{
    World w;
    double *X, *F, cheap[SAMPLE][FAMILY_OBJ_MAX];
    Status status = world_open(&w, p, levels, &X, &F, err);
    *tau = 0.0;
    for (size_t i = 0; status == STATUS_OK && i < SAMPLE; i++) {
        memcpy(cheap[i], F + i * p->n_obj, p->n_obj * sizeof *F);
        make_cheap(&w, X + i * p->n_var, cheap[i]);
        for (size_t j = 0; j < i; j++)
            for (size_t k = 0; k < p->n_obj; k++) {
                const double product = (cheap[i][k] - cheap[j][k]) * (F[i * p->n_obj + k] - F[j * p->n_obj + k]);
                *tau += ((product > 0.0) - (product < 0.0)) / (double)(p->n_obj * SAMPLE * (SAMPLE - 1) / 2);
            }
    }
    free(X);
    free(F);
    return status;
}
