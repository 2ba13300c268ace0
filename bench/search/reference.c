#include "bench/search/reference.h"

#include <math.h>
#include <string.h>

#include "base/random.h"
#include "bench/search/families.h"
#include "moga/directions.h"
#include "base/dominance.h"

enum { MOVES = 500, STARTS = 4, STEPS_PER_VARIABLE = 100 };

typedef struct {
    double x[FAMILY_VAR_MAX], f[FAMILY_OBJ_MAX], violation, sum;
} Point;

static void measure(const Problem *p, const double w[], Point *at)
{
    at->violation = family_evaluate(p, at->x, at->f);
    at->sum = 0.0;
    for (size_t k = 0; k < p->n_obj; k++)
        at->sum += (w[k] + 1e-3) * at->f[k];
}

static int is_better(const Point *a, const Point *b)
{
    return a->violation != b->violation ? a->violation < b->violation : a->sum < b->sum;
}

static void improve(const Problem *p, size_t fixed, const double w[], Random *random, Point *best)
{
    double step = 0.1;
    for (size_t i = 0; i < STEPS_PER_VARIABLE * p->n_var; i++) {
        Point next = *best;
        for (size_t d = fixed; d < p->n_var; d++)
            next.x[d] = fmin(fmax(next.x[d] + step * (p->upper[d] - p->lower[d]) * random_normal(random), p->lower[d]),
                             p->upper[d]);
        problem_repair(p, next.x);
        measure(p, w, &next);
        const int better = is_better(&next, best);
        step = fmin(step * (better ? exp(0.8) : exp(-0.2)), 0.3);
        if (step < 1e-6)
            step = 0.1;
        if (better)
            *best = next;
    }
}

/* From the zero where that counts, else from designs that do, drawn at random. */
static Point least_from(const Problem *p, size_t fixed, const double w[], Random *random, const Point *zero)
{
    Point least = *zero;
    for (int start = 0; start < (zero->violation > 0.0 ? STARTS : 1); start++) {
        Point at = *zero;
        while (at.violation > 0.0) {
            for (size_t d = fixed; d < p->n_var; d++)
                at.x[d] = problem_spread(p, d, random_uniform(random));
            measure(p, w, &at);
        }
        improve(p, fixed, w, random, &at);
        if (is_better(&at, &least))
            least = at;
    }
    return least;
}

/* Other places on the front may dominate it, where that is in pieces: first far away, then near. */
static void move_along(const Problem *p, size_t fixed, Random *random, Point *best)
{
    static const double none[FAMILY_OBJ_MAX] = {0};
    for (size_t i = 0; i < MOVES; i++) {
        Point next = *best;
        for (size_t d = 0; d < fixed; d++)
            next.x[d] += 0.5 * exp(-6.0 * (double)i / MOVES) * random_normal(random);
        for (size_t d = 0; d < fixed; d++)
            next.x[d] = fmin(fmax(next.x[d], p->lower[d]), p->upper[d]);
        measure(p, none, &next);
        if (next.violation <= best->violation && dominates(p->n_obj, next.f, best->f))
            *best = next;
    }
}

static void drop_dominated(Course *c)
{
    const size_t m = c->n_obj;
    size_t n = 0;
    for (size_t i = 0; i < c->n; i++)
        for (size_t j = 0; j < c->n && c->counts[i]; j++)
            if (c->counts[j] && dominates(m, c->F + j * m, c->F + i * m))
                c->counts[i] = 0;
    for (size_t i = 0; i < c->n; i++)
        if (c->counts[i]) {
            memmove(c->F + n * m, c->F + i * m, m * sizeof *c->F);
            c->counts[n++] = 1;
        }
    c->n = n;
}

Status reference_make(const Problem *p, Course *c, Err *err)
{
    Directions directions;
    TRY(directions_spread(&directions, p->n_obj, REFERENCES, err));
    const Status status = course_create(c, REFERENCES, p->n_obj, err);
    for (size_t i = 0; status == STATUS_OK && i < REFERENCES; i++) {
        const double *w = directions.W + i * p->n_obj;
        Random random = random_stream(1, RANDOM_TEST, 2, (uint32_t)i);
        Point at;
        const size_t fixed = family_place(p, w, (double)i / (REFERENCES - 1), at.x);
        measure(p, w, &at);
        if (fixed == 0 || at.violation > 0.0)
            at = least_from(p, fixed, w, &random, &at);
        move_along(p, fixed, &random, &at);
        course_add(c, at.f, at.violation == 0.0);
    }
    directions_free(&directions);
    if (status == STATUS_OK)
        drop_dominated(c);
    return status;
}
