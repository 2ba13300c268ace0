/* GeoNet (GNS Science, earlier the Institute of Geological & Nuclear Sciences) V1A and V2A, as a rule three components
 * one after the other. Each has 16 lines of text, of which line 13 is "Component N28W" (blank in older files) and line
 * 14 "Acceleration:  Peak  -2080.5 mm/s/s ...", then 10 lines of 10 numbers, then samples 10F8.1 in mm/s2. Numbers of
 * that header, line and place counted from 0:
 *
 *   [3][0] samples of V1      [3][3] [3][4] [3][5] accelerations, velocities, displacements of V2      [6][5] step [s]
 */
#include <ctype.h>
#include <math.h>
#include <string.h>

#include "motion/formats/record.h"

enum { TEXT_LINES = 16, COMPONENT_LINE = 13, N_LINES = 10, PER_LINE = 10, WIDTH = 8 };

static int begins_component(const Lines *l)
{
    return l->from && (line_begins(l, "Uncorrected accelerogram") || line_begins(l, "Corrected accelerogram"));
}

static int recognise(Lines l)
{
    return lines_next(&l) && begins_component(&l) && (line_has(&l, "GNS") || line_has(&l, "Nuclear Sci"));
}

/* "Component S16W  Longitudinal Accelerometer Axis" */
static void name_component(const Lines *l, Channel *c)
{
    const char *from = l->from + strlen("Component"), *to;
    while (from < l->to && isspace((unsigned char)*from))
        from++;
    for (to = from; to < l->to && !isspace((unsigned char)*to); to++)
        ;
    channel_name(c, from, to);
}

/* V1 tells the unit of its readings; V2 only that of their peak. */
static Status read_text(Record *r, Lines *l, Channel **c, double *step_in_words, Err *err)
{
    int in_mm = 0, told = 0;
    TRY(record_channel(r, l, c, err));
    for (int i = 2; i <= TEXT_LINES; i++) {
        if (!lines_next(l))
            return fail_too_short(l, "header", err);
        number_behind(l->from, l->to, "data at", step_in_words);
        if (line_has(l, "units of") || (!told && line_begins(l, "Acceleration"))) {
            in_mm = line_has(l, "mm/s/s");
            told = 1;
        }
        if (line_begins(l, "Acceleration") && line_has(l, "mm/s/s"))
            channel_peak(*c, l->from, l->to, "Peak", 0.001);
        if (i != COMPONENT_LINE || l->from == l->to) /* blank in older files: the component has no name */
            continue;
        if (!line_begins(l, "Component"))
            return fail(err, STATUS_BAD_DATA, "%s:%d: '%.*s' does not name a component", l->path, l->number,
                        line_shown(l), l->from);
        name_component(l, *c);
    }
    (*c)->units = in_mm ? 1u << UNIT_CM_S2 : 0;
    (*c)->scale = in_mm ? 0.1 : 1;
    return STATUS_OK;
}

static Status read_numbers(Lines *l, double h[N_LINES][PER_LINE], Lines *at_count, Err *err)
{
    for (int i = 0; i < N_LINES; i++) {
        size_t n;
        if (!lines_next(l))
            return fail_too_short(l, "header", err);
        TRY(line_numbers(l, WIDTH, PER_LINE, h[i], &n, err));
        if (n != PER_LINE)
            return fail(err, STATUS_BAD_DATA, "%s:%d: %zu numbers in this line of the header, 10 are expected", l->path,
                        l->number, n);
        if (i == 3)
            *at_count = *l;
    }
    return STATUS_OK;
}

static int lines_for(double n)
{
    return n > 0 && n <= 1e8 ? ((int)n + PER_LINE - 1) / PER_LINE : 0;
}

static Status read_component(Record *r, Lines *l, Err *err)
{
    double h[N_LINES][PER_LINE];
    Channel *c;
    Lines at_count;
    const int is_v2 = line_begins(l, "Corrected");
    double in_words = 0;
    TRY(read_text(r, l, &c, &in_words, err));
    TRY(read_numbers(l, h, &at_count, err));
    const double count = h[3][is_v2 ? 3 : 0];
    if (!(count >= 2))
        return fail(err, STATUS_BAD_DATA, "%s:%d: no usable number of points (2 or more) in '%.*s'", l->path,
                    at_count.number, line_shown(&at_count), at_count.from);
    if (!(h[6][5] > 0))
        return fail(err, STATUS_BAD_DATA, "%s:%d: no usable time step: the header above says %g", l->path, l->number,
                    h[6][5]);
    if (in_words > 0 && fabs(in_words - h[6][5]) > 0.0006) /* three decimals */
        return fail(err, STATUS_BAD_DATA, "%s:%d: a step of %g s in the numbers of the header, %g s in its words",
                    l->path, l->number, h[6][5], in_words);
    const BlockForm form = {.count = count, .dt = h[6][5], .width = WIDTH};
    TRY(record_block(r, l, &form, err));
    if (is_v2 && !lines_skip(l, lines_for(h[3][4]) + lines_for(h[3][5])))
        return fail_too_short(l, "velocities and displacements", err);
    return record_block_ends(l, form.count, err);
}

static Status read(Record *r, Lines *l, const ReadHints *hints, Err *err)
{
    (void)hints;
    while (lines_next_filled(l)) {
        if (!begins_component(l))
            return fail(err, STATUS_BAD_DATA, "%s:%d: '%.*s' does not begin a component", l->path, l->number,
                        line_shown(l), l->from);
        TRY(read_component(r, l, err));
    }
    return STATUS_OK;
}

const MotionFormat FORMAT_GEONET = {"geonet", recognise, read};
