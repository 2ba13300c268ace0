#include "scene/building_svg.h"

#include <math.h>
#include <string.h>

/* Sizes in px. */
static const double TOP = 40, LEFT = 60, HEIGHT = 640, WIDTH_MAX = 520, MODE_WIDTH = 64, LABELS = 95;
enum { MODES_SHOWN = 10 };

typedef struct {
    FILE *out;
    double x0, z1, scale; /* [m] left edge and top of the building, [px/m] */
    double right;         /* [px] where the building ends */
} Drawing;

static double px(const Drawing *d, double x)
{
    return LEFT + (x - d->x0) * d->scale;
}

static double py(const Drawing *d, double z)
{
    return TOP + (d->z1 - z) * d->scale;
}

/* Names come from users. */
static void print_text(FILE *out, const char *text)
{
    for (; *text; text++)
        if (strchr("<>&\"", *text))
            fprintf(out, "&#%d;", *text);
        else
            fputc(*text, out);
}

/* ---- the building --------------------------------------------------------------------------------------------- */

static void draw_element(const Drawing *d, const Frame *f, const FrameElement *e)
{
    const FrameNode *a = &f->node[e->node[0]], *b = &f->node[e->node[1]];
    const double x[2] = {px(d, a->x), px(d, b->x)}, y[2] = {py(d, a->z), py(d, b->z)};
    fprintf(d->out, "<line class=\"e\" x1=\"%.2f\" y1=\"%.2f\" x2=\"%.2f\" y2=\"%.2f\"><title>", x[0], y[0], x[1],
            y[1]);
    print_text(d->out, e->name);
    fputs(": ", d->out);
    print_text(d->out, f->section[e->section].name);
    fputs("</title></line>\n", d->out);
    for (int end = 0; end < 2; end++) /* a pin, 6 px along the element */
        if (e->pinned[end]) {
            const double l = hypot(x[1] - x[0], y[1] - y[0]), share = 6 / fmax(l, 12);
            fprintf(d->out, "<circle class=\"p\" cx=\"%.2f\" cy=\"%.2f\" r=\"2.5\"/>\n",
                    x[end] + share * (x[!end] - x[end]), y[end] + share * (y[!end] - y[end]));
        }
}

/* A triangle where the ground holds z, a bar beside it where it holds x alone; filled where it holds the rotation
 * too. */
static void draw_support(const Drawing *d, const FrameNode *n)
{
    const double x = px(d, n->x), y = py(d, n->z);
    if (n->fixed[FRAME_Z])
        fprintf(d->out, "<path class=\"%s\" d=\"M%.2f %.2f l-6 10 h12 z\"/>\n", n->fixed[FRAME_ROT] ? "s f" : "s", x,
                y);
    else if (n->fixed[FRAME_X])
        fprintf(d->out, "<path class=\"s\" d=\"M%.2f %.2f l-8 -5 v10 z\"/>\n", x, y);
}

static void draw_frame(const Drawing *d, const Frame *f)
{
    for (int e = 0; e < f->n[FRAME_ELEMENTS]; e++)
        draw_element(d, f, &f->element[e]);
    for (int i = 0; i < f->n[FRAME_NODES]; i++) {
        const FrameNode *n = &f->node[i];
        draw_support(d, n);
        if (n->floor)
            fprintf(d->out, "<circle class=\"n\" cx=\"%.2f\" cy=\"%.2f\" r=\"2\"><title>floor %d</title></circle>\n",
                    px(d, n->x), py(d, n->z), n->floor);
    }
}

static void draw_stick(const Drawing *d, const Building *b)
{
    double z = 0, mass, largest = 0;
    for (int j = 0; j < b->n; j++)
        largest = fmax(largest, b->M[j * b->n + j]);
    fprintf(d->out, "<path class=\"s f\" d=\"M%.2f %.2f h40\"/>\n", px(d, 0) - 20, py(d, 0));
    for (int j = 0; j < b->n; j++) {
        const double x = px(d, 0), foot = py(d, z);
        z += b->storey_m[j];
        mass = b->M[j * b->n + j];
        fprintf(d->out, "<line class=\"e\" x1=\"%.2f\" y1=\"%.2f\" x2=\"%.2f\" y2=\"%.2f\"/>\n", x, foot, x, py(d, z));
        fprintf(d->out,
                "<circle class=\"n\" cx=\"%.2f\" cy=\"%.2f\" r=\"%.2f\"><title>floor %d: %.4g kg</title></circle>\n", x,
                py(d, z), 3 + 5 * sqrt(mass / largest), j + 1, mass);
    }
}

/* ---- floors and modes ----------------------------------------------------------------------------------------- */

/* Height of a floor in the drawing: ground is where the first storey begins. */
static double floor_z(const Building *b, double ground, int floor)
{
    for (int j = 0; j < floor; j++)
        ground += b->storey_m[j];
    return ground;
}

static void draw_floor_labels(const Drawing *d, const Building *b, double ground)
{
    const int step = 1 + b->n / 25;
    for (int k = 0; k <= b->n; k += step)
        fprintf(d->out, "<text x=\"%.2f\" y=\"%.2f\">%d: %.4g m</text>\n", d->right + 12,
                py(d, floor_z(b, ground, k)) + 4, k, floor_z(b, 0, k));
}

static void draw_mode(const Drawing *d, const Building *b, double ground, int mode)
{
    const double left = d->right + LABELS + MODE_WIDTH * mode, middle = left + 0.5 * MODE_WIDTH;
    double largest = 0, mass = 0;
    for (int j = 0; j < b->n; j++)
        largest = fmax(largest, fabs(b->phi[j * b->n + mode]));
    for (int i = 0; i < b->n * b->n; i++)
        mass += b->M[i];
    fprintf(
        d->out,
        "<line class=\"a\" x1=\"%.2f\" y1=\"%.2f\" x2=\"%.2f\" y2=\"%.2f\"/>\n<polyline class=\"m\" points=\"%.2f,%.2f",
        middle, py(d, ground), middle, py(d, floor_z(b, ground, b->n)), middle, py(d, ground));
    for (int j = 0; j < b->n; j++)
        fprintf(d->out, " %.2f,%.2f", middle + 0.42 * MODE_WIDTH * b->phi[j * b->n + mode] / largest,
                py(d, floor_z(b, ground, j + 1)));
    fprintf(d->out,
            "\"/>\n<text class=\"c\" x=\"%.2f\" y=\"%.2f\">%.4g s</text><text class=\"c\" x=\"%.2f\" "
            "y=\"%.2f\">%.3g %%</text>\n",
            middle, TOP - 26, 2 * M_PI / b->omega[mode], middle, TOP - 12,
            100 * b->gamma[mode] * b->gamma[mode] / mass);
}

/* ---- the page ------------------------------------------------------------------------------------------------- */

typedef struct {
    double x0, x1, z0, z1, ground; /* [m] */
} Extent;

static Extent find_extent(const Building *b, const Frame *f)
{
    Extent e = {HUGE_VAL, -HUGE_VAL, HUGE_VAL, -HUGE_VAL, 0};
    const double height = floor_z(b, 0, b->n);
    if (!f)
        return (Extent){-0.1 * height, 0.1 * height, 0, height, 0};
    for (int i = 0; i < f->n[FRAME_NODES]; i++) {
        const FrameNode *n = &f->node[i];
        e.x0 = fmin(e.x0, n->x);
        e.x1 = fmax(e.x1, n->x);
        e.z0 = fmin(e.z0, n->z);
        e.z1 = fmax(e.z1, n->z);
        if (n->floor == b->n)
            e.ground = n->z - height;
    }
    return e;
}

void building_svg(FILE *out, const Building *b, const Frame *f)
{
    const Extent e = find_extent(b, f);
    const double scale = fmin(HEIGHT / (e.z1 - e.z0), WIDTH_MAX / fmax(e.x1 - e.x0, 1e-9));
    Drawing d = {.out = out, .x0 = e.x0, .z1 = e.z1, .scale = scale, .right = LEFT + (e.x1 - e.x0) * scale};
    const int modes = b->n < MODES_SHOWN ? b->n : MODES_SHOWN;
    const double width = d.right + LABELS + MODE_WIDTH * modes + 20, height = TOP + (e.z1 - e.z0) * scale + 40;
    fprintf(out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %.0f %.0f\" width=\"%.0f\" height=\"%.0f\">\n"
            "<style>.e{stroke:#345;stroke-width:1.5}.n{fill:#c40}.p{fill:#fff;stroke:#345}.s{fill:#fff;stroke:#345}"
            ".f{fill:#345}.a{stroke:#bbb}.m{fill:none;stroke:#06c;stroke-width:1.5}text{font:12px sans-serif;fill:#222}"
            ".c{text-anchor:middle}</style>\n<rect width=\"100%%\" height=\"100%%\" fill=\"#fff\"/>\n",
            width, height, width, height);
    if (f)
        draw_frame(&d, f);
    else
        draw_stick(&d, b);
    draw_floor_labels(&d, b, e.ground);
    for (int mode = 0; mode < modes; mode++)
        draw_mode(&d, b, e.ground, mode);
    fprintf(out, "</svg>\n");
}
