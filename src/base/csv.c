#include "base/csv.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- lines ---------------------------------------------------------------------------------------------------- */

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

Status csv_open(CsvReader *r, const char *path, const char *text, size_t length, Err *err)
{
    *r = (CsvReader){.path = path, .next = text, .stop = text + length};
    if (length >= 2 && (memcmp(text, "\xff\xfe", 2) == 0 || memcmp(text, "\xfe\xff", 2) == 0))
        return fail(err, STATUS_BAD_DATA, "%s: is written in UTF-16; save it as CSV UTF-8", path);
    if (memchr(text, 0, length))
        return fail(err, STATUS_BAD_DATA, "%s: holds a NUL byte; this is not a text file", path);
    if (length >= 3 && memcmp(text, "\xef\xbb\xbf", 3) == 0) /* UTF-8 byte order mark */
        r->next += 3;
    r->line_end = memchr(r->next, '\n', (size_t)(r->stop - r->next)) ? '\n' : '\r';
    return STATUS_OK;
}

static void strip_blanks(CsvCell *c)
{
    while (c->from < c->to && isspace((unsigned char)*c->from))
        c->from++;
    while (c->to > c->from && isspace((unsigned char)c->to[-1]))
        c->to--;
}

/* Spreadsheets write lines of empty cells where rows were emptied. */
static int is_blank(CsvReader r)
{
    while (r.at <= r.end) {
        const CsvCell c = csv_cell(&r);
        if (c.from < c.to)
            return 0;
    }
    return 1;
}

int csv_is_error(const char *line, const char *end)
{
    const char *p = line;
    for (p += p < end && *p == '#'; p < end && (isupper((unsigned char)*p) || *p == '/' || *p == '0');)
        p++;
    const size_t n = (size_t)(p - line);
    const int is_not_there = (n == 4 && memcmp(line, "#N/A", 4) == 0) || (n == 3 && memcmp(line, "#NV", 3) == 0);
    p += p < end && n > 3 && (*p == '!' || *p == '?');
    return (is_not_there || (size_t)(p - line) > n) && (p == end || strchr(",;\t\r", *p));
}

/* Is there anything in the line from..to? Then it is made the one at hand. */
static int take_line(CsvReader *r, const char *from, const char *to)
{
    CsvCell body = {from, to};
    strip_blanks(&body);
    if (body.from == body.to || (*body.from == '#' && !csv_is_error(body.from, body.to)))
        return 0;
    if (!r->separator && body.to - body.from == 5 && strncmp(body.from, "sep=", 4) == 0) { /* for Excel */
        r->separator = body.from[4];
        return 0;
    }
    if (!r->separator)
        r->separator = find_separator(body.from, body.to);
    const int blanks_separate = r->separator == '\t';
    r->at = blanks_separate ? from : body.from;
    r->end = blanks_separate ? to : body.to;
    return !is_blank(*r);
}

int csv_line(CsvReader *r)
{
    while (r->next < r->stop) {
        const char *from = r->next, *end = memchr(from, r->line_end, (size_t)(r->stop - from));
        r->next = end ? end + 1 : r->stop;
        r->line++;
        if (take_line(r, from, end ? end : r->stop))
            return 1;
    }
    return 0;
}

/* ---- cells ---------------------------------------------------------------------------------------------------- */

CsvCell csv_cell(CsvReader *r)
{
    CsvCell c = {r->at, r->at};
    if (r->at > r->end)
        return (CsvCell){r->end, r->end};
    for (int quoted = 0; c.to < r->end && (quoted || *c.to != r->separator); c.to++)
        quoted ^= *c.to == '"';
    r->at = c.to + 1;
    strip_blanks(&c);
    if (c.to - c.from >= 2 && *c.from == '"' && c.to[-1] == '"') {
        c.from++;
        c.to--;
        strip_blanks(&c);
    }
    return c;
}

size_t csv_count(const CsvReader *r)
{
    CsvReader rest = *r;
    size_t n = 0;
    for (; rest.at <= rest.end; n++)
        csv_cell(&rest);
    return n;
}

/* Length of a cell in a message. */
static int shown(CsvCell c)
{
    return c.to - c.from < 20 ? (int)(c.to - c.from) : 20;
}

/* A comma in a cell is a decimal one: it separates nothing there. */
static Status note_decimal_mark(CsvReader *r, char *number, Err *err)
{
    char *comma = strchr(number, ',');
    if (strchr(number, '.') && !r->point_line)
        r->point_line = r->line;
    if (comma && !r->comma_line)
        r->comma_line = r->line;
    if (comma)
        *comma = '.';
    if (r->point_line && r->comma_line)
        return fail(err, STATUS_BAD_DATA, "%s:%d: decimal points and decimal commas are mixed; line %d has the other",
                    r->path, r->line, r->point_line < r->comma_line ? r->point_line : r->comma_line);
    return STATUS_OK;
}

enum { LONGEST = 400 }; /* characters of a number; printf's longest double has some 325 */

Status csv_note_mark(CsvReader *r, CsvCell c, Err *err)
{
    char number[LONGEST + 1];
    snprintf(number, sizeof number, "%.*s", (int)(c.to - c.from), c.from);
    return number[strspn(number, "0123456789+-.,eE")] ? STATUS_OK : note_decimal_mark(r, number, err);
}

Status csv_number(CsvReader *r, CsvCell c, size_t column, size_t n_columns, double *value, Err *err)
{
    char number[LONGEST + 1], *stop;
    const size_t length = (size_t)(c.to - c.from) < LONGEST ? (size_t)(c.to - c.from) : LONGEST;
    memcpy(number, c.from, length);
    number[length] = 0;
    const Status mark = note_decimal_mark(r, number, err);
    *value = strtod(number, &stop);
    if (stop == number)
        return fail(err, STATUS_BAD_DATA, "%s:%d: column %zu of %zu is missing or not a number: '%.*s'", r->path,
                    r->line, column, n_columns, shown(c), c.from);
    if (*stop || length < (size_t)(c.to - c.from))
        return fail(err, STATUS_BAD_DATA, "%s:%d: column %zu is not a number: '%.*s'", r->path, r->line, column,
                    shown(c), c.from);
    if (!isfinite(*value))
        return fail(err, STATUS_BAD_DATA, "%s:%d: column %zu is %g; only finite numbers are accepted", r->path, r->line,
                    column, *value);
    return mark;
}
