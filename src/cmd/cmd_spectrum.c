#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/units.h"
#include "cmd/commands.h"
#include "cmd/show.h"
#include "report/gnuplot.h"
#include "store/output.h"
#include "scene/spectrum.h"
#include "scene/motion_source.h"
#include "settings/settings.h"

enum { N_PERIODS = 121, PRINTED_EACH = 6 };
static const double DAMPING = 0.05, SHORTEST_S = 0.02, LONGEST_S = 20, TWO_PI = 6.283185307179586;

typedef struct {
    const Motion *motion;
    MotionFigures figures;
    double *velocity, *displacement, *husid; /* (n of the motion) */
    double T[N_PERIODS], psa[N_PERIODS], psv[N_PERIODS], sd[N_PERIODS];
} Spectrum;

static Status compute(const Motion *m, Spectrum *s, Err *err)
{
    s->motion = m;
    s->velocity = malloc(3 * m->n * sizeof *s->velocity);
    if (!s->velocity)
        return fail(err, STATUS_NO_MEMORY, "no memory for the histories of %zu samples", m->n);
    s->displacement = s->velocity + m->n;
    s->husid = s->displacement + m->n;
    motion_histories(m, s->velocity, s->displacement, s->husid);
    for (int i = 0; i < N_PERIODS; i++)
        s->T[i] = SHORTEST_S * pow(LONGEST_S / SHORTEST_S, (double)i / (N_PERIODS - 1));
    spectrum_psa(m, DAMPING, N_PERIODS, s->T, s->psa);
    for (int i = 0; i < N_PERIODS; i++) {
        const double w = TWO_PI / s->T[i];
        s->psv[i] = s->psa[i] / w;
        s->sd[i] = s->psa[i] / (w * w);
    }
    motion_figures(m, &s->figures);
    return STATUS_OK;
}

static Status print_json(const Spectrum *s, const Motion *m, Err *err)
{
    const MotionFigures *f = &s->figures;
    json_t *o = json_object();
    json_object_set_new(o, "motion", json_string(m->name));
    json_object_set_new(o, "format", json_string(m->format));
    json_object_set_new(o, "channel", json_string(m->channel));
    json_object_set_new(o, "processed", json_string(m->processed));
    json_object_set_new(o, "warning", json_string(m->warning));
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
    json_object_set_new(o, "damping", json_number(DAMPING));
    json_object_set_new(o, "period_s", json_numbers(N_PERIODS, s->T));
    json_object_set_new(o, "psa_m_s2", json_numbers(N_PERIODS, s->psa));
    json_object_set_new(o, "psv_m_s", json_numbers(N_PERIODS, s->psv));
    json_object_set_new(o, "sd_m", json_numbers(N_PERIODS, s->sd));
    json_object_set_new(o, "accel_m_s2", json_numbers(m->n, m->accel));
    json_object_set_new(o, "velocity_m_s", json_numbers(m->n, s->velocity));
    json_object_set_new(o, "displacement_m", json_numbers(m->n, s->displacement));
    json_object_set_new(o, "husid", json_numbers(m->n, s->husid));
    return show_json(o, err);
}

static Status write_csv(const Spectrum *s, const char *path, Err *err)
{
    Output o;
    TRY(output_open(&o, path, err));
    fprintf(o.stream, "period_s,psa_m_s2,psv_m_s,sd_m\n");
    for (int i = 0; i < N_PERIODS; i++) {
        const double row[] = {s->T[i], s->psa[i], s->psv[i], s->sd[i]};
        for (int j = 0; j < 4; j++) {
            print_number(o.stream, row[j]);
            fputc(j < 3 ? ',' : '\n', o.stream);
        }
    }
    return output_close(&o, err);
}

static Status write_history(const Spectrum *s, const char *path, Err *err)
{
    const Motion *m = s->motion;
    Output o;
    TRY(output_open(&o, path, err));
    fprintf(o.stream, "time_s,accel_m_s2,velocity_m_s,displacement_m,husid\n");
    for (size_t i = 0; i < m->n; i++) {
        const double row[] = {(double)i * m->dt_s, m->accel[i], s->velocity[i], s->displacement[i], s->husid[i]};
        for (int j = 0; j < 5; j++) {
            print_number(o.stream, row[j]);
            fputc(j < 4 ? ',' : '\n', o.stream);
        }
    }
    return output_close(&o, err);
}

/* Four histories on the left, under each other; on the right the spectra of acceleration and displacement. */
static const char PANELS[] =
    "set terminal svg size 1100,900 font 'sans,13' noenhanced background '#ffffff'\n"
    "set grid lc '#d0d0d0'\nunset key\nset lmargin 0\nset rmargin 0\nset tmargin 0\nset bmargin 0\n"
    "set multiplot\nset size 0.46,0.19\nset xrange [0:END]\nset format x ''\nset ytics nomirror\n"
    "set origin 0.09,0.74\nset ylabel 'acceleration [g]' offset 0\n"
    "plot $H using 1:2 with lines lc '#0072b2'\n"
    "unset label 1\nset origin 0.09,0.52\nset ylabel 'velocity [m/s]'\nplot $H using 1:3 with lines lc '#0072b2'\n"
    "set origin 0.09,0.30\nset ylabel 'displacement [m]'\nplot $H using 1:4 with lines lc '#0072b2'\n"
    "set origin 0.09,0.08\nset format x '%g'\nset xlabel 'time [s]'\nset ylabel 'share of Arias (Husid)'\n"
    "set yrange [0:1]\nplot $H using 1:5 with lines lc '#d55e00'\n"
    "set autoscale y\nset logscale x\nset xrange [0.02:20]\nset size 0.33,0.41\n"
    "set origin 0.65,0.52\nset format x ''\nunset xlabel\nset ylabel 'pseudo-acceleration [g], 5 % damping'\n"
    "set yrange [0:*]\nplot $S using 1:2 with lines lw 2 lc '#0072b2'\n"
    "set origin 0.65,0.08\nset format x '%g'\nset xlabel 'period [s]'\nset ylabel 'displacement [m], 5 % damping'\n"
    "plot $S using 1:3 with lines lw 2 lc '#0072b2'\nunset multiplot\n";

static void write_script(FILE *script, const void *user)
{
    const Spectrum *s = user;
    const Motion *m = s->motion;
    const MotionFigures *f = &s->figures;
    char title[512];
    fprintf(script, "$H << EOD\n");
    for (size_t i = 0; i < m->n; i++)
        fprintf(script, "%.7g %.6g %.6g %.6g %.6g\n", (double)i * m->dt_s, m->accel[i] / GRAVITY, s->velocity[i],
                s->displacement[i], s->husid[i]);
    fprintf(script, "EOD\n$S << EOD\n");
    for (int i = 0; i < N_PERIODS; i++)
        fprintf(script, "%.6g %.6g %.6g\n", s->T[i], s->psa[i] / GRAVITY, s->sd[i]);
    snprintf(title, sizeof title, "%s%s%s: %.3f g, %.3f m/s, %.3f m; Arias %.3f m/s, 5 to 95 %% in %.1f s", m->name,
             m->channel[0] ? ", " : "", m->channel, f->pga_m_s2 / GRAVITY, f->pgv_m_s, f->pgd_m, f->arias_m_s,
             f->d5_95_s);
    fprintf(script, "EOD\nEND = %.7g\nset label 1 ", f->duration_s);
    gnuplot_quote(script, title);
    fprintf(script, " at screen 0.5,0.965 center noenhanced\n%s", PANELS);
}

static void print_table(const Spectrum *s, const Motion *m)
{
    const MotionFigures *f = &s->figures;
    char peak[MOTION_PEAK_TEXT_MAX];
    motion_peak_text(m, peak);
    printf("%s: %zu samples every %g s, %s, format %s%s%s\n", m->name, m->n, m->dt_s, peak, m->format,
           m->channel[0] ? ", channel " : "", m->channel);
    if (m->processed[0])
        printf("processed %s\n", m->processed);
    if (m->warning[0])
        printf("warning   %s\n", m->warning);
    putchar('\n');
    printf("pga       %8.4f g   (%.4f m/s2)\npgv       %8.4f m/s\npgd       %8.4f m\n", f->pga_m_s2 / GRAVITY,
           f->pga_m_s2, f->pgv_m_s, f->pgd_m);
    printf("duration  %8.2f s   (5 to 95 %% of Arias: %.2f s)\narias     %8.4f m/s\ncav       %8.4f m/s\n\n",
           f->duration_s, f->d5_95_s, f->arias_m_s, f->cav_m_s);
    printf("response at %g %% damping\nperiod_s     psa_g   psv_m_s      sd_m\n", 100 * DAMPING);
    for (int i = 0; i < N_PERIODS; i += PRINTED_EACH)
        printf("%8.4g %9.4g %9.4g %9.4g\n", s->T[i], s->psa[i] / GRAVITY, s->psv[i], s->sd[i]);
}

/* All that is asked for; the table where nothing is. */
static Status give(const Args *args, const Spectrum *s, Err *err)
{
    if (args_has(args, "--csv"))
        TRY(write_csv(s, args_value(args, "--csv"), err));
    if (args_has(args, "--history"))
        TRY(write_history(s, args_value(args, "--history"), err));
    if (args_has(args, "--svg"))
        TRY(gnuplot_draw(args_value(args, "--svg"), write_script, s, err));
    if (args_has(args, "--json"))
        return print_json(s, s->motion, err);
    if (!args_has(args, "--csv") && !args_has(args, "--history") && !args_has(args, "--svg"))
        print_table(s, s->motion);
    return STATUS_OK;
}

static Status run(const Args *args, Err *err)
{
    Settings s;
    Motion m = {0};
    Spectrum spectrum = {0};
    settings_defaults(&s);
    TRY(args_apply(args, &s, NULL, NULL, err));
    if (strlen(args->operand) >= sizeof s.motion.record)
        return fail(err, STATUS_MISSING, "%.60s...: the path is too long", args->operand);
    snprintf(s.motion.record, sizeof s.motion.record, "%s", args->operand);
    TRY(motion_open(&m, &s.motion, err));
    Status status = motion_prepare(&m, s.motion.pga_g, s.motion.stretch, err);
    if (status == STATUS_OK)
        status = compute(&m, &spectrum, err);
    if (status == STATUS_OK)
        status = give(args, &spectrum, err);
    free(spectrum.velocity);
    motion_free(&m);
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
    .operand = "MOTION",
    .summary = "response spectrum, peak, duration and Arias intensity of a ground motion",
    .example = "imtet spectrum builtin:kobe-like --pga 0.3 --stretch 3.1",
    .details = "MOTION is a file (the formats of docs/motions.md) or\n"
               "builtin:kobe-like | builtin:elcentro-like | builtin:sylmar-like. It is taken as recorded unless --pga "
               "or --stretch say otherwise.",
    .options = OPTIONS,
    .run = run,
};
