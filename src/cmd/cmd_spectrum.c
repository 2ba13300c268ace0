#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/json.h"
#include "base/cell.h"
#include "base/units.h"
#include "cmd/commands.h"
#include "cmd/show.h"
#include "cmd/spectrum.h"
#include "motion/motion_process.h"
#include "motion/motion_scale.h"
#include "settings/settings.h"
#include "store/output.h"

enum { PRINTED_EACH = 6 };

/* ---- one motion -------------------------------------------------------------------------------------------------- */

static json_t *describe_recorded(const Spectrum *s)
{
    return json_pack("{s:f, s:f, s:f, s:o}", "pga_m_s2", s->recorded.pga_m_s2, "pgv_m_s", s->recorded.pgv_m_s, "pgd_m",
                     s->recorded.pgd_m, "psa_m_s2", json_numbers(N_PERIODS, s->recorded_psa));
}

static json_t *describe(const Spectrum *s)
{
    const MotionFigures *f = &s->figures;
    const Motion *m = &s->motion;
    json_t *o = json_object();
    json_object_set_new(o, "motion", json_words(m->name));
    json_object_set_new(o, "format", json_string(m->format));
    json_object_set_new(o, "channel", json_words(m->channel));
    json_object_set_new(o, "processed", json_words(m->processed));
    json_object_set_new(o, "corrected", json_boolean(motion_is_corrected(&s->options)));
    json_object_set_new(o, "warning", json_words(m->warning));
    json_object_set_new(o, "scale", json_number(m->scale));
    json_object_set_new(o, "stretch", json_number(m->stretch));
    json_object_set_new(o, "samples", json_integer((json_int_t)m->n));
    json_object_set_new(o, "step_s", json_number(m->dt_s));
    json_object_set_new(o, "duration_s", json_number(f->duration_s));
    json_object_set_new(o, "pga_g", json_number(f->pga_m_s2 / GRAVITY));
    json_object_set_new(o, "pga_m_s2", json_number(f->pga_m_s2));
    json_object_set_new(o, "pgv_m_s", json_number(f->pgv_m_s));
    json_object_set_new(o, "pgd_m", json_number(f->pgd_m));
    json_object_set_new(o, "arias_m_s", json_number(f->arias_m_s));
    json_object_set_new(o, "cav_m_s", json_number(f->cav_m_s));
    json_object_set_new(o, "d5_95_s", json_number(f->d5_95_s));
    json_object_set_new(o, "damping", json_number(0.05));
    json_object_set_new(o, "period_s", json_numbers(N_PERIODS, s->T));
    json_object_set_new(o, "psa_m_s2", json_numbers(N_PERIODS, s->psa));
    json_object_set_new(o, "psv_m_s", json_numbers(N_PERIODS, s->psv));
    json_object_set_new(o, "sd_m", json_numbers(N_PERIODS, s->sd));
    json_object_set_new(o, "accel_m_s2", json_numbers(m->n, m->accel));
    json_object_set_new(o, "velocity_m_s", json_numbers(m->n, s->velocity));
    json_object_set_new(o, "displacement_m", json_numbers(m->n, s->displacement));
    json_object_set_new(o, "husid", json_numbers(m->n, s->husid));
    if (s->is_processed)
        json_object_set_new(o, "recorded", describe_recorded(s));
    if (s->code.kind != TARGET_NONE) {
        json_object_set_new(o, "target_psa_m_s2", json_numbers(N_PERIODS, s->target));
        json_object_set_new(o, "target_misfit", json_number(target_misfit(m, &s->code)));
    }
    return o;
}

static Status write_csv(const Spectrum *s, const char *path, Err *err)
{
    Output o;
    TRY(output_open(&o, path, err));
    fprintf(o.stream, "period_s,psa_m_s2,psv_m_s,sd_m%s%s\n", s->is_processed ? ",recorded_psa_m_s2" : "",
            s->code.kind != TARGET_NONE ? ",target_psa_m_s2" : "");
    for (int i = 0; i < N_PERIODS; i++) {
        const double row[] = {s->psa[i], s->psv[i], s->sd[i]};
        print_number(o.stream, s->T[i]);
        print_cells(o.stream, 3, row);
        if (s->is_processed)
            print_cells(o.stream, 1, &s->recorded_psa[i]);
        if (s->code.kind != TARGET_NONE)
            print_cells(o.stream, 1, &s->target[i]);
        fputc('\n', o.stream);
    }
    return output_close(&o, err);
}

static Status write_history(const Spectrum *s, const char *path, Err *err)
{
    const Motion *m = &s->motion;
    Output o;
    TRY(output_open(&o, path, err));
    fprintf(o.stream, "time_s,accel_m_s2,velocity_m_s,displacement_m,husid\n");
    for (size_t i = 0; i < m->n; i++) {
        const double row[] = {m->accel[i], s->velocity[i], s->displacement[i], s->husid[i]};
        print_number(o.stream, (double)i * m->dt_s);
        print_cells(o.stream, 4, row);
        fputc('\n', o.stream);
    }
    return output_close(&o, err);
}

static void print_head(const Spectrum *s)
{
    const Motion *m = &s->motion;
    char peak[MOTION_PEAK_TEXT_MAX], scaling[SCALINGS_TEXT_MAX];
    motion_peak_text(m, peak);
    printf("%s: %zu samples every %g s, %s, format %s%s%s\n", m->name, m->n, m->dt_s, peak, m->format,
           m->channel[0] ? ", channel " : "", m->channel);
    if (m->processed[0])
        printf("processed %s\n", m->processed);
    if (motion_scalings(&s->options, scaling))
        printf("scaled    x %.5g: %s\n", m->scale, scaling);
    if (s->code.kind != TARGET_NONE)
        printf("target    %g to %g s; ln(spectrum / target) is %.3g in the root mean square\n", s->code.from_s,
               s->code.to_s, target_misfit(m, &s->code));
    if (m->warning[0])
        printf("warning   %s\n", m->warning);
}

static void print_figures(const Spectrum *s)
{
    const MotionFigures *f = &s->figures, *r = &s->recorded;
    const int corrected = motion_is_corrected(&s->options);
    char before[3][48] = {"", "", ""};
    if (s->is_processed) {
        snprintf(before[0], sizeof before[0], ", recorded %.4f g", r->pga_m_s2 / GRAVITY);
        snprintf(before[1], sizeof before[1], "   (recorded %.4f m/s)", r->pgv_m_s);
        snprintf(before[2], sizeof before[2], "   (recorded %.4f m)", r->pgd_m);
    }
    printf("pga       %8.4f g   (%.4f m/s2%s)\n", f->pga_m_s2 / GRAVITY, f->pga_m_s2, before[0]);
    printf("pgv       %8.4f m/s%s\n", f->pgv_m_s, before[1]);
    printf("pgd       %8.4f m%s%s\n", f->pgd_m, before[2],
           corrected ? "" : "   uncorrected: the drift of the record is in it (motion.baseline, motion.highpass_hz)");
    printf("duration  %8.2f s   (5 to 95 %% of Arias: %.2f s)\narias     %8.4f m/s\ncav       %8.4f m/s\n\n",
           f->duration_s, f->d5_95_s, f->arias_m_s, f->cav_m_s);
}

static void print_table(const Spectrum *s)
{
    const int has_target = s->code.kind != TARGET_NONE;
    print_head(s);
    putchar('\n');
    print_figures(s);
    printf("response at 5 %% damping\nperiod_s     psa_g   psv_m_s      sd_m%s%s\n",
           s->is_processed ? "  recorded" : "", has_target ? "    target" : "");
    for (int i = 0; i < N_PERIODS; i += PRINTED_EACH) {
        printf("%8.4g %9.4g %9.4g %9.4g", s->T[i], s->psa[i] / GRAVITY, s->psv[i], s->sd[i]);
        if (s->is_processed)
            printf(" %9.4g", s->recorded_psa[i] / GRAVITY);
        if (has_target)
            printf(" %9.4g", s->target[i] / GRAVITY);
        putchar('\n');
    }
}

/* All that is asked for; the table where nothing is. */
static Status give_one(const Args *args, const Spectrum *s, Err *err)
{
    if (args_has(args, "--csv"))
        TRY(write_csv(s, args_value(args, "--csv"), err));
    if (args_has(args, "--history"))
        TRY(write_history(s, args_value(args, "--history"), err));
    if (args_has(args, "--svg"))
        TRY(spectrum_draw(s, args_value(args, "--svg"), err));
    if (args_has(args, "--json"))
        return show_json(describe(s), err);
    if (!args_has(args, "--csv") && !args_has(args, "--history") && !args_has(args, "--svg"))
        print_table(s);
    return STATUS_OK;
}

/* ---- several ----------------------------------------------------------------------------------------------------- */

static Status write_csv_of_all(size_t n, const Spectrum s[], const char *path, Err *err)
{
    Output o;
    double mean[N_PERIODS];
    spectra_average(n, s, mean);
    TRY(output_open(&o, path, err));
    fprintf(o.stream, "period_s,mean_psa_m_s2%s", s->code.kind != TARGET_NONE ? ",target_psa_m_s2" : "");
    for (size_t k = 0; k < n; k++) {
        char name[128];
        cell_text(name, sizeof name, spectrum_name(&s[k]));
        fprintf(o.stream, ",%s psa_m_s2", name);
    }
    fputc('\n', o.stream);
    for (int i = 0; i < N_PERIODS; i++) {
        print_number(o.stream, s->T[i]);
        print_cells(o.stream, 1, &mean[i]);
        if (s->code.kind != TARGET_NONE)
            print_cells(o.stream, 1, &s->target[i]);
        for (size_t k = 0; k < n; k++)
            print_cells(o.stream, 1, &s[k].psa[i]);
        fputc('\n', o.stream);
    }
    return output_close(&o, err);
}

static json_t *describe_all(size_t n, const Spectrum s[])
{
    double mean[N_PERIODS];
    json_t *o = json_object(), *list = json_array();
    spectra_average(n, s, mean);
    for (size_t k = 0; k < n; k++)
        json_array_append_new(list, describe(&s[k]));
    json_object_set_new(o, "motions", list);
    json_object_set_new(o, "period_s", json_numbers(N_PERIODS, s->T));
    json_object_set_new(o, "mean_psa_m_s2", json_numbers(N_PERIODS, mean));
    if (s->code.kind != TARGET_NONE)
        json_object_set_new(o, "target_psa_m_s2", json_numbers(N_PERIODS, s->target));
    return o;
}

static void print_all(size_t n, const Spectrum s[])
{
    const int has_target = s->code.kind != TARGET_NONE;
    double mean[N_PERIODS];
    spectra_average(n, s, mean);
    for (size_t k = 0; k < n; k++) {
        printf("%zu  ", k + 1);
        print_head(&s[k]);
    }
    printf("\npseudo-acceleration [g] at 5 %% damping\nperiod_s      mean%s", has_target ? "    target" : "");
    for (size_t k = 0; k < n; k++)
        printf(" %9zu", k + 1);
    putchar('\n');
    for (int i = 0; i < N_PERIODS; i += PRINTED_EACH) {
        printf("%8.4g %9.4g", s->T[i], mean[i] / GRAVITY);
        if (has_target)
            printf(" %9.4g", s->target[i] / GRAVITY);
        for (size_t k = 0; k < n; k++)
            printf(" %9.4g", s[k].psa[i] / GRAVITY);
        putchar('\n');
    }
}

static Status give_all(const Args *args, size_t n, const Spectrum s[], Err *err)
{
    if (args_has(args, "--csv"))
        TRY(write_csv_of_all(n, s, args_value(args, "--csv"), err));
    if (args_has(args, "--svg"))
        TRY(spectra_draw(n, s, args_value(args, "--svg"), err));
    if (args_has(args, "--json"))
        return show_json(describe_all(n, s), err);
    if (!args_has(args, "--csv") && !args_has(args, "--svg"))
        print_all(n, s);
    return STATUS_OK;
}

/* ---- all --------------------------------------------------------------------------------------------------------- */

static Status open_all(const Args *args, const Settings *settings, Spectrum s[], Err *err)
{
    for (int k = 0; k < args->n_operands; k++) {
        MotionOptions o = settings->motion;
        TRY(option_put_path(o.record, args->operands[k], err));
        TRY(spectrum_open(&s[k], &o, err));
    }
    return STATUS_OK;
}

static Status run(const Args *args, Err *err)
{
    Settings settings;
    const size_t n = (size_t)args->n_operands;
    settings_defaults(&settings);
    TRY(args_apply(args, &settings, NULL, NULL, err));
    TRY(settings_check(&settings, err));
    if (n > 1 && args_has(args, "--history"))
        return fail(err, STATUS_USAGE, "--history is of one motion, not of %zu", n);
    Spectrum *s = calloc(n, sizeof *s);
    if (!s)
        return fail(err, STATUS_NO_MEMORY, "no memory for %zu motions", n);
    Status status = open_all(args, &settings, s, err);
    if (status == STATUS_OK)
        status = n == 1 ? give_one(args, s, err) : give_all(args, n, s, err);
    for (size_t k = 0; k < n; k++)
        spectrum_close(&s[k]);
    free(s);
    return status;
}

static const ArgOption OPTIONS[] = {
    OPTION_CHANNEL,
    OPTION_UNIT,
    OPTION_PGA,
    OPTION_STRETCH,
    OPTION_SET,
    OPTION_JSON,
    OPTION_CSV,
    {"--history", "FILE", NULL, 0, "acceleration, velocity, displacement and Husid's curve as CSV; -: standard output"},
    {"--svg", "FILE", NULL, 0, "a picture of all of it, drawn by gnuplot"},
    OPTION_END,
};

const Command CMD_SPECTRUM = {
    .name = "spectrum",
    .group = GROUP_PREPARE,
    .operand = "MOTION...",
    .summary = "response spectrum, peak, duration and Arias intensity of ground motions",
    .example = "imtet spectrum builtin:kobe-like --pga 0.3 --stretch 3.1",
    .details = "MOTION is a file (the formats of docs/motions.md) or\n"
               "builtin:kobe-like | builtin:elcentro-like | builtin:sylmar-like. It is taken as recorded unless an "
               "option\n"
               "scales it, stretches it, or processes it (--set motion.baseline=linear, motion.highpass_hz=0.1): then "
               "the\n"
               "recorded figures stand beside. Several motions: their spectra, the mean, and the code spectrum of\n"
               "--set 'motion.target=eurocode8 ag=0.3 soil=C'.",
    .options = OPTIONS,
    .is_alone = 1,
    .run = run,
};
