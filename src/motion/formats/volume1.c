/* Volume 1 of two agencies, uncorrected accelerograms, one component or more, one after the other. Each has 13 lines of
 * text, 7 lines 16I5 and 7 lines 8F10, then the samples; units as a rule g/10.
 *
 *   bhrc   BHRC (Iran): line 1 "* VOL1DS FILE: ...", line 5 L, T or V, equal steps, 10E13.6, "/&" behind each component
 *          NO. OF POINTS =  15616      DURATION =  78.080           UNITS ARE SECONDS AND G/10
 *   usc    USC (Los Angeles): line 1 "FILE 0 OF UNCORRECTED ACCELEROGRAM DATA OF VOLUME I", line 6 "COMP N08W",
 *          pairs of time and acceleration F8.3, 9F7.3, digitized from film NO. OF POINTS =   8820      DURATION =
 *          37.714 SEC       UNITS ARE SEC AND G/10 */
#include <math.h>
#include <string.h>

#include "motion/formats/record.h"

enum { TEXT_LINES = 13, NUMBER_LINES = 14 };

static int begins_bhrc(const Lines *l)
{
    return line_begins(l, "* VOL1");
}

static int begins_usc(const Lines *l)
{
    return line_begins(l, "FILE") && line_has(l, "OF UNCORRECTED ACCELEROGRAM DATA");
}

static int recognise_bhrc(Lines l)
{
    return lines_next(&l) && begins_bhrc(&l);
}

static int recognise_usc(Lines l)
{
    return lines_next(&l) && begins_usc(&l);
}

typedef struct {
    double count, duration;
    Lines at_count;
} Text;

/* "L" of BHRC, where its own line has it; "N08W" of USC, behind COMP. */
static void take_text(const Lines *l, Text *t, Channel *c)
{
    if (l->to - l->from == 1 && strchr("LTV", *l->from))
        channel_name(c, l->from, l->to);
    if (line_begins(l, "COMP") && !c->name[0]) {
        const char *p = l->from + strlen("COMP"), *to;
        while (p < l->to && *p == ' ')
            p++;
        for (to = p; to < l->to && *to != ' ';)
            to++;
        channel_name(c, p, to);
    }
    if (number_behind(l->from, l->to, "NO. OF POINTS", &t->count)) {
        t->at_count = *l;
        number_behind(l->from, l->to, "DURATION", &t->duration);
    }
    if (line_begins(l, "UNITS ARE"))
        channel_unit_in(c, l, " and ");
}

/* Up to the last line of the numeric header. */
static Status read_header(Record *r, Lines *l, Text *t, Channel **c, Err *err)
{
    *t = (Text){.count = NAN, .duration = NAN, .at_count = *l};
    TRY(record_channel(r, l, c, err));
    for (int i = 1; i < TEXT_LINES; i++) {
        if (!lines_next(l))
            return fail_too_short(l, "header", err);
        take_text(l, t, *c);
    }
    if (!(t->count >= 2 && t->count <= 1e8))
        return fail(err, STATUS_BAD_DATA, "%s:%d: no usable number of points (2 or more) in '%.*s'", l->path,
                    t->at_count.number, line_shown(&t->at_count), t->at_count.from);
    return lines_skip(l, NUMBER_LINES) ? STATUS_OK : fail_too_short(l, "header", err);
}

static Status read_bhrc(Record *r, Lines *l, const ReadHints *hints, Err *err)
{
    (void)hints;
    while (lines_next_filled(l)) {
        Text t;
        Channel *c;
        if (!begins_bhrc(l))
            continue;
        TRY(read_header(r, l, &t, &c, err));
        TRY(record_block(r, l, &(BlockForm){.count = t.count, .dt = t.duration / t.count, .width = 13}, err));
        TRY(record_block_ends(l, t.count, err));
    }
    return STATUS_OK;
}

static Status read_usc(Record *r, Lines *l, const ReadHints *hints, Err *err)
{
    (void)hints;
    while (lines_next_filled(l)) {
        Text t;
        Channel *c;
        if (!begins_usc(l))
            continue;
        TRY(read_header(r, l, &t, &c, err));
        TRY(record_pairs(r, l, t.count, 7, err));
    }
    return STATUS_OK;
}

const MotionFormat FORMAT_BHRC = {"bhrc", recognise_bhrc, read_bhrc};
const MotionFormat FORMAT_USC = {"usc", recognise_usc, read_usc};
