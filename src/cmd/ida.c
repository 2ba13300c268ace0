#include "cmd/ida.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/figure.h"
#include "cmd/show.h"
#include "report/gnuplot.h"

const double IDA_FRACTILE[IDA_FRACTILES] = {0.16, 0.5, 0.84};
const char *const IDA_FRACTILE_WORD[IDA_FRACTILES] = {"16 %", "median", "84 %"};

/* ---- for people and programs ------------------------------------------------------------------------------------- */

static int n_shown(const MeasureOrder *order)
{
    return order->n_obj < IDA_SHOWN ? order->n_obj : IDA_SHOWN;
}

void ida_print(const Evaluations *e, const MeasureOrder *order)
{
    char text[3 * FIGURE_MAX + 16], value[IDA_FRACTILES][FIGURE_MAX];
    for (int c = 0; c < N_EVALUATED; c++) {
        json_t *table = json_array();
        printf("%s, %zu records: median (16 %% to 84 %%)\n", EVALUATION_CASES[c].word, e->n_read);
        for (size_t l = 0; l < e->n_levels; l++) {
            json_t *row = figures_row(table);
            json_object_set_new(row, "pga_g", json_real(e->level[l]));
            for (int i = 0; i < n_shown(order); i++) {
                for (int f = 0; f < IDA_FRACTILES; f++)
                    figure_text(ida_fractile(e, l, (EvaluatedCase)c, order->of[i], IDA_FRACTILE[f]), NAN, NAN,
                                value[f]);
                snprintf(text, sizeof text, "%s (%s to %s)", value[1], value[0], value[2]);
                json_object_set_new(row, measure(order->of[i])->name, json_string(text));
            }
        }
        figures_print(table);
        putchar('\n');
    }
}

static json_t *json_fractiles(const Evaluations *e, EvaluatedCase which, double p)
{
    json_t *o = json_object();
    for (int k = 0; k < N_MEASURES; k++) {
        json_t *list = json_array();
        for (size_t l = 0; l < e->n_levels; l++)
            json_array_append_new(list, json_number(ida_fractile(e, l, which, k, p)));
        json_object_set_new(o, measure(k)->name, list);
    }
    return o;
}

json_t *ida_json(const Evaluations *e)
{
    static const char *const KEYS[IDA_FRACTILES] = {"fractile_16", "median", "fractile_84"};
    json_t *o = json_object();
    json_object_set_new(o, "pga_g", json_numbers(e->n_levels, e->level));
    for (int c = 0; c < N_EVALUATED; c++) {
        json_t *one = json_object();
        for (int i = 0; i < IDA_FRACTILES; i++)
            json_object_set_new(one, KEYS[i], json_fractiles(e, (EvaluatedCase)c, IDA_FRACTILE[i]));
        json_object_set_new(o, EVALUATION_CASES[c].key, one);
    }
    return o;
}

/* ---- the picture ------------------------------------------------------------------------------------------------- */

typedef struct {
    const Evaluations *e;
    const MeasureOrder *order;
} Picture;

/* $R0, $R1, ...: the records; $F00 ... $F22: fractiles of the cases. Columns: intensity, objectives. */
static void write_blocks(FILE *script, const Evaluations *e, const MeasureOrder *order)
{
    for (size_t r = 0; r < e->n_records; r++) {
        if (e->record[r].readable != STATUS_OK)
            continue;
        fprintf(script, "$R%zu << EOD\n", r);
        for (size_t l = 0; l < e->n_levels; l++) {
            fprintf(script, "%.6g ", e->level[l]);
            for (int k = 0; k < n_shown(order); k++)
                gnuplot_number(script, ida_value(&e->run[r * e->n_levels + l], EVALUATED_DESIGN, order->of[k]));
            fputc('\n', script);
        }
        fputs("EOD\n", script);
    }
    for (int c = 0; c < N_EVALUATED; c++)
        for (int i = 0; i < IDA_FRACTILES; i++) {
            fprintf(script, "$F%d%d << EOD\n", c, i);
            for (size_t l = 0; l < e->n_levels; l++) {
                fprintf(script, "%.6g ", e->level[l]);
                for (int k = 0; k < n_shown(order); k++)
                    gnuplot_number(script, ida_fractile(e, l, (EvaluatedCase)c, order->of[k], IDA_FRACTILE[i]));
                fputc('\n', script);
            }
            fputs("EOD\n", script);
        }
}

static void write_panel(FILE *script, const Picture *p, int k)
{
    static const char *const COLOURS[N_EVALUATED] = {"#0072b2", "#8a6d00", "#d55e00"};
    const Evaluations *e = p->e;
    const Measure *of = measure(p->order->of[k]);
    fprintf(script, "set xlabel '%s [%s]'\nset %s\nplot ", of->what, of->unit, k == 0 ? "key" : "key off");
    for (size_t r = 0; r < e->n_records; r++)
        if (e->record[r].readable == STATUS_OK)
            fprintf(script, "$R%zu using %d:1 with lines lc '#b8c8d8' notitle, ", r, k + 2);
    for (int c = 0; c < N_EVALUATED; c++)
        for (int i = 0; i < IDA_FRACTILES; i++) {
            fprintf(script, "$F%d%d using %d:1 with lines lc '%s' %s ", c, i, k + 2, COLOURS[c],
                    i == 1 ? "lw 2.5" : "lw 1.2 dt (6,4)");
            if (i == 1)
                fprintf(script, "title '%s: median, 16 and 84 %%'", EVALUATION_CASES[c].word);
            else
                fputs("notitle", script);
            fputs(c + 1 < N_EVALUATED || i + 1 < IDA_FRACTILES ? ", " : "\n", script);
        }
}

static void write_script(FILE *script, const void *user)
{
    const Picture *p = user;
    write_blocks(script, p->e, p->order);
    fprintf(script,
            "set terminal svg size 1300,520 font 'sans,13' noenhanced background '#ffffff'\n"
            "set grid lc '#d0d0d0'\nset tics nomirror\nset xrange [0:*]\nset yrange [0:*]\n"
            "set ylabel 'peak ground acceleration [g]'\n"
            "set multiplot layout 1,%d margins 0.06,0.98,0.13,0.82 spacing 0.07,0\n"
            "set key at screen 0.5,0.98 center top horizontal\n",
            n_shown(p->order));
    for (int k = 0; k < n_shown(p->order); k++)
        write_panel(script, p, k);
    fputs("unset multiplot\n", script);
}

Status ida_draw(const Evaluations *e, const MeasureOrder *order, const char *path, Err *err)
{
    return gnuplot_draw(path, write_script, &(Picture){e, order}, err);
}
