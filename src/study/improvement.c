#include "study/improvement.h"

#include "moga/convergence.h"
#include "moga/search.h"
#include "settings/options.h"

Status improvement_expected(const Run *run, double *gain, Err *err)
{
    const size_t n = run_first_polished(run), m = run->schema.n_obj, cuts[] = {n / 4, n / 2, n};
    double h[3];
    *gain = NAN;
    if (run->settings->search.fidelity != FIDELITY_OFF)
        return STATUS_OK;
    if (run->n_sessions > 0 &&
        strcmp(run->session[run->n_sessions - 1].stopped, stop_reason_words(STOP_EXHAUSTED)) == 0) {
        *gain = 0; /* there is no other design */
        return STATUS_OK;
    }
    unsigned char *counts = calloc(2, n + 1), *on_front = counts + n;
    double *sense = calloc(m, sizeof *sense);
    for (size_t k = 0; sense && k < m; k++)
        sense[k] = schema_objective(&run->schema, k)->sense;
    for (size_t i = 0; counts && i < n; i++) {
        const Evaluation *r = &run->table.row[i];
        const int is_answer = r->kind != KIND_UNFINISHED && r->kind != KIND_REPEAT && run->place[i].ok;
        counts[i] = is_answer && !(r->violation > 0.0);
        on_front[i] = is_answer && run->place[i].entered != NEVER && run->place[i].left == NEVER;
    }
    const GrowingFront designs = {n, m, run->F, NULL, sense, counts, on_front};
    const Status status =
        counts && sense ? convergence_shares(&designs, 3, cuts, h, err) : fail_memory(err, n, "designs");
    if (status == STATUS_OK)
        *gain = convergence_expected(h);
    free(counts);
    free(sense);
    return status;
}
