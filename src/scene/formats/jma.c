/* JMA acceleration waveforms as CSV: lines "KEY=value", the first of which is SITE CODE, then the names of the columns
 * (NS,EW,UD) and one line per sample.
 *
 *   SAMPLING RATE= 100Hz      UNIT  = gal(cm/s/s)
 */
#include <math.h>
#include <string.h>

#include "scene/formats/columns.h"

typedef struct {
    double hertz;
    Channel unit; /* units and unit of every channel */
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

static Status name_channels(Record *r, const Header *h, const Columns *columns, Err *err)
{
    const char *p = h->names.from, *from, *to;
    while (column_name(&h->names, &p, &from, &to)) {
        Channel *c;
        TRY(record_channel(r, &h->names, &c, err));
        *c = (Channel){.scale = 1,
                       .units = h->unit.units,
                       .dt = 1 / h->hertz,
                       .first = r->n_channels - 1,
                       .stride = columns->width,
                       .n = columns->n_rows};
        memcpy(c->unit, h->unit.unit, sizeof c->unit);
        channel_name(c, from, to);
    }
    if (r->n_channels != columns->width)
        return fail(err, STATUS_BAD_DATA, "%s:%d: names %zu columns, but %zu follow", h->names.path, h->names.number,
                    r->n_channels, columns->width);
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
    return name_channels(r, &h, &columns, err);
}

const MotionFormat FORMAT_JMA = {"jma", recognise, read};
