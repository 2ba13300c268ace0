/* USGS SMC format (Open-File Report 2005-1438, appendix): 11 lines of text, of which the first says what is held and
 * the sixth names the component; 6 lines 8I10, 10 lines 5E15.7; comments that begin with '|'; samples 8E10.4 in cm/s2,
 * which run together where they are negative.
 *
 *   integer 16: number of comment lines      integer 17: number of samples      real 2: samples per second
 */
#include <ctype.h>
#include <string.h>

#include "scene/formats/record.h"

enum { TEXT_LINES = 11, N_INTEGERS = 48, N_REALS = 50, COMMENTS_AT = 15, COUNT_AT = 16, RATE_AT = 1 };

static int recognise(Lines l)
{
    if (!lines_next(&l) || l.from == l.to)
        return 0;
    const int first = line_has(&l, "ACCELEROGRAM") || line_has(&l, "VELOCITY") || line_has(&l, "DISPLACEMENT");
    const int numbered = isdigit((unsigned char)*l.from) && first;
    if (!numbered && *l.from != '*')
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
    if (!lines_next(l) || !line_has(l, "ACCELEROGRAM"))
        return fail(err, STATUS_BAD_DATA, "%s:%d: not an acceleration: '%.*s'", l->path, l->number, line_shown(l),
                    l->from);
    lines_skip(l, TEXT_LINES - 1);
    const char *name = find_word(six.from, six.to, "component=");
    TRY(record_channel(r, l, c, err));
    if (name)
        channel_name(*c, name + strlen("component="), six.to);
    return STATUS_OK;
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
    if (!(reals[RATE_AT] > 0 && reals[RATE_AT] <= 1e5))
        return fail(err, STATUS_BAD_DATA, "%s:%d: no usable sampling rate: the header above says %g", l->path,
                    l->number, reals[RATE_AT]);
    if (!(integers[COUNT_AT] >= 2))
        return fail(err, STATUS_BAD_DATA, "%s:%d: no usable number of points: the header above says %g", l->path,
                    l->number, integers[COUNT_AT]);
    const BlockForm form = {.count = integers[COUNT_AT], .dt = 1 / reals[RATE_AT], .width = 10};
    TRY(record_block(r, l, &form, err));
    return record_block_ends(l, form.count, err);
}

const MotionFormat FORMAT_SMC = {"smc", recognise, read};
