/* Engineering Strong Motion data base, ASCII (https://esm-db.eu): lines "KEY: value", of which EVENT_NAME is the first,
 * then one sample per line. NDATA and SAMPLING_INTERVAL_S give the length, UNITS the unit, DATA_TYPE the quantity,
 * STREAM the channel. */
#include <ctype.h>
#include <math.h>
#include <string.h>

#include "motion/formats/record.h"

typedef struct {
    const char *from, *to;
    int line;
} Value;

typedef struct {
    Value count, step, units, type, stream, peak, duration;
} Header;

static int recognise(Lines l)
{
    return lines_next(&l) && line_begins(&l, "EVENT_NAME:");
}

static void take(const Lines *l, const char *key, Value *v)
{
    const size_t n = strlen(key);
    if (line_begins(l, key) && l->from + n < l->to && l->from[n] == ':')
        *v = (Value){l->from + n + 1, l->to, l->number};
}

static Header read_header(Lines *l)
{
    Header h = {0};
    for (Lines ahead = lines_ahead(l); ahead.from; ahead = lines_ahead(l)) {
        const char *colon = memchr(ahead.from, ':', (size_t)(ahead.to - ahead.from));
        if (!colon || !isalpha((unsigned char)*ahead.from))
            break;
        *l = ahead;
        take(l, "NDATA", &h.count);
        take(l, "SAMPLING_INTERVAL_S", &h.step);
        take(l, "UNITS", &h.units);
        take(l, "DATA_TYPE", &h.type);
        take(l, "STREAM", &h.stream);
        take(l, "DURATION_S", &h.duration);
        take(l, "PGA_CM/S^2", &h.peak);
    }
    return h;
}

static Status read(Record *r, Lines *l, const ReadHints *hints, Err *err)
{
    Channel *c;
    BlockForm form = {.count = NAN, .dt = NAN};
    (void)hints;
    const Header h = read_header(l);
    if (!h.count.from || !h.step.from)
        return fail(err, STATUS_BAD_DATA, "%s:%d: no %s in the header above this line", l->path, l->number,
                    h.count.from ? "SAMPLING_INTERVAL_S" : "NDATA");
    if (h.type.from && !find_word(h.type.from, h.type.to, "ACCELERATION"))
        return fail(err, STATUS_BAD_DATA, "%s:%d: not an acceleration: '%.*s'", l->path, h.type.line,
                    (int)(h.type.to - h.type.from < 40 ? h.type.to - h.type.from : 40), h.type.from);
    TRY(record_channel(r, l, &c, err));
    if (h.stream.from)
        channel_name(c, h.stream.from, h.stream.to);
    if (h.peak.from)
        channel_peak(c, h.peak.from, h.peak.to, "", 0.01);
    if (h.units.from)
        channel_unit(c, h.units.from, h.units.to);
    Lines at = *l;
    at.number = h.count.line;
    TRY(field_number(&at, h.count.from, h.count.to, 0, &form.count, err));
    at.number = h.step.line;
    TRY(field_number(&at, h.step.from, h.step.to, 0, &form.dt, err));
    TRY(record_block(r, l, &form, err));
    double duration = 0;
    const double by_steps = form.count * form.dt;
    if (h.duration.from && number_behind(h.duration.from, h.duration.to, "", &duration) && duration > 0 &&
        fabs(duration - by_steps) > 2 * form.dt + 0.01 * duration)
        return fail(err, STATUS_BAD_DATA, "%s:%d: DURATION_S is %g s, but %g samples every %g s are %g s", l->path,
                    h.duration.line, duration, form.count, form.dt, by_steps);
    return record_block_ends(l, form.count, err);
}

const MotionFormat FORMAT_ESM = {"esm", recognise, read};
