/* JMA acceleration waveforms as CSV: lines "KEY=value", the first of which is SITE CODE, then the names of the columns
 * (NS,EW,UD) and one line per sample.
 *
 *   SAMPLING RATE= 100Hz      UNIT  = gal(cm/s/s)
 */
#include <math.h>
#include <string.h>

#include "motion/formats/columns.h"

typedef struct {
    double hertz;
    Channel unit; /* units, unit and dt of every channel */
    Lines names;
} Header;

static int recognise(Lines l)
{
    return lines_next(&l) && line_begins(&l, "SITE CODE");
}

static Status read_header(Lines *l, Header *h, Err *err)
{
    *h = (Header){.hertz = NAN};
    do {
        if (line_begins(l, "SAMPLING RATE"))
            number_behind(l->from, l->to, "RATE", &h->hertz);
        else if (line_begins(l, "UNIT"))
            channel_unit(&h->unit, l->from + strlen("UNIT"), l->to);
        if (!lines_next_filled(l))
            return fail_too_short(l, "names of the columns", err);
    } while (memchr(l->from, '=', (size_t)(l->to - l->from)));
    h->names = *l;
    if (!(h->hertz > 0 && h->hertz <= 1e5))
        return fail(err, STATUS_BAD_DATA, "%s:%d: no usable SAMPLING RATE above this line", l->path, l->number);
    return STATUS_OK;
}

static Status read(Record *r, Lines *l, const ReadHints *hints, Err *err)
{
    Header h;
    Columns columns = {0};
    (void)hints;
    lines_next(l);
    TRY(read_header(l, &h, err));
    while (lines_next_filled(l))
        TRY(columns_add(&columns, r, l, err));
    TRY(columns_check(&columns, l, err));
    h.unit.dt = 1 / h.hertz;
    return columns_name(&columns, r, &h.names, &h.unit, err);
}

const MotionFormat FORMAT_JMA = {"jma", recognise, read};
