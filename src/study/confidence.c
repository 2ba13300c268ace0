#include "study/confidence.h"

#include <math.h>
#include <stdlib.h>

#include "moga/front_confidence.h"
#include "settings/options.h"

static int counts(const Run *run, size_t i)
{
    const Evaluation *e = &run->table.row[i];
    return e->id < POLISHED_FIRST && e->kind != KIND_UNFINISHED && e->kind != KIND_REPEAT && e->kind != KIND_SCREENED &&
           run->place[i].ok && !(e->violation > 0.0);
}

/* Designs that keep the limits, with minimised objectives and their standard errors. Left out are those whose error is not
 * known: one simulation of theirs failed, and the search has taken them off the front; or none was repeated at all. */
typedef struct {
    size_t n;
    double *F, *error; /* (n, n_obj) */
    size_t *place;     /* (table.n) of a row among the n, from 1; 0: left out */
} Known;

static int gather_one(const Run *run, size_t i, Known *known)
{
    const size_t m = run->schema.n_obj, at = known->n * m;
    const Evaluation *e = &run->table.row[i];
    int is_known = counts(run, i) && e->replicates > 0;
    for (size_t k = 0; k < m && is_known; k++) {
        known->F[at + k] = schema_objective(&run->schema, k)->sense * run->F[i * m + k];
        known->error[at + k] = e->sd[k] / sqrt((double)e->replicates);
        is_known = known->error[at + k] >= 0.0;
    }
    return is_known;
}

static void gather_errors(const Run *run, Known *known)
{
    for (size_t i = 0; schema_is_noisy(run->settings) && i < run->table.n; i++)
        if (gather_one(run, i, known))
            known->place[i] = ++known->n;
}

static Status know(const Run *run, Known *known, Err *err)
{
    const size_t m = run->schema.n_obj, n = run->table.n;
    known->F = calloc(2 * n * m + 1, sizeof *known->F);
    known->place = calloc(n + 1, sizeof *known->place);
    if (!known->F || !known->place)
        return fail(err, STATUS_NO_MEMORY, "no memory for %zu designs", n);
    known->error = known->F + n * m;
    gather_errors(run, known);
    return STATUS_OK;
}

static void forget(Known *known)
{
    free(known->F);
    free(known->place);
}

static Status draw(const Run *run, const Known *known, size_t n, const size_t rows[], size_t asked[], double p[],
                   Err *err)
{
    size_t n_asked = 0;
    for (size_t i = 0; i < n; i++)
        if (known->place[rows[i]] > 0)
            asked[n_asked++] = known->place[rows[i]] - 1;
    TRY(front_confidence(known->n, run->schema.n_obj, known->F, known->error, 1, n_asked, asked, p, err));
    for (size_t i = n; i-- > 0;) /* those asked for stand first */
        p[i] = known->place[rows[i]] > 0 ? p[--n_asked] : NAN;
    return STATUS_OK;
}

Status confidence_of_designs(const Run *run, size_t n, const size_t rows[], double p[], Err *err)
{
    Known known = {0};
    size_t *asked = calloc(n + 1, sizeof *asked);
    Status status =
        asked ? know(run, &known, err) : fail(err, STATUS_NO_MEMORY, "no memory for a front of %zu designs", n);
    if (status == STATUS_OK)
        status = draw(run, &known, n, rows, asked, p, err);
    forget(&known);
    free(asked);
    return status;
}

Status confidence_of_front(const Run *run, size_t *n_confident, size_t *n_known, Err *err)
{
    *n_confident = *n_known = 0;
    if (!schema_is_noisy(run->settings))
        return STATUS_OK;
    double *p = calloc(run->n_front + 1, sizeof *p);
    const Status status = p ? confidence_of_designs(run, run->n_front, run->front, p, err)
                            : fail(err, STATUS_NO_MEMORY, "no memory for a front of %zu designs", run->n_front);
    for (size_t i = 0; i < run->n_front && status == STATUS_OK; i++) {
        *n_confident += p[i] >= CONFIDENT;
        *n_known += !isnan(p[i]);
    }
    free(p);
    return status;
}
