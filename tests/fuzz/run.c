/* A run's database that somebody else sent: its bytes, and what its cells hold. */
#include "targets.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/csv.h"
#include "store/run_read.h"

static void demand_run(Run *h)
{
    for (size_t i = 0; i < h->table.n; i++)
        if (h->place[i].on_front && !h->place[i].ok)
            abort();
    run_free(h);
}

static void load(const char *path)
{
    Err err = {0};
    Database *d;
    Run h;
    if (database_open(&d, path, DATABASE_READ, &err) != STATUS_OK) {
        if (!err.text[0])
            abort();
        return;
    }
    const Status status = run_load(&h, d, "", RUN_WHOLE, &err);
    if (status == STATUS_OK)
        demand_run(&h);
    else if (!err.text[0])
        abort();
    database_close(d);
}

/* SQLite wants a path that stays where it is: a file in memory, of this process alone. */
static void write_run(const void *data, size_t size, char path[64])
{
    snprintf(path, 64, "/dev/shm/imtet-fuzz-%ld", (long)getpid());
    const int fd = open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    if (fd < 0 || write(fd, data, size) != (ssize_t)size)
        abort();
    close(fd);
}

static void load_and_remove(const char *path)
{
    char beside[80];
    load(path);
    snprintf(beside, sizeof beside, "%s-wal", path);
    unlink(beside);
    snprintf(beside, sizeof beside, "%s-shm", path);
    unlink(beside);
    unlink(path);
}

void fuzz_database(const uint8_t *data, size_t size)
{
    char path[64];
    write_run(data, size, path);
    load_and_remove(path);
}

/* The next field of the input, up to a byte of 30; NULL: there is none. */
static const char *next_field(const char **rest, const char *end, int *length)
{
    const char *field = *rest;
    if (!field || field > end)
        return NULL;
    const char *stop = memchr(field, 30, (size_t)(end - field));
    *length = (int)((stop ? stop : end) - field);
    *rest = stop ? stop + 1 : NULL;
    return field;
}

/* A field `as it is` ("=" alone) leaves the cell of the template. */
static void put(sqlite3 *db, const char *sql, const char *text, int length)
{
    sqlite3_stmt *s;
    if (length == 1 && text[0] == '=')
        return;
    if (sqlite3_prepare_v2(db, sql, -1, &s, NULL) != SQLITE_OK)
        abort();
    sqlite3_bind_text(s, 1, text, length, SQLITE_TRANSIENT);
    sqlite3_step(s); /* what the table itself refuses stays as it was */
    sqlite3_finalize(s);
}

void fuzz_cells(const uint8_t *data, size_t size)
{
    static const char *const UPDATES[] = {
        "UPDATE run SET settings = ?",
        "UPDATE run SET provenance = ?",
        "UPDATE run SET n_var = ?",
        "UPDATE evaluation SET x1 = ? WHERE id = 3",
        "UPDATE evaluation SET f1 = ? WHERE id = 4",
        "UPDATE evaluation SET digest = ? WHERE id = 5",
        "UPDATE state SET bytes = ? WHERE copy = 1",
        "UPDATE evaluation SET outcome = ? WHERE id = 7",
        "UPDATE evaluation SET reason = ? WHERE id = 8",
        "UPDATE evaluation SET kind = ? WHERE id = 9",
        "UPDATE evaluation SET violation = ? WHERE id = 10",
        "UPDATE front SET entered = ?",
        "UPDATE evaluation SET id = ? WHERE id = 11",
        "UPDATE generation SET hypervolume = ?",
        "UPDATE session SET stopped = ?",
    };
    char path[64], *template;
    size_t length;
    sqlite3 *db;
    Err err = {0};
    if (file_read("tests/fuzz/run.sqlite", FILE_LARGEST, &template, &length, &err) != STATUS_OK)
        abort();
    write_run(template, length, path);
    free(template);
    if (sqlite3_open_v2(path, &db, SQLITE_OPEN_READWRITE, NULL) != SQLITE_OK)
        abort();
    sqlite3_exec(db, "PRAGMA journal_mode=OFF; PRAGMA synchronous=OFF; BEGIN", NULL, NULL, NULL);
    const char *rest = (const char *)data, *end = rest + size, *field;
    int n = 0;
    for (size_t i = 0; i < sizeof UPDATES / sizeof UPDATES[0] && (field = next_field(&rest, end, &n)); i++)
        put(db, UPDATES[i], field, n);
    sqlite3_exec(db, "COMMIT", NULL, NULL, NULL);
    sqlite3_close(db);
    load_and_remove(path);
}
