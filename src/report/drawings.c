#include "report/drawings.h"

/* Sizes in px; a page of A4 has some 700 across. */
static const double HEIGHT = 430, TOP = 34, FOOT = 22, LEFT = 62, PANEL = 205, ACROSS = 80;
enum { POINTS_MAX = 1200 };

static const char *const COLOURS[CURVES_SHOWN] = {"#0a58ca", "#777", "#d55e00", "#0a7d4f"};
static const char *const DASHES[CURVES_SHOWN] = {"none", "none", "6 3", "2 3"};

static double total_height(const Detail *d)
{
    double z = 0;
    for (int j = 0; j < d->n_floors; j++)
        z += d->storey_m[j];
    return z;
}

static void begin(FILE *out, double height, const char *title)
{
    fprintf(out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 700 %.0f\" width=\"700\" role=\"img\" "
            "aria-label=\"%s\" font-family=\"sans-serif\" font-size=\"12\">\n",
            height, title);
}

/* ---- devices --------------------------------------------------------------------------------------------------- */

static void draw_link(FILE *out, double x, double width, double y)
{
    fprintf(out,
            "<path d=\"M%.1f %.1f h%.1f\" stroke=\"#0a7d4f\"/><rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"6\" "
            "fill=\"#0a7d4f\"/>\n",
            x, y + 5, width, x + 0.3 * width, y + 2, 0.4 * width);
}

/* What is between floor j and one side of the core at x0; direction +1: to the right of it. */
static void draw_side(FILE *out, const Detail *d, const Design *design, int j, double gap_px, int has_stop, double x0,
                      double direction, double y)
{
    const double face = x0 + direction * gap_px, end = x0 + direction * 150;
    fprintf(out, "<path d=\"M%.1f %.1f H%.1f\" stroke=\"#345\" stroke-width=\"2.5\"/>\n", has_stop ? face : end, y,
            end);
    if (has_stop)
        fprintf(out, "<path d=\"M%.1f %.1f v10\" stroke=\"#c40\" stroke-width=\"%d\"/>\n", face, y - 5,
                d->bumper_n_m[j] > 0 ? 6 : 3);
    if (design_has_link(design, j))
        draw_link(out, direction > 0 ? x0 : end, 150, y);
}

static void label_floor(FILE *out, const Design *design, const Detail *d, int j, double y)
{
    const double gap = d->gap_m[j];
    fprintf(out, "<text x=\"8\" y=\"%.1f\">%d</text><text x=\"460\" y=\"%.1f\">", y + 4, j + 1, y + 4);
    if (isinf(gap))
        fputs("no stop", out);
    else if (d->gap_sides == GAPS_EACH)
        fprintf(out, "%.1f | %.1f mm", 1e3 * d->gap_side_m[1][j], 1e3 * d->gap_side_m[0][j]);
    else
        fprintf(out, "%.1f mm", 1e3 * gap);
    fputs("</text>", out);
    if (d->thickness_m[j] > 0)
        fprintf(out, "<text x=\"560\" y=\"%.1f\">%.1f mm</text>", y + 4, 1e3 * d->thickness_m[j]);
    if (design_has_link(design, j))
        fprintf(out, "<text x=\"630\" y=\"%.1f\">%s</text>", y + 4, design->link[j] > 0 ? "link" : "friction");
    else if (d->bumper_n_m[j] > 0)
        fprintf(out, "<text x=\"630\" y=\"%.1f\">%.3g MN/m</text>", y + 4, 1e-6 * d->bumper_n_m[j]);
    fputc('\n', out);
}

static double largest_of(int n, const double v[])
{
    double most = 0;
    for (int j = 0; j < n; j++)
        most = isfinite(v[j]) ? fmax(most, v[j]) : most;
    return most;
}

void draw_devices(FILE *out, const Detail *d, const Design *design)
{
    const double height = total_height(d), scale = HEIGHT / height, middle = 240, half = 34;
    const double wide = fmax(largest_of(d->n_floors, d->gap_side_m[0]), largest_of(d->n_floors, d->gap_side_m[1]));
    const double thick = largest_of(d->n_floors, d->thickness_m);
    double z = 0;
    begin(out, HEIGHT + TOP + FOOT, "section through tower and core");
    fputs("<text x=\"8\" y=\"14\">floor</text><text x=\"460\" y=\"14\">gap</text><text x=\"560\" y=\"14\">core "
          "wall</text>\n",
          out);
    for (int j = 0; j < d->n_floors; j++) {
        const double foot = TOP + (height - z) * scale, y = foot - d->storey_m[j] * scale;
        const double wall = thick > 0 ? 2 + 8 * d->thickness_m[j] / thick : 4;
        for (int side = -1; side <= 1; side += 2) {
            const double gap = d->gap_side_m[side < 0][j], x = middle + side * half;
            fprintf(out, "<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" fill=\"#9ab\"/>",
                    x - (side > 0) * wall, y, wall, foot - y);
            draw_side(out, d, design, j, wide > 0 ? ACROSS * gap / wide : 0, isfinite(gap), x, side, y);
        }
        label_floor(out, design, d, j, y);
        z += d->storey_m[j];
    }
    if (design->mass_kg > 0)
        fprintf(out,
                "<text x=\"%.0f\" y=\"14\" text-anchor=\"middle\">tuned mass %.0f t, %.3g Hz, damping %.2g</text>\n",
                middle, 1e-3 * design->mass_kg, design->mass_hz, design->mass_damping);
    fprintf(out,
            "<path d=\"M%.0f %.1f V%d M%.0f %.1f V%d M40 %.1f H440\" stroke=\"#345\" stroke-width=\"3\" "
            "fill=\"none\"/>\n</svg>\n",
            middle - half - 150, HEIGHT + TOP, (int)TOP, middle + half + 150, HEIGHT + TOP, (int)TOP, HEIGHT + TOP);
}

/* ---- curves ---------------------------------------------------------------------------------------------------- */

static void draw_legend(FILE *out, const char *const names[CURVES_SHOWN])
{
    double x = LEFT;
    for (int c = 0; c < CURVES_SHOWN && names[c]; c++) {
        fprintf(out,
                "<path d=\"M%.0f 10 h26\" stroke=\"%s\" stroke-width=\"2\" stroke-dasharray=\"%s\"/><text x=\"%.0f\" "
                "y=\"14\">%s</text>\n",
                x, COLOURS[c], DASHES[c], x + 32, names[c]);
        x += 165;
    }
}

static void draw_panel(FILE *out, const Detail *d, const Panel *p, double x0)
{
    const double height = 300, scale = height / total_height(d), width = PANEL - 40;
    double most = 0;
    for (int c = 0; c < CURVES_SHOWN; c++)
        most = fmax(most, p->curve[c] ? largest_of(d->n_floors, p->curve[c]) : 0);
    fprintf(out,
            "<text x=\"%.0f\" y=\"%.0f\">%s</text><path d=\"M%.0f %.0f v%.0f h%.0f\" stroke=\"#999\" fill=\"none\"/>"
            "<text x=\"%.0f\" y=\"%.0f\">0</text><text x=\"%.0f\" y=\"%.0f\" text-anchor=\"end\">%.3g</text>\n",
            x0, TOP, p->title, x0, TOP + 10, height, width, x0, TOP + height + 26, x0 + width, TOP + height + 26,
            p->factor * most);
    for (int c = 0; c < CURVES_SHOWN && most > 0; c++) {
        double z = 0;
        const char *move = "M";
        fprintf(out, "<path fill=\"none\" stroke=\"%s\" stroke-width=\"%g\" stroke-dasharray=\"%s\" d=\"", COLOURS[c],
                p->is_bars ? 5 : 1.8, DASHES[c]);
        for (int j = 0; j < d->n_floors && p->curve[c]; j++) {
            z += d->storey_m[j];
            const double x = x0 + width * p->curve[c][j] / most, y = TOP + 10 + height - z * scale;
            if (!isfinite(x))
                continue;
            if (p->is_bars)
                fprintf(out, "M%.1f %.1f H%.1f ", x0, y, x);
            else
                fprintf(out, "%s%.1f %.1f ", move, x, y);
            move = "L";
        }
        fputs("\"/>\n", out);
    }
}

void draw_profiles(FILE *out, const Detail *d, const char *const names[CURVES_SHOWN], size_t n, const Panel panels[])
{
    begin(out, 375, "peaks over the height");
    draw_legend(out, names);
    fprintf(out, "<text x=\"6\" y=\"%.0f\">floor</text>\n", TOP);
    for (int j = 0, step = 1 + d->n_floors / 12; j < d->n_floors; j += step) {
        double z = 0;
        for (int i = 0; i <= j; i++)
            z += d->storey_m[i];
        fprintf(out, "<text x=\"%.0f\" y=\"%.1f\" text-anchor=\"end\">%d</text>\n", LEFT - 8,
                TOP + 14 + 300 - z * 300 / total_height(d), j + 1);
    }
    for (size_t i = 0; i < n; i++)
        draw_panel(out, d, &panels[i], LEFT + PANEL * (double)i);
    fputs("</svg>\n", out);
}

void draw_history(FILE *out, const Detail *d)
{
    static const char *const NAMES[CURVES_SHOWN] = {"with core", "no core"};
    double most = 0, end = 0;
    for (int i = 0; i < 2; i++)
        for (size_t k = 0; k < d->history[i].n; k++) {
            most = fmax(most, fabs(d->history[i].u[k]));
            end = fmax(end, d->history[i].t[k]);
        }
    begin(out, 250, "displacement over time");
    draw_legend(out, NAMES);
    for (int i = 1; i >= 0 && most > 0 && end > 0; i--) {
        const History *h = &d->history[i];
        const char *move = "M";
        fprintf(out, "<path fill=\"none\" stroke=\"%s\" d=\"", COLOURS[i]);
        for (size_t k = 0; k < h->n; k += 1 + h->n / POINTS_MAX) {
            fprintf(out, "%s%.1f %.1f", move, LEFT + 620 * h->t[k] / end, 125 - 95 * h->u[k] / most);
            move = "L";
        }
        fputs("\"/>\n", out);
    }
    fprintf(out,
            "<path d=\"M%.0f 125 h620\" stroke=\"#999\"/><text x=\"2\" y=\"34\">%.3g m</text><text x=\"2\" "
            "y=\"129\">0</text><text x=\"682\" y=\"242\" text-anchor=\"end\">%.4g s</text>\n</svg>\n",
            LEFT, most, end);
}
