#include "study/improvement.h"

#include <math.h>
#include <stdlib.h>

#include "moga/convergence.h"
#include "settings/options.h"

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
