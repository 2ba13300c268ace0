#include "scene/building_svg.h"

#include "base/text.h"

/* Sizes in px. */
static const double TOP = 40, LEFT = 60, HEIGHT = 640, WIDTH_MAX = 520, MODE_WIDTH = 64, LABELS = 95;
enum { MODES_SHOWN = 10 };

typedef struct {
    FILE *out;
    const Building *b;
    double x0, z1, scale; /* [m] left edge and top of the building, [px/m] */
    double ground;        /* [m] where the first storey begins */
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

static double height_of(const Building *b, int floor)
{
    double z = 0;
    for (int j = 0; j < floor; j++)
        z += b->storey_m[j];
    return z;
}

/* ---- the building --------------------------------------------------------------------------------------------- */

static void draw_element(const Drawing *d, const Frame *f, const FrameElement *e)
{
    const FrameNode *a = &f->node[e->node[0]], *b = &f->node[e->node[1]];
    const double x[2] = {px(d, a->x), px(d, b->x)}, y[2] = {py(d, a->z), py(d, b->z)};
    fprintf(d->out, "<line class=\"e\" x1=\"%.2f\" y1=\"%.2f\" x2=\"%.2f\" y2=\"%.2f\"><title>", x[0], y[0], x[1],
            y[1]);
    text_html(d->out, e->name);
    fputs(": ", d->out);
    text_html(d->out, f->section[e->section].name);
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
            fprintf(d->out,
                    "<circle class=\"n\" cx=\"%.2f\" cy=\"%.2f\" r=\"3\"><title>floor %d: %.4g t</title></circle>\n",
                    px(d, n->x), py(d, n->z), n->floor, building_floor_mass(d->b, n->floor - 1) / 1e3);
    }
}

/* Storeys as a frame of one column. */
static Status make_stick(Frame *f, const Building *b, Err *err)
{
    TRY(frame_add_section(f, &(FrameSection){.name = "storey", .area = 1, .inertia = 1, .E = 1}, err));
    for (int j = 0; j <= b->n; j++) {
        FrameNode node = {.z = height_of(b, j), .floor = j, .fixed = {!j, !j, !j}};
        FrameElement e = {.node = {j - 1, j}};
        snprintf(node.name, sizeof node.name, "%d", j);
        snprintf(e.name, sizeof e.name, "%d", j);
        TRY(frame_add_node(f, &node, err));
        if (j > 0)
            TRY(frame_add_element(f, &e, err));
    }
    return STATUS_OK;
}

/* ---- floors and modes ----------------------------------------------------------------------------------------- */

static void draw_floor_labels(const Drawing *d)
{
    const int step = 1 + d->b->n / 25;
    for (int k = 0; k <= d->b->n; k += step)
        fprintf(d->out, "<text x=\"%.2f\" y=\"%.2f\">%d: %.4g m</text>\n", d->right + 12,
                py(d, d->ground + height_of(d->b, k)) + 4, k, height_of(d->b, k));
}

static void draw_mode(const Drawing *d, int mode)
{
    const Building *b = d->b;
    const double middle = d->right + LABELS + MODE_WIDTH * (mode + 0.5), foot = py(d, d->ground);
    double largest = 0;
    for (int j = 0; j < b->n; j++)
        largest = fmax(largest, fabs(b->phi[j * b->n + mode]));
    fprintf(d->out, "<path class=\"a\" d=\"M%.2f %.2f V%.2f\"/>\n<polyline class=\"m\" points=\"%.2f,%.2f", middle,
            foot, py(d, d->ground + height_of(b, b->n)), middle, foot);
    for (int j = 0; j < b->n; j++)
        fprintf(d->out, " %.2f,%.2f", middle + 0.42 * MODE_WIDTH * b->phi[j * b->n + mode] / largest,
                py(d, d->ground + height_of(b, j + 1)));
    fprintf(d->out,
            "\"/>\n<text class=\"c\" x=\"%.2f\" y=\"%.2f\">%.4g s</text><text class=\"c\" x=\"%.2f\" "
            "y=\"%.2f\">%.3g %%</text>\n",
            middle, TOP - 26, 2 * M_PI / b->omega[mode], middle, TOP - 12,
            100 * b->gamma[mode] * b->gamma[mode] / building_mass(b));
}

/* ---- the page ------------------------------------------------------------------------------------------------- */

static void draw(FILE *out, const Building *b, const Frame *f)
{
    double x0 = HUGE_VAL, x1 = -HUGE_VAL, z0 = HUGE_VAL, z1 = -HUGE_VAL, ground = 0;
    for (const FrameNode *n = f->node; n < f->node + f->n[FRAME_NODES]; n++) {
        x0 = fmin(x0, n->x);
        x1 = fmax(x1, n->x);
        z0 = fmin(z0, n->z);
        z1 = fmax(z1, n->z);
        if (n->floor == b->n)
            ground = n->z - height_of(b, b->n);
    }
    const double scale = fmin(HEIGHT / (z1 - z0), WIDTH_MAX / fmax(x1 - x0, 1e-9)), across = (x1 - x0) * scale;
    const Drawing d = {
        .out = out, .b = b, .x0 = x0, .z1 = z1, .scale = scale, .ground = ground, .right = LEFT + across};
    const int modes = MIN_OF(b->n, MODES_SHOWN);
    const double width = d.right + LABELS + MODE_WIDTH * modes + 20, height = TOP + (z1 - z0) * scale + 40;
    fprintf(out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %.0f %.0f\" width=\"%.0f\" height=\"%.0f\">\n"
            "<style>.e{stroke:#345;stroke-width:1.5}.n{fill:#c40}.p{fill:#fff;stroke:#345}.s{fill:#fff;stroke:#345}"
            ".f{fill:#345}.a{stroke:#bbb}.m{fill:none;stroke:#06c;stroke-width:1.5}text{font:12px sans-serif;fill:#222}"
            ".c{text-anchor:middle}</style>\n<rect width=\"100%%\" height=\"100%%\" fill=\"#fff\"/>\n",
            width, height, width, height);
    draw_frame(&d, f);
    draw_floor_labels(&d);
    for (int mode = 0; mode < modes; mode++)
        draw_mode(&d, mode);
    fprintf(out, "</svg>\n");
}

Status building_svg(FILE *out, const Building *b, const Frame *f, Err *err)
{
    Frame stick = {0};
    const Status status = f ? STATUS_OK : make_stick(&stick, b, err);
    if (status == STATUS_OK)
        draw(out, b, f ? f : &stick);
    frame_free(&stick);
    return status;
}
