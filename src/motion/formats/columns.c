/* Plain text: one, two or many columns of numbers, parted by blanks, tabs, commas or semicolons.
 *
 *   comments  begin with # % ! or //; they may state the unit (m/s2, cm/s2; gal and g as in "units: g", "[g]", "in g"), the
 *             step ("dt = 1/200 s", "sampling rate: 100") and the number of samples ("npts = 4000"); what is stated twice
 *             must agree
 *   names     lines of words above the numbers; the last of them names the columns, a unit there wins
 *   npts dt   two numbers alone in the first row, or one each in the first two, where the first is the number of samples or
 *             rows that follow; npts alone in the first row
 *   times     the column that is named so, else the first, unless there is only one, or the names or the numbers say that
 *             it is none; then the step must be known. 0, 1, 2, ... without such a name are numbers of samples
 *   rows      numbers without names are read row by row as one long column where their number is the one that is stated
 *   1,5;2,5   a comma is a decimal one where semicolons, tabs or blanks part the columns and every comma stands between
 *             digits, and where the names name one column and no number has a point */
#include "motion/formats/columns.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/csv.h"

/* Digits behind the decimal point of a number as printed, less its exponent. */
static int count_decimals(const char *from, const char *to)
{
    int n = 0, behind_point = 0;
    for (; from < to; from++) {
        if (*from == '.' || *from == ',') {
            behind_point = 1;
        } else if (isdigit((unsigned char)*from)) {
            n += behind_point;
        } else if (*from != '+' && *from != '-') {
            double exponent = 0;
            if (number_behind(from, to, "", &exponent) || number_behind(from + 1, to, "", &exponent))
                n -= (int)fmax(fmin(exponent, 400), -400);
            break;
        }
    }
    return n;
}

/* Does something else than commas part the columns? */
static int has_decimal_commas(const Lines *l, int is_one)
{
    int parted = is_one;
    if (memchr(l->from, ';', (size_t)(l->to - l->from)))
        return 1;
    for (const char *p = l->from; p < l->to; p++) {
        if (*p == ',' &&
            !(p > l->from && isdigit((unsigned char)p[-1]) && p + 1 < l->to && isdigit((unsigned char)p[1])))
            return 0;
        parted |= *p == ' ' || *p == '\t';
    }
    return parted;
}

/* Decimal points and decimal commas are not of one file: one of them would be a mark of thousands. */
static Status note_marks(Columns *columns, const Lines *l, int with_comma, Err *err)
{
    const size_t n = (size_t)(l->to - l->from);
    if (!columns->point_line && memchr(l->from, '.', n))
        columns->point_line = l->number;
    if (!columns->comma_line && with_comma && memchr(l->from, ',', n))
        columns->comma_line = l->number;
    return !columns->point_line || !columns->comma_line
               ? STATUS_OK
               : fail(err, STATUS_BAD_DATA, "%s:%d: decimal points (line %d) and decimal commas (line %d) are mixed",
                      l->path, l->number, columns->point_line, columns->comma_line);
}

Status columns_add(Columns *columns, Record *r, const Lines *l, Err *err)
{
    const int with_comma = has_decimal_commas(l, columns->is_one);
    size_t n = 0;
    for (const char *p = l->from; p < l->to; n++) {
        const char *from = p, *to = field_next(l, &p, with_comma);
        const int is_quoted = from < to && *from == '"';
        field_strip(&from, &to);
        Row row = {.line = l->number, .decimals = count_decimals(from, to)};
        TRY(field_number(l, from, to, with_comma || is_quoted, &row.a, err));
        if (n > CHANNELS_MAX)
            return fail(err, STATUS_BAD_DATA, "%s:%d: more than %d channels", l->path, l->number, CHANNELS_MAX);
        TRY(record_add(r, l, row, err));
    }
    TRY(note_marks(columns, l, with_comma, err));
    if (columns->n_rows++ == 0)
        columns->width = n;
    if (n != columns->width && !columns->odd_line) {
        columns->odd_line = l->number;
        columns->odd_row = columns->n_rows - 1;
        columns->odd_width = n;
    }
    return STATUS_OK;
}

Status columns_check(const Columns *columns, const Lines *l, Err *err)
{
    const char *s = columns->odd_width == 1 ? "" : "s";
    if (!columns->odd_line)
        return STATUS_OK;
    if (columns->odd_row == 1) /* what stands alone above all others is meant otherwise */
        return fail(
            err, STATUS_BAD_DATA,
            "%s:%d: has %zu column%s where the line of numbers above has %zu; if that line states the number of "
            "samples, %zu lines follow it; put # before what is no sample",
            l->path, columns->odd_line, columns->odd_width, s, columns->width, columns->n_rows - 1);
    return fail(err, STATUS_BAD_DATA, "%s:%d: has %zu column%s where the lines above have %zu", l->path,
                columns->odd_line, columns->odd_width, s, columns->width);
}

/* Width, rows and odd line of the rows that r holds. */
static void recount(Columns *columns, const Record *r)
{
    columns->n_rows = 0;
    columns->odd_line = 0;
    for (size_t i = 0, n; i < r->n; i += n, columns->n_rows++) {
        for (n = 1; i + n < r->n && r->row[i + n].line == r->row[i].line; n++)
            ;
        if (columns->n_rows == 0)
            columns->width = n;
        if (n != columns->width && !columns->odd_line) {
            columns->odd_line = r->row[i].line;
            columns->odd_row = columns->n_rows;
            columns->odd_width = n;
        }
    }
}

static int has_marks(const Lines *l)
{
    int n = 0;
    for (const char *p = l->from; p < l->to; p++)
        n += strchr(",;\t", *p) != NULL;
    return n > 0;
}

/* Blanks before a unit in brackets, "acc [m/s2]", part no names. */
static int begins_unit(const char *p, const char *to)
{
    while (p < to && *p == ' ')
        p++;
    return p < to && (*p == '[' || *p == '(');
}

int column_name(const Lines *l, const char **p, const char **from, const char **to)
{
    const int marked = has_marks(l);
    const char *parting = marked ? ",;\t" : " ";
    while (!marked && *p < l->to && **p == ' ')
        ++*p;
    if (*p >= l->to)
        return 0;
    int deep = 0;
    for (*from = *p; *p < l->to; ++*p) {
        deep += !marked && strchr("([", **p) ? 1 : !marked && strchr(")]", **p) ? -1 : 0;
        if (strchr(parting, **p) && deep <= 0 && !(!marked && begins_unit(*p, l->to)))
            break;
    }
    *to = *p;
    *p += *p < l->to;
    return 1;
}

Status columns_name(const Columns *columns, Record *r, const Lines *names, const Channel *all, Err *err)
{
    const char *p = names->from, *from, *to;
    while (column_name(names, &p, &from, &to)) {
        Channel *c;
        TRY(record_channel(r, names, &c, err));
        *c = *all;
        c->scale = 1;
        c->first = r->n_channels - 1;
        c->stride = columns->width;
        c->n = columns->n_rows;
        channel_name(c, from, to);
    }
    return r->n_channels == columns->width ? STATUS_OK
                                           : fail(err, STATUS_BAD_DATA, "%s:%d: names %zu columns, but %zu follow",
                                                  names->path, names->number, r->n_channels, columns->width);
}

/* ---- what stands above the numbers ---------------------------------------------------------------------------- */

typedef struct {
    unsigned in_comments;  /* units */
    double dt;             /* [s] 0: not stated */
    double count;          /* of samples; 0: not stated */
    char unit[UNIT_SHOWN]; /* in them that is not known */
    char odd[160];         /* what is contradicted or not understood, and where */
    int odd_line;          /* 0: nothing */
    double stated_dt;      /* [s] of the file alone */
    Lines names;           /* from == NULL: no such line */
} Preface;

static int is_comment(const Lines *l)
{
    return (strchr("#%!", *l->from) && !csv_is_error(l->from, l->to)) || line_begins(l, "//");
}

/* A line of words begins like a word and is no number (nan and inf are numbers). */
static int is_words(const Lines *l)
{
    double x;
    if (!isalpha((unsigned char)*l->from) && !strchr("\"'[(", *l->from))
        return 0;
    const char *p = l->from, *to = field_next(l, &p, 0);
    return field_number(l, l->from, to, *l->from == '"', &x, &(Err){0}) != STATUS_OK &&
           !number_behind(l->from, to, "", &x) &&
           !(to - l->from == 3 && (line_begins(l, "nan") || line_begins(l, "inf")));
}

/* A step or a count that is stated twice must be the same. */
static void take_number(Preface *preface, double *have, double x, const char *what, const Lines *l)
{
    if (*have == 0)
        *have = x;
    else if (fabs(x - *have) > 0.01 * *have && !preface->odd_line) {
        preface->odd_line = l->number;
        snprintf(preface->odd, sizeof preface->odd, "states a %s of %.6g, elsewhere in the file it is %.6g", what, x,
                 *have);
    }
}

enum { STEP, RATE, COUNT };

/* Every x of "word ... = x" or "word ... : x" */
static void take_stated(const Lines *l, const char *word, int kind, Preface *preface)
{
    double x;
    for (const char *at = l->from; (at = find_word(at, l->to, word)); at++) {
        if (at > l->from && isalnum((unsigned char)at[-1]))
            continue;
        const char *mark = at + strlen(word);
        while (mark < l->to && !strchr("=:;", *mark))
            mark++;
        if (mark == l->to || *mark == ';' || find_word(at + strlen(word), mark, " per "))
            continue;
        const int got =
            kind == COUNT ? number_behind(mark, l->to, "", &x) : quantity_behind(mark, l->to, "", kind == RATE, &x);
        if (got < 0 && !preface->odd_line) {
            preface->odd_line = l->number;
            snprintf(preface->odd, sizeof preface->odd, "the step in '%.*s' is not in seconds", line_shown(l), l->from);
        } else if (got > 0 && x > 0 && x <= 1e6) {
            take_number(preface, kind == COUNT ? &preface->count : &preface->dt, kind == RATE ? 1 / x : x,
                        kind == COUNT ? "number of samples" : "step", l);
        }
    }
}

/* Step and number of samples. */
static void take_numbers(const Lines *l, Preface *preface)
{
    static const char *const steps[] = {"dt", "time step"};
    static const char *const rates[] = {"sampling rate", "sampling frequency", "samples per second", "fs"};
    static const char *const counts[] = {"npts", "number of points", "number of samples", "number of data"};
    for (size_t i = 0; i < sizeof steps / sizeof *steps; i++)
        take_stated(l, steps[i], STEP, preface);
    for (size_t i = 0; i < sizeof rates / sizeof *rates; i++)
        take_stated(l, rates[i], RATE, preface);
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
        take_stated(l, counts[i], COUNT, preface);
    if (preface->dt == 0) /* "step 2: filtered" may follow */
        take_stated(l, "step", STEP, preface);
}

static void take_comment(const Lines *l, Preface *preface)
{
    const char *from = l->from;
    while (from < l->to && strchr("#%!/ \t", *from))
        from++;
    preface->in_comments |= units_stated(from, l->to);
    if (!preface->unit[0])
        unit_unknown(from, l->to, preface->unit);
    take_numbers(l, preface);
}

static size_t count_names(const Lines *names)
{
    size_t n = 0;
    const char *p = names->from, *from, *to;
    while (names->from && column_name(names, &p, &from, &to))
        n++;
    return n;
}

static size_t count_fields(const Lines *l)
{
    size_t n = 0;
    for (const char *p = l->from; p < l->to; n++)
        field_next(l, &p, has_decimal_commas(l, 0));
    return n;
}

/* Do the rows so far make a table: below comments, below names that fit them or the line at hand, or three of one width? */
static int is_table(const Columns *columns, const Preface *preface, Lines start, const Lines *l)
{
    const size_t n_names = count_names(&preface->names);
    if (!lines_next_filled(&start) || columns->odd_line)
        return 0;
    return is_comment(&start) || columns->n_rows >= 3 || (n_names > 0 && n_names == columns->width) ||
           (columns->n_rows == 0 && n_names == count_fields(l) && has_marks(&preface->names) && has_marks(l));
}

/* Spreadsheets write rows of empty cells. */
static int is_empty_row(const Lines *l)
{
    const char *p = l->from;
    while (p < l->to && strchr(",; \t", *p))
        p++;
    return p == l->to;
}

static Status fail_unknown(const Lines *l, Lines start, Err *err)
{
    lines_next_filled(&start);
    return fail(err, STATUS_BAD_DATA,
                "%s:%d: in no format that is known here (docs/motions.md lists them), and no plain columns of "
                "numbers; the first line is '%.*s'",
                l->path, l->number, line_shown(&start), start.from);
}

static Status read_rows(Record *r, Lines *l, Preface *preface, Columns *columns, Err *err)
{
    const Lines start = *l;
    while (lines_next_filled(l)) {
        if (is_empty_row(l))
            continue;
        if (is_comment(l)) {
            take_comment(l, preface);
        } else if (r->n == 0 && is_words(l)) {
            if (preface->names.from)
                take_comment(&preface->names, preface);
            preface->names = *l;
        } else {
            const Status s = columns_add(columns, r, l, err);
            if (s != STATUS_OK)
                return is_table(columns, preface, start, l) || !strstr(err->text, "is not a number")
                           ? s
                           : fail_unknown(l, start, err);
        }
    }
    return STATUS_OK;
}

/* ---- which column is what ------------------------------------------------------------------------------------- */

/* Name of column k, from 0; 0: it has none. */
static int name_of(const Lines *names, size_t k, Channel *c)
{
    const char *p = names->from, *from, *to;
    for (size_t i = 0; i <= k; i++)
        if (!p || !column_name(names, &p, &from, &to))
            return 0;
    channel_name(c, from, to);
    return 1;
}

static int names_times(const Lines *names, size_t k)
{
    Channel c;
    if (!name_of(names, k, &c))
        return 0;
    return strncasecmp(c.name, "time", 4) == 0 || strncasecmp(c.name, "sec", 3) == 0 ||
           (tolower((unsigned char)c.name[0]) == 't' && !isalnum((unsigned char)c.name[1]));
}

/* Times are seconds: a name that says otherwise is refused before it shakes a tower a thousand times too slowly. */
static Status times_are_seconds(const Lines *names, size_t k, const char *path, Err *err)
{
    static const char *const OTHERS[] = {"ms", "msec", "us", "min", "minutes", "h", "hours"};
    Channel c;
    if (!name_of(names, k, &c))
        return STATUS_OK;
    for (const char *word = c.name; *word;) {
        const size_t length = strcspn(word, "_ ()[],");
        for (size_t i = 0; i < sizeof OTHERS / sizeof OTHERS[0]; i++)
            if (word != c.name && length == strlen(OTHERS[i]) && strncasecmp(word, OTHERS[i], length) == 0)
                return fail(err, STATUS_BAD_DATA, "%s: the column of times is '%s'; times must be in seconds", path,
                            c.name);
        word += length;
        word += strspn(word, "_ ()[],");
    }
    return STATUS_OK;
}

static int times_increase(const Record *r, const Columns *columns)
{
    for (size_t i = columns->width; i < r->n; i += columns->width)
        if (!(r->row[i].a > r->row[i - columns->width].a))
            return 0;
    return !columns->odd_line;
}

/* 0, 1, 2, ... or from another whole number on: these are samples, not seconds. */
static int counts_samples(const Record *r, const Columns *columns)
{
    if (columns->odd_line || columns->width < 2 || columns->n_rows < 2)
        return 0;
    for (size_t k = 0; k < columns->n_rows; k++) {
        const Row *row = &r->row[k * columns->width];
        if (row->decimals != 0 || row->a != r->row[0].a + (double)k)
            return 0;
    }
    return r->row[0].a == floor(r->row[0].a);
}

/* Rising at three steps of four at least: times, perhaps with a mistake, and no acceleration. */
static int looks_like_times(const Record *r, const Columns *columns)
{
    size_t steps = 0, rises = 0;
    for (size_t i = columns->width; i < r->n; i += columns->width, steps++)
        rises += r->row[i].a > r->row[i - columns->width].a;
    return 4 * rises >= 3 * steps;
}

/* The samples without the first n numbers. */
static void drop_first(Record *r, size_t n, Columns *columns)
{
    r->n -= n;
    memmove(r->row, r->row + n, r->n * sizeof *r->row);
    recount(columns, r);
}

/* Two numbers before the samples are "npts dt" where they stand alone in their row, or one each in two, and the first
 * counts the samples, or the rows, that follow; one number is "npts" in the same way. */
static void take_count(Record *r, Columns *columns, Preface *preface)
{
    enum { SAMPLES_MIN = 10 }; /* of fewer a sample might be their number */
    if (r->n < 4 || columns->width > 2 || (columns->width == 1 && r->n < SAMPLES_MIN))
        return;
    const double count = r->row[0].a, dt = r->row[1].a, rows = (double)columns->n_rows;
    const int is_step = dt > 0 && dt < MOTION_STEP_MAX_S;
    const int in_two = columns->width == 1 && r->row[2].line != r->row[1].line && count == (double)r->n - 2;
    const int is_pair = columns->width == 2 && (count == (double)r->n - 2 || count == rows - 1);
    const Lines l = {.number = r->row[0].line};
    if (is_step && (is_pair || in_two)) {
        drop_first(r, 2, columns);
        take_number(preface, &preface->dt, dt, "step", &l);
    } else if (columns->width == 1 && (count == (double)r->n - 1 || count == rows - 1)) {
        drop_first(r, 1, columns);
    } else {
        return;
    }
    take_number(preface, &preface->count, count, "number of samples", &l);
}

/* Column k of each row. */
static void set_times(Record *r, size_t width, size_t k)
{
    for (size_t i = 0; i + width <= r->n; i += width) {
        const Row time = r->row[i + k];
        for (size_t j = i; j < i + width; j++) {
            r->row[j].t = time.a;
            r->row[j].decimals = time.decimals;
        }
    }
}

static Status one_long_column(Record *r, const Lines *l, const Preface *preface, unsigned units, Err *err)
{
    Channel *c;
    TRY(record_channel(r, l, &c, err));
    *c = (Channel){.scale = 1, .units = units, .dt = preface->dt, .stride = 1, .n = r->n};
    memcpy(c->unit, preface->unit, sizeof c->unit);
    return STATUS_OK;
}

/* All columns but `skipped` become channels, at equal steps unless they are `timed`. A column that names no unit has that of
 * the line of names as a whole where it is the only one, else that of the comments. */
static Status name_channels(Record *r, const Lines *l, const Preface *preface, const Columns *columns, size_t skipped,
                            int timed, Err *err)
{
    const Lines *names = &preface->names;
    const int named = count_names(names) == columns->width, is_only = columns->width - (skipped < columns->width) == 1;
    const unsigned in_names = names->from && (is_only || !named) ? units_stated(names->from, names->to) : 0;
    const char *p = names->from, *from = NULL, *to = NULL;
    for (size_t k = 0; k < columns->width; k++) {
        Channel *c;
        if (named)
            column_name(names, &p, &from, &to);
        if (k == skipped)
            continue;
        TRY(record_channel(r, l, &c, err));
        *c = (Channel){.scale = 1,
                       .other_dt = timed ? preface->stated_dt : 0,
                       .dt = timed ? 0 : preface->dt,
                       .first = k,
                       .stride = columns->width,
                       .n = columns->n_rows};
        if (named)
            channel_name(c, from, to);
        c->units = named ? units_named(from, to) : 0;
        c->units = c->units ? c->units : in_names ? in_names : preface->in_comments;
        memcpy(c->unit, preface->unit, sizeof c->unit);
    }
    return STATUS_OK;
}

static int recognise(Lines l)
{
    (void)l;
    return 1;
}

/* What numbers without names are, when their first column holds no times. */
static Status fail_unnamed(const Record *r, const Lines *l, const Columns *columns, const Preface *preface, Err *err)
{
    if (columns->odd_line)
        return columns_check(columns, l, err);
    const size_t n_names = count_names(&preface->names);
    if (n_names > 1 && 2 * n_names == columns->width && !columns->point_line)
        return fail(
            err, STATUS_BAD_DATA,
            "%s:%d: %zu columns are named, but the rows have %zu numbers: are its commas decimal ones too? Write "
            "decimal points, or semicolons between the columns",
            l->path, r->row[0].line, n_names, columns->width);
    if (!(preface->dt > 0))
        return fail(err, STATUS_BAD_DATA,
                    "%s:%d: has %zu columns without names, and the first holds no times; set motion.dt_s (--set "
                    "motion.dt_s=0.01)",
                    l->path, r->row[0].line, columns->width);
    return fail(err, STATUS_BAD_DATA,
                "%s:%d: has %zu rows of %zu columns without names: choose one by motion.channel (--channel 1 to %zu); "
                "if they are one motion written row by row, put '# npts = %zu' above them%s",
                l->path, r->row[0].line, columns->n_rows, columns->width, columns->width, r->n,
                columns->width == 2 && !columns->point_line
                    ? "; if they are one column with decimal commas, put its name above it"
                    : "");
}

/* Rows, with the comma as decimal mark where the names name one column; then without what stands above the samples. */
static Status read_table(Record *r, Lines *l, Preface *preface, Columns *columns, Err *err)
{
    const Lines start = *l;
    Lines first = start;
    TRY(read_rows(r, l, preface, columns, err));
    if (columns->n_rows < 2 && count_names(&preface->names) != columns->width && lines_next_filled(&first) &&
        !is_comment(&first) && !(preface->count > 1))
        return fail_unknown(l, start, err);
    if (count_names(&preface->names) == 1 && columns->width == 2 && !columns->point_line) {
        *columns = (Columns){.is_one = 1};
        *l = start;
        r->n = 0;
        TRY(read_rows(r, l, preface, columns, err));
    }
    take_count(r, columns, preface);
    if (preface->names.from && count_names(&preface->names) != columns->width)
        take_comment(&preface->names, preface);
    if (preface->odd_line)
        return fail(err, STATUS_BAD_DATA, "%s:%d: %s", l->path, preface->odd_line, preface->odd);
    if (columns->n_rows < 2 && columns->width < 3)
        return fail(err, STATUS_BAD_DATA, "%s: holds %zu sample%s; at least two are needed", l->path, columns->n_rows,
                    columns->n_rows == 1 ? "" : "s");
    return STATUS_OK;
}

/* The column that is named as times, or the first, where none is. */
static size_t column_of_times(const Preface *preface, const Columns *columns, int *known)
{
    *known = 0;
    for (size_t k = 0; count_names(&preface->names) == columns->width && k < columns->width; k++) {
        *known = names_times(&preface->names, k);
        if (*known)
            return k;
    }
    return 0;
}

static Status read(Record *r, Lines *l, const ReadHints *hints, Err *err)
{
    Preface preface = {0};
    Columns columns = {0};
    int known;
    TRY(read_table(r, l, &preface, &columns, err));
    preface.stated_dt = preface.dt;
    preface.dt = preface.dt > 0 ? preface.dt : hints->dt_s;
    const int named = count_names(&preface.names) == columns.width;
    const unsigned units = preface.names.from ? units_stated(preface.names.from, preface.names.to) : 0;
    const size_t times = column_of_times(&preface, &columns, &known);
    int timed = columns.width > 1 && !(named && preface.dt > 0 && !known);
    if (columns.width == 1 && !(preface.dt > 0))
        return fail(err, STATUS_BAD_DATA,
                    "%s:%d: has one column and does not say its step; set motion.dt_s, or give times beside it",
                    l->path, r->row[0].line);
    if (columns.width > 1 && !named && preface.dt > 0 && preface.count == (double)r->n)
        return one_long_column(r, l, &preface, units ? units : preface.in_comments, err);
    if (columns.width > 1 && !named && !times_increase(r, &columns)) {
        timed = !(preface.dt > 0) && looks_like_times(r, &columns);
        if (columns.odd_line || (!timed && (!(preface.dt > 0) || !hints->channel)))
            return fail_unnamed(r, l, &columns, &preface, err);
    }
    TRY(columns_check(&columns, l, err));
    if (preface.count > 1 && preface.count != (double)columns.n_rows && preface.count != (double)r->n)
        return fail(err, STATUS_BAD_DATA, "%s: announces %g samples, but has %zu rows", l->path, preface.count,
                    columns.n_rows);
    const int numbered = !known && counts_samples(r, &columns);
    if (numbered && !(preface.dt > 0))
        return fail(err, STATUS_BAD_DATA,
                    "%s:%d: the first column counts %g, %g, ...: are these samples? Give their step (--set "
                    "motion.dt_s=0.01); if they are seconds, name the column time_s",
                    l->path, r->row[0].line, r->row[0].a, r->row[columns.width].a);
    timed = timed && !numbered;
    if (timed && named)
        TRY(times_are_seconds(&preface.names, times, l->path, err));
    if (timed)
        set_times(r, columns.width, times);
    return name_channels(r, l, &preface, &columns, timed || numbered ? times : columns.width, timed, err);
}

const MotionFormat FORMAT_COLUMNS = {"csv", recognise, read};
