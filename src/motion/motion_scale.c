#include "motion/motion_scale.h"

#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/filter.h"
#include "base/units.h"
#include "motion/builtin.h"
#include "motion/motion_read.h"
#include "motion/spectrum.h"

enum { PADDING_MAX = 10000000 };                        /* samples: 80 MB */
static const double HIGHPASS_PAD = 0.75 * FILTER_ORDER; /* [-] times 1 / fc, before and behind */

static __attribute__((format(printf, 2, 3))) void say(Motion *m, const char *format, ...)
{
    const size_t used = strlen(m->processed);
    va_list list;
    va_start(list, format);
    snprintf(m->processed + used, sizeof m->processed - used, "%s", used ? "; " : "");
    vsnprintf(m->processed + strlen(m->processed), sizeof m->processed - strlen(m->processed), format, list);
    va_end(list);
}

/* ---- base line --------------------------------------------------------------------------------------------------- */

enum { DEGREE_MAX = 2 };

/* Values at s of the first polynomials that are orthogonal over the points s_i = 2 i / (n - 1) - 1, i = 0..n-1. */
static void orthogonal(double s, double n, double p[DEGREE_MAX + 1])
{
    p[0] = 1;
    p[1] = s;
    p[2] = s * s - (n + 1) / (3 * (n - 1)); /* mean of s_i^2 */
}

static Status subtract_baseline(Motion *m, int degree, Err *err)
{
    static const char *const WORDS[] = {"mean", "straight line", "parabola"};
    const double n = (double)m->n;
    double p[DEGREE_MAX + 1], sum[DEGREE_MAX + 1] = {0}, square[DEGREE_MAX + 1] = {0}, largest = 0;
    if (m->n < (size_t)degree + 2)
        return fail(err, STATUS_BAD_DATA, "%s: %zu samples are too few for motion.baseline", m->name, m->n);
    for (size_t i = 0; i < m->n; i++) {
        orthogonal(2 * (double)i / (n - 1) - 1, n, p);
        for (int k = 0; k <= degree; k++) {
            sum[k] += p[k] * m->accel[i];
            square[k] += p[k] * p[k];
        }
    }
    for (size_t i = 0; i < m->n; i++) {
        double line = 0;
        orthogonal(2 * (double)i / (n - 1) - 1, n, p);
        for (int k = 0; k <= degree; k++)
            line += sum[k] / square[k] * p[k];
        m->accel[i] -= line;
        largest = fmax(largest, fabs(line));
    }
    say(m, "base line: %s subtracted, at most %.3g g", WORDS[degree], largest / GRAVITY);
    return STATUS_OK;
}

/* ---- filters ----------------------------------------------------------------------------------------------------- */

/* Zeros before and behind the record. */
static Status pad(Motion *m, size_t before, size_t behind, Err *err)
{
    double *wider = calloc(before + m->n + behind, sizeof *wider);
    if (!wider)
        return fail(err, STATUS_NO_MEMORY, "%s: no memory to filter it", m->name);
    memcpy(wider + before, m->accel, m->n * sizeof *wider);
    free(m->accel);
    m->accel = wider;
    m->n += before + behind;
    return STATUS_OK;
}

static Status open_filter(const Motion *m, Filter *f, FilterKind kind, const char *key, double cutoff_hz, Err *err)
{
    Err why = {0};
    const Status status = filter_butterworth(f, kind, cutoff_hz, m->dt_s, &why);
    return status == STATUS_OK ? STATUS_OK : fail(err, status, "%s: motion.%s: %s", m->name, key, why.text);
}

static Status high_pass(Motion *m, double cutoff_hz, Err *err)
{
    Filter f;
    TRY(open_filter(m, &f, FILTER_HIGH_PASS, "highpass_hz", cutoff_hz, err));
    const double length_s = HIGHPASS_PAD / cutoff_hz;
    const size_t padding = (size_t)ceil(length_s / m->dt_s);
    if (padding > PADDING_MAX)
        return fail(err, STATUS_BAD_DATA, "%s: motion.highpass_hz: %g Hz needs %zu samples of padding; at most %d",
                    m->name, cutoff_hz, padding, PADDING_MAX);
    TRY(pad(m, padding, padding, err));
    filter_zero_phase(&f, m->n, 1, m->accel);
    say(m, "high-pass %g Hz (4th order Butterworth, zero phase), %.4g s of zeros added at both ends", cutoff_hz,
        (double)padding * m->dt_s);
    return STATUS_OK;
}

static Status low_pass(Motion *m, double cutoff_hz, Err *err)
{
    Filter f;
    TRY(open_filter(m, &f, FILTER_LOW_PASS, "lowpass_hz", cutoff_hz, err));
    const size_t padding = filter_padding(&f);
    if (padding > PADDING_MAX)
        return fail(err, STATUS_BAD_DATA, "%s: motion.lowpass_hz: %g Hz needs %zu samples of padding; at most %d",
                    m->name, cutoff_hz, padding, PADDING_MAX);
    TRY(pad(m, 0, padding, err));
    filter_zero_phase(&f, m->n, 1, m->accel);
    m->n -= padding;
    say(m, "low-pass %g Hz (4th order Butterworth, zero phase)", cutoff_hz);
    return STATUS_OK;
}

Status motion_process(Motion *m, const MotionOptions *o, Err *err)
{
    if (o->baseline != BASELINE_NONE)
        TRY(subtract_baseline(m, (int)o->baseline - (int)BASELINE_MEAN, err));
    if (o->highpass_hz > 0)
        TRY(high_pass(m, o->highpass_hz, err));
    if (o->lowpass_hz > 0)
        TRY(low_pass(m, o->lowpass_hz, err));
    return STATUS_OK;
}

int motion_is_corrected(const MotionOptions *o)
{
    return o->baseline != BASELINE_NONE || o->highpass_hz > 0;
}

static const double DAMPING = 0.05;

/* ---- code spectra ------------------------------------------------------------------------------------------------ */

enum { EUROCODE8 = 1u << TARGET_EUROCODE8, ASCE7 = 1u << TARGET_ASCE7 };

/* The numbers of motion.target: what a target must be given begins as 0. */
static const struct {
    const char *key;
    size_t at;
    double least, most;
    unsigned of; /* the codes that have it */
} NUMBERS[] = {
    {"from", offsetof(CodeSpectrum, from_s), 1e-3, 1e3, EUROCODE8 | ASCE7},
    {"to", offsetof(CodeSpectrum, to_s), 1e-3, 1e3, EUROCODE8 | ASCE7},
    {"ag", offsetof(CodeSpectrum, ag_g), 1e-6, 1e6, EUROCODE8},
    {"s", offsetof(CodeSpectrum, s), 0.1, 10, EUROCODE8},
    {"tb", offsetof(CodeSpectrum, tb_s), 1e-3, 100, EUROCODE8},
    {"tc", offsetof(CodeSpectrum, tc_s), 1e-3, 100, EUROCODE8},
    {"td", offsetof(CodeSpectrum, td_s), 1e-3, 100, EUROCODE8},
    {"sds", offsetof(CodeSpectrum, sds_g), 1e-6, 1e6, ASCE7},
    {"sd1", offsetof(CodeSpectrum, sd1_g), 1e-6, 1e6, ASCE7},
    {"tl", offsetof(CodeSpectrum, tl_s), 1e-3, 100, ASCE7},
};

/* EN 1998-1, Table 3.2: ground types A to E, spectrum of type 1. */
static const struct {
    double s, tb_s, tc_s, td_s;
} SOILS[] = {{1, 0.15, 0.4, 2}, {1.2, 0.15, 0.5, 2}, {1.15, 0.2, 0.6, 2}, {1.35, 0.2, 0.8, 2}, {1.4, 0.15, 0.5, 2}};

/* One "key=value". */
static Status take_number(CodeSpectrum *c, const char *word, Err *err)
{
    const size_t length = strcspn(word, "=");
    char *end;
    if (c->kind == TARGET_EUROCODE8 && strncmp(word, "soil=", 5) == 0 && word[5] >= 'A' && word[5] <= 'E' && !word[6]) {
        const int k = word[5] - 'A';
        c->s = SOILS[k].s;
        c->tb_s = SOILS[k].tb_s;
        c->tc_s = SOILS[k].tc_s;
        c->td_s = SOILS[k].td_s;
        return STATUS_OK;
    }
    for (size_t i = 0; i < sizeof NUMBERS / sizeof NUMBERS[0]; i++) {
        if (!(NUMBERS[i].of >> c->kind & 1) || strlen(NUMBERS[i].key) != length ||
            strncmp(word, NUMBERS[i].key, length) != 0 || word[length] != '=')
            continue;
        const double x = strtod(word + length + 1, &end);
        if (end == word + length + 1 || *end || !(x >= NUMBERS[i].least && x <= NUMBERS[i].most))
            return fail(err, STATUS_BAD_DATA, "motion.target: '%s' is no number from %g to %g", word, NUMBERS[i].least,
                        NUMBERS[i].most);
        memcpy((char *)c + NUMBERS[i].at, &x, sizeof x);
        return STATUS_OK;
    }
    return fail(err, STATUS_BAD_DATA, "motion.target: '%s' is none of %s", word,
                c->kind == TARGET_ASCE7 ? "sds= sd1= tl= from= to=" : "ag= soil=A..E s= tb= tc= td= from= to=");
}

static Status check_target(const CodeSpectrum *c, Err *err)
{
    if (!(c->from_s < c->to_s))
        return fail(err, STATUS_BAD_DATA, "motion.target: from=%g must be below to=%g", c->from_s, c->to_s);
    if (c->kind == TARGET_EUROCODE8 && !(c->ag_g > 0 && c->s > 0 && c->tb_s > 0 && c->tc_s > 0 && c->td_s > 0))
        return fail(err, STATUS_BAD_DATA,
                    "motion.target: eurocode8 needs ag= [g] and soil=A..E, or s=, tb=, tc= and td= in its place");
    if (c->kind == TARGET_EUROCODE8 && !(c->tb_s <= c->tc_s && c->tc_s <= c->td_s))
        return fail(err, STATUS_BAD_DATA, "motion.target: tb=%g, tc=%g and td=%g must rise", c->tb_s, c->tc_s, c->td_s);
    if (c->kind == TARGET_ASCE7 && !(c->sds_g > 0 && c->sd1_g > 0))
        return fail(err, STATUS_BAD_DATA, "motion.target: asce7 needs sds= and sd1= [g]");
    if (c->kind == TARGET_ASCE7 && !(c->sd1_g / c->sds_g <= c->tl_s))
        return fail(err, STATUS_BAD_DATA, "motion.target: tl=%g must not be below TS = sd1 / sds = %g", c->tl_s,
                    c->sd1_g / c->sds_g);
    return STATUS_OK;
}

Status target_parse(const char *text, CodeSpectrum *out, Err *err)
{
    static const char *const KINDS[] = {"none", "eurocode8", "asce7"};
    char copy[OPTION_TEXT_MAX], *rest = copy;
    *out = (CodeSpectrum){.from_s = 0.2, .to_s = 2, .tl_s = 8};
    snprintf(copy, sizeof copy, "%s", *text ? text : KINDS[TARGET_NONE]);
    const char *word = strsep(&rest, " ");
    while (out->kind <= TARGET_ASCE7 && strcmp(word, KINDS[out->kind]) != 0)
        out->kind++;
    if (out->kind > TARGET_ASCE7 || (out->kind == TARGET_NONE && rest))
        return fail(err, STATUS_BAD_DATA, "motion.target: '%s' is none of none, eurocode8 ag=... , asce7 sds=...",
                    text);
    while ((word = strsep(&rest, " "))) {
        const char *again = rest;
        for (size_t n = strcspn(word, "=") + 1; *word && again; again = strchr(again, ' ')) {
            again += strspn(again, " ");
            if (strncmp(again, word, n) == 0)
                return fail(err, STATUS_BAD_DATA, "motion.target: '%s' and '%s': one of them", word, again);
        }
        if (*word)
            TRY(take_number(out, word, err));
    }
    return out->kind == TARGET_NONE ? STATUS_OK : check_target(out, err);
}

static double eurocode8(const CodeSpectrum *c, double T)
{
    const double plateau = 2.5 * c->ag_g * c->s;
    if (T < c->tb_s)
        return plateau / 2.5 * (1 + 1.5 * T / c->tb_s);
    if (T <= c->tc_s)
        return plateau;
    return T <= c->td_s ? plateau * c->tc_s / T : plateau * c->tc_s * c->td_s / (T * T);
}

static double asce7(const CodeSpectrum *c, double T)
{
    const double ts = c->sd1_g / c->sds_g, t0 = 0.2 * ts;
    if (T < t0)
        return c->sds_g * (0.4 + 0.6 * T / t0);
    if (T <= ts)
        return c->sds_g;
    return T <= c->tl_s ? c->sd1_g / T : c->sd1_g * c->tl_s / (T * T);
}

double target_psa(const CodeSpectrum *c, double T)
{
    return c->kind == TARGET_NONE ? 0 : GRAVITY * (c->kind == TARGET_EUROCODE8 ? eurocode8(c, T) : asce7(c, T));
}

/* ln(target / PSa) over the range: its mean, and the root of its mean square. */
static void compare(const Motion *m, const CodeSpectrum *c, double *mean, double *rms)
{
    double T[TARGET_PERIODS], psa[TARGET_PERIODS];
    *mean = *rms = 0;
    for (int i = 0; i < TARGET_PERIODS; i++)
        T[i] = c->from_s * pow(c->to_s / c->from_s, (double)i / (TARGET_PERIODS - 1));
    spectrum_psa(m, DAMPING, TARGET_PERIODS, T, psa);
    for (int i = 0; i < TARGET_PERIODS; i++) {
        const double ratio = log(target_psa(c, T[i]) / psa[i]);
        *mean += ratio / TARGET_PERIODS;
        *rms += ratio * ratio / TARGET_PERIODS;
    }
    *rms = sqrt(*rms);
}

double target_misfit(const Motion *m, const CodeSpectrum *c)
{
    double mean, rms;
    compare(m, c, &mean, &rms);
    return rms;
}

/* ---- scaling ----------------------------------------------------------------------------------------------------- */

static double factor_of(const Motion *m, const MotionOptions *o, const CodeSpectrum *c)
{
    double psa, mean, rms;
    if (o->sa_g > 0) {
        spectrum_psa(m, DAMPING, 1, &o->sa_period_s, &psa);
        return o->sa_g * GRAVITY / psa;
    }
    if (c->kind != TARGET_NONE) {
        compare(m, c, &mean, &rms);
        return exp(mean);
    }
    return o->factor;
}

/* Behind what the reader has to say. */
static void warn_of_scale(Motion *m)
{
    const size_t used = strlen(m->warning);
    if (m->scale > SCALE_PLAUSIBLE || m->scale < 1 / SCALE_PLAUSIBLE)
        snprintf(m->warning + used, sizeof m->warning - used,
                 "%sscaled by %.3g; records are scaled by %g to %g as a rule", used ? "; " : "", m->scale,
                 1 / SCALE_PLAUSIBLE, SCALE_PLAUSIBLE);
}

/* A record that must be multiplied by so much is not what it is taken for. A factor of one's own may convert units. */
static Status check_scale(const Motion *m, const MotionOptions *o, double peak_g, Err *err)
{
    char scaling[SCALINGS_TEXT_MAX];
    if (o->factor != 1 || m->scale <= SCALE_MAX)
        return STATUS_OK;
    motion_scalings(o, scaling);
    return fail(
        err, STATUS_BAD_DATA,
        "%s: %s would multiply it by %.3g, for it peaks at %.3g g%s%s; beyond %g its unit is wrong, or nothing is "
        "left of it",
        m->name, scaling, m->scale, peak_g, m->processed[0] ? " after this: " : "", m->processed, SCALE_MAX);
}

Status motion_scale(Motion *m, const MotionOptions *o, Err *err)
{
    const double peak_g = motion_peak(m) / GRAVITY;
    CodeSpectrum target;
    TRY(target_parse(o->target, &target, err));
    TRY(motion_prepare(m, o->pga_g, o->stretch, err));
    const double factor = factor_of(m, o, &target);
    if (!(factor > 0 && isfinite(factor)))
        return fail(err, STATUS_BAD_DATA, "%s: cannot be scaled to a response spectrum: it moves no such oscillator",
                    m->name);
    for (size_t i = 0; i < m->n && factor != 1; i++)
        m->accel[i] *= factor;
    m->scale *= factor;
    warn_of_scale(m);
    return check_scale(m, o, peak_g, err);
}

int motion_scalings(const MotionOptions *o, char text[SCALINGS_TEXT_MAX])
{
    char each[4][64] = {"", "", "", ""};
    int n = 0;
    if (o->pga_g > 0)
        snprintf(each[n++], sizeof each[0], "motion.pga_g = %g", o->pga_g);
    if (o->factor != 1)
        snprintf(each[n++], sizeof each[0], "motion.factor = %g", o->factor);
    if (o->sa_g > 0)
        snprintf(each[n++], sizeof each[0], "motion.sa_g = %g", o->sa_g);
    if (o->target[0] && strcmp(o->target, "none") != 0)
        snprintf(each[n++], sizeof each[0], "motion.target = %.40s", o->target);
    text[0] = 0;
    for (int i = 0; i < n; i++)
        snprintf(text + strlen(text), SCALINGS_TEXT_MAX - strlen(text), "%s%s", i ? ", " : "", each[i]);
    return n;
}

void motion_unscale(MotionOptions *o)
{
    o->pga_g = o->sa_g = 0;
    o->factor = 1;
    o->target[0] = 0;
}

static Status load(Motion *m, const char *source, const MotionHow *how, Err *err)
{
    static const char *const MOTIONS[] = {BUILTIN_MOTION_LIST(CHOICE_WORD)};
    if (builtin_name(source))
        return builtin_motion(m, builtin_name(source), err); /* in m/s2, one channel, whatever is said of files */
    const Status status = motion_read(m, source, how, err);
    const char *near =
        status == STATUS_MISSING ? nearest_word(source, MOTIONS, sizeof MOTIONS / sizeof MOTIONS[0]) : NULL;
    return near ? fail_sub(err, status, SUB_SUGGESTS, "%s: there is no such file; did you mean %s?", source, near)
                : status;
}

Status motion_load(Motion *m, const char *source, MotionUnit unit, Err *err)
{
    return load(m, source, &(MotionHow){.unit = unit}, err);
}

Status motion_open(Motion *m, const MotionOptions *o, Err *err)
{
    MotionHow how = {.channel = o->channel, .dt_s = o->dt_s};
    TRY(motion_unit_parse(o->unit, &how.unit, &how.counts_per_m_s2, err));
    TRY(load(m, o->record, &how, err));
    const Status status = motion_process(m, o, err);
    if (status != STATUS_OK)
        motion_free(m);
    return status;
}
