/* CSMIP (CDMG, CGS) and the USGS files of the same layout, V1 and V2 (CSMIP report OSMS 85-03), one or more channels:
 * lines of text, 100 integers 16I5, 50 (V1) or 100 (V2) reals 8F10, then a line that says what follows, such as
 *
 *   13200 Accelerogram points at 200 pts/sec in units of g .      Format: (8f9.6)               V1, digital
 *   12000 points of accel data equally spaced at  .005 sec, in cm/sec2. (8f10.6)                V2
 *
 * and the samples (8F10 where the line has no format); V2 goes on with velocities and displacements. V1 of a film
 * recorder has no such line: pairs of time and acceleration, 10F7.3, whose number and unit (as a rule g/10) stand in
 * the text. Peaks: "Max = .079 g" beside the units (V1), "Peak acceleration = 77.280 cm/sec/sec" (V2). A channel's name
 * is what stands behind "Chan  1:", with the location where the text has one ("Location: Roof"). */
#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/units.h"
#include "motion/formats/record.h"

enum { TEXT_LINES_MAX = 60, INTEGER_LINES = 7, REAL_LINES_V1 = 7, REAL_LINES_MAX = 20 };

static int begins_channel(const Lines *l)
{
    return line_begins(l, "Uncorrected accelerogram") || line_begins(l, "Corrected accelerogram");
}

static int recognise(Lines l)
{
    return lines_next(&l) && begins_channel(&l);
}

typedef struct {
    int is_v2;
    double count, dt; /* NAN: the text does not say */
    Lines at_count;
} Text;

static int has_letters(const Lines *l)
{
    for (const char *p = l->from; p < l->to; p++)
        if (isalpha((unsigned char)*p) && !strchr("eEdD", *p))
            return 1;
    return 0;
}

/* 16I5: nothing but digits, signs and blanks. */
static int is_integers(const Lines *l)
{
    int digits = 0;
    for (const char *p = l->from; p < l->to; p++) {
        if (!isdigit((unsigned char)*p) && *p != ' ' && *p != '-')
            return 0;
        digits += isdigit((unsigned char)*p) != 0;
    }
    return digits >= 16;
}

/* "360 Deg   (Sta Chn: 1)  Location: Roof" is named "360 Deg, Roof": what tells channels apart comes first. */
static void name_channel(const char *from, const char *to, Channel *c)
{
    char text[2 * CHANNEL_NAME_MAX];
    const char *bracket = memchr(from, '(', (size_t)(to - from)), *location = find_word(from, to, "Location");
    const char *stop = bracket && (!location || bracket < location) ? bracket : location ? location : to;
    channel_name(c, from, stop);
    if (!location)
        return;
    location += strlen("Location");
    while (location < to && strchr(" :=", *location))
        location++;
    const int n = snprintf(text, sizeof text, "%s, %.*s", c->name, (int)(to - location), location);
    channel_name(c, text, text + (n < (int)sizeof text ? n : (int)sizeof text - 1));
}

static void take_text(const Lines *l, Text *t, Channel *c)
{
    const char *colon = memchr(l->from, ':', (size_t)(l->to - l->from));
    if (line_begins(l, "Chan") && colon)
        name_channel(colon + 1, l->to, c);
    if (number_behind(l->from, l->to, "of points", &t->count))
        t->at_count = *l;
    number_behind(l->from, l->to, "spaced intervals of", &t->dt);
    if (line_begins(l, "Peak acceleration") && (line_has(l, "cm/sec") || line_has(l, "cms/sec")))
        channel_peak(c, l->from, l->to, "acceleration", 0.01);
    if (!line_begins(l, "Units of"))
        return;
    const char *max = find_word(l->from, l->to, "Max");
    if (max && find_word(max, l->to, " g"))
        channel_peak(c, max, l->to, "Max", GRAVITY);
    channel_unit_in(c, l, " and ");
}

/* Up to the last line of the integer header. */
static Status read_text(Lines *l, Text *t, Channel *c, Err *err)
{
    *t = (Text){.is_v2 = line_begins(l, "Corrected"), .count = NAN, .dt = NAN, .at_count = *l};
    for (int i = 0; i < TEXT_LINES_MAX; i++) {
        if (!lines_next(l))
            return fail_too_short(l, "header", err);
        if (!is_integers(l)) {
            take_text(l, t, c);
            continue;
        }
        return lines_skip(l, INTEGER_LINES - 1) ? STATUS_OK : fail_too_short(l, "header", err);
    }
    return fail(err, STATUS_BAD_DATA, "%s:%d: no integer header in the %d lines above", l->path, l->number,
                TEXT_LINES_MAX);
}

/* Past the real header. Now l is at the line that announces the samples, or, pairs, at the one before them. */
static Status find_samples(Lines *l, const Text *t, int *pairs, Err *err)
{
    *pairs = 0;
    for (int i = 0; i < REAL_LINES_MAX; i++) {
        const Lines ahead = lines_ahead(l);
        if (!ahead.from)
            return fail_too_short(l, "samples", err);
        if (!t->is_v2 && i == REAL_LINES_V1 && !has_letters(&ahead)) {
            *pairs = 1;
            return STATUS_OK;
        }
        *l = ahead;
        if (has_letters(l))
            return STATUS_OK;
    }
    return fail(err, STATUS_BAD_DATA, "%s:%d: no line that announces the samples above this one", l->path, l->number);
}

/* "... at 200 pts/sec ..." or "... equally spaced at .005 sec ..." */
static double announced_step(const Lines *l, double from_text)
{
    double x;
    if (!number_behind(l->from, l->to, " at ", &x))
        return from_text;
    return line_has(l, "pts/s") || line_has(l, "points/s") || line_has(l, "samples/s") ? 1 / x : x;
}

static Status read_pairs(Record *r, Lines *l, const Text *t, Err *err)
{
    const Lines *at = &t->at_count;
    if (!(t->count >= 2 && t->count <= 1e8))
        return fail(err, STATUS_BAD_DATA, "%s:%d: no usable number of points (2 or more) in '%.*s'", l->path,
                    at->number, line_shown(at), at->from);
    return record_pairs(r, l, t->count, 7, err);
}

static Status read_block(Record *r, Lines *l, const Text *t, Channel *c, Err *err)
{
    BlockForm form = {.count = NAN, .dt = announced_step(l, t->dt), .width = format_width(l)};
    form.width = form.width ? form.width : 10; /* 8F10.x where the line does not say it */
    number_behind(l->from, l->to, "", &form.count);
    Channel stated = {0};
    channel_unit_in(&stated, l, " in units of ");
    if (line_has(l, "veloc") || line_has(l, "displ"))
        return fail(err, STATUS_BAD_DATA, "%s:%d: not an acceleration: '%.*s'", l->path, l->number, line_shown(l),
                    l->from);
    if (stated.units || stated.unit[0]) {
        c->units = stated.units;
        memcpy(c->unit, stated.unit, sizeof c->unit);
        c->scale = stated.scale;
    }
    TRY(record_block(r, l, &form, err));
    const Lines ahead = lines_ahead(l);
    return ahead.from && has_letters(&ahead) ? STATUS_OK : record_block_ends(l, form.count, err);
}

static Status read_channel(Record *r, Lines *l, Err *err)
{
    Text text;
    Channel *c;
    int pairs;
    TRY(record_channel(r, l, &c, err));
    TRY(read_text(l, &text, c, err));
    TRY(find_samples(l, &text, &pairs, err));
    return pairs ? read_pairs(r, l, &text, err) : read_block(r, l, &text, c, err);
}

/* Velocities, displacements and end marks lie between the channels. */
static Status read(Record *r, Lines *l, const ReadHints *hints, Err *err)
{
    (void)hints;
    while (lines_next_filled(l))
        if (begins_channel(l))
            TRY(read_channel(r, l, err));
    return STATUS_OK;
}

const MotionFormat FORMAT_CSMIP = {"csmip", recognise, read};
