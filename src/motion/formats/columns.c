/* Plain text: one, two or many columns of numbers, parted by blanks, tabs, commas or semicolons.
 *
 *   header    lines that begin with # % ! or //, and lines of words above the numbers, hold pairs "key = value" or
 *             "key: value": unit (m/s2, cm/s2, gal, g), step ("dt = 1/200 s", "sampling rate: 100"), number of samples
 *             ("npts = 4000"); what is stated twice must agree. Anything else in them is passed over
 *   names     the last line of words names the columns, else a comment that begins with the name of times or periods;
 *             a unit in a name, "acc [m/s2]" or "acc_m_s2", wins
 *   npts dt   two numbers alone in the first row, or one each in the first two, where the first is the number of
 *             samples or rows that follow; npts alone in the first row
 *   times     the column that is named so, else the first where it has no other name; with another name, which may be
 *             that of a period or of a frequency, the step must be known. 0, 1, 2, ... without such a name are numbers
 *             of samples
 *   rows      numbers without names are read row by row as one long column where their number is the one that is
 *             stated, or where the step is known and the last of rows too wide for the components of a station is
 *             shorter
 *   1,5;2,5   a comma is a decimal one where semicolons, tabs or blanks part the columns and every comma stands between
 *             digits, and where the names name one column and no number has a point */
#include <ctype.h>

#include "motion/formats/record.h"

typedef struct {
    Record *r;
    Lines *l;
    Lines start, names, above;     /* from == NULL: no line of words, no comment that heads columns */
    size_t n_names, width, n_rows; /* width: numbers of the first row */
    size_t odd_row, odd_width;     /* the first row that is not as wide */
    int odd_line, is_one;          /* odd_line 0: none; is_one: one column, no comma parts anything */
    double dt, count;              /* [s], of samples; 0: not stated */
    Channel all;                   /* unit, or stated, of every column that has none in its name */
    int is_counted, is_timed;      /* the first column counts rows; a column of times is named so */
    int restated_line;             /* of a step, a count or a unit below the first row; 0: none */
    Err wrong;                     /* what is contradicted or not understood; empty: nothing */
} Plain;

/* ---- header ------------------------------------------------------------------------------------------------------ */

/* A step or a count that is stated twice must be the same. */
static void state_number(Plain *t, double *have, double x, const char *what, const Lines *l)
{
    if (*have == 0)
        *have = x;
    else if (fabs(x - *have) > 0.01 * *have)
        fail_at(&t->wrong, l, "states a %s of %.6g, elsewhere in the file it is %.6g", what, x, *have);
}

static const char PARTS[] = "_ ()[],"; /* between the words of a name */

static int names_seconds(Cell c)
{
    return text_is(EQUALS, c.from, c.to, "s|sec|secs|second|seconds");
}

/* Or a period, by name or as the T of an oscillator; the last two are the first letters of both in Japanese and
 * Chinese. */
static int names_frequency(Cell c)
{
    const char *p = c.from;
    const Cell word = cell_next(&p, c.to, PARTS);
    return text_is(EQUALS, word.from, word.to, "tn|t0|t1|t2") ||
           text_is(HOLDS, c.from, c.to, "period|freq|frec|omega|[hz|(hz|_hz|\xe5\x91\xa8|\xe9\xa2\x91");
}

/* "time", "t [s]", "Zeit", or anything in seconds but a period. */
static int names_times(Cell c)
{
    const char *p = c.from;
    Cell word = cell_next(&p, c.to, PARTS);
    if (names_frequency(c))
        return 0;
    if (text_is(EQUALS, word.from, word.to, "t") || text_is(HOLDS, c.from, c.to, "time") ||
        text_is(BEGINS, c.from, c.to, "sec|zeit|tiempo|temps|tempo|zaman|czas"))
        return 1;
    while (p < c.to)
        word = cell_next(&p, c.to, PARTS);
    return names_seconds(word);
}

/* The unit that the text begins with, where it begins with one. */
static void read_unit(Channel *c, const char *from, const char *to)
{
    channel_unit(c, from, to);
    if (!c->counts && !is_quantity(c->stated, c->stated + strlen(c->stated)))
        c->stated[0] = 0;
}

enum { UNIT, STEP, RATE, COUNT };
static const struct {
    const char *word;
    int kind;
} KEYS[] = {{"unit", UNIT},
            {"units", UNIT},
            {"dt", STEP},
            {"time step", STEP},
            {"sampling rate", RATE},
            {"sampling frequency", RATE},
            {"samples per second", RATE},
            {"fs", RATE},
            {"npts", COUNT},
            {"number of points", COUNT},
            {"number of samples", COUNT},
            {"number of data", COUNT},
            {"step", STEP}};

/* The value of a key behind its mark. */
static void read_value(Plain *t, int kind, const Lines *l, const char *mark)
{
    double x;
    if (kind == UNIT) {
        Channel c = {.scale = 1};
        read_unit(&c, mark, l->to);
        const char *next = memchr(mark, ',', l->to - mark); /* "units: s, g" */
        if (next && names_seconds((Cell){.from = c.stated, .to = c.stated + strlen(c.stated)}))
            read_unit(&c, next + 1, l->to);
        if (c.unit && t->all.unit && c.unit != t->all.unit)
            fail_at(&t->wrong, l, "states another unit than a line above");
        if (!t->all.unit && c.scale == 1)
            t->all = c;
        return;
    }
    const int got =
        kind == COUNT ? number_behind(mark, l->to, "", &x) : quantity_behind(mark, l->to, "", kind == RATE, &x);
    if (got < 0)
        fail_at(&t->wrong, l, "the step in '%.*s' is not in seconds", line_shown(l), l->from);
    else if (got > 0 && x > 0 && x <= 1e6 && kind == COUNT)
        state_number(t, &t->count, x, "number of samples", l);
    else if (got > 0 && x > 0 && x <= 1e6)
        state_number(t, &t->dt, kind == RATE ? 1 / x : x, "step", l);
}

/* Every "key ... = value" or "key ... : value" of a comment or a line of words. */
static void read_pairs(Plain *t, const Lines *l)
{
    for (size_t i = 0; i < N_OF(KEYS); i++) {
        const size_t n = strlen(KEYS[i].word);
        if (strcmp(KEYS[i].word, "step") == 0 && t->dt > 0) /* "step 2: filtered" may follow */
            continue;
        for (const char *at = l->from; (at = find_word(at, l->to, KEYS[i].word)); at++) {
            const char *mark = at + n;
            while (mark < l->to && !strchr("=:;,", *mark))
                mark++;
            if (mark == l->to || strchr(";,", *mark) || (at > l->from && isalnum((unsigned char)at[-1])) ||
                isalpha((unsigned char)at[n]) || find_word(at + n, mark, " per "))
                continue;
            read_value(t, KEYS[i].kind, l, mark);
            t->restated_line = t->r->n ? l->number : 0;
        }
    }
}

static int is_comment(const Lines *l)
{
    return (strchr("#%!", *l->from) && !csv_is_error(l->from, l->to)) || line_begins(l, "//");
}

/* A line of words begins like a word, or with the empty name of a column of numbers, and is no number (nan and inf
 * are). */
static int is_words(const Lines *l)
{
    double x;
    const char *p = l->from;
    if (!isalpha((unsigned char)*p) && (unsigned char)*p < 128 && !strchr("\"'[(,", *p))
        return 0;
    const Cell c = cell_next(&p, l->to, " ,;");
    return cell_number(c, c.is_quoted, &x) == NO_NUMBER && !number_behind(c.from, c.to, "", &x);
}

/* ---- names ------------------------------------------------------------------------------------------------------- */

static int has_marks(const Lines *l)
{
    const char *p = l->from;
    while (p < l->to && !strchr(",;\t", *p))
        p++;
    return p < l->to;
}

/* The name at *p; commas, semicolons or tabs part names, or else blanks, but none that stands in brackets or before
 * them. */
static Cell next_name(const Lines *l, const char **p)
{
    const size_t n = l->to - l->from;
    if (has_marks(l))
        return cell_next(p, l->to, memchr(l->from, ';', n) ? ";" : ",\t");
    Cell c = {.from = *p, .to = *p};
    for (int deep = 0; c.to < l->to; c.to++) {
        const char *behind = c.to;
        while (behind < l->to && *behind == ' ')
            behind++;
        deep += strchr("([", *c.to) ? 1 : strchr(")]", *c.to) ? -1 : 0;
        if (*c.to == ' ' && deep <= 0 && !(behind < l->to && strchr("([", *behind)))
            break;
    }
    *p = c.to;
    while (*p < l->to && **p == ' ')
        ++*p;
    *p += *p == l->to;
    return c;
}

/* Name k, from 0. */
static Cell name_at(const Plain *t, size_t k)
{
    Cell c = {0};
    const char *p = t->names.from;
    for (size_t i = 0; p && i <= k && p <= t->names.to; i++)
        c = next_name(&t->names, &p);
    return c;
}

static void set_names(Plain *t, const Lines *l)
{
    t->names = *l;
    t->n_names = 0;
    for (const char *p = l->from; p <= l->to && t->n_names <= CHANNELS_MAX + 1; t->n_names++)
        next_name(l, &p);
}

static int is_named(const Plain *t)
{
    return t->n_names > 0 && t->n_names == t->width;
}

/* "acc [m/s2]", "acceleration (in g)", "acc_m_s2", "gal". Behind a number of several digits, "x1000_m_s2", stands a
 * multiple. */
static void unit_in_name(Cell name, Channel *c)
{
    const char *open = name.to;
    while (open > name.from && !strchr("[(", open[-1]))
        open--;
    if (open > name.from) {
        const char *close = open;
        while (close < name.to && !strchr("])", *close))
            close++;
        if (open[-1] == '(' && close - open == 1 && strchr("NSEWUDVZ", *open)) /* a direction */
            return;
        open += find_word(open, close, "in ") == open ? 3 : 0;
        read_unit(c, open, close);
        if (c->scale != 1 || (c->unit && unit_of(open, close) != c->unit)) { /* tenths, or more than a unit */
            c->unit = UNIT_FROM_FILE;
            c->scale = 1;
            snprintf(c->stated, sizeof c->stated, "%.*s", (int)MIN_OF(close - open, 31), open);
        }
        return;
    }
    for (const char *p = name.from; p < name.to && !c->unit; p++)
        if ((p == name.from || strchr("_ ", p[-1])) &&
            !(p - name.from > 2 && isdigit((unsigned char)p[-2]) && isdigit((unsigned char)p[-3])))
            c->unit = unit_of(p, name.to);
    for (const char *p = name.from + 1; p < name.to && !c->unit; p++)
        if (p[-1] == '_' && text_is(EQUALS, p, name.to, "cm_s|m_s|mm_s|in_s|kn|mn|kpa|mpa|m|cm|mm|knm|rad|deg|mg|hz"))
            snprintf(c->stated, sizeof c->stated, "%.*s", (int)(name.to - p), p);
}

/* Times are seconds: a name that says otherwise is refused before it shakes a tower a thousand times too slowly, and
 * periods, frequencies or whatever else the first column is said to be are no times. A title of two words above two
 * columns is no name. */
static Status check_times(const Plain *t, Cell name, Err *err)
{
    const Lines *l = &t->names;
    int is_title = !has_marks(l) && !text_is(HOLDS, l->from, l->to, "[|(|_");
    for (const char *p = name.from; p < name.to; p++)
        is_title |= (unsigned char)*p > 127; /* in another script, perhaps of time */
    if (!t->is_timed && name.from < name.to && !is_title)
        return fail_at(err, l,
                       "the first column is '%.*s', which is no time: name the one of the times time_s, or give the "
                       "step of the samples (--set motion.dt_s=0.01)",
                       (int)(name.to - name.from), name.from);
    for (const char *p = name.from; p <= name.to;) {
        const Cell word = cell_next(&p, name.to, PARTS);
        if (word.from > name.from && text_is(EQUALS, word.from, word.to, "ms|msec|us|min|minutes|h|hours"))
            return bad_data(err, "%s: the column of times is '%.*s'; times must be in seconds", t->l->path,
                            (int)(name.to - name.from), name.from);
    }
    return STATUS_OK;
}

/* ---- rows -------------------------------------------------------------------------------------------------------- */

/* Finds number and width of the rows, and the first one that has another width than the first. */
static void measure_rows(Plain *t)
{
    const Record *r = t->r;
    t->n_rows = t->width = t->odd_line = 0;
    for (size_t i = 0, k; i < r->n; i += k, t->n_rows++) {
        for (k = 1; i + k < r->n && r->row[i + k].line == r->row[i].line; k++)
            ;
        t->width = i ? t->width : k;
        if (k != t->width && !t->odd_line) {
            t->odd_line = r->row[i].line;
            t->odd_row = t->n_rows;
            t->odd_width = k;
        }
    }
}

/* Does something else than commas part the columns? */
static int has_decimal_commas(const Plain *t)
{
    const Lines *l = t->l;
    const size_t n = l->to - l->from;
    return memchr(l->from, ';', n) || ((t->is_one || memchr(l->from, ' ', n) || memchr(l->from, '\t', n)) &&
                                       csv_has_decimal_commas(l->from, l->to));
}

/* Refuses a text that is no table either, with its first line, by which people see what they have. */
static Status fail_unknown(const Plain *t, Err *err)
{
    Lines start = t->start;
    lines_next_filled(&start);
    return fail_at(err, t->l,
                   "in no format that is known here (docs/motions.md lists them), and no plain columns of "
                   "numbers (a list of motions has a name that ends in list.txt); the first line is '%.*s'",
                   line_shown(&start), start.from);
}

/* Do the rows so far make a table: below comments, below names that fit them or the line at hand, or three of one
 * width? */
static int is_table(Plain *t)
{
    Lines start = t->start;
    size_t n = 0;
    measure_rows(t);
    if (t->odd_line || !lines_next_filled(&start))
        return 0;
    const int with_comma = has_decimal_commas(t);
    for (const char *p = t->l->from; p <= t->l->to && n <= t->n_names; n++)
        cell_next(&p, t->l->to, with_comma ? " ;" : " ,;");
    return is_comment(&start) || t->n_rows >= 3 || is_named(t) ||
           (t->n_rows == 0 && n == t->n_names && has_marks(&t->names) && has_marks(t->l));
}

/* Comments, names and rows of numbers. */
static Status read_rows(Plain *t, Err *err)
{
    Lines *l = t->l;
    while (lines_next_filled(l)) {
        const size_t before = t->r->n;
        const char *p = l->from;
        size_t n;
        while (p < l->to && strchr(",; \t", *p)) /* spreadsheets write rows of empty cells */
            p++;
        if (p == l->to)
            continue;
        const int is_above = before == 0 && is_words(l);
        if (is_comment(l) || (is_above && memchr(l->from, '=', l->to - l->from))) {
            read_pairs(t, l);
            if (before > 0)
                continue;

            /* A comment heads the columns if it parts names as a table does, the first one of times or periods. */
            Lines h = *l;
            while (h.from < h.to && strchr("#%!/ ", *h.from))
                h.from++;
            p = h.from;
            const Cell first = next_name(&h, &p);
            if (!text_is(HOLDS, h.from, h.to, "=|:") && (has_marks(&h) || text_is(HOLDS, h.from, h.to, "[|(|_")) &&
                (names_times(first) || names_frequency(first)))
                t->above = h;
        } else if (is_above) {
            if (t->names.from)
                read_pairs(t, &t->names);
            set_names(t, l);
        } else {
            if (t->restated_line)
                return bad_data(
                    err,
                    "%s:%d: states a step, a unit or a number of samples below the first sample; is it a second "
                    "record? Keep one of them",
                    l->path, t->restated_line);
            const Status s = record_add_cells(t->r, l, has_decimal_commas(t), &n, err);
            if (s == STATUS_OK)
                continue;
            t->r->n = before;
            if (before && is_words(l) && !has_marks(l) && !lines_ahead(l).from) /* "end" */
                return STATUS_OK;
            return err->sub != SUB_NO_NUMBER || is_table(t) ? s : fail_unknown(t, err);
        }
    }
    return STATUS_OK;
}

/* Two numbers before the samples are "npts dt" where they stand alone in their row, or one each in two, and the first
 * counts the samples, or the rows, that follow; one number is "npts" in the same way. */
static void read_count(Plain *t)
{
    enum { SAMPLES_MIN = 10 }; /* of fewer a sample might be their number */
    Record *r = t->r;
    if (r->n < 4 || t->width > 2 || (t->width == 1 && r->n < SAMPLES_MIN))
        return;
    const double count = r->row[0].a, dt = r->row[1].a, rows = (double)t->n_rows, n = (double)r->n;
    const int in_two = t->width == 1 && r->row[2].line != r->row[1].line && count == n - 2;
    const int is_pair = t->width == 2 && (count == n - 2 || count == rows - 1);
    const int has_dt = dt > 0 && dt < MOTION_STEP_MAX_S && (is_pair || in_two);
    const Lines l = {.path = t->l->path, .number = r->row[0].line};
    if (!has_dt && !(t->width == 1 && (count == n - 1 || count == rows - 1)))
        return;
    if (has_dt)
        state_number(t, &t->dt, dt, "step", &l);
    state_number(t, &t->count, count, "number of samples", &l);
    r->n -= 1 + has_dt;
    memmove(r->row, r->row + 1 + has_dt, r->n * sizeof *r->row);
    measure_rows(t);
}

/* Rows, with the comma as decimal mark where the names name one column; then without what stands above the samples. */
static Status read_table(Plain *t, Err *err)
{
    Lines first = t->start;
    TRY(read_rows(t, err));
    measure_rows(t);
    if (t->n_rows < 2 && !is_named(t) && lines_next_filled(&first) && !is_comment(&first) && !(t->count > 1))
        return fail_unknown(t, err);
    if (t->n_names == 1 && t->width == 2 && !t->l->point_line) {
        *t = (Plain){.r = t->r, .l = t->l, .start = t->start, .is_one = 1};
        *t->l = t->start;
        t->r->n = 0;
        TRY(read_rows(t, err));
        measure_rows(t);
    }
    read_count(t);
    if (t->names.from && !is_named(t))
        read_pairs(t, &t->names);
    if (!t->names.from && t->above.from)
        set_names(t, &t->above);
    if (t->wrong.text[0]) {
        *err = t->wrong;
        return STATUS_BAD_DATA;
    }
    if (t->n_rows < 2 && t->width < 3)
        return bad_data(err, "%s: holds %zu sample%s; at least two are needed", t->l->path, t->n_rows,
                        t->n_rows == 1 ? "" : "s");
    return STATUS_OK;
}

/* Refuses rows of different widths. */
static Status check_rows(const Plain *t, Err *err)
{
    const char *s = t->odd_width == 1 ? "" : "s";
    if (!t->odd_line)
        return STATUS_OK;
    t->r->is_known = t->r->n >= 20; /* a table is told from a text by its numbers */
    if (t->odd_row == 1)            /* what stands alone above all others is meant otherwise */
        return fail_sub(
            err, STATUS_BAD_DATA, SUB_RAGGED,
            "%s:%d: has %zu column%s where the line of numbers above has %zu; if that line states the number "
            "of samples, %zu lines follow it; put # before what is no sample",
            t->l->path, t->odd_line, t->odd_width, s, t->width, t->n_rows - 1);
    return fail_sub(
        err, STATUS_BAD_DATA, SUB_RAGGED,
        "%s:%d: has %zu column%s where the lines above have %zu; one motion written row by row has its number "
        "of samples above it, '# npts = %zu', and its step ('# dt = 0.01 s', or --set motion.dt_s=0.01)",
        t->l->path, t->odd_line, t->odd_width, s, t->width, t->r->n);
}

/* ---- which column is what ---------------------------------------------------------------------------------------- */

/* All columns but `skipped` become channels, at equal steps unless they are `timed`. */
static Status name_channels(const Plain *t, size_t skipped, int timed, double stated_dt, Err *err)
{
    static const char *const UNITS[] = {MOTION_UNIT_LIST(CHOICE_WORD)};
    const char *p = t->names.from;
    for (size_t k = 0; k < t->width; k++) {
        Channel *c;
        const Cell name = is_named(t) ? next_name(&t->names, &p) : (Cell){0};
        if (k == skipped || (k == 0 && t->is_counted) || (is_named(t) && name.from == name.to))
            continue; /* pandas does not name the numbers of its rows */
        TRY(record_channel(t->r, t->l, &c, err));
        *c = (Channel){.scale = 1,
                       .other_dt = timed ? stated_dt : 0,
                       .is_timed = timed && t->is_timed,
                       .dt = timed ? 0 : t->dt,
                       .first = k,
                       .stride = t->width,
                       .n = t->n_rows,
                       .format = "csv"};
        if (is_named(t)) {
            channel_name(c, name.from, name.to);
            unit_in_name(name, c);
        }
        if (c->unit && t->all.unit && c->unit != t->all.unit)
            return fail_at(err, &t->names, "the column '%s' is in %s, but the header above says %s", c->name,
                           UNITS[c->unit], UNITS[t->all.unit]);
        if (!c->unit && !c->stated[0] && t->all.unit)
            c->unit = t->all.unit;
        if (!c->unit && !c->stated[0])
            memcpy(c->stated, t->all.stated, sizeof c->stated);
    }
    return STATUS_OK;
}

/* What numbers without names are, when their first column holds no times. */
static Status fail_unnamed(const Plain *t, const Lines *first, Err *err)
{
    TRY(check_rows(t, err));
    if (t->n_names > 1 && 2 * t->n_names == t->width && !t->l->point_line)
        return fail_at(err, first,
                       "%zu columns are named, but the rows have %zu numbers: are its commas decimal ones too? Write "
                       "decimal points, or semicolons between the columns",
                       t->n_names, t->width);
    if (!(t->dt > 0))
        return fail_at(err, first,
                       "has %zu columns without names, and the first holds no times; set motion.dt_s (--set "
                       "motion.dt_s=0.01)",
                       t->width);
    return fail_at(err, first,
                   "has %zu rows of %zu columns without names: choose one by motion.channel (--channel 1 to %zu); "
                   "if they are one motion written row by row, put '# npts = %zu' above them%s",
                   t->n_rows, t->width, t->width, t->r->n,
                   t->width == 2 && !t->l->point_line
                       ? "; if they are one column with decimal commas, put its name above it"
                       : "");
}

/* 0, 1, 2, ... or from another whole number on: these are samples, not seconds. */
static int counts_samples(const Plain *t)
{
    const Row *row = t->r->row;
    size_t k = 0;
    while (k < t->n_rows && row[k * t->width].decimals == 0 && row[k * t->width].a == row[0].a + (double)k)
        k++;
    return t->width > 1 && t->n_rows > 1 && row[0].a == floor(row[0].a) && k == t->n_rows;
}

Status columns_read(Record *r, Lines *l, Err *err)
{
    enum { COMPONENTS_MAX = 4 };
    Plain plain = {.r = r, .l = l, .start = *l}, *t = &plain;
    size_t times = 0, rises = 0;
    TRY(read_table(t, err));
    const double stated_dt = t->dt;
    const Row *row = r->row;
    const Lines first = {.path = l->path, .number = row[0].line};
    t->dt = stated_dt > 0 ? stated_dt : r->hints.dt_s;

    /* Times stand in the column that is named so, or in the first, where none is. */
    for (size_t k = 0; is_named(t) && k < t->width && !t->is_timed; k++)
        if ((t->is_timed = names_times(name_at(t, k))))
            times = k;
    if (is_named(t) && !t->is_timed && names_frequency(name_at(t, 0)))
        return fail_at(err, &t->names, "'%.*s' heads a spectrum; a motion is a function of time", line_shown(&t->names),
                       t->names.from);
    int timed = t->width > 1 && !(is_named(t) && t->dt > 0 && !t->is_timed);
    if (t->width == 1 && !(t->dt > 0))
        return fail_at(err, &first,
                       "has one column and does not say its step; set motion.dt_s, or give times beside it");

    /* Without names: one motion row by row, whose number of samples is stated, or whose last row is shorter, while none
     * is as narrow as the components of a station and the first column does not rise like times; or times, perhaps with
     * a mistake; or columns of which one is wanted. */
    if (t->width > 1 && !is_named(t)) {
        for (size_t i = t->width; i < r->n; i += t->width)
            rises += row[i].a > row[i - t->width].a;
        const int mostly_rises = 4 * rises >= 3 * (t->n_rows - 1);
        const int is_wrapped = t->width > COMPONENTS_MAX && t->odd_line && t->odd_row + 1 == t->n_rows &&
                               t->odd_width < t->width && !r->hints.channel && !mostly_rises;
        if (t->dt > 0 && (t->count == r->n || is_wrapped)) {
            t->width = 1;
            t->n_rows = r->n;
            return name_channels(t, 1, 0, 0, err);
        }
        if (t->odd_line || rises + 1 < t->n_rows) {
            timed = !(t->dt > 0) && mostly_rises;
            if (t->odd_line || (!timed && (!(t->dt > 0) || !r->hints.channel)))
                return fail_unnamed(t, &first, err);
        }
    }
    TRY(check_rows(t, err));
    if (t->count > 1 && t->count != t->n_rows && t->count != r->n)
        return bad_data(err, "%s: announces %g samples, but has %zu rows", l->path, t->count, t->n_rows);
    t->is_counted = counts_samples(t);
    if (!t->is_timed && t->is_counted && !(t->dt > 0))
        return fail_at(err, &first,
                       "the first column counts %g, %g, ...: are these samples? Give their step (--set "
                       "motion.dt_s=0.01); if they are seconds, name the column time_s",
                       row[0].a, row[t->width].a);
    timed = timed && (t->is_timed || !t->is_counted);
    if (timed && is_named(t))
        TRY(check_times(t, name_at(t, times), err));
    if (timed)
        record_set_times(r, 0, t->width, times);
    return name_channels(t, timed ? times : t->width, timed, stated_dt, err);
}
