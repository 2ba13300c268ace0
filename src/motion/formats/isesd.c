/* Internet Site for European Strong-Motion Data and its CD-ROM (N. Ambraseys, P. Smit et al., 2000; "Datafile Format"
 * at http://isesd.hi.is): lines "key: value", of which the first is "file:",
 *
 *   orientation of transducer: NS     sampling period: 0.010000s     number of samples: 3043     units: m/s*s, m/s & s
 *
 * a line "-> corrected acceleration time histories", the samples, then "-> ..." of velocity and displacement. The
 * unequal steps of uncorrected records from film are not described there and are refused. */
#include <math.h>
#include <string.h>

#include "motion/formats/record.h"

static int recognise(Lines l)
{
    int lines = 0, known = 0;
    if (!lines_next(&l) || !line_begins(&l, "file:"))
        return 0;
    while (lines++ < 6 && lines_next(&l))
        known |= line_begins(&l, "earthquake code:") || line_begins(&l, "waveform code:");
    return known;
}

static int key(const Lines *l, const char *word, const char **from)
{
    return line_begins(l, word) && value_behind_colon(l, from);
}

static Status read_header(Lines *l, Channel *c, BlockForm *form, Err *err)
{
    const char *from;
    while (lines_next_filled(l) && !line_begins(l, "->")) {
        if (key(l, "orientation of transducer", &from))
            channel_name(c, from, l->to);
        else if (key(l, "sampling period", &from))
            number_behind(from, l->to, "", &form->dt);
        else if (key(l, "number of samples", &from))
            number_behind(from, l->to, "", &form->count);
        else if (key(l, "units", &from)) { /* of acceleration, velocity and displacement */
            const char *comma = memchr(from, ',', (size_t)(l->to - from));
            channel_unit(c, from, comma ? comma : l->to);
        }
    }
    return line_begins(l, "->") ? STATUS_OK : fail_too_short(l, "line '-> ... acceleration time histories'", err);
}

static Status read(Record *r, Lines *l, const ReadHints *hints, Err *err)
{
    Channel *c;
    BlockForm form = {.count = NAN, .dt = NAN};
    (void)hints;
    TRY(record_channel(r, l, &c, err));
    TRY(read_header(l, c, &form, err));
    if (!line_has(l, "acceleration"))
        return fail(err, STATUS_BAD_DATA, "%s:%d: not an acceleration: '%.*s'", l->path, l->number, line_shown(l),
                    l->from);
    if (!(form.dt > 0))
        return fail(err, STATUS_BAD_DATA,
                    "%s: an ISESD record without equal steps (no 'sampling period'); its layout is not published, take "
                    "the corrected record",
                    l->path);
    TRY(record_block(r, l, &form, err));
    const Lines ahead = lines_ahead(l);
    return ahead.from && line_begins(&ahead, "->") ? STATUS_OK : record_block_ends(l, form.count, err);
}

const MotionFormat FORMAT_ISESD = {"isesd", recognise, read};
