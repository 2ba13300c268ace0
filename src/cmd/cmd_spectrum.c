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
#include "settings/settings.h"
#include "store/output.h"

enum { N_PERIODS = 121 /* 0.02 to 20 s, equally spaced in their logarithm */, PRINTED_EACH = 6 };
static const double DAMPING = 0.05, SHORTEST_S = 0.02, LONGEST_S = 20, TWO_PI = 6.283185307179586;

typedef struct {
    Motion motion;
    MotionOptions options;
    CodeSpectrum code; /* motion.target */
    MotionFigures figures, recorded;
    double *velocity, *displacement, *husid; /* (n of the motion) */
    double T[N_PERIODS], psa[N_PERIODS];
    int is_processed; /* by motion.baseline, highpass_hz or lowpass_hz; `recorded` is without them, same scale */
    double recorded_psa[N_PERIODS];
} Spectrum;

/* ---- numbers ----------------------------------------------------------------------------------------------------- */

/* Does the displacement mean something? */
static int is_corrected(const Spectrum *s)
{
    return s->motion.is_corrected || motion_is_corrected(&s->options);
}

static Status spectrum_open(Spectrum *s, const MotionOptions *o, Err *err)
{
    Motion *m = &s->motion;
    *s = (Spectrum){.options = *o};
    TRY(target_parse(o->target, &s->code, err));
    TRY(motion_open(m, o, err));
    TRY(motion_scale(m, o, err));
    for (int i = 0; i < N_PERIODS; i++)
        s->T[i] = SHORTEST_S * pow(LONGEST_S / SHORTEST_S, (double)i / (N_PERIODS - 1));
    spectrum_psa(m, DAMPING, N_PERIODS, s->T, s->psa);
    motion_figures(m, &s->figures);
    s->is_processed = motion_is_corrected(o) || o->lowpass_hz > 0;
    if (s->is_processed) {  /* before there are histories: a record being read takes as much memory again */
        Motion as_is = {0}; /* without base line and filters, at the same scale */
        MotionOptions plain = *o;
        plain.baseline = BASELINE_NONE;
        plain.highpass_hz = plain.lowpass_hz = 0;
        motion_unscale(&plain);
        plain.factor = m->scale;
        TRY(motion_open(&as_is, &plain, err));
        const Status status = motion_scale(&as_is, &plain, err);
        if (status == STATUS_OK) {
            motion_figures(&as_is, &s->recorded);
            spectrum_psa(&as_is, DAMPING, N_PERIODS, s->T, s->recorded_psa);
        }
        motion_free(&as_is);
        TRY(status);
    }
    TRY_ROOM(s->velocity, 3 * m->n, "samples", err);
    s->displacement = s->velocity + m->n;
    s->husid = s->displacement + m->n;
    motion_histories(m, s->velocity, s->displacement, s->husid);
    return STATUS_OK;
}

/* ---- files and answers ------------------------------------------------------------------------------------------- */

/* A row for every period, or for every few. */
static json_t *rows_of(size_t n, const Spectrum s[], size_t every)
{
    json_t *table = json_array();
    for (size_t i = 0; i < N_PERIODS; i += every) {
        const double w = TWO_PI / s->T[i];
        double mean = 0;
        json_t *row = json_put(figures_row(table), "period_s=%g", s->T[i]);
        for (size_t k = 0; k < n; k++)
            mean += s[k].psa[i] / (double)n;
        if (n == 1)
            json_put(row, "psa_m_s2=%g psv_m_s=%g sd_m=%g", s->psa[i], s->psa[i] / w, s->psa[i] / (w * w));
        else
            json_put(row, "mean_psa_m_s2=%g", mean);
        if (n == 1 && s->is_processed)
            json_put(row, "recorded_psa_m_s2=%g", s->recorded_psa[i]);
        if (s->code.kind)
            json_put(row, "target_psa_m_s2=%g", target_psa(&s->code, s->T[i]));
        for (size_t k = 0; k < n && n > 1; k++) {
            char name[160];
            cell_text(name, 128, basename(s[k].motion.name));
            strcat(name, " psa_m_s2");
            if (json_object_get(row, name))
                snprintf(name, sizeof name, "%zu psa_m_s2", k + 1);
            json_object_set_new(row, name, json_number(s[k].psa[i]));
        }
    }
    return table;
}

/* There may be millions of rows: each is written as it comes. */
static Status write_history(const Spectrum *s, const char *path, Err *err)
{
    Output o;
    TRY(output_open(&o, path, err));
    fputs("time_s,accel_m_s2,velocity_m_s,displacement_m,husid\n", o.stream);
    for (size_t i = 0; i < s->motion.n; i++) {
        const double values[] = {s->motion.accel[i], s->velocity[i], s->displacement[i], s->husid[i]};
        print_number(o.stream, (double)i * s->motion.dt_s);
        print_cells(o.stream, N_OF(values), values);
        fputc('\n', o.stream);
    }
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

/* Figures of the motion, also without base line and filters, where it has such. with_histories: they may be millions of
 * numbers. */
static json_t *describe(const Spectrum *s, int with_histories)
{
    const MotionFigures *f = &s->figures, *r = &s->recorded;
    const Motion *m = &s->motion;
    json_t *rows = rows_of(1, s, 1);
    json_t *o = json_of("motion=%s format=%s channel=%s processed=%s corrected=%c warning=%s samples=%ld scale=%g "
                        "stretch=%g step_s=%g damping=%g pga_m_s2=%g pga_g=%g pgv_m_s=%g pgd_m=%g duration_s=%g "
                        "arias_m_s=%g cav_m_s=%g d5_95_s=%g",
                        m->name, m->format, m->channel, m->processed, is_corrected(s), m->warning, m->n, m->scale,
                        m->stretch, m->dt_s, DAMPING, f->pga_m_s2, f->pga_m_s2 / GRAVITY, f->pgv_m_s, f->pgd_m,
                        f->duration_s, f->arias_m_s, f->cav_m_s, f->d5_95_s);
    json_put(o, "period_s=%p psa_m_s2=%p psv_m_s=%p sd_m=%p target_psa_m_s2=%p", json_column(rows, "period_s"),
             json_column(rows, "psa_m_s2"), json_column(rows, "psv_m_s"), json_column(rows, "sd_m"),
             json_column(rows, "target_psa_m_s2"));
    json_decref(rows);
    if (s->is_processed)
        json_put(o, "recorded=%p",
                 json_of("pga_m_s2=%g pgv_m_s=%g pgd_m=%g psa_m_s2=%p", r->pga_m_s2, r->pgv_m_s, r->pgd_m,
                         json_numbers(N_PERIODS, s->recorded_psa)));
    if (s->code.kind)
        json_put(o, "target_misfit=%g", target_misfit(m, &s->code));
    if (with_histories)
        json_put(o, "accel_m_s2=%p velocity_m_s=%p displacement_m=%p husid=%p", json_numbers(m->n, m->accel),
                 json_numbers(m->n, s->velocity), json_numbers(m->n, s->displacement), json_numbers(m->n, s->husid));
    return o;
}

static Status give(const Args *args, size_t n, const Spectrum s[], Err *err)
{
    const char *times = args_value(args, "--history");
    const int with_histories = args_has(args, "--json") || (n == 1 && args_has(args, "--svg"));
    if (times)
        TRY(text_ends(times, ".json") ? write_event(&s->motion, times, err) : write_history(s, times, err));
    Document d = {.rows = rows_of(n, s, 1), .drawing = "motion", .width = 1100};
    json_t *motions = json_array();
    for (size_t k = 0; k < n; k++) {
        json_array_append_new(motions, describe(&s[k], with_histories));
        document_motion(&d, &s[k].motion, 0);
    }
    d.data =
        n == 1 ? json_only(motions)
               : json_of("period_s=%p mean_psa_m_s2=%p target_psa_m_s2=%p motions=%p", json_column(d.rows, "period_s"),
                         json_column(d.rows, "mean_psa_m_s2"), json_column(d.rows, "target_psa_m_s2"), motions);
    if (n == 1)
        document_list(&d, describe(s, 0));
    if (n == 1 && !is_corrected(s))
        document_say(&d,
                     "pgd_m: uncorrected: it contains the drift of the record (motion.baseline, motion.highpass_hz)");
    document_say(&d, "response at 5 %% damping");
    json_t *table = rows_of(n, s, PRINTED_EACH);
    json_array_extend(document_table(&d), table);
    json_decref(table);
    return document_give(&d, args, err);
}

/* ---- all --------------------------------------------------------------------------------------------------------- */

typedef struct {
    const Settings *settings;
    size_t n;
    Spectrum *s; /* (n) */
} Opened;

static Status open_next(const char *source, void *user, Err *err)
{
    Opened *all = user;
    MotionOptions o = all->settings->motion;
    Spectrum *more = realloc(all->s, (all->n + 1) * sizeof *more);
    if (!more)
        return fail_memory(err, all->n + 1, "motions");
    all->s = more;
    TRY(option_put_path(o.record, source, err));
    return spectrum_open(&more[all->n++], &o, err);
}

static Status run(const Args *args, Err *err)
{
    Settings settings;
    Opened all = {.settings = &settings};
    Status status = STATUS_OK;
    settings_defaults(&settings);
    TRY(args_apply(args, &settings, NULL, NULL, err));
    TRY(settings_check(&settings, err));
    for (int k = 0; k < args->n_operands; k++)
        THEN(status, suite_each(args->operands[k], open_next, &all, err));
    if (all.n > 1 && args_has(args, "--history"))
        THEN(status, misused(err, "--history takes one motion, not %zu", all.n));
    THEN(status, give(args, all.n, all.s, err));
    for (size_t k = 0; k < all.n; k++) {
        free(all.s[k].velocity);
        motion_free(&all.s[k].motion);
    }
    free(all.s);
    return status;
}

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
    .options =
        {
            OPTION_UNIT,
            OPTION_TEXT,
            OPTION_PGA,
            OPTION_SET,
            OPTION_JSON,
            OPTION_CSV,
            VALUE("--history", "FILE",
                  "acceleration, velocity, displacement, Husid's curve as CSV (NAME.json: SimCenter); -: standard "
                  "output"),
            VALUE("--svg", "FILE", "a picture of spectrum and histories, drawn by Chromium"),
        },
    .is_alone = 1,
    .run = run,
};
