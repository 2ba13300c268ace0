/* Spectra of ground motions: figures, histories and response spectra as text, CSV, JSON and pictures. */

#include "base/visible.h"
#include "base/json.h"
#include "base/text.h"
#include "base/units.h"
#include "cmd/commands.h"
#include "cmd/show.h"
#include "motion/motion_scale.h"
#include "motion/motion.h"
#include "motion/suite.h"
#include "motion/spectrum.h"
#include "report/panels.h"
#include "report/pictures.h"
#include "settings/settings.h"
#include "store/output.h"

enum { N_PERIODS = 121 /* 0.02 to 20 s, equally spaced in their logarithm */, PRINTED_EACH = 6, CURVES_MAX = 6 };
static const double DAMPING = 0.05, SHORTEST_S = 0.02, LONGEST_S = 20, TWO_PI = 6.283185307179586;

typedef struct {
    Motion motion;
    MotionOptions options;
    CodeSpectrum code; /* motion.target */
    MotionFigures figures, recorded;
    double *velocity, *displacement, *husid; /* (n of the motion) */
    double T[N_PERIODS], psa[N_PERIODS], psv[N_PERIODS], sd[N_PERIODS];
    double target[N_PERIODS]; /* [m/s2] of the code, else 0 */
    int is_processed; /* by motion.baseline, highpass_hz or lowpass_hz; `recorded` is without them, same scale */
    double recorded_psa[N_PERIODS];
} Spectrum;

/* ---- numbers ----------------------------------------------------------------------------------------------------- */

/* The same motion without base line and filters, at the same scale. */
static Status compare_recorded(Spectrum *s, Err *err)
{
    Motion m = {0};
    MotionOptions o = s->options;
    o.baseline = BASELINE_NONE;
    o.highpass_hz = o.lowpass_hz = 0;
    motion_unscale(&o);
    o.factor = s->motion.scale;
    TRY(motion_open(&m, &o, err));
    const Status status = motion_scale(&m, &o, err);
    if (status == STATUS_OK) {
        motion_figures(&m, &s->recorded);
        spectrum_psa(&m, DAMPING, N_PERIODS, s->T, s->recorded_psa);
    }
    motion_free(&m);
    return status;
}

static Status compute(Spectrum *s, Err *err)
{
    const Motion *m = &s->motion;
    for (int i = 0; i < N_PERIODS; i++)
        s->T[i] = SHORTEST_S * pow(LONGEST_S / SHORTEST_S, (double)i / (N_PERIODS - 1));
    spectrum_psa(m, DAMPING, N_PERIODS, s->T, s->psa);
    for (int i = 0; i < N_PERIODS; i++) {
        const double w = TWO_PI / s->T[i];
        s->psv[i] = s->psa[i] / w;
        s->sd[i] = s->psa[i] / (w * w);
        s->target[i] = target_psa(&s->code, s->T[i]);
    }
    motion_figures(m, &s->figures);
    s->is_processed = motion_is_corrected(&s->options) || s->options.lowpass_hz > 0;
    if (s->is_processed) /* before there are histories: a record being read takes as much memory again */
        TRY(compare_recorded(s, err));
    TRY_ROOM(s->velocity, 3 * m->n, "samples", err);
    s->displacement = s->velocity + m->n;
    s->husid = s->displacement + m->n;
    motion_histories(m, s->velocity, s->displacement, s->husid);
    return STATUS_OK;
}

/* Does the displacement mean something? */
static int is_corrected(const Spectrum *s)
{
    return s->motion.is_corrected || motion_is_corrected(&s->options);
}

static Status spectrum_open(Spectrum *s, const MotionOptions *o, Err *err)
{
    *s = (Spectrum){.options = *o};
    TRY(target_parse(o->target, &s->code, err));
    TRY(motion_open(&s->motion, o, err));
    TRY(motion_scale(&s->motion, o, err));
    return compute(s, err);
}

static void spectrum_close(Spectrum *s)
{
    free(s->velocity);
    motion_free(&s->motion);
}

static void average(size_t n, const Spectrum s[], double mean[N_PERIODS])
{
    for (int i = 0; i < N_PERIODS; i++) {
        mean[i] = 0;
        for (size_t k = 0; k < n; k++)
            mean[i] += s[k].psa[i] / (double)n;
    }
}

/* ---- columns ----------------------------------------------------------------------------------------------------- */

typedef struct {
    char name[160], title[24]; /* of CSV and JSON; of the table on the screen */
    double unit;               /* of the table; of times, which are not stored, the step */
    const double *x;           /* NULL: not asked for, or times */
} Curve;

enum { N_HISTORIES = 5 };

static void curves_of_one(const Spectrum *s, Curve c[CURVES_MAX])
{
    c[0] = (Curve){"period_s", "period_s", 1, s->T};
    c[1] = (Curve){"psa_m_s2", "psa_g", GRAVITY, s->psa};
    c[2] = (Curve){"psv_m_s", "psv_m_s", 1, s->psv};
    c[3] = (Curve){"sd_m", "sd_m", 1, s->sd};
    c[4] = (Curve){"recorded_psa_m_s2", "recorded", GRAVITY, s->is_processed ? s->recorded_psa : NULL};
    c[5] = (Curve){"target_psa_m_s2", "target", GRAVITY, s->code.kind ? s->target : NULL};
}

static void histories_of(const Spectrum *s, Curve c[N_HISTORIES])
{
    c[0] = (Curve){"time_s", "", s->motion.dt_s, NULL};
    c[1] = (Curve){"accel_m_s2", "", 1, s->motion.accel};
    c[2] = (Curve){"velocity_m_s", "", 1, s->velocity};
    c[3] = (Curve){"displacement_m", "", 1, s->displacement};
    c[4] = (Curve){"husid", "", 1, s->husid};
}

static void curves_of_all(size_t n, const Spectrum s[], const double mean[N_PERIODS], Curve c[])
{
    c[0] = (Curve){"period_s", "period_s", 1, s->T};
    c[1] = (Curve){"mean_psa_m_s2", "mean", GRAVITY, mean};
    c[2] = (Curve){"target_psa_m_s2", "target", GRAVITY, s->code.kind ? s->target : NULL};
    for (size_t k = 0; k < n; k++) {
        c[3 + k] = (Curve){.unit = GRAVITY, .x = s[k].psa};
        cell_text(c[3 + k].name, 128, basename(s[k].motion.name));
        strcat(c[3 + k].name, " psa_m_s2");
        snprintf(c[3 + k].title, sizeof c->title, "%zu", k + 1);
    }
}

/* Histories may have millions of rows: each is written as it comes. */
static Status write_curves(const char *path, size_t n_rows, size_t n, const Curve c[], Err *err)
{
    Output o;
    TRY(output_open(&o, path, err));
    fputs(c->name, o.stream);
    for (size_t k = 1; k < n; k++)
        if (c[k].x)
            fprintf(o.stream, ",%s", c[k].name);
    for (size_t i = 0; i < n_rows; i++) {
        fputc('\n', o.stream);
        print_number(o.stream, c->x ? c->x[i] : (double)i * c->unit);
        for (size_t k = 1; k < n; k++)
            if (c[k].x)
                print_cells(o.stream, 1, &c[k].x[i]);
    }
    fputc('\n', o.stream);
    return output_close(&o, err);
}

/* As SimCenter's tools read it, and motion/formats/simcenter.c. */
static Status write_event(const Motion *m, const char *path, Err *err)
{
    Output o;
    json_t *samples = json_array();
    for (size_t i = 0; i < m->n; i++)
        json_array_append_new(samples, json_real(m->accel[i] / GRAVITY));
    json_t *event = json_of("name=%s type=%s units=%s dT=%g numSteps=%zu data_x=%p", m->name, "Seismic", "g", m->dt_s,
                            m->n, samples);
    Status status = output_open(&o, path, err);
    if (status == STATUS_OK) {
        json_dumpf(event, o.stream, JSON_REAL_PRECISION(17));
        status = output_close(&o, err);
    }
    json_decref(event);
    return status;
}

static void print_curves(size_t n, const Curve c[])
{
    json_t *table = json_array();
    for (size_t i = 0; i < N_PERIODS; i += PRINTED_EACH) {
        json_t *row = figures_row(table);
        for (size_t k = 0; k < n; k++)
            if (c[k].x)
                json_object_set_new(row, c[k].title, json_number(c[k].x[i] / c[k].unit));
    }
    figures_print(table);
}

/* ---- pictures ---------------------------------------------------------------------------------------------------- */

#define BLUE       CASE_LOOK[SCENE_IMPACT].colour
#define VERMILLION CASE_LOOK[SCENE_NO_CORE].colour
enum { BINS = 4000 }; /* of a history: more samples are drawn as the least and the largest of each bin */

/* The times as well, in the units of the eye. */
static void add_sample(const Spectrum *s, size_t i, json_t *history[N_HISTORIES])
{
    const double values[] = {(double)i * s->motion.dt_s, s->motion.accel[i] / GRAVITY, s->velocity[i],
                             s->displacement[i], s->husid[i]};
    for (size_t k = 0; k < N_HISTORIES; k++)
        json_array_append_new(history[k], json_number(values[k]));
}

/* Of a long history two samples of each bin, the ones of the least and of the largest acceleration, in their order. */
static void add_samples(const Spectrum *s, json_t *history[N_HISTORIES])
{
    const size_t n = s->motion.n, bin = n > 4 * BINS ? n / BINS : 1;
    for (size_t begin = 0; begin < n; begin += bin) {
        size_t low = begin, high = begin;
        for (size_t i = begin; i < begin + bin && i < n; i++) {
            low = s->motion.accel[i] < s->motion.accel[low] ? i : low;
            high = s->motion.accel[i] > s->motion.accel[high] ? i : high;
        }
        add_sample(s, MIN_OF(low, high), history);
        if (low != high)
            add_sample(s, low < high ? high : low, history);
    }
}

/* Over the periods, logarithmic; a curve that is not asked for is left out. */
static void add_spectrum(json_t *lines, const Spectrum *s, const Curve *c, const char *colour, double thick)
{
    double values[N_PERIODS];
    for (int i = 0; c->x && i < N_PERIODS; i++)
        values[i] = c->x[i] / c->unit;
    json_t *line = c->x ? curve(N_PERIODS, s->T, values, colour, thick) : NULL;
    if (line)
        json_array_append_new(lines, c->x == s->target ? dashed(line) : line);
}

static json_t *spectrum_panel(const char *label, json_t *lines)
{
    json_t *axis = json_of("label=%s type=%s tickFormat=%s domain=%p ticks=%p", "period [s]", "log", "~g",
                           json_numbers(2, (double[]){SHORTEST_S, LONGEST_S}),
                           json_numbers(8, (double[]){0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10}));
    return panel("", axis, json_of("label=%s zero=%c", label, 1), lines);
}

/* Four histories on the left, under each other; on the right the spectra of acceleration and displacement. */
static Status draw_one(const Spectrum *s, const Curve c[CURVES_MAX], const char *path, Err *err)
{
    static const char *const LABELS[] = {"", "acceleration [g]", "velocity [m/s]", "displacement [m]",
                                         "share of Arias (Husid)"};
    const Motion *m = &s->motion;
    const MotionFigures *f = &s->figures;
    char title[512];
    json_t *history[N_HISTORIES], *left = json_array(), *right = json_array(), *psa = json_array(), *sd = json_array();
    for (size_t k = 0; k < N_HISTORIES; k++)
        history[k] = json_array();
    add_samples(s, history);
    for (size_t k = 1; k < N_HISTORIES; k++)
        json_array_append_new(left,
                              panel("", json_of("label=%s", "time [s]"), json_of("label=%s ticks=%d", LABELS[k], 5),
                                    json_pack("[o]", json_of("mark=%s x=%p y=%p stroke=%s strokeWidth=%g", "line",
                                                             json_incref(history[0]), history[k], BLUE, 1.0))));
    json_decref(history[0]);
    add_spectrum(psa, s, &c[1], BLUE, 2);
    add_spectrum(psa, s, &c[5], VERMILLION, 1.5);
    add_spectrum(sd, s, &c[3], BLUE, 2);
    json_array_append_new(right, spectrum_panel("pseudo-acceleration [g], 5 % damping", psa));
    json_array_append_new(right, spectrum_panel("displacement [m], 5 % damping", sd));
    snprintf(title, sizeof title, "%s%s%s: %.3f g, %.3f m/s, %.3f m%s; Arias %.3f m/s, 5 to 95 %% in %.1f s", m->name,
             m->channel[0] ? ", " : "", m->channel, f->pga_m_s2 / GRAVITY, f->pgv_m_s, f->pgd_m,
             is_corrected(s) ? "" : " (uncorrected)", f->arias_m_s, f->d5_95_s);
    return drawing_save(drawing(title, json_array(), 840, json_pack("[oo]", left, right)), 1100, path, err);
}

static Status draw_all(size_t n, const Spectrum s[], const Curve c[], const char *path, Err *err)
{
    static const char *const HUES[] = {"#56b4e9", "#009e73", "#cc79a7", "#e69f00", "#0072b2", "#8a6d00", "#9aa4af"};
    json_t *lines = json_array(), *names = json_array();
    for (size_t k = 0; k < n; k++) {
        const char *colour = HUES[k % N_OF(HUES)];
        add_spectrum(lines, s, &c[3 + k], colour, 1.2);
        json_array_append_new(names, name_of(basename(s[k].motion.name), colour, "\u25a0"));
    }
    add_spectrum(lines, s, &c[1], "#000000", 3);
    add_spectrum(lines, s, &c[2], VERMILLION, 3);
    json_array_append_new(names, name_of("mean", "#000000", "\u25a0"));
    if (c[2].x)
        json_array_append_new(names, name_of("target", VERMILLION, "\u25a0"));
    json_t *one = spectrum_panel("pseudo-acceleration [g], 5 % damping", lines);
    return drawing_save(drawing("", names, 560, json_pack("[[o]]", one)), 1000, path, err);
}

/* ---- one motion -------------------------------------------------------------------------------------------------- */

/* Figures of the motion; recorded: without base line and filters, where it has such. */
static void add_figures(json_t *o, const MotionFigures *f)
{
    json_put(o, "pga_m_s2=%g pga_g=%g pgv_m_s=%g pgd_m=%g duration_s=%g arias_m_s=%g cav_m_s=%g d5_95_s=%g",
             f->pga_m_s2, f->pga_m_s2 / GRAVITY, f->pgv_m_s, f->pgd_m, f->duration_s, f->arias_m_s, f->cav_m_s,
             f->d5_95_s);
}

/* All but the histories, which may be long. */
static json_t *describe(const Spectrum *s)
{
    const MotionFigures *r = &s->recorded;
    const Motion *m = &s->motion;
    Curve c[CURVES_MAX];
    json_t *o = json_of("motion=%s format=%s channel=%s processed=%s corrected=%c warning=%s samples=%ld scale=%g "
                        "stretch=%g step_s=%g damping=%g",
                        m->name, m->format, m->channel, m->processed, is_corrected(s), m->warning, m->n, m->scale,
                        m->stretch, m->dt_s, DAMPING);
    add_figures(o, &s->figures);
    curves_of_one(s, c);
    for (size_t k = 0; k < CURVES_MAX; k++)
        if (c[k].x && c[k].x != s->recorded_psa)
            json_object_set_new(o, c[k].name, json_numbers(N_PERIODS, c[k].x));
    if (s->is_processed)
        json_put(o, "recorded=%p",
                 json_of("pga_m_s2=%g pgv_m_s=%g pgd_m=%g psa_m_s2=%p", r->pga_m_s2, r->pgv_m_s, r->pgd_m,
                         json_numbers(N_PERIODS, s->recorded_psa)));
    if (s->code.kind)
        json_put(o, "target_misfit=%g", target_misfit(m, &s->code));
    return o;
}

/* The members of o, without the brackets around them. */
static Status print_members(json_t *o, Err *err)
{
    const int failed = json_dumpf(o, stdout, JSON_EMBED | JSON_INDENT(2) | JSON_REAL_PRECISION(17)) != 0;
    json_decref(o);
    return failed ? fail(err, STATUS_IO, "standard output: cannot be written") : STATUS_OK;
}

/* Histories number by number, for there may be millions. */
static Status print_json(const Spectrum *s, Err *err)
{
    Curve c[N_HISTORIES];
    histories_of(s, c);
    putchar('{');
    TRY(print_members(describe(s), err));
    for (size_t k = 1; k < N_HISTORIES; k++) {
        printf(",\n  \"%s\": ", c[k].name);
        print_list(stdout, s->motion.n, c[k].x);
    }
    puts("}");
    return STATUS_OK;
}

/* All that is asked for; the table where nothing is. */
static Status give_one(const Args *args, const Spectrum *s, Err *err)
{
    Curve c[CURVES_MAX], history[N_HISTORIES];
    const char *csv = args_value(args, "--csv"), *times = args_value(args, "--history");
    const char *svg = args_value(args, "--svg");
    curves_of_one(s, c);
    histories_of(s, history);
    TRY(csv ? write_curves(csv, N_PERIODS, CURVES_MAX, c, err) : STATUS_OK);
    if (times)
        TRY(text_ends(times, ".json") ? write_event(&s->motion, times, err)
                                      : write_curves(times, s->motion.n, N_HISTORIES, history, err));
    TRY(svg ? draw_one(s, c, svg, err) : STATUS_OK);
    if (args_has(args, "--json"))
        return print_json(s, err);
    if (csv || times || svg)
        return STATUS_OK;
    json_t *o = describe(s);
    show_motion(stdout, &s->motion, 0);
    figures_list(2, o);
    json_decref(o);
    puts(is_corrected(s) ? "\nresponse at 5 % damping"
                         : "pgd_m: uncorrected: the drift of the record is in it (motion.baseline, "
                           "motion.highpass_hz)\n\nresponse at 5 % damping");
    print_curves(CURVES_MAX, c);
    return STATUS_OK;
}

/* ---- several ----------------------------------------------------------------------------------------------------- */

static Status print_all_json(size_t n, const Spectrum s[], const Curve c[], Err *err)
{
    json_t *o = json_object();
    for (size_t k = 0; k < 3; k++)
        if (c[k].x)
            json_object_set_new(o, c[k].name, json_numbers(N_PERIODS, c[k].x));
    putchar('{');
    TRY(print_members(o, err));
    for (size_t k = 0; k < n; k++) {
        fputs(k ? "," : ",\n  \"motions\": [", stdout);
        TRY(print_json(&s[k], err));
    }
    puts("]}");
    return STATUS_OK;
}

static Status give_all(const Args *args, size_t n, const Spectrum s[], Curve c[], Err *err)
{
    double mean[N_PERIODS];
    const char *csv = args_value(args, "--csv"), *svg = args_value(args, "--svg");
    average(n, s, mean);
    curves_of_all(n, s, mean, c);
    TRY(csv ? write_curves(csv, N_PERIODS, n + 3, c, err) : STATUS_OK);
    TRY(svg ? draw_all(n, s, c, svg, err) : STATUS_OK);
    if (args_has(args, "--json"))
        return print_all_json(n, s, c, err);
    if (csv || svg)
        return STATUS_OK;
    for (size_t k = 0; k < n; k++) {
        printf("%zu  ", k + 1);
        show_motion(stdout, &s[k].motion, 0);
    }
    puts("\npseudo-acceleration [g] at 5 % damping");
    print_curves(n + 3, c);
    return STATUS_OK;
}

/* ---- all --------------------------------------------------------------------------------------------------------- */

typedef struct {
    const Settings *settings;
    size_t n, n_max;
    Spectrum *s; /* (n); NULL: they are only counted */
} Opened;

static Status open_next(const char *source, void *user, Err *err)
{
    Opened *all = user;
    MotionOptions o = all->settings->motion;
    if (!all->s) {
        all->n++;
        return STATUS_OK;
    }
    if (all->n == all->n_max)
        return bad_data(err, "%s: came while the others were read", source);
    TRY(option_put_path(o.record, source, err));
    return spectrum_open(&all->s[all->n++], &o, err);
}

static Status each_operand(const Args *args, Opened *all, Err *err)
{
    all->n = 0;
    for (int k = 0; k < args->n_operands; k++)
        TRY(suite_each(args->operands[k], open_next, all, err));
    return STATUS_OK;
}

static Status run(const Args *args, Err *err)
{
    Settings settings;
    Opened all = {.settings = &settings};
    settings_defaults(&settings);
    TRY(args_apply(args, &settings, NULL, NULL, err));
    TRY(settings_check(&settings, err));
    TRY(each_operand(args, &all, err));
    const size_t n = all.n_max = all.n;
    if (n > 1 && args_has(args, "--history"))
        return misused(err, "--history is of one motion, not of %zu", n);
    Curve *c = calloc(n + 3, sizeof *c);
    all.s = calloc(n, sizeof *all.s);
    Status status = all.s && c ? each_operand(args, &all, err) : fail_memory(err, n, "motions");
    THEN(status, n == 1 ? give_one(args, all.s, err) : give_all(args, n, all.s, c, err));
    for (size_t k = 0; all.s && k < n; k++)
        spectrum_close(&all.s[k]);
    free(all.s);
    free(c);
    return status;
}

static const ArgOption OPTIONS[] = {
    OPTION_CHANNEL,
    OPTION_UNIT,
    OPTION_TEXT,
    OPTION_PGA,
    OPTION_SET,
    OPTION_JSON,
    OPTION_CSV,
    VALUE("--history", "FILE",
          "acceleration, velocity, displacement and Husid's curve as CSV (NAME.json: a SimCenter event); -: standard "
          "output"),
    VALUE("--svg", "FILE", "a picture of all of it, drawn by Chromium"),
    OPTION_END,
};

const Command CMD_SPECTRUM = {
    .name = "spectrum",
    .group = GROUP_PREPARE,
    .operand = "MOTION...",
    .summary = "response spectrum, peak, duration and Arias intensity of ground motions",
    .example = "imtet spectrum builtin:kobe-like --pga 0.3 --set motion.stretch=3.1",
    .details =

        "MOTION is a file (docs/motions.md has the formats), builtin:kobe-like | builtin:elcentro-like |\n"
        "builtin:sylmar-like, or a suite: builtin:suite, a folder, or a file *list.txt. The motion is taken\n"
        "as recorded unless an option scales, stretches or processes it (--set motion.baseline=linear,\n"
        "motion.highpass_hz=0.1); the recorded figures are then shown for comparison. For several motions it\n"
        "prints their spectra, the mean, and the code spectrum of --set 'motion.target=eurocode8 ag=0.3\n"
        "soil=C'.",
    .options = OPTIONS,
    .is_alone = 1,
    .run = run,
};
