#include "report/convergence.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/random.h"
#include "moga/dominance.h"
#include "moga/hypervolume.h"
#include "run/saved.h"

enum { SAMPLES = 20000, EXACT_MAX = 3 };
static const double MARGIN = 1.1; /* so that the worst of each objective still counts */

/* ---- the volume ------------------------------------------------------------------------------------------------ */

static int is_finite(size_t n_obj, const double f[])
{
    int finite = 1;
    for (size_t k = 0; k < n_obj; k++)
        finite = finite && isfinite(f[k]);
    return finite;
}

/* Keeps only the nondominated of `kept` and f; returns how many there are. */
static size_t keep(size_t n, size_t n_obj, double kept[], const double f[])
{
    size_t m = 0;
    for (size_t i = 0; i < n; i++)
        if (dominates(n_obj, kept + i * n_obj, f) || memcmp(kept + i * n_obj, f, n_obj * sizeof *f) == 0)
            return n;
    for (size_t i = 0; i < n; i++)
        if (!dominates(n_obj, f, kept + i * n_obj))
            memmove(kept + m++ * n_obj, kept + i * n_obj, n_obj * sizeof *f);
    memcpy(kept + m * n_obj, f, n_obj * sizeof *f);
    return m + 1;
}

/* Samples that f reaches are taken off the list; returns how many are left. */
static size_t reach(size_t n_left, size_t n_obj, double samples[], const double f[])
{
    for (size_t s = 0; s < n_left;) {
        size_t k = 0;
        while (k < n_obj && f[k] <= samples[s * n_obj + k])
            k++;
        if (k < n_obj)
            s++;
        else
            memmove(samples + s * n_obj, samples + --n_left * n_obj, n_obj * sizeof *samples);
    }
    return n_left;
}

static Status allocate(size_t n, Convergence *c, Err *err)
{
    c->simulated = calloc(3 * (n + 1), sizeof *c->simulated);
    if (!c->simulated)
        return fail(err, STATUS_NO_MEMORY, "no memory for %zu generations", n);
    c->volume = c->simulated + n + 1;
    c->standard_error = c->volume + n + 1;
    return STATUS_OK;
}

static Status follow(size_t n, size_t n_obj, const double generation[], const double F[], const double ideal[],
                     const double span[], double work[], Convergence *c, Err *err)
{
    const int exact = n_obj <= EXACT_MAX;
    double f[OBJECTIVES_MAX], reference[OBJECTIVES_MAX];
    Random random = random_stream(1, RANDOM_HYPERVOLUME, 0, 0);
    size_t n_kept = 0, n_left = SAMPLES;
    for (size_t i = 0; !exact && i < SAMPLES * n_obj; i++)
        work[i] = MARGIN * random_uniform(&random);
    for (size_t k = 0; k < n_obj; k++)
        reference[k] = MARGIN;
    for (size_t i = 0; i < n; i++) {
        for (size_t k = 0; k < n_obj; k++)
            f[k] = (F[i * n_obj + k] - ideal[k]) / span[k];
        const int reaches = is_finite(n_obj, f);
        c->n_failed += !reaches;
        if (reaches && exact)
            n_kept = keep(n_kept, n_obj, work, f);
        else if (reaches)
            n_left = reach(n_left, n_obj, work, f);
        if (i + 1 < n && !(generation[i + 1] > generation[i]))
            continue;
        Hypervolume v = {.volume = 1 - (double)n_left / SAMPLES};
        v.standard_error = sqrt(v.volume * (1 - v.volume) / SAMPLES);
        if (exact)
            TRY(hypervolume_exact(n_kept, n_obj, work, reference, &v, err));
        c->simulated[c->n] = (double)(i + 1);
        c->volume[c->n] = exact ? v.volume / pow(MARGIN, (double)n_obj) : v.volume;
        c->standard_error[c->n++] = v.standard_error;
    }
    return STATUS_OK;
}

Status convergence_of(size_t n, size_t n_obj, const double generation[], const double F[], const double ideal[],
                      const double span[], Convergence *out, Err *err)
{
    *out = (Convergence){.n_evaluated = n};
    double *work = calloc((n_obj <= EXACT_MAX ? n + 1 : SAMPLES) * n_obj, sizeof *work);
    Status status = work ? allocate(n, out, err) : fail(err, STATUS_NO_MEMORY, "no memory for a hypervolume");
    if (status == STATUS_OK)
        status = follow(n, n_obj, generation, F, ideal, span, work, out, err);
    free(work);
    if (status != STATUS_OK)
        convergence_free(out);
    return status;
}

/* ---- the run --------------------------------------------------------------------------------------------------- */

/* What generations have finished; designs that failed or break limits of the user reach nothing. */
static size_t take_rows(const Saved *h, double generation[], double F[])
{
    const size_t n_obj = h->schema.n_obj;
    size_t n = 0;
    for (size_t i = 0; i < h->n; i++) {
        const SavedRow *row = &h->row[i];
        if (row->kind == KIND_UNFINISHED)
            continue;
        generation[n] = (double)row->generation;
        for (size_t k = 0; k < n_obj; k++)
            F[n * n_obj + k] =
                row->ok && !(row->violation > 0) ? schema_objective(&h->schema, k)->sense * h->F[i * n_obj + k] : NAN;
        n++;
    }
    return n;
}

static Status follow_run(const Front *front, const Saved *h, Convergence *out, Err *err)
{
    double ideal[OBJECTIVES_MAX], span[OBJECTIVES_MAX];
    double *generation = calloc(h->n * (1 + front->n_obj) + 1, sizeof *generation);
    if (!generation)
        return fail(err, STATUS_NO_MEMORY, "no memory for %zu evaluations", h->n);
    const size_t n = take_rows(h, generation, generation + h->n);
    front_box(front, ideal, span);
    const Status status = convergence_of(n, front->n_obj, generation, generation + h->n, ideal, span, out, err);
    out->n_failed = h->n_failed;
    free(generation);
    return status;
}

Status convergence_read(const Front *front, const char *folder, Convergence *out, Err *err)
{
    char path[PATH_MAX];
    Saved h;
    memset(out, 0, sizeof *out);
    if (front->n == 0 || !saved_path(folder, path, sizeof path))
        return STATUS_OK;
    TRY(saved_read(&h, folder, err));
    const Status status = follow_run(front, &h, out, err);
    saved_free(&h);
    return status;
}

void convergence_free(Convergence *c)
{
    free(c->simulated);
    memset(c, 0, sizeof *c);
}
