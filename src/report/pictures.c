/* Every picture is a data block of numbers and a script over it; the terminal comes in front of both. */
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <string.h>
#include <sys/stat.h>

#include "moga/hypervolume.h"
#include "report/gnuplot.h"
#include "report/report.h"
#include "simulator/measures.h"

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

static const char *file_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

/* ---- the front ------------------------------------------------------------------------------------------------- */

/* Of objective k: tonnes of the core's mass, else the unit of the files. */
static double scale_of(const Report *r, size_t k)
{
    return r->has_detail && r->run->schema.order.of[k] == MEASURE_MCORE ? 1e-3 : 1;
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

/* What objective k is, with its unit; of another problem its name, without the apostrophe that keeps it from being a
 * formula in a spreadsheet (base/cell.h). */
static void write_label(FILE *script, const Report *r, size_t k)
{
    char text[128];
    const char *name = schema_objective(&r->run->schema, k)->name;
    if (r->has_detail) {
        const Measure *m = measure(r->run->schema.order.of[k]);
        snprintf(text, sizeof text, "%s [%s]", m->what, scale_of(r, k) < 1 ? "t" : m->unit);
    } else {
        snprintf(text, sizeof text, "%s", name + (name[0] == '\'' && name[1] && strchr("=+-@", name[1])));
    }
    gnuplot_quote(script, text);
}

/* Two objectives against each other; the last one gives the colour. */
typedef struct {
    size_t x, y;
} Panel;

static void write_panel(FILE *script, const Report *r, const Panel *p)
{
    const size_t x = p->x + 1, y = p->y + 1;
    fputs("set xlabel ", script);
    write_label(script, r, p->x);
    fputs(" noenhanced\nset ylabel ", script);
    write_label(script, r, p->y);
    fprintf(script,
            " noenhanced offset 1.2\n"
            "plot $FRONT using %zu:%zu:%zu with points pt 7 ps DOT lc palette, "
            "$KNEE using %zu:%zu with points pt 13 ps 2.6 lc rgb 'white', "
            "'' using %zu:%zu with points pt 13 ps 1.8 lc rgb WITHOUT",
            x, y, r->run->schema.n_obj, x, y, x, y);
    if (r->has_detail && !r->is_robust)
        fprintf(script,
                ", $ALONE using %zu:%zu with points pt 2 ps 1.7 lw 7 lc rgb 'white', "
                "'' using %zu:%zu with points pt 2 ps 1.5 lw 3 lc rgb 'black'",
                x, y, x, y);
    fputs("\nunset label\n", script);
}

/* Those of the paper that are there, or the first three pairs. Returns how many there are. */
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
    if (n > 0)
        return n;
    memcpy(panels, PAIRS, sizeof PAIRS);
    if (s->n_obj == 1)
        panels[0].y = 0;
    return s->n_obj > 2 ? 3 : 1;
}

static void write_legend(FILE *script, const Report *r)
{
    fprintf(script,
            "set label 1 '%zu designs of the front' at screen 0.06,0.95 point pt 7 ps 1 lc rgb '#21918c' offset 0.8\n"
            "set label 2 'the knee' at screen 0.28,0.95 point pt 13 ps 1.8 lc rgb WITHOUT offset 1\n",
            r->run->n_front);
    if (r->has_detail)
        fputs("set xrange [0:*]\nset yrange [0:*]\n", script);
    if (r->has_detail && !r->is_robust)
        fputs("set label 3 'the building without a core' at screen 0.39,0.95 point pt 2 ps 1.5 lw 3 lc rgb 'black' "
              "offset 1\n",
              script);
    fputs("set cblabel ", script);
    write_label(script, r, r->run->schema.n_obj - 1);
    fputs(" noenhanced\n", script);
}

static void write_front(FILE *script, const Report *r)
{
    Panel panels[3];
    const size_t n = choose_panels(r, panels);
    write_rows(script, "FRONT", r, r->run->n_front, r->run->front);
    write_rows(script, "KNEE", r, 1, &r->knee);
    fputs("$ALONE << EOD\n", script);
    for (size_t k = 0; r->has_detail && k < r->run->schema.n_obj; k++)
        gnuplot_number(script,
                       measure_value(&r->detail.result[SCENE_NO_CORE], r->run->schema.order.of[k]) * scale_of(r, k));
    fprintf(script,
            "\nEOD\nset multiplot layout 1,%zu margins 0.055,0.905,0.135,0.88 spacing 0.066,0\n"
            "set offsets graph 0.02, graph 0.04, graph 0.04, graph 0.02\nunset key\nunset colorbox\n",
            n);
    write_legend(script, r);
    for (size_t i = 0; i < n; i++) {
        if (i + 1 == n)
            fputs("set colorbox user origin 0.922,0.135 size 0.013,0.745\n", script);
        write_panel(script, r, &panels[i]);
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

static void write_gaps(FILE *script, const Report *r)
{
    const Detail *d = &r->detail;
    fputs("$D << EOD\n", script);
    for (int j = 0; j < d->n_floors; j++)
        numbers(script, 3, (double)j + 1, 1e3 * d->gap_m[j], 1e3 * d->thickness_m[j]);
    fprintf(script,
            "EOD\nset multiplot layout 1,2 margins 0.09,0.97,0.13,0.95 spacing 0.12,0\nunset key\n"
            "set yrange [0.3:%d.7]\nset ylabel 'floor'\nset xrange [0:*]\nset xlabel 'gap [mm]'\n"
            "plot $D using (0):1:(0):2:($1-0.38):($1+0.38) with boxxyerror lc rgb WITH\n"
            "set xlabel 'thickness of the core [mm]'\n"
            "plot $D using 3:1 with linespoints lw 2.5 pt 7 ps 0.7 lc rgb WITH\nunset multiplot\n",
            d->n_floors);
}

static const char SCENE_LINES[] =
    "plot $P using (column(1+K)):1 with linespoints lw 2.2 pt 7 ps 0.7 lc rgb WITH title 'with core', "
    "'' using (column(4+K)):1 with linespoints lw 2.2 dt (8,4) pt 13 ps 0.8 lc rgb WITHOUT title 'without core', "
    "'' using (column(7+K)):1 with linespoints lw 2.2 dt (3,3) pt 9 ps 0.8 lc rgb RIGID title 'rigidly connected', "
    "'' using (column(10+K)):1 with linespoints lw 1.6 dt (12,4) pt 5 ps 0.6 lc rgb GREEN title 'tuned mass damper', "
    "'' using (column(13+K)):1 with linespoints lw 1.6 dt (2,4) pt 11 ps 0.7 lc rgb PURPLE title 'viscous links'\n";

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
    fprintf(script,
            "EOD\nset multiplot layout 1,3 margins 0.055,0.985,0.14,0.88 spacing 0.055,0\nset xrange [0:*]\n"
            "set yrange [0.5:%d.5]\nset ylabel 'floor'\nset key at screen 0.5,0.95 center vertical maxrows 1\n"
            "set xlabel 'peak displacement [m]'\nK = 1\n%sunset key\nunset ylabel\n"
            "set xlabel 'peak interstorey drift [m]'\nK = 2\n%s"
            "set xlabel 'peak absolute acceleration [g]'\nK = 3\n%sunset multiplot\n",
            d->n_floors, SCENE_LINES, SCENE_LINES, SCENE_LINES);
}

/* Shares of the leading modes of up to three responses side by side. */
static void write_modes_of(FILE *script, const char *block, size_t n, const SimResult *const results[])
{
    const int n_modes = results[0]->n_modes < 10 ? results[0]->n_modes : 10;
    fprintf(script, "$%s << EOD\n", block);
    for (int i = 0; i < n_modes; i++) {
        fprintf(script, "%d ", i + 1);
        for (size_t s = 0; s < n; s++)
            fprintf(script, "%.6g ", results[s]->mode_share_pct[i]);
        fputc('\n', script);
    }
    fputs("EOD\n", script);
}

static void write_modes(FILE *script, const Report *r)
{
    const SimResult *const all[] = {&r->detail.result[SCENE_IMPACT], &r->detail.result[SCENE_NO_CORE],
                                    &r->detail.result[SCENE_RIGID]};
    write_modes_of(script, "M", sizeof all / sizeof all[0], all);
    fputs(
        "set xlabel 'mode of the building'\nset ylabel 'share of the input energy [%]'\nset yrange [0:*]\n"
        "set style data histograms\nset style histogram clustered gap 1\nset boxwidth 0.9 relative\nset grid noxtics\n"
        "plot $M using 2:xtic(1) lc rgb WITH title 'with core', '' using 3 lc rgb WITHOUT title 'without core', "
        "'' using 4 lc rgb RIGID title 'rigidly connected'\n",
        script);
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
        const double top = 1 - ((double)e + 0.09) / rows, bottom = 1 - ((double)e + 0.86) / rows;
        write_modes_of(script, "M", 2, pair);
        fputs("$P << EOD\n", script);
        for (int j = 0; j < d->n_floors; j++)
            numbers(script, 3, (double)j + 1, at->with_core.peak_drift_m[j], at->no_core.peak_drift_m[j]);
        fprintf(script,
                "EOD\nset tmargin at screen %g\nset bmargin at screen %g\nset lmargin at screen 0.07\n"
                "set rmargin at screen 0.47\nunset key\nset title ",
                top, bottom);
        gnuplot_quote(script, file_name(at->record));
        fprintf(
            script,
            " noenhanced\nset xrange [0:*]\nset yrange [0.5:%d.5]\nset xtics auto\nset xlabel 'peak interstorey drift "
            "[m]'\n"
            "set ylabel 'floor'\nset style data lines\n"
            "plot $P using 2:1 with linespoints lw 2.2 pt 7 ps 0.7 lc rgb WITH title 'with core', "
            "'' using 3:1 with linespoints lw 2.2 dt (8,4) pt 13 ps 0.8 lc rgb WITHOUT title 'without core'\n"
            "set lmargin at screen 0.57\nset rmargin at screen 0.98\nset autoscale x\nset yrange [0:*]\n"
            "set xlabel 'mode of the building'\nset ylabel 'share of the input energy [%%]'\n"
            "set key top right\nset style data histograms\nset style histogram clustered gap 1\nset boxwidth 0.9 "
            "relative\n"
            "plot $M using 2:xtic(1) lc rgb WITH title 'with core', '' using 3 lc rgb WITHOUT title 'without core'\n",
            d->n_floors);
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
