/* UNAM (Mexico), "archivo estandar de aceleracion" (ASA) 2.0: lines "key : value" up to "DATOS DE ACELERACION:", of
 * which, for channels 1 to 6,
 *
 *   ORIENTACION C1-C6 (rumbo;orientacion)  : /V/N90E/N00E         INTERVALO DE MUESTREO, C1-C6 (s) : /0.004/0.004/0.004
 *   NUM. TOTAL DE MUESTRAS, C1-C6          : /17500/17500/17500   ACEL. MAX.(Gal), C1-C6           : /0.47/-1.19/1.22
 *   UNIDADES DE LOS DATOS                  : Gal (cm/s/s)
 *
 * then the names of the columns between two rulers, and a column per channel, 3F10.3. */
#include <math.h>
#include <string.h>

#include "motion/formats/columns.h"

enum { COLUMNS_MAX = 6 };

typedef struct {
    Lines orientation, step, count, peak, units;
} Header;

static int recognise(Lines l)
{
    for (int i = 0; i < 12 && lines_next(&l); i++)
        if (line_begins(&l, "ARCHIVO ESTANDAR DE ACELERACION"))
            return 1;
    return 0;
}

/* The k-th of "/a/b/c", from 0. */
static int item(const Lines *l, int k, const char **from, const char **to)
{
    if (!l->from || !value_behind_colon(l, from))
        return 0;
    for (int i = 0; i <= k; i++) {
        const char *slash = memchr(*from, '/', (size_t)(l->to - *from));
        if (!slash)
            return 0;
        *from = slash + 1;
    }
    const char *next = memchr(*from, '/', (size_t)(l->to - *from));
    *to = next ? next : l->to;
    return 1;
}

static double item_number(const Lines *l, int k)
{
    const char *from, *to;
    double x;
    return item(l, k, &from, &to) && number_behind(from, to, "", &x) ? x : NAN;
}

static Status read_header(Lines *l, Header *h, Err *err)
{
    while (lines_next_filled(l)) {
        if (line_begins(l, "ORIENTACION C1"))
            h->orientation = *l;
        else if (line_begins(l, "INTERVALO DE MUESTREO, C1"))
            h->step = *l;
        else if (line_begins(l, "NUM. TOTAL DE MUESTRAS, C1"))
            h->count = *l;
        else if (line_begins(l, "ACEL. MAX.(Gal), C1"))
            h->peak = *l;
        else if (line_begins(l, "UNIDADES DE LOS DATOS"))
            h->units = *l;
        else if (line_begins(l, "DATOS DE ACELERACION"))
            return STATUS_OK;
    }
    return fail_too_short(l, "line 'DATOS DE ACELERACION:'", err);
}

static Status name_channels(Record *r, const Lines *l, const Header *h, const Columns *columns, Err *err)
{
    for (size_t k = 0; k < columns->width; k++) {
        Channel *c;
        const char *from, *to;
        TRY(record_channel(r, l, &c, err));
        *c = (Channel){.scale = 1,
                       .dt = item_number(&h->step, (int)k),
                       .first = k,
                       .stride = columns->width,
                       .n = columns->n_rows};
        if (h->units.from)
            channel_unit_in(c, &h->units, ":");
        if (item(&h->orientation, (int)k, &from, &to))
            channel_name(c, from, to);
        if (item(&h->peak, (int)k, &from, &to))
            channel_peak(c, from, to, "", 0.01);
        if (!(c->dt > 0 && c->dt <= MOTION_STEP_MAX_S))
            return fail(err, STATUS_BAD_DATA, "%s:%d: no usable step of channel %zu in '%.*s'", l->path, h->step.number,
                        k + 1, h->step.from ? line_shown(&h->step) : 0, h->step.from ? h->step.from : "");
        const double count = item_number(&h->count, (int)k);
        if (count >= 2 && count < (double)columns->n_rows && (double)columns->n_rows <= count + 16) {
            c->n = (size_t)count;
            c->warning = "it has some rows more than its header announces; they are left out";
        } else if (count != (double)columns->n_rows)
            return fail(err, STATUS_BAD_DATA, "%s:%d: %zu rows, but its header announces %g for channel %zu", l->path,
                        l->number, columns->n_rows, count, k + 1);
    }
    return STATUS_OK;
}

static Status read(Record *r, Lines *l, const ReadHints *hints, Err *err)
{
    Header h = {0};
    Columns columns = {0};
    (void)hints;
    TRY(read_header(l, &h, err));
    for (int rulers = 0; rulers < 2;) { /* the names of the columns stand between them */
        if (!lines_next_filled(l))
            return fail_too_short(l, "samples", err);
        rulers += line_begins(l, "---------+");
    }
    while (lines_next_filled(l))
        TRY(columns_add(&columns, r, l, err));
    TRY(columns_check(&columns, l, err));
    if (columns.width > COLUMNS_MAX)
        return fail(err, STATUS_BAD_DATA, "%s:%d: %zu columns; the header describes %d", l->path, l->number,
                    columns.width, COLUMNS_MAX);
    return name_channels(r, l, &h, &columns, err);
}

const MotionFormat FORMAT_UNAM = {"unam", recognise, read};
