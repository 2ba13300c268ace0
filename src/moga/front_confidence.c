#include "moga/front_confidence.h"

#include <stdlib.h>

#include "base/random.h"
#include "moga/dominance.h"

/* Of the k-th design asked for: of[first[k]..first[k + 1]), the designs that may dominate it in a draw. */
typedef struct {
    size_t n_max, *first, *of;
} Rivals;

/* Not where it is worse in an objective by six standard deviations of the difference (1e-9). */
static int may_dominate(size_t n_obj, const double f[], const double e[], const double other_f[],
                        const double other_e[])
{
    for (size_t k = 0; k < n_obj; k++) {
        const double worse = f[k] - other_f[k];
        if (worse > 0.0 && worse * worse > 36.0 * (e[k] * e[k] + other_e[k] * other_e[k]))
            return 0;
    }
    return 1;
}

static Status add(Rivals *r, size_t n, size_t j, Err *err)
{
    if (n == r->n_max) {
        size_t *more = realloc(r->of, (2 * n + 1024) * sizeof *more);
        if (!more)
            return fail(err, STATUS_NO_MEMORY, "no memory for %zu pairs of designs", 2 * n);
        r->of = more;
        r->n_max = 2 * n + 1024;
    }
    r->of[n] = j;
    return STATUS_OK;
}

static Status find_rivals(Rivals *r, size_t n, size_t n_obj, const double F[], const double error[], size_t n_asked,
                          const size_t asked[], Err *err)
{
    size_t count = 0;
    for (size_t k = 0; k < n_asked; k++) {
        const size_t i = asked[k] * n_obj;
        r->first[k] = count;
        for (size_t j = 0; j < n; j++)
            if (j != asked[k] && may_dominate(n_obj, F + j * n_obj, error + j * n_obj, F + i, error + i))
                TRY(add(r, count++, j, err));
    }
    r->first[n_asked] = count;
    return STATUS_OK;
}

static int is_nondominated(const Rivals *r, size_t k, size_t n_obj, const double F[], size_t i)
{
    for (size_t at = r->first[k]; at < r->first[k + 1]; at++)
        if (dominates(n_obj, F + r->of[at] * n_obj, F + i * n_obj))
            return 0;
    return 1;
}

Status front_confidence(size_t n, size_t n_obj, const double F[], const double error[], uint32_t seed, size_t n_asked,
                        const size_t asked[], double p[], Err *err)
{
    double *drawn = calloc(n * n_obj + 1, sizeof *drawn);
    Rivals r = {.first = calloc(n_asked + 1, sizeof *r.first)};
    Status status = drawn && r.first ? find_rivals(&r, n, n_obj, F, error, n_asked, asked, err)
                                     : fail(err, STATUS_NO_MEMORY, "no memory for draws of %zu designs", n);
    for (size_t k = 0; k < n_asked; k++)
        p[k] = 0.0;
    for (uint32_t draw = 0; status == STATUS_OK && draw < FRONT_DRAWS; draw++) {
        Random random = random_stream(seed, RANDOM_CONFIDENCE, 0, draw);
        for (size_t i = 0; i < n * n_obj; i++)
            drawn[i] = F[i] + error[i] * random_normal(&random);
        for (size_t k = 0; k < n_asked; k++)
            p[k] += is_nondominated(&r, k, n_obj, drawn, asked[k]) / (double)FRONT_DRAWS;
    }
    free(drawn);
    free(r.first);
    free(r.of);
    return status;
}
