#include "moga/front_confidence.h"

#include <stdlib.h>

#include "base/random.h"
#include "moga/dominance.h"

static int is_nondominated(size_t n, size_t n_obj, const double F[], size_t i)
{
    for (size_t j = 0; j < n; j++)
        if (dominates(n_obj, F + j * n_obj, F + i * n_obj))
            return 0;
    return 1;
}

Status front_confidence(size_t n, size_t n_obj, const double F[], const double error[], uint32_t seed, size_t n_asked,
                        const size_t asked[], double p[], Err *err)
{
    double *drawn = calloc(n * n_obj + 1, sizeof *drawn);
    if (!drawn)
        return fail(err, STATUS_NO_MEMORY, "no memory for draws of %zu designs", n);
    for (size_t k = 0; k < n_asked; k++)
        p[k] = 0.0;
    for (uint32_t draw = 0; draw < FRONT_DRAWS; draw++) {
        Random r = random_stream(seed, RANDOM_CONFIDENCE, 0, draw);
        for (size_t i = 0; i < n * n_obj; i++)
            drawn[i] = F[i] + error[i] * random_normal(&r);
        for (size_t k = 0; k < n_asked; k++)
            p[k] += is_nondominated(n, n_obj, drawn, asked[k]) / (double)FRONT_DRAWS;
    }
    free(drawn);
    return STATUS_OK;
}
