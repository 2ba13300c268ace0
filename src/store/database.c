#include "store/database.h"

#include <errno.h>
#include <limits.h>
#include <stdarg.h>
#include <sys/stat.h>
#include <sys/vfs.h>
#include <unistd.h>

#include "store/output.h"

/* Between machines a reader holds the writer up, and the other way round, over a network. */
enum { BUSY_MS = 3000, SHARED_BUSY_MS = 60000, KEPT_STATEMENTS = 12 };

struct Database {
    sqlite3 *db;
    char path[PATH_MAX];
    int is_shared;                       /* with other machines: no WAL */
    sqlite3_stmt *kept[KEPT_STATEMENTS]; /* prepared, the one used last first */
    dev_t device; /* of the file that was opened for writing, and its number there; 0: none was */
    ino_t file;
    double version; /* of what it holds, as this connection has left it; 0: nothing was asked yet */
};

const char *database_path(const Database *d)
{
    return d->path;
}

int database_in_transaction(const Database *d)
{
    return sqlite3_get_autocommit(d->db) == 0;
}

int database_changes(const Database *d)
{
    return sqlite3_changes(d->db);
}

const char *column_text(sqlite3_stmt *row, int column)
{
    const char *text = (const char *)sqlite3_column_text(row, column);
    return text ? text : "";
}

double column_number(sqlite3_stmt *row, int column)
{
    const double value = sqlite3_column_double(row, column); /* NULL: 0 */
    return value == 0.0 && sqlite3_column_type(row, column) == SQLITE_NULL ? NAN : value;
}

long column_whole(sqlite3_stmt *row, int column, long otherwise)
{
    return sqlite3_column_type(row, column) == SQLITE_NULL ? otherwise : sqlite3_column_int64(row, column);
}

/* -- faults -------------------------------------------------------------------------------------------------------- */

/* The fault in our words, and what to do about it. */
static Status explain(const char *path, int code, const char *said, Err *err)
{
    switch (code & 0xff) {
    case SQLITE_NOMEM:
        return fail(err, STATUS_NO_MEMORY, "%s: out of memory", path);
    case SQLITE_FULL:
        return fail(err, STATUS_IO, "%s: cannot be written: the disk is full; what was stored before can be read",
                    path);
    case SQLITE_READONLY:
    case SQLITE_PERM:
        return fail(err, STATUS_IO, "%s: cannot be written: file or folder is read-only", path);
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
        return fail(err, STATUS_IO, "%s: is busy: another program has kept it locked for %d s", path, BUSY_MS / 1000);
    case SQLITE_CORRUPT:
        return fail_sub(err, STATUS_IO, SUB_DAMAGED,
                        "%s: is damaged (%s); `sqlite3 FILE .recover` saves what can be read", path, said);
    case SQLITE_NOTADB:
        return fail_sub(err, STATUS_BAD_DATA, SUB_NO_RUN, "%s: is no database of a run", path);
    case SQLITE_CANTOPEN:
        return fail(err, STATUS_IO, "%s: cannot be opened: %s", path, said);
    default:
        return fail(err, STATUS_IO, "%s: cannot be read or written: %s (%s)", path, said, strerror(errno));
    }
}

static Status complain(const Database *d, Err *err)
{
    return explain(d->path, sqlite3_extended_errcode(d->db), sqlite3_errmsg(d->db), err);
}

Status database_damaged(const Database *d, Err *err, const char *format, ...)
{
    char what[200];
    va_list args;
    va_start(args, format);
    vsnprintf(what, sizeof what, format, args);
    va_end(args);
    return fail_sub(err, STATUS_IO, SUB_DAMAGED, "%s: is damaged: %s", d->path, what);
}

/* -- statements ---------------------------------------------------------------------------------------------------- */

/* The statement moves to the front; the one that was not used for longest goes. */
Status database_statement(Database *d, const char *sql, sqlite3_stmt **s, Err *err)
{
    size_t i = 0;
    while (i < KEPT_STATEMENTS - 1 && d->kept[i] && strcmp(sqlite3_sql(d->kept[i]), sql) != 0)
        i++;
    *s = d->kept[i];
    if (*s && strcmp(sqlite3_sql(*s), sql) != 0) {
        sqlite3_finalize(*s);
        *s = NULL;
    }
    const int code = *s ? SQLITE_OK : sqlite3_prepare_v2(d->db, sql, -1, s, NULL);
    memmove(d->kept + 1, d->kept, i * sizeof *d->kept);
    d->kept[0] = *s;
    return code == SQLITE_OK ? STATUS_OK : complain(d, err);
}

static void forget_statements(Database *d)
{
    for (size_t i = 0; i < KEPT_STATEMENTS; i++) {
        sqlite3_finalize(d->kept[i]);
        d->kept[i] = NULL;
    }
}

Status database_run(Database *d, sqlite3_stmt *s, Err *err)
{
    const int code = sqlite3_step(s);
    if (code != SQLITE_DONE && code != SQLITE_ROW) {
        const Status status = complain(d, err);
        forget_statements(d);
        return status;
    }
    sqlite3_reset(s);
    sqlite3_clear_bindings(s);
    return STATUS_OK;
}

Status database_do(Database *d, Err *err, const char *sql, const char *types, ...)
{
    sqlite3_stmt *s;
    int code = SQLITE_OK;
    if (!*types)
        return sqlite3_exec(d->db, sql, NULL, NULL, NULL) == SQLITE_OK ? STATUS_OK : complain(d, err);
    TRY(database_statement(d, sql, &s, err));
    va_list values;
    va_start(values, types);
    for (int i = 1; code == SQLITE_OK && types[i - 1]; i++) {
        const char *text;
        const void *bytes;
        double number;
        switch (types[i - 1]) {
        case 'i':
            code = sqlite3_bind_int64(s, i, va_arg(values, long));
            break;
        case 'd':
            number = va_arg(values, double);
            code = isfinite(number) ? sqlite3_bind_double(s, i, number) : sqlite3_bind_null(s, i);
            break;
        case 't':
            text = va_arg(values, const char *);
            code = text ? sqlite3_bind_text(s, i, text, -1, SQLITE_TRANSIENT) : sqlite3_bind_null(s, i);
            break;
        default:
            bytes = va_arg(values, const void *);
            code = sqlite3_bind_blob64(s, i, bytes, va_arg(values, size_t), SQLITE_TRANSIENT);
        }
    }
    va_end(values);
    return code == SQLITE_OK ? database_run(d, s, err) : complain(d, err);
}

Status database_each(Database *d, const char *sql, DatabaseRowFn take, void *user, Err *err)
{
    sqlite3_stmt *s = NULL;
    Status status = STATUS_OK;
    int code = sqlite3_prepare_v2(d->db, sql, -1, &s, NULL);
    while (code == SQLITE_OK && (code = sqlite3_step(s)) == SQLITE_ROW) {
        status = take(s, user, err);
        code = status == STATUS_OK ? SQLITE_OK : SQLITE_DONE;
    }
    if (code != SQLITE_DONE)
        status = complain(d, err);
    sqlite3_finalize(s);
    return status;
}

static Status take_number(sqlite3_stmt *row, void *user, Err *err)
{
    (void)err;
    *(double *)user = sqlite3_column_double(row, 0); /* NULL: 0 */
    return STATUS_OK;
}

Status database_number(Database *d, const char *sql, double *value, Err *err)
{
    *value = 0;
    return database_each(d, sql, take_number, value, err);
}

/* Of a number that changes where another connection has written. */
Status database_begin(Database *d, Err *err)
{
    double version;
    TRY(database_do(d, err, "BEGIN IMMEDIATE", ""));
    Status status = database_number(d, "PRAGMA data_version", &version, err);
    if (status == STATUS_OK && d->version > 0 && version != d->version)
        status = fail(err, STATUS_IO, "%s: another process has written to it, which works on the same run", d->path);
    d->version = version;
    if (status != STATUS_OK)
        database_do(d, NULL, "ROLLBACK", "");
    return status;
}

/* -- opening ------------------------------------------------------------------------------------------------------- */

/* File systems of several machines, by the number that each has in Linux (linux/magic.h, and the sources of Lustre,
 * GPFS and BeeGFS). */
static int is_shared(const char *path)
{
    static const unsigned KINDS[] = {0x6969 /* NFS */,
                                     0x0bd00bd0 /* Lustre */,
                                     0x47504653 /* GPFS */,
                                     0x00c36400 /* CephFS */,
                                     0x19830326 /* BeeGFS */,
                                     0xff534d42 /* CIFS */,
                                     0xfe534d42 /* SMB2 */};
    struct statfs about;
    if (statfs(path, &about) != 0)
        return 0;
    size_t i = 0;
    while (i < N_OF(KINDS) && (unsigned)about.f_type != KINDS[i])
        i++;
    return i < N_OF(KINDS);
}

/* SQLite does not follow a path that goes up beyond the root: it gets the folder's real one. Where there is none, path
 * itself, for SQLite to say what is wrong. */
static const char *real_path(const char *path, char real[PATH_MAX])
{
    char folder[PATH_MAX], found[PATH_MAX];
    const char *slash = strrchr(path, '/');
    if (!slash || slash == path || slash - path >= PATH_MAX)
        return path;
    snprintf(folder, sizeof folder, "%.*s", (int)(slash - path), path);
    return realpath(folder, found) && snprintf(real, PATH_MAX, "%s%s", found, slash) < PATH_MAX ? real : path;
}

/* name: of it for SQLite. */
static Status open_file(Database **out, const char *path, const char *name, int flags, Err *err)
{
    Database *d = calloc(1, sizeof *d);
    *out = NULL;
    if (!d || snprintf(d->path, sizeof d->path, "%s", path) >= (int)sizeof d->path) {
        free(d);
        return fail(err, d ? STATUS_IO : STATUS_NO_MEMORY, "%.200s: cannot be opened: path too long or no memory",
                    path);
    }
    const int code = sqlite3_open_v2(name, &d->db, flags | SQLITE_OPEN_NOMUTEX, NULL);
    if (code != SQLITE_OK) {
        const Status status = d->db ? complain(d, err) : explain(path, code, sqlite3_errstr(code), err);
        sqlite3_close(d->db);
        free(d);
        return status;
    }
    sqlite3_extended_result_codes(d->db, 1);
    d->is_shared = is_shared(path);
    sqlite3_busy_timeout(d->db, d->is_shared ? SHARED_BUSY_MS : BUSY_MS);
    sqlite3_db_config(d->db, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, NULL);
    sqlite3_db_config(d->db, SQLITE_DBCONFIG_ENABLE_TRIGGER, 0, NULL);
    *out = d;
    return STATUS_OK;
}

static Status take_word(sqlite3_stmt *row, void *user, Err *err)
{
    (void)err;
    snprintf(user, 200, "%s", (const char *)sqlite3_column_text(row, 0));
    return STATUS_OK;
}

void database_grow(Database *d)
{
    sqlite3_limit(d->db, SQLITE_LIMIT_LENGTH, INT_MAX);
}

/* What was opened: no row is longer than the file and its journal, as a damaged file may claim; a writer commits for
 * good, and remembers which file it has. It is ours, of a format that is known, and whole. */
static Status prepare(Database *d, DatabaseMode mode, Err *err)
{
    /* A view or a virtual table in the place of a table could compute rows without end. */
    static const char FOREIGN[] = "SELECT count(*) FROM sqlite_schema WHERE type <> 'table' OR "
                                  "coalesce(rootpage, 0) < 2 OR sql LIKE '%virtual%'";
    enum { SLACK = 1 << 20 };
    char journal[PATH_MAX + 8], word[200] = "";
    double application, format, foreign;
    struct stat file = {0}, beside = {0}; /* of one that is not there: 0 bytes */
    snprintf(journal, sizeof journal, "%s-wal", d->path);
    const int is_there = stat(d->path, &file) == 0;
    stat(journal, &beside);
    sqlite3_limit(d->db, SQLITE_LIMIT_LENGTH,
                  (int)fmin(2.0 * (double)(file.st_size + beside.st_size) + SLACK, INT_MAX));
    if (mode == DATABASE_WRITE) {
        TRY(database_do(d, err, d->is_shared ? "PRAGMA journal_mode=DELETE" : "PRAGMA journal_mode=WAL", ""));
        TRY(database_do(d, err, "PRAGMA synchronous=FULL", ""));
    }
    if (mode == DATABASE_WRITE && is_there) {
        d->device = file.st_dev;
        d->file = file.st_ino;
    }
    TRY(database_number(d, "PRAGMA data_version", &d->version, err));
    TRY(database_number(d, "PRAGMA application_id", &application, err));
    TRY(database_number(d, "PRAGMA user_version", &format, err));
    if (application != DATABASE_APPLICATION)
        return fail_sub(err, STATUS_BAD_DATA, SUB_NO_RUN, "%s: is no database of a run", d->path);
    if (format != DATABASE_FORMAT)
        return fail(err, STATUS_IO,
                    "%s: has format %g, this program reads %d; %s imtet wrote it: only that one can resume it, its "
                    "front.csv and settings.ini can be read by anyone",
                    d->path, format, DATABASE_FORMAT, format > DATABASE_FORMAT ? "a newer" : "an older");
    TRY(database_number(d, FOREIGN, &foreign, err));
    if (foreign > 0)
        return fail(err, STATUS_IO, "%s: is no database of a run: it holds views or triggers", d->path);
    TRY(database_each(d, "PRAGMA quick_check(1)", take_word, word, err));
    for (char *end; (end = strchr(word, '\n'));) /* of several lines */
        *end = ' ';
    return strcmp(word, "ok") == 0 ? STATUS_OK : explain(d->path, SQLITE_CORRUPT, word, err);
}

/* Another way to open a file for reading, where the first one needs what the folder does not allow. A commit that a
 * killed writer left half done is rolled back by whoever may write. A folder that may not be written to has no place
 * for the memory by which processes share a journal: the file is read without, and without locks, for nobody writes
 * there; with no journal the file is all. */
static Status open_otherwise(Database **out, const char *path, Err *err)
{
    char folder[PATH_MAX], real[PATH_MAX], journal[PATH_MAX + 8], uri[3 * PATH_MAX + 40] = "file:";
    size_t n = strlen(uri);
    folder_of(path, folder);
    const char *name = real_path(path, real);
    if (access(path, W_OK) == 0 && access(folder, W_OK) == 0) {
        TRY(open_file(out, path, name, SQLITE_OPEN_READWRITE, err));
        return prepare(*out, DATABASE_READ, err);
    }
    for (const char *c = name; *c; c++)
        n += sprintf(uri + n, strchr("%?#", *c) ? "%%%02X" : "%c", (unsigned char)*c);
    snprintf(journal, sizeof journal, "%s-wal", path);
    strcpy(uri + n, access(journal, F_OK) == 0 ? "?vfs=unix-none" : "?immutable=1");
    TRY(open_file(out, path, uri, SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, err));
    TRY(database_do(*out, err, "PRAGMA locking_mode=EXCLUSIVE", ""));
    return prepare(*out, DATABASE_READ, err);
}

Status database_open(Database **out, const char *path, DatabaseMode mode, Err *err)
{
    char real[PATH_MAX];
    struct stat there;
    *out = NULL;
    if (stat(path, &there) != 0)
        return fail(err, STATUS_MISSING, "%s: is not there", path);
    if (!S_ISREG(there.st_mode))
        return fail(err, STATUS_IO, "%s: is no file", path);
    if (there.st_size == 0)
        return fail_sub(err, STATUS_IO, SUB_EMPTY, "%s: is empty, no database of a run", path);
    TRY(open_file(out, path, real_path(path, real),
                  mode == DATABASE_WRITE ? SQLITE_OPEN_READWRITE : SQLITE_OPEN_READONLY, err));
    Status status = prepare(*out, mode, err);
    const int code = sqlite3_errcode((*out)->db) & 0xff;
    if (status != STATUS_OK && mode == DATABASE_READ && (code == SQLITE_CANTOPEN || code == SQLITE_READONLY)) {
        database_close(*out);
        status = open_otherwise(out, path, err);
    }
    if (status != STATUS_OK) {
        database_close(*out);
        *out = NULL;
    }
    return status;
}

/* -- a file that is removed while it is written to ----------------------------------------------------------------- */

void database_remove_journal(const char *path)
{
    static const char *const ENDS[] = {"-wal", "-shm", "-journal"};
    char journal[PATH_MAX + 8];
    for (size_t i = 0; i < N_OF(ENDS); i++) {
        snprintf(journal, sizeof journal, "%s%s", path, ENDS[i]);
        unlink(journal);
    }
}

Status database_check_place(Database *d, Err *err)
{
    char journal[PATH_MAX + 8], temporary[PATH_MAX + 8];
    struct stat there;
    snprintf(journal, sizeof journal, "%s-wal", d->path);
    if (stat(d->path, &there) != 0) {
        /* A copy from the file that is still open, in the place of the one that is gone; its journal went with it. */
        snprintf(temporary, sizeof temporary, "%s.tmp", d->path);
        unlink(temporary);
        TRY(database_do(d, err, "VACUUM INTO ?", "t", temporary));
        database_remove_journal(d->path);
        if (rename(temporary, d->path) != 0)
            return fail_errno(err, d->path, "was removed while the run went on, and cannot be put back");
        return fail(
            err, STATUS_IO,
            "%s: was removed while the run went on; what it held was put back: the same command resumes the run",
            d->path);
    }
    if (there.st_ino != d->file || there.st_dev != d->device)
        return fail(err, STATUS_IO, "%s: another file took its place while the run went on", d->path);
    if (d->is_shared || access(journal, F_OK) == 0)
        return STATUS_OK;
    TRY(database_do(d, err, "PRAGMA wal_checkpoint(TRUNCATE)", "")); /* out of the journal that is still open */
    return fail(err, STATUS_IO,
                "%s: was removed while the run went on; nothing is lost: the same command resumes the run", journal);
}

Status database_create(Database **out, const char *path, Err *err)
{
    char sql[128], real[PATH_MAX];
    TRY(open_file(out, path, real_path(path, real), SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, err));
    snprintf(sql, sizeof sql, "PRAGMA synchronous=FULL; PRAGMA application_id=%d; PRAGMA user_version=%d",
             DATABASE_APPLICATION, DATABASE_FORMAT);
    const Status status = database_do(*out, err, sql, "");
    if (status != STATUS_OK) {
        database_close(*out);
        *out = NULL;
    }
    return status;
}

void database_close(Database *d)
{
    if (!d)
        return;
    forget_statements(d);
    sqlite3_close(d->db);
    free(d);
}
