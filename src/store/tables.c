#include "store/tables.h"

#include <errno.h>
#include <limits.h>
#include <unistd.h>

#include "base/hash.h"
#include "base/text.h"
#include "settings/settings.h"
#include "store/folder.h"
#include "store/output.h"

/* -- the tables: a line for every column --------------------------------------------------------------------------- */

/* Of MOVED, MARK and KIND the digest knows nothing: they change after the row is written. */
typedef enum { WHOLE, MOVED, MARK, REAL, TEXT, REASON, OUTCOME, KIND } FieldType;

/* A column, and where the record of its row has the value. */
typedef struct {
    const char *name, *declared;
    FieldType type;
    size_t at, size;
} Field;

/* clang-format off */
#define NAMED(name, record, member, sql, type) {name, sql, type, offsetof(record, member), sizeof((record){0}.member)}
#define FIELD(record, member, sql, type) NAMED(#member, record, member, sql, type)

static const Field EVALUATION[] = {
    FIELD(Evaluation, id, "INTEGER PRIMARY KEY", WHOLE),
    FIELD(Evaluation, generation, "INTEGER NOT NULL", MOVED),
    FIELD(Evaluation, kind, "TEXT", KIND),
    FIELD(Evaluation, outcome, "TEXT NOT NULL", OUTCOME),
    FIELD(Evaluation, reason, "TEXT NOT NULL", REASON),
    FIELD(Evaluation, seconds, "REAL", REAL),
    FIELD(Evaluation, violation, "REAL", REAL),
};

static const Field FINER[] = {
    FIELD(Evaluation, id, "INTEGER PRIMARY KEY", WHOLE),
    FIELD(Evaluation, level, "INTEGER NOT NULL", WHOLE),
    FIELD(Evaluation, reason, "TEXT NOT NULL", REASON),
    FIELD(Evaluation, seconds, "REAL", REAL),
    FIELD(Evaluation, violation, "REAL", REAL),
};

static const Field GENERATION[] = {
    FIELD(RunGeneration, number, "INTEGER PRIMARY KEY", WHOLE),
    FIELD(RunGeneration, simulated, "INTEGER NOT NULL", WHOLE),
    FIELD(RunGeneration, failed, "INTEGER NOT NULL", WHOLE),
    FIELD(RunGeneration, front, "INTEGER NOT NULL", WHOLE),
    FIELD(RunGeneration, surrogate_error, "REAL", REAL),
    FIELD(RunGeneration, hypervolume, "REAL", REAL),
    FIELD(RunGeneration, seconds, "REAL NOT NULL", REAL),
    FIELD(RunGeneration, finished, "TEXT NOT NULL", TEXT),
    FIELD(RunGeneration, members, "INTEGER NOT NULL", WHOLE),
};

static const Field FRONT[] = {
    NAMED("evaluation", RunMark, id, "INTEGER PRIMARY KEY", WHOLE),
    FIELD(RunMark, entered, "INTEGER NOT NULL", MARK),
    FIELD(RunMark, left, "INTEGER", MARK),
};

static const Field SESSION[] = {
    FIELD(RunSession, number, "INTEGER PRIMARY KEY", WHOLE),
    FIELD(RunSession, started, "TEXT NOT NULL", TEXT),
    FIELD(RunSession, ended, "TEXT", TEXT),
    FIELD(RunSession, host, "TEXT", TEXT),
    FIELD(RunSession, pid, "INTEGER", WHOLE),
    FIELD(RunSession, program, "TEXT", TEXT),
    FIELD(RunSession, threads, "INTEGER", WHOLE),
    FIELD(RunSession, simulated_before, "INTEGER", WHOLE),
    FIELD(RunSession, seconds, "REAL", REAL),
    FIELD(RunSession, stopped, "TEXT", TEXT),
    FIELD(RunSession, is_final, "INTEGER", MARK),
    NAMED("search", RunSession, search_s, "REAL", REAL),
    NAMED("waited", RunSession, waited_s, "REAL", REAL),
    NAMED("surrogate", RunSession, surrogate_s, "REAL", REAL),
};
/* clang-format on */

typedef struct {
    const char *name;
    int has_digest; /* of the row, behind its fields */
    const Field *field;
    size_t n, size; /* fields; bytes of a record */
} TableColumns;

#define TABLE(name, has_digest, fields, record)                                                                        \
    {                                                                                                                  \
        name, has_digest, fields, N_OF(fields), sizeof(record)                                                         \
    }

static const TableColumns TABLES[N_DESCRIBED] = {
    [ROWS_EVALUATION] = TABLE("evaluation", 1, EVALUATION, Evaluation),
    [ROWS_FINER] = TABLE("finer", 1, FINER, Evaluation),
    [TABLE_GENERATION] = TABLE("generation", 1, GENERATION, RunGeneration),
    [TABLE_FRONT] = TABLE("front", 0, FRONT, RunMark),
    [TABLE_SESSION] = TABLE("session", 0, SESSION, RunSession),
};

#define OTHERS                                                                                                         \
    "CREATE TABLE run(id INTEGER PRIMARY KEY CHECK (id = 1), settings TEXT NOT NULL, provenance TEXT NOT NULL, "       \
    "planned_evals INTEGER NOT NULL, n_var INTEGER NOT NULL, created TEXT NOT NULL, "                                  \
    "tried_to_polish INTEGER NOT NULL DEFAULT 0, polished_at INTEGER NOT NULL DEFAULT 0, digest INTEGER NOT NULL);"    \
    "CREATE TABLE state(copy INTEGER PRIMARY KEY, generation INTEGER NOT NULL, bytes BLOB NOT NULL, "                  \
    "digest INTEGER NOT NULL);"

static const Field DIGEST = {"digest", "INTEGER NOT NULL", WHOLE, 0, 0};

/* Numbers of an evaluation that follow its digest: n columns named after those of the schema from `first` on, and the
 * array of the record that has them. */
typedef struct {
    size_t n, first, array;
    const char *begin, *end; /* of their names */
} Numbers;

enum { N_NUMBERS = 5, COLUMNS_MAX = 2000 /* SQLITE_MAX_COLUMN as SQLite is built by default */ };

/* What a table has of them, in the order in which this program writes them. */
static void numbers_of(RunTable table, const Schema *s, Numbers list[N_NUMBERS])
{
    const int is_finer = table == ROWS_FINER;
    const Numbers all[] = {
        {is_finer ? 0 : s->n_var, 0, offsetof(Evaluation, x), "", ""},
        {s->n_obj, s->n_var, offsetof(Evaluation, f), "", ""},
        {s->n_extra, s->n_var + s->n_obj, offsetof(Evaluation, extra), "", ""},
        {is_finer || s->has_spread ? s->n_obj : 0, s->n_var, offsetof(Evaluation, sd), "", "_sd"},
        {is_finer ? s->n_obj + s->n_extra : 0, s->n_var, offsetof(Evaluation, err), "err_", ""},
    };
    memcpy(list, all, sizeof all);
}

static double *number_at(const Evaluation *e, NumberPlace place)
{
    return *(double *const *)(const void *)((const char *)e + place.array) + place.i;
}

/* -- the text of the tables ---------------------------------------------------------------------------------------- */

/* The statements that make all tables, to be freed. Names become identifiers of SQL: in double quotes, doubled inside.
 */
static Status tables_text(const Schema *s, char **text, Err *err)
{
    size_t length;
    Numbers list[N_NUMBERS];
    *text = NULL;
    FILE *f = text_open(text, &length);
    if (!f)
        return fail_memory(err, 1, "the names of the columns");
    fputs(OTHERS, f);
    for (RunTable t = 0; t < N_DESCRIBED; t++) {
        fprintf(f, "CREATE TABLE %s(", TABLES[t].name);
        for (size_t i = 0; i < TABLES[t].n + TABLES[t].has_digest; i++) {
            const Field *field = i < TABLES[t].n ? &TABLES[t].field[i] : &DIGEST;
            fprintf(f, "%s%s %s", i > 0 ? ", " : "", field->name, field->declared);
        }
        numbers_of(t, s, list);
        for (size_t k = 0; k < N_NUMBERS && t < N_ROW_TABLES; k++)
            for (size_t c = 0; c < list[k].n; c++) {
                fprintf(f, ", \"%s", list[k].begin);
                for (const char *name = s->column[list[k].first + c].name; *name; name++)
                    fputs(*name == '"' ? "\"\"" : (char[]){*name, 0}, f);
                fprintf(f, "%s\" REAL", list[k].end);
            }
        fputs(");", f);
    }
    return text_close(f) == 0 ? STATUS_OK : fail_memory(err, 1, "the names of the columns");
}

/* The tables are made once in memory: SQLite knows which names it takes for one. */
Status tables_have_room(const Schema *s, Err *err)
{
    Numbers list[N_NUMBERS];
    size_t others = N_OF(EVALUATION) + 1;
    sqlite3 *db = NULL;
    char *text;
    Status status = STATUS_OK;
    numbers_of(ROWS_EVALUATION, s, list);
    for (size_t k = 1; k < N_NUMBERS; k++) /* behind the variables */
        others += list[k].n;
    if (s->n_var + others > COLUMNS_MAX)
        return bad_data(err,
                        "problem.variables = %zu: a run has room for %zu variables beside "
                        "%zu objectives (SQLite: %d columns)",
                        s->n_var, COLUMNS_MAX - others, s->n_obj, COLUMNS_MAX);
    TRY(tables_text(s, &text, err));
    int code = sqlite3_open(":memory:", &db);
    if (code == SQLITE_OK)
        code = sqlite3_exec(db, text, NULL, NULL, NULL);
    if (code == SQLITE_NOMEM)
        status = fail_memory(err, 1, "the names of the columns");
    else if (code != SQLITE_OK)
        status = bad_data(err,
                          "problem.variable_names: or problem.objective_names: %s; a run has columns of its own (id, "
                          "kind, g_1 ...), and E is e there",
                          sqlite3_errmsg(db));
    sqlite3_close(db);
    free(text);
    return status;
}

/* -- what a file has of them --------------------------------------------------------------------------------------- */

/* Where numbers of that name stand in the record of a row; that of column `like` is tried first. */
static NumberPlace place_of(const char *name, const Numbers list[N_NUMBERS], const Schema *s, size_t like)
{
    char known[TABLE_NAME_MAX + 8];
    size_t n = 0;
    for (size_t k = 0; k < N_NUMBERS; k++)
        n += list[k].n;
    for (size_t tried = 0; tried < n; tried++) {
        size_t k = 0, i = (like + tried) % n;
        for (; i >= list[k].n; k++)
            i -= list[k].n;
        snprintf(known, sizeof known, "%s%s%s", list[k].begin, s->column[list[k].first + i].name, list[k].end);
        if (strcmp(known, name) == 0)
            return (NumberPlace){list[k].array, i};
    }
    return (NumberPlace){0};
}

typedef struct {
    const TableColumns *table;
    Numbers list[N_NUMBERS];
    const Schema *schema;
    RowColumns *columns;
    size_t at, n_wanted; /* columns that have passed; variables and objectives among them */
    int is_right;        /* all of these columns are those of the table */
} Finding;

/* A column of a table: its fields, as this program makes them; behind them stand numbers alone, in any order. */
static Status find_column(sqlite3_stmt *row, void *user, Err *err)
{
    Finding *f = user;
    RowColumns *c = f->columns;
    const TableColumns *t = f->table;
    const char *name = column_text(row, 0), *declared = column_text(row, 1);
    const size_t at = f->at++;
    (void)err;
    if (at < t->n + t->has_digest) {
        const Field *field = at < t->n ? &t->field[at] : &DIGEST;
        f->is_right &= strcmp(name, field->name) == 0 && strcmp(declared, field->declared) == 0;
        return STATUS_OK;
    }
    f->is_right &= c->table < N_ROW_TABLES && c->n < COLUMNS_MAX && strcmp(declared, "REAL") == 0;
    if (f->is_right) {
        const NumberPlace place = c->place[c->n] = place_of(name, f->list, f->schema, c->n);
        f->n_wanted += place.array == offsetof(Evaluation, x) || place.array == offsetof(Evaluation, f);
        c->n++;
    }
    return STATUS_OK;
}

Status tables_columns(Database *db, RunTable table, const Schema *schema, RowColumns *columns, Err *err)
{
    char sql[240];
    Finding f = {.table = &TABLES[table], .schema = schema, .columns = columns, .is_right = 1};
    const size_t n_obj = table < N_ROW_TABLES ? schema->n_obj : 0;
    const size_t wanted = n_obj + (table == ROWS_EVALUATION ? schema->n_var : 0);
    *columns = (RowColumns){.table = table};
    numbers_of(table, schema, f.list);
    TRY_ROOM(columns->place, COLUMNS_MAX, "columns", err);
    snprintf(sql, sizeof sql,
             "SELECT name, type || iif(\"notnull\", ' NOT NULL', '') || iif(pk, ' PRIMARY KEY', '') || "
             "coalesce(dflt_value, '') || iif(hidden, ' HIDDEN', '') FROM pragma_table_xinfo('%s')",
             f.table->name);
    Status status = database_each(db, sql, find_column, &f, err);
    if (status == STATUS_OK && !(f.is_right && f.at >= f.table->n + f.table->has_digest && f.n_wanted == wanted))
        status = database_damaged(db, err, "its table %s is not that of this run", f.table->name);
    if (status != STATUS_OK) {
        free(columns->place);
        columns->place = NULL;
    }
    return status;
}

Status tables_check(Database *db, const Schema *schema, Err *err)
{
    /* SQLite keeps the statements as they were written. */
    static const char KNOWN[] = "SELECT count(*) FROM sqlite_schema WHERE instr('" OTHERS "', sql || ';') > 0";
    double n_known;
    for (RunTable t = 0; t < N_DESCRIBED; t++) {
        RowColumns columns;
        TRY(tables_columns(db, t, schema, &columns, err));
        free(columns.place);
    }
    TRY(database_number(db, KNOWN, &n_known, err));
    return n_known == 2 ? STATUS_OK : database_damaged(db, err, "its tables run and state are not those of this run");
}

/* -- digests ------------------------------------------------------------------------------------------------------- */

/* A step for 64 bits: FNV-1a a word at a time, its high bits mixed into the low ones. */
static uint64_t digest_whole(long value, uint64_t hash)
{
    hash = (hash ^ (uint64_t)value) * HASH_PRIME;
    return hash ^ hash >> 32;
}

static uint64_t digest_text(const char *text, uint64_t hash)
{
    return hash_fnv1a(text, strlen(text) + 1, hash);
}

uint64_t digest_member(long id)
{
    return digest_whole(id, HASH_SEED);
}

long state_digest(long generation, const void *bytes, size_t n)
{
    return hash_fnv1a(bytes, n, digest_whole(generation, HASH_SEED));
}

/* Kind and generation of an evaluation change after it is written: their part is joined to the rest by exclusive or. */
static uint64_t digest_kind(EvaluationKind kind, long generation)
{
    return kind == KIND_UNFINISHED ? 0 : digest_text(kind_word(kind), digest_whole(generation, HASH_SEED));
}

/* -- a new database ------------------------------------------------------------------------------------------------ */

static long digest_of_head(const char *settings, const char *provenance, long planned_evals, long n_var)
{
    return digest_whole(n_var, digest_whole(planned_evals, digest_text(provenance, digest_text(settings, HASH_SEED))));
}

int tables_head_is_whole(sqlite3_stmt *row)
{
    return column_whole(row, 6, 0) ==
           digest_of_head(column_text(row, 0), column_text(row, 1), column_whole(row, 2, 0), column_whole(row, 3, 0));
}

Status tables_create(const char *path, const Schema *schema, const Settings *used, const char *provenance, Err *err)
{
    static const char INSERT[] = "INSERT INTO run(id, settings, provenance, planned_evals, n_var, created, digest) "
                                 "VALUES (1, ?, ?, ?, ?, ?, ?)";
    char temporary[PATH_MAX + 8], created[24], *tables = NULL, *text = settings_text(used);
    const long evals = used->search.max_evals;
    Database *db = NULL;
    snprintf(temporary, sizeof temporary, "%s.tmp", path);
    unlink(temporary);
    utc_now(created);
    Status status = text ? tables_have_room(schema, err) : fail_memory(err, 1, "the settings");
    THEN(status, tables_text(schema, &tables, err));
    THEN(status, database_create(&db, temporary, err));
    THEN(status, database_do(db, err, "BEGIN", ""));
    THEN(status, database_do(db, err, tables, ""));
    THEN(status, database_do(db, err, INSERT, "ttiiti", text, provenance, evals, schema->n_var, created,
                             digest_of_head(text, provenance, evals, schema->n_var)));
    THEN(status, database_do(db, err, "COMMIT", ""));
    database_close(db);
    free(tables);
    free(text);
    TRY(status);
    database_remove_journal(path);
    if (rename(temporary, path) != 0)
        return fail_errno(err, path, "cannot be put in place");
    output_sync_folder(path);
    return STATUS_OK;
}

Status tables_set_settings(Database *db, const Settings *used, const Run *run, Err *err)
{
    char *text = settings_text(used);
    if (!text)
        return fail_memory(err, 1, "the settings");
    const Status status =
        database_do(db, err, "UPDATE run SET settings = ?, provenance = ?, digest = ?", "tti", text, run->provenance,
                    digest_of_head(text, run->provenance, run->planned_evals, run->schema.n_var));
    free(text);
    return status;
}

/* -- records ------------------------------------------------------------------------------------------------------- */

/* A row that is written or read column by column, and the digest of what has passed. */
typedef struct {
    sqlite3_stmt *s;
    int reads, at; /* columns that have passed */
    uint64_t digest;
} Row;

/* NULL stands for what is not finite; the digest is of numbers as SQLite gives them back: -0 as 0, and one value for
 * all that are not finite. */
static void pass_number(Row *r, double *value)
{
    long bits;
    if (r->reads)
        *value = column_number(r->s, r->at);
    else if (isfinite(*value))
        sqlite3_bind_double(r->s, r->at + 1, *value);
    r->at++;
    const double known = isfinite(*value) ? *value + 0.0 : -1e308;
    memcpy(&bits, &known, sizeof bits);
    r->digest = digest_whole(bits, r->digest);
}

/* A column of a record: what is not bound is NULL, and a reason that is read is SQLite's until the next row. */
static void pass_field(Row *r, const Field *f, void *record)
{
    void *field = (char *)record + f->at;
    const char **reason = field, *text = f->type >= TEXT && r->reads ? column_text(r->s, r->at) : NULL;
    switch (f->type) {
    case REAL:
        pass_number(r, field);
        return;
    case WHOLE:
    case MOVED:
        if (r->reads)
            *(long *)field = sqlite3_column_int64(r->s, r->at);
        else
            sqlite3_bind_int64(r->s, r->at + 1, *(long *)field);
        r->digest = digest_whole(f->type == WHOLE ? *(long *)field : 0, r->digest);
        break;
    case MARK:
        if (r->reads)
            *(int *)field = (int)column_whole(r->s, r->at, NEVER);
        else if (*(int *)field != NEVER)
            sqlite3_bind_int(r->s, r->at + 1, *(int *)field);
        break;
    case TEXT:
        if (r->reads)
            snprintf(field, f->size, "%s", text);
        else
            text = field;
        break;
    case REASON:
        if (r->reads)
            *reason = text;
        else
            text = *reason ? *reason : "";
        break;
    case OUTCOME:
        if (r->reads)
            *(Outcome *)field = outcome_of_word(text);
        else
            text = outcome_word(*(Outcome *)field);
        break;
    case KIND:
        if (r->reads)
            *(EvaluationKind *)field = kind_of_word(text);
        else
            text = *(EvaluationKind *)field == KIND_UNFINISHED ? "" : kind_word(*(EvaluationKind *)field);
    }
    r->at++;
    if (text && !r->reads && (*text || f->type == REASON))
        sqlite3_bind_text(r->s, r->at, text, -1, SQLITE_STATIC);
    if (text && f->type != KIND)
        r->digest = digest_text(text, r->digest);
}

/* INSERT with n places, and the fields in the first of them. */
static Status begin_insert(Database *db, const TableColumns *t, size_t n, void *record, Row *r, Err *err)
{
    char sql[4200]; /* 2 for each of 2,000 columns */
    int at = snprintf(sql, sizeof sql, "INSERT OR REPLACE INTO %s VALUES (?", t->name);
    for (size_t i = 1; i < n; i++) {
        sql[at++] = ',';
        sql[at++] = '?';
    }
    snprintf(sql + at, 2, ")");
    *r = (Row){.digest = HASH_SEED};
    TRY(database_statement(db, sql, &r->s, err));
    for (size_t i = 0; i < t->n; i++)
        pass_field(r, &t->field[i], record);
    return STATUS_OK;
}

Status record_put(Database *db, RunTable table, void *record, Err *err)
{
    const TableColumns *t = &TABLES[table];
    Row r;
    TRY(begin_insert(db, t, t->n + t->has_digest, record, &r, err));
    if (t->has_digest)
        sqlite3_bind_int64(r.s, r.at + 1, r.digest);
    return database_run(db, r.s, err);
}

typedef struct {
    Database *db;
    const TableColumns *table;
    char *list;
    size_t n;
} Records;

/* A row becomes the next record of the list, which grows at powers of two. */
static Status take_record(sqlite3_stmt *row, void *user, Err *err)
{
    Records *r = user;
    const TableColumns *t = r->table;
    if ((r->n & (r->n - 1)) == 0) {
        char *wider = realloc(r->list, (r->n > 0 ? 2 * r->n : 1) * t->size);
        if (!wider)
            return fail(err, STATUS_NO_MEMORY, "%s: no memory for %zu rows of %s", database_path(r->db), r->n, t->name);
        r->list = wider;
    }
    char *record = r->list + r->n++ * t->size;
    Row taken = {.s = row, .reads = 1, .digest = HASH_SEED};
    memset(record, 0, t->size);
    for (size_t i = 0; i < t->n; i++)
        pass_field(&taken, &t->field[i], record);
    if (t->has_digest && sqlite3_column_int64(row, taken.at) != (long)taken.digest)
        return database_damaged(r->db, err, "%s %lld is not what was written", t->name, sqlite3_column_int64(row, 0));
    return STATUS_OK;
}

Status records_read(Database *db, RunTable table, void *list, size_t *n, Err *err)
{
    char sql[64];
    Records r = {.db = db, .table = &TABLES[table]};
    snprintf(sql, sizeof sql, "SELECT * FROM %s ORDER BY 1", r.table->name);
    const Status status = database_each(db, sql, take_record, &r, err);
    memcpy(list, &r.list, sizeof r.list);
    *n = r.n;
    return status;
}

/* -- rows of evaluations ------------------------------------------------------------------------------------------- */

Status rows_insert(Database *db, const RowColumns *columns, const Schema *schema, const Evaluation *e, Err *err)
{
    double none[OBJECTIVES_MAX];
    const TableColumns *t = &TABLES[columns->table];
    Evaluation row = *e;
    Row r;
    for (size_t k = 0; k < schema->n_obj; k++)
        none[k] = NAN;
    row.f = e->outcome == OUTCOME_OK ? e->f : none;
    row.sd = e->sd ? e->sd : none;
    TRY(begin_insert(db, t, t->n + 1 + columns->n, &row, &r, err));
    const int digest_at = ++r.at;
    for (size_t i = 0; i < columns->n; i++)
        pass_number(&r, columns->place[i].array ? number_at(&row, columns->place[i]) : &(double){NAN});
    sqlite3_bind_int64(r.s, digest_at, (r.digest ^ digest_kind(e->kind, e->generation)));
    return database_run(db, r.s, err);
}

/* The exclusive or that SQL lacks is (a | b) - (a & b). */
Status rows_finish(Database *db, long id, EvaluationKind kind, long generation, Err *err)
{
    const long digest = digest_kind(kind, generation);
    TRY(database_do(db, err,
                    "UPDATE evaluation SET kind = ?, generation = ?, digest = (digest | ?) - (digest & ?) WHERE id = ?",
                    "tiiii", kind_word(kind), generation, digest, digest, id));
    return database_changes(db) == 1
               ? STATUS_OK
               : fail(err, STATUS_INTERNAL, "%s: the search knows of evaluation %ld, which is not stored",
                      database_path(db), id);
}

typedef struct {
    Database *db;
    RowColumns columns;
    EvaluationTable room; /* of one row */
    EvaluationFn take;
    void *user;
} Reading;

/* A row becomes the one evaluation that there is room for, and is handed on. */
static Status take_row(sqlite3_stmt *row, void *user, Err *err)
{
    Reading *r = user;
    Evaluation *e = r->room.row;
    const TableColumns *t = &TABLES[r->columns.table];
    Row taken = {.s = row, .reads = 1, .digest = HASH_SEED};
    for (size_t i = 0; i < t->n; i++)
        pass_field(&taken, &t->field[i], e);
    const uint64_t digest = (uint64_t)sqlite3_column_int64(row, taken.at++);
    for (size_t i = 0; i < r->columns.n; i++)
        pass_number(&taken, r->columns.place[i].array ? number_at(e, r->columns.place[i]) : &(double){0});
    if (digest != (taken.digest ^ digest_kind(e->kind, e->generation)))
        return database_damaged(r->db, err, "evaluation %ld is not what was written", e->id);
    evaluation_set_outcome(e, e->outcome, e->reason);
    return r->take(e, r->user, err);
}

Status rows_each(Database *db, RunTable table, const Schema *s, const char *where, EvaluationFn take, void *user,
                 Err *err)
{
    char sql[200];
    Evaluation *row;
    const size_t n_err = table == ROWS_FINER ? s->n_obj + s->n_extra : 0;
    Reading r = {
        .db = db, .room = evaluation_table(s->n_var, s->n_obj, s->n_extra + n_err), .take = take, .user = user};
    snprintf(sql, sizeof sql, "SELECT * FROM %s WHERE %s ORDER BY id", TABLES[table].name, where);
    Status status = tables_columns(db, table, s, &r.columns, err);
    THEN(status, evaluation_table_add(&r.room, &row, err));
    if (status == STATUS_OK && n_err > 0)
        row->err = row->extra + s->n_extra;
    THEN(status, evaluation_table_give_room(row, err));
    THEN(status, database_each(db, sql, take_row, &r, err));
    evaluation_table_free(&r.room);
    free(r.columns.place);
    return status;
}
