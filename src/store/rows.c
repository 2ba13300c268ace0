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

/* Room for what it is of. */
static size_t message_room(const RowText *t)
{
    const char *const texts[] = {t->outcome, t->reason, t->x, t->f, t->sd, t->extra};
    size_t n = sizeof(long) + 2 * sizeof(double);
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++)
        n += (texts[i] ? strlen(texts[i]) : 0) + 1;
    return n;
}

/* What it is of: all but kind and generation, one behind the other. Returns the length. */
static size_t put_message(const Evaluation *e, const RowText *t, char *to)
{
    const char *const texts[] = {t->outcome, t->reason, t->x, t->f, t->sd, t->extra};
    const double numbers[] = {digest_known(e->seconds), digest_known(e->violation)};
    char *at = mempcpy(mempcpy(to, &e->id, sizeof e->id), numbers, sizeof numbers);
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++)
        at = stpcpy(at, texts[i] ? texts[i] : "") + 1;
    return (size_t)(at - to);
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

static Status insert_text(Database *db, const Evaluation *e, const RowText *t, long digest, Err *err)
{
    const char *kind = e->kind == KIND_UNFINISHED ? NULL : kind_word(e->kind);
    return database_do(db, err,
                       "INSERT OR REPLACE INTO evaluation(id, generation, kind, outcome, reason, seconds, x, f, "
                       "spread, violation, extra, digest) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
                       "iitttdtttdti", e->id, e->generation, kind, t->outcome, t->reason, e->seconds, t->x, t->f, t->sd,
                       e->violation, t->extra, digest);
}

static Status insert_with_digest(Database *db, const Evaluation *e, const RowText *t, Err *err)
{
    char *message = malloc(message_room(t));
    if (!message)
        return fail(err, STATUS_NO_MEMORY, "no memory for the text of a row");
    const uint64_t digest = hash_fnv1a(message, put_message(e, t, message), HASH_SEED);
    free(message);
    return insert_text(db, e, t, (long)(digest ^ digest_kind(e->kind, e->generation)), err);
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
    const Status status = insert_with_digest(db, e, &t, err);
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

/* A row whose digest is still to be compared. */
typedef struct {
    long id;
    uint64_t digest; /* that it should have, without kind and generation */
    size_t n, n_max;
    char *message; /* (n) */
} Unchecked;

/* Rows are compared HASH_LANES at a time: every step of a digest waits for the one before, those of several rows do not. */
typedef struct {
    EvaluationTable *table;
    Database *db;
    RowLines *lines;                 /* NULL: none are compared */
    long without;                    /* id of a row without a digest; 0: there is none */
    int has_with;                    /* a row with one */
    uint64_t kind_digest;            /* of the kind and the generation of the row before, which most have */
    EvaluationKind kind;             /* ... */
    long generation;                 /* ... */
    Unchecked unchecked[HASH_LANES]; /* (n_unchecked) */
    size_t n_unchecked;
} Reading;

static Status damaged(const Reading *r, const char *what, long id, Err *err)
{
    return fail(err, STATUS_IO, "%s: is damaged: %s of evaluation %ld cannot be read", database_path(r->db), what, id);
}

int rows_numbers(const char *text, size_t n_least, size_t n, double values[])
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
        if (*text == 'n' && strncmp(text, "null", 4) == 0) {
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

/* Outcome and reason. */
static Status parse_outcome(const Reading *r, const RowText *t, Evaluation *e, Err *err)
{
    /* books_open: the word for it before 0.1.0 */
    e->outcome = strcmp(t->outcome, "books_open") == 0 ? OUTCOME_ENERGY_BALANCE : outcome_of_word(t->outcome);
    if (e->outcome == OUTCOME_COUNT)
        return damaged(r, "outcome", e->id, err);
    if (t->reason[0])
        TRY(evaluation_table_give_room(e, err));
    evaluation_set_outcome(e, e->outcome, t->reason);
    return STATUS_OK;
}

static Status parse_row(const Reading *r, const RowText *t, Evaluation *e, Err *err)
{
    const EvaluationTable *table = r->table;
    TRY(parse_outcome(r, t, e, err));
    if (table->n_var > 0 && (!t->x[0] || !rows_numbers(t->x, table->n_var, table->n_var, e->x)))
        return damaged(r, "x", e->id, err);
    if (!rows_numbers(t->f, table->n_obj, table->n_obj, e->f))
        return damaged(r, "f", e->id, err);
    if (!rows_numbers(t->sd, table->n_obj, table->n_obj, e->sd))
        return damaged(r, "spread", e->id, err);
    /* an earlier version had fewer measures: the first of them */
    return table->n_extra == 0 || rows_numbers(t->extra, 0, table->n_extra, e->extra) ? STATUS_OK
                                                                                      : damaged(r, "extra", e->id, err);
}

static Status compare_digests(Reading *r, Err *err)
{
    const char *message[HASH_LANES];
    size_t length[HASH_LANES];
    uint64_t digest[HASH_LANES];
    const size_t n = r->n_unchecked;
    for (size_t i = 0; i < n; i++) {
        message[i] = r->unchecked[i].message;
        length[i] = r->unchecked[i].n;
    }
    r->n_unchecked = 0;
    hash_fnv1a_each(n, message, length, digest);
    for (size_t i = 0; i < n; i++)
        if (digest[i] != r->unchecked[i].digest)
            return fail(err, STATUS_IO, "%s: is damaged: evaluation %ld is not what was written", database_path(r->db),
                        r->unchecked[i].id);
    return STATUS_OK;
}

/* Before format 3 kind and generation were not in it. */
static uint64_t digest_without_kind(Reading *r, const Evaluation *e, uint64_t digest)
{
    if (database_format(r->db) < 3)
        return digest;
    if (r->kind != e->kind || r->generation != e->generation) {
        r->kind = e->kind;
        r->generation = e->generation;
        r->kind_digest = digest_kind(e->kind, e->generation);
    }
    return digest ^ r->kind_digest;
}

static Status compare_later(Reading *r, const Evaluation *e, const RowText *t, uint64_t digest, Err *err)
{
    Unchecked *u = &r->unchecked[r->n_unchecked];
    const size_t room = message_room(t);
    if (u->n_max < room) {
        free(u->message);
        u->n_max = 2 * room;
        u->message = malloc(u->n_max);
    }
    if (!u->message) {
        u->n_max = 0;
        return fail(err, STATUS_NO_MEMORY, "no memory for the text of a row");
    }
    u->id = e->id;
    u->digest = digest_without_kind(r, e, digest);
    u->n = put_message(e, t, u->message);
    return ++r->n_unchecked == HASH_LANES ? compare_digests(r, err) : STATUS_OK;
}

static Status check_row(Reading *r, const Evaluation *e, const RowText *text, sqlite3_stmt *row, Err *err)
{
    if (sqlite3_column_type(row, 11) == SQLITE_NULL) {
        r->without = e->id;
        return STATUS_OK;
    }
    r->has_with = 1;
    return compare_later(r, e, text, (uint64_t)sqlite3_column_int64(row, 11), err);
}

/* All but the numbers of the lists. */
static RowText take_text(sqlite3_stmt *row, Evaluation *e)
{
    e->id = (long)sqlite3_column_int64(row, 0);
    e->generation = (long)sqlite3_column_int64(row, 1);
    e->kind = kind_of_word(column_text(row, 2));
    e->seconds = column_number(row, 5);
    e->violation = column_number(row, 9);
    return (RowText){.outcome = column_text(row, 3),
                     .reason = column_text(row, 4),
                     .x = column_text(row, 6),
                     .f = column_text(row, 7),
                     .sd = column_text(row, 8),
                     .extra = column_text(row, 10)};
}

/* Behind a comma and the word; NULL: something else is there. */
static const char *skip_cell(const char *at, const char *word, size_t length)
{
    return at && *at == ',' && strncmp(at + 1, word, length) == 0 ? at + 1 + length : NULL;
}

/* Behind the n cells of the list. */
static const char *skip_cells(const char *at, const char *list, size_t n)
{
    const size_t length = strlen(list);
    if (length > 2 && !strchr(list, 'n')) /* all of them are known: the same text */
        return skip_cell(at, list + 1, length - 2);
    for (size_t i = 0; i < n; i++) {
        list += *list == '[' || *list == ',';
        const size_t digits = *list == 'n' ? 0 : strcspn(list, ",]");
        at = skip_cell(at, list, digits);
        list += *list == 'n' ? strlen("null") : digits;
    }
    return at;
}

static int is_next_line(RowLines *l, const EvaluationTable *shape, const Evaluation *e, const RowText *t)
{
    const char *const words[] = {kind_word(e->kind), outcome_word(e->outcome), e->reason};
    char *end;
    if (getline(&l->line, &l->room, l->f) <= 0 || strtol(l->line, &end, 10) != e->id || *end != ',' ||
        strtol(end + 1, &end, 10) != e->generation)
        return 0;
    const char *at = end;
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++)
        at = skip_cell(at, words[i], strlen(words[i]));
    l->cells = at;
    at = skip_cells(skip_cells(at, t->x, shape->n_var), t->f, shape->n_obj);
    l->n_cells = at ? (size_t)(at - l->cells) : 0;
    at = skip_cells(at, t->extra, shape->n_extra);
    return at && strcmp(at, "\n") == 0;
}

static Status take_row(sqlite3_stmt *row, void *user, Err *err)
{
    Reading *r = user;
    Evaluation *e;
    TRY(evaluation_table_add(r->table, &e, err));
    const RowText text = take_text(row, e);
    TRY(parse_row(r, &text, e, err));
    if (r->lines && r->lines->are_same)
        r->lines->are_same = is_next_line(r->lines, r->table, e, &text);
    return check_row(r, e, &text, row, err);
}

/* Every row of the query through `take`, whose user is the Reading. */
static Status each_row(Reading *r, DatabaseRowFn take, void *user, long first, long last, Err *err)
{
    char sql[sizeof EVALUATIONS + 48];
    r->kind = KIND_UNFINISHED;
    snprintf(sql, sizeof sql, EVALUATIONS, first, last);
    Status status = database_each(r->db, sql, take, user, err);
    if (status == STATUS_OK)
        status = compare_digests(r, err);
    for (size_t i = 0; i < HASH_LANES; i++)
        free(r->unchecked[i].message);
    if (status != STATUS_OK || !r->without || !r->has_with)
        return status;
    return fail(err, STATUS_IO, "%s: is damaged: evaluation %ld has no digest, as if it were not what was written",
                database_path(r->db), r->without);
}

Status rows_read(Database *db, EvaluationTable *table, long first, long last, Err *err)
{
    Reading r = {.table = table, .db = db};
    return each_row(&r, take_row, &r, first, last, err);
}

typedef struct {
    Reading reading;
    EvaluationFn take;
    void *user;
} Passing;

static Status pass_row(sqlite3_stmt *row, void *user, Err *err)
{
    Passing *p = user;
    p->reading.table->n = 0;
    TRY(take_row(row, &p->reading, err));
    return p->take(p->reading.table->row, p->user, err);
}

Status rows_each(Database *db, EvaluationTable *room, long first, long last, RowLines *lines, EvaluationFn take,
                 void *user, Err *err)
{
    Passing p = {{.table = room, .db = db, .lines = lines}, take, user};
    return each_row(&p.reading, pass_row, &p, first, last, err);
}

/* -- as lines ------------------------------------------------------------------------------------------------------ */

int rows_put_texts(FILE *f, const char *list, size_t n, const char *before, const char *missing)
{
    static const char NUMBER[] = "0123456789.-+e";
    const char *at = list[0] ? list + 1 : list;
    for (size_t i = 0; i < n; i++) {
        const size_t length = strspn(at, NUMBER);
        fputs_unlocked(i == 0 ? before : ",", f);
        fwrite_unlocked(at, 1, length, f);
        if (length == 0)
            fputs_unlocked(missing, f);
        at += length == 0 && strncmp(at, "null", 4) == 0 ? 4 : length;
        if (*at == ',')
            at++;
        else if (*at != 0 && *at != ']')
            return 0;
    }
    return *at == 0 || *at == ']';
}

static int put_cells(FILE *f, const char *list, size_t n)
{
    return rows_put_texts(f, list, n, ",", "");
}

typedef struct {
    Reading reading;
    FILE *f;
    RowShape shape;
    int unfinished_too;
    size_t *n;
    char room[REASON_MAX];
} Printing;

static Status print_row(sqlite3_stmt *row, void *user, Err *err)
{
    Printing *p = user;
    Evaluation e;
    const RowText t = take_text(row, &e);
    const RowShape *s = &p->shape;
    e.room = p->room;
    if (e.kind == KIND_UNFINISHED && !p->unfinished_too)
        return STATUS_OK;
    TRY(parse_outcome(&p->reading, &t, &e, err));
    fprintf(p->f, "%ld,%ld,%s,%s,%s", e.id, e.generation, kind_word(e.kind), outcome_word(e.outcome), e.reason);
    if (!put_cells(p->f, t.x, s->n_var) || !put_cells(p->f, t.f, s->n_obj) || !put_cells(p->f, t.extra, s->n_extra))
        return damaged(&p->reading, "a number", e.id, err);
    putc_unlocked('\n', p->f);
    ++*p->n;
    return check_row(&p->reading, &e, &t, row, err);
}

Status rows_print(Database *db, FILE *f, RowShape shape, long first, long last, int unfinished_too, size_t *n, Err *err)
{
    Printing p = {{.db = db}, f, shape, unfinished_too, n, {0}};
    *n = 0;
    return each_row(&p.reading, print_row, &p, first, last, err);
}

typedef struct {
    RowTextFn take;
    void *user;
} Texts;

static Status take_texts(sqlite3_stmt *row, void *user, Err *err)
{
    const Texts *t = user;
    const RowNumbers numbers = {(long)sqlite3_column_int64(row, 0), column_text(row, 1), column_text(row, 2),
                                column_text(row, 3)};
    return t->take(&numbers, t->user, err);
}

Status rows_each_text(Database *db, RowTextFn take, void *user, Err *err)
{
    return database_each(db, "SELECT id, x, f, extra FROM evaluation ORDER BY id", take_texts, &(Texts){take, user},
                         err);
}
