#include <math.h>
#include <string.h>

#include "cmd/commands.h"
#include "cmd/show.h"
#include "run/output.h"
#include "scene/spectrum.h"

enum { N_PERIODS = 121, PRINTED_EACH = 6 };
static const double DAMPING = 0.05, SHORTEST_S = 0.02, LONGEST_S = 20, G = 9.81, TWO_PI = 6.283185307179586;

typedef struct {
    MotionFigures figures;
    double T[N_PERIODS], psa[N_PERIODS], psv[N_PERIODS], sd[N_PERIODS];
} Spectrum;

static void compute(const Motion *m, Spectrum *s)
{
    for (int i = 0; i < N_PERIODS; i++)
        s->T[i] = SHORTEST_S * pow(LONGEST_S / SHORTEST_S, (double)i / (N_PERIODS - 1));
    spectrum_psa(m, DAMPING, N_PERIODS, s->T, s->psa);
    for (int i = 0; i < N_PERIODS; i++) {
        const double w = TWO_PI / s->T[i];
        s->psv[i] = s->psa[i] / w;
        s->sd[i] = s->psa[i] / (w * w);
    }
    motion_figures(m, &s->figures);
}

static Status print_json(const Spectrum *s, const Motion *m, Err *err)
{
    const MotionFigures *f = &s->figures;
    json_t *o = json_object();
    json_object_set_new(o, "motion", json_string(m->name));
    json_object_set_new(o, "samples", json_integer((json_int_t)m->n));
    json_object_set_new(o, "step_s", json_number(m->dt_s));
    json_object_set_new(o, "duration_s", json_number(f->duration_s));
    json_object_set_new(o, "pga_g", json_number(f->pga_m_s2 / G));
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

static void print_table(const Spectrum *s, const Motion *m)
{
    const MotionFigures *f = &s->figures;
    printf("%s: %zu samples every %g s\n\n", m->name, m->n, m->dt_s);
    printf("pga       %8.4f g   (%.4f m/s2)\npgv       %8.4f m/s\npgd       %8.4f m\n", f->pga_m_s2 / G, f->pga_m_s2,
           f->pgv_m_s, f->pgd_m);
    printf("duration  %8.2f s   (5 to 95 %% of Arias: %.2f s)\narias     %8.4f m/s\ncav       %8.4f m/s\n\n",
           f->duration_s, f->d5_95_s, f->arias_m_s, f->cav_m_s);
    printf("response at %g %% damping\nperiod_s     psa_g   psv_m_s      sd_m\n", 100 * DAMPING);
    for (int i = 0; i < N_PERIODS; i += PRINTED_EACH)
        printf("%8.4g %9.4g %9.4g %9.4g\n", s->T[i], s->psa[i] / G, s->psv[i], s->sd[i]);
}

static Status run(const Args *args, Err *err)
{
    Settings s;
    Motion m = {0};
    Spectrum spectrum;
    settings_defaults(&s);
    s.motion.pga_g = 0;
    s.motion.stretch = 1;
    TRY(args_apply(args, &s, NULL, NULL, err));
    if (strlen(args->operand) >= sizeof s.motion.record)
        return fail(err, STATUS_MISSING, "%.60s...: the path is too long", args->operand);
    snprintf(s.motion.record, sizeof s.motion.record, "%s", args->operand);
    TRY(motion_open(&m, &s, err));
    Status status = motion_prepare(&m, s.motion.pga_g, s.motion.stretch, err);
    if (status == STATUS_OK) {
        compute(&m, &spectrum);
        if (args_has(args, "--csv"))
            status = write_csv(&spectrum, args_value(args, "--csv"), err);
        if (status == STATUS_OK && args_has(args, "--json"))
            status = print_json(&spectrum, &m, err);
        else if (status == STATUS_OK && !args_has(args, "--csv"))
            print_table(&spectrum, &m);
    }
    motion_free(&m);
    return status;
}

static const ArgOption OPTIONS[] = {OPTION_UNIT, OPTION_PGA, OPTION_STRETCH, OPTION_JSON, OPTION_CSV, OPTION_END};

const Command CMD_SPECTRUM = {
    .name = "spectrum",
    .operand = "MOTION",
    .summary = "response spectrum, peak, duration and Arias intensity of a ground motion",
    .example = "imtet spectrum builtin:kobe-like --pga 0.3 --stretch 3.1",
    .details = "MOTION is a file (two-column CSV or PEER AT2) or builtin:kobe-like | builtin:elcentro-like |\n"
               "builtin:sylmar-like. It is taken as recorded unless --pga or --stretch say otherwise.",
    .options = OPTIONS,
    .run = run,
};
