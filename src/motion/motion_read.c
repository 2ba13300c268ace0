#include "motion/motion_read.h"

#include <ctype.h>

#include "base/hash.h"
#include "motion/formats/record.h"

/* The strongest ground acceleration ever recorded is near 4 g; far beyond that a unit is wrong (El Centro in cm/s2
 * taken for m/s2 shows 35 g). */
static const double LARGEST_PEAK_G = 20.0;

static const BinaryFormat *const BINARY_FORMATS[] = {&FORMAT_MSEED, &FORMAT_SAC, &FORMAT_SIMCENTER};
enum { ARCHIVES_DEEP = 2 };

/* An earthquake ends where it began: a mean above this share of the peak is the zero of the recorder. */
static const double OFFSET_MAX = 0.2;

static const char *const UNIT_NAMES[] = {MOTION_UNIT_LIST(CHOICE_WORD)};

/* A peak that misses the header's by more belongs to other samples; by a fifth of it: rounded, or filtered once
 * more. */
static const double PEAK_ERROR_MAX = 0.05;

/* ---- which unit ----------------------------------------------------------------------------------------------- */

Status motion_unit_parse(const char *text, MotionUnit *unit, double *counts_per_m_s2, Err *err)
{
    const size_t length = strcspn(text, "=");
    char *end = NULL;
    *counts_per_m_s2 = text[length] ? strtod(text + length + 1, &end) : 0;
    for (*unit = UNIT_FROM_FILE; *text && *unit <= UNIT_COUNTS; ++*unit)
        if (strlen(UNIT_NAMES[*unit]) == length && strncmp(text, UNIT_NAMES[*unit], length) == 0)
            break;
    if (*unit == UNIT_COUNTS && text[length] && !*end && *counts_per_m_s2 > 0 && *counts_per_m_s2 <= 1e15)
        return STATUS_OK;
    if (*unit < UNIT_COUNTS && !text[length])
        return STATUS_OK;
    static const char *const WORDS[] = {"from_file", "m_s2", "cm_s2", "g", "counts=VALUE"};
    return fail_no_word(err, STATUS_BAD_DATA, "motion.unit", text, "unit", WORDS, 5);
}

/* The one unit that file and setting agree on, and what a sample of the file is times to be in m/s2. */
static Status settle_unit(const char *path, const Channel *c, const MotionHow *how, MotionUnit *unit, double *to_m_s2,
                          Err *err)
{
    *unit = how->unit ? how->unit : c->unit;
    if (!*unit && c->counts)
        return bad_data(
            err,
            "%s: holds numbers without a unit, as a rule counts: set motion.unit (--unit) to counts=VALUE, the counts "
            "per m/s2 of the instrument, or to m_s2, cm_s2 or g",
            path);
    const int is_word = !is_quantity(c->stated, c->stated + strlen(c->stated)); /* "adc" may be counts, kN may not */
    if (c->stated[0] && !c->counts && !(is_word && how->unit == UNIT_COUNTS))
        return bad_data(err,
                        "%s: the unit '%s' of its acceleration is not known; %sconvert it to m/s2, cm/s2 or g and "
                        "write that unit in its place",
                        path, c->stated,
                        is_word ? "set motion.unit (--unit) to counts=VALUE, its counts per m/s2, or " : "");
    if (!*unit)
        return bad_data(
            err, "%s: does not say the unit of its acceleration; set motion.unit (--unit) to m_s2, cm_s2 or g", path);
    if (c->unit && *unit != c->unit)
        return bad_data(err, "%s: motion.unit is %s, but the file says %s; leave motion.unit at from_file", path,
                        UNIT_NAMES[*unit], UNIT_NAMES[c->unit]);
    *to_m_s2 = c->scale * UNIT_IN_M_S2[*unit] / (*unit == UNIT_COUNTS ? how->counts_per_m_s2 : 1);
    return STATUS_OK;
}

/* ---- which channel -------------------------------------------------------------------------------------------- */

/* Is the channel an acceleration, or does its name say velocity, displacement or spectrum? */
static int is_acceleration(const Channel *c)
{
    const char *p = c->name, *end = p + strlen(p);
    if (text_is(BEGINS, p, end, "vel|dis"))
        return 0;
    if (strcmp(c->format, "csv") != 0) /* SA may be a station elsewhere */
        return 1;
    if (text_is(BEGINS, p, end, "period|freq") || text_is(HOLDS, p, end, "spectr|fourier"))
        return 0;
    for (; p < end; p += p < end) { /* "Sa(g)", "NS PSA" */
        const char *word = p;
        while (p < end && (is_letter(*p) || is_digit(*p)))
            p++;
        if (text_is(EQUALS, word, p, "sa|psa|psv|fas"))
            return 0;
    }
    return 1;
}

/* Letters and digits only, in small letters, so that N-S is NS and "360 Deg" is 360deg. */
static void plain_name(const char *name, char plain[64])
{
    size_t n = 0;
    for (; *name && n < 63; name++)
        if (is_letter(*name) || is_digit(*name))
            plain[n++] = (char)tolower((unsigned char)*name);
    plain[n] = 0;
}

/* The only channel of that name, of that number, or whose name begins so. A name comes before a number, for azimuths
 * are names. */
static const Channel *find_channel(const Record *r, const char *wanted)
{
    char want[64], have[64], *end;
    const long number = strtol(wanted, &end, 10);
    plain_name(wanted, want);
    for (int exactly = 1; exactly >= 0; exactly--) {
        const Channel *found = NULL;
        int n = 0;
        for (size_t i = 0; i < r->n_channels; i++) {
            plain_name(r->channel[i].name, have);
            if (want[0] && strncmp(want, have, exactly ? sizeof want : strlen(want)) == 0) {
                found = &r->channel[i];
                n++;
            }
        }
        if (n == 1)
            return found;
        if (exactly && end != wanted && !*end && number >= 1 && number <= (long)r->n_channels)
            return &r->channel[number - 1];
    }
    return NULL;
}

/* The channel that is wanted, or the only acceleration where none is named. */
static Status choose_channel(const Record *r, const char *path, const Channel **out, Err *err)
{
    enum { LIST_MAX = 360 }; /* of the 480 bytes of Err */
    const char *wanted = r->how->channel;
    const size_t n = r->n_channels, each = n ? (LIST_MAX - 16) / n : 0;
    const int shown = each > 8 + CHANNEL_NAME_MAX ? CHANNEL_NAME_MAX : each > 24 ? (int)each - 8 : 16;
    char list[LIST_MAX] = "";
    int n_accelerations = 0, is_full = 0;
    for (size_t i = 0; i < n; i++) {
        if (is_acceleration(&r->channel[i])) {
            *out = &r->channel[i];
            n_accelerations++;
        }

        /* "1 'NS', 2 'EW'", names shortened where there are too many for a message. */
        char name[CHANNEL_NAME_MAX + 1];
        name_shorten(name, shown, r->channel[i].name);
        if (is_full)
            continue;
        text_join(list, LIST_MAX, ", ", name[0] ? "%zu '%s'" : "%zu (no name)", i + 1, name);
        is_full = strlen(list) + shown + 24 >= LIST_MAX;
        if (i + 1 < n && is_full)
            text_join(list, LIST_MAX, ", ", "... %zu", n);
    }
    if (wanted)
        *out = find_channel(r, wanted);
    else if (n_accelerations != 1)
        return n_accelerations == 0
                   ? bad_data(err, "%s: none of its channels is an acceleration: %s", path, list)
                   : bad_data(
                         err,
                         "%s: holds %zu channels: %s; choose one by motion.channel (--set motion.channel=NAME), or "
                         "behind the file, 'FILE channel=NAME'",
                         path, n, list);
    if (!*out)
        return bad_data(err, "%s: motion.channel '%.40s' is not exactly one of its channels: %s", path, wanted, list);
    if (!is_acceleration(*out))
        return bad_data(err, "%s: its channel '%s' is not an acceleration", path, (*out)->name);
    if ((*out)->n < 2)
        return bad_data(err, "%s: holds %zu sample%s; at least two are needed", path, (*out)->n,
                        (*out)->n == 1 ? "" : "s");
    return STATUS_OK;
}

/* ---- the step ------------------------------------------------------------------------------------------------- */

/* The rows of one channel. */
typedef struct {
    const char *path;
    const Channel *c;
    const Row *base;
} Series;

static const Row *row_at(const Series *s, size_t i)
{
    return &s->base[i * s->c->stride];
}

/* bad_data of "PATH:LINE: what" at a row. */
#define fail_row(err, s, row, what, ...) bad_data(err, "%s:%d: " what, (s)->path, (row)->line, ##__VA_ARGS__)

/* The shortest decimal number within `slack` of x: times printed with few digits say 0.02, not 0.0200003. */
static double shortest_near(double x, double slack)
{
    for (int digits = 1; digits < 17; digits++) {
        char text[40];
        snprintf(text, sizeof text, "%.*g", digits, x);
        const double y = strtod(text, NULL);
        if (fabs(y - x) <= slack)
            return y;
    }
    return x;
}

static double step_before(const Series *s, size_t i)
{
    return row_at(s, i)->t - row_at(s, i - 1)->t;
}

/* The common step. A printed time is off by half a unit of its last digit at most, and so are the first and the last
 * one, which give the step: one unit in all, or 1e-5 of the time where six significant digits were printed, or 1e-3 of
 * a step in any case. A missing or doubled sample is off by half a step or more wherever it stands; hence the cap. */
static Status uniform_step(const Series *s, double *dt, Err *err)
{
    const size_t n = s->c->n;
    const double begin = row_at(s, 0)->t, span = row_at(s, n - 1)->t - begin, intervals = (double)(n - 1);
    int decimals = row_at(s, 0)->decimals, is_even = 1;
    for (size_t i = 1; i < n; i++)
        decimals = MAX_OF(row_at(s, i)->decimals, decimals);
    const double digit = pow(10.0, -decimals);
    *dt = shortest_near(span / intervals, digit / intervals);
    if (!(*dt > 0) || !isfinite(span))
        return bad_data(err, "%s: %zu samples from %g s to %g s have no usable step", s->path, n, begin,
                        row_at(s, n - 1)->t);
    for (size_t i = 0; i < n && is_even; i++) {
        const double t = row_at(s, i)->t, printed = fmax(digit, 1e-5 * fabs(t));
        is_even = !(fabs(t - begin - (double)i * *dt) > fmin(fmax(printed, 1e-3 * *dt), 0.3 * *dt));
    }
    if (is_even)
        return STATUS_OK;

    /* The message names the step that is least like the others: there the sample is missing, while the drift that it
     * causes is noticed elsewhere. The step of the others is what it breaks. */
    size_t odd = 1;
    for (size_t i = 2; i < n; i++)
        if (fabs(step_before(s, i) - *dt) > fabs(step_before(s, odd) - *dt))
            odd = i;
    const double step = step_before(s, odd), others = fmax((double)n - 2, 1);
    return fail_row(err, s, row_at(s, odd),
                    "time %.10g s breaks the uniform step of %.6g s: it comes %.6g s after the line before; a sample "
                    "is missing, or the file must be resampled: %sset motion.dt_s",
                    row_at(s, odd)->t, shortest_near((span - step) / others, digit / others), step,
                    s->c->is_timed ? "" : "name the column of its times time_s and ");
}

/* The step that the file states or its times have; 0: the times are uneven and to be resampled. */
static Status find_step(const Series *s, const MotionHow *how, double *dt, Err *err)
{
    const Channel *c = s->c;
    const double intervals = (double)(c->n - 1);
    Err uneven = {0};
    *dt = c->dt;
    if (*dt == 0) {
        for (size_t i = 1; i < c->n; i++) /* times on film may coincide in the digits that are printed */
            if (!(step_before(s, i) > 0) && !(c->digitized && step_before(s, i) == 0))
                return fail_row(err, s, row_at(s, i), "time %.10g s does not come after %.10g s", row_at(s, i)->t,
                                row_at(s, i - 1)->t);
        uniform_step(s, dt, &uneven);
    }
    if (*dt > MOTION_STEP_MAX_S)
        return fail_row(err, s, row_at(s, 0), "a step of %g s; more than %g s is no record of an earthquake", *dt,
                        MOTION_STEP_MAX_S);
    if (uneven.code != STATUS_OK && (how->dt_s == 0 || !(c->is_timed || c->digitized)))
        return c->digitized ? fail_row(err, s, row_at(s, 0),
                                       "digitized from film, where its trace bends; have it resampled by straight "
                                       "lines: --set motion.dt_s=0.005")
                            : bad_data(err, "%s", uneven.text);

    /* The header's step and that of the printed times, which have fewer digits: within 1 %, and half a step in all. */
    const double apart = c->other_dt > 0 ? fabs(*dt - c->other_dt) : 0;
    if (uneven.code == STATUS_OK && apart * intervals > *dt * (0.6 + 0.01 * intervals))
        return bad_data(err, "%s: its header says a step of %.6g s, its times one of %.6g s", s->path,
                        c->dt > 0 ? *dt : c->other_dt, c->dt > 0 ? c->other_dt : *dt);
    if (c->other_dt > 0 && apart * (double)c->n < 0.1 * *dt)
        *dt = c->other_dt;
    *dt = uneven.code == STATUS_OK ? *dt : 0;
    return STATUS_OK;
}

/* ---- samples -------------------------------------------------------------------------------------------------- */

/* Where the sample lies farthest from `offset`. */
static const Row *peak_from(const Series *s, double offset)
{
    const Row *peak = row_at(s, 0);
    for (size_t i = 1; i < s->c->n; i++)
        peak = fabs(row_at(s, i)->a - offset) > fabs(peak->a - offset) ? row_at(s, i) : peak;
    return peak;
}

/* Are the samples, in the unit of the file, plausible, and do they peak where the header says? offset: their mean where
 * that is to be subtracted. */
static Status check_peak(Motion *m, const Series *s, double offset, double to_m_s2, MotionUnit unit, Err *err)
{
    const Channel *c = s->c;
    const Row *highest = peak_from(s, 0);
    const double to_file = c->scale / to_m_s2, peak = to_m_s2 * fabs(peak_from(s, offset)->a - offset);
    const double error = c->peak > 0 ? (fabs(peak - c->peak) - c->peak_slack) / c->peak : 0;
    char what[160];
    if (!(fabs(highest->a) * to_m_s2 <= LARGEST_PEAK_G * GRAVITY))
        return fail_row(err, s, highest, "an acceleration of %g %s is beyond %g g; is the unit right?",
                        c->scale * highest->a, UNIT_NAMES[unit], LARGEST_PEAK_G);
    snprintf(what, sizeof what, "its samples peak at %.5g %s, its header says %.5g", peak * to_file, UNIT_NAMES[unit],
             c->peak * to_file);
    if (error > PEAK_ERROR_MAX)
        return bad_data(err, "%s: %s; more than %g %% apart", s->path, what, 100 * PEAK_ERROR_MAX);
    text_copy(m->warning, error > 0.2 * PEAK_ERROR_MAX ? what : c->warning ? c->warning : "");
    return STATUS_OK;
}

/* The mean of the samples, which must be finite; in a bare table of nothing below zero the second column is a spectrum
 * over its periods. */
static Status find_mean(const Series *s, double *mean, Err *err)
{
    int n_negative = 0;
    *mean = 0;
    for (size_t i = 0; i < s->c->n; i++) {
        const double a = row_at(s, i)->a;
        if (!isfinite(a))
            return bad_data(err, "%s: sample %zu of the channel is not a finite number", s->path, i + 1);
        *mean += a / (double)s->c->n;
        n_negative += a < 0;
    }
    if (s->c->is_bare && n_negative == 0)
        return fail_row(err, s, row_at(s, 0),
                        "no value is negative, as in a spectrum over its periods; if these are times and an "
                        "acceleration, say so: --text columns=time:1,value:2 (motion.text), or names above the "
                        "columns");
    return STATUS_OK;
}

/* The samples in m/s2 become the motion's; uneven ones are resampled by straight lines, at begin + k dt up to the end.
 * A step so short that it would multiply the file many times is a mistake. */
static Status convert_samples(Motion *m, const Series *s, const MotionHow *how, Err *err)
{
    const Channel *c = s->c;
    MotionUnit unit;
    double dt, to_m_s2 = 1, mean, n = (double)c->n;
    TRY(find_step(s, how, &dt, err));
    const int is_even = dt > 0;
    TRY(settle_unit(s->path, c, how, &unit, &to_m_s2, err));
    TRY(find_mean(s, &mean, err));
    const int is_offset = fabs(mean) > OFFSET_MAX * fabs(peak_from(s, 0)->a);
    const double offset = c->subtract_mean || (is_offset && unit == UNIT_COUNTS) ? mean : 0;
    TRY(check_peak(m, s, offset, to_m_s2, unit, err));
    if (is_offset && offset == 0 && !m->warning[0])
        snprintf(
            m->warning, sizeof m->warning,
            "its mean of %.4g %s is %.0f %% of its peak: if that is the zero of the recorder, motion.baseline = mean "
            "removes it",
            c->scale * mean, UNIT_NAMES[unit], 100 * fabs(mean / peak_from(s, 0)->a));
    if (offset != 0)
        snprintf(m->processed, sizeof m->processed, "mean of %.4g %s subtracted", c->scale * offset, UNIT_NAMES[unit]);
    const double begin = row_at(s, 0)->t, span = row_at(s, c->n - 1)->t - begin;
    if (!is_even) {
        dt = how->dt_s;
        n = floor(span / dt * (1 + 1e-12)) + 1;
        if (!(n >= 2 && n <= 1e6 + 16 * (double)c->n))
            return bad_data(err, "%s: motion.dt_s = %g would make %.0f samples of %zu in %g s", s->path, dt, n, c->n,
                            span);
        text_join(m->processed, sizeof m->processed, "; ", "resampled every %g s by straight lines", dt);
    }
    TRY_ROOM(m->accel, n, "samples of a motion", err);
    m->n = (size_t)n;
    m->dt_s = dt;
    for (size_t k = 0; k < m->n && is_even; k++)
        m->accel[k] = to_m_s2 * (row_at(s, k)->a - offset);
    for (size_t k = 0, i = 0; k < m->n && !is_even; k++) {
        const double t = begin + (double)k * dt;
        while (i + 2 < c->n && row_at(s, i + 1)->t <= t)
            i++;
        const Row *a = row_at(s, i), *b = row_at(s, i + 1);
        m->accel[k] = to_m_s2 * (a->a - offset + (b->a - a->a) * fmin((t - a->t) / (b->t - a->t), 1));
    }
    return STATUS_OK;
}

/* ---- the file ------------------------------------------------------------------------------------------------- */

typedef struct {
    Record *r;
    const char *path;
    Err first; /* why the first member could not be read */
} Members;

static Status read_content(Record *r, const char *path, const char *bytes, size_t n, Err *err);

/* A member that is no record of an acceleration (a picture, a readme, a velocity) is passed over, a damaged one not. */
static Status add_member(const char *name, const char *bytes, size_t n, void *user, Err *err)
{
    Members *members = user;
    Err why = {0};
    Record *one;
    TRY_ROOM(one, 1, "a record", err);
    one->how = members->r->how;
    one->deep = members->r->deep + 1;
    Status status = read_content(one, name, bytes, n, &why);
    if (status == STATUS_OK)
        status = record_append(members->r, one, members->path, name, err);
    else if (status == STATUS_NO_MEMORY)
        status = fail(err, status, "%s", why.text);
    else if (one->is_broken || (one->is_known && why.sub != SUB_NO_RECORD)) {
        members->r->is_broken = 1;
        status = fail(err, status, "%s: a member of this archive is damaged: %.360s", members->path, why.text);
    } else {
        if (!members->first.text[0])
            members->first = why;
        status = STATUS_OK;
    }
    record_free(one);
    free(one);
    return status;
}

/* Every channel of an archive, of a binary file, or of a text. */
static Status read_content(Record *r, const char *path, const char *bytes, size_t n, Err *err)
{
    Members members = {.r = r, .path = path};
    Lines l;
    int line = 1;
    if (archive_is(bytes, n)) {
        if (r->deep == ARCHIVES_DEEP)
            return bad_data(err, "%s: an archive in an archive in an archive", path);
        TRY(archive_each(path, bytes, n, add_member, &members, err));
        return r->n_channels > 0 ? STATUS_OK
                                 : bad_data(err, "%s: no member of this archive is a record: %.300s", path,
                                            members.first.text[0] ? members.first.text : "it is empty");
    }
    for (size_t i = 0; i < N_OF(BINARY_FORMATS); i++)
        if (BINARY_FORMATS[i]->recognise(bytes, n)) {
            r->is_known = BINARY_FORMATS[i] != &FORMAT_SIMCENTER; /* JSON may be anything */
            TRY(BINARY_FORMATS[i]->read(r, path, bytes, n, err));
            for (size_t k = 0; k < r->n_channels; k++)
                r->channel[k].format = BINARY_FORMATS[i]->name;
            return STATUS_OK;
        }
    while (n && strchr("\x1a\t\r\n ", bytes[n - 1])) /* Ctrl-Z and NUL end the texts of old programs */
        n--;
    if (n == 0)
        return bad_data(err, "%s: is empty", path);
    const int is_wide = n >= 2 && (memcmp(bytes, "\xff\xfe", 2) == 0 || memcmp(bytes, "\xfe\xff", 2) == 0);
    for (size_t i = 0; i < n && !is_wide; i++) {
        if ((unsigned char)bytes[i] < ' ' && !is_blank(bytes[i]))
            return bad_data(err, "%s:%d: holds bytes that no text has; a binary file of this kind is not read", path,
                            line);
        line += bytes[i] == '\n';
    }
    TRY(lines_open(&l, path, bytes, n, err));
    return text_read(r, &l, err);
}

Status motion_parse(Motion *m, const char *path, const char *text, size_t length, const MotionHow *how, Err *err)
{
    const Channel *c = NULL;
    MotionHow used = *how;
    Record *r;
    memset(m, 0, sizeof *m);
    TRY_ROOM(r, 1, "a record", err);
    if (used.channel && strcmp(used.channel, "auto") == 0)
        used.channel = NULL;
    r->how = &used;
    Status s = read_content(r, path, text, length, err);
    THEN(s, choose_channel(r, path, &c, err));
    THEN(s, convert_samples(m, &(Series){path, c, r->row + c->first}, how, err));
    if (s == STATUS_OK) {
        if (how->dt_s > 0 && fabs(how->dt_s - m->dt_s) > 1e-6 * m->dt_s)
            text_join(m->warning, sizeof m->warning, "; ", "motion.dt_s = %g is not used: the file says %.6g s",
                      how->dt_s, m->dt_s);
        m->is_corrected = c->is_corrected;
        text_copy(m->name, path);
        text_copy(m->format, c->format);
        text_copy(m->channel, c->name);
        m->file_hash = hash_fnv1a(text, length, HASH_SEED);
    }
    record_free(r);
    free(r);
    return s;
}

Status motion_read(Motion *m, const char *path, const MotionHow *how, Err *err)
{
    char *text;
    size_t length;
    memset(m, 0, sizeof *m);
    TRY(file_read(path, FILE_LARGEST, &text, &length, err));
    const Status s = motion_parse(m, path, text, length, how, err);
    free(text);
    return s;
}
