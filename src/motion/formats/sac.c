/* SAC, binary of both byte orders and alphanumeric (SAC User's Manual, "SAC Data File Format"): 70 reals, 40 integers,
 * 24 words of 8 characters (the second and third are one), then NPTS samples. Places from 0:
 *
 *   real 0 DELTA [s]       real 1, 2 DEPMIN, DEPMAX                 integer 6 NVHDR (6 or 7)   integer 9 NPTS
 *   integer 15 IFTYPE (1: time series)   integer 35 LEVEN (1: equal steps)   word 20 KCMPNM   word 21 KNETWK
 *
 * Integer 16, IDEP, may say displacement (6) or velocity (7), which are refused. That it says nm/s2 (8) hardly any file
 * keeps to: the unit is asked for. */

#include "motion/formats/record.h"

enum {
    N_REALS = 70,
    N_INTEGERS = 40,
    WORDS_AT = 4 * (N_REALS + N_INTEGERS),
    HEADER = WORDS_AT + 24 * 8,
    FOOTER = 22 * 8, /* of version 7: some of the reals once more, as doubles */
    DELTA = 0,
    DEPMIN = 1,
    DEPMAX = 2,
    NVHDR = N_REALS + 6,
    NPTS = 9,
    IFTYPE = 15,
    IDEP = 16,
    LEVEN = 35,
    COMPONENT_AT = WORDS_AT + 20 * 8
};
static const double UNDEFINED = -12345;

/* Word k of 4 bytes, of an integer or of a real; the other byte order: swapped. */
static int32_t word_at(const char *bytes, size_t k, int swapped)
{
    uint32_t w;
    memcpy(&w, bytes + 4 * k, sizeof w);
    return swapped ? __builtin_bswap32(w) : w;
}

static double real_at(const char *bytes, size_t k, int swapped)
{
    const int32_t w = word_at(bytes, k, swapped);
    float x;
    memcpy(&x, &w, sizeof x);
    return x;
}

static int is_version(int32_t v)
{
    return v == 6 || v == 7;
}

static int recognise(const char bytes[], size_t n)
{
    return n >= HEADER && (is_version(word_at(bytes, NVHDR, 0)) || is_version(word_at(bytes, NVHDR, 1)));
}

/* The largest magnitude that the header states, where both ends are known; in the unit of the samples. */
static void check_range(Channel *c, const Record *r, double low, double high)
{
    double most = 0;
    const double stated = fmax(fabs(low), fabs(high));
    if (low == UNDEFINED || high == UNDEFINED || !(stated > 0))
        return;
    for (size_t i = 0; i < c->n; i++)
        most = fmax(most, fabs(r->row[c->first + i].a));
    if (fabs(most - stated) > 0.01 * stated)
        c->warning = "its largest sample is not the one that its header states (DEPMIN, DEPMAX)";
}

/* Refuses a header that is none of an acceleration in equal steps; else makes its channel, of counts. */
static Status take_header(Record *r, const Lines *l, const double reals[], const double integers[], Channel **c,
                          Err *err)
{
    const char *path = l->path;
    const double quantity = integers[IDEP], delta = reals[DELTA], npts = integers[NPTS];
    if (quantity == 6 || quantity == 7)
        return fail_sub(err, STATUS_BAD_DATA, SUB_NO_RECORD, "%s: not an acceleration: IDEP in its SAC header says %s",
                        path, quantity == 6 ? "displacement" : "velocity");
    if (integers[IFTYPE] != 1 || integers[LEVEN] != 1)
        return bad_data(err, "%s: a SAC file of type %g that is no time series in equal steps", path, integers[IFTYPE]);
    if (!(delta > 0 && delta <= MOTION_STEP_MAX_S))
        return bad_data(err, "%s: no usable step in its SAC header: DELTA is %g", path, delta);
    if (!(npts >= 2 && npts <= 1e8))
        return bad_data(err, "%s: no usable number of points in its SAC header: NPTS is %g", path, npts);
    TRY(record_channel(r, l, c, err));
    (*c)->counts = 1;
    (*c)->dt = delta;
    return STATUS_OK;
}

/* One channel: the header in the byte order of its version, then its samples. */
static Status read_binary(Record *r, const char *path, const char *bytes, size_t n, Err *err)
{
    const Lines l = {.path = path, .number = 1};
    const int swapped = !is_version(word_at(bytes, NVHDR, 0));
    const char *component = bytes + COMPONENT_AT;
    double reals[N_REALS], integers[N_INTEGERS];
    Channel *c;
    for (int i = 0; i < N_REALS; i++)
        reals[i] = real_at(bytes, i, swapped);
    for (int i = 0; i < N_INTEGERS; i++)
        integers[i] = word_at(bytes, N_REALS + i, swapped);
    TRY(take_header(r, &l, reals, integers, &c, err));
    const size_t npts = (size_t)integers[NPTS];
    if ((n - HEADER) / 4 != npts && n != HEADER + 4 * npts + FOOTER)
        return bad_data(err, "%s: holds %zu samples, not the %zu that its header announces", path, (n - HEADER) / 4,
                        npts);
    c->n = npts;
    c->dt = round(c->dt * 1e7) / 1e7; /* a float of 0.01 is 0.0099999998 */
    if (strnlen(component, 8) > 0 && strncmp(component, "-12345", 6) != 0)
        channel_name(c, component, component + strnlen(component, 8));
    for (size_t i = 0; i < c->n; i++) {
        const double x = real_at(bytes + HEADER, i, swapped);
        if (!isfinite(x))
            return bad_data(err, "%s: sample %zu is %g; only finite numbers are accepted", path, i, x);
        TRY(record_add(r, (Row){.a = x, .line = 1}, err));
    }
    check_range(c, r, reals[DEPMIN], reals[DEPMAX]);
    return STATUS_OK;
}

/* ---- alphanumeric: 14 lines 5G15.7, 8 lines 5I10, 8 lines of words, 5G15.7 --------------------------------------- */

enum { REAL_LINES = N_REALS / 5, WORD_LINES = 8 };

int sac_text_is(Lines l)
{
    double x[5];
    size_t n;
    Err ignored = {0};
    if (!lines_next(&l) || line_has_letters(&l) || !lines_skip(&l, REAL_LINES + 1) ||
        line_numbers(&l, 10, 5, x, &n, &ignored) != STATUS_OK)
        return 0;
    return n == 5 && is_version((int32_t)fmax(fmin(x[1], 100), -100)) && x[1] == floor(x[1]);
}

Status sac_text_read(Record *r, Lines *l, Err *err)
{
    double reals[N_REALS], integers[N_INTEGERS];
    Channel *c;
    TRY(header_numbers(l, 15, N_REALS, reals, err));
    TRY(header_numbers(l, 10, N_INTEGERS, integers, err));
    TRY(take_header(r, l, reals, integers, &c, err));
    for (int i = 0; i < WORD_LINES; i++) {
        if (!lines_next(l))
            return fail_too_short(l, "header", err);
        if (i == 6 && l->to - l->raw > 16 && strncmp(l->raw + 16, "-12345", 6) != 0) /* words 18 to 20 */
            channel_name(c, l->raw + 16, l->to);
    }
    TRY(record_block(r, l, integers[NPTS], 15, 0, err));
    check_range(c, r, reals[DEPMIN], reals[DEPMAX]);
    return STATUS_OK;
}

const BinaryFormat FORMAT_SAC = {"sac", recognise, read_binary};
