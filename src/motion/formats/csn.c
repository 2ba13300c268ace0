/* CSN (Chile), text files of its data base of strong motion: comment lines "# key: value", of which the first is the
 * time of the first sample, then one sample per line.
 *
 *   # Tiempo de Origen: 2010-01-01T00:00:00.000000Z     # Tasa de muestreo: 200.0 muestras/seg
 *   # Numero total de muestras: 43800                   # Estacion: A02F Componente: HNN
 *   # Latitud: -23.1 Longitud: -70.4                    # Unidades: m/seg/seg
 *
 * No description of it was found: the layout is that of two programs that read these files. */
#include <math.h>

#include "motion/formats/record.h"

typedef struct {
    double count, hertz;
    Lines station, unit;
} Header;

static int recognise(Lines l)
{
    if (!lines_next(&l) || !line_begins(&l, "# Tiempo"))
        return 0;
    for (int i = 0; i < 8 && lines_next(&l); i++)
        if (line_begins(&l, "# Tasa de muestreo"))
            return 1;
    return 0;
}

static void take(const Lines *l, Header *h)
{
    const char *from;
    if (!value_behind_colon(l, &from))
        return;
    if (line_begins(l, "# Tasa de muestreo"))
        number_behind(from, l->to, "", &h->hertz);
    else if (line_begins(l, "# Numero"))
        number_behind(from, l->to, "", &h->count);
    else if (line_begins(l, "# Unidades"))
        h->unit = *l;
    else if (line_begins(l, "# Estacion"))
        h->station = *l;
}

/* "Estacion: A02F Componente: HNN": what stands behind the last colon. */
static void name_channel(Channel *c, const Lines *station)
{
    const char *from = station->to;
    while (from > station->from && from[-1] != ':')
        from--;
    channel_name(c, from, station->to);
}

static Status read(Record *r, Lines *l, const ReadHints *hints, Err *err)
{
    Channel *c;
    const char *unit;
    Header h = {.count = NAN, .hertz = NAN};
    (void)hints;
    for (Lines ahead = lines_ahead(l); ahead.from && *ahead.from == '#'; ahead = lines_ahead(l)) {
        *l = ahead;
        take(l, &h);
    }
    TRY(record_channel(r, l, &c, err));
    if (h.station.from)
        name_channel(c, &h.station);
    if (h.unit.from && value_behind_colon(&h.unit, &unit))
        channel_unit(c, unit, h.unit.to);
    TRY(record_block(r, l, &(BlockForm){.count = h.count, .dt = 1.0 / h.hertz}, err));
    return record_block_ends(l, h.count, err);
}

const MotionFormat FORMAT_CSN = {"csn", recognise, read};
