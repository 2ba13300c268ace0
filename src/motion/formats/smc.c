/* USGS SMC format (Open-File Report 2005-1438, appendix): 11 lines of text, of which the first says what is held and
 * the sixth names the component; 6 lines 8I10, 10 lines 5E15.7; comments that begin with '|'; numbers in cm/s2, which
 * run together where they are negative, 8E10.4 or wider columns (5E14.7).
 *
 *   integer 16   comment lines                 real 1         stands for "undefined" (1.7E38)
 *   integer 17   numbers that follow           real 2         samples per second; undefined: pairs of time and
 *   real 30, 32  largest and smallest value                   acceleration, digitized from film, their steps unequal
 *
 * A first line "UNKNOWN" does not say what is held; it is read as an acceleration, with a warning. */
#include <ctype.h>
#include <math.h>
#include <string.h>

#include "motion/formats/record.h"

enum {
    TEXT_LINES = 11,
    N_INTEGERS = 48,
    N_REALS = 50,
    COMMENTS_AT = 15,
    COUNT_AT = 16,
    RATE_AT = 1,
    LARGEST_AT = 29,
    SMALLEST_AT = 31
};

static int recognise(Lines l)
{
    if (!lines_next(&l) || l.from == l.to)
        return 0;
    const int first = line_has(&l, "ACCELEROGRAM") || line_has(&l, "VELOCITY") || line_has(&l, "DISPLACEMENT");
    const int numbered = isdigit((unsigned char)*l.from) && first;
    if (!numbered && *l.from != '*' && !line_begins(&l, "UNKNOWN"))
        return 0;
    return lines_skip(&l, 1) && line_begins(&l, "*") && lines_skip(&l, TEXT_LINES - 2) && line_begins(&l, "*");
}

static Status skip_comments(Lines *l, double n, Err *err)
{
    if (!(n >= 0 && n <= 1e6))
        return fail(err, STATUS_BAD_DATA, "%s:%d: no usable number of comment lines: %g", l->path, l->number, n);
    for (int i = 0; i < (int)n; i++) {
        if (!lines_next(l))
            return fail_too_short(l, "samples", err);
        if (!line_begins(l, "|"))
            return fail(err, STATUS_BAD_DATA, "%s:%d: comment %d of %g does not begin with '|': '%.*s'", l->path,
                        l->number, i + 1, n, line_shown(l), l->from);
    }
    return STATUS_OK;
}

static Status read_text(Record *r, Lines *l, Channel **c, Err *err)
{
    Lines six = *l;
    lines_skip(&six, 6);
    if (!lines_next(l))
        return fail_too_short(l, "header", err);
    const int unknown = line_begins(l, "UNKNOWN");
    if (!unknown && !line_has(l, "ACCELEROGRAM"))
        return fail(err, STATUS_BAD_DATA, "%s:%d: not an acceleration: '%.*s'", l->path, l->number, line_shown(l),
                    l->from);
    lines_skip(l, TEXT_LINES - 1);
    const char *name = find_word(six.from, six.to, "component=");
    TRY(record_channel(r, l, c, err));
    if (unknown)
        (*c)->warning = "its first line, UNKNOWN, does not say what it holds; taken as an acceleration";
    if (name)
        channel_name(*c, name + strlen("component="), six.to);
    return STATUS_OK;
}

/* The first number of a block stands at the right end of its column. */
static int column_width(const Lines *l)
{
    const Lines ahead = lines_ahead(l);
    if (!ahead.from)
        return 10;
    const char *p = ahead.from;
    while (p < ahead.to && *p != 'E' && *p != 'e' && *p != 'D' && *p != ' ')
        p++;
    for (p += p < ahead.to;
         p < ahead.to && (isdigit((unsigned char)*p) || (strchr("+-", *p) && !isdigit((unsigned char)p[-1])));)
        p++;
    const long width = p - ahead.raw;
    return width >= 10 && width <= 20 ? (int)width : 10;
}

static void take_peak(Channel *c, const double reals[N_REALS])
{
    const double undefined = reals[0], a = reals[LARGEST_AT], b = reals[SMALLEST_AT];
    if (a == undefined || b == undefined || !(fabs(a) < 1e6 && fabs(b) < 1e6))
        return;
    c->peak = 0.01 * fmax(fabs(a), fabs(b));
    c->peak_slack = 1e-4 * c->peak;
}

static Status read(Record *r, Lines *l, const ReadHints *hints, Err *err)
{
    double integers[N_INTEGERS], reals[N_REALS];
    Channel *c;
    (void)hints;
    TRY(read_text(r, l, &c, err));
    c->units = 1u << UNIT_CM_S2;
    TRY(header_numbers(l, 10, N_INTEGERS, integers, err));
    TRY(header_numbers(l, 15, N_REALS, reals, err));
    TRY(skip_comments(l, integers[COMMENTS_AT], err));
    take_peak(c, reals);
    const double count = integers[COUNT_AT], rate = reals[RATE_AT];
    if (!(count >= 2 && count <= 1e8))
        return fail(err, STATUS_BAD_DATA, "%s:%d: no usable number of points: the header above says %g", l->path,
                    l->number, count);
    if (rate == reals[0] && rate > 1e30)
        return record_pairs(r, l, floor(count / 2), column_width(l),
                            err); /* a line more may follow, of another record */
    else if (!(rate > 0 && rate <= 1e5))
        return fail(err, STATUS_BAD_DATA, "%s:%d: no usable sampling rate: the header above says %g", l->path,
                    l->number, rate);
    else
        TRY(record_block(r, l, &(BlockForm){.count = count, .dt = 1 / rate, .width = column_width(l)}, err));
    return record_block_ends(l, count, err);
}

const MotionFormat FORMAT_SMC = {"smc", recognise, read};
