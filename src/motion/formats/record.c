#include "motion/formats/record.h"

#include <stdarg.h>

/* ---- rows -------------------------------------------------------------------------------------------------------- */

Status record_add(Record *r, Row row, Err *err)
{
    if (r->n == r->capacity) {
        const size_t capacity = r->capacity ? 2 * r->capacity : 1024;
        Row *wider = realloc(r->row, capacity * sizeof *wider);
        if (!wider)
            return fail_memory(err, capacity, "samples");
        r->row = wider;
        r->capacity = capacity;
    }
    r->row[r->n++] = row;
    return STATUS_OK;
}

void record_free(Record *r)
{
    free(r->row);
    r->row = NULL;
    r->n = r->capacity = r->n_channels = 0;
}

/* Digits behind the decimal point of a number as printed, less its exponent. */
static int count_decimals(Cell c)
{
    int n = 0, behind_point = 0;
    const char *p = c.from;
    double exponent;
    for (; p < c.to && (is_digit(*p) || strchr("+-.,", *p)); p++) {
        behind_point |= *p == '.' || *p == ',';
        n += behind_point && is_digit(*p);
    }
    return p < c.to && number_behind(p + 1, c.to, "", &exponent) ? n - (int)fmax(fmin(exponent, 400), -400) : n;
}

Status record_add_cells(Record *r, Lines *l, int with_comma, size_t *n, Err *err)
{
    *n = 0;
    for (const char *p = l->from; p < l->to; ++*n) {
        const Cell c = cell_next(&p, l->to, with_comma ? " ;" : " ,;");
        Row row = {.line = l->number, .decimals = count_decimals(c)};
        TRY(line_number(l, c, with_comma || c.is_quoted, &row.a, err));
        if (with_comma || !memchr(c.from, ',', c.to - c.from))
            TRY(lines_note_mark(l, c, err));
        if (*n > CHANNELS_MAX)
            return fail_at(err, l, "more than %d channels", CHANNELS_MAX);
        TRY(record_add(r, row, err));
    }
    return STATUS_OK;
}

void record_set_times(Record *r, size_t first, size_t width, size_t k)
{
    for (size_t i = first; i + width <= r->n; i += width)
        for (size_t j = i; j < i + width; j++) {
            r->row[j].t = r->row[i + k].a;
            r->row[j].decimals = r->row[i + k].decimals;
        }
}

/* ---- channels ---------------------------------------------------------------------------------------------------- */

void name_shorten(char *out, size_t room, const char *name)
{
    const size_t n = strlen(name), head = (room - 2) / 3;
    if (n <= room)
        memcpy(out, name, n + 1);
    else
        snprintf(out, room + 1, "%.*s..%s", (int)head, name, name + n - (room - 2 - head));
}

Status record_append(Record *r, const Record *from, const char *path, const char *member, Err *err)
{
    const Lines l = {.path = path};
    const size_t offset = r->n;
    for (size_t i = 0; i < from->n; i++)
        TRY(record_add(r, from->row[i], err));
    for (size_t k = 0; k < from->n_channels; k++) {
        Channel *c = NULL;
        char own[CHANNEL_NAME_MAX / 2 + 1], of[CHANNEL_NAME_MAX];
        TRY(record_channel(r, &l, &c, err));
        *c = from->channel[k];
        c->first += offset;
        name_shorten(own, sizeof own - 1, c->name);
        name_shorten(of, sizeof of - 4 - strlen(own), member);
        channel_named(c, "%s%s%s", own, own[0] ? ", " : "", of);
    }
    return STATUS_OK;
}

Status record_channel(Record *r, const Lines *l, Channel **out, Err *err)
{
    if (r->n_channels == CHANNELS_MAX)
        return fail_at(err, l, "more than %d channels", CHANNELS_MAX);
    *out = &r->channel[r->n_channels++];
    **out = (Channel){.scale = 1, .first = r->n, .stride = 1};
    return STATUS_OK;
}

/* from..to in at most `room` bytes with the NUL: one blank for several, ? for what is no ASCII. */
static void copy_plain(char *out, size_t room, const char *from, const char *to)
{
    size_t n = 0;
    for (; from < to && n + 1 < room; from++)
        if (!is_blank(*from))
            out[n++] = *from >= ' ' && *from <= '~' ? *from : '?';
        else if (n && from + 1 < to && !is_blank(from[1]))
            out[n++] = ' ';
    out[n] = 0;
}

void channel_name(Channel *c, const char *from, const char *to)
{
    while (from < to && (is_blank(*from) || strchr("\"'", *from)))
        from++;
    while (to > from && (is_blank(to[-1]) || strchr("\"'", to[-1])))
        to--;
    copy_plain(c->name, sizeof c->name, from, to);
}

void channel_named(Channel *c, const char *format, ...)
{
    char name[4 * CHANNEL_NAME_MAX];
    va_list list;
    va_start(list, format);
    vsnprintf(name, sizeof name, format, list);
    va_end(list);
    channel_name(c, name, name + strlen(name));
}

void channel_unit(Channel *c, const char *from, const char *to)
{
    while (from < to && strchr(" \t=:", *from) && *from)
        from++;
    const char *word = from, *all;
    while (word < to && !strchr(" \t,;([", *word))
        word++;
    for (all = from; all < to && !strchr(",;([", *all) && strncmp(all, "  ", to - all < 2 ? 1 : 2) != 0;)
        all++;
    for (int i = 0; i < 2; i++) {
        const char **end = i ? &all : &word;
        while (*end > from && strchr(" .", (*end)[-1]))
            --*end;
        const int tenths = text_is(EQUALS, from, *end, "g/10"), mm = text_is(EQUALS, from, *end, "mm/s/s");
        c->unit = tenths ? UNIT_G : mm ? UNIT_CM_S2 : unit_of(from, *end);
        if (tenths || mm)
            c->scale *= 0.1;
        if (c->unit)
            return;
    }
    c->counts = text_is(HOLDS, from, all, "count|cuenta");
    copy_plain(c->stated, sizeof c->stated, from, all);
}

/* ---- samples ----------------------------------------------------------------------------------------------------- */

int line_is_marker(const Lines *l)
{
    if (*l->from == '*')
        return line_has(l, "end");
    return (is_letter(*l->from) && !line_begins(l, "nan|inf")) || strchr("/|#&", *l->from) || line_begins(l, "->");
}

int line_has_letters(const Lines *l)
{
    for (const char *p = l->from; p < l->to; p++)
        if (is_letter(*p) && !strchr("eEdD", *p))
            return 1;
    return 0;
}

Status record_block(Record *r, Lines *l, double count, int width, size_t lines_behind, Err *err)
{
    enum { PER_LINE_MAX = 64 };
    double x[PER_LINE_MAX];
    Channel *c = &r->channel[r->n_channels - 1];
    const double dt = c->dt;
    const int is_pair = c->digitized || c->is_timed;
    const size_t each = is_pair ? 2 : 1;
    if (!(count >= 2 && count <= 1e8 && count == floor(count)))
        return fail_at(err, l, "no usable number of points (2 or more) above this line");
    if (!c->digitized && !(dt > 0 && dt <= MOTION_STEP_MAX_S))
        return fail_at(err, l, "no usable time step (above 0, at most %g s) above this line", MOTION_STEP_MAX_S);
    const size_t wanted = (size_t)count;
    c->dt = is_pair ? 0 : dt;
    c->other_dt = c->is_timed ? dt : 0;
    Lines ahead = lines_ahead(l);
    for (; c->n < wanted && ahead.from && !line_is_marker(&ahead); ahead = lines_ahead(l)) {
        size_t n;
        *l = ahead;
        TRY(line_numbers(l, width, PER_LINE_MAX, x, &n, err));
        if (n % each)
            return fail_at(err, l, "%zu numbers are not pairs of time and acceleration", n);
        for (size_t i = 0; i < n; i += each)
            TRY(record_add(r, (Row){x[i], x[i + each - 1], l->number, c->is_timed ? 6 : 3}, err));
        c->n += n / each;
    }
    if (c->n < wanted)
        return fail_at(err, l, "ends after %zu samples, but its header announces %zu", c->n, wanted);
    for (; lines_behind > 0; lines_behind--)
        if (!lines_next(l) || line_has_letters(l))
            return fail_at(err, l, "velocities and displacements end before the number of the header");
    ahead = lines_ahead(l);
    if (c->n > wanted || (!c->digitized && ahead.from && !line_is_marker(&ahead) && !line_has_letters(&ahead)))
        return fail_at(err, c->n > wanted ? l : &ahead, "more samples than the %zu that its header announces", wanted);
    return STATUS_OK;
}

Status fail_too_short(const Lines *l, const char *what, Err *err)
{
    return fail_at(err, l, "the file ends before its %s", what);
}

Status header_numbers(Lines *l, int width, size_t n, double x[], Err *err)
{
    for (size_t done = 0, more; done < n; done += more) {
        if (!lines_next(l))
            return fail_too_short(l, "header", err);
        TRY(line_numbers(l, width, n - done, x + done, &more, err));
        if (more == 0)
            return fail_at(err, l, "the header has %zu numbers, %zu are expected", done, n);
    }
    return STATUS_OK;
}
