/* K-NET and KiK-net, one component per file (NIED, https://www.kyoshin.bosai.go.jp): 17 lines "key  value", of which
 *
 *   Sampling Freq(Hz) 100Hz      Duration Time(s) 300      Dir. N-S      Scale Factor 3920(gal)/6182761
 *   Max. Acc. (gal)   123.4
 *
 * and the last is "Memo.", then counts, eight to a line. A count times the scale factor is in gal; its zero is the
 * recorder's, so the mean is subtracted, as NIED does for its Max. Acc. KiK-net numbers its directions: 1 to 3 are NS,
 * EW, UD in the borehole, 4 to 6 the same at the surface. */
#include <math.h>
#include <string.h>

#include "motion/formats/record.h"

typedef struct {
    Lines frequency, duration, direction, factor, peak;
} Header;

static int recognise(Lines l)
{
    return lines_next(&l) && line_begins(&l, "Origin Time");
}

static Status read_header(Lines *l, Header *h, Err *err)
{
    while (lines_next(l)) {
        if (line_begins(l, "Sampling Freq"))
            h->frequency = *l;
        else if (line_begins(l, "Duration Time"))
            h->duration = *l;
        else if (line_begins(l, "Dir."))
            h->direction = *l;
        else if (line_begins(l, "Scale Factor"))
            h->factor = *l;
        else if (line_begins(l, "Max. Acc"))
            h->peak = *l;
        else if (line_begins(l, "Memo"))
            return STATUS_OK;
    }
    return fail_too_short(l, "line 'Memo.', which begins the samples", err);
}

/* "3920(gal)/6182761" */
static double scale_factor(const Lines *l)
{
    double gal, counts;
    const char *slash = memchr(l->from, '/', (size_t)(l->to - l->from));
    const int ok = slash && number_behind(l->from, slash, "Factor", &gal) && number_behind(slash, l->to, "/", &counts);
    return ok && find_word(l->from, slash, "gal") ? gal / counts : NAN;
}

static Status name_direction(Channel *c, const Lines *l, Err *err)
{
    static const char *const KIKNET[] = {"NS1", "EW1", "UD1", "NS2", "EW2", "UD2"}, *const KNET[] = {"N-S", "E-W",
                                                                                                     "U-D"};
    channel_name(c, l->from + strlen("Dir."), l->to);
    for (int i = 0; i < 3; i++)
        if (strcmp(c->name, KNET[i]) == 0)
            return STATUS_OK;
    if (c->name[0] < '1' || c->name[0] > '6' || c->name[1])
        return fail(err, STATUS_BAD_DATA,
                    "%s:%d: the direction '%s' is none of N-S, E-W, U-D (K-NET), 1 to 6 (KiK-net)", l->path, l->number,
                    c->name);
    channel_name(c, KIKNET[c->name[0] - '1'], KIKNET[c->name[0] - '1'] + 3);
    return STATUS_OK;
}

static Status read(Record *r, Lines *l, const ReadHints *hints, Err *err)
{
    Header h = {0};
    Channel *c;
    double hertz = NAN, seconds = NAN;
    (void)hints;
    TRY(read_header(l, &h, err));
    if (!h.frequency.from || !h.duration.from || !h.factor.from || !h.direction.from)
        return fail(err, STATUS_BAD_DATA, "%s:%d: no line '%s' before this one", l->path, l->number,
                    !h.frequency.from  ? "Sampling Freq(Hz)"
                    : !h.duration.from ? "Duration Time(s)"
                    : !h.factor.from   ? "Scale Factor"
                                       : "Dir.");
    number_behind(h.frequency.from, h.frequency.to, "(Hz)", &hertz);
    number_behind(h.duration.from, h.duration.to, "(s)", &seconds);
    TRY(record_channel(r, l, &c, err));
    TRY(name_direction(c, &h.direction, err));
    c->subtract_mean = 1;
    if (h.peak.from)
        channel_peak(c, h.peak.from, h.peak.to, "(gal)", 0.01);
    c->units = 1u << UNIT_CM_S2;
    c->scale = scale_factor(&h.factor);
    if (!(c->scale > 0 && isfinite(c->scale)))
        return fail(err, STATUS_BAD_DATA, "%s:%d: no usable scale factor, as 3920(gal)/6182761, in '%.*s'", l->path,
                    h.factor.number, line_shown(&h.factor), h.factor.from);
    if (!(hertz > 0 && hertz <= 1e5))
        return fail(err, STATUS_BAD_DATA, "%s:%d: no usable sampling frequency in '%.*s'", l->path, h.frequency.number,
                    line_shown(&h.frequency), h.frequency.from);
    const BlockForm form = {.count = round(hertz * seconds), .dt = 1 / hertz};
    TRY(record_block(r, l, &form, err));
    return record_block_ends(l, form.count, err);
}

const MotionFormat FORMAT_KNET = {"knet", recognise, read};
