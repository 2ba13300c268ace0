/* CWB, now CWA (Taiwan): comment lines "#Key: value", of which the first is "#Earthquake Information",
 *
 *   #SampleRate(Hz): 50     #AmplitudeUnit:  gal. DCoffset(corr)     #AmplitudeMAX. U:    0.658~   -0.837
 *   #DataSequence: Time U(+); N(+); E(+)
 *
 * then rows of time and three accelerations, 4F10.3. */
#include <math.h>
#include <string.h>

#include "motion/formats/columns.h"

enum { COMPONENTS_MAX = 8 };

typedef struct {
    double hertz;
    Channel unit; /* units and unit of every channel */
    Lines sequence, peak[COMPONENTS_MAX];
    int n_peaks;
} Header;

static int recognise(Lines l)
{
    return lines_next(&l) && line_begins(&l, "#Earthquake Information");
}

static void take(const Lines *l, Header *h)
{
    if (line_begins(l, "#SampleRate(Hz)"))
        number_behind(l->from, l->to, "(Hz)", &h->hertz);
    else if (line_begins(l, "#AmplitudeUnit"))
        channel_unit(&h->unit, l->from + strlen("#AmplitudeUnit"), l->to);
    else if (line_begins(l, "#AmplitudeMAX.") && h->n_peaks < COMPONENTS_MAX)
        h->peak[h->n_peaks++] = *l;
    else if (line_begins(l, "#DataSequence:"))
        h->sequence = *l;
}

/* The larger magnitude of "0.658~ -0.837" of the component. */
static void take_peak(Channel *c, const Header *h)
{
    for (int i = 0; i < h->n_peaks; i++) {
        const Lines *l = &h->peak[i];
        const char *name = l->from + strlen("#AmplitudeMAX."), *wave = memchr(l->from, '~', (size_t)(l->to - l->from));
        while (name < l->to && *name == ' ')
            name++;
        if (*name != c->name[0] || !wave)
            continue;
        Channel low = {0};
        channel_peak(c, name, wave, ":", 0.01);
        channel_peak(&low, wave, l->to, "~", 0.01);
        if (low.peak > c->peak) {
            c->peak = low.peak;
            c->peak_slack = low.peak_slack;
        }
    }
}

/* Of the first column, the times [s]; 0: there are none. */
static double mean_step(const Record *r, const Columns *columns)
{
    const size_t last = columns->n_rows - 1;
    return columns->n_rows > 1 ? (r->row[last * columns->width].a - r->row[0].a) / (double)last : 0;
}

/* "Time U(+); N(+); E(+)": a channel for each word but the first. */
static Status name_channels(Record *r, const Header *h, const Columns *columns, Err *err)
{
    const char *p = h->sequence.from + strlen("#DataSequence:");
    for (size_t k = 0; p < h->sequence.to; k++) {
        while (p < h->sequence.to && strchr(" ;", *p))
            p++;
        const char *from = p;
        while (p < h->sequence.to && !strchr(" ;", *p))
            p++;
        if (p == from || k == 0)
            continue;
        Channel *c;
        TRY(record_channel(r, &h->sequence, &c, err));
        *c = (Channel){.scale = 1,
                       .units = h->unit.units,
                       .dt = 1 / h->hertz,
                       .other_dt = mean_step(r, columns),
                       .first = k,
                       .stride = columns->width,
                       .n = columns->n_rows};
        memcpy(c->unit, h->unit.unit, sizeof c->unit);
        const char *sign = memchr(from, '(', (size_t)(p - from));
        channel_name(c, from, sign ? sign : p);
        take_peak(c, h);
    }
    return r->n_channels + 1 == columns->width
               ? STATUS_OK
               : fail(err, STATUS_BAD_DATA, "%s:%d: names %zu columns beside the time, but %zu follow",
                      h->sequence.path, h->sequence.number, r->n_channels, columns->width - 1);
}

static Status read(Record *r, Lines *l, const ReadHints *hints, Err *err)
{
    Header h = {.hertz = NAN};
    Columns columns = {0};
    (void)hints;
    while (lines_next_filled(l))
        if (*l->from == '#')
            take(l, &h);
        else
            TRY(columns_add(&columns, r, l, err));
    TRY(columns_check(&columns, l, err));
    if (!(h.hertz > 0 && h.hertz <= 1e5) || !h.sequence.from || columns.width < 2)
        return fail(err, STATUS_BAD_DATA, "%s: no usable #SampleRate(Hz) or #DataSequence in its header", l->path);
    return name_channels(r, &h, &columns, err);
}

const MotionFormat FORMAT_CWB = {"cwb", recognise, read};
