/* The text formats of agencies: one reader, and a row of FORMATS for each, by the words of its header. What a row
 * cannot say has a function above it. The layouts are those of the agencies' descriptions and of their files
 * (docs/motions.md).
 *
 * A header ends where a line `ends` was seen and a line of numbers follows; or behind `text_lines` lines. Its words
 * give
 *
 *   COUNT, or RATE times DURATION     number of samples         STEP, or 1 / RATE, or DURATION / COUNT    [s]
 *   UNIT, PEAK, NAME, PLACE, TYPE     of the motion; what is twice in a header counts where it stands first
 *
 * Samples stand row by row, in columns of `width` where they run together; or in one column per channel, whose NAMES
 * are in the header, else in its last line; "/a/b/c" is one value for each. A column of times is checked row by row. */
#include <strings.h>

#include "base/units.h"
#include "motion/formats/record.h"

typedef enum { NAME, PLACE, COUNT, STEP, RATE, DURATION, UNIT, PEAK, FACTOR, TYPE, NAMES, N_FIELDS } Field;

typedef struct {
    Lines at[N_FIELDS]; /* the line, from its value on; from == NULL: none */
    Lines first, last;  /* the last that is not blank */
    double count, dt;   /* NAN: not known yet */
    int width;
    size_t lines_behind; /* the samples, of velocities and displacements */
} Header;

/* "LINE|WORD": the value stands behind WORD of a line that begins with LINE. Either may be empty, WORD left out
 * with its bar. "=LTV": the line is one of these letters. */
typedef struct {
    Field field;
    const char *text;
} HeaderWord;

typedef struct Format {
    const char *name, *begins, *has; /* a line begins and has, of words parted by |, */
    int within;                      /* among the first so many; 0: it begins a channel, and another may follow */
    int (*is)(Lines l);              /* in the place of them */
    const char *ends;                /* of the header; NULL: the first line of numbers */
    int text_lines, number_lines;    /* of the header; -1: "with N text lines" */
    int integers;                    /* it ends before a line of integers */
    int width, pairs;                /* pairs: of time and acceleration; without `more` digitized from film */
    const char *separator;           /* of names; NULL: samples stand row by row */
    const char *peak_of;             /* what stands before the peak of the channel %s */
    int one_word;                    /* the name is the first word of its value */
    MotionUnit unit;                 /* by definition */
    const char *refused;             /* why it is not read */
    /* What else the header holds; l is at its last line. */
    Status (*more)(Lines *l, Header *h, Channel *c, Err *err);
    Status (*read)(Record *r, Lines *l, Err *err); /* in the place of all this */
    HeaderWord words[12];
} Format;

static const Format *format_at(Lines l);

/* ---- headers ----------------------------------------------------------------------------------------------------- */

/* The value behind the word of the line; 0: there is none. */
static int find_behind(Header *h, Field field, const Lines *l, const char *word)
{
    const char *p = find_word(l->from, l->to, word);
    h->at[field] = *l;
    h->at[field].from = p ? p + strlen(word) : NULL;
    return p != NULL;
}

/* 16I5: nothing but digits, signs and blanks. */
static int is_integers(const Lines *l)
{
    int digits = 0;
    for (const char *p = l->from; p && p < l->to; p++) {
        if (!is_digit(*p) && *p != ' ' && *p != '-')
            return 0;
        digits += is_digit(*p);
    }
    return digits >= 16;
}

/* Reads up to the header's last line and takes its words. */
static Status read_header(const Format *f, Lines *l, Header *h, Err *err)
{
    double n_lines = f->text_lines;
    int ended = !f->ends;
    Lines ahead = {0};
    *h = (Header){.count = NAN, .dt = NAN, .width = f->width, .first = *l};
    if (f->text_lines < 0 && !(number_behind(l->from, l->to, "with", &n_lines) && n_lines > 0 && n_lines <= 1000))
        return fail_at(err, l, "no usable number of text lines in '%.*s'", line_shown(l), l->from);
    for (int i = 1;; i++) {
        for (const HeaderWord *w = f->words; w->text; w++) {
            const size_t n = strcspn(w->text, "|");
            const int is_one = *w->text == '=' && l->to - l->from == 1 && strchr(w->text + 1, *l->from);
            Lines rest = *l;
            rest.from += is_one ? 0 : n;
            if (!h->at[w->field].from && (is_one || (rest.from <= l->to && !strncasecmp(l->from, w->text, n))))
                find_behind(h, w->field, &rest, w->text[n] ? w->text + n + 1 : "");
        }
        h->last = l->from < l->to ? *l : h->last;
        ended |= f->ends && line_has(l, f->ends);
        if (ahead.number <= l->number) /* not over the same blank lines again and again */
            ahead = lines_ahead(l);
        if (f->integers   ? is_integers(&ahead)
            : n_lines > 0 ? i == (int)n_lines
                          : ended && ahead.from && !line_is_marker(&ahead) && !line_begins(&ahead, "--"))
            return lines_skip(l, f->number_lines) ? STATUS_OK : fail_too_short(l, "header", err);
        if (!lines_next(l))
            return ended ? fail_too_short(l, f->integers ? "integer header" : "samples", err)
                         : fail_at(err, l, "the file ends before its line '%s'", f->ends);
    }
}

/* Item k of "/a/b/c", or the value for all of them. */
static Cell item_of(const Lines *at, int k)
{
    const char *p = at->from;
    if (!p)
        return (Cell){0};
    while (p < at->to && strchr(" :", *p))
        p++;
    if (p == at->to || *p != '/')
        return (Cell){.from = at->from, .to = at->to};
    Cell c = cell_next(&p, at->to, "/");
    for (int i = 0; i <= k; i++)
        c = cell_next(&p, at->to, "/");
    return c;
}

static double number_of(const Header *h, Field field, int k)
{
    double x;
    const Cell c = item_of(&h->at[field], k);
    return c.from && number_behind(c.from, c.to, "", &x) ? x : NAN;
}

/* Names the line of the header that should have said the number of points, or the step. */
static Status fail_word(const Format *f, const Lines *l, Field first, Field second, Err *err)
{
    const HeaderWord *w = f->words;
    while (w->text && w->field != first && w->field != second)
        w++;
    const int n = w->text ? (int)strcspn(w->text, "|") : 0;
    return fail_at(err, l, "no usable %s above this line%s%.*s%s%s",
                   first == COUNT ? "number of points" : "time step (above 0, at most 1 s)", w->text ? " (" : "", n,
                   w->text ? w->text : "", w->text && w->text[n] ? w->text + n + 1 : "", w->text ? ")" : "");
}

/* Number and step of channel k; where a length is stated too it must be theirs. */
static Status settle_steps(const Format *f, const Lines *l, Header *h, int k, Err *err)
{
    const double rate = number_of(h, RATE, k), duration = number_of(h, DURATION, k);
    double count = isnan(h->count) ? number_of(h, COUNT, k) : h->count,
           dt = isnan(h->dt) ? number_of(h, STEP, k) : h->dt;
    count = isnan(count) ? round(rate * duration) : count;
    dt = isnan(dt) ? (rate > 1e5 ? INFINITY : 1 / rate) : dt;
    dt = isnan(dt) ? duration / count : dt;
    if (!(dt > 0 && dt <= MOTION_STEP_MAX_S))
        return fail_word(f, l, STEP, RATE, err);
    if (!f->separator && !(count >= 2 && count <= 1e8))
        return fail_word(f, l, COUNT, DURATION, err);
    const double rounded = duration == floor(duration); /* "approx   70 secs" */
    if (duration > 0 && fabs(duration - count * dt) > 2 * dt + 0.02 * duration + rounded)
        return fail_at(err, &h->at[DURATION], "a length of %g s, but %g samples every %g s are %g s", duration, count,
                       dt, count * dt);
    h->count = count;
    h->dt = dt;
    return STATUS_OK;
}

/* The first unit among the words of the text. */
static MotionUnit unit_within(const char *from, const char *to)
{
    MotionUnit unit = UNIT_FROM_FILE;
    while (from < to && !unit) {
        const char *word = from;
        while (from < to && !strchr(" \t,;:()[]_=", *from))
            from++;
        unit = unit_of(word, from);
        from++;
    }
    return unit;
}

/* The number at `from`, in the unit of its line, or else in the channel's. */
static void read_peak(Channel *c, const char *line, const char *from, const char *to)
{
    double x, digit = 1;
    int behind_point = 0;
    if (!number_behind(from, to, "", &x) || x == 0)
        return;
    while (from < to && strchr(" \t=:(", *from))
        from++;
    for (const char *p = from; p < to && strchr("+-.0123456789", *p); p++) {
        digit /= behind_point ? 10 : 1;
        behind_point |= *p == '.';
    }
    MotionUnit unit = unit_within(from, to);
    unit = unit ? unit : unit_within(line, from);
    const double scale = unit ? UNIT_IN_M_S2[unit] : UNIT_IN_M_S2[c->unit] * c->scale;
    if (fabs(x) * scale <= c->peak)
        return;
    c->peak = fabs(x) * scale;
    c->peak_slack = 0.5 * digit * scale;
}

/* Takes unit and peak of channel k. Behind `peak_of` with the channel's name stand one number or two, "0.658~ -0.837",
 * of which the larger counts. */
static void settle_channel(const Format *f, const Header *h, Channel *c, int k)
{
    const Lines *unit = &h->at[UNIT], *peak = &h->at[PEAK];
    char word[CHANNEL_NAME_MAX + 32];
    if (unit->from)
        channel_unit(c, unit->from, unit->to);
    else if (!c->unit)
        c->unit = f->unit;
    if (!f->peak_of) {
        const Cell item = item_of(peak, k);
        if (item.from)
            read_peak(c, peak->raw, item.from, item.to);
        return;
    }
    snprintf(word, sizeof word, f->peak_of, c->name);
    const char *end = h->last.to, *at = find_word(h->first.from, end, word);
    if (!at)
        return;
    const char *stop = memchr(at, '\n', end - at);
    stop = stop ? stop : end;
    read_peak(c, at, at + strlen(word), stop);
    const char *wave = memchr(at, '~', stop - at);
    if (wave)
        read_peak(c, at, wave + 1, stop);
}

/* Refuses a header that says velocity or displacement. */
static Status check_type(const Lines *type, Err *err)
{
    Lines whole = *type;
    whole.from = whole.raw;
    if (!type->from || line_has(&whole, "accel") || !line_has(&whole, "veloc|displ"))
        return STATUS_OK;
    fail_at(err, type, "not an acceleration: '%.*s'", line_shown(&whole), whole.from);
    err->sub = SUB_NO_RECORD;
    return STATUS_BAD_DATA;
}

/* ---- samples ----------------------------------------------------------------------------------------------------- */

/* One column for each channel whose NAMES are in the header, perhaps behind one of times. */
static Status read_columns(const Format *f, Record *r, Lines *l, Header *h, Err *err)
{
    const Lines *names = h->at[NAMES].from ? &h->at[NAMES] : &h->last, *count = &h->at[COUNT];
    size_t width = 0, n, k = 0, timed = 0;
    const size_t base = r->n;
    for (Lines ahead = lines_ahead(l); ahead.from; ahead = lines_ahead(l)) {
        if (!strchr("+-.0123456789", *ahead.from) && format_at(ahead))
            break;
        *l = ahead;
        TRY(record_add_cells(r, l, 0, &n, err));
        width = width ? width : n;
        if (n != width)
            return fail_sub(err, STATUS_BAD_DATA, SUB_RAGGED, "%s:%d: has %zu columns where the lines above have %zu",
                            l->path, l->number, n, width);
    }
    for (const char *p = names->from; p <= names->to;) {
        const Cell name = cell_next(&p, names->to, f->separator);
        Channel *c;
        if (name.from == name.to)
            continue;
        timed |= k == 0 && find_word(name.from, name.to, "time") == name.from;
        if (k++ < timed || k > width)
            continue;
        const char *sign = memchr(name.from, '(', name.to - name.from);
        TRY(record_channel(r, l, &c, err));
        channel_name(c, name.from, sign ? sign : name.to);
        c->is_timed = (int)timed;
        c->first = base + k - 1;
        c->stride = width;
        c->n = (r->n - base) / width;
        h->count = h->dt = NAN;
        TRY(settle_steps(f, l, h, (int)(k - 1 - timed), err));
        *(timed ? &c->other_dt : &c->dt) = h->dt;
        settle_channel(f, h, c, (int)(k - 1 - timed));
        if (h->at[DURATION].from && h->count > 1 && fabs(h->count - (double)c->n) * h->dt > 1) /* in whole seconds */
            return fail_at(err, l, "%zu rows, but its header announces %g s every %g s", c->n, h->count * h->dt, h->dt);
        if (count->from && h->count < c->n && c->n <= h->count + 16 && h->count >= 2 &&
            memchr(count->from, '/', 4)) { /* as UNAM's files have them */
            c->n = (size_t)h->count;
            c->warning = "it has some rows more than its header announces; they are left out";
        } else if (count->from && h->count != c->n) {
            return fail_at(err, l, "%zu rows, but its header announces %g for channel %zu", c->n, h->count, k - timed);
        }
    }
    if (k != width)
        return fail_at(err, names, "names %zu columns, but %zu follow", k, width);
    if (timed)
        record_set_times(r, base, width, 0);
    return STATUS_OK;
}

static int says_corrected(const Lines *l)
{
    return l->from && text_is(HOLDS, l->raw, l->to, "corrected acc") && !text_is(HOLDS, l->raw, l->to, "uncorrected");
}

/* One record of a format: one channel row by row, or a column for each. */
static Status read_channel(const Format *f, Record *r, Lines *l, Err *err)
{
    Header h;
    Channel *c;
    lines_next_filled(l);
    TRY(read_header(f, l, &h, err));
    TRY(check_type(&h.at[TYPE], err));
    if (f->separator)
        return read_columns(f, r, l, &h, err);
    TRY(record_channel(r, l, &c, err));

    /* The name: "340 deg (Rcrdr Chan 1)", "1: 340 deg", "360 Deg   Location: Roof", with the location, which tells the
     * channels of a building apart. */
    const Lines *name = &h.at[NAME], *place = &h.at[PLACE];
    const char *from = name->from, *to, *where = name->from ? place->from : NULL;
    for (const char *p = from; p && p < name->to && strchr(" 0123456789:", *p); p++)
        from = *p == ':' ? p + 1 : from;
    for (to = from; to && to < name->to && *to != '(' && !(to > from && text_is(BEGINS, to, name->to, "Location"));)
        to++;
    channel_name(c, from, to);
    while (where && where < place->to && strchr(" :=", *where))
        where++;
    if (where) {
        char own[sizeof c->name];
        memcpy(own, c->name, sizeof own);
        channel_named(c, "%s, %.*s", own, (int)(place->to - where), where);
    }
    if (f->one_word)
        c->name[strcspn(c->name, " ")] = 0;
    c->digitized = f->pairs && !f->more;
    c->is_timed = f->pairs && f->more;
    if (f->more)
        TRY(f->more(l, &h, c, err));
    TRY(check_type(&h.at[TYPE], err));
    if (c->digitized)
        h.count = isnan(h.count) ? number_of(&h, COUNT, 0) : h.count;
    else
        TRY(settle_steps(f, l, &h, 0, err));
    settle_channel(f, &h, c, 0);
    c->is_corrected = says_corrected(&h.first) || says_corrected(&h.at[TYPE]);
    c->dt = h.dt;
    return record_block(r, l, h.count, h.width, h.lines_behind, err);
}

/* ---- what no row can say ----------------------------------------------------------------------------------------- */

/* CSMIP (report OSMS 85-03): 7 lines 16I5, 50 (V1) or 100 (V2) reals 8F10, then a line such as
 *
 *   13200 Accelerogram points at 200 pts/sec in units of g .      Format: (8f9.6)               V1, digital
 *   12000 points of accel data equally spaced at  .005 sec, in cm/sec2. (8f10.6)                V2
 *
 * V1 of a film recorder has no such line: pairs of time and acceleration, 10F7.3. A name is what stands behind "Chan 
 * 1:", with the location where the text has one, for that tells the channels of a building apart. */
static Status csmip_more(Lines *l, Header *h, Channel *c, Err *err)
{
    enum { REAL_LINES_V1 = 7, REAL_LINES_MAX = 20 };
    double x;
    const int is_v2 = line_begins(&h->first, "corrected");
    for (int i = 0; i < REAL_LINES_MAX; i++) {
        const Lines ahead = lines_ahead(l);
        if (!ahead.from)
            return fail_too_short(l, "samples", err);
        c->digitized = !is_v2 && i == REAL_LINES_V1 && !line_has_letters(&ahead);
        h->width = 7;
        if (c->digitized)
            return STATUS_OK;
        *l = ahead;
        if (line_has_letters(l))
            break;
    }
    if (!line_has_letters(l))
        return fail_at(err, l, "no line that announces the samples above this one");
    h->width = format_width(l) ? format_width(l) : 10;
    h->at[COUNT] = h->at[TYPE] = *l;
    if (number_behind(l->from, l->to, " at ", &x)) /* "at 200 pts/sec" or "spaced at .005 sec" */
        h->dt = line_has(l, "pts/s|points/s|samples/s") ? 1 / x : x;
    const Lines above = h->at[UNIT];
    if (!find_behind(h, UNIT, l, " in units of ") && !find_behind(h, UNIT, l, " in units ") &&
        !find_behind(h, UNIT, l, " in "))
        h->at[UNIT] = above;
    return STATUS_OK;
}

/* The line above a part of COSMOS' header: "100 Integer-header values follow on  10 lines, Format= (10I8)". */
static Status part_begins(Lines *l, const char *word, double *n_lines, Err *err)
{
    if (!lines_next(l))
        return fail_too_short(l, "header", err);
    const int counted = number_behind(l->from, l->to, "follow on", n_lines);
    if (!line_has(l, word) || !counted || !(*n_lines >= 0 && *n_lines <= 1000))
        return fail_at(err, l, "'%.*s' does not announce the %s", line_shown(l), l->from, word);
    return STATUS_OK;
}

/* COSMOS 1.20: an integer and a real header and comments, each under a line that says how many lines follow, then
 *
 *   7000  acceleration pts, approx   70 secs, units=cm/sec2(04),Format=(8F10.5)
 *
 * and the samples. Real 62 is the step in ms. Comments begin with '|', whatever their announced number is. */
static Status cosmos_more(Lines *l, Header *h, Channel *c, Err *err)
{
    enum { N_REALS = 100, STEP_AT = 61 };
    static const MotionUnit CODES[] = {[2] = UNIT_G, [4] = UNIT_CM_S2, [10] = UNIT_CM_S2};
    double n_lines = 0, reals[N_REALS], code;
    (void)c;
    TRY(part_begins(l, "Integer-header", &n_lines, err));
    if (!lines_skip(l, (int)n_lines))
        return fail_too_short(l, "header", err);
    TRY(part_begins(l, "Real-header", &n_lines, err));
    TRY(header_numbers(l, format_width(l), N_REALS, reals, err));
    do {
        if (!lines_next(l))
            return fail_too_short(l, "samples", err);
    } while (*l->from == '|' || line_has(l, "comment line"));
    h->dt = reals[STEP_AT] * 1e-3;
    h->width = format_width(l);
    h->at[COUNT] = *l;
    find_behind(h, DURATION, l, "approx");
    find_behind(h, UNIT, l, "units=");

    /* The code behind a unit, "cm/sec2(04)", is that of COSMOS' Table 2: 2 is g, 4 cm/s2, 10 gal; others up to 9 are no
     * accelerations. */
    const Lines *unit = &h->at[UNIT];
    const char *open = unit->from ? memchr(unit->from, '(', unit->to - unit->from) : NULL;
    if (!open || !number_behind(open, unit->to, "(", &code) || !(code >= 1 && code <= 10))
        return STATUS_OK;
    const MotionUnit said = unit_of(unit->from, open);
    return !said || said == CODES[(int)code]
               ? STATUS_OK
               : fail_at(err, unit, "the unit in words, '%.*s', is not the one of its code %g",
                         (int)(open - unit->from), unit->from, code);
}

/* USGS SMC (Open-File Report 2005-1438, appendix): 11 lines of text, of which the first says what is held; 6 lines
 * 8I10, 10 lines 5E15.7; comments that begin with '|'; numbers in cm/s2, 8E10.4 or in wider columns (5E14.7).
 *
 *   integer 16   comment lines                 real 1         stands for "undefined" (1.7E38)
 *   integer 17   numbers that follow           real 2         samples per second; undefined: pairs of time and
 *   real 30, 32  largest and smallest value                   acceleration, digitized from film */
enum { SMC_TEXT_LINES = 11 };

static int smc_is(Lines l)
{
    return lines_next(&l) && (line_begins(&l, "*") || line_has(&l, "ACCELEROGRAM|VELOCITY|DISPLACEMENT|UNKNOWN")) &&
           lines_skip(&l, 1) && line_begins(&l, "*") && lines_skip(&l, SMC_TEXT_LINES - 2) && line_begins(&l, "*");
}

/* Takes what the integers and reals of the header say, and passes over the comments. */
static Status smc_more(Lines *l, Header *h, Channel *c, Err *err)
{
    enum {
        N_INTEGERS = 48,
        N_REALS = 50,
        COMMENTS = 15,
        NUMBERS = 16,
        UNDEFINED = 0,
        RATE_AT = 1,
        LARGEST = 29,
        SMALLEST = 31
    };
    double integers[N_INTEGERS], reals[N_REALS];
    h->at[TYPE] = h->first;
    if (line_has(&h->first, "UNKNOWN"))
        c->warning = "its first line, UNKNOWN, does not say what it holds; taken as an acceleration";
    TRY(header_numbers(l, 10, N_INTEGERS, integers, err));
    TRY(header_numbers(l, 15, N_REALS, reals, err));
    for (double i = 0; i < integers[COMMENTS]; i++) {
        if (!lines_next(l))
            return fail_too_short(l, "samples", err);
        if (*l->from != '|')
            return fail_at(err, l, "comment %g of %g does not begin with '|': '%.*s'", i + 1, integers[COMMENTS],
                           line_shown(l), l->from);
    }
    h->count = integers[NUMBERS];
    h->dt = reals[RATE_AT] <= 1e5 ? 1 / reals[RATE_AT] : INFINITY;

    /* The first number of a block stands at the right end of its column. */
    const Lines ahead = lines_ahead(l);
    if (!ahead.from)
        return fail_too_short(l, "samples", err);
    const char *p = ahead.from;
    while (p < ahead.to && !strchr("EeDd ", *p))
        p++;
    for (p += p < ahead.to; p < ahead.to && (is_digit(*p) || (strchr("+-", *p) && !is_digit(p[-1])));)
        p++;
    h->width = p >= ahead.raw + 10 && p <= ahead.raw + 20 ? (int)(p - ahead.raw) : 10;
    if (reals[RATE_AT] == reals[UNDEFINED] && reals[UNDEFINED] > 1e30) {
        c->digitized = 1;
        h->count = floor(h->count / 2); /* a line more may follow, of another record */
    }
    const double a = reals[LARGEST], b = reals[SMALLEST];
    if (a != reals[UNDEFINED] && b != reals[UNDEFINED] && fabs(a) < 1e6 && fabs(b) < 1e6)
        c->peak = 0.01 * fmax(fabs(a), fabs(b));
    c->peak_slack = 1e-4 * c->peak;
    return STATUS_OK;
}

/* K-NET, KiK-net (NIED): a count times the factor 3920(gal)/6182761 is in gal; its zero is the recorder's, so the
 * mean is subtracted, as NIED does for its Max. Acc. KiK-net numbers its directions: 1 to 3 are NS, EW, UD in the
 * borehole, 4 to 6 the same at the surface. */
static Status knet_more(Lines *l, Header *h, Channel *c, Err *err)
{
    static const char DIRECTIONS[][4] = {"NS1", "EW1", "UD1", "NS2", "EW2", "UD2"};
    const Lines *factor = &h->at[FACTOR];
    double gal = NAN, counts = NAN;
    const char *slash = factor->from ? memchr(factor->from, '/', factor->to - factor->from) : NULL;
    if (!slash || !find_word(factor->from, slash, "gal") || !number_behind(factor->from, slash, "", &gal) ||
        !number_behind(slash, factor->to, "/", &counts) || !(gal / counts > 0) || isinf(gal / counts))
        return fail_at(err, factor->from ? factor : l, "no usable Scale Factor, as 3920(gal)/6182761");
    c->scale = gal / counts;
    c->subtract_mean = 1;
    if (c->name[0] >= '1' && c->name[0] <= '6' && !c->name[1])
        memcpy(c->name, DIRECTIONS[c->name[0] - '1'], sizeof DIRECTIONS[0]);
    else if (!text_is(EQUALS, c->name, c->name + strlen(c->name), "N-S|E-W|U-D"))
        return fail_at(err, h->at[NAME].from ? &h->at[NAME] : l,
                       "the direction '%s' is none of N-S, E-W, U-D (K-NET), 1 to 6 (KiK-net)", c->name);
    return STATUS_OK;
}

/* GeoNet: 10 lines of 10 numbers behind the text, counted from 0 the samples of V1 at 30, those of V2 (accelerations,
 * velocities, displacements) at 33, 34, 35, the step [s] at 65; samples 10F8.1 in mm/s2. */
static Status geonet_more(Lines *l, Header *h, Channel *c, Err *err)
{
    double x[100], in_words = 0;
    TRY(header_numbers(l, 8, 100, x, err));
    const int is_v2 = line_begins(&h->first, "corrected");
    h->count = x[is_v2 ? 33 : 30];
    h->dt = x[65];
    for (int k = 34; k <= 35 && is_v2; k++)
        h->lines_behind += x[k] > 0 && x[k] <= 1e8 ? (size_t)ceil(x[k] / 10) : 0;
    if (!h->at[UNIT].from && h->at[PEAK].from && find_word(h->at[PEAK].from, h->at[PEAK].to, "mm/s/s")) {
        c->unit = UNIT_CM_S2;
        c->scale = 0.1;
    }
    const int said = number_behind(h->first.from, h->last.to, "intervals of", &in_words) ||
                     number_behind(h->first.from, h->last.to, "data at", &in_words);
    if (said && fabs(in_words - h->dt) > 0.0006) /* three decimals */
        return fail_at(err, l, "a step of %g s in the numbers of the header, %g s in its words", h->dt, in_words);
    return STATUS_OK;
}

/* PEER: "NPTS=  3930, DT=   .0050 SEC" or "3930    0.0050    NPTS, DT"; not in the comments of plain text. Below a
 * title the step may be missing: that is a fault of this format, not another format. */
static int at2_is(Lines l)
{
    int has_title = 0;
    while (l.number < 8 && lines_next(&l)) {
        if (l.from < l.to && !strchr("#%!/", *l.from) && line_has(&l, "NPTS") && (has_title || line_has(&l, "DT")))
            return 1;
        has_title |= line_has(&l, "TIME SERIES|TIME HISTORY");
    }
    return 0;
}

/* Takes number and step of "3930    0.0050    NPTS, DT", or the step of "NPTS=  3930, DT=   .0050 SEC". */
static Status at2_more(Lines *l, Header *h, Channel *c, Err *err)
{
    const Lines *npts = &h->at[COUNT];
    double x[2];
    size_t n;
    (void)l, (void)c, (void)err;
    if (!npts->from)
        return STATUS_OK;
    Lines whole = *npts;
    whole.from = whole.raw;
    if (!memchr(whole.from, '=', whole.to - whole.from) && line_numbers(&whole, 0, 2, x, &n, &(Err){0}) == STATUS_OK &&
        n == 2) {
        h->count = x[0];
        h->dt = x[1];
    } else if (quantity_behind(whole.from, whole.to, "DT", 0, &h->dt) <= 0) {
        h->dt = INFINITY; /* stated in no unit that is known, or not at all */
    }
    return STATUS_OK;
}

/* ---- TIMESERIES of IRIS (ascii2mseed, ObsPy) ------------------------------------------------------------------------
 *
 *   TIMESERIES NET_STA_LOC_CHA_Q, 6001 samples, 200 sps, 2009-08-24T00:20:03.000000, SLIST, INTEGER, Counts
 *
 * then samples row by row (SLIST), or "time  sample" (TSPAIR). A segment is a channel; a gap makes two. */

/* Takes name, number, rate and unit of the fields between commas. */
static Status series_more(Lines *l, Header *h, Channel *c, Err *err)
{
    const char *p = l->from;
    (void)err;
    for (int k = 0; p <= l->to; k++) {
        const Cell field = cell_next(&p, l->to, ",");
        double x = NAN;
        if (k == 0)
            channel_name(c, field.from + strlen("TIMESERIES "), field.to);
        else if (k <= 2 && number_behind(field.from, field.to, "", &x))
            *(k == 1 ? &h->count : &h->dt) = k == 1 ? x : 1 / x;
        else if (k == 6)
            channel_unit(c, field.from, field.to);
    }
    return STATUS_OK;
}

/* ---- the table --------------------------------------------------------------------------------------------------- */

static const Format FORMATS[] = {
    {"knet", .begins = "Origin Time", .ends = "Memo.", .unit = UNIT_CM_S2, .more = knet_more,
     .words = {{RATE, "Sampling Freq(Hz)"},
               {DURATION, "Duration Time(s)"},
               {NAME, "Dir."},
               {FACTOR, "Scale Factor"},
               {PEAK, "Max. Acc. (gal)"}}},
    {"esm", .begins = "EVENT_NAME:",
     .words = {{COUNT, "NDATA:"},
               {STEP, "SAMPLING_INTERVAL_S:"},
               {DURATION, "DURATION_S:"},
               {NAME, "STREAM:"},
               {UNIT, "UNITS:"},
               {PEAK, "PGA_CM/S^2:"},
               {TYPE, "DATA_TYPE:"}}},
    {"jma", .begins = "SITE CODE", .separator = ",", .words = {{RATE, "SAMPLING RATE"}, {UNIT, "UNIT"}}},
    {"cwb", .begins = "#Earthquake Information", .separator = " ;", .peak_of = "#AmplitudeMAX. %s:",
     .words = {{RATE, "#SampleRate(Hz)"},
               {DURATION, "#RecordLength(sec)"},
               {UNIT, "#AmplitudeUnit"},
               {NAMES, "#DataSequence:"}}},
    {"afad", .begins = "STRONG GROUND MOTION RECORDS OF T", .separator = " ", .peak_of = "(%s)", .unit = UNIT_CM_S2,
     .words = {{COUNT, "NUMBER OF DATA|:"}, {STEP, "SAMPLING INTERVAL|:"}}},
    {"unam", .begins = "ARCHIVO ESTANDAR DE ACELERACION", .within = 12,
     .ends = "DATOS DE ACELERACION:", .separator = "/",
     .words = {{NAMES, "ORIENTACION C1|:"},
               {STEP, "INTERVALO DE MUESTREO, C1|:"},
               {UNIT, "UNIDADES DE LOS DATOS|:"},
               {COUNT, "NUM. TOTAL DE MUESTRAS, C1|:"},
               {PEAK, "ACEL. MAX.(Gal), C1|:"}}},
    {"csmnc", .begins = "NO. OF POINTS", .has = "EQUALLY SPACED INTERVALS OF", .within = 20, .ends = "NO. OF POINTS",
     .width = 14,
     .words = {{NAME, "COMP."},
               {UNIT, "|UNIT:"},
               {TYPE, "|UNIT:"},
               {PEAK, "PEAK VALUE"},
               {COUNT, "NO. OF POINTS"},
               {STEP, "NO. OF POINTS|INTERVALS OF"}}},
    {"csn", .begins = "# Tasa de muestreo", .within = 8,
     .words = {{RATE, "# Tasa de muestreo:"},
               {COUNT, "# Numero total de muestras:"},
               {UNIT, "# Unidades:"},
               {NAME, "# Estacion|Componente:"}}},
    {"isesd", .begins = "earthquake code:|waveform code:", .within = 7, .ends = "->",
     .words = {{NAME, "orientation of transducer:"},
               {STEP, "sampling period:"},
               {UNIT, "units:"},
               {COUNT, "number of samples:"},
               {TYPE, "->"}}},
    {"geonet", .begins = "Uncorrected accelerogram|Corrected accelerogram", .has = "GNS|Nuclear Sci", .text_lines = 16,
     .width = 8, .one_word = 1, .more = geonet_more,
     .words = {{NAME, "Component"}, {UNIT, "|units of 1.00"}, {PEAK, "Acceleration|Peak"}}},
    {"smc", .is = smc_is, .text_lines = SMC_TEXT_LINES, .unit = UNIT_CM_S2, .more = smc_more,
     .words = {{NAME, "|component="}}},
    {"cosmos", .has = "(Format v", .text_lines = -1, .more = cosmos_more,
     .words = {{TYPE, "|(Format v"}, {PEAK, "Processed|Max"}, {NAME, "Sta Cha|:"}}},
    {"csmip", .begins = "Uncorrected accelerogram|Corrected accelerogram", .integers = 1, .number_lines = 7,
     .more = csmip_more,
     .words = {{NAME, "Chan|:"},
               {PLACE, "Chan|Location"},
               {COUNT, "|of points"},
               {STEP, "|spaced intervals of"},
               {UNIT, "Units of| and "},
               {PEAK, "Units of|Max"},
               {PEAK, "Peak acceleration"}}},
    {"bhrc", .begins = "* VOL1", .text_lines = 13, .number_lines = 14, .width = 13, .one_word = 1,
     .words = {{NAME, "=LTV"},
               {NAME, "COMP"},
               {COUNT, "|NO. OF POINTS"},
               {DURATION, "|DURATION"},
               {UNIT, "UNITS ARE| and "}}},
    {"usc", .begins = "FILE", .has = "OF UNCORRECTED ACCELEROGRAM DATA", .text_lines = 13, .number_lines = 14,
     .width = 7, .pairs = 1, .one_word = 1,
     .words = {{NAME, "COMP"}, {COUNT, "|NO. OF POINTS"}, {UNIT, "UNITS ARE| and "}}},
    {"sac", .is = sac_text_is, .read = sac_text_read},
    {"slist", .begins = "TIMESERIES ", .has = "SLIST", .text_lines = 1, .more = series_more},
    {"tspair", .begins = "TIMESERIES ", .has = "TSPAIR", .text_lines = 1, .pairs = 1, .more = series_more},
    {"", .begins = "Response and Fourier amplitude spectra",
     .refused = "response and Fourier spectra of CSMIP (V3); take its V2 or V1"},
    {"", .begins = "RESPONSE", .has = "FOURIER",
     .refused = "response and Fourier spectra (volume 3); take the accelerogram"},
    {"", .begins = "<?xml", .refused = "XML (StationXML, QuakeML or the like)"},
    {"", .begins = "<!DOCTYPE html|<html", .refused = "a web page, perhaps of a log-in, in the place of the record"},
    {"", .begins = "WID2|BEGIN GSE2", .refused = "GSE2; export it as miniSEED, SAC or text"},
    {"", .begins = "version https://git-lfs", .refused = "a pointer of git-lfs in the place of the record"},
    {"at2", .is = at2_is, .ends = "NPTS", .width = 15, .more = at2_more,
     .words = {{COUNT, "|NPTS"},
               {UNIT, "|UNITS OF"},
               {UNIT, "|UNITS"},
               {UNIT, "|UNIT"},
               {UNIT, "ACCELERATION| IN "},
               {TYPE, "|TIME SERIES"},
               {TYPE, "|TIME HISTORY"}}},
};

/* The format of a record that begins with line l. */
static const Format *format_at(Lines l)
{
    l.next = l.raw;
    l.number = 0;
    for (const Format *f = FORMATS; f < FORMATS + N_OF(FORMATS); f++) {
        if (f->is && f->is(l))
            return f;
        for (Lines at = l; !f->is && at.number < MAX_OF(f->within, 1) && lines_next(&at);)
            if ((!f->begins || line_begins(&at, f->begins)) && (!f->has || line_has(&at, f->has)))
                return f;
    }
    return NULL;
}

/* Records lie one after the other, of one format or of several. */
Status text_read(Record *r, Lines *l, Err *err)
{
    const Lines first = lines_ahead(l);
    const Format *f = first.from && !r->how->text.is_given ? format_at(first) : NULL;
    if (!f)
        return columns_read(r, l, err);
    if (f->refused)
        return bad_data(err, "%s: is not read: %s", l->path, f->refused);
    for (r->is_known = 1; f;) {
        size_t k = r->n_channels;
        TRY(f->read ? f->read(r, l, err) : read_channel(f, r, l, err));
        for (; k < r->n_channels; k++)
            r->channel[k].format = f->name;

        /* The next one. End marks, velocities and displacements are passed over; other numbers below words would be
         * dropped in silence. */
        int is_known = 1;
        double x;
        f = NULL;
        for (Lines ahead = lines_ahead(l); ahead.from; ahead = lines_ahead(l)) {
            if (line_has_letters(&ahead) || !strchr("+-.0123456789", *ahead.from)) {
                f = format_at(ahead);
                is_known = f || line_has(&ahead, "veloc|displ| vel | dis");
                if (f && !f->refused)
                    break;
            } else if (!is_known && number_behind(ahead.from, ahead.to, "", &x))
                return fail_at(err, &ahead,
                               "more numbers, below words, than the header announces; is it a second record? Keep "
                               "one of them");
            *l = ahead;
            f = NULL;
        }
    }
    return STATUS_OK;
}
