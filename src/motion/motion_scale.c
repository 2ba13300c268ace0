#include "motion/motion_scale.h"

#include "base/filter.h"
#include "base/hash.h"
#include "base/keyed.h"
#include "base/list.h"
#include "base/text.h"
#include "base/units.h"
#include "motion/builtin.h"
#include "motion/forces.h"
#include "motion/motion_read.h"
#include "motion/spectrum.h"
#include "motion/suite.h"

enum { PADDING_MAX = 10000000 };                        /* samples: 80 MB */
static const double HIGHPASS_PAD = 0.75 * FILTER_ORDER; /* [-] times 1 / fc, before and behind */

/* ---- base line --------------------------------------------------------------------------------------------------- */

enum { DEGREE_MAX = 2 };

/* Values at s of the first polynomials that are orthogonal over the points s_i = 2 i / (n - 1) - 1, i = 0..n-1. */
static void orthogonal(double s, double n, double p[DEGREE_MAX + 1])
{
    p[0] = 1;
    p[1] = s;
    p[2] = s * s - (n + 1) / (3 * (n - 1)); /* mean of s_i^2 */
}

/* Subtracts the polynomial of that degree that fits the samples best. */
static Status subtract_baseline(Motion *m, int degree, Err *err)
{
    static const char *const WORDS[] = {"mean", "straight line", "parabola"};
    const double n = (double)m->n;
    double p[DEGREE_MAX + 1], sum[DEGREE_MAX + 1] = {0}, square[DEGREE_MAX + 1] = {0}, largest = 0;
    if (m->n < (size_t)degree + 2)
        return bad_data(err, "%s: %zu samples are too few for motion.baseline", m->name, m->n);
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
    text_join(m->processed, sizeof m->processed, "; ", "base line: %s subtracted, at most %.3g g", WORDS[degree],
              largest / GRAVITY);
    return STATUS_OK;
}

/* ---- filters ----------------------------------------------------------------------------------------------------- */

/* Passes over the record, with zeros behind it, and before it too for a high pass, which keeps them. */
static Status filter(Motion *m, FilterKind kind, const char *key, double cutoff_hz, Err *err)
{
    Filter f;
    Err why = {0};
    double *wider;
    const int is_high = kind == FILTER_HIGH_PASS;
    const Status status = filter_butterworth(&f, kind, cutoff_hz, m->dt_s, &why);
    if (status != STATUS_OK)
        return fail(err, status, "%s: motion.%s: %s", m->name, key, why.text);
    const size_t padding = is_high ? (size_t)ceil(HIGHPASS_PAD / cutoff_hz / m->dt_s) : filter_padding(&f);
    const size_t before = is_high ? padding : 0, n = before + m->n + padding;
    if (padding > PADDING_MAX)
        return bad_data(err, "%s: motion.%s: %g Hz needs %zu samples of padding; at most %d", m->name, key, cutoff_hz,
                        padding, PADDING_MAX);
    TRY_ROOM(wider, n, "samples of a motion", err);
    memcpy(wider + before, m->accel, m->n * sizeof *wider);
    free(m->accel);
    m->accel = wider;
    filter_zero_phase(&f, n, 1, m->accel);
    m->n = is_high ? n : m->n;
    text_join(m->processed, sizeof m->processed, "; ", "%s-pass %g Hz (4th order Butterworth, zero phase)",
              is_high ? "high" : "low", cutoff_hz);
    if (is_high)
        text_join(m->processed, sizeof m->processed, ", ", "%.4g s of zeros added at both ends",
                  (double)padding * m->dt_s);
    return STATUS_OK;
}

Status motion_process(Motion *m, const MotionOptions *o, Err *err)
{
    if (o->baseline != BASELINE_NONE)
        TRY(subtract_baseline(m, o->baseline - BASELINE_MEAN, err));
    if (o->highpass_hz > 0)
        TRY(filter(m, FILTER_HIGH_PASS, "highpass_hz", o->highpass_hz, err));
    if (o->lowpass_hz > 0)
        TRY(filter(m, FILTER_LOW_PASS, "lowpass_hz", o->lowpass_hz, err));
    return STATUS_OK;
}

int motion_is_corrected(const MotionOptions *o)
{
    return o->baseline != BASELINE_NONE || o->highpass_hz > 0;
}

static const double DAMPING = 0.05;

/* ---- code spectra ------------------------------------------------------------------------------------------------ */

/* The keys of motion.target. */
enum { AG, SOIL, S, TB, TC, TD, SDS, SD1, TL, FROM, TO, N_KEYS };
enum { EUROCODE8 = 1 << TARGET_EUROCODE8, ASCE7 = 1 << TARGET_ASCE7 };
static const KeyedNumber KEYS[N_KEYS] = {
    {"ag", EUROCODE8, 1e-6, 1e6, 0},
    {"soil", EUROCODE8, 1, 5, 1},
    {"s", EUROCODE8, 0.1, 10, 0},
    {"tb", EUROCODE8, 1e-3, 100, 0},
    {"tc", EUROCODE8, 1e-3, 100, 0},
    {"td", EUROCODE8, 1e-3, 100, 0},
    {"sds", ASCE7, 1e-6, 1e6, 0},
    {"sd1", ASCE7, 1e-6, 1e6, 0},
    {"tl", ASCE7, 1e-3, 100, 0},
    {"from", EUROCODE8 | ASCE7, 1e-3, 1e3, 0},
    {"to", EUROCODE8 | ASCE7, 1e-3, 1e3, 0},
};
static const double OTHERWISE[N_KEYS] = {[TL] = 8, [FROM] = 0.2, [TO] = 2};

/* EN 1998-1, Table 3.2: S, TB, TC, TD of ground types A to E, spectrum of type 1. */
static const double SOILS[][4] = {
    {1, 0.15, 0.4, 2}, {1.2, 0.15, 0.5, 2}, {1.15, 0.2, 0.6, 2}, {1.35, 0.2, 0.8, 2}, {1.4, 0.15, 0.5, 2}};

Status target_parse(const char *text, CodeSpectrum *c, Err *err)
{
    char copy[OPTION_TEXT_MAX], *rest = copy;
    double x[N_KEYS] = {0};
    *c = (CodeSpectrum){TARGET_NONE};
    if (!list_is_given(text))
        return STATUS_OK;
    text_copy(copy, text);
    const char *word = strsep(&rest, " ");
    const int is_eurocode = strcmp(word, "eurocode8") == 0, kind = is_eurocode ? TARGET_EUROCODE8 : TARGET_ASCE7;
    if (!is_eurocode && strcmp(word, "asce7") != 0)
        return bad_data(err, "motion.target: '%s' is none of none, eurocode8 ag=... , asce7 sds=...", text);
    if (rest)
        TRY(keyed_numbers("motion.target", rest, 1u << kind, N_KEYS, KEYS, x, err));

    /* Both codes rise from 0.4 to a plateau, which ends at TC, and fall with T and from TD on with its square. */
    for (int k = 0; k < N_KEYS; k++)
        x[k] = x[k] != 0 ? x[k] : k >= S && k <= TD && x[SOIL] > 0 ? SOILS[(int)x[SOIL] - 1][k - S] : OTHERWISE[k];
    const double ts = x[SD1] / x[SDS];
    *c = is_eurocode ? (CodeSpectrum){kind, x[FROM], x[TO], 2.5 * x[AG] * x[S], x[TB], x[TC], x[TD]}
                     : (CodeSpectrum){kind, x[FROM], x[TO], x[SDS], 0.2 * ts, ts, x[TL]};
    if (!(c->plateau_g > 0 && c->tb_s > 0 && c->tc_s > 0 && c->td_s > 0))
        return bad_data(err, "motion.target: %s",
                        is_eurocode ? "eurocode8 needs ag= [g] and soil=A..E, or s=, tb=, tc= and td= in its place"
                                    : "asce7 needs sds= and sd1= [g]");
    if (!(c->from_s < c->to_s))
        return bad_data(err, "motion.target: from=%g must be below to=%g", c->from_s, c->to_s);
    return c->tb_s <= c->tc_s && c->tc_s <= c->td_s
               ? STATUS_OK
               : bad_data(err, "motion.target: %s=%g, %s=%g and %s=%g must rise", is_eurocode ? "tb" : "T0", c->tb_s,
                          is_eurocode ? "tc" : "TS", c->tc_s, is_eurocode ? "td" : "tl", c->td_s);
}

double target_psa(const CodeSpectrum *c, double T)
{
    if (c->kind == TARGET_NONE)
        return 0;
    const double fall = T <= c->td_s ? c->tc_s / T : c->tc_s * c->td_s / (T * T);
    return GRAVITY * c->plateau_g * (T < c->tb_s ? 0.4 + 0.6 * T / c->tb_s : T <= c->tc_s ? 1 : fall);
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

/* Is the ground at rest? */
static int is_still(const MotionOptions *o)
{
    return strcmp(o->record, "none") == 0;
}

Status motion_scale(Motion *m, const MotionOptions *o, Err *err)
{
    const double peak_g = motion_peak(m) / GRAVITY;
    double factor, psa, mean, rms;
    char scaling[SCALINGS_TEXT_MAX];
    CodeSpectrum target;
    Source source;
    if (is_still(o)) {
        m->scale = m->stretch = 1;
        return forces_place(m, err);
    }
    TRY(target_parse(o->target, &target, err));
    TRY(source_read(o->record, &source, err));
    if (source.factor != 1 && (o->pga_g > 0 || o->sa_g > 0 || target.kind != TARGET_NONE))
        return bad_data(err,
                        "%s: has a factor of its own, and all records are scaled otherwise too (motion.pga_g, "
                        "motion.sa_g or motion.target): leave one out",
                        source.path);
    TRY(motion_prepare(m, o->pga_g, o->stretch, err));

    /* To a spectral value, to a code spectrum, or by the factors of setting and source. */
    if (o->sa_g > 0) {
        spectrum_psa(m, DAMPING, 1, &o->sa_period_s, &psa);
        factor = o->sa_g * GRAVITY / psa;
    } else if (target.kind != TARGET_NONE) {
        compare(m, &target, &mean, &rms);
        factor = exp(mean);
    } else {
        factor = o->factor * source.factor;
    }
    if (!(factor > 0 && isfinite(factor)))
        return bad_data(err, "%s: cannot be scaled to a response spectrum: it moves no such oscillator", m->name);
    for (size_t i = 0; i < m->n && factor != 1; i++)
        m->accel[i] *= factor;
    m->scale *= factor;

    /* A record that must be multiplied by so much is not what it is taken for. A factor of one's own may convert
     * units. */
    if (m->scale > SCALE_PLAUSIBLE || m->scale < 1 / SCALE_PLAUSIBLE)
        text_join(m->warning, sizeof m->warning, "; ", "scaled by %.3g; records are scaled by %g to %g as a rule",
                  m->scale, 1 / SCALE_PLAUSIBLE, SCALE_PLAUSIBLE);
    if (o->factor == 1 && source.factor == 1 && m->scale > SCALE_MAX) {
        motion_scalings(o, scaling);
        return bad_data(
            err,
            "%s: %s would multiply it by %.3g, for it peaks at %.3g g%s%s; beyond %g its unit is wrong, or nothing is "
            "left of it",
            m->name, scaling, m->scale, peak_g, m->processed[0] ? " after this: " : "", m->processed, SCALE_MAX);
    }
    return forces_place(m, err);
}

int motion_scalings(const MotionOptions *o, char text[SCALINGS_TEXT_MAX])
{
    const struct {
        const char *key;
        double x, without;
    } NUMBERS[] = {{"pga_g", o->pga_g, 0}, {"factor", o->factor, 1}, {"sa_g", o->sa_g, 0}};
    int n = 0;
    text[0] = 0;
    for (int i = 0; i < 3; i++)
        if (NUMBERS[i].x != NUMBERS[i].without) {
            text_join(text, SCALINGS_TEXT_MAX, ", ", "motion.%s = %g", NUMBERS[i].key, NUMBERS[i].x);
            n++;
        }
    if (list_is_given(o->target))
        text_join(text, SCALINGS_TEXT_MAX, ", ", "motion.target = %.40s", o->target);
    return n + list_is_given(o->target);
}

void motion_unscale(MotionOptions *o)
{
    o->pga_g = o->sa_g = 0;
    o->factor = 1;
    o->target[0] = 0;
}

/* Reads a file or makes a built-in motion; a word that is neither may be one misspelt. */
static Status load(Motion *m, const char *source, const MotionHow *how, Err *err)
{
    static const char *const MOTIONS[] = {BUILTIN_MOTION_LIST(CHOICE_WORD)};
    if (builtin_name(source))
        return builtin_motion(m, source, err); /* in m/s2, one channel, whatever is said of files */
    const Status status = motion_read(m, source, how, err);
    const char *near = status == STATUS_MISSING ? nearest_word(source, MOTIONS, N_OF(MOTIONS)) : NULL;
    return near ? fail(err, status, "%s: there is no such file; did you mean %s?", source, near) : status;
}

Status motion_load(Motion *m, const char *source, MotionUnit unit, Err *err)
{
    return load(m, source, &(MotionHow){.unit = unit}, err);
}

Status motion_open(Motion *m, const MotionOptions *o, Err *err)
{
    Source source;
    TRY(source_read(o->record, &source, err));
    MotionHow how = {.channel = source.channel[0] ? source.channel : o->channel, .dt_s = o->dt_s};
    TRY(motion_unit_parse(o->unit, &how.unit, &how.counts_per_m_s2, err));
    TRY(text_form_parse(o->text, &how.text, err));
    if (is_still(o)) {
        if (!list_is_given(o->forces))
            return bad_data(err, "motion.record = none: then nothing moves but by motion.forces");
        *m = (Motion){.n = 2, .dt_s = 1, .name = "none", .format = "none"};
        TRY_ROOM(m->accel, m->n, "samples of a motion", err);
    } else {
        TRY(load(m, source.path, &how, err));
    }
    const char *words = o->record + source_path_length(o->record);
    m->file_hash = hash_fnv1a(words, strlen(words), m->file_hash); /* without words it stays what it is */
    Status status = is_still(o) ? STATUS_OK : motion_process(m, o, err);
    if (list_is_given(o->forces))
        THEN(status, forces_read(m, o->forces, err));
    if (status != STATUS_OK)
        motion_free(m);
    return status;
}
