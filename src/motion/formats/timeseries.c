/* The ASCII time series of IRIS (ascii2mseed, ObsPy): per segment a line
 *
 *   TIMESERIES NET_STA_LOC_CHA_Q, 6001 samples, 200 sps, 2009-08-24T00:20:03.000000, SLIST, INTEGER, Counts
 *
 * then samples row by row (SLIST), or "time  sample" (TSPAIR). Counts need the gain of the instrument. A segment is a
 * channel; a gap makes two. */
#include <math.h>
#include <string.h>

#include "motion/formats/record.h"

static int begins_series(const Lines *l)
{
    return line_begins(l, "TIMESERIES ");
}

static int recognise_slist(Lines l)
{
    return lines_next(&l) && begins_series(&l) && line_has(&l, "SLIST");
}

static int recognise_tspair(Lines l)
{
    return lines_next(&l) && begins_series(&l) && line_has(&l, "TSPAIR");
}

/* The k-th field between commas, from 0. */
static int field(const Lines *l, int k, const char **from, const char **to)
{
    *from = l->from;
    for (int i = 0; i <= k; i++) {
        const char *comma = memchr(*from, ',', (size_t)(l->to - *from));
        *to = comma ? comma : l->to;
        if (i == k)
            return 1;
        if (!comma)
            return 0;
        *from = comma + 1;
    }
    return 0;
}

static Status read_header(Record *r, Lines *l, Channel **c, BlockForm *form, Err *err)
{
    const char *from, *to;
    double rate = NAN;
    *form = (BlockForm){.count = NAN, .dt = NAN};
    if (!begins_series(l))
        return fail(err, STATUS_BAD_DATA, "%s:%d: '%.*s' does not begin a segment", l->path, l->number, line_shown(l),
                    l->from);
    TRY(record_channel(r, l, c, err));
    if (field(l, 0, &from, &to))
        channel_name(*c, from + strlen("TIMESERIES "), to);
    if (field(l, 1, &from, &to))
        number_behind(from, to, "", &form->count);
    if (field(l, 2, &from, &to))
        number_behind(from, to, "", &rate);
    form->dt = 1 / rate;
    if (!field(l, 6, &from, &to))
        return STATUS_OK;
    (*c)->counts = find_word(from, to, "count") != NULL;
    channel_unit(*c, from, to);
    return STATUS_OK;
}

static Status read_slist(Record *r, Lines *l, const ReadHints *hints, Err *err)
{
    (void)hints;
    while (lines_next_filled(l)) {
        Channel *c;
        BlockForm form;
        TRY(read_header(r, l, &c, &form, err));
        TRY(record_block(r, l, &form, err));
        TRY(record_block_ends(l, form.count, err));
    }
    return STATUS_OK;
}

/* Seconds of the day of "2001-01-01T00:00:00.010000"; NAN: written otherwise. */
static double time_of_day(const char *from, const char *to)
{
    double h, m, s;
    const char *t = memchr(from, 'T', (size_t)(to - from));
    return t && to - t > 8 && t[3] == ':' && t[6] == ':' && number_behind(t + 1, t + 3, "", &h) &&
                   number_behind(t + 4, t + 6, "", &m) && number_behind(t + 7, to, "", &s)
               ? 3600 * h + 60 * m + s
               : NAN;
}

static Status read_tspair(Record *r, Lines *l, const ReadHints *hints, Err *err)
{
    (void)hints;
    while (lines_next_filled(l)) {
        Channel *c;
        BlockForm form;
        double first = NAN, last = NAN;
        TRY(read_header(r, l, &c, &form, err));
        if (!(form.count >= 2 && form.dt > 0 && form.dt <= MOTION_STEP_MAX_S))
            return fail(err, STATUS_BAD_DATA, "%s:%d: no usable number of samples or rate in '%.*s'", l->path,
                        l->number, line_shown(l), l->from);
        for (c->dt = form.dt; (double)c->n < form.count; c->n++) {
            Row row = {0};
            if (!lines_next_filled(l) || begins_series(l))
                return fail(err, STATUS_BAD_DATA, "%s:%d: ends after %zu samples, but its header announces %.0f",
                            l->path, l->number, c->n, form.count);
            const char *p = l->from;
            const char *stop = field_next(l, &p, 0);
            last = time_of_day(l->from, stop);
            first = c->n == 0 ? last : first;
            row.line = l->number;
            TRY(field_number(l, p, l->to, 0, &row.a, err));
            TRY(record_add(r, l, row, err));
        }
        last += last < first ? 24 * 3600 : 0; /* past midnight */
        c->other_dt = isfinite(first) && isfinite(last) ? (last - first) / (double)(c->n - 1) : 0;
    }
    return STATUS_OK;
}

const MotionFormat FORMAT_SLIST = {"slist", recognise_slist, read_slist};
const MotionFormat FORMAT_TSPAIR = {"tspair", recognise_tspair, read_tspair};
