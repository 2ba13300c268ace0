#include "api/asking.h"

#include <omp.h>

#include "base/clock.h"
#include "base/linalg.h"

Status asking_add(Asking *a, const double x[], Err *err)
{
    Evaluation *row;
    if (a->table.n == a->room) {
        const size_t room = 2 * a->room + 64;
        AskedDesign *wider = realloc(a->design, room * sizeof *wider);
        if (!wider)
            return fail_memory(err, room, "designs");
        a->design = wider;
        a->room = room;
    }
    TRY(evaluation_table_add(&a->table, &row, err));
    memcpy(row->x, x, a->table.n_var * sizeof *x);
    row->id = (long)a->table.n;
    a->design[a->table.n - 1] = (AskedDesign){0};
    return STATUS_OK;
}

Status asking_tell(Asking *a, size_t row, Err *err)
{
    return search_tell(a->search, row + 1, &a->table.row[row], NULL, err);
}

/* A search that was saved asks again for what was under way; it may be told already. */
static Status take_question(Asking *a, const Question *q, Err *err)
{
    const size_t row = q->number - 1;
    if (row == a->table.n)
        TRY(asking_add(a, q->x, err));
    if (row >= a->table.n || memcmp(a->table.row[row].x, q->x, a->table.n_var * sizeof *q->x) != 0)
        return fail(err, STATUS_INTERNAL, "design %zu is another one than was asked for before", q->number);
    a->table.row[row].kind = q->kind;
    a->table.row[row].generation = (long)q->generation;
    return a->design[row].place == DESIGN_TOLD ? asking_tell(a, row, err) : STATUS_OK;
}

static Status advance(Asking *a, Err *err)
{
    for (SearchMove move = SEARCH_ASKS; move != SEARCH_WAITS && move != SEARCH_ENDS;) {
        Question q;
        TRY(search_ask(a->search, &move, &q, err));
        if (move == SEARCH_ASKS)
            TRY(take_question(a, &q, err));
        a->is_over = move == SEARCH_ENDS;
    }
    if (a->is_over)
        a->reason = search_look(a->search).reason;
    return STATUS_OK;
}

/* With threads and BLAS as the search wants them; the caller's own are as before. */
Status asking_advance(Asking *a, Err *err)
{
    const int threads = omp_get_max_threads();
    if (a->is_over)
        return STATUS_OK;
    if (a->config.max_seconds > 0.0 && clock_seconds() >= a->began + a->config.max_seconds)
        search_stop(a->search, STOP_TIME);
    linalg_begin();
    omp_set_num_threads((int)a->threads);
    const Status status = advance(a, err);
    omp_set_num_threads(threads);
    linalg_end();
    return status;
}

void asking_init(Asking *a)
{
    const Problem *p = &a->problem;
    a->problem.n_parts = a->problem.n_workers = 1;
    a->table = evaluation_table(p->n_var, p->n_obj, p->n_extra);
}

Status asking_open(Asking *a, Err *err)
{
    const SearchStart start = {.n = a->n_entered, .row = a->table.row, .state = a->state, .n_state = a->n_state};
    a->began = clock_seconds();
    TRY(search_create(&a->search, &a->problem, &a->config, a->state ? &start : NULL, err));
    free(a->state);
    a->state = NULL;
    return a->table.n > 0 ? asking_advance(a, err) : STATUS_OK;
}

void asking_close(Asking *a)
{
    search_free(a->search);
    evaluation_table_free(&a->table);
    free(a->design);
    free(a->state);
}
