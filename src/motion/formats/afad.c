/* AFAD (Turkey), the text files of the National Strong-Motion Network: line 1 "STRONG GROUND MOTION RECORDS OF
 * TURKIYE", lines "key : value", of which
 *
 *   NUMBER OF DATA          : 28683
 *   SAMPLING INTERVAL (sec) : 0.01
 *   RAW PGA VALUES (gal)    : (N-S) 13.200332 (E-W) 12.163827 (U-D) 9.840572
 *
 * a line of the three names, then rows of three accelerations in gal. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "motion/formats/columns.h"

typedef struct {
    Lines count, step, peaks, names;
} Header;

static int recognise(Lines l)
{
    return lines_next(&l) && line_begins(&l, "STRONG GROUND MOTION RECORDS OF T");
}

static Status read_header(Lines *l, Header *h, Err *err)
{
    while (lines_next_filled(l)) {
        if (line_begins(l, "NUMBER OF DATA"))
            h->count = *l;
        else if (line_begins(l, "SAMPLING INTERVAL"))
            h->step = *l;
        else if (line_has(l, "PGA VALUES"))
            h->peaks = *l;
        else if (line_begins(l, "N-S") || line_begins(l, "E-W") || line_begins(l, "U-D")) {
            h->names = *l;
            return STATUS_OK;
        }
    }
    return fail_too_short(l, "names of the columns (N-S E-W U-D)", err);
}

/* The number behind the first colon; NAN: none. */
static double value_of(const Lines *l)
{
    const char *from;
    double x;
    return l->from && value_behind_colon(l, &from) && number_behind(from, l->to, "", &x) ? x : NAN;
}

static void take_peaks(Record *r, const Lines *peaks)
{
    for (size_t k = 0; k < r->n_channels && peaks->from && line_has(peaks, "gal"); k++) {
        char word[CHANNEL_NAME_MAX + 2];
        snprintf(word, sizeof word, "(%s)", r->channel[k].name);
        channel_peak(&r->channel[k], peaks->from, peaks->to, word, 0.01);
    }
}

static Status read(Record *r, Lines *l, const ReadHints *hints, Err *err)
{
    Header h = {0};
    Columns columns = {0};
    (void)hints;
    TRY(read_header(l, &h, err));
    const double step = value_of(&h.step), count = value_of(&h.count);
    if (!(step > 0 && step <= MOTION_STEP_MAX_S))
        return fail(err, STATUS_BAD_DATA, "%s:%d: no usable SAMPLING INTERVAL above this line", l->path, l->number);
    while (lines_next_filled(l))
        TRY(columns_add(&columns, r, l, err));
    TRY(columns_check(&columns, l, err));
    if (count != (double)columns.n_rows)
        return fail(err, STATUS_BAD_DATA, "%s:%d: %zu rows, but its header announces %.0f", l->path, l->number,
                    columns.n_rows, count);
    TRY(columns_name(&columns, r, &h.names, &(Channel){.units = 1u << UNIT_CM_S2, .dt = step}, err));
    take_peaks(r, &h.peaks);
    return STATUS_OK;
}

const MotionFormat FORMAT_AFAD = {"afad", recognise, read};
