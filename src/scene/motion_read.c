#include "scene/motion_read.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/table.h"

static const double G = 9.81; /* [m/s2] per g, as everywhere in this program */

/* The strongest ground acceleration ever recorded is near 4 g; far beyond that a unit is wrong (El Centro in cm/s2
 * taken for m/s2 shows 35 g). */
static const double LARGEST_PEAK_G = 20.0;

/* ---- lines ---------------------------------------------------------------------------------------------------- */

typedef struct {
    const char *path, *next, *end; /* of the text that is left */
    int number;                    /* of the line below, from 1 */
    const char *from, *to;         /* the line without blanks at its ends */
} Lines;

static int lines_next(Lines *l)
{
    if (l->next >= l->end)
        return 0;
    const char *stop = memchr(l->next, '\n', (size_t)(l->end - l->next));
    l->from = l->next;
    l->to = stop ? stop : l->end;
    l->next = stop ? stop + 1 : l->end;
    l->number++;
    while (l->to > l->from && isspace((unsigned char)l->to[-1]))
        l->to--;
    while (l->from < l->to && isspace((unsigned char)*l->from))
        l->from++;
    return 1;
}

/* Enough of the line for a message. */
static int shown(const Lines *l)
{
    return (int)(l->to - l->from < 40 ? l->to - l->from : 40);
}

/* Line of the first byte that no text file holds, 0 if there is none. */
static int binary_line(const char *text, size_t length)
{
    int line = 1;
    for (size_t i = 0; i < length; i++) {
        const unsigned char c = (unsigned char)text[i];
        if (c < ' ' && !isspace(c))
            return line;
        line += c == '\n';
    }
    return 0;
}

static const char *find_word(const char *from, const char *to, const char *word)
{
    const size_t length = strlen(word);
    for (; from + length <= to; from++)
        if (strncasecmp(from, word, length) == 0)
            return from;
    return NULL;
}

/* ---- units ---------------------------------------------------------------------------------------------------- */

static const struct {
    const char *word;
    MotionUnit unit;
} UNIT_WORDS[] = {
    {"m/s2", UNIT_M_S2},          {"m/s^2", UNIT_M_S2},    {"m/s**2", UNIT_M_S2},
    {"m/s/s", UNIT_M_S2},         {"m_s2", UNIT_M_S2},     {"m/s\xc2\xb2", UNIT_M_S2},
    {"m/sec2", UNIT_M_S2},        {"m/sec^2", UNIT_M_S2},  {"m/sec/sec", UNIT_M_S2},
    {"m s-2", UNIT_M_S2},         {"cm/s2", UNIT_CM_S2},   {"cm/s^2", UNIT_CM_S2},
    {"cm/s**2", UNIT_CM_S2},      {"cm/s/s", UNIT_CM_S2},  {"cm_s2", UNIT_CM_S2},
    {"cm/s\xc2\xb2", UNIT_CM_S2}, {"cm/sec2", UNIT_CM_S2}, {"cm/sec^2", UNIT_CM_S2},
    {"cm/sec/sec", UNIT_CM_S2},   {"cm s-2", UNIT_CM_S2},  {"gal", UNIT_CM_S2},
    {"gals", UNIT_CM_S2},         {"g", UNIT_G},
};

static const char *const UNIT_NAMES[] = {
    [UNIT_FROM_FILE] = "from_file", [UNIT_M_S2] = "m_s2", [UNIT_CM_S2] = "cm_s2", [UNIT_G] = "g"};

/* Does the word at `at` of the line from..to stand for a unit? Not inside a longer word, not the g of "e.g." or
 * "g = 9.81", and not behind a number: "peak 0.3 g" is a quantity that someone mentions. */
static int is_unit(const char *from, const char *to, const char *at, size_t length)
{
    const char *before = at, *behind = at + length;
    if (at > from && (isalnum((unsigned char)at[-1]) || strchr(".%\\", at[-1])))
        return 0;
    if (behind < to && (isalnum((unsigned char)*behind) || strchr("^*/", *behind)))
        return 0;
    while (behind < to && isspace((unsigned char)*behind))
        behind++;
    if (behind < to && *behind == '=')
        return 0;
    while (before > from && isspace((unsigned char)before[-1]))
        before--;
    return before == from || !isdigit((unsigned char)before[-1]);
}

/* Set of the units that a line names, one bit (1 << MotionUnit) each. */
static unsigned units_named(const char *from, const char *to)
{
    unsigned set = 0;
    for (size_t i = 0; i < sizeof UNIT_WORDS / sizeof *UNIT_WORDS; i++) {
        const char *word = UNIT_WORDS[i].word;
        for (const char *at = from; (at = find_word(at, to, word)); at++)
            if (is_unit(from, to, at, strlen(word)))
                set |= 1u << UNIT_WORDS[i].unit;
    }
    return set;
}

/* The one unit that file and setting agree on. */
static Status settle_unit(const char *path, unsigned named, MotionUnit *unit, Err *err)
{
    MotionUnit first = UNIT_FROM_FILE, second = UNIT_FROM_FILE;
    for (MotionUnit u = UNIT_M_S2; u <= UNIT_G; u++)
        if (named & 1u << u) {
            second = first ? u : second;
            first = first ? first : u;
        }
    if (*unit == UNIT_FROM_FILE && first == UNIT_FROM_FILE)
        return fail(err, STATUS_BAD_DATA,
                    "%s: does not say the unit of its acceleration; set motion.unit to m_s2, cm_s2 or g", path);
    if (*unit == UNIT_FROM_FILE && second != UNIT_FROM_FILE)
        return fail(err, STATUS_BAD_DATA,
                    "%s: names two units of acceleration, %s and %s; set motion.unit to the right one", path,
                    UNIT_NAMES[first], UNIT_NAMES[second]);
    if (*unit != UNIT_FROM_FILE && named && !(named & 1u << *unit))
        return fail(err, STATUS_BAD_DATA, "%s: motion.unit is %s, but the file says %s; leave motion.unit at from_file",
                    path, UNIT_NAMES[*unit], UNIT_NAMES[first]);
    *unit = *unit == UNIT_FROM_FILE ? first : *unit;
    return STATUS_OK;
}

/* ---- samples -------------------------------------------------------------------------------------------------- */

typedef struct {
    double t, a;  /* [s], [unit of the file] */
    int line;     /* where it stands */
    int decimals; /* of the time as printed */
} Row;

typedef struct {
    Row *row;
    size_t n, capacity;
} Rows;

static Status rows_add(Rows *r, const char *path, Row row, Err *err)
{
    if (r->n == r->capacity) {
        const size_t capacity = r->capacity ? 2 * r->capacity : 4096;
        Row *wider = realloc(r->row, capacity * sizeof *wider);
        if (!wider)
            return fail(err, STATUS_NO_MEMORY, "%s: no memory for %zu samples", path, capacity);
        r->row = wider;
        r->capacity = capacity;
    }
    r->row[r->n++] = row;
    return STATUS_OK;
}

/* One finite number that begins at *p; *p moves behind it and the blanks that follow. */
static Status read_number(const Lines *l, const char **p, double *x, Err *err)
{
    char *stop;
    *x = strtod(*p, &stop);
    if (stop == *p || stop > l->to || (stop < l->to && !isspace((unsigned char)*stop) && !strchr(",;", *stop)))
        return fail(err, STATUS_BAD_DATA, "%s:%d: '%.*s' is not a number", l->path, l->number,
                    (int)(l->to - *p < 40 ? l->to - *p : 40), *p);
    if (!isfinite(*x))
        return fail(err, STATUS_BAD_DATA, "%s:%d: found %g; only finite numbers are accepted", l->path, l->number, *x);
    for (*p = stop; *p < l->to && isspace((unsigned char)**p); (*p)++)
        ;
    return STATUS_OK;
}

/* The samples in m/s2 become the motion's. */
static Status take_samples(Motion *m, const char *path, const Rows *r, double dt, MotionUnit unit, Err *err)
{
    const double to_m_s2 = unit == UNIT_M_S2 ? 1.0 : unit == UNIT_CM_S2 ? 0.01 : G;
    size_t peak = 0;
    for (size_t i = 0; i < r->n; i++)
        peak = fabs(r->row[i].a) > fabs(r->row[peak].a) ? i : peak;
    if (fabs(r->row[peak].a) * to_m_s2 > LARGEST_PEAK_G * G)
        return fail(err, STATUS_BAD_DATA, "%s:%d: an acceleration of %g %s is beyond %g g; is the unit right?", path,
                    r->row[peak].line, r->row[peak].a, UNIT_NAMES[unit], LARGEST_PEAK_G);
    m->accel = malloc(r->n * sizeof *m->accel);
    if (!m->accel)
        return fail(err, STATUS_NO_MEMORY, "%s: no memory for %zu samples", path, r->n);
    for (size_t i = 0; i < r->n; i++)
        m->accel[i] = to_m_s2 * r->row[i].a;
    m->n = r->n;
    m->dt_s = dt;
    return STATUS_OK;
}

/* ---- csv ------------------------------------------------------------------------------------------------------ */

/* Digits behind the decimal point of a number as printed, less its exponent. */
static int count_decimals(const char *from, const char *to)
{
    int n = 0, behind_point = 0;
    for (; from < to; from++) {
        if (*from == '.')
            behind_point = 1;
        else if (isdigit((unsigned char)*from))
            n += behind_point;
        else if (*from == 'e' || *from == 'E')
            return n - (int)strtol(from + 1, NULL, 10);
        else if (*from != '+' && *from != '-')
            break;
    }
    return n;
}

/* A line that names columns begins like a word and is no number (nan and inf are numbers). */
static int is_header(const Lines *l)
{
    char *stop;
    if (!isalpha((unsigned char)*l->from) && !strchr("\"'[(", *l->from))
        return 0;
    strtod(l->from, &stop);
    return stop == l->from || (*stop != ',' && *stop != ';' && !isspace((unsigned char)*stop));
}

static Status read_row(const Lines *l, Row *row, Err *err)
{
    const char *p = l->from;
    row->line = l->number;
    row->decimals = count_decimals(l->from, l->to);
    TRY(read_number(l, &p, &row->t, err));
    if (p < l->to && strchr(",;", *p))
        for (p++; p < l->to && isspace((unsigned char)*p); p++)
            ;
    if (p == l->to)
        return fail(err, STATUS_BAD_DATA, "%s:%d: '%.*s' has no second column; time and acceleration are expected",
                    l->path, l->number, shown(l), l->from);
    TRY(read_number(l, &p, &row->a, err));
    if (p < l->to)
        return fail(err, STATUS_BAD_DATA, "%s:%d: '%.*s' has more than two columns; time and acceleration are expected",
                    l->path, l->number, shown(l), l->from);
    return STATUS_OK;
}

/* The shortest decimal number within `slack` of x: times printed with few digits say 0.02, not 0.0200003. */
static double shortest_near(double x, double slack)
{
    for (int digits = 1; digits < 17; digits++) {
        char text[40];
        snprintf(text, sizeof text, "%.*g", digits, x);
        const double y = strtod(text, NULL);
        if (fabs(y - x) <= slack)
            return y;
    }
    return x;
}

/* Names the step that is least like the others: there the sample is missing, while the drift that it causes is noticed
 * elsewhere. The step of the others is what it breaks. */
static Status fail_at_oddest_step(const char *path, const Rows *r, double dt, double digit, Err *err)
{
    const Row *row = r->row, *odd = &row[1];
    for (size_t i = 2; i < r->n; i++)
        if (fabs(row[i].t - row[i - 1].t - dt) > fabs(odd[0].t - odd[-1].t - dt))
            odd = &row[i];
    const double step = odd[0].t - odd[-1].t, others = (double)(r->n - 2);
    const double usual = shortest_near((row[r->n - 1].t - row[0].t - step) / others, digit / others);
    return fail(err, STATUS_BAD_DATA,
                "%s:%d: time %.10g s breaks the uniform step of %.6g s: it comes %.6g s after the line before; a sample "
                "is missing, or the file must be resampled",
                path, odd->line, odd->t, usual, step);
}

/* The common step. A printed time is off by half a unit of its last digit at most, and so are the first and the last
 * one, which give the step: one unit in all, or 1e-5 of the time where six significant digits were printed, or 1e-3 of
 * a step in any case. A missing or doubled sample is off by half a step or more wherever it stands; hence the cap. */
static Status uniform_step(const char *path, const Rows *r, double *dt, Err *err)
{
    const Row *row = r->row;
    const double span = row[r->n - 1].t - row[0].t, intervals = (double)(r->n - 1);
    int decimals = row[0].decimals;
    for (size_t i = 1; i < r->n; i++) {
        decimals = row[i].decimals > decimals ? row[i].decimals : decimals;
        if (!(row[i].t > row[i - 1].t))
            return fail(err, STATUS_BAD_DATA, "%s:%d: time %.10g s does not come after %.10g s", path, row[i].line,
                        row[i].t, row[i - 1].t);
    }
    const double digit = pow(10.0, -decimals);
    *dt = shortest_near(span / intervals, digit / intervals);
    if (!(*dt > 0) || !isfinite(span))
        return fail(err, STATUS_BAD_DATA, "%s: %zu samples from %g s to %g s have no usable step", path, r->n, row[0].t,
                    row[r->n - 1].t);
    for (size_t i = 0; i < r->n; i++) {
        const double want = row[0].t + (double)i * *dt;
        const double printed = fmax(digit, 1e-5 * fabs(row[i].t));
        if (fabs(row[i].t - want) > fmin(fmax(printed, 1e-3 * *dt), 0.3 * *dt))
            return fail_at_oddest_step(path, r, *dt, digit, err);
    }
    return STATUS_OK;
}

static Status read_csv_rows(Lines *l, Rows *r, unsigned *named, Err *err)
{
    unsigned in_comments = 0, in_header = 0;
    int seen_header = 0;
    while (lines_next(l)) {
        if (l->from == l->to)
            continue;
        if (*l->from == '#') {
            in_comments |= units_named(l->from, l->to);
        } else if (!seen_header && r->n == 0 && is_header(l)) {
            seen_header = 1;
            in_header = units_named(l->from, l->to);
        } else {
            Row row;
            TRY(read_row(l, &row, err));
            TRY(rows_add(r, l->path, row, err));
        }
    }
    *named = in_header ? in_header : in_comments;
    return STATUS_OK;
}

static Status parse_csv(Motion *m, Lines *l, Rows *r, MotionUnit unit, Err *err)
{
    unsigned named;
    double dt = 0;
    TRY(read_csv_rows(l, r, &named, err));
    if (r->n < 2)
        return fail(err, STATUS_BAD_DATA, "%s: holds %zu sample%s; at least two are needed", l->path, r->n,
                    r->n == 1 ? "" : "s");
    TRY(uniform_step(l->path, r, &dt, err));
    TRY(settle_unit(l->path, named, &unit, err));
    snprintf(m->format, sizeof m->format, "csv");
    return take_samples(m, l->path, r, dt, unit, err);
}

/* ---- at2 ------------------------------------------------------------------------------------------------------ */

/* "NPTS=  3930, DT=   .0050 SEC" or "3930   0.0050   NPTS, DT" */
static int is_npts_line(const Lines *l)
{
    return *l->from != '#' && find_word(l->from, l->to, "NPTS") && find_word(l->from, l->to, "DT");
}

static Status read_npts_line(const Lines *l, size_t *n, double *dt, Err *err)
{
    const char *npts = find_word(l->from, l->to, "NPTS"), *step = find_word(l->from, l->to, "DT");
    const char *equals = memchr(npts, '=', (size_t)(l->to - npts));
    double count = NAN, seconds = NAN;
    char *stop;
    if (equals) {
        count = strtod(equals + 1, NULL);
        equals = memchr(step, '=', (size_t)(l->to - step));
        if (equals)
            seconds = strtod(equals + 1, NULL);
    } else {
        count = strtod(l->from, &stop);
        seconds = strtod(stop, NULL);
    }
    if (!(count >= 2 && count <= 1e8 && count == floor(count)))
        return fail(err, STATUS_BAD_DATA, "%s:%d: no usable number of points (2 or more) in '%.*s'", l->path, l->number,
                    shown(l), l->from);
    if (!(seconds > 0 && isfinite(seconds)))
        return fail(err, STATUS_BAD_DATA, "%s:%d: no usable time step in '%.*s'", l->path, l->number, shown(l),
                    l->from);
    *n = (size_t)count;
    *dt = seconds;
    return STATUS_OK;
}

static Status read_at2_header(Lines *l, unsigned *named, size_t *n, double *dt, Err *err)
{
    *named = 0;
    while (lines_next(l)) {
        if (is_npts_line(l))
            return read_npts_line(l, n, dt, err);
        if (find_word(l->from, l->to, "VELOCITY TIME") || find_word(l->from, l->to, "DISPLACEMENT TIME"))
            return fail(err, STATUS_BAD_DATA, "%s:%d: not an acceleration: '%.*s'", l->path, l->number, shown(l),
                        l->from);
        if (find_word(l->from, l->to, "UNIT"))
            *named |= units_named(l->from, l->to);
    }
    return fail(err, STATUS_INTERNAL, "%s: no line with NPTS and DT", l->path);
}

static Status parse_at2(Motion *m, Lines *l, Rows *r, MotionUnit unit, Err *err)
{
    unsigned named;
    size_t n = 0;
    double dt = 0;
    TRY(read_at2_header(l, &named, &n, &dt, err));
    while (lines_next(l))
        for (const char *p = l->from; p < l->to;) {
            Row row = {.line = l->number};
            TRY(read_number(l, &p, &row.a, err));
            if (r->n == n)
                return fail(err, STATUS_BAD_DATA, "%s:%d: more samples than the %zu that its header announces", l->path,
                            l->number, n);
            TRY(rows_add(r, l->path, row, err));
        }
    if (r->n != n)
        return fail(err, STATUS_BAD_DATA, "%s:%d: ends after %zu samples, but its header announces %zu", l->path,
                    l->number, r->n, n);
    TRY(settle_unit(l->path, named, &unit, err));
    snprintf(m->format, sizeof m->format, "at2");
    return take_samples(m, l->path, r, dt, unit, err);
}

/* ---- either --------------------------------------------------------------------------------------------------- */

/* PEER files have the count and the step in line 4; a line or two more of header does no harm. */
static int looks_like_at2(Lines l)
{
    while (l.number < 8 && lines_next(&l))
        if (is_npts_line(&l))
            return 1;
    return 0;
}

uint64_t motion_hash(const void *data, size_t n)
{
    const unsigned char *bytes = data;
    uint64_t hash = 0xcbf29ce484222325u;
    for (size_t i = 0; i < n; i++)
        hash = (hash ^ bytes[i]) * 0x100000001b3u;
    return hash;
}

Status motion_parse(Motion *m, const char *path, const char *text, size_t length, MotionUnit unit, Err *err)
{
    memset(m, 0, sizeof *m);
    const int binary = binary_line(text, length);
    if (length == 0)
        return fail(err, STATUS_BAD_DATA, "%s: is empty", path);
    if (binary)
        return fail(err, STATUS_BAD_DATA, "%s:%d: holds bytes that no text has; a binary file is not read", path,
                    binary);
    const size_t mark = length >= 3 && memcmp(text, "\xef\xbb\xbf", 3) == 0 ? 3 : 0; /* UTF-8 byte order mark */
    Lines l = {.path = path, .next = text + mark, .end = text + length};
    Rows rows = {0};
    const Status s = looks_like_at2(l) ? parse_at2(m, &l, &rows, unit, err) : parse_csv(m, &l, &rows, unit, err);
    free(rows.row);
    if (s != STATUS_OK)
        return s;
    snprintf(m->name, sizeof m->name, "%s", path);
    m->file_hash = motion_hash(text, length);
    return STATUS_OK;
}

Status motion_read(Motion *m, const char *path, MotionUnit unit, Err *err)
{
    char *text;
    size_t length;
    memset(m, 0, sizeof *m);
    TRY(file_read(path, &text, &length, err));
    const Status s = motion_parse(m, path, text, length, unit, err);
    free(text);
    return s;
}
