#include "motion/formats/record.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

Status record_add(Record *r, const Lines *l, Row row, Err *err)
{
    if (r->n == r->capacity) {
        const size_t capacity = r->capacity ? 2 * r->capacity : 1024;
        Row *wider = realloc(r->row, capacity * sizeof *wider);
        if (!wider)
            return fail(err, STATUS_NO_MEMORY, "%s: no memory for %zu samples", l->path, capacity);
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
        TRY(record_add(r, &l, from->row[i], err));
    for (size_t k = 0; k < from->n_channels; k++) {
        Channel *c;
        char name[2 * CHANNEL_NAME_MAX], own[CHANNEL_NAME_MAX / 2 + 1], of[CHANNEL_NAME_MAX];
        const char *slash = strrchr(member, '/');
        TRY(record_channel(r, &l, &c, err));
        *c = from->channel[k];
        c->first += offset;
        name_shorten(own, sizeof own - 1, c->name);
        for (int with_folder = 1; with_folder >= 0; with_folder--) {
            name_shorten(of, sizeof of - 4 - strlen(own), with_folder || !slash ? member : slash + 1);
            snprintf(name, sizeof name, "%s%s%s", own, own[0] ? ", " : "", of);
            channel_name(c, name, name + strlen(name));
            if (with_folder)
                memcpy(c->full, c->name, sizeof c->full);
        }
    }
    return STATUS_OK;
}

void channel_name(Channel *c, const char *from, const char *to)
{
    size_t n = 0;
    while (from < to && (isspace((unsigned char)*from) || strchr("\"'", *from)))
        from++;
    while (to > from && (isspace((unsigned char)to[-1]) || strchr("\"'", to[-1])))
        to--;
    for (; from < to && n + 1 < sizeof c->name; from++)
        if (!isspace((unsigned char)*from) || !isspace((unsigned char)from[1])) /* one blank for several */
            c->name[n++] = isspace((unsigned char)*from) ? ' ' : isprint((unsigned char)*from) ? *from : '?';
    c->name[n] = 0;
}

void channel_unit(Channel *c, const char *from, const char *to)
{
    size_t n = 0;
    while (from < to && *from && strchr(" \t=:", *from))
        from++;
    field_strip(&from, &to);
    c->units = units_named(from, to);
    for (; !c->units && from < to && n + 1 < sizeof c->unit; from++)
        c->unit[n++] = isprint((unsigned char)*from) ? *from : '?';
    c->unit[n] = 0;
}

void channel_unit_in(Channel *c, const Lines *l, const char *word)
{
    const char *from = find_word(l->from, l->to, word), *to;
    const int tenths = line_has(l, "g/10");
    c->units = tenths ? 1u << UNIT_G : units_named(l->from, l->to);
    c->scale = tenths ? 0.1 : 1;
    if (!from || c->units)
        return;
    for (from += strlen(word); from < l->to && *from == ' ';)
        from++;
    for (to = from; to < l->to && !strchr(",;([", *to) && strncmp(to, "  ", (size_t)(l->to - to < 2 ? 1 : 2)) != 0;)
        to++;
    while (to > from && strchr(" .", to[-1]))
        to--;
    channel_unit(c, from, to);
}

Status record_channel(Record *r, const Lines *l, Channel **out, Err *err)
{
    if (r->n_channels == CHANNELS_MAX)
        return fail(err, STATUS_BAD_DATA, "%s:%d: more than %d channels", l->path, l->number, CHANNELS_MAX);
    *out = &r->channel[r->n_channels++];
    **out = (Channel){.scale = 1, .first = r->n, .stride = 1};
    return STATUS_OK;
}

void channel_peak(Channel *c, const char *from, const char *to, const char *word, double m_s2)
{
    double x;
    const char *p = find_word(from, to, word);
    if (!p || !number_behind(p, to, word, &x) || x == 0)
        return;
    p += strlen(word);
    while (p < to && strchr(" \t=:(", *p))
        p++;
    double digit = 1;
    int behind_point = 0;
    for (; p < to && strchr("+-.0123456789", *p) && *p; p++) {
        digit /= behind_point ? 10 : 1;
        behind_point |= *p == '.';
    }
    c->peak = fabs(x) * m_s2;
    c->peak_slack = 0.5 * digit * m_s2;
}

int line_is_marker(const Lines *l)
{
    if (line_begins(l, "*"))
        return line_has(l, "end");
    if (line_begins(l, "nan") || line_begins(l, "inf"))
        return 0;
    return isalpha((unsigned char)*l->from) || strchr("/|#&", *l->from) || line_begins(l, "->");
}

int value_behind_colon(const Lines *l, const char **from)
{
    const char *colon = memchr(l->from, ':', (size_t)(l->to - l->from));
    *from = colon ? colon + 1 : NULL;
    return colon != NULL;
}

static Status check_form(const Lines *l, const BlockForm *form, Err *err)
{
    if (!(form->count >= 2 && form->count <= 1e8 && form->count == floor(form->count)))
        return fail(err, STATUS_BAD_DATA, "%s:%d: no usable number of points (2 or more) in '%.*s'", l->path, l->number,
                    line_shown(l), l->from);
    if (!(form->dt > 0 && form->dt <= MOTION_STEP_MAX_S))
        return fail(err, STATUS_BAD_DATA, "%s:%d: no usable time step (above 0, at most %g s) in '%.*s'", l->path,
                    l->number, MOTION_STEP_MAX_S, line_shown(l), l->from);
    return STATUS_OK;
}

Status record_block(Record *r, Lines *l, const BlockForm *form, Err *err)
{
    enum { PER_LINE_MAX = 64 };
    double x[PER_LINE_MAX];
    Channel *c = &r->channel[r->n_channels - 1];
    TRY(check_form(l, form, err));
    const size_t wanted = (size_t)form->count;
    Lines ahead = lines_ahead(l);
    for (c->dt = form->dt; c->n < wanted && ahead.from && !line_is_marker(&ahead); ahead = lines_ahead(l)) {
        size_t n;
        *l = ahead;
        TRY(line_numbers(l, form->width, PER_LINE_MAX, x, &n, err));
        if (n > wanted - c->n)
            return fail(err, STATUS_BAD_DATA, "%s:%d: more samples than the %zu that its header announces", l->path,
                        l->number, wanted);
        for (size_t i = 0; i < n; i++)
            TRY(record_add(r, l, (Row){.a = x[i], .line = l->number}, err));
        c->n += n;
    }
    if (c->n != wanted)
        return fail(err, STATUS_BAD_DATA, "%s:%d: ends after %zu samples, but its header announces %zu", l->path,
                    l->number, c->n, wanted);
    return STATUS_OK;
}

Status record_block_ends(const Lines *l, double count, Err *err)
{
    const Lines ahead = lines_ahead(l);
    if (ahead.from && !line_is_marker(&ahead))
        return fail(err, STATUS_BAD_DATA, "%s:%d: more samples than the %.0f that its header announces", ahead.path,
                    ahead.number, count);
    return STATUS_OK;
}

/* n numbers of a line. */
static Status add_pairs(Record *r, const Lines *l, size_t n, const double x[], Err *err)
{
    Channel *c = &r->channel[r->n_channels - 1];
    if (n % 2)
        return fail(err, STATUS_BAD_DATA, "%s:%d: %zu numbers are not pairs of time and acceleration", l->path,
                    l->number, n);
    for (size_t i = 0; i < n; i += 2)
        TRY(record_add(r, l, (Row){.t = x[i], .a = x[i + 1], .line = l->number, .decimals = 3}, err));
    c->n += n / 2;
    c->digitized = 1;
    return STATUS_OK;
}

Status record_pairs(Record *r, Lines *l, double count, int width, Err *err)
{
    enum { PER_LINE_MAX = 64 };
    double x[PER_LINE_MAX];
    Channel *c = &r->channel[r->n_channels - 1];
    while ((double)c->n < count) {
        size_t n;
        const Lines ahead = lines_ahead(l);
        if (!ahead.from || line_is_marker(&ahead))
            return fail(err, STATUS_BAD_DATA, "%s:%d: ends after %zu samples, but its header announces %.0f", l->path,
                        l->number, c->n, count);
        *l = ahead;
        TRY(line_numbers(l, width, PER_LINE_MAX, x, &n, err));
        if ((double)(c->n + n / 2) > count)
            return fail(err, STATUS_BAD_DATA,
                        "%s:%d: %zu numbers are not pairs of time and acceleration up to the %.0f that its header "
                        "announces",
                        l->path, l->number, n, count);
        TRY(add_pairs(r, l, n, x, err));
    }
    return STATUS_OK;
}

Status fail_too_short(const Lines *l, const char *what, Err *err)
{
    return fail(err, STATUS_BAD_DATA, "%s:%d: the file ends before its %s", l->path, l->number, what);
}

Status header_numbers(Lines *l, int width, size_t n, double x[], Err *err)
{
    for (size_t done = 0, more; done < n; done += more) {
        if (!lines_next(l))
            return fail_too_short(l, "header", err);
        TRY(line_numbers(l, width, n - done, x + done, &more, err));
        if (more == 0)
            return fail(err, STATUS_BAD_DATA, "%s:%d: the header has %zu numbers, %zu are expected", l->path, l->number,
                        done, n);
    }
    return STATUS_OK;
}
