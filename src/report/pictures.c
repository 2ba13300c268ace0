/* Every picture is blocks of numbers and a script over them; what all scripts share stands in STYLE. */
#include <errno.h>
#include <stdarg.h>
#include <sys/stat.h>

#include "base/hypervolume.h"
#include "motion/builtin.h"
#include "report/gnuplot.h"
#include "report/report.h"
#include "report/words.h"

enum { HISTORY_POINTS = 2000, MODES_SHOWN = 10 };

/* Which reports have it. */
typedef enum { ALWAYS, WITH_PAIRS, WITH_GROWTH, WITH_DETAIL, WITH_HISTORIES, WITH_ELSEWHERE } Condition;

typedef struct {
    const char *name;
    int width, height; /* of the SVG [px] */
    Condition wants;
    void (*write)(FILE *out, const Report *r); /* its blocks of numbers, and what else the script needs of the report */
    const char *script;
} Picture;

typedef struct {
    const Report *report;
    const Picture *picture;
    int is_png;
} Drawing;

/* Okabe and Ito's colours and viridis, readable without colour vision. CASE: the design and its baselines, each with
 * words, a colour, a symbol and a dash type of its own; CURVES draws columns of a block for some of them. */
static const char STYLE[] =
    "set encoding utf8\n"
    "array CASE[5] = ['with core', 'without core', 'rigidly connected', 'tuned mass damper', 'viscous links']\n"
    "array HUE[5] = ['#0072b2', '#d55e00', '#8a6d00', '#009e73', '#cc79a7']\n"
    "array DOTS[5] = [7, 13, 9, 5, 15]\n"
    "set for [i=1:5] linetype i lc rgb HUE[i] lw 2.2 pt DOTS[i] ps 0.8 dt i\n"
    "set palette defined (0 '#440154', 0.25 '#3b528b', 0.5 '#21918c', 0.75 '#5ec962', 1 '#dde318')\n"
    "set grid lc '#d8d8d8' lt 1 lw 1 dt 1\nset tics nomirror out\nset border 3\nset key noenhanced\n"
    "set style fill solid 1 noborder\n";

/* A line of a block. */
static void numbers(FILE *out, size_t n, ...)
{
    va_list list;
    va_start(list, n);
    for (size_t i = 0; i < n; i++)
        gnuplot_number(out, va_arg(list, double));
    va_end(list);
    fputc('\n', out);
}

static double largest(size_t n, const double values[])
{
    double most = 0;
    for (size_t i = 0; i < n; i++)
        most = fmax(most, fabs(values[i]));
    return most;
}

/* ---- the front ------------------------------------------------------------------------------------------------- */

/* Objectives in the units for the eye, behind a number. */
static void write_objectives(FILE *out, const Report *r, double first, const double f[])
{
    gnuplot_number(out, first);
    for (size_t k = 0; k < r->run->schema.n_obj; k++)
        gnuplot_number(out, f[k] * words_of_objective(&r->run->schema, k).factor);
    fputc('\n', out);
}

/* Pairs of objectives against each other: those of the paper where all are there, else the first ones. */
static size_t choose_panels(const Schema *s, size_t panels[3][2])
{
    static const char *const PAPER[3][2] = {{"j1_m", "j3_g"}, {"j1_m", "j2_m"}, {"ed1_pct", "ed5_10_pct"}};
    static const size_t FIRST[3][2] = {{0, 1}, {0, 2}, {1, 2}};
    int has_all = 1;
    for (int i = 0; i < 6; i++) {
        panels[i / 2][i % 2] = schema_find_objective(s, PAPER[i / 2][i % 2]);
        has_all = has_all && panels[i / 2][i % 2] < s->n_obj;
    }
    if (!has_all)
        memcpy(panels, FIRST, sizeof FIRST);
    return has_all || s->n_obj > 2 ? 3 : 1;
}

static void write_front(FILE *out, const Report *r)
{
    const Schema *schema = &r->run->schema;
    size_t panels[3][2] = {{0}};
    const size_t n = choose_panels(schema, panels);
    double f[OBJECTIVES_MAX];
    fputs("$FRONT << EOD\n", out);
    for (size_t i = 0; i < r->run->n_front; i++)
        write_objectives(out, r, 0, run_f(r->run, r->run->front[i]));
    fputs("EOD\n$KNEE << EOD\n", out);
    write_objectives(out, r, 0, run_f(r->run, r->knee));
    fputs("EOD\n$BASELINES << EOD\n", out);
    char there[16] = "";
    for (int b = 0; r->has_detail && b < N_SCENES - 1; b++) {
        for (size_t k = 0; k < schema->n_obj; k++)
            f[k] = r->detail.baseline[b + 1].value[schema->order.of[k]];
        if (r->detail.baseline[b + 1].outcome != OUTCOME_OK)
            continue;
        write_objectives(out, r, b + 2, f);
        snprintf(there + strlen(there), sizeof there - strlen(there), "%d ", b + 2);
    }
    fprintf(out,
            "EOD\nTHERE = '%s'; N_FRONT = %zu; N_OBJ = %zu; N = %zu; LEAST = %s\narray LABEL[N_OBJ]\narray X[3]\narray "
            "Y[3]\n",
            there, r->run->n_front, schema->n_obj, n, r->has_detail ? "0" : "NaN");
    for (size_t i = 0; i < n; i++)
        fprintf(out, "X[%zu] = %zu; Y[%zu] = %zu\n", i + 1, panels[i][0] + 1, i + 1, panels[i][1] + 1);
    for (size_t k = 0; k < schema->n_obj; k++) {
        const Words w = words_of_objective(schema, k);
        char text[256];
        snprintf(text, sizeof text, w.unit[0] ? "%s [%s]" : "%s", w.title, w.unit);
        fprintf(out, "LABEL[%zu] = ", k + 1);
        gnuplot_quote(out, text);
        fputc('\n', out);
    }
}

/* Symbols stand on white ones, so that they stand out of the dots. */
static const char FRONT[] =
    "set multiplot layout 1,N margins 0.055,0.905,0.16,0.88 spacing 0.066,0\n"
    "set offsets graph 0.02, graph 0.04, graph 0.04, graph 0.02\nunset colorbox\n"
    "set cblabel LABEL[N_OBJ] noenhanced\n"
    "if (LEAST == 0) { set xrange [0:*]; set yrange [0:*] }\n"
    "SPOTS = words(THERE) == 0 ? '' : \", "
    "for [b in THERE] $BASELINES using ($1 == b ? column(X[p]+1) : NaN):(column(Y[p]+1)) with points "
    "pt DOTS[int(b)] ps 2.5 lc rgb 'white' notitle, "
    "for [b in THERE] $BASELINES using ($1 == b ? column(X[p]+1) : NaN):(column(Y[p]+1)) with points "
    "pt DOTS[int(b)] ps 1.7 lc rgb HUE[int(b)] notitle, "
    "for [b in THERE] keyentry with points pt DOTS[int(b)] ps 1.7 lc rgb HUE[int(b)] title CASE[int(b)]\"\n"
    "do for [p=1:N] {\n"
    "if (p == N) { set colorbox user origin 0.922,0.16 size 0.013,0.72 }\n"
    "if (p == 1) { set key at screen 0.5,0.97 center vertical maxrows 1 samplen 1 } else { unset key }\n"
    "set xlabel LABEL[X[p]] noenhanced\nset ylabel LABEL[Y[p]] noenhanced offset 1.2\n"
    "plot $FRONT using (column(X[p]+1)):(column(Y[p]+1)):(column(N_OBJ+1)) with points pt 7 ps DOT lc palette notitle, "
    "$KNEE using (column(X[p]+1)):(column(Y[p]+1)) with points pt 7 ps 2.2 lc rgb 'white' notitle, "
    "'' using (column(X[p]+1)):(column(Y[p]+1)) with points pt 7 ps 1.5 lc rgb 'black' notitle, "
    "keyentry with points pt 7 ps 0.9 lc rgb '#21918c' title sprintf('%d designs', N_FRONT), "
    "keyentry with points pt 7 ps 1.5 lc rgb 'black' title 'the knee' @SPOTS\n}\n";

static void write_growth(FILE *out, const Report *r)
{
    fputs("$G << EOD\n", out);
    for (const RunGeneration *g = r->run->generation; g < r->run->generation + r->run->n_generations; g++)
        if (isfinite(g->hypervolume))
            numbers(out, 3, (double)g->simulated, 100 * g->hypervolume, 200 * hypervolume_error(g->hypervolume));
    fputs("EOD\n", out);
}

static const char GROWTH[] =
    "set xlabel 'designs simulated'\nset ylabel 'hypervolume [%]'\nset yrange [0:*]\nunset key\n"
    "plot $G using 1:($2-$3):($2+$3) with filledcurves lc rgb '#b3d4e8', "
    "'' using 1:2 with lines lw 2.5 lc rgb HUE[1]\n";

/* ---- the chosen design ----------------------------------------------------------------------------------------- */

/* Every floor has a number where they are few. */
#define FLOOR_AXIS                                                                                                     \
    "set yrange [0.3:FLOORS+0.7]\nset ylabel 'floor'\n"                                                                \
    "set ytics 0,FLOORS <= 12 ? 1 : FLOORS <= 24 ? 5 : FLOORS <= 60 ? 10 : 20\nset ytics add ('1' 1)\n"

/* [mm] Nothing to draw where there is nothing on that side. */
static double side_or_none(double gap)
{
    return isfinite(gap) ? 1e3 * gap : NAN;
}

static void write_gaps(FILE *out, const Report *r)
{
    const Detail *d = &r->detail;
    const DesignOptions *o = &r->run->settings->design;
    fputs("$D << EOD\n", out);
    for (int j = 0; j < d->n_floors; j++)
        numbers(out, 5, (double)j + 1, side_or_none(d->gap_side_m[0][j]), 1e3 * d->thickness_m[j],
                d->result[SCENE_IMPACT].closings[j] > 0 ? 1.0 : NAN, -side_or_none(d->gap_side_m[1][j]));
    fprintf(out, "EOD\nFLOORS = %d; LOW = %.6g; HIGH = %.6g; FROM = %s; TO = %s; GAP = '%s'\n", d->n_floors,
            1e3 * o->gap_m.at[0], 1e3 * o->gap_m.at[1],
            d->gap_sides == GAPS_BOTH || d->gap_sides == GAPS_RIGHT ? "0" : "-1.03*HIGH",
            d->gap_sides == GAPS_LEFT ? "0" : "1.03*HIGH",
            d->gap_sides == GAPS_BOTH ? "gap [mm]" : "gap [mm], to the left and to the right");
}

/* Pale: never closes; dashed: the bounds of the search. */
static const char GAPS[] =
    "set multiplot layout 1,2 margins 0.09,0.97,0.13,0.9 spacing 0.12,0\n"
    "set key at screen 0.5,0.97 center vertical maxrows 1\n"
    "set arrow 1 from LOW, graph 0 to LOW, graph 1 nohead dt (6,4) lw 1.5 lc rgb HUE[2]\n"
    "set arrow 2 from HIGH, graph 0 to HIGH, graph 1 nohead dt (6,4) lw 1.5 lc rgb HUE[2]\n" FLOOR_AXIS
    "set xrange [FROM:TO]\nset xlabel GAP\n"
    "plot $D using (0):1:(0):2:($1-0.38):($1+0.38) with boxxyerror lc rgb '#c5d6e2' title 'never closes', "
    "'' using (0):($4 > 0 ? $1 : NaN):(0):2:($1-0.38):($1+0.38) with boxxyerror lc rgb HUE[1] title 'closes', "
    "'' using (0):1:5:(0):($1-0.38):($1+0.38) with boxxyerror lc rgb '#c5d6e2' notitle, "
    "'' using (0):($4 > 0 ? $1 : NaN):5:(0):($1-0.38):($1+0.38) with boxxyerror lc rgb HUE[1] notitle, "
    "keyentry with lines dt (6,4) lw 1.5 lc rgb HUE[2] title 'bounds of the search'\n"
    "unset arrow\nunset key\nset xrange [0:*]\nset xlabel 'thickness of the core [mm]'\n"
    "plot $D using 3:1 with linespoints lt 1 ps 0.7\n";

/* Floor by floor: displacement, drift and acceleration of n results, one after the other. */
static void write_floors(FILE *out, int n_floors, int n, const SimResult *const results[])
{
    fputs("$P << EOD\n", out);
    for (int j = 0; j < n_floors; j++) {
        gnuplot_number(out, j + 1);
        for (int s = 0; s < n; s++) {
            gnuplot_number(out, results[s]->peak_displacement_m[j]);
            gnuplot_number(out, results[s]->peak_drift_m[j]);
            gnuplot_number(out, results[s]->peak_acceleration_g[j]);
        }
        fputc('\n', out);
    }
    fprintf(out, "EOD\nFLOORS = %d\n", n_floors);
}

/* Shares of the leading modes of n results, one after the other. */
static void write_modes_of(FILE *out, int n, const SimResult *const results[])
{
    static const double LEAST_PCT = 0.01;
    fputs("$M << EOD\n", out);
    for (int i = 0; i < results[0]->n_modes && i < MODES_SHOWN; i++) {
        gnuplot_number(out, i + 1);
        for (int s = 0; s < n; s++)
            gnuplot_number(out, fmax(results[s]->mode_share_pct[i], LEAST_PCT));
        fputc('\n', out);
    }
    fputs("EOD\n", out);
}

static void write_scenes(FILE *out, const Report *r)
{
    static const SceneKind ORDER[N_SCENES] = {SCENE_IMPACT, SCENE_NO_CORE, SCENE_RIGID, SCENE_TMD, SCENE_LINKS};
    const SimResult *all[N_SCENES];
    for (int s = 0; s < N_SCENES; s++)
        all[s] = &r->detail.result[ORDER[s]];
    write_floors(out, r->detail.n_floors, N_SCENES, all);
    write_modes_of(out, 3, all);
    if (all[0]->yields)
        fprintf(out, "set title 'storeys that yield dissipate %.2g %%: shares of modes say little'\n",
                all[0]->ed_hysteresis_pct);
}

static const char PEAKS[] =
    "unset title\nset multiplot layout 1,3 margins 0.055,0.985,0.14,0.88 spacing 0.055,0\nset xrange [0:*]\n" FLOOR_AXIS
    "set key at screen 0.5,0.95 center vertical maxrows 1\n"
    "array WHAT[3] = ['displacement [m]', 'interstorey drift [m]', 'absolute acceleration [g]']\n"
    "do for [k=1:3] {\nset xlabel 'peak '.WHAT[k]\n"
    "plot for [i=1:5] $P using (column(3*i-2+k)):1 with linespoints lt i title CASE[i]\nunset key\nunset ylabel\n}\n";

#define MODE_AXES                                                                                                      \
    "set xlabel 'mode of the building'\nset ylabel 'share of the input energy [%]'\nset logscale y\n"                  \
    "set yrange [0.01:100]\nset xrange [0.5:10.5]\nset xtics 1\nset key top right\n"

static const char MODES[] = MODE_AXES "plot for [i=1:3] $M using 1:(column(i+1)) with linespoints lt i title CASE[i]\n";

/* -- over time -- */

/* Time, displacement, input energy, then the sums of where it is, from the first on. */
static void write_history(FILE *out, int block, const History *h)
{
    static const EnergyKind ORDER[] = {ENERGY_DAMPED_BUILDING, ENERGY_DAMPED_CORE, ENERGY_CONTACTS, ENERGY_CORE,
                                       ENERGY_STRAIN,          ENERGY_KINETIC};
    fprintf(out, "$H%d << EOD\n", block);
    for (size_t i = 0; i < h->n; i += h->n / HISTORY_POINTS + 1) {
        double sum = 0;
        fprintf(out, "%.6g %.5g %.5g", h->t[i], h->u[i], h->energy[ENERGY_INPUT][i] / 1e6);
        for (size_t k = 0; k < N_OF(ORDER); k++)
            fprintf(out, " %.5g", sum += h->energy[ORDER[k]][i] / 1e6);
        fputc('\n', out);
    }
    fputs("EOD\n", out);
}

static void write_energies(FILE *out, const Report *r)
{
    double top = 0;
    for (int i = 0; i < 2; i++) {
        const History *h = &r->detail.history[i];
        write_history(out, i + 1, h);
        top = fmax(top, 1e-6 * largest(h->n, h->energy[ENERGY_INPUT]));
    }
    fprintf(out, "TOP = %.6g; TAKEN = '%s'\n", top,
            r->detail.result[SCENE_IMPACT].yields ? "impacts, storeys that yield" : "impacts");
}

#define ENERGY_AREAS                                                                                                   \
    "with lines lc rgb '#000000' notitle, "                                                                            \
    "'' using 1:9 with filledcurves y1=0 lc rgb '#9aa4af' title 'kinetic, building', "                                 \
    "'' using 1:8 with filledcurves y1=0 lc rgb '#56b4e9' title 'strain, building', "                                  \
    "'' using 1:7 with filledcurves y1=0 lc rgb '#cc79a7' title 'kinetic and strain, core', "                          \
    "'' using 1:6 with filledcurves y1=0 lc rgb '#e69f00' title TAKEN, "                                               \
    "'' using 1:5 with filledcurves y1=0 lc rgb '#009e73' title 'damping, core', "                                     \
    "'' using 1:4 with filledcurves y1=0 lc rgb '#0072b2' title 'damping, building', "                                 \
    "'' using 1:3 with lines lw 1.5 lc rgb 'black' title 'input energy'\n"

static const char ENERGIES[] =
    "set multiplot layout 1,2 margins 0.07,0.98,0.13,0.78 spacing 0.08,0\nset yrange [0:1.05*TOP]\n"
    "set xlabel 'time [s]'\nset ylabel 'energy [MJ]'\nset key at screen 0.5,0.98 center top vertical maxrows 2\n"
    "set title CASE[1]\nplot $H1 using 1:(0) " ENERGY_AREAS
    "unset key\nset title CASE[2]\nplot $H2 using 1:(0) " ENERGY_AREAS;

static void write_spectrum(FILE *out, int block, const Spectrogram *s)
{
    fprintf(out, "$S%d << EOD\n", block);
    for (size_t i = 0; i < SPECTRUM_FREQUENCIES; i++) {
        for (size_t k = 0; k < SPECTRUM_TIMES; k++)
            numbers(out, 3, s->t[k], log10(s->f[i]), s->amplitude[i * SPECTRUM_TIMES + k]);
        fputc('\n', out);
    }
    fputs("EOD\n", out);
}

/* The colour goes with the square root of the amplitude; its scale is labelled with the amplitude itself. */
static void write_amplitude_tics(FILE *out, double top)
{
    fputs("set cbtics ('0' 0", out);
    for (double step = pow(10, floor(log10(top)) - 2); step > 0 && step <= top; step *= 10)
        for (int k = 1; k <= 5; k += k == 1 ? 1 : 3)
            if (step * k <= top && step * k > 0.008 * top)
                fprintf(out, ", '%g' %.6g", step * k, sqrt(step * k));
    fputs(")\n", out);
}

static void write_displacement(FILE *out, const Report *r)
{
    const Detail *d = &r->detail;
    const Spectrogram *s = d->spectrum;
    double limit = 0, top = 0;
    for (int i = 0; i < 2; i++) {
        write_history(out, i + 1, &d->history[i]);
        write_spectrum(out, i + 1, &s[i]);
        limit = fmax(limit, largest(d->history[i].n, d->history[i].u));
        top = fmax(top, largest(SPECTRUM_FREQUENCIES * SPECTRUM_TIMES, s[i].amplitude));
    }
    fputs("$HZ << EOD\n", out);
    for (int mode = 0; mode < MODES_SHOWN && mode < d->n_floors; mode++)
        numbers(out, 1, log10(d->building_hz[mode]));
    fprintf(out, "EOD\nFLOOR = %d; LIMIT = %.6g; TOP = %.6g; END = %.6g; LOW = %.6g; HIGH = %.6g\n", d->floor + 1,
            limit, sqrt(top), s->t[SPECTRUM_TIMES - 1], log10(s->f[0]), log10(s->f[SPECTRUM_FREQUENCIES - 1]));
    write_amplitude_tics(out, top);
}

#define DISPLACEMENT_OF(history, spectrum, i)                                                                          \
    "LEFT = 0.085 + 0.445 * (" i " - 1)\n"                                                                             \
    "set lmargin at screen LEFT\nset rmargin at screen LEFT + 0.365\n"                                                 \
    "set tmargin at screen 0.92\nset bmargin at screen 0.68\nset title sprintf('floor %d, %s', FLOOR, CASE[" i "])\n"  \
    "set format x ''\nunset xlabel\nset ytics auto\nset ylabel 'displacement [m]'\n"                                   \
    "set yrange [-1.05*LIMIT:1.05*LIMIT]\nset grid back lc '#d8d8d8'\n"                                                \
    "plot " history " using 1:2 with lines lw 1 dt 1 lc rgb 'black'\n"                                                 \
    "unset title\nset tmargin at screen 0.63\nset bmargin at screen 0.14\nset format x '%g'\nset xlabel 'time [s]'\n"  \
    "set ylabel 'frequency [Hz]'\nset yrange [LOW:HIGH]\nunset grid\n"                                                 \
    "set ytics ('0.1' -1, '0.2' -0.69897, '0.5' -0.30103, '1' 0, '2' 0.30103, '5' 0.69897, '10' 1)\n"                  \
    "plot " spectrum " using 1:2:(sqrt($3)) with image, "                                                              \
    "$HZ using (0):1:(END):(0) with vectors nohead lw 1 dt (6,6) lc rgb 'white'\n"

static const char DISPLACEMENT[] =
    "set multiplot\nunset key\nset xrange [0:END]\nset cbrange [0:TOP]\nunset colorbox\n" DISPLACEMENT_OF(
        "$H1", "$S1", "1") "set colorbox user origin 0.915,0.14 size 0.012,0.49\n"
                           "set cblabel 'amplitude [m]' offset 0.5\n" DISPLACEMENT_OF("$H2", "$S2", "2");

/* ---- other earthquakes ------------------------------------------------------------------------------------------- */

/* The file's name; of a built-in motion that it is synthetic. */
static void write_motion_name(FILE *out, const char *record)
{
    char text[160];
    if (builtin_name(record))
        snprintf(text, sizeof text, "%s (synthetic)", builtin_name(record));
    else
        snprintf(text, sizeof text, "%s", basename(record));
    gnuplot_quote(out, text);
}

static const char ELSEWHERE[] =
    "set lmargin at screen 0.07\nset rmargin at screen 0.47\nunset key\nset title NAME noenhanced\nset xrange [0:*]\n"
    "set xtics auto\nunset logscale\nset xlabel 'peak interstorey drift [m]'\n" FLOOR_AXIS
    "plot for [i=1:2] $P using (column(3*i)):1 with linespoints lt i title CASE[i]\n"
    "set lmargin at screen 0.57\nset rmargin at screen 0.98\nset ytics auto\n" MODE_AXES
    "plot for [i=1:2] $M using 1:(column(i+1)) with linespoints lt i title CASE[i]\n";

static void write_elsewhere(FILE *out, const Report *r)
{
    const Detail *d = &r->detail;
    const double rows = (double)d->n_elsewhere;
    fputs("set multiplot\n", out);
    for (size_t e = 0; e < d->n_elsewhere; e++) {
        const SimResult *const pair[] = {&d->elsewhere[e].with_core, &d->elsewhere[e].no_core};
        write_floors(out, d->n_floors, 2, pair);
        write_modes_of(out, 2, pair);
        fputs("NAME = ", out);
        write_motion_name(out, d->elsewhere[e].record);
        fprintf(out, "\nset tmargin at screen %g\nset bmargin at screen %g\n%s", 1 - ((double)e + 0.09) / rows,
                1 - ((double)e + 0.83) / rows, ELSEWHERE);
    }
}

/* ---- all of them ----------------------------------------------------------------------------------------------- */

static const Picture PICTURES[] = {
    {"front", 1200, 420, WITH_PAIRS, write_front, FRONT},
    {"growth", 700, 400, WITH_GROWTH, write_growth, GROWTH},
    {"gaps", 900, 460, WITH_DETAIL, write_gaps, GAPS},
    {"peaks", 1200, 480, WITH_DETAIL, write_scenes, PEAKS},
    {"modes", 800, 420, WITH_DETAIL, write_scenes, MODES},
    {"energies", 1200, 460, WITH_HISTORIES, write_energies, ENERGIES},
    {"displacement", 1200, 600, WITH_HISTORIES, write_displacement, DISPLACEMENT},
    {"elsewhere", 1000, 400, WITH_ELSEWHERE, write_elsewhere, ""},
};

static void write_script(FILE *out, const void *user)
{
    const Drawing *d = user;
    const Picture *p = d->picture;
    const int height = p->height * (p->wants == WITH_ELSEWHERE ? (int)d->report->detail.n_elsewhere : 1);
    if (d->is_png)
        fprintf(out, "set terminal pngcairo size %d,%d font 'sans,15' background rgb 'white'\nDOT = 0.8\n",
                p->width * 3 / 2, height * 3 / 2);
    else
        fprintf(out, "set terminal svg size %d,%d dynamic font 'sans,13' background rgb 'white'\nDOT = 0.4\n", p->width,
                height);
    fputs(STYLE, out);
    p->write(out, d->report);
    fprintf(out, "%sunset multiplot\n", p->script);
}

static int is_there(const Report *r, Condition wanted)
{
    const Detail *d = &r->detail;
    size_t n = 0;
    for (size_t i = 0; i < r->run->n_generations; i++)
        n += isfinite(r->run->generation[i].hypervolume) != 0;
    const int there[] = {[ALWAYS] = 1,
                         [WITH_PAIRS] = r->run->schema.n_obj > 1,
                         [WITH_GROWTH] = n > 1,
                         [WITH_DETAIL] = r->has_detail,
                         [WITH_HISTORIES] = r->has_detail && d->history[0].n > 1 && d->history[1].n > 1,
                         [WITH_ELSEWHERE] = d->n_elsewhere > 0};
    return there[wanted];
}

Status report_pictures(const Report *r, const char *folder, Err *err)
{
    if (mkdir(folder, 0777) != 0 && errno != EEXIST)
        return fail_errno(err, folder, "cannot be made a folder");
    for (size_t i = 0; i < N_OF(PICTURES); i++)
        for (int is_png = 0; is_png < 2 && is_there(r, PICTURES[i].wants); is_png++) {
            const Drawing drawing = {r, &PICTURES[i], is_png};
            char path[PATH_MAX];
            if (snprintf(path, sizeof path, "%s/%s.%s", folder, PICTURES[i].name, is_png ? "png" : "svg") >=
                (int)sizeof path)
                return fail(err, STATUS_IO, "%.200s...: the path is too long", folder);
            TRY(gnuplot_draw(path, write_script, &drawing, err));
        }
    return STATUS_OK;
}
