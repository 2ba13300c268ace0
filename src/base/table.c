#include "base/table.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* A named pipe in a folder may have no writer, and reading it would block for ever; /dev/stdin and the pipes of a shell's <(...)
 * have a writer. */
static int is_left_pipe(const char *path)
{
    struct stat about;
    return strncmp(path, "/dev/", 5) != 0 && stat(path, &about) == 0 && S_ISFIFO(about.st_mode);
}

Status file_read(const char *path, char **text, size_t *length, Err *err)
{
    *text = NULL;
    *length = 0;
    if (is_left_pipe(path))
        return fail(err, STATUS_MISSING, "%s: is a named pipe, not a file; to read from a pipe name /dev/stdin", path);
    FILE *f = fopen(path, "rb");
    if (!f)
        return fail(err, status_of_errno(errno, STATUS_MISSING), "%s: %s", path, strerror(errno));
    enum { LARGEST = 1 << 28 }; /* [bytes] far above any record; a device or a wrong file ends here */
    size_t capacity = 1 << 16, n = 0;
    char *buffer = malloc(capacity + 1);
    while (buffer) {
        n += fread(buffer + n, 1, capacity - n, f);
        if (n < capacity || capacity > LARGEST)
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
    if (n > LARGEST) {
        free(buffer);
        return fail(err, STATUS_BAD_DATA, "%s: larger than %d MiB; this is no text file of numbers", path,
                    LARGEST >> 20);
    }
    buffer[n] = 0;
    *text = buffer;
    *length = n;
    return STATUS_OK;
}

typedef struct {
    const char *path;
    int line;
    size_t capacity;
} Reader;

static Status read_names(Table *t, const Reader *r, const char *line, const char *end, Err *err)
{
    size_t n = 1;
    for (const char *p = line; p < end; p++)
        n += *p == ',';
    t->names = calloc(n, sizeof *t->names);
    if (!t->names)
        return fail(err, STATUS_NO_MEMORY, "%s: no memory for %zu column names", r->path, n);
    t->n_cols = n;
    for (size_t j = 0; j < n; j++) {
        const char *stop = memchr(line, ',', (size_t)(end - line));
        stop = stop ? stop : end;
        while (line < stop && isspace((unsigned char)*line))
            line++;
        size_t length = (size_t)(stop - line);
        while (length && isspace((unsigned char)line[length - 1]))
            length--;
        if (length == 0 || length >= TABLE_NAME_MAX)
            return fail(err, STATUS_BAD_DATA, "%s:%d: column %zu has no usable name", r->path, r->line, j + 1);
        memcpy(t->names[j], line, length);
        line = stop + 1;
    }
    return STATUS_OK;
}

static Status room_for_row(Table *t, Reader *r, Err *err)
{
    const size_t need = (t->n_rows + 1) * t->n_cols;
    if (need <= r->capacity)
        return STATUS_OK;
    const size_t capacity = need * 2;
    double *wider = realloc(t->values, capacity * sizeof *wider);
    if (!wider)
        return fail(err, STATUS_NO_MEMORY, "%s: no memory for %zu numbers", r->path, capacity);
    t->values = wider;
    r->capacity = capacity;
    return STATUS_OK;
}

/* Length of the cell that begins here, for a message. */
static int shown(const char *cell, const char *end)
{
    int n = 0;
    while (cell + n < end && cell[n] != ',' && n < 20)
        n++;
    return n;
}

static Status read_row(Table *t, Reader *r, const char *line, const char *end, Err *err)
{
    if (t->n_cols == 0) {
        t->n_cols = 1;
        for (const char *p = line; p < end; p++)
            t->n_cols += *p == ',';
    }
    TRY(room_for_row(t, r, err));
    double *row = t->values + t->n_rows * t->n_cols;
    for (size_t j = 0; j < t->n_cols; j++) {
        char *stop;
        row[j] = strtod(line, &stop);
        if (stop == line || stop > end)
            return fail(err, STATUS_BAD_DATA, "%s:%d: column %zu of %zu is missing or not a number: '%.*s'", r->path,
                        r->line, j + 1, t->n_cols, shown(line, end), line);
        if (!isfinite(row[j]))
            return fail(err, STATUS_BAD_DATA, "%s:%d: column %zu is %g; only finite numbers are accepted", r->path,
                        r->line, j + 1, row[j]);
        while (stop < end && isspace((unsigned char)*stop))
            stop++;
        const int last = j + 1 == t->n_cols;
        if (stop < end && *stop != ',')
            return fail(err, STATUS_BAD_DATA, "%s:%d: column %zu is not a number: '%.*s'", r->path, r->line, j + 1,
                        shown(line, end), line);
        if (last && stop < end)
            return fail(err, STATUS_BAD_DATA, "%s:%d: more than %zu columns", r->path, r->line, t->n_cols);
        line = stop + 1;
    }
    t->n_rows++;
    return STATUS_OK;
}

Status table_parse(Table *t, const char *path, const char *text, size_t length, int has_header, Err *err)
{
    Reader r = {.path = path};
    memset(t, 0, sizeof *t);
    if (memchr(text, 0, length))
        return fail(err, STATUS_BAD_DATA, "%s: holds a NUL byte; this is not a text file", path);
    for (const char *line = text; line < text + length;) {
        const char *end = memchr(line, '\n', (size_t)(text + length - line));
        const char *next = end ? end + 1 : text + length;
        end = end ? end : text + length;
        r.line++;
        while (end > line && isspace((unsigned char)end[-1]))
            end--;
        while (line < end && isspace((unsigned char)*line))
            line++;
        if (line < end && *line != '#') {
            const Status s =
                has_header && !t->names ? read_names(t, &r, line, end, err) : read_row(t, &r, line, end, err);
            if (s != STATUS_OK) {
                table_free(t);
                return s;
            }
        }
        line = next;
    }
    if (t->n_rows == 0 && !t->names) {
        table_free(t);
        return fail(err, STATUS_BAD_DATA, "%s: holds no numbers", path);
    }
    return STATUS_OK;
}

Status table_read(Table *t, const char *path, int has_header, Err *err)
{
    char *text;
    size_t length;
    memset(t, 0, sizeof *t);
    TRY(file_read(path, &text, &length, err));
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
    memset(t, 0, sizeof *t);
}
