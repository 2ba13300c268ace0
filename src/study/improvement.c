#include "study/improvement.h"

#include <math.h>
#include <stdlib.h>

#include "moga/convergence.h"
#include "settings/options.h"

static int keeps_limits(const SearchView *v, size_t row)
{
    for (size_t c = 0; c < v->n_con; c++)
        if (v->H[row * v->n_con + c] > 0.0)
            return 0;
    return v->ok[row] && v->replicates[row] > 0 && v->kind[row] != KIND_SCREENED;
}

static double value_of(const Igd *q)
{
    const double value = igd_value(q);
    return isfinite(value) ? value : NAN;
}

/* The designs of the reference that were known by then come first: nothing is to be measured from them any more. */
static void add_early(Igd *q, const SearchView *v, size_t n, const size_t front[])
{
    const size_t early = v->n - v->n / 10, taken = n < IGD_REFERENCE_MAX ? n : IGD_REFERENCE_MAX;
    for (size_t i = 0; i < taken; i++)
        if (front[i * n / taken] < early && keeps_limits(v, front[i * n / taken]))
            igd_add(q, v->F + front[i * n / taken] * v->n_obj);
    for (size_t i = 0; i < early; i++)
        if (keeps_limits(v, i))
            igd_add(q, v->F + i * v->n_obj);
}

Status improvement_lately(const SearchView *v, double *igd, Err *err)
{
    Igd *q;
    size_t n = 0, *front = v->n_front > 0 ? calloc(v->n_front, sizeof *front) : NULL;
    *igd = NAN;
    if (v->n_front == 0)
        return STATUS_OK;
    if (!front)
        return fail(err, STATUS_NO_MEMORY, "no memory for %zu designs", v->n_front);
    for (size_t i = 0; i < v->n && n < v->n_front; i++)
        if (v->on_front[i])
            front[n++] = i;
    const Status status = igd_create(&q, v->n_obj, n, front, v->F, err);
    if (status == STATUS_OK) {
        add_early(q, v, n, front);
        *igd = value_of(q);
        igd_free(q);
    }
    free(front);
    return status;
}

/* -- of a stored run ----------------------------------------------------------------------------------------------- */

static int is_first_answer(const Evaluation *r)
{
    return r->kind != KIND_POLISHED && r->kind != KIND_UNFINISHED && r->kind != KIND_REPEAT;
}

/* Every objective minimised; rows of the search's own front into front (n); returns how many. */
static size_t minimise(const Run *run, double F[], size_t front[])
{
    const size_t m = run->schema.n_obj;
    size_t n = 0;
    for (size_t i = 0; i < run->table.n; i++) {
        const Evaluation *r = &run->table.row[i];
        for (size_t k = 0; k < m; k++)
            F[i * m + k] = schema_objective(&run->schema, k)->sense * run->F[i * m + k];
        if (is_first_answer(r) && run->place[i].ok && run->place[i].entered != NEVER && run->place[i].left == NEVER)
            front[n++] = i;
    }
    return n;
}

/* Designs that were on no front add nothing to one: where there is no noise they are passed over. */
static int adds(const Run *run, size_t row)
{
    const Evaluation *e = &run->table.row[row];
    return is_first_answer(e) && run->place[row].ok && !(e->violation > 0.0) &&
           (run->schema.is_noisy || run->place[row].entered != NEVER);
}

static void follow(const Run *run, const double F[], Igd *q, double igd[])
{
    size_t row = 0;
    for (size_t g = 0; g < run->n_generations; g++) {
        for (; row < run->table.n && run->table.row[row].id <= run->generation[g].simulated; row++)
            if (adds(run, row))
                igd_add(q, F + row * run->schema.n_obj);
        igd[g] = value_of(q);
    }
}

Status improvement_of_run(const Run *run, double igd[], Err *err)
{
    double *F = calloc(run->table.n * run->schema.n_obj + 1, sizeof *F);
    size_t *front = calloc(run->table.n + 1, sizeof *front), n = 0;
    Igd *q = NULL;
    Status status = F && front ? STATUS_OK : fail(err, STATUS_NO_MEMORY, "no memory for %zu designs", run->table.n);
    for (size_t g = 0; g < run->n_generations; g++)
        igd[g] = NAN;
    if (status == STATUS_OK && (n = minimise(run, F, front)) > 0)
        status = igd_create(&q, run->schema.n_obj, n, front, F, err);
    if (q)
        follow(run, F, q, igd);
    igd_free(q);
    free(F);
    free(front);
    return status;
}

static size_t search_rows(const Run *run)
{
    return run_first_polished(run);
}

static Status expected(const Run *run, size_t n, const double F[], const unsigned char on_front[],
                       unsigned char counts[], double *gain, Err *err)
{
    const size_t cuts[] = {n / 4, n / 2, n};
    double h[3];
    for (size_t i = 0; i < n; i++)
        counts[i] = is_first_answer(&run->table.row[i]) && run->place[i].ok && !(run->table.row[i].violation > 0.0);
    TRY(convergence_shares(&(GrowingFront){n, run->schema.n_obj, F, NULL, counts, on_front}, 3, cuts, h, err));
    *gain = convergence_expected(h);
    return STATUS_OK;
}

Status improvement_expected(const Run *run, double *gain, Err *err)
{
    const size_t n = search_rows(run);
    *gain = NAN;
    if (run->settings->search.fidelity != FIDELITY_OFF)
        return STATUS_OK;
    double *F = calloc(run->table.n * run->schema.n_obj + 1, sizeof *F);
    size_t *front = calloc(run->table.n + 1, sizeof *front);
    unsigned char *flags = calloc(2, n + 1);
    Status status =
        F && front && flags ? STATUS_OK : fail(err, STATUS_NO_MEMORY, "no memory for %zu designs", run->table.n);
    if (status == STATUS_OK) {
        const size_t n_front = minimise(run, F, front);
        for (size_t i = 0; i < n_front; i++)
            flags[front[i]] = 1;
        status = expected(run, n, F, flags, flags + n, gain, err);
    }
    free(F);
    free(front);
    free(flags);
    return status;
}
