#include "store/results.h"

#include <stdlib.h>
#include <string.h>

#include "base/carve.h"

static void layout(void *results, Carve *c)
{
    Results *r = results;
    r->f = carve(c, r->n_max * r->n_obj, sizeof *r->f);
    r->seconds = carve(c, r->n_max, sizeof *r->seconds);
    r->violation = carve(c, r->n_max, sizeof *r->violation);
    r->generation = carve(c, r->n_max, sizeof *r->generation);
    r->kind = carve(c, r->n_max, 1);
}

void results_begin(Results *r, size_t n_max, size_t n_obj)
{
    *r = (Results){.n_max = n_max, .n_obj = n_obj};
    r->store = carve_all(layout, r);
    r->n_max = r->store ? n_max : 0;
}

void results_take(Results *r, const Evaluation *e)
{
    const size_t i = r->n;
    if (i == r->n_max)
        return;
    if (e->outcome != OUTCOME_OK || e->reason[0] || e->id != (long)i + 1) {
        results_free(r);
        return;
    }
    r->n++;
    memcpy(r->f + i * r->n_obj, e->f, r->n_obj * sizeof *r->f);
    r->seconds[i] = e->seconds;
    r->violation[i] = e->violation;
    r->generation[i] = (int)e->generation;
    r->kind[i] = (unsigned char)e->kind;
}

Status results_table(const Results *r, EvaluationTable *table, Err *err)
{
    Evaluation *e;
    for (size_t i = 0; i < r->n; i++) {
        TRY(evaluation_table_add(table, &e, err));
        e->id = (long)i + 1;
        e->generation = r->generation[i];
        e->kind = (EvaluationKind)r->kind[i];
        e->seconds = r->seconds[i];
        e->violation = r->violation[i];
        memcpy(e->f, r->f + i * r->n_obj, r->n_obj * sizeof *e->f);
    }
    return STATUS_OK;
}

void results_free(Results *r)
{
    free(r->store);
    *r = (Results){0};
}
