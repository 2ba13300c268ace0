/* Plain text: one, two or many columns of numbers, parted by blanks, tabs, commas or semicolons.
 *
 *   header    lines that begin with # % ! or //, and lines of words above the numbers, hold pairs "key = value" or
 *             "key: value": unit (m/s2, cm/s2, gal, g), step ("dt = 1/200 s", "sampling rate: 100"), number of samples
 *             ("npts = 4000"); what is stated twice must agree. Anything else in them is passed over
 *   names     the last line of words names the columns, else a comment that begins with the name of times or periods;
 *             a unit in a name, "acc [m/s2]" or "acc_m_s2", wins
 *   signs     a line of signs alone (-----, =====) above the numbers is passed over, one of * not right above a number
 *   npts dt   two numbers alone in the first row, or one each in the first two, where the first is the number of
 *             samples or rows that follow; npts alone in the first row; "300 points, 0.01 s" in a line of words
 *   times     the column that is named so, else the first where it has no other name; with another name, which may be
 *             that of a period or of a frequency, the step must be known. 0, 1, 2, ... without such a name are numbers
 *             of samples
 *   rows      numbers without names are read row by row as one long column where their number is the one that is
 *             stated, or where the step is known and the last of rows too wide for the components of a station is
 *             shorter
 *   asked     motion.text says which lines and columns to take (TextForm), and that counts before what is found above
 *   1,5;2,5   a comma is a decimal one where semicolons, tabs or blanks part the columns and every comma stands between
 *             digits, and where the names name one column and no number has a point */
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
static void state_number(Plain *t, double *have, double x, const Lines *l)
{
    if (*have == 0)
        *have = x;
    else if (fabs(x - *have) > 0.01 * *have)
        fail_at(&t->wrong, l, "states a %s of %.6g, elsewhere in the file it is %.6g",
                have == &t->dt ? "step" : "number of samples", x, *have);
}

static const char PARTS[] = "_ ()[],"; /* between the words of a name */

static const char SECONDS[] = "s|sec|secs|second|seconds";

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
    return text_is(EQUALS, word.from, word.to, SECONDS);
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
        if (next && text_is(EQUALS, c.stated, c.stated + strlen(c.stated), SECONDS))
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
    else if (got > 0 && x > 0 && x <= 1e6)
        state_number(t, kind == COUNT ? &t->count : &t->dt, kind == RATE ? 1 / x : x, l);
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
            if (mark == l->to || strchr(";,", *mark) || (at > l->from && (is_letter(at[-1]) || is_digit(at[-1]))) ||
                is_letter(at[n]) || find_word(at + n, mark, " per "))
                continue;
            read_value(t, KEYS[i].kind, l, mark);
            t->restated_line = t->r->n ? l->number : 0;
        }
    }
}

/* "300 points, 0.01 s" at the beginning of a line, "acceleration in g" at its end or before a comma. */
static void read_phrases(Plain *t, const Lines *l)
{
    const char *p = l->from, *in = find_word(p, l->to, "acceleration in "),
               *comma = in ? memchr(in, ',', l->to - in) : NULL;
    double x;
    while (p < l->to && is_digit(*p))
        p++;
    if (text_is(BEGINS, p, l->to, " points,| samples,") && number_behind(l->from, p, "", &x)) {
        state_number(t, &t->count, x, l);
        if (quantity_behind(p, l->to, ",", 0, &x) > 0 && x <= MOTION_STEP_MAX_S)
            state_number(t, &t->dt, x, l);
    }
    if (in && !t->all.unit)
        t->all.unit = unit_of(in + strlen("acceleration in "), comma ? comma : l->to);
}

/* Three or more signs and nothing else. */
static int is_rule(const Lines *l)
{
    const char *p = l->from;
    while (p < l->to && strchr("-=_~+* ", *p))
        p++;
    return p == l->to && l->to - l->from >= 3;
}

static int is_comment(const Lines *l)
{
    return (strchr("#%!", *l->from) && !csv_is_error(l->from, l->to)) || line_begins(l, "//");
}

/* A line of words begins like a word, or with the empty name of a column of numbers, and is no number (nan and inf
 * are); or two letters stand side by side in it. */
static int is_words(const Lines *l)
{
    double x;
    const char *p = l->from;
    if (!is_letter(*p) && (unsigned char)*p < 128 && !strchr("\"'[(,", *p)) {
        while (p + 1 < l->to && !(is_letter(p[0]) && is_letter(p[1])))
            p++;
        return p + 1 < l->to && !text_is(BEGINS, p, l->to, "nan|inf");
    }
    const Cell c = cell_next(&p, l->to, " ,;");
    return cell_number(c, c.is_quoted, &x) == NO_NUMBER && !number_behind(c.from, c.to, "", &x);
}

/* A rule between header and numbers. Stars right above a number may be one too large for its field. */
static int is_rule_above(const Lines *l)
{
    Lines ahead = lines_ahead(l);
    return is_rule(l) && (!line_has(l, "*") || (ahead.from && (is_words(&ahead) || is_rule(&ahead))));
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
    if (has_marks(l))
        return cell_next(p, l->to, memchr(l->from, ';', (size_t)(l->to - l->from)) ? ";" : ",\t");
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

/* Behind "components:" stand the names alone. */
static void set_names(Plain *t, const Lines *l)
{
    t->names = *l;
    if (line_begins(l, "components:"))
        for (t->names.from += strlen("components:"); t->names.from < l->to && *t->names.from == ' ';)
            t->names.from++;
    l = &t->names;
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
        if ((p == name.from || strchr("_ ", p[-1])) && !(p - name.from > 2 && is_digit(p[-2]) && is_digit(p[-3])))
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
    int is_title = !has_marks(l) && !line_has(l, "[|(|_");
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

/* How many numbers the line has; 0: something else stands in it. */
static int count_numbers(Lines l)
{
    int n = 0;
    double x;
    for (const char *p = l.from; p < l.to; n++)
        if (cell_number(cell_next(&p, l.to, " ,;"), 0, &x) != NUMBER)
            return 0;
    return n;
}

/* Refuses a text that is no table either, with its first lines, by which people see what they have, and what they might
 * ask for. */
static Status fail_unknown(const Plain *t, Err *err)
{
    char form[64] = "";
    Lines first = lines_ahead(&t->start), second = first, l = t->start, one = l;
    int width = 0;
    lines_next_filled(&second);

    /* What motion.text might read it by, its first two lines of equally many numbers being samples. */
    while (lines_next_filled(&l) && !((width = count_numbers(l)) && one.from && count_numbers(one) == width))
        one = l;
    if (l.from && one.from && width > 0)
        snprintf(form, sizeof form,
                 width == 1   ? "skip=%d"
                 : width == 2 ? "skip=%d,columns=time:1,value:2"
                              : "skip=%d,per_line=%d (or columns=time:1,value:2)",
                 one.number - 1, width);
    return fail_at(err, t->l,
                   "in no format that is known here (docs/motions.md lists them), and no plain columns of "
                   "numbers (a list of motions has a name that ends in list.txt); the first line is '%.*s'%s%.*s%s%s%s",
                   line_shown(&first), first.from, second.from ? ", then '" : "", second.from ? line_shown(&second) : 0,
                   second.from, second.from ? "'" : "", form[0] ? "; perhaps --text " : "", form);
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
        if (p == l->to || (before == 0 && is_rule_above(l)))
            continue;
        if (l->number <= t->r->how->text.skip) {
            read_pairs(t, l);
            continue;
        }
        const int is_above = before == 0 && is_words(l);
        if (is_above)
            read_phrases(t, l);
        if (is_comment(l) || (is_above && line_has(l, "="))) {
            read_pairs(t, l);
            if (before > 0)
                continue;

            /* A comment heads the columns if it parts names as a table does, the first one of times or periods. */
            Lines h = *l;
            while (h.from < h.to && strchr("#%!/ ", *h.from))
                h.from++;
            p = h.from;
            const Cell first = next_name(&h, &p);
            if (!line_has(&h, "=|:") && (has_marks(&h) || line_has(&h, "[|(|_")) &&
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
            if (before && ((is_words(l) && !has_marks(l)) || is_rule(l)) && !lines_ahead(l).from) /* "end" */
                return STATUS_OK;
            return err->sub != SUB_NO_NUMBER || is_table(t) ? s : fail_unknown(t, err);
        }
    }
    return STATUS_OK;
}

/* Rows, with the comma as decimal mark where the names name one column; then without what stands above the samples. */
static Status read_table(Plain *t, Err *err)
{
    enum { SAMPLES_MIN = 10 }; /* of fewer a sample might be their number */
    Record *r = t->r;
    Lines first = t->start;
    TRY(read_rows(t, err));
    measure_rows(t);
    if (t->n_rows < 2 && !is_named(t) && lines_next_filled(&first) && !is_comment(&first) && !(t->count > 1))
        return fail_unknown(t, err);
    if (t->n_names == 1 && t->width == 2 && !t->l->point_line) {
        *t = (Plain){.r = r, .l = t->l, .start = t->start, .is_one = 1};
        *t->l = t->start;
        r->n = 0;
        TRY(read_rows(t, err));
        measure_rows(t);
    }

    /* Two numbers before the samples are "npts dt" where they stand alone in their row, or one each in two, and the
     * first counts the samples, or the rows, that follow; one number is "npts" in the same way. */
    if (r->n >= 4 && t->width <= 2 && (t->width == 2 || r->n >= SAMPLES_MIN)) {
        const double count = r->row[0].a, dt = r->row[1].a, n = (double)r->n, rows = (double)t->n_rows;
        const int is_alone = t->width == 1, in_two = is_alone && r->row[2].line != r->row[1].line;
        const int has_dt = dt > 0 && dt < MOTION_STEP_MAX_S &&
                           ((count == n - 2 && (in_two || !is_alone)) || (count == rows - 1 && !is_alone));
        const Lines l = {.path = t->l->path, .number = r->row[0].line};
        if (has_dt)
            state_number(t, &t->dt, dt, &l);
        if (has_dt || (is_alone && (count == n - 1 || count == rows - 1))) {
            state_number(t, &t->count, count, &l);
            r->n -= 1 + has_dt;
            memmove(r->row, r->row + 1 + has_dt, r->n * sizeof *r->row);
            measure_rows(t);
        }
    }
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
        "%s:%d: has %zu column%s where the lines above have %zu; one motion written row by row is read by --text "
        "per_line=%zu, and its step ('# dt = 0.01 s', or --set motion.dt_s=0.01)",
        t->l->path, t->odd_line, t->odd_width, s, t->width, t->width);
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
                       .is_bare = timed && !is_named(t),
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
                   "has %zu rows of %zu columns without names: choose one by motion.channel (1 to %zu); "
                   "if they are one motion written row by row, --text per_line=%zu%s",
                   t->n_rows, t->width, t->width, t->width,
                   t->width == 2 && !t->l->point_line
                       ? "; if they are one column with decimal commas, put its name above it"
                       : "");
}

/* ---- as asked ---------------------------------------------------------------------------------------------------- */

/* One channel of all numbers, or of every second one behind its time, or of one column beside its times. */
static Status take_form(Plain *t, Err *err)
{
    Record *r = t->r;
    const TextForm *form = &r->how->text;
    size_t time = form->time, value = form->value ? form->value : 1 + (time == 1);
    Channel *c;
    const int is_short = t->odd_row + 1 == t->n_rows && t->odd_width < t->width; /* the last line */
    if (form->per_line && (t->width != form->per_line || (t->odd_line && !is_short)))
        return bad_data(err, "%s:%d: has %zu numbers where motion.text says per_line=%zu", t->l->path,
                        t->width != form->per_line ? r->row[0].line : t->odd_line,
                        t->width != form->per_line ? t->width : t->odd_width, form->per_line);
    if (form->per_line || form->pairs) {
        time = form->pairs;
        value = t->width = 1 + time;
        t->n_rows = r->n / t->width;
    } else {
        TRY(check_rows(t, err));
    }
    if (MAX_OF(time, value) > t->width || t->n_rows < 2 || r->n % t->width || (!time && !(t->dt > 0)))
        return bad_data(err, "%s: has %zu lines of %zu numbers%s; it has not what motion.text asks for", t->l->path,
                        t->n_rows, t->width, time || t->dt > 0 ? "" : " and no step (set motion.dt_s)");
    TRY(record_channel(r, t->l, &c, err));
    *c = t->all;
    c->scale = 1;
    c->is_timed = time > 0;
    c->dt = time ? 0 : t->dt;
    c->first = value - 1;
    c->stride = t->width;
    c->n = t->n_rows;
    c->format = "csv";
    if (time)
        record_set_times(r, 0, t->width, time - 1);
    return STATUS_OK;
}

/* ---- what is no motion as it stands ------------------------------------------------------------------------------ */

/* Refuses what would be read as another motion than it is. */
static Status check_motion(const Plain *t, Err *err)
{
    enum { SAMPLES_MIN = 10 };
    const Row *row = t->r->row;
    const size_t n = t->r->n;
    const Lines first = {.path = t->l->path, .number = row[0].line};
    size_t i = 2, k = 2;

    /* t a t a ...: the numbers at odd places rise all through the file. */
    while (i < n && row[i].a > row[i - 2].a)
        i += 2;
    if (t->width >= 4 && t->width % 2 == 0 && n >= 8 && i >= n)
        return fail_at(err, &first,
                       "its rows hold pairs of time and value (times %g, %g, %g ...); read them by --text pairs=yes "
                       "(motion.text)",
                       row[0].a, row[2].a, row[4].a);

    /* Does a bare column begin with a factor, its step or both? The first number is larger than all others, or the
     * second is the step that was given, or both are printed with fewer digits than the samples. */
    if (t->r->how->text.is_given || t->width != 1 || n < SAMPLES_MIN || row[0].a == 0)
        return STATUS_OK;
    for (i = 1; i < n && fabs(row[i].a) < fabs(row[0].a);)
        i++;
    while (k < SAMPLES_MIN && MAX_OF(row[0].decimals, row[1].decimals) + 2 <= row[k].decimals)
        k++;
    if (i == n || row[1].a == t->r->how->dt_s || (k == SAMPLES_MIN && row[1].a > 0))
        return fail_at(err, &first,
                       "begins with %g and %g, which look like a factor, a number or a step and no samples: say how "
                       "many lines are none, --text skip=%d,factor=%g (motion.text; skip=0: both are samples)",
                       row[0].a, row[1].a, row[1].line, row[0].a);
    return STATUS_OK;
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

/* Which columns are times and channels, by their names, their numbers and what the header says. */
static Status columns_as_found(Plain *t, double stated_dt, Err *err)
{
    enum { COMPONENTS_MAX = 4 };
    Record *r = t->r;
    const int named = is_named(t);
    size_t times = 0, rises = 0;
    const Row *row = r->row;
    const Lines first = {.path = t->l->path, .number = row[0].line};

    /* Times stand in the column that is named so, or in the first, where none is. */
    while (named && times < t->width && !names_times(name_at(t, times)))
        times++;
    t->is_timed = named && times < t->width;
    times = t->is_timed ? times : 0;
    if (named && !t->is_timed && names_frequency(name_at(t, 0)))
        return fail_at(err, &t->names, "'%.*s' heads a spectrum; a motion is a function of time", line_shown(&t->names),
                       t->names.from);
    if (t->width == 1 && !(t->dt > 0))
        return fail_at(err, &first,
                       "has one column and does not say its step; set motion.dt_s, or give times beside it");
    int timed = t->width > 1 && !(named && t->dt > 0 && !t->is_timed);

    /* Without names: one motion row by row, whose number of samples is stated, or whose last row is shorter, while none
     * is as narrow as the components of a station and the first column does not rise like times; or times, perhaps with
     * a mistake; or columns of which one is wanted. */
    if (t->width > 1 && !named) {
        for (size_t i = t->width; i < r->n; i += t->width)
            rises += row[i].a > row[i - t->width].a;
        const int mostly_rises = 4 * rises >= 3 * (t->n_rows - 1);
        const int is_wrapped = t->width > COMPONENTS_MAX && t->odd_line && t->odd_row + 1 == t->n_rows &&
                               t->odd_width < t->width && !r->how->channel && !mostly_rises;
        if (t->dt > 0 && (t->count == r->n || is_wrapped)) {
            t->width = 1;
            t->n_rows = r->n;
            return name_channels(t, 1, 0, 0, err);
        }
        const int always_rises = !t->odd_line && rises + 1 >= t->n_rows;
        timed = always_rises ? timed : !(t->dt > 0) && mostly_rises;
        if (t->odd_line || (!always_rises && !timed && (!(t->dt > 0) || !r->how->channel)))
            return fail_unnamed(t, &first, err);
    }
    TRY(check_rows(t, err));
    if (t->count > 1 && t->count != t->n_rows && t->count != r->n)
        return bad_data(err, "%s: announces %g samples, but has %zu rows", t->l->path, t->count, t->n_rows);
    t->is_counted = counts_samples(t);
    if (!t->is_timed && t->is_counted && !(t->dt > 0))
        return fail_at(err, &first,
                       "the first column counts %g, %g, ...: are these samples? Give their step (--set "
                       "motion.dt_s=0.01); if they are seconds, name the column time_s",
                       row[0].a, row[t->width].a);
    timed = timed && (t->is_timed || !t->is_counted);
    if (!timed)
        return name_channels(t, t->width, 0, stated_dt, err);
    if (named)
        TRY(check_times(t, name_at(t, times), err));
    record_set_times(r, 0, t->width, times);
    return name_channels(t, times, 1, stated_dt, err);
}

Status columns_read(Record *r, Lines *l, Err *err)
{
    Plain plain = {.r = r, .l = l, .start = *l}, *t = &plain;
    const TextForm *form = &r->how->text;
    const int is_laid_out = form->pairs || form->per_line || form->value || form->time;
    TRY(read_table(t, err));
    const double stated_dt = t->dt;
    t->dt = stated_dt > 0 ? stated_dt : r->how->dt_s;
    if (!is_laid_out)
        TRY(check_motion(t, err));
    TRY(is_laid_out ? take_form(t, err) : columns_as_found(t, stated_dt, err));
    for (size_t k = 0; k < r->n_channels && form->factor > 0; k++)
        r->channel[k].scale *= form->factor;
    return STATUS_OK;
}
