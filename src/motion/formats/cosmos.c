/* COSMOS strong motion data format 1.20 (COSMOS, 2001), V1 and V2, one or more channels. Line 1 ends in "(Format v01.20
 * with 13 text lines)", itself among them; after those come an integer and a real header and comments, each under a
 * line that says how many lines follow, then
 *
 *   7000  acceleration pts, approx   70 secs, units=cm/sec2(04),Format=(8F10.5)
 *
 * and the samples. Real 62 is the step in ms. A line "End-of-data ..." closes the channel. */
#include <ctype.h>
#include <math.h>
#include <string.h>

#include "motion/formats/record.h"

enum { N_REALS = 100, STEP_AT = 61 };
static const double S_PER_MS = 1e-3;

static int begins_channel(const Lines *l)
{
    return line_has(l, "(Format v") && line_has(l, "text lines");
}

static int recognise(Lines l)
{
    return lines_next(&l) && begins_channel(&l);
}

static Status read_text(Lines *l, Channel *c, Err *err)
{
    double n = NAN;
    number_behind(l->from, l->to, "with", &n);
    if (!line_has(l, "acceleration"))
        return fail(err, STATUS_BAD_DATA, "%s:%d: not an acceleration: '%.*s'", l->path, l->number, line_shown(l),
                    l->from);
    if (!(n >= 0 && n <= 1000))
        return fail(err, STATUS_BAD_DATA, "%s:%d: no usable number of text lines in '%.*s'", l->path, l->number,
                    line_shown(l), l->from);
    for (int i = 1; i < (int)n; i++) {
        if (!lines_next(l))
            return fail_too_short(l, "header", err);
        const char *colon = memchr(l->from, ':', (size_t)(l->to - l->from));
        const char *max = line_begins(l, "Processed") ? find_word(l->from, l->to, "Max =") : NULL;
        if (max && find_word(max, l->to, "cm/sec2"))
            channel_peak(c, max, l->to, "Max", 0.01);
        if (!line_begins(l, "Sta Cha") || !colon)
            continue;
        const char *name = find_word(colon, l->to, "deg") ? memchr(colon + 1, ':', (size_t)(l->to - colon - 1)) : NULL;
        name = name && name < find_word(colon, l->to, "deg") ? name + 1 : colon + 1;
        const char *stop = memchr(name, '(', (size_t)(l->to - name));
        channel_name(c, name, stop ? stop : l->to);
    }
    return STATUS_OK;
}

/* The line above a part of the header: "100 Integer-header values follow on  10 lines, Format= (10I8)". */
static Status part_begins(Lines *l, const char *word, double *n_lines, Err *err)
{
    if (!lines_next(l))
        return fail_too_short(l, "header", err);
    const int counted = number_behind(l->from, l->to, "follow on", n_lines);
    if (!line_has(l, word) || !counted || !(*n_lines >= 0 && *n_lines <= 1000))
        return fail(err, STATUS_BAD_DATA, "%s:%d: '%.*s' does not announce the %s", l->path, l->number, line_shown(l),
                    l->from, word);
    return STATUS_OK;
}

static Status read_headers(Lines *l, double reals[N_REALS], Err *err)
{
    double n_lines = 0;
    TRY(part_begins(l, "Integer-header", &n_lines, err));
    if (!lines_skip(l, (int)n_lines))
        return fail_too_short(l, "header", err);
    TRY(part_begins(l, "Real-header", &n_lines, err));
    TRY(header_numbers(l, format_width(l), N_REALS, reals, err));
    return STATUS_OK;
}

/* Comments begin with '|', whatever their announced number is; the line after them announces the samples. */
static Status skip_comments(Lines *l, Err *err)
{
    if (!lines_next(l))
        return fail_too_short(l, "samples", err);
    if (!line_has(l, "comment line"))
        return STATUS_OK;
    do {
        if (!lines_next(l))
            return fail_too_short(l, "samples", err);
    } while (line_begins(l, "|"));
    return STATUS_OK;
}

/* The header's step times its count must give about the length that is written beside it. */
static Status check_length(const Lines *l, const BlockForm *form, Err *err)
{
    double seconds;
    if (!number_behind(l->from, l->to, "approx", &seconds))
        return STATUS_OK;
    const double length = form->count * form->dt;
    if (fabs(length - seconds) > 1 + 0.02 * length)
        return fail(err, STATUS_BAD_DATA, "%s:%d: %g points every %g s are %g s, but this line says %g s", l->path,
                    l->number, form->count, form->dt, length, seconds);
    return STATUS_OK;
}

static Status read_channel(Record *r, Lines *l, Err *err)
{
    double reals[N_REALS];
    Channel *c;
    TRY(record_channel(r, l, &c, err));
    TRY(read_text(l, c, err));
    TRY(read_headers(l, reals, err));
    TRY(skip_comments(l, err));
    if (line_has(l, "counts"))
        return fail(err, STATUS_BAD_DATA, "%s:%d: raw counts, not an acceleration: '%.*s'", l->path, l->number,
                    line_shown(l), l->from);
    BlockForm form = {.count = NAN, .dt = reals[STEP_AT] * S_PER_MS, .width = format_width(l)};
    number_behind(l->from, l->to, "", &form.count);
    channel_unit_in(c, l, "units=");
    if (!(form.dt > 0))
        return fail(err, STATUS_BAD_DATA, "%s:%d: no usable time step: real 62 of the header above is %g", l->path,
                    l->number, reals[STEP_AT]);
    TRY(check_length(l, &form, err));
    TRY(record_block(r, l, &form, err));
    return record_block_ends(l, form.count, err);
}

static Status read(Record *r, Lines *l, const ReadHints *hints, Err *err)
{
    (void)hints;
    while (lines_next_filled(l))
        if (begins_channel(l))
            TRY(read_channel(r, l, err));
    return STATUS_OK;
}

const MotionFormat FORMAT_COSMOS = {"cosmos", recognise, read};
