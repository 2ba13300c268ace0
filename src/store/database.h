/* store/database.h -- one SQLite file, opened so that what was committed is never lost; its faults in our words.
 *
 *   journal WAL, synchronous FULL   a commit returns when it is on the disk; readers never wait for the writer
 *   rollback journal                instead on NFS, Lustre, GPFS, CephFS, BeeGFS, SMB: WAL needs memory that all
 *   processes
 *                                   share, which those of several machines have not. Readers and writer wait for each
 *                                   other, up to a minute
 *   application_id, user_version    the file is ours, and the version of its tables; checked on opening, like its
 *                                   integrity
 *
 * A file from another program runs nothing: only tables are read, no views of its own and no triggers, and no row is
 * longer than the file. Every write of a run's database goes through database_do.
 *
 * Life cycle  database_create or database_open -> database_do, database_each ... -> database_close
 * Threads     one connection, one thread at a time
 * Errors      disk full, read-only, busy, damaged, of a newer version: STATUS_IO with file and cause; of another
 *             program: STATUS_BAD_DATA; no such file: STATUS_MISSING
 * Source      https://sqlite.org/wal.html, https://sqlite.org/pragma.html#pragma_synchronous */
#pragma once

#include <sqlite3.h>

#include "base/status.h"

enum {
    DATABASE_APPLICATION = 0x494d5445 /* "IMTE" */,
    DATABASE_FORMAT = 10 /* raised with every change of the tables */
};

typedef struct Database Database;

typedef enum { DATABASE_WRITE, DATABASE_READ } DatabaseMode;

/* A new file, or one that a fault left unfinished and is begun again. */
Status database_create(Database **out, const char *path, Err *err);
Status database_open(Database **out, const char *path, DatabaseMode mode, Err *err);
void database_grow(Database *d);  /* what was there is read: from here on rows may be longer than the file was */
void database_close(Database *d); /* NULL is fine; what was committed is on the disk already */
const char *database_path(const Database *d);

/* A transaction that writes; STATUS_IO where another connection has written since this one was opened, or since its own
 * last transaction: a process whose lock was removed does not mix its rows with those of the next one. */
Status database_begin(Database *d, Err *err);

/* A full disk or refused memory makes SQLite roll the whole transaction back by itself: asked after every fault. */
int database_in_transaction(const Database *d);
int database_changes(const Database *d); /* rows that the last statement changed */
/* "FILE: is damaged: ...", STATUS_IO with SUB_DAMAGED. */
__attribute__((format(printf, 3, 4))) Status database_damaged(const Database *d, Err *err, const char *format, ...);

/* The file and its journal are still where they were opened. If not: STATUS_IO, after what the database holds was put
 * back where it was removed. Not within a transaction. */
Status database_check_place(Database *d, Err *err);

/* The journal of an earlier file in that place, which SQLite would take for that of the next one. */
void database_remove_journal(const char *path);

/* One statement (or several without values) that returns no rows. types: a letter for each ? of it: i long, d double
 * (not finite: NULL), t text (NULL: NULL), b bytes (const void *, size_t). */
Status database_do(Database *d, Err *err, const char *sql, const char *types, ...);

/* A statement that is kept prepared, its values bound by the caller, and done: no rows. */
Status database_statement(Database *d, const char *sql, sqlite3_stmt **s, Err *err);
Status database_run(Database *d, sqlite3_stmt *s, Err *err);

/* `take` gets every row; a status that is not ok ends it. */
typedef Status (*DatabaseRowFn)(sqlite3_stmt *row, void *user, Err *err);
Status database_each(Database *d, const char *sql, DatabaseRowFn take, void *user, Err *err);

/* The first column of the first row, or 0 where there is none. */
Status database_number(Database *d, const char *sql, double *value, Err *err);

/* Columns of a row. */
const char *column_text(sqlite3_stmt *row, int column);           /* NULL: "" */
double column_number(sqlite3_stmt *row, int column);              /* NULL: NAN */
long column_whole(sqlite3_stmt *row, int column, long otherwise); /* NULL: otherwise */
