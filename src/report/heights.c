#include "report/heights.h"

#include "report/gnuplot.h"

/* Okabe and Ito's colours. */
static const char *const COLOURS[HEIGHT_CURVES_MAX] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7"};
enum { PANEL_WIDTH = 230, PANEL_HEIGHT = 420, TOP = 40 };

static void write_block(FILE *script, const Heights *h, int panel)
{
    const HeightPanel *p = &h->panel[panel];
    fprintf(script, "$P%d << EOD\n", panel);
    for (int j = p->from_ground ? -1 : 0; j < h->n; j++) {
        fprintf(script, "%.6g", j < 0 ? 0.0 : h->z[j]);
        for (int c = 0; c < HEIGHT_CURVES_MAX; c++)
            fprintf(script, " %.6g", p->curve[c] && j >= 0 ? p->curve[c][j] : 0.0);
        fputc('\n', script);
    }
    fputs("EOD\n", script);
}

static void write_panel(FILE *script, const Heights *h, int panel)
{
    const HeightPanel *p = &h->panel[panel];
    fputs("set title ", script);
    gnuplot_quote(script, p->title);
    fprintf(script, " noenhanced\nset ylabel '%s'\nset format y '%s'\nplot ",
            panel % h->columns == 0 ? "height [m]" : "", panel % h->columns == 0 ? "%g" : "");
    for (int c = 0; c < HEIGHT_CURVES_MAX && p->curve[c]; c++) {
        fprintf(script, "%s$P%d using %d:1 with lines lw 1.5 lc '%s' dt %s ", c ? ", " : "", panel, c + 2, COLOURS[c],
                c ? "(7,4)" : "1");
        if (p->name[c]) {
            fputs("title ", script);
            gnuplot_quote(script, p->name[c]);
        } else {
            fputs("notitle", script);
        }
    }
    fputc('\n', script);
}

static void write_all(FILE *script, const void *user)
{
    const Heights *h = user;
    const int rows = (h->n_panels + h->columns - 1) / h->columns;
    for (int i = 0; i < h->n_panels; i++)
        write_block(script, h, i);
    fprintf(script,
            "set terminal svg size %d,%d font 'sans,12' noenhanced background '#ffffff'\nset grid lc '#d8d8d8'\n"
            "set tics nomirror\nset xtics rotate autofreq\nset border 3\nset yrange [0:%.6g]\nset key bottom right\n"
            "set multiplot layout %d,%d title ",
            PANEL_WIDTH * h->columns + 60, PANEL_HEIGHT * rows + TOP, 1.02 * h->z[h->n - 1], rows, h->columns);
    gnuplot_quote(script, h->title);
    fputc('\n', script);
    for (int i = 0; i < h->n_panels; i++)
        write_panel(script, h, i);
    fputs("unset multiplot\n", script);
}

Status heights_draw(const Heights *h, const char *path, Err *err)
{
    return gnuplot_draw(path, write_all, h, err);
}
