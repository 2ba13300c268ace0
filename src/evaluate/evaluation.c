#include "evaluate/evaluation.h"

#include "base/carve.h"
#include "base/stat.h"
#include "base/text.h"
#include "base/visible.h"

static const char *const OUTCOME_WORDS[] = {
#define X(name, word) word,
    OUTCOME_LIST(X)
#undef X
};

static const char *const KIND_WORDS[] = {
#define X(name, word) word,
    KIND_LIST(X)
#undef X
};

const char *outcome_word(Outcome outcome)
{
    return OUTCOME_WORDS[outcome];
}

Outcome outcome_of_word(const char *word)
{
    return (Outcome)index_of_word(word, OUTCOME_WORDS, OUTCOME_COUNT);
}

const char *kind_word(EvaluationKind kind)
{
    return KIND_WORDS[kind];
}

EvaluationKind kind_of_word(const char *word)
{
    return (EvaluationKind)index_of_word(word, KIND_WORDS, KIND_UNFINISHED);
}

void evaluation_set_outcome(Evaluation *e, Outcome outcome, const char *reason)
{
    char shown[REASON_MAX];
    e->outcome = outcome;
    e->reason = "";
    if (!reason || !reason[0])
        return;
    visible_text(shown, sizeof shown, reason);
    cell_text(e->room, REASON_MAX, shown);
    e->reason = e->room;
}

EvaluationTable evaluation_table(size_t n_var, size_t n_obj, size_t n_extra)
{
    return (EvaluationTable){.n_var = n_var, .n_obj = n_obj, .n_extra = n_extra, .n_sd = n_obj};
}

static void point_row(EvaluationTable *t, size_t i)
{
#define X(array, width) t->row[i].array = t->array + i * t->width;
    EVALUATION_ARRAYS(X)
#undef X
    if (t->n_sd == 0)
        t->row[i].sd = NULL;
}

void evaluation_forget(Evaluation *e, size_t n_obj, size_t n_extra)
{
    const Evaluation own = *e;
    const size_t n_sd = own.sd ? n_obj : 0;
    *e = (Evaluation){
        .kind = KIND_UNFINISHED, .reason = "", .room = own.room, .seconds = NAN, .violation = NAN, .x = own.x};
#define X(array, width)                                                                                                \
    e->array = own.array;                                                                                              \
    for (size_t i = 0; i < width; i++)                                                                                 \
        e->array[i] = NAN;
    RESULT_ARRAYS(X)
#undef X
}

Status evaluation_table_add(EvaluationTable *t, Evaluation **row, Err *err)
{
    if (t->n == t->n_max) { /* of large arrays the system moves the pages, and copies nothing */
        const size_t n_max = t->n_max > 0 ? 2 * t->n_max : 32;
        int lacks = 0;
        t->row = widened(t->row, n_max, sizeof *t->row, &lacks);
#define X(array, width) t->array = widened(t->array, n_max * t->width, sizeof *t->array, &lacks);
        EVALUATION_ARRAYS(X)
#undef X
        for (size_t i = 0; i < t->n; i++)
            point_row(t, i);
        if (lacks)
            return fail_memory(err, n_max, "evaluations");
        t->n_max = n_max;
    }
    *row = &t->row[t->n];
    **row = (Evaluation){0};
    point_row(t, t->n++);
    if (t->n_var > 0)
        memset((*row)->x, 0, t->n_var * sizeof *t->x);
    evaluation_forget(*row, t->n_obj, t->n_extra);
    return STATUS_OK;
}

Status evaluation_table_give_room(Evaluation *row, Err *err)
{
    if (!row->room)
        row->room = malloc(REASON_MAX);
    return row->room ? STATUS_OK : fail(err, STATUS_NO_MEMORY, "no memory for the reason of a failure");
}

Status evaluation_table_append(EvaluationTable *t, const Evaluation *from, Err *err)
{
    Evaluation *e;
    TRY(evaluation_table_add(t, &e, err));
    const Evaluation own = *e;
    *e = *from;
    e->room = NULL;
    e->reason = "";
    e->err = NULL;
#define X(array, width)                                                                                                \
    e->array = own.array;                                                                                              \
    if (from->array && e->array)                                                                                       \
        copy_values(t->width, from->array, e->array);
    EVALUATION_ARRAYS(X)
#undef X
    if (from->reason && from->reason[0]) {
        TRY(evaluation_table_give_room(e, err));
        snprintf(e->room, REASON_MAX, "%s", from->reason);
        e->reason = e->room;
    }
    return STATUS_OK;
}

static int by_words(const void *a, const void *b)
{
    return strcmp(*(const char *const *)a, *(const char *const *)b);
}

const char *evaluation_table_failures(const EvaluationTable *t, size_t *n_failed, size_t *most)
{
    const char **reason = malloc((t->n + 1) * sizeof *reason), *commonest = "";
    size_t n = 0;
    *n_failed = *most = 0;
    for (size_t i = 0; i < t->n; i++)
        if (t->row[i].outcome != OUTCOME_OK && ++*n_failed && reason)
            reason[n++] = t->row[i].reason;
    if (n > 0)
        qsort(reason, n, sizeof *reason, by_words);
    for (size_t i = 0, first = 0; i < n; i++) {
        first = strcmp(reason[i], reason[first]) == 0 ? first : i;
        if (i + 1 - first > *most) {
            *most = i + 1 - first;
            commonest = reason[i];
        }
    }
    free(reason);
    return commonest;
}

Status evaluation_table_check(const EvaluationTable *t, Err *err)
{
    size_t n, most;
    const char *reason = evaluation_table_failures(t, &n, &most);
    return n == 0 || n < t->n
               ? STATUS_OK
               : fail(err, STATUS_INTERNAL, "none of %zu simulations succeeded; %zu failed with: %s", n, most, reason);
}

void evaluation_table_free(EvaluationTable *t)
{
    for (size_t i = 0; i < t->n; i++)
        free(t->row[i].room);
    free(t->row);
#define X(array, width) free(t->array);
    EVALUATION_ARRAYS(X)
#undef X
    *t = (EvaluationTable){.n_var = t->n_var, .n_obj = t->n_obj, .n_extra = t->n_extra, .n_sd = t->n_sd};
}
