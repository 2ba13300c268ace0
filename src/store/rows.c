#include "store/rows.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/number.h"
#include "store/digest.h"

const char *column_text(sqlite3_stmt *row, int column)
{
    const char *text = (const char *)sqlite3_column_text(row, column);
    return text ? text : "";
}

double column_number(sqlite3_stmt *row, int column)
{
    return sqlite3_column_type(row, column) == SQLITE_NULL ? NAN : sqlite3_column_double(row, column);
}

long column_whole(sqlite3_stmt *row, int column, long otherwise)
{
    return sqlite3_column_type(row, column) == SQLITE_NULL ? otherwise : (long)sqlite3_column_int64(row, column);
}

/* -- the digest ---------------------------------------------------------------------------------------------------- */

/* As stored; NULL: none. */
typedef struct {
    const char *outcome, *reason, *x, *f, *sd, *extra;
} RowText;

static long digest_of(const Evaluation *e, const RowText *t)
{
    const char *const texts[] = {t->outcome, t->reason, t->x, t->f, t->sd, t->extra};
    uint64_t hash = digest_number(e->violation, digest_number(e->seconds, digest_whole(e->id, HASH_SEED)));
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++)
        hash = digest_text(texts[i], hash);
    return (long)(hash ^ digest_kind(e->kind, e->generation));
}

/* -- writing ------------------------------------------------------------------------------------------------------- */

/* Characters of n numbers as a list. */
static size_t list_room(size_t n)
{
    return n * NUMBER_TEXT_MAX + 3;
}

/* "[1,2.5,null]" at *room, which moves behind it; NULL where no number is finite. */
static const char *list_text(size_t n, const double values[], char **room)
{
    char *const text = *room, *to = text;
    size_t known = 0;
    for (size_t i = 0; values && i < n; i++)
        known += isfinite(values[i]) != 0;
    if (known == 0)
        return NULL;
    for (size_t i = 0; i < n; i++) {
        *to++ = i == 0 ? '[' : ',';
        if (isfinite(values[i]))
            to += number_text(values[i], to);
        else
            to = stpcpy(to, "null");
    }
    *room = stpcpy(to, "]") + 1;
    return text;
}

static Status insert_text(Database *db, const Evaluation *e, const RowText *t, Err *err)
{
    const char *kind = e->kind == KIND_UNFINISHED ? NULL : kind_word(e->kind);
    return database_do(db, err,
                       "INSERT OR REPLACE INTO evaluation(id, generation, kind, outcome, reason, seconds, x, f, "
                       "spread, violation, extra, digest) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
                       "iitttdtttdti", e->id, e->generation, kind, t->outcome, t->reason, e->seconds, t->x, t->f, t->sd,
                       e->violation, t->extra, digest_of(e, t));
}

Status rows_insert(Database *db, RowShape shape, const Evaluation *e, Err *err)
{
    char *const store = malloc(list_room(shape.n_var) + 2 * list_room(shape.n_obj) + list_room(shape.n_extra));
    char *room = store;
    if (!store)
        return fail(err, STATUS_NO_MEMORY, "no memory for the text of a row");
    RowText t = {.outcome = outcome_word(e->outcome), .reason = e->reason ? e->reason : ""};
    t.x = list_text(shape.n_var, e->x, &room);
    t.f = e->outcome == OUTCOME_OK ? list_text(shape.n_obj, e->f, &room) : NULL;
    t.sd = list_text(shape.n_obj, e->sd, &room);
    t.extra = list_text(shape.n_extra, e->extra, &room);
    const Status status = insert_text(db, e, &t, err);
    free(store);
    return status;
}

/* By (a | b) - (a & b), the exclusive or that SQL lacks. */
Status rows_finish(Database *db, long id, EvaluationKind kind, long generation, Err *err)
{
    return database_do(
        db, err, "UPDATE evaluation SET kind = ?, generation = ?, digest = (digest | ?) - (digest & ?) WHERE id = ?",
        "tiiii", kind_word(kind), generation, (long)digest_kind(kind, generation), (long)digest_kind(kind, generation),
        id);
}

Status rows_unfinish(Database *db, long id, EvaluationKind kind, long generation, Err *err)
{
    return database_do(db, err, "UPDATE evaluation SET kind = NULL, digest = (digest | ?) - (digest & ?) WHERE id = ?",
                       "iii", (long)digest_kind(kind, generation), (long)digest_kind(kind, generation), id);
}

/* -- reading ------------------------------------------------------------------------------------------------------- */

typedef struct {
    EvaluationTable *table;
    Database *db;
    long without; /* id of a row without a digest; 0: there is none */
    int has_with; /* a row with one */
} Reading;

static Status damaged(const Reading *r, const char *what, long id, Err *err)
{
    return fail(err, STATUS_IO, "%s: is damaged: %s of evaluation %ld cannot be read", database_path(r->db), what, id);
}

/* "[1,2.5,null]"; no text at all: n times NAN. A list may have n_least numbers alone: the others are not known. */
static int parse_numbers(const char *text, size_t n_least, size_t n, double values[])
{
    const int known = text[0] != 0;
    for (size_t i = 0; i < n; i++)
        values[i] = NAN;
    for (size_t i = 0; i < n && known; i++) {
        const char *end;
        if (i >= n_least && i > 0 && *text == ']')
            break;
        if (*text++ != (i == 0 ? '[' : ','))
            return 0;
        if (strncmp(text, "null", 4) == 0) {
            text += 4;
            continue;
        }
        values[i] = number_read(text, &end);
        if (end == text || !isfinite(values[i]))
            return 0;
        text = end;
    }
    return !known || strcmp(text, "]") == 0;
}

static const char EVALUATIONS[] = "SELECT id, generation, kind, outcome, reason, seconds, x, f, spread, violation, "
                                  "extra, digest FROM evaluation WHERE id BETWEEN %ld AND %ld ORDER BY id";

static Status parse_row(const Reading *r, const RowText *t, Evaluation *e, Err *err)
{
    const EvaluationTable *table = r->table;
    /* books_open: the word for it before 0.1.0 */
    e->outcome = strcmp(t->outcome, "books_open") == 0 ? OUTCOME_ENERGY_BALANCE : outcome_of_word(t->outcome);
    if (e->outcome == OUTCOME_COUNT)
        return damaged(r, "outcome", e->id, err);
    if (t->reason[0])
        TRY(evaluation_table_give_room(e, err));
    evaluation_set_outcome(e, e->outcome, t->reason);
    if (!t->x[0] || !parse_numbers(t->x, table->n_var, table->n_var, e->x))
        return damaged(r, "x", e->id, err);
    if (!parse_numbers(t->f, table->n_obj, table->n_obj, e->f))
        return damaged(r, "f", e->id, err);
    if (!parse_numbers(t->sd, table->n_obj, table->n_obj, e->sd))
        return damaged(r, "spread", e->id, err);
    /* an earlier version had fewer measures: the first of them */
    return table->n_extra == 0 || parse_numbers(t->extra, 0, table->n_extra, e->extra)
               ? STATUS_OK
               : damaged(r, "extra", e->id, err);
}

static Status take_row(sqlite3_stmt *row, void *user, Err *err)
{
    Reading *r = user;
    const RowText text = {.outcome = column_text(row, 3),
                          .reason = column_text(row, 4),
                          .x = column_text(row, 6),
                          .f = column_text(row, 7),
                          .sd = column_text(row, 8),
                          .extra = column_text(row, 10)};
    Evaluation *e;
    TRY(evaluation_table_add(r->table, &e, err));
    e->id = (long)sqlite3_column_int64(row, 0);
    e->generation = (long)sqlite3_column_int64(row, 1);
    e->kind = kind_of_word(column_text(row, 2));
    e->seconds = column_number(row, 5);
    e->violation = column_number(row, 9);
    TRY(parse_row(r, &text, e, err));
    if (sqlite3_column_type(row, 11) == SQLITE_NULL) {
        r->without = e->id;
        return STATUS_OK;
    }
    r->has_with = 1;
    /* before format 3 kind and generation were not in it */
    const long plain = database_format(r->db) < 3 ? (long)digest_kind(e->kind, e->generation) : 0;
    if (sqlite3_column_int64(row, 11) == (digest_of(e, &text) ^ plain))
        return STATUS_OK;
    return fail(err, STATUS_IO, "%s: is damaged: evaluation %ld is not what was written", database_path(r->db), e->id);
}

Status rows_read(Database *db, EvaluationTable *table, long first, long last, Err *err)
{
    char sql[sizeof EVALUATIONS + 48];
    Reading r = {.table = table, .db = db};
    snprintf(sql, sizeof sql, EVALUATIONS, first, last);
    TRY(database_each(db, sql, take_row, &r, err));
    return !r.without || !r.has_with
               ? STATUS_OK
               : fail(err, STATUS_IO,
                      "%s: is damaged: evaluation %ld has no digest, as if it were not what was written",
                      database_path(db), r.without);
}

/* -- as lines ------------------------------------------------------------------------------------------------------ */

/* n cells, each behind a comma, of "[1,2.5,null]"; empty ones for what is not there. */
static void print_list(FILE *f, const char *list, size_t n)
{
    const char *at = list[0] ? list + 1 : list;
    for (size_t i = 0; i < n; i++) {
        const size_t length = strcspn(at, ",]");
        fputc(',', f);
        if (*at != 'n')
            fwrite(at, 1, length, f);
        at += length + (at[length] == ',');
    }
}

typedef struct {
    FILE *f;
    RowShape shape;
    size_t *n;
} Printing;

static Status print_row(sqlite3_stmt *row, void *user, Err *err)
{
    const Printing *p = user;
    (void)err;
    if (sqlite3_column_type(row, 2) == SQLITE_NULL)
        return STATUS_OK;
    fprintf(p->f, "%ld,%ld,%s,%s,%s", (long)sqlite3_column_int64(row, 0), (long)sqlite3_column_int64(row, 1),
            column_text(row, 2), column_text(row, 3), column_text(row, 4));
    print_list(p->f, column_text(row, 6), p->shape.n_var);
    print_list(p->f, column_text(row, 7), p->shape.n_obj);
    print_list(p->f, column_text(row, 10), p->shape.n_extra);
    fputc('\n', p->f);
    ++*p->n;
    return STATUS_OK;
}

Status rows_print(Database *db, FILE *f, RowShape shape, long first, long last, size_t *n, Err *err)
{
    char sql[sizeof EVALUATIONS + 48];
    Printing p = {f, shape, n};
    *n = 0;
    snprintf(sql, sizeof sql, EVALUATIONS, first, last);
    return database_each(db, sql, print_row, &p, err);
}
