#include "base/table.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/csv.h"

/* A named pipe in a folder may have no writer, and reading it would block for ever; /dev/stdin and the pipes of a shell's <(...)
 * have a writer. */
static int is_left_pipe(const char *path)
{
    struct stat about;
    return strncmp(path, "/dev/", 5) != 0 && stat(path, &about) == 0 && S_ISFIFO(about.st_mode);
}

Status file_read(const char *path, size_t largest, char **text, size_t *length, Err *err)
{
    *text = NULL;
    *length = 0;
    if (is_left_pipe(path))
        return fail(err, STATUS_MISSING, "%s: is a named pipe, not a file; to read from a pipe name /dev/stdin", path);
    FILE *f = fopen(path, "rb");
    if (!f)
        return fail(err, status_of_errno(errno, STATUS_MISSING), "%s: %s", path, strerror(errno));
    size_t capacity = 1 << 16, n = 0;
    char *buffer = malloc(capacity + 1);
    while (buffer) {
        n += fread(buffer + n, 1, capacity - n, f);
        if (n < capacity || capacity > largest)
            break;
        char *wider = realloc(buffer, 2 * capacity + 1);
        if (!wider) {
            free(buffer);
            buffer = NULL;
            break;
        }
        buffer = wider;
        capacity *= 2;
    }
    const int broken = ferror(f);
    const int why = errno;
    fclose(f);
    if (!buffer)
        return fail(err, STATUS_NO_MEMORY, "%s: no memory for %zu bytes", path, 2 * capacity);
    if (broken) {
        free(buffer);
        return fail(err, STATUS_MISSING, "%s: cannot be read: %s", path, strerror(why));
    }
    if (n > largest) {
        free(buffer);
        return fail(err, STATUS_BAD_DATA, "%s: larger than %zu MiB; is it the right file?", path, largest >> 20);
    }
    buffer[n] = 0;
    *text = buffer;
    *length = n;
    return STATUS_OK;
}

static Status read_names(Table *t, CsvReader *r, Err *err)
{
    t->n_cols = csv_count(r);
    t->names = calloc(t->n_cols, sizeof *t->names);
    if (!t->names)
        return fail(err, STATUS_NO_MEMORY, "%s: no memory for %zu column names", r->path, t->n_cols);
    for (size_t j = 0; j < t->n_cols; j++) {
        const CsvCell c = csv_cell(r);
        const size_t length = (size_t)(c.to - c.from);
        if (length == 0 || length >= TABLE_NAME_MAX)
            return fail(err, STATUS_BAD_DATA, "%s:%d: column %zu has no usable name", r->path, r->line, j + 1);
        memcpy(t->names[j], c.from, length);
    }
    return STATUS_OK;
}

static Status room_for_row(Table *t, size_t *capacity, const CsvReader *r, Err *err)
{
    if (t->n_rows < *capacity)
        return STATUS_OK;
    const size_t wider = 2 * (t->n_rows + 1);
    double *values = realloc(t->values, wider * t->n_cols * sizeof *values);
    if (values)
        t->values = values;
    int *line = values ? realloc(t->line, wider * sizeof *line) : NULL;
    if (!line)
        return fail(err, STATUS_NO_MEMORY, "%s: no memory for %zu numbers", r->path, wider * t->n_cols);
    t->line = line;
    *capacity = wider;
    return STATUS_OK;
}

static Status read_row(Table *t, size_t *capacity, CsvReader *r, Err *err)
{
    if (t->n_cols == 0)
        t->n_cols = csv_count(r);
    TRY(room_for_row(t, capacity, r, err));
    double *row = t->values + t->n_rows * t->n_cols;
    for (size_t j = 0; j < t->n_cols; j++)
        TRY(csv_number(r, csv_cell(r), j + 1, t->n_cols, &row[j], err));
    if (csv_count(r) > 0)
        return fail(err, STATUS_BAD_DATA, "%s:%d: more than %zu columns", r->path, r->line, t->n_cols);
    t->line[t->n_rows++] = r->line;
    return STATUS_OK;
}

Status table_parse(Table *t, const char *path, const char *text, size_t length, int has_header, Err *err)
{
    CsvReader r;
    size_t capacity = 0;
    memset(t, 0, sizeof *t);
    TRY(csv_open(&r, path, text, length, err));
    Status s = STATUS_OK;
    while (s == STATUS_OK && csv_line(&r))
        s = has_header && !t->names ? read_names(t, &r, err) : read_row(t, &capacity, &r, err);
    if (s == STATUS_OK && t->n_rows == 0 && !t->names)
        s = fail(err, STATUS_BAD_DATA, "%s: holds no numbers", path);
    if (s != STATUS_OK)
        table_free(t);
    return s;
}

Status table_read(Table *t, const char *path, int has_header, Err *err)
{
    char *text;
    size_t length;
    memset(t, 0, sizeof *t);
    TRY(file_read(path, FILE_LARGEST, &text, &length, err));
    const Status s = table_parse(t, path, text, length, has_header, err);
    free(text);
    return s;
}

int table_column(const Table *t, const char *name)
{
    for (size_t j = 0; t->names && j < t->n_cols; j++)
        if (strcmp(t->names[j], name) == 0)
            return (int)j;
    return -1;
}

void table_free(Table *t)
{
    free(t->names);
    free(t->values);
    free(t->line);
    memset(t, 0, sizeof *t);
}
