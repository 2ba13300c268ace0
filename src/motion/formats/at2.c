/* PEER strong motion data base, *.AT2: four lines of header (now and then one or two more), then the samples, as a rule
 * 5E15.7. Line 3 names the quantity and its unit; line 4 has the number of points and the step in one of two forms,
 *
 *   NPTS=  3930, DT=   .0050 SEC                 3930    0.0050    NPTS, DT
 */
#include <math.h>
#include <string.h>

#include "motion/formats/record.h"

static int is_title(const Lines *l)
{
    return line_has(l, "TIME SERIES") || line_has(l, "TIME HISTORY");
}

/* Below a title the step may be missing: that is a fault of this format, not another format. */
static int is_npts_line(const Lines *l, int has_title)
{
    return l->from < l->to && !strchr("#%!/", *l->from) && line_has(l, "NPTS") && (has_title || line_has(l, "DT"));
}

static int recognise(Lines l)
{
    int has_title = 0;
    while (l.number < 8 && lines_next(&l)) {
        if (is_npts_line(&l, has_title))
            return 1;
        has_title = has_title || is_title(&l);
    }
    return 0;
}

static BlockForm read_npts_line(const Lines *l)
{
    BlockForm form = {.count = NAN, .dt = NAN, .width = 15};
    double x[2];
    size_t n;
    Err ignored = {0};
    if (memchr(l->from, '=', (size_t)(l->to - l->from))) {
        number_behind(l->from, l->to, "NPTS", &form.count);
        if (quantity_behind(l->from, l->to, "DT", 0, &form.dt) < 0)
            form.dt = NAN;
    } else if (line_numbers(l, 0, 2, x, &n, &ignored) == STATUS_OK && n == 2) {
        form.count = x[0];
        form.dt = x[1];
    }
    return form;
}

/* "UNITS OF G": the words before the unit are no part of what a message names. */
static void take_unit(Channel *c, const char *from, const char *to)
{
    const unsigned before = c->units;
    const char *of = find_word(from, to, " OF ");
    channel_unit(c, of && !units_named(from, to) ? of + 4 : from, to);
    c->units |= before;
}

static Status read(Record *r, Lines *l, const ReadHints *hints, Err *err)
{
    Channel *c;
    Channel unit = {0};
    int has_title = 0;
    (void)hints;
    while (lines_next(l) && !is_npts_line(l, has_title)) {
        has_title = has_title || is_title(l);
        if (line_has(l, "VELOCITY TIME") || line_has(l, "DISPLACEMENT TIME"))
            return fail(err, STATUS_BAD_DATA, "%s:%d: not an acceleration: '%.*s'", l->path, l->number, line_shown(l),
                        l->from);
        if (line_has(l, "UNIT"))
            take_unit(&unit, find_word(l->from, l->to, "UNIT"), l->to);
        else if (line_has(l, "ACCELERATION") && find_word(l->from, l->to, " IN "))
            take_unit(&unit, find_word(l->from, l->to, " IN "), l->to);
    }
    const BlockForm form = read_npts_line(l);
    TRY(record_channel(r, l, &c, err));
    c->units = unit.units;
    memcpy(c->unit, unit.unit, sizeof c->unit);
    TRY(record_block(r, l, &form, err));
    return record_block_ends(l, form.count, err);
}

const MotionFormat FORMAT_AT2 = {"at2", recognise, read};
