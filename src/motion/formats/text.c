#include "motion/formats/text.h"

#include <ctype.h>
#include <strings.h>
#include <time.h>

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
    for (const char *p = l->next; p < l->end && is_blank(*p); p++)
        if (*p == l->mark) {
            l->number++;
            l->next = p + 1;
        }
    return lines_next(l) && l->from < l->to;
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
    return (int)MIN_OF(l->to - l->from, 40);
}

const char *find_word(const char *from, const char *to, const char *word)
{
    const size_t length = strlen(word);
    for (; from + length <= to; from++)
        if (strncasecmp(from, word, length) == 0)
            return from;
    return NULL;
}

int text_is(Match how, const char *from, const char *to, const char *words)
{
    char word[64];
    for (size_t n; *words; words += n + (words[n] == '|')) {
        n = strcspn(words, "|");
        memcpy(word, words, n);
        word[n] = 0;
        const char *at = how == HOLDS ? find_word(from, to, word) : find_word(from, MIN_OF(from + n, to), word);
        if (at && (how != EQUALS || from + n == to))
            return 1;
    }
    return 0;
}

int line_begins(const Lines *l, const char *words)
{
    return text_is(BEGINS, l->from, l->to, words);
}

int line_has(const Lines *l, const char *words)
{
    return text_is(HOLDS, l->from, l->to, words);
}

/* ---- numbers -------------------------------------------------------------------------------------------------- */

enum { NUMBER_MAX = 64 };

/* "2001-01-01T00:00:00.010000" in seconds. */
static int is_time(Cell c, double *x)
{
    char text[NUMBER_MAX] = "";
    struct tm day = {0};
    double second;
    const size_t n = c.to - c.from;
    if (n < 19 || n >= sizeof text || c.from[10] != 'T')
        return 0;
    memcpy(text, c.from, n);
    if (sscanf(text, "%4d-%2d-%2dT%2d:%2d:%lf", &day.tm_year, &day.tm_mon, &day.tm_mday, &day.tm_hour, &day.tm_min,
               &second) != 6 ||
        !(second >= 0 && second < 61))
        return 0;
    day.tm_year -= 1900;
    day.tm_mon--;
    *x = (double)timegm(&day) + second;
    return 1;
}

Status line_number(const Lines *l, Cell c, int with_comma, double *x, Err *err)
{
    const size_t n = c.to - c.from;
    const int shown = n < 40 ? (int)n : 40;
    const CellKind kind = is_time(c, x) ? NUMBER : cell_number(c, with_comma, x);
    if (with_comma && memchr(c.from, '.', n) && memchr(c.from, ',', n))
        return fail_at(err, l, "'%.*s' has a point and a comma; write numbers without marks of thousands", shown,
                       c.from);
    if (kind == NO_NUMBER)
        return fail_sub(err, STATUS_BAD_DATA, SUB_NO_NUMBER, "%s:%d: '%.*s' is not a number", l->path, l->number, shown,
                        c.from);
    return kind == NUMBER ? STATUS_OK : fail_at(err, l, "found %g; only finite numbers are accepted", *x);
}

static const char *skip(const char *p, const char *to, const char *set)
{
    while (p < to && *p && strchr(set, *p))
        p++;
    return p;
}

/* Behind the number at p, "-1.5E+3", "1,5", "2.D-2"; p: there is none. */
static const char *number_end(const char *p, const char *to)
{
    static const char DIGITS[] = "0123456789";
    const char *begin = p, *first = p < to && strchr("+-", *p) ? p + 1 : p;
    p = skip(first, to, DIGITS);
    if (p < to && (*p == '.' || (*p == ',' && p > first && skip(p + 1, to, DIGITS) > p + 1)))
        p = skip(p + 1, to, DIGITS);
    if (p == first || (p == first + 1 && *first == '.'))
        return begin;
    const char *power = p < to && strchr("eEdD", *p) ? p + 1 : to;
    power = power < to && strchr("+-", *power) ? power + 1 : power;
    return power < to && is_digit(*power) ? skip(power, to, DIGITS) : p;
}

/* Where the number behind `word` begins; NULL: there is no such word. */
static const char *behind(const char *from, const char *to, const char *word)
{
    const char *p = find_word(from, to, word);
    return p ? skip(p + strlen(word), to, " \t=:(") : NULL;
}

int number_behind(const char *from, const char *to, const char *word, double *x)
{
    const char *p = behind(from, to, word);
    const Cell c = {.from = p, .to = p ? number_end(p, to) : p};
    return c.to > c.from && cell_number(c, memchr(c.from, ',', c.to - c.from) != NULL, x) == NUMBER;
}

int quantity_behind(const char *from, const char *to, const char *word, int is_rate, double *x)
{
    static const struct {
        const char *words;
        double seconds, hertz; /* 0: none of this quantity */
    } UNITS[] = {{"s|sec|secs|second|seconds", 1, 0},
                 {"ms|msec|milliseconds", 1e-3, 0},
                 {"us|usec", 1e-6, 0},
                 {"min|minutes|ns|hours", 0, 0},
                 {"hz|sps", 0, 1},
                 {"khz", 0, 1e3}};
    double below;
    if (!number_behind(from, to, word, x))
        return 0;
    const char *p = skip(number_end(behind(from, to, word), to), to, " \t");
    if (p < to && *p == '/' && number_behind(p + 1, to, "", &below) && below > 0) { /* "1/200 s" */
        *x /= below;
        p = skip(number_end(behind(p + 1, to, ""), to), to, " \t");
    }
    const char *end = p;
    while (end < to && is_letter(*end))
        end++;
    for (size_t i = 0; i < N_OF(UNITS) && !(end < to && strchr("-^/", *end)); i++) /* s-1, m/s2 */
        if (text_is(EQUALS, p, end, UNITS[i].words)) {
            const double unit = is_rate ? UNITS[i].hertz : UNITS[i].seconds;
            *x *= unit;
            return unit > 0 ? 1 : -1;
        }
    return 1;
}

Status line_numbers(const Lines *l, int width, size_t max, double x[], size_t *n, Err *err)
{
    Status parted = STATUS_OK;
    *n = 0;
    for (const char *p = l->from; p < l->to && *n < max && parted == STATUS_OK; ++*n) {
        const Cell c = cell_next(&p, l->to, " ,;");
        const long length = c.to - c.from;
        parted = width && length > width && !memchr(c.from, '.', length)
                     ? fail_at(err, l, "'%.*s' is wider than %d characters", (int)MIN_OF(length, 40), c.from, width)
                     : line_number(l, c, 0, &x[*n], err);
    }
    if (parted == STATUS_OK || width <= 0)
        return parted;

    /* Else they run together, in columns of that width. */
    *n = 0;
    for (const char *p = l->raw; p < l->to && *n < max; p += width, ++*n) {
        const char *from = p, *to = l->to - p < width ? l->to : p + width;
        const Cell c = cell_next(&from, to, "\n"); /* all of it */
        if (line_number(l, c, 0, &x[*n], &(Err){0}) != STATUS_OK)
            return parted;
    }
    return STATUS_OK;
}

int format_width(const Lines *l)
{
    for (const char *p = l->from; (p = memchr(p, '(', l->to - p)); p++) {
        char format[NUMBER_MAX];
        int repeat, width;
        snprintf(format, sizeof format, "%.*s", (int)(l->to - p), p);
        if (sscanf(format, "(%3d%*1[fFeEgGiI]%3d", &repeat, &width) == 2 && is_digit(format[1]) && repeat > 0 &&
            width > 1 && width < NUMBER_MAX)
            return width;
    }
    return 0;
}

/* ---- units ---------------------------------------------------------------------------------------------------- */

MotionUnit unit_of(const char *from, const char *to)
{
    static const char *const UNITS[] = {
        [UNIT_M_S2] = "m/s2|m/s/s|m/ss|ms-2", [UNIT_CM_S2] = "cm/s2|cm/s/s|cm/ss|cms-2|gal|gals", [UNIT_G] = "g"};
    char tidy[16];
    size_t n = 0;

    /* In small letters, _ as /, sec and seg as s, without blanks, ^, * and the square sign's two bytes: cm/sec**2 is
     * cm/s2. */
    for (const char *p = from; p < to && n < 15; p++) {
        const char c = *p == '_' ? '/' : (char)tolower((unsigned char)*p);
        const int is_second = n && tidy[n - 1] == 's' && to - p >= 2 && c == 'e' && strchr("cCgG", p[1]);
        if (is_second)
            p++;
        else if (!is_blank(c) && !strchr("^*\xc2", c))
            tidy[n++] = c == '\xb2' ? '2' : c;
    }
    for (MotionUnit unit = UNIT_M_S2; unit <= UNIT_G; unit++)
        if (text_is(EQUALS, tidy, tidy + n, UNITS[unit]))
            return unit;
    return UNIT_FROM_FILE;
}

int is_quantity(const char *from, const char *to)
{
    static const char UNITS[] =
        "m|cm|mm|km|in|inch|inches|ft|feet|n|kn|mn|kip|kips|lb|lbf|pa|kpa|mpa|psi|ksi|nm|knm|v|mv|volt|volts|"
        "rad|mrad|deg|hz|s|sec|second|seconds|ms|kg|t|j|kj|g|mg|gal|gals|milli|micro|of|x";
    int n_words = 0, n_letters = 0;
    from = skip(from, to, " \t\n\r\v\f");
    for (const char *p = from; p < to;) {
        const char *word = p;
        while (p < to && is_letter(*p))
            p++;
        if (p > word && !text_is(EQUALS, word, p, UNITS))
            return 0;
        n_words += p > word;
        n_letters += p - word == 1 && strchr("NSEWUDVZ", *word);
        p += p == word;
    }
    const int is_direction = n_words > 1 && n_letters == n_words; /* N-S */
    return (n_words && !is_direction) || memchr(from, '%', to - from) || text_is(EQUALS, from, to, "-");
}
