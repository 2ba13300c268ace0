#include "cmd/spectrum.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/stat.h"
#include "base/units.h"
#include "report/gnuplot.h"
#include "motion/motion_process.h"
#include "motion/motion_scale.h"
#include "motion/motion_source.h"

static const double DAMPING = 0.05, SHORTEST_S = 0.02, LONGEST_S = 20, TWO_PI = 6.283185307179586;

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
        s->target[i] = target_psa(&s->code, s->T[i]);
    }
    motion_figures(m, &s->figures);
    s->is_processed = motion_is_corrected(&s->options) || s->options.lowpass_hz > 0;
    return s->is_processed ? compare_recorded(s, err) : STATUS_OK;
}

Status spectrum_open(Spectrum *s, const MotionOptions *o, Err *err)
{
    *s = (Spectrum){.options = *o};
    TRY(target_parse(o->target, &s->code, err));
    TRY(motion_open(&s->motion, o, err));
    TRY(motion_scale(&s->motion, o, err));
    return compute(s, err);
}

void spectrum_close(Spectrum *s)
{
    free(s->velocity);
    s->velocity = NULL;
    motion_free(&s->motion);
}

typedef struct {
    const Spectrum *s;
    int period;
} Column;

static double psa_of(size_t k, const void *user)
{
    const Column *c = user;
    return c->s[k].psa[c->period];
}

void spectra_average(size_t n, const Spectrum s[], double mean[N_PERIODS])
{
    for (int i = 0; i < N_PERIODS; i++)
        mean_and_sd(n, psa_of, &(Column){s, i}, &mean[i], NULL);
}

const char *spectrum_name(const Spectrum *s)
{
    const char *slash = strrchr(s->motion.name, '/');
    return slash ? slash + 1 : s->motion.name;
}

/* ---- pictures ---------------------------------------------------------------------------------------------------- */

enum { BINS = 4000 }; /* of a history: more samples are drawn as the least and the largest of each bin */

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
    "set yrange [0:*]\nplot $S using 1:2 with lines lw 2 lc '#0072b2', "
    "'' using 1:($4 > 0 ? $4 : NaN) with lines dt (6,4) lc '#d55e00'\n"
    "set origin 0.65,0.08\nset format x '%g'\nset xlabel 'period [s]'\nset ylabel 'displacement [m], 5 % damping'\n"
    "plot $S using 1:3 with lines lw 2 lc '#0072b2'\nunset multiplot\n";

static void write_sample(FILE *script, const Spectrum *s, size_t i)
{
    fprintf(script, "%.7g %.6g %.6g %.6g %.6g\n", (double)i * s->motion.dt_s, s->motion.accel[i] / GRAVITY,
            s->velocity[i], s->displacement[i], s->husid[i]);
}

/* Of a long history two samples of each bin, the ones of the least and of the largest acceleration, in their order. */
static void write_history(FILE *script, const Spectrum *s)
{
    const size_t n = s->motion.n, bin = n > 4 * BINS ? n / BINS : 1;
    for (size_t begin = 0; begin < n; begin += bin) {
        size_t low = begin, high = begin;
        for (size_t i = begin; i < begin + bin && i < n; i++) {
            low = s->motion.accel[i] < s->motion.accel[low] ? i : low;
            high = s->motion.accel[i] > s->motion.accel[high] ? i : high;
        }
        write_sample(script, s, low < high ? low : high);
        if (low != high)
            write_sample(script, s, low < high ? high : low);
    }
}

static void write_one(FILE *script, const void *user)
{
    const Spectrum *s = user;
    const Motion *m = &s->motion;
    const MotionFigures *f = &s->figures;
    char title[512];
    fprintf(script, "$H << EOD\n");
    write_history(script, s);
    fprintf(script, "EOD\n$S << EOD\n");
    for (int i = 0; i < N_PERIODS; i++)
        fprintf(script, "%.6g %.6g %.6g %.6g\n", s->T[i], s->psa[i] / GRAVITY, s->sd[i], s->target[i] / GRAVITY);
    snprintf(title, sizeof title, "%s%s%s: %.3f g, %.3f m/s, %.3f m%s; Arias %.3f m/s, 5 to 95 %% in %.1f s", m->name,
             m->channel[0] ? ", " : "", m->channel, f->pga_m_s2 / GRAVITY, f->pgv_m_s, f->pgd_m,
             motion_is_corrected(&s->options) ? "" : " (uncorrected)", f->arias_m_s, f->d5_95_s);
    fprintf(script, "EOD\nEND = %.7g\nset label 1 ", f->duration_s);
    gnuplot_quote(script, title);
    fprintf(script, " at screen 0.5,0.965 center noenhanced\n%s", PANELS);
}

Status spectrum_draw(const Spectrum *s, const char *path, Err *err)
{
    return gnuplot_draw(path, write_one, s, err);
}

typedef struct {
    size_t n;
    const Spectrum *s;
} Several;

static void write_several(FILE *script, const void *user)
{
    const Several *all = user;
    const int has_target = all->s->code.kind != TARGET_NONE;
    double mean[N_PERIODS];
    spectra_average(all->n, all->s, mean);
    fprintf(script, "$S << EOD\n");
    for (int i = 0; i < N_PERIODS; i++) {
        fprintf(script, "%.6g %.6g %.6g", all->s->T[i], mean[i] / GRAVITY, all->s->target[i] / GRAVITY);
        for (size_t k = 0; k < all->n; k++)
            fprintf(script, " %.6g", all->s[k].psa[i] / GRAVITY);
        fputc('\n', script);
    }
    fprintf(script, "EOD\nset terminal svg size 1000,600 font 'sans,13' noenhanced background '#ffffff'\n"
                    "set grid lc '#d0d0d0'\nset logscale x\nset xrange [0.02:20]\nset yrange [0:*]\nset tics nomirror\n"
                    "set xlabel 'period [s]'\nset ylabel 'pseudo-acceleration [g], 5 %% damping'\n"
                    "set key outside right top noenhanced\nplot ");
    for (size_t k = 0; k < all->n; k++) {
        fprintf(script, "$S using 1:%zu with lines title ", k + 4);
        gnuplot_quote(script, spectrum_name(&all->s[k]));
        fputs(", ", script);
    }
    fprintf(script, "$S using 1:2 with lines lw 3 lc 'black' title 'mean'%s\n",
            has_target ? ", $S using 1:3 with lines lw 3 dt (6,4) lc '#d55e00' title 'target'" : "");
}

Status spectra_draw(size_t n, const Spectrum s[], const char *path, Err *err)
{
    return gnuplot_draw(path, write_several, &(Several){n, s}, err);
}
