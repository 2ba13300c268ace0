#include "base/csv.h"

#include <errno.h>
#include <sys/stat.h>

#include "base/carve.h"
#include "base/text.h"

/* ---- files ------------------------------------------------------------------------------------------------------- */

Status file_read(const char *path, size_t largest, char **text, size_t *length, Err *err)
{
    struct stat about;
    Status status = STATUS_OK;
    *text = NULL;
    *length = 0;

    /* A named pipe in a folder may have no writer, and reading it would block for ever; /dev/stdin and the pipes of a
     * shell's <(...) have a writer. */
    if (strncmp(path, "/dev/", 5) != 0 && stat(path, &about) == 0 && S_ISFIFO(about.st_mode))
        return fail(err, STATUS_MISSING, "%s: is a named pipe, not a file; to read from a pipe name /dev/stdin", path);
    FILE *f = fopen(path, "rb");
    if (!f)
        return fail_missing(err, path);
    int is_whole = 0;
    for (size_t capacity = 1 << 16; status == STATUS_OK && !is_whole; capacity *= 2) {
        char *wider = realloc(*text, capacity + 1);
        if (!wider) {
            status = fail_memory(err, capacity, "bytes");
            break;
        }
        *text = wider;
        *length += fread(*text + *length, 1, capacity - *length, f);
        (*text)[*length] = 0;
        is_whole = *length < capacity;
        if (ferror(f))
            status = fail(err, STATUS_MISSING, "%s: cannot be read: %s", path, strerror(errno));
        else if (*length > largest)
            status = bad_data(err, "%s: larger than %zu MiB; is it the right file?", path, largest >> 20);
    }
    fclose(f);
    if (status != STATUS_OK) {
        free(*text);
        *text = NULL;
    }
    return status;
}

/* ---- lines and cells --------------------------------------------------------------------------------------------- */

Status lines_open(Lines *l, const char *path, const char *text, size_t length, Err *err)
{
    *l = (Lines){.path = path, .next = text, .end = text + length};
    if (length >= 2 && (memcmp(text, "\xff\xfe", 2) == 0 || memcmp(text, "\xfe\xff", 2) == 0))
        return bad_data(err, "%s: is written in UTF-16; save it as UTF-8", path);
    if (memchr(text, 0, length))
        return bad_data(err, "%s: holds a NUL byte; this is not a text file", path);
    if (length >= 3 && memcmp(text, "\xef\xbb\xbf", 3) == 0) /* UTF-8 byte order mark */
        l->next += 3;
    l->mark = memchr(text, '\n', length) ? '\n' : '\r';
    return STATUS_OK;
}

static void strip(const char **from, const char **to)
{
    while (*to > *from && is_blank((*to)[-1]))
        --*to;
    while (*from < *to && is_blank(**from))
        ++*from;
}

int lines_next(Lines *l)
{
    if (l->next >= l->end)
        return 0;
    const char *stop = memchr(l->next, l->mark, l->end - l->next);
    l->raw = l->from = l->next;
    l->to = stop ? stop : l->end;
    l->next = stop ? stop + 1 : l->end;
    l->number++;
    strip(&l->from, &l->to);
    return 1;
}

Cell cell_next(const char **p, const char *end, const char *marks)
{
    const int blanks = *marks == ' ';
    while (blanks && *p < end && is_blank(**p))
        ++*p;
    Cell c = {.from = *p, .to = *p};
    if (*p >= end) {
        *p = end + 1;
        return (Cell){.from = end, .to = end};
    }
    for (int opens = *c.from == '"', quoted = 0; c.to < end; c.to++) {
        quoted ^= opens && *c.to == '"';
        if (!quoted && (strchr(marks, *c.to) || (blanks && is_blank(*c.to))))
            break;
    }
    /* Behind the cell any blanks and at most one of the other marks; beyond the end where nothing is left. */
    *p = blanks ? c.to : c.to + 1;
    for (int n = 0; blanks && *p < end && (is_blank(**p) || (strchr(marks, **p) && !n)); ++*p)
        n += !is_blank(**p);
    if (blanks && *p >= end)
        *p = end + 1;
    strip(&c.from, &c.to);
    c.is_quoted = c.to - c.from >= 2 && *c.from == '"' && c.to[-1] == '"';
    if (c.is_quoted) {
        c.from++;
        c.to--;
        strip(&c.from, &c.to);
    }
    return c;
}

CellKind cell_number(Cell c, int with_comma, double *x)
{
    enum { LONGEST = 400 }; /* printf's longest double has some 325 characters */
    char text[LONGEST + 1], *stop;
    const size_t n = c.to - c.from;
    if (n == 0 || n > LONGEST || memchr(c.from, 'x', n) || memchr(c.from, 'X', n))
        return NO_NUMBER;
    for (size_t i = 0; i < n; i++) { /* Fortran's exponent letter D is E */
        const int is_exponent = (c.from[i] == 'D' || c.from[i] == 'd') && i && strchr("0123456789.", c.from[i - 1]);
        text[i] = is_exponent ? 'E' : with_comma && c.from[i] == ',' ? '.' : c.from[i];
    }
    text[n] = 0;
    *x = strtod(text, &stop);
    return *stop ? NO_NUMBER : isfinite(*x) ? NUMBER : NOT_FINITE;
}

Status lines_note_mark(Lines *l, Cell c, Err *err)
{
    const size_t n = c.to - c.from;
    if (!l->point_line && memchr(c.from, '.', n))
        l->point_line = l->number;
    if (!l->comma_line && memchr(c.from, ',', n))
        l->comma_line = l->number;
    if (!l->point_line || !l->comma_line)
        return STATUS_OK;
    return fail_at(err, l, "decimal points and decimal commas are mixed; line %d has the other",
                   MIN_OF(l->point_line, l->comma_line));
}

int csv_is_error(const char *line, const char *end)
{
    static const char *const ERRORS[] = {"#N/A", "#NV", "#VALUE!", "#DIV/0!", "#REF!", "#NUM!", "#NAME?", "#NULL!"};
    for (size_t i = 0; i < N_OF(ERRORS); i++) {
        const char *behind = line + strlen(ERRORS[i]);
        if (behind <= end && strncmp(line, ERRORS[i], strlen(ERRORS[i])) == 0)
            return behind == end || strchr(",;\t\r", *behind);
    }
    return 0;
}

int csv_has_decimal_commas(const char *line, const char *end)
{
    for (const char *p = line; p < end; p++)
        if (*p == ',' && (p == line || p + 1 == end || !is_digit(p[-1]) || !is_digit(p[1])))
            return 0;
    return 1;
}

/* ---- tables ------------------------------------------------------------------------------------------------------ */

typedef struct {
    Table *t;
    Lines l;
    char separator[2]; /* empty: not yet known */
    int has_header, of_words;
    size_t rows, used; /* room for rows; bytes of text so far */
} Reading;

/* The next line with something in it, from..to; 0: there is none. */
static int next_row(Reading *r, const char **from, const char **to)
{
    Lines *l = &r->l;
    while (lines_next(l)) {
        const size_t n = l->to - l->from;
        if (n == 0 || (*l->from == '#' && !csv_is_error(l->from, l->to)))
            continue;
        if (!*r->separator && n == 5 && strncmp(l->from, "sep=", 4) == 0) { /* for Excel */
            *r->separator = l->from[4];
            continue;
        }
        if (!*r->separator) {
            const int has_commas = !csv_has_decimal_commas(l->from, l->to);
            *r->separator = memchr(l->from, ';', n)                     ? ';'
                            : has_commas                                ? ','
                            : memchr(l->from, '\t', n)                  ? '\t'
                            : !r->has_header && memchr(l->from, ' ', n) ? ' '
                                                                        : ',';
        }
        *from = *r->separator == '\t' ? l->raw : l->from; /* a tab is a blank, too */
        *to = *r->separator == '\t' && l->next[-1] == l->mark ? l->next - 1 : *r->separator == '\t' ? l->next : l->to;
        for (const char *p = *from; p <= *to;) { /* spreadsheets write lines of empty cells where rows were emptied */
            const Cell c = cell_next(&p, *to, r->separator);
            if (c.from < c.to)
                return 1;
        }
    }
    return 0;
}

/* What is wrong with a cell that should be a number. */
static Status fail_number(const Table *t, int line, size_t column, Cell c, Err *err)
{
    double x;
    if (cell_number(c, 1, &x) == NOT_FINITE)
        return bad_data(err, "%s:%d: column %zu is %g; only finite numbers are accepted", t->path, line, column + 1, x);
    if (c.from == c.to)
        return bad_data(err, "%s:%d: column %zu of %zu is missing", t->path, line, column + 1, t->n_cols);
    return bad_data(err, "%s:%d: column %zu is not a number: '%.*s'", t->path, line, column + 1,
                    (int)MIN_OF(c.to - c.from, 20), c.from);
}

/* The cells of a row. Numbers that are missing at its end are named one by one. */
static Status read_row(Reading *r, const char *from, const char *to, Err *err)
{
    Table *t = r->t;
    const char *p = from;
    if (t->n_rows == r->rows) {
        const size_t rows = 2 * t->n_rows + 64, cells = rows * t->n_cols;
        int lacks = 0;
        t->cell = widened(t->cell, cells, sizeof *t->cell, &lacks);
        t->values = widened(t->values, cells, sizeof *t->values, &lacks);
        t->line = widened(t->line, rows, sizeof *t->line, &lacks);
        if (lacks)
            return fail_memory(err, rows, "rows");
        r->rows = rows;
    }
    for (size_t n = 0; n < t->n_cols; n++) {
        if (r->of_words && p > to)
            return fail_at(err, &r->l, "%zu columns; the header has %zu", n, t->n_cols);
        const Cell c = cell_next(&p, to, r->separator);
        const size_t at = t->n_rows * t->n_cols + n, length = c.to - c.from;
        if (cell_number(c, 1, &t->values[at]) == NUMBER)
            TRY(lines_note_mark(&r->l, c, err));
        else if (r->of_words || (r->has_header && length == 0))
            t->values[at] = NAN;
        else
            return fail_number(t, r->l.number, n, c, err);
        if (!r->of_words)
            continue;
        memcpy(t->text + r->used, c.from, length);
        t->text[r->used + length] = 0;
        t->cell[at] = r->used;
        r->used += length + 1;
    }
    t->line[t->n_rows++] = r->l.number;
    return p > to ? STATUS_OK : fail_at(err, &r->l, "more than %zu columns", t->n_cols);
}

/* The names of the columns, where there are some, and all rows. */
static Status read_rows(Reading *r, size_t length, Err *err)
{
    Table *t = r->t;
    const char *from, *to;
    if (r->of_words)
        t->text = malloc(2 * length + 1); /* a cell is closed by a zero instead of its separator */
    if (r->of_words && !t->text)
        return fail_memory(err, 2 * length, "bytes");
    while (next_row(r, &from, &to)) {
        for (const char *p = from; t->n_cols == 0 || (p > from && p <= to); t->n_cols++)
            cell_next(&p, to, r->separator);
        if (!r->has_header || t->names) {
            TRY(read_row(r, from, to, err));
            continue;
        }
        TRY_ROOM(t->names, t->n_cols, "column names", err);
        size_t n = 0;
        for (const char *p = from; p <= to; n++) {
            const Cell c = cell_next(&p, to, r->separator);
            if (c.from == c.to || c.to - c.from >= TABLE_NAME_MAX)
                return fail_at(err, &r->l, "column %zu has no usable name", n + 1);
            memcpy(t->names[n], c.from, c.to - c.from);
        }
    }
    if (t->n_rows > 0 || (t->names && !r->of_words))
        return STATUS_OK;
    return bad_data(err, "%s: holds no %s", t->path, r->of_words ? "rows" : "numbers");
}

Status table_parse(Table *t, const char *path, const char *text, size_t length, TableForm form, Err *err)
{
    Reading r = {.t = t, .has_header = form != TABLE_PLAIN, .of_words = form == TABLE_WORDS};
    memset(t, 0, sizeof *t);
    text_copy(t->path, path);
    Status status = lines_open(&r.l, t->path, text, length, err);
    THEN(status, read_rows(&r, length, err));
    if (status != STATUS_OK)
        table_free(t);
    return status;
}

Status table_read(Table *t, const char *path, TableForm form, Err *err)
{
    char *text;
    size_t length;
    memset(t, 0, sizeof *t);
    TRY(file_read(path, FILE_LARGEST, &text, &length, err));
    const Status status = table_parse(t, path, text, length, form, err);
    free(text);
    return status;
}

void table_free(Table *t)
{
    free(t->names);
    free(t->line);
    free(t->values);
    free(t->text);
    free(t->cell);
    memset(t, 0, sizeof *t);
}

/* ---- columns and cells ---------------------------------------------------------------------------------------- */

int table_column(const Table *t, const char *name)
{
    for (size_t j = 0; t->names && j < t->n_cols; j++)
        if (strcmp(t->names[j], name) == 0)
            return (int)j;
    return -1;
}

const char *sheet_text(const Table *s, size_t row, const char *column)
{
    const int j = table_column(s, column);
    return j < 0 ? "" : s->text + s->cell[row * s->n_cols + j];
}

Status sheet_number(const Table *s, size_t row, const char *column, double otherwise, double *value, Err *err)
{
    const char *text = sheet_text(s, row, column);
    const Cell c = {.from = text, .to = text + strlen(text)};
    *value = otherwise;
    if (!*text && !isnan(otherwise))
        return STATUS_OK;
    return cell_number(c, 1, value) == NUMBER ? STATUS_OK
                                              : fail_number(s, s->line[row], table_column(s, column), c, err);
}
