/* CSMNC, the strong motion network centre of China (Institute of Engineering Mechanics, China Earthquake
 * Administration), one component per file: lines of words, of which
 *
 *   COMP. EW                                         UNCORRECTED ACCELERATION          UNIT: CM/SEC/SEC
 *   NO. OF POINTS:  12000  EQUALLY SPACED INTERVALS OF:  0.005  SEC
 *   PEAK VALUE:    -1005.350   AT   26.35 SEC    DURATION:  60 SEC
 *
 * then the samples, 8E14.6. The layout is that of files of the Lushan earthquake of 2013. */
#include <math.h>
#include <string.h>

#include "motion/formats/record.h"

static int is_points_line(const Lines *l)
{
    return line_begins(l, "NO. OF POINTS") && line_has(l, "EQUALLY SPACED INTERVALS OF");
}

static int recognise(Lines l)
{
    while (l.number < 20 && lines_next(&l))
        if (is_points_line(&l))
            return 1;
    return 0;
}

static Status read(Record *r, Lines *l, const ReadHints *hints, Err *err)
{
    Channel *c;
    BlockForm form = {.count = NAN, .dt = NAN, .width = 14};
    Lines direction = {0}, unit = {0}, peak = {0};
    (void)hints;
    for (Lines ahead = lines_ahead(l); ahead.from && (isnan(form.count) || line_is_marker(&ahead));
         ahead = lines_ahead(l)) {
        *l = ahead;
        if (line_begins(l, "COMP."))
            direction = *l;
        else if (line_has(l, "UNIT:"))
            unit = *l;
        else if (line_begins(l, "PEAK VALUE"))
            peak = *l;
        else if (is_points_line(l)) {
            number_behind(l->from, l->to, "POINTS", &form.count);
            number_behind(l->from, l->to, "INTERVALS OF", &form.dt);
        }
    }
    if (unit.from && !line_has(&unit, "ACCELERATION"))
        return fail(err, STATUS_BAD_DATA, "%s:%d: not an acceleration: '%.*s'", l->path, unit.number, line_shown(&unit),
                    unit.from);
    TRY(record_channel(r, l, &c, err));
    if (direction.from)
        channel_name(c, direction.from + strlen("COMP."), direction.to);
    if (unit.from)
        channel_unit_in(c, &unit, "UNIT:");
    if (peak.from)
        channel_peak(c, peak.from, peak.to, "PEAK VALUE", 0.01);
    TRY(record_block(r, l, &form, err));
    return record_block_ends(l, form.count, err);
}

const MotionFormat FORMAT_CSMNC = {"csmnc", recognise, read};
