#include "motion/formats/text.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* ---- lines ---------------------------------------------------------------------------------------------------- */

int lines_skip(Lines *l, int n)
{
    for (int i = 0; i < n; i++)
        if (!lines_next(l))
            return 0;
    return 1;
}

int lines_next_filled(Lines *l)
{
    while (lines_next(l))
        if (l->from < l->to)
            return 1;
    return 0;
}

Lines lines_ahead(const Lines *l)
{
    Lines ahead = *l;
    if (!lines_next_filled(&ahead))
        ahead.from = ahead.to = NULL;
    return ahead;
}

int line_shown(const Lines *l)
{
    return (int)(l->to - l->from < 40 ? l->to - l->from : 40);
}

int line_begins(const Lines *l, const char *word)
{
    const size_t n = strlen(word);
    return (size_t)(l->to - l->from) >= n && strncasecmp(l->from, word, n) == 0;
}

const char *find_word(const char *from, const char *to, const char *word)
{
    const size_t length = strlen(word);
    for (; from + length <= to; from++)
        if (strncasecmp(from, word, length) == 0)
            return from;
    return NULL;
}

int line_has(const Lines *l, const char *word)
{
    return find_word(l->from, l->to, word) != NULL;
}

/* ---- numbers -------------------------------------------------------------------------------------------------- */

enum { NUMBER_MAX = 64 };

/* A C string of the field as strtod wants it: Fortran's exponent letter D is E, a decimal comma is a point. Hexadecimal
 * numbers, which strtod would take, are none of a record. */
static int tidy(const char *from, const char *to, int with_comma, char text[NUMBER_MAX])
{
    const size_t n = (size_t)(to - from);
    if (n == 0 || n >= NUMBER_MAX || memchr(from, 'x', n) || memchr(from, 'X', n))
        return 0;
    for (size_t i = 0; i < n; i++) {
        const int is_exponent = (from[i] == 'D' || from[i] == 'd') && i && strchr("0123456789.", from[i - 1]);
        text[i] = is_exponent ? 'E' : with_comma && from[i] == ',' ? '.' : from[i];
    }
    text[n] = 0;
    return 1;
}

void field_strip(const char **from, const char **to)
{
    while (*from < *to && isspace((unsigned char)**from))
        ++*from;
    while (*to > *from && isspace((unsigned char)(*to)[-1]))
        --*to;
    if (*to - *from >= 2 && **from == '"' && (*to)[-1] == '"') {
        ++*from;
        --*to;
    }
}

Status field_number(const Lines *l, const char *from, const char *to, int with_comma, double *x, Err *err)
{
    char text[NUMBER_MAX], *stop = NULL;
    field_strip(&from, &to);
    const int is_text = tidy(from, to, with_comma, text);
    if (is_text)
        *x = strtod(text, &stop);
    if (with_comma && memchr(from, '.', (size_t)(to - from)) && memchr(from, ',', (size_t)(to - from)))
        return fail(err, STATUS_BAD_DATA,
                    "%s:%d: '%.*s' has a point and a comma; write numbers without marks of thousands", l->path,
                    l->number, (int)(to - from < 40 ? to - from : 40), from);
    if (!is_text || stop == text || *stop)
        return fail(err, STATUS_BAD_DATA, "%s:%d: '%.*s' is not a number", l->path, l->number,
                    (int)(to - from < 40 ? to - from : 40), from);
    if (!isfinite(*x))
        return fail(err, STATUS_BAD_DATA, "%s:%d: found %g; only finite numbers are accepted", l->path, l->number, *x);
    return STATUS_OK;
}

const char *field_next(const Lines *l, const char **p, int with_comma)
{
    const char *parting = with_comma ? ";" : ",;";
    const char *end = *p, *quote = end < l->to && *end == '"' ? memchr(end + 1, '"', (size_t)(l->to - end - 1)) : NULL;
    end = quote ? quote : end;
    while (end < l->to && !isspace((unsigned char)*end) && !strchr(parting, *end))
        end++;
    const char *next = end;
    int seen_mark = 0;
    while (next < l->to && (isspace((unsigned char)*next) || (!seen_mark && strchr(parting, *next))))
        seen_mark |= !isspace((unsigned char)*next++);
    *p = next;
    return end;
}

int number_behind(const char *from, const char *to, const char *word, double *x)
{
    char text[NUMBER_MAX], *stop;
    const char *p = find_word(from, to, word);
    if (!p)
        return 0;
    for (p += strlen(word); p < to && strchr(" \t=:(", *p) && *p; p++)
        ;
    const size_t n = (size_t)(to - p) < sizeof text - 1 ? (size_t)(to - p) : sizeof text - 1;
    memcpy(text, p, n);
    text[n] = 0;
    for (size_t i = 1; i + 1 < n; i++) /* Fortran's exponent */
        if (strchr("dD", text[i]) && strchr("0123456789.", text[i - 1]) && strchr("+-0123456789", text[i + 1]))
            text[i] = 'E';
    *x = strtod(text, &stop);
    if (*stop == ',' && stop > text && isdigit((unsigned char)stop[-1]) && isdigit((unsigned char)stop[1]) &&
        !memchr(text, '.', strcspn(text, " \t"))) { /* a decimal comma */
        *stop = '.';
        *x = strtod(text, &stop);
    }
    return stop != text && isfinite(*x) && !memchr(text, 'x', (size_t)(stop - text)) &&
           !memchr(text, 'X', (size_t)(stop - text));
}

static const char *skip(const char *p, const char *to, const char *set)
{
    while (p < to && *p && strchr(set, *p))
        p++;
    return p;
}

int quantity_behind(const char *from, const char *to, const char *word, int is_rate, double *x)
{
    static const struct {
        const char *word;
        double seconds, hertz; /* 0: none of this quantity */
    } WORDS[] = {{"s", 1, 0},     {"sec", 1, 0},     {"secs", 1, 0},  {"second", 1, 0},  {"seconds", 1, 0},
                 {"ms", 1e-3, 0}, {"msec", 1e-3, 0}, {"us", 1e-6, 0}, {"usec", 1e-6, 0}, {"milliseconds", 1e-3, 0},
                 {"min", 0, 0},   {"minutes", 0, 0}, {"ns", 0, 0},    {"hours", 0, 0},   {"hz", 0, 1},
                 {"sps", 0, 1},   {"khz", 0, 1e3}};
    double below;
    if (!number_behind(from, to, word, x))
        return 0;
    const char *p = skip(find_word(from, to, word) + strlen(word), to, " \t=:(");
    p = skip(skip(p, to, "0123456789.,+-eEdD"), to, " \t");
    if (p < to && *p == '/' && number_behind(p + 1, to, "", &below) && below > 0) { /* "1/200 s" */
        *x /= below;
        p = skip(skip(p + 1, to, " \t0123456789.,+-eEdD"), to, " \t");
    }
    const char *end = p;
    while (end < to && isalpha((unsigned char)*end))
        end++;
    if (end < to && strchr("-^/", *end)) /* s-1, m/s2 */
        return 1;
    for (size_t i = 0; i < sizeof WORDS / sizeof WORDS[0]; i++)
        if ((size_t)(end - p) == strlen(WORDS[i].word) && strncasecmp(p, WORDS[i].word, (size_t)(end - p)) == 0) {
            const double unit = is_rate ? WORDS[i].hertz : WORDS[i].seconds;
            *x *= unit;
            return unit > 0 ? 1 : -1;
        }
    return 1;
}

static Status parted_numbers(const Lines *l, int width, size_t max, double x[], size_t *n, Err *err)
{
    *n = 0;
    for (const char *p = l->from; p < l->to && *n < max;) {
        const char *from = p, *to = field_next(l, &p, 0);
        if (width && to - from > width && !memchr(from, '.', (size_t)(to - from)))
            return fail(err, STATUS_BAD_DATA, "%s:%d: '%.*s' is wider than %d characters", l->path, l->number,
                        (int)(to - from < 40 ? to - from : 40), from, width);
        TRY(field_number(l, from, to, 0, &x[*n], err));
        ++*n;
    }
    return STATUS_OK;
}

static Status column_numbers(const Lines *l, int width, size_t max, double x[], size_t *n, Err *err)
{
    *n = 0;
    for (const char *p = l->raw; p < l->to && *n < max; p += width) {
        TRY(field_number(l, p, l->to - p < width ? l->to : p + width, 0, &x[*n], err));
        ++*n;
    }
    return STATUS_OK;
}

Status line_numbers(const Lines *l, int width, size_t max, double x[], size_t *n, Err *err)
{
    Err e = {0};
    const Status parted = parted_numbers(l, width, max, x, n, err);
    if (parted == STATUS_OK || width <= 0)
        return parted;
    return column_numbers(l, width, max, x, n, &e) == STATUS_OK ? STATUS_OK : parted;
}

int format_width(const Lines *l)
{
    for (const char *p = l->from; p < l->to; p++) {
        int repeat = 0, width = 0;
        if (*p != '(')
            continue;
        const char *q = p + 1;
        while (q < l->to && isdigit((unsigned char)*q) && repeat < 1000)
            repeat = 10 * repeat + *q++ - '0';
        if (repeat == 0 || q >= l->to || !strchr("fFeEgGiI", *q))
            continue;
        for (q++; q < l->to && isdigit((unsigned char)*q) && width < 1000;)
            width = 10 * width + *q++ - '0';
        if (width > 1 && width < NUMBER_MAX)
            return width;
    }
    return 0;
}

/* ---- units ---------------------------------------------------------------------------------------------------- */

static const struct {
    const char *word;
    MotionUnit unit;
} UNIT_WORDS[] = {
    {"m/s2", UNIT_M_S2},        {"m/s^2", UNIT_M_S2},       {"m/s**2", UNIT_M_S2},      {"m/s/s", UNIT_M_S2},
    {"m_s2", UNIT_M_S2},        {"m/s\xc2\xb2", UNIT_M_S2}, {"m/s\xb2", UNIT_M_S2},     {"m/sec2", UNIT_M_S2},
    {"m/sec^2", UNIT_M_S2},     {"m/sec**2", UNIT_M_S2},    {"m/sec/sec", UNIT_M_S2},   {"m s-2", UNIT_M_S2},
    {"m/seg/seg", UNIT_M_S2},   {"cm/s2", UNIT_CM_S2},      {"cm/s^2", UNIT_CM_S2},     {"cm/s**2", UNIT_CM_S2},
    {"cm/s/s", UNIT_CM_S2},     {"cm_s2", UNIT_CM_S2},      {"cm/sec2", UNIT_CM_S2},    {"cm/s\xc2\xb2", UNIT_CM_S2},
    {"cm/s\xb2", UNIT_CM_S2},   {"gals", UNIT_CM_S2},       {"cm/sec^2", UNIT_CM_S2},   {"cm/sec**2", UNIT_CM_S2},
    {"cm/sec/sec", UNIT_CM_S2}, {"gal", UNIT_CM_S2},        {"cm s-2", UNIT_CM_S2},     {"g", UNIT_G},
    {"m/s*s", UNIT_M_S2},       {"cm/s*s", UNIT_CM_S2},     {"cm/seg/seg", UNIT_CM_S2},
};

const char *const UNIT_NAMES[] = {MOTION_UNIT_LIST(CHOICE_WORD)};

typedef enum { NO_UNIT, PLAIN_UNIT, SCALED_UNIT } UnitUse;

static const char *before_blanks(const char *from, const char *at)
{
    while (at > from && isspace((unsigned char)at[-1]))
        at--;
    return at;
}

/* Does from..at end in the word, which begins there? */
static int ends_in(const char *from, const char *at, const char *word)
{
    const size_t n = strlen(word);
    return (size_t)(at - from) >= n && strncasecmp(at - n, word, n) == 0 &&
           (at - n == from || !isalnum((unsigned char)at[-(ptrdiff_t)n - 1]));
}

/* Multiples: "% g", "% of g", "m g", "milli-g", "1/g", "[0.01 g]", "x1000_m_s2" */
static int is_scaled_before(const char *from, const char *at)
{
    const char *p = before_blanks(from, at), *q;
    if (ends_in(from, p, "of"))
        p = before_blanks(from, p - 2);
    if (p > from && (p[-1] == '%' || ends_in(from, p, "percent") || ends_in(from, p, "milli") ||
                     ends_in(from, p, "milli-") || (p < at && ends_in(from, p, "m"))))
        return 1;
    for (q = p; q > from && strchr("0123456789.eE+-_*/ ", q[-1]); q--)
        ;
    if (q == p || q == from || !isdigit((unsigned char)*skip(q, p, " .+-")))
        return 0;
    const int tens = memcmp(q, "10", 2) == 0; /* x1 is a channel, x1000 a factor */
    return strchr("[(", q[-1]) || (p < at && ends_in(from, q, "in")) || (tens && ends_in(from, q, "x"));
}

/* "m/s2 x 1000", "g / 10", "g*100" */
static int is_scaled_behind(const char *behind, const char *to)
{
    const char *p = skip(behind, to, " \t");
    if (p >= to || !strchr("xX*/", *p))
        return 0;
    p = skip(p + 1, to, " \t");
    return p < to && isdigit((unsigned char)*p);
}

/* Does the word at `at` of the line from..to stand for a unit? Not inside a longer word, not the g of "e.g." or
 * "g = 9.81", and not behind a number: "peak 0.3 g" is a quantity that someone mentions. */
static UnitUse use_of(const char *from, const char *to, const char *at, size_t length)
{
    const char *behind = at + length, *before = before_blanks(from, at);
    if (at > from && (isalnum((unsigned char)at[-1]) || strchr(".\\", at[-1])))
        return NO_UNIT;
    if (behind < to && isalnum((unsigned char)*behind))
        return NO_UNIT;
    if (is_scaled_before(from, at) || is_scaled_behind(behind, to))
        return SCALED_UNIT;
    if (behind < to && strchr("^*/", *behind))
        return NO_UNIT;
    behind = skip(behind, to, " \t");
    if (behind < to && *behind == '=')
        return NO_UNIT;
    return before == from || !isdigit((unsigned char)before[-1]) ? PLAIN_UNIT : NO_UNIT;
}

/* A letter g and the word gal of a sentence are a unit where they stand alone, in brackets, or behind a word like "in". */
static int is_stated(const char *from, const char *to, const char *at, const char *behind)
{
    static const char *const SAYING[] = {"in",    "unit", "units",    "acceleration", "accelerations",
                                         "accel", "acc",  "amplitude"};
    const char *p = before_blanks(from, at);
    behind = skip(behind, to, " \t");
    if ((p == from || strchr(",;[(", p[-1])) && (behind == to || strchr(",;])", *behind)))
        return 1;
    if (p > from && p[-1] == '/')
        return 1;
    while (p > from && strchr(" \t:=[]()_", p[-1]))
        p--;
    for (size_t i = 0; i < sizeof SAYING / sizeof SAYING[0]; i++)
        if (ends_in(from, p, SAYING[i]))
            return 1;
    return ends_in(from, p, "of") && (find_word(from, p, "unit") || find_word(from, p, "fraction"));
}

static const char *find_unit(const char *from, const char *to, const char *word, UnitUse use, int strictly)
{
    const size_t n = strlen(word);
    for (const char *at = from; (at = find_word(at, to, word)); at++)
        if (use_of(from, to, at, n) == use && (!strictly || is_stated(from, to, at, at + n)))
            return at;
    return NULL;
}

static unsigned find_units(const char *from, const char *to, int is_sentence)
{
    unsigned set = 0;
    for (size_t i = 0; i < sizeof UNIT_WORDS / sizeof *UNIT_WORDS; i++)
        if (find_unit(from, to, UNIT_WORDS[i].word, PLAIN_UNIT, is_sentence && *UNIT_WORDS[i].word == 'g'))
            set |= 1u << UNIT_WORDS[i].unit;
    return set;
}

unsigned units_named(const char *from, const char *to)
{
    return find_units(from, to, 0);
}

unsigned units_stated(const char *from, const char *to)
{
    return find_units(from, to, 1);
}

/* What stands around `at`, between brackets, commas or semicolons. */
static void show_unit(const char *from, const char *to, const char *at, char shown[UNIT_SHOWN])
{
    const char *a = at, *b = at;
    size_t n = 0;
    while (a > from && at - a < UNIT_SHOWN / 2 && !strchr("[(,;:#", a[-1]))
        a--;
    while (b < to && b - a < UNIT_SHOWN - 1 && !strchr("]),;", *b))
        b++;
    for (field_strip(&a, &b); a < b; a++)
        shown[n++] = isprint((unsigned char)*a) ? *a : '?';
    shown[n] = 0;
}

int unit_unknown(const char *from, const char *to, char shown[UNIT_SHOWN])
{
    static const char *const WORDS[] = {"mg",     "milli-g", "mgal",    "mm/s2", "mm/s^2", "mm_s2", "in/s2",
                                        "in/s^2", "in_s2",   "in/sec2", "ft/s2", "ft/s^2", "ft_s2", "ft/sec2"};
    const char *at = NULL;
    for (size_t i = 0; !at && i < sizeof UNIT_WORDS / sizeof *UNIT_WORDS; i++)
        at = find_unit(from, to, UNIT_WORDS[i].word, SCALED_UNIT, 0);
    if (at) {
        show_unit(from, to, at, shown);
        return 1;
    }
    for (size_t i = 0; i < sizeof WORDS / sizeof *WORDS; i++)
        if (find_unit(from, to, WORDS[i], PLAIN_UNIT, 0)) {
            memcpy(shown, WORDS[i], strlen(WORDS[i]) + 1);
            return 1;
        }
    return 0;
}
