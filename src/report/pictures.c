/* Every picture is a data block of numbers and a script over it; the terminal comes in front of both. */
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <string.h>
#include <sys/stat.h>

#include "moga/hypervolume.h"
#include "report/gnuplot.h"
#include "report/report.h"
#include "report/words.h"
#include "motion/builtin.h"
#include "settings/options.h"

enum { HISTORY_POINTS = 2000 };

typedef struct Picture {
    const char *name;
    int width, height; /* of the SVG [px] */
    int wants_detail;
    void (*write)(FILE *script, const Report *r);
} Picture;

typedef struct {
    const Report *report;
    const Picture *picture;
    int is_png;
} Drawing;

/* Okabe and Ito's colours and viridis, readable without colour vision. */
static const char STYLE[] =
    "set encoding utf8\n"
    "WITH = '#0072b2'; WITHOUT = '#d55e00'; RIGID = '#8a6d00'; GREEN = '#009e73'\n"
    "ORANGE = '#e69f00'; SKY = '#56b4e9'; PURPLE = '#cc79a7'; GREY = '#9aa4af'\n"
    "set palette defined (0 '#440154', 0.25 '#3b528b', 0.5 '#21918c', 0.75 '#5ec962', 1 '#dde318')\n"
    "set grid lc '#d8d8d8' lt 1 lw 1\nset tics nomirror out\nset border 3\nset key noenhanced\n"
    "set style fill solid 1 noborder\n";

static void numbers(FILE *script, size_t n, ...)
{
    va_list list;
    va_start(list, n);
    for (size_t i = 0; i < n; i++)
        gnuplot_number(script, va_arg(list, double));
    va_end(list);
    fputc('\n', script);
}

/* The file's name; of a built-in motion that it is synthetic. */
static void write_motion_name(FILE *script, const char *record)
{
    const char *slash = strrchr(record, '/');
    char text[160];
    if (builtin_name(record))
        snprintf(text, sizeof text, "%s (synthetic)", builtin_name(record));
    else
        snprintf(text, sizeof text, "%s", slash ? slash + 1 : record);
    gnuplot_quote(script, text);
}

/* ---- the front ------------------------------------------------------------------------------------------------- */

static double scale_of(const Report *r, size_t k)
{
    return words_of_objective(&r->run->schema, k).factor;
}

static void write_rows(FILE *script, const char *block, const Report *r, size_t n, const size_t rows[])
{
    fprintf(script, "$%s << EOD\n", block);
    for (size_t i = 0; i < n; i++) {
        for (size_t k = 0; k < r->run->schema.n_obj; k++)
            gnuplot_number(script, run_f(r->run, rows[i])[k] * scale_of(r, k));
        fputc('\n', script);
    }
    fputs("EOD\n", script);
}

static void write_label(FILE *script, const Report *r, size_t k)
{
    char text[256];
    const Words w = words_of_objective(&r->run->schema, k);
    snprintf(text, sizeof text, w.unit[0] ? "%s [%s]" : "%s", w.title, w.unit);
    gnuplot_quote(script, text);
}

/* Two objectives against each other; the last one gives the colour. */
typedef struct {
    size_t x, y;
} Panel;

/* As in the page: colour and symbol of every baseline. */
static const struct {
    const char *words, *colour;
    int symbol;
} BASELINES[N_BASELINES] = {[BASELINE_NO_CORE] = {"without core", "WITHOUT", 13},
                            [BASELINE_RIGID] = {"rigidly connected", "RIGID", 9},
                            [BASELINE_TMD] = {"tuned mass damper", "GREEN", 5},
                            [BASELINE_LINKS] = {"viscous links", "PURPLE", 15}};

static int has_baseline(const Report *r, int k)
{
    return r->has_detail && r->detail.baseline[k].outcome == OUTCOME_OK;
}

static void write_baselines(FILE *script, const Report *r)
{
    for (int b = 0; b < N_BASELINES; b++) {
        if (!has_baseline(r, b))
            continue;
        fprintf(script, "$B%d << EOD\n", b);
        for (size_t k = 0; k < r->run->schema.n_obj; k++)
            gnuplot_number(script, r->detail.baseline[b].value[r->run->schema.order.of[k]] * scale_of(r, k));
        fputs("\nEOD\n", script);
    }
}

/* A symbol on a white one, so that it stands out of the dots. */
static void write_spot(FILE *script, const char *block, const Panel *p, int symbol, double size, const char *colour)
{
    fprintf(script,
            ", $%s using %zu:%zu with points pt %d ps %g lc rgb 'white' notitle, "
            "'' using %zu:%zu with points pt %d ps %g lc rgb %s notitle",
            block, p->x + 1, p->y + 1, symbol, 1.5 * size, p->x + 1, p->y + 1, symbol, size, colour);
}

static void write_panel(FILE *script, const Report *r, const Panel *p, int has_key)
{
    fputs("set xlabel ", script);
    write_label(script, r, p->x);
    fputs(" noenhanced\nset ylabel ", script);
    write_label(script, r, p->y);
    fprintf(script,
            " noenhanced offset 1.2\n%s\nplot $FRONT using %zu:%zu:%zu with points pt 7 ps DOT lc palette notitle",
            has_key ? "set key at screen 0.5,0.97 center vertical maxrows 1 samplen 1 noenhanced" : "unset key",
            p->x + 1, p->y + 1, r->run->schema.n_obj);
    write_spot(script, "KNEE", p, 7, 1.5, "'black'");
    for (int b = 0; b < N_BASELINES; b++) {
        char block[16];
        snprintf(block, sizeof block, "B%d", b);
        if (has_baseline(r, b))
            write_spot(script, block, p, BASELINES[b].symbol, 1.7, BASELINES[b].colour);
    }
    fprintf(script,
            ", keyentry with points pt 7 ps 0.9 lc rgb '#21918c' title '%zu designs', keyentry with points pt "
            "7 ps 1.5 lc rgb 'black' title 'the knee'",
            r->run->n_front);
    for (int b = 0; b < N_BASELINES; b++)
        if (has_baseline(r, b))
            fprintf(script, ", keyentry with points pt %d ps 1.7 lc rgb %s title '%s'", BASELINES[b].symbol,
                    BASELINES[b].colour, BASELINES[b].words);
    fputc('\n', script);
}

/* Those of the paper that are there, then the first pairs. Returns how many there are. */
static size_t choose_panels(const Report *r, Panel panels[3])
{
    static const int PAPER[3][2] = {{MEASURE_J1, MEASURE_J3}, {MEASURE_J1, MEASURE_J2}, {MEASURE_ED1, MEASURE_ED5_10}};
    static const Panel PAIRS[3] = {{0, 1}, {0, 2}, {1, 2}};
    const Schema *s = &r->run->schema;
    size_t n = 0;
    for (int i = 0; i < 3 && r->has_detail; i++) {
        panels[n] = (Panel){schema_find_objective(s, measure(PAPER[i][0])->name),
                            schema_find_objective(s, measure(PAPER[i][1])->name)};
        n += panels[n].x < s->n_obj && panels[n].y < s->n_obj;
    }
    for (int i = 0; i < 3 && n < 3 && PAIRS[i].y < s->n_obj; i++) {
        int is_there = 0;
        for (size_t k = 0; k < n; k++)
            is_there |= (panels[k].x == PAIRS[i].x && panels[k].y == PAIRS[i].y) ||
                        (panels[k].x == PAIRS[i].y && panels[k].y == PAIRS[i].x);
        if (!is_there)
            panels[n++] = PAIRS[i];
    }
    return n;
}

static void write_front(FILE *script, const Report *r)
{
    Panel panels[3];
    const size_t n = choose_panels(r, panels);
    write_rows(script, "FRONT", r, r->run->n_front, r->run->front);
    write_rows(script, "KNEE", r, 1, &r->knee);
    write_baselines(script, r);
    fprintf(script,
            "set multiplot layout 1,%zu margins 0.055,0.905,0.16,0.88 spacing 0.066,0\n"
            "set offsets graph 0.02, graph 0.04, graph 0.04, graph 0.02\nunset colorbox\n%sset cblabel ",
            n, r->has_detail ? "set xrange [0:*]\nset yrange [0:*]\n" : "");
    write_label(script, r, r->run->schema.n_obj - 1);
    fputs(" noenhanced\n", script);
    for (size_t i = 0; i < n; i++) {
        if (i + 1 == n)
            fputs("set colorbox user origin 0.922,0.16 size 0.013,0.72\n", script);
        write_panel(script, r, &panels[i], i == 0);
    }
}

static void write_growth(FILE *script, const Report *r)
{
    const Run *run = r->run;
    fputs("$G << EOD\n", script);
    for (size_t i = 0; i < run->n_generations; i++) {
        const double v = run->generation[i].hypervolume;
        if (isfinite(v))
            numbers(script, 3, (double)run->generation[i].simulated, 100 * v, 200 * hypervolume_error(v));
    }
    fputs("EOD\nset xlabel 'designs simulated'\nset ylabel 'hypervolume [%]'\nset yrange [0:*]\nunset key\n"
          "plot $G using 1:($2-$3):($2+$3) with filledcurves lc rgb '#b3d4e8', "
          "'' using 1:2 with lines lw 2.5 lc rgb WITH\n",
          script);
}

/* ---- the chosen design ----------------------------------------------------------------------------------------- */

/* Every floor has a number where they are few. */
static void write_floor_axis(FILE *script, int n)
{
    fprintf(script, "set yrange [0.3:%d.7]\nset ylabel 'floor'\nset ytics 0,%d\nset ytics add ('1' 1)\n", n,
            n <= 12   ? 1
            : n <= 24 ? 5
            : n <= 60 ? 10
                      : 20);
}

/* Pale: never closes; dashed: the bounds of the search. */
static void write_gaps(FILE *script, const Report *r)
{
    const Detail *d = &r->detail;
    const DesignOptions *o = &r->run->settings->design;
    fputs("$D << EOD\n", script);
    for (int j = 0; j < d->n_floors; j++)
        numbers(script, 4, (double)j + 1, 1e3 * d->gap_m[j], 1e3 * d->thickness_m[j],
                d->result[SCENE_IMPACT].closings[j] > 0 ? 1.0 : NAN);
    fprintf(script,
            "EOD\nset multiplot layout 1,2 margins 0.09,0.97,0.13,0.9 spacing 0.12,0\n"
            "set key at screen 0.5,0.97 center vertical maxrows 1\n"
            "set arrow 1 from %.6g, graph 0 to %.6g, graph 1 nohead dt (6,4) lw 1.5 lc rgb WITHOUT\n"
            "set arrow 2 from %.6g, graph 0 to %.6g, graph 1 nohead dt (6,4) lw 1.5 lc rgb WITHOUT\n",
            1e3 * o->gap_min_m, 1e3 * o->gap_min_m, 1e3 * o->gap_max_m, 1e3 * o->gap_max_m);
    write_floor_axis(script, d->n_floors);
    fprintf(script,
            "set xrange [0:%.6g]\nset xlabel 'gap [mm]'\n"
            "plot $D using (0):1:(0):2:($1-0.38):($1+0.38) with boxxyerror lc rgb '#c5d6e2' title 'never closes', "
            "'' using (0):($4 > 0 ? $1 : NaN):(0):2:($1-0.38):($1+0.38) with boxxyerror lc rgb WITH title 'closes', "
            "keyentry with lines dt (6,4) lw 1.5 lc rgb WITHOUT title 'bounds of the search'\n"
            "unset arrow\nunset key\nset xrange [0:*]\nset xlabel 'thickness of the core [mm]'\n"
            "plot $D using 3:1 with linespoints lw 2.5 pt 7 ps 0.7 lc rgb WITH\nunset multiplot\n",
            1.03e3 * o->gap_max_m);
}

static const char SCENE_LINES[] =
    "plot $P using (column(1+K)):1 with linespoints lw 2.2 pt 7 ps 0.7 lc rgb WITH title 'with core', "
    "'' using (column(4+K)):1 with linespoints lw 2.2 dt (8,4) pt 13 ps 0.8 lc rgb WITHOUT title 'without core', "
    "'' using (column(7+K)):1 with linespoints lw 2.2 dt (3,3) pt 9 ps 0.8 lc rgb RIGID title 'rigidly connected', "
    "'' using (column(10+K)):1 with linespoints lw 1.6 dt (12,4) pt 5 ps 0.6 lc rgb GREEN title 'tuned mass damper', "
    "'' using (column(13+K)):1 with linespoints lw 1.6 dt (2,4) pt 15 ps 0.7 lc rgb PURPLE title 'viscous links'\n";

static void write_peaks(FILE *script, const Report *r)
{
    const Detail *d = &r->detail;
    fputs("$P << EOD\n", script);
    for (int j = 0; j < d->n_floors; j++) {
        fprintf(script, "%d ", j + 1);
        for (int s = 0; s < N_SCENES; s++)
            fprintf(script, "%.6g %.6g %.6g ", d->result[s].peak_displacement_m[j], d->result[s].peak_drift_m[j],
                    d->result[s].peak_acceleration_g[j]);
        fputc('\n', script);
    }
    fputs("EOD\nset multiplot layout 1,3 margins 0.055,0.985,0.14,0.88 spacing 0.055,0\nset xrange [0:*]\n", script);
    write_floor_axis(script, d->n_floors);
    fprintf(script,
            "set key at screen 0.5,0.95 center vertical maxrows 1\n"
            "set xlabel 'peak displacement [m]'\nK = 1\n%sunset key\nunset ylabel\n"
            "set xlabel 'peak interstorey drift [m]'\nK = 2\n%s"
            "set xlabel 'peak absolute acceleration [g]'\nK = 3\n%sunset multiplot\n",
            SCENE_LINES, SCENE_LINES, SCENE_LINES);
}

static const double MODE_SHARE_SHOWN = 0.01; /* [%] the least */

#define MODE_LINES(column, style) "using 1:" column " with linespoints lw 1.6 " style

static const char MODE_AXES[] = "set xlabel 'mode of the building'\nset ylabel 'share of the input energy [%]'\n"
                                "set logscale y\nset yrange [0.01:100]\nset xrange [0.5:10.5]\nset xtics 1\n"
                                "set key top right\n";

/* Shares of the leading modes of up to three responses side by side. */
static void write_modes_of(FILE *script, const char *block, size_t n, const SimResult *const results[])
{
    const int n_modes = results[0]->n_modes < 10 ? results[0]->n_modes : 10;
    fprintf(script, "$%s << EOD\n", block);
    for (int i = 0; i < n_modes; i++) {
        fprintf(script, "%d ", i + 1);
        for (size_t s = 0; s < n; s++)
            fprintf(script, "%.6g ", fmax(results[s]->mode_share_pct[i], MODE_SHARE_SHOWN));
        fputc('\n', script);
    }
    fputs("EOD\n", script);
}

static void write_modes(FILE *script, const Report *r)
{
    const SimResult *const all[] = {&r->detail.result[SCENE_IMPACT], &r->detail.result[SCENE_NO_CORE],
                                    &r->detail.result[SCENE_RIGID]};
    write_modes_of(script, "M", sizeof all / sizeof all[0], all);
    fprintf(
        script,
        "%splot $M " MODE_LINES(
            "2", "pt 7 ps 1 lc rgb WITH") " title 'with core', "
                                          "'' " MODE_LINES(
                                              "3",
                                              "dt (8,4) pt 13 ps 1.2 lc rgb WITHOUT") " title 'without core', "
                                                                                      "'' " MODE_LINES(
                                                                                          "4",
                                                                                          "dt (3,3) pt 9 ps 1.2 lc rgb "
                                                                                          "RIGID") " title 'rigidly "
                                                                                                   "connected'\n",
        MODE_AXES);
}

static void write_history(FILE *script, const char *block, const History *h)
{
    const size_t step = h->n / HISTORY_POINTS + 1;
    fprintf(script, "$%s << EOD\n", block);
    for (size_t i = 0; i < h->n; i += step) {
        double sum = 0;
        fprintf(script, "%.6g %.5g %.5g", h->t[i], h->u[i], h->energy[ENERGY_INPUT][i] / 1e6);
        static const EnergyKind ORDER[] = {ENERGY_DAMPED_BUILDING, ENERGY_DAMPED_CORE, ENERGY_CONTACTS, ENERGY_CORE,
                                           ENERGY_STRAIN,          ENERGY_KINETIC};
        for (size_t k = 0; k < sizeof ORDER / sizeof ORDER[0]; k++)
            fprintf(script, " %.5g", sum += h->energy[ORDER[k]][i] / 1e6);
        fputc('\n', script);
    }
    fputs("EOD\n", script);
}

static const char ENERGY_AREAS[] =
    "plot 0 with lines lc rgb '#000000' notitle, "
    "$H using 1:9 with filledcurves y1=0 lc rgb GREY title 'kinetic, building', "
    "'' using 1:8 with filledcurves y1=0 lc rgb SKY title 'strain, building', "
    "'' using 1:7 with filledcurves y1=0 lc rgb PURPLE title 'kinetic and strain, core', "
    "'' using 1:6 with filledcurves y1=0 lc rgb ORANGE title 'impacts', "
    "'' using 1:5 with filledcurves y1=0 lc rgb GREEN title 'damping, core', "
    "'' using 1:4 with filledcurves y1=0 lc rgb WITH title 'damping, building', "
    "'' using 1:3 with lines lw 1.5 lc rgb 'black' title 'input energy'\n";

static double largest(size_t n, const double values[])
{
    double most = 0;
    for (size_t i = 0; i < n; i++)
        most = fmax(most, fabs(values[i]));
    return most;
}

static void write_energies(FILE *script, const Report *r)
{
    const History *h = r->detail.history;
    const double top = fmax(largest(h[0].n, h[0].energy[ENERGY_INPUT]), largest(h[1].n, h[1].energy[ENERGY_INPUT]));
    fprintf(script,
            "set multiplot layout 1,2 margins 0.07,0.98,0.13,0.78 spacing 0.08,0\nset yrange [0:%.6g]\n"
            "set xlabel 'time [s]'\nset ylabel 'energy [MJ]'\n"
            "set key at screen 0.5,0.98 center top vertical maxrows 2\nset title 'with core'\n",
            1.05e-6 * top);
    write_history(script, "H", &h[0]);
    fputs(ENERGY_AREAS, script);
    write_history(script, "H", &h[1]);
    fprintf(script, "unset key\nset title 'without core'\n%sunset multiplot\n", ENERGY_AREAS);
}

static void write_spectrum(FILE *script, const char *block, const Spectrogram *s)
{
    fprintf(script, "$%s << EOD\n", block);
    for (size_t i = 0; i < SPECTRUM_FREQUENCIES; i++) {
        for (size_t k = 0; k < SPECTRUM_TIMES; k++)
            numbers(script, 3, s->t[k], log10(s->f[i]), s->amplitude[i * SPECTRUM_TIMES + k]);
        fputc('\n', script);
    }
    fputs("EOD\n", script);
}

/* The colour goes with the square root of the amplitude; its scale is labelled with the amplitude itself. */
static void write_amplitude_tics(FILE *script, double top)
{
    fputs("set cbtics ('0' 0", script);
    for (double step = pow(10, floor(log10(top)) - 2); step > 0 && step <= top; step *= 10)
        for (int k = 1; k <= 5; k += k == 1 ? 1 : 3)
            if (step * k <= top && step * k > 0.008 * top)
                fprintf(script, ", '%g' %.6g", step * k, sqrt(step * k));
    fputs(")\n", script);
}

static void write_displacement(FILE *script, const Report *r)
{
    static const char *const WORDS[] = {"with core", "without core"};
    const Detail *d = &r->detail;
    double limit = 0, top = 0;
    for (int i = 0; i < 2; i++) {
        limit = fmax(limit, largest(d->history[i].n, d->history[i].u));
        top = fmax(top, largest(SPECTRUM_FREQUENCIES * SPECTRUM_TIMES, d->spectrum[i].amplitude));
    }
    fprintf(script,
            "set multiplot\nunset key\nset xrange [0:%.6g]\nset cbrange [0:%.6g]\n"
            "set ytics add ('0.1' -1, '0.2' -0.69897, '0.5' -0.30103, '1' 0, '2' 0.30103, '5' 0.69897, '10' 1)\n",
            d->spectrum[0].t[SPECTRUM_TIMES - 1], sqrt(top));
    write_amplitude_tics(script, top);
    for (int i = 0; i < 2; i++) {
        const double left = 0.085 + 0.445 * i;
        if (d->history[i].n < 2)
            continue;
        write_history(script, "H", &d->history[i]);
        write_spectrum(script, "S", &d->spectrum[i]);
        fprintf(script,
                "set lmargin at screen %g\nset rmargin at screen %g\nset tmargin at screen 0.92\nset bmargin at screen "
                "0.68\nset title 'floor %d, %s'\nset format x ''\nunset xlabel\nset ytics auto\n"
                "set ylabel 'displacement [m]'\nset yrange [%.6g:%.6g]\nset grid back lc '#d8d8d8'\n"
                "plot $H using 1:2 with lines lc rgb 'black'\n"
                "unset title\nset tmargin at screen 0.63\nset bmargin at screen 0.14\nset format x '%%g'\n"
                "set xlabel 'time [s]'\nset ylabel 'frequency [Hz]'\nset yrange [%.6g:%.6g]\nunset grid\n"
                "set ytics ('0.1' -1, '0.2' -0.69897, '0.5' -0.30103, '1' 0, '2' 0.30103, '5' 0.69897, '10' 1)\n"
                "%s\n",
                left, left + 0.365, d->floor + 1, WORDS[i], -1.05 * limit, 1.05 * limit, log10(d->spectrum[i].f[0]),
                log10(d->spectrum[i].f[SPECTRUM_FREQUENCIES - 1]),
                i == 0 ? "unset colorbox"
                       : "set colorbox user origin 0.915,0.14 size 0.012,0.49\nset cblabel 'amplitude [m]' offset 0.5");
        for (int mode = 0; mode < 10 && mode < d->n_floors; mode++)
            fprintf(script,
                    "set arrow %d from graph 0, first %.6g to graph 1, first %.6g nohead dt (6,6) lc rgb 'white' "
                    "front\n",
                    mode + 1, log10(d->building_hz[mode]), log10(d->building_hz[mode]));
        fputs("plot $S using 1:2:(sqrt($3)) with image\nunset arrow\n", script);
    }
    fputs("unset multiplot\n", script);
}

static void write_elsewhere(FILE *script, const Report *r)
{
    const Detail *d = &r->detail;
    const double rows = (double)d->n_elsewhere;
    fputs("set multiplot\n", script);
    for (size_t e = 0; e < d->n_elsewhere; e++) {
        const Elsewhere *at = &d->elsewhere[e];
        const SimResult *const pair[] = {&at->with_core, &at->no_core};
        const double top = 1 - ((double)e + 0.09) / rows, bottom = 1 - ((double)e + 0.83) / rows;
        write_modes_of(script, "M", 2, pair);
        fputs("$P << EOD\n", script);
        for (int j = 0; j < d->n_floors; j++)
            numbers(script, 3, (double)j + 1, at->with_core.peak_drift_m[j], at->no_core.peak_drift_m[j]);
        fprintf(script,
                "EOD\nset tmargin at screen %g\nset bmargin at screen %g\nset lmargin at screen 0.07\n"
                "set rmargin at screen 0.47\nunset key\nset title ",
                top, bottom);
        write_motion_name(script, at->record);
        fputs(
            " noenhanced\nset xrange [0:*]\nset xtics auto\nunset logscale\nset xlabel 'peak interstorey drift [m]'\n",
            script);
        write_floor_axis(script, d->n_floors);
        fprintf(script,
                "plot $P using 2:1 with linespoints lw 2.2 pt 7 ps 0.7 lc rgb WITH title 'with core', "
                "'' using 3:1 with linespoints lw 2.2 dt (8,4) pt 13 ps 0.8 lc rgb WITHOUT title 'without core'\n"
                "set lmargin at screen 0.57\nset rmargin at screen 0.98\nset ytics auto\n%s"
                "plot $M " MODE_LINES(
                    "2", "pt 7 ps 1 lc rgb WITH") " title 'with core', "
                                                  "'' " MODE_LINES(
                                                      "3",
                                                      "dt (8,4) pt 13 ps 1.2 lc rgb WITHOUT") " title 'without core'\n",
                MODE_AXES);
    }
    fputs("unset multiplot\n", script);
}

/* ---- all of them ----------------------------------------------------------------------------------------------- */

static const Picture PICTURES[] = {
    {"front", 1200, 420, 0, write_front},
    {"growth", 700, 400, 0, write_growth},
    {"gaps", 900, 460, 1, write_gaps},
    {"peaks", 1200, 480, 1, write_peaks},
    {"modes", 800, 420, 1, write_modes},
    {"energies", 1200, 460, 1, write_energies},
    {"displacement", 1200, 600, 1, write_displacement},
    {"elsewhere", 1000, 400, 1, write_elsewhere},
};

static void write_script(FILE *script, const void *user)
{
    const Drawing *d = user;
    const Picture *p = d->picture;
    const size_t rows = p->write == write_elsewhere ? d->report->detail.n_elsewhere : 1;
    const int height = p->height * (int)rows;
    if (d->is_png)
        fprintf(script, "set terminal pngcairo size %d,%d font 'sans,15' background rgb 'white'\nDOT = 0.8\n",
                p->width * 3 / 2, height * 3 / 2);
    else
        fprintf(script, "set terminal svg size %d,%d dynamic font 'sans,13' background rgb 'white'\nDOT = 0.4\n",
                p->width, height);
    fputs(STYLE, script);
    p->write(script, d->report);
}

/* Generations with a hypervolume. */
static size_t n_measured(const Run *run)
{
    size_t n = 0;
    for (size_t i = 0; i < run->n_generations; i++)
        n += isfinite(run->generation[i].hypervolume) != 0;
    return n;
}

static int is_wanted(const Report *r, const Picture *p)
{
    const Detail *d = &r->detail;
    if (p->write == write_front)
        return r->run->schema.n_obj > 1;
    if (p->write == write_growth)
        return n_measured(r->run) > 1;
    if (p->write == write_elsewhere)
        return d->n_elsewhere > 0;
    if (p->write == write_energies || p->write == write_displacement)
        return r->has_detail && d->history[0].n > 1 && d->history[1].n > 1;
    return r->has_detail || !p->wants_detail;
}

Status report_pictures(const Report *r, const char *folder, Err *err)
{
    if (mkdir(folder, 0777) != 0 && errno != EEXIST)
        return fail(err, STATUS_IO, "%s: cannot be made a folder: %s", folder, strerror(errno));
    for (size_t i = 0; i < sizeof PICTURES / sizeof PICTURES[0]; i++)
        for (int is_png = 0; is_png < 2 && is_wanted(r, &PICTURES[i]); is_png++) {
            const Drawing drawing = {r, &PICTURES[i], is_png};
            char path[PATH_MAX];
            if (snprintf(path, sizeof path, "%s/%s.%s", folder, PICTURES[i].name, is_png ? "png" : "svg") >=
                (int)sizeof path)
                return fail(err, STATUS_IO, "%.200s...: the path is too long", folder);
            TRY(gnuplot_draw(path, write_script, &drawing, err));
        }
    return STATUS_OK;
}
