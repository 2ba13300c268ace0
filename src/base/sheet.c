#include "base/sheet.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/csv.h"
#include "base/table.h"

/* ---- reading -------------------------------------------------------------------------------------------------- */

static Status read_names(Sheet *s, CsvReader *r, Err *err)
{
    s->n_cols = csv_count(r);
    s->names = calloc(s->n_cols, sizeof *s->names);
    if (!s->names)
        return fail(err, STATUS_NO_MEMORY, "%s: no memory for %zu column names", s->path, s->n_cols);
    for (size_t j = 0; j < s->n_cols; j++) {
        const CsvCell c = csv_cell(r);
        const size_t length = (size_t)(c.to - c.from);
        if (length == 0 || length >= SHEET_NAME_MAX)
            return fail(err, STATUS_BAD_DATA, "%s:%d: column %zu has no usable name", s->path, r->line, j + 1);
        memcpy(s->names[j], c.from, length);
    }
    return STATUS_OK;
}

typedef struct {
    size_t rows, used; /* room for rows; bytes of text so far */
} Room;

static Status room_for_row(Sheet *s, Room *room, Err *err)
{
    if (s->n_rows < room->rows)
        return STATUS_OK;
    const size_t rows = 2 * s->n_rows + 64;
    size_t *cell = realloc(s->cell, rows * s->n_cols * sizeof *cell);
    if (cell)
        s->cell = cell;
    int *line = cell ? realloc(s->line, rows * sizeof *line) : NULL;
    if (!line)
        return fail(err, STATUS_NO_MEMORY, "%s: no memory for %zu rows", s->path, rows);
    s->line = line;
    room->rows = rows;
    return STATUS_OK;
}

static Status read_row(Sheet *s, Room *room, CsvReader *r, Err *err)
{
    const size_t n = csv_count(r);
    if (n != s->n_cols)
        return fail(err, STATUS_BAD_DATA, "%s:%d: %zu columns; the header has %zu", s->path, r->line, n, s->n_cols);
    TRY(room_for_row(s, room, err));
    for (size_t j = 0; j < n; j++) {
        const CsvCell c = csv_cell(r);
        const size_t length = (size_t)(c.to - c.from);
        TRY(csv_note_mark(r, c, err));
        memcpy(s->text + room->used, c.from, length);
        s->text[room->used + length] = 0;
        s->cell[s->n_rows * n + j] = room->used;
        room->used += length + 1;
    }
    s->line[s->n_rows++] = r->line;
    return STATUS_OK;
}

static Status read_lines(Sheet *s, const char *text, size_t length, Err *err)
{
    CsvReader r;
    Room room = {0};
    TRY(csv_open(&r, s->path, text, length, err));
    s->text = malloc(2 * length + 1); /* a cell is closed by a zero instead of its separator */
    if (!s->text)
        return fail(err, STATUS_NO_MEMORY, "%s: no memory for %zu bytes", s->path, 2 * length);
    while (csv_line(&r))
        TRY(s->names ? read_row(s, &room, &r, err) : read_names(s, &r, err));
    return s->n_rows ? STATUS_OK : fail(err, STATUS_BAD_DATA, "%s: holds no rows", s->path);
}

Status sheet_parse(Sheet *s, const char *path, const char *text, size_t length, Err *err)
{
    memset(s, 0, sizeof *s);
    snprintf(s->path, sizeof s->path, "%s", path);
    const Status status = read_lines(s, text, length, err);
    if (status != STATUS_OK)
        sheet_free(s);
    return status;
}

Status sheet_read(Sheet *s, const char *path, Err *err)
{
    char *text;
    size_t length;
    memset(s, 0, sizeof *s);
    TRY(file_read(path, FILE_LARGEST, &text, &length, err));
    const Status status = sheet_parse(s, path, text, length, err);
    free(text);
    return status;
}

void sheet_free(Sheet *s)
{
    free(s->names);
    free(s->text);
    free(s->cell);
    free(s->line);
    memset(s, 0, sizeof *s);
}

/* ---- columns and cells ---------------------------------------------------------------------------------------- */

int sheet_column(const Sheet *s, const char *name)
{
    for (size_t j = 0; j < s->n_cols; j++)
        if (strcmp(s->names[j], name) == 0)
            return (int)j;
    return -1;
}

enum { EXPECTED_MAX = 24 };

/* Splits the blank-separated words into list; text is changed. */
static int split(char *text, const char *list[], int n)
{
    for (char *word; (word = strsep(&text, " "));)
        if (*word && n < EXPECTED_MAX)
            list[n++] = word;
    return n;
}

Status sheet_expect(const Sheet *s, const char *required, const char *optional, Err *err)
{
    char needed[256], other[256];
    const char *list[EXPECTED_MAX];
    snprintf(needed, sizeof needed, "%s", required);
    snprintf(other, sizeof other, "%s", optional);
    const int n_required = split(needed, list, 0), n = split(other, list, n_required);
    for (int i = 0; i < n_required; i++)
        if (sheet_column(s, list[i]) < 0)
            return fail(err, STATUS_BAD_DATA, "%s: has no column %s; it needs %s, and may have %s", s->path, list[i],
                        required, optional);
    for (size_t j = 0; j < s->n_cols; j++) {
        int known = 0;
        for (int i = 0; i < n && !known; i++)
            known = strcmp(s->names[j], list[i]) == 0;
        if (!known)
            return fail(err, STATUS_BAD_DATA, "%s: column '%s' is not known; there are %s %s", s->path, s->names[j],
                        required, optional);
    }
    return STATUS_OK;
}

const char *sheet_text(const Sheet *s, size_t row, const char *column)
{
    const int j = sheet_column(s, column);
    return j < 0 ? "" : s->text + s->cell[row * s->n_cols + (size_t)j];
}

Status sheet_number(const Sheet *s, size_t row, const char *column, double otherwise, double *value, Err *err)
{
    const char *text = sheet_text(s, row, column);
    CsvReader r = {.path = s->path, .line = s->line[row]};
    *value = otherwise;
    if (!*text && !isnan(otherwise))
        return STATUS_OK;
    const CsvCell cell = {text, text + strlen(text)};
    return csv_number(&r, cell, (size_t)sheet_column(s, column) + 1, s->n_cols, value, err);
}
