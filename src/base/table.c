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

/* ---- how the file is written ---------------------------------------------------------------------------------- */

typedef struct {
    const char *path;
    int line;
    char separator;             /* of the cells; 0: not yet known */
    int point_line, comma_line; /* the first number with a decimal point, with a decimal comma; 0: none */
    size_t capacity;
} Reader;

/* Does every comma stand between digits? Beside tabs these are decimal commas. */
static int all_commas_are_decimal(const char *line, const char *end)
{
    for (const char *p = line; p < end; p++)
        if (*p == ',' && (p == line || p + 1 == end || !isdigit((unsigned char)p[-1]) || !isdigit((unsigned char)p[1])))
            return 0;
    return 1;
}

/* By the first line that is no comment. */
static char find_separator(const char *line, const char *end)
{
    const size_t n = (size_t)(end - line);
    if (memchr(line, ';', n))
        return ';';
    return memchr(line, '\t', n) && all_commas_are_decimal(line, end) ? '\t' : ',';
}

/* ---- cells ---------------------------------------------------------------------------------------------------- */

typedef struct {
    const char *from, *to; /* without the blanks and the quotes around it */
} Cell;

static void strip_blanks(Cell *c)
{
    while (c->from < c->to && isspace((unsigned char)*c->from))
        c->from++;
    while (c->to > c->from && isspace((unsigned char)c->to[-1]))
        c->to--;
}

/* The cell that begins at *p; *p moves behind its separator, or one behind the end of the line. */
static Cell next_cell(const Reader *r, const char **p, const char *end)
{
    Cell c = {*p, *p};
    for (int quoted = 0; c.to < end && (quoted || *c.to != r->separator); c.to++)
        quoted ^= *c.to == '"';
    *p = c.to + 1;
    strip_blanks(&c);
    if (c.to - c.from >= 2 && *c.from == '"' && c.to[-1] == '"') {
        c.from++;
        c.to--;
        strip_blanks(&c);
    }
    return c;
}

static size_t count_cells(const Reader *r, const char *line, const char *end)
{
    size_t n = 0;
    while (line <= end) {
        next_cell(r, &line, end);
        n++;
    }
    return n;
}

/* Spreadsheets write such lines where rows were emptied. */
static int is_blank(const Reader *r, const char *line, const char *end)
{
    while (line <= end) {
        const Cell c = next_cell(r, &line, end);
        if (c.from < c.to)
            return 0;
    }
    return 1;
}

/* ---- names ---------------------------------------------------------------------------------------------------- */

static Status read_names(Table *t, const Reader *r, const char *line, const char *end, Err *err)
{
    t->n_cols = count_cells(r, line, end);
    t->names = calloc(t->n_cols, sizeof *t->names);
    if (!t->names)
        return fail(err, STATUS_NO_MEMORY, "%s: no memory for %zu column names", r->path, t->n_cols);
    for (size_t j = 0; j < t->n_cols; j++) {
        const Cell c = next_cell(r, &line, end);
        const size_t length = (size_t)(c.to - c.from);
        if (length == 0 || length >= TABLE_NAME_MAX)
            return fail(err, STATUS_BAD_DATA, "%s:%d: column %zu has no usable name", r->path, r->line, j + 1);
        memcpy(t->names[j], c.from, length);
    }
    return STATUS_OK;
}

/* ---- numbers -------------------------------------------------------------------------------------------------- */

static Status room_for_row(Table *t, Reader *r, Err *err)
{
    if (t->n_rows < r->capacity)
        return STATUS_OK;
    const size_t capacity = 2 * (t->n_rows + 1);
    double *values = realloc(t->values, capacity * t->n_cols * sizeof *values);
    if (values)
        t->values = values;
    int *line = values ? realloc(t->line, capacity * sizeof *line) : NULL;
    if (!line)
        return fail(err, STATUS_NO_MEMORY, "%s: no memory for %zu numbers", r->path, capacity * t->n_cols);
    t->line = line;
    r->capacity = capacity;
    return STATUS_OK;
}

/* Length of a cell in a message. */
static int shown(Cell c)
{
    return c.to - c.from < 20 ? (int)(c.to - c.from) : 20;
}

/* A comma in a cell is a decimal one: it separates nothing there. */
static void note_decimal_mark(Reader *r, char *number)
{
    char *comma = strchr(number, ',');
    if (strchr(number, '.') && !r->point_line)
        r->point_line = r->line;
    if (comma && !r->comma_line)
        r->comma_line = r->line;
    if (comma)
        *comma = '.';
}

static Status read_number(Reader *r, Cell c, size_t column, size_t n_cols, double *value, Err *err)
{
    enum { LONGEST = 400 }; /* characters of a number; printf's longest double has some 325 */
    char number[LONGEST + 1], *stop;
    const size_t length = (size_t)(c.to - c.from) < LONGEST ? (size_t)(c.to - c.from) : LONGEST;
    memcpy(number, c.from, length);
    number[length] = 0;
    note_decimal_mark(r, number);
    *value = strtod(number, &stop);
    if (stop == number)
        return fail(err, STATUS_BAD_DATA, "%s:%d: column %zu of %zu is missing or not a number: '%.*s'", r->path,
                    r->line, column, n_cols, shown(c), c.from);
    if (*stop || length < (size_t)(c.to - c.from))
        return fail(err, STATUS_BAD_DATA, "%s:%d: column %zu is not a number: '%.*s'", r->path, r->line, column,
                    shown(c), c.from);
    if (!isfinite(*value))
        return fail(err, STATUS_BAD_DATA, "%s:%d: column %zu is %g; only finite numbers are accepted", r->path, r->line,
                    column, *value);
    return STATUS_OK;
}

static Status read_row(Table *t, Reader *r, const char *line, const char *end, Err *err)
{
    if (t->n_cols == 0)
        t->n_cols = count_cells(r, line, end);
    TRY(room_for_row(t, r, err));
    double *row = t->values + t->n_rows * t->n_cols;
    for (size_t j = 0; j < t->n_cols; j++) {
        const Cell c = line <= end ? next_cell(r, &line, end) : (Cell){end, end};
        TRY(read_number(r, c, j + 1, t->n_cols, &row[j], err));
    }
    if (line <= end)
        return fail(err, STATUS_BAD_DATA, "%s:%d: more than %zu columns", r->path, r->line, t->n_cols);
    if (r->point_line && r->comma_line)
        return fail(err, STATUS_BAD_DATA, "%s:%d: decimal points and decimal commas are mixed; line %d has the other",
                    r->path, r->line, r->point_line < r->comma_line ? r->point_line : r->comma_line);
    t->line[t->n_rows++] = r->line;
    return STATUS_OK;
}

/* ---- the file ------------------------------------------------------------------------------------------------- */

static Status read_line(Table *t, Reader *r, const char *line, const char *end, int has_header, Err *err)
{
    Cell body = {line, end};
    strip_blanks(&body);
    if (body.from == body.to || *body.from == '#')
        return STATUS_OK;
    if (!r->separator)
        r->separator = find_separator(body.from, body.to);
    const Cell all = r->separator == '\t' ? (Cell){line, end} : body; /* a blank that separates counts */
    if (is_blank(r, all.from, all.to))
        return STATUS_OK;
    return has_header && !t->names ? read_names(t, r, all.from, all.to, err) : read_row(t, r, all.from, all.to, err);
}

static Status check_text(const char *path, const char *text, size_t length, Err *err)
{
    if (length >= 2 && (memcmp(text, "\xff\xfe", 2) == 0 || memcmp(text, "\xfe\xff", 2) == 0))
        return fail(err, STATUS_BAD_DATA, "%s: is written in UTF-16; save it as CSV UTF-8", path);
    if (memchr(text, 0, length))
        return fail(err, STATUS_BAD_DATA, "%s: holds a NUL byte; this is not a text file", path);
    return STATUS_OK;
}

Status table_parse(Table *t, const char *path, const char *text, size_t length, int has_header, Err *err)
{
    Reader r = {.path = path};
    const char *end = text + length;
    memset(t, 0, sizeof *t);
    TRY(check_text(path, text, length, err));
    if (length >= 3 && memcmp(text, "\xef\xbb\xbf", 3) == 0) /* UTF-8 byte order mark */
        text += 3;
    const char line_end = memchr(text, '\n', (size_t)(end - text)) ? '\n' : '\r';
    while (text < end) {
        const char *stop = memchr(text, line_end, (size_t)(end - text));
        r.line++;
        const Status s = read_line(t, &r, text, stop ? stop : end, has_header, err);
        if (s != STATUS_OK) {
            table_free(t);
            return s;
        }
        text = stop ? stop + 1 : end;
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
