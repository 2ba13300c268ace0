#include "report/panels.h"

#include "base/json.h"

static const char BLUE[] = "#0072b2", VERMILLION[] = "#d55e00"; /* of the page (web/app/1-run.js) */
static const double ROOM =
    1.9; /* height of a drawing over the width of its frame, where it is as narrow as in a dossier */

static json_t *panel(const char *title, json_t *x, json_t *y, json_t *marks)
{
    return json_of("title=%s x=%p y=%p marks=%p", title, x, y, marks);
}

/* ---- the building ---------------------------------------------------------------------------------------------- */

static double height_of(const Building *b, int floor)
{
    double z = 0;
    for (int j = 0; j < floor; j++)
        z += b->storey_m[j];
    return z;
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

/* One more of what a mark has a list of. */
static void append(json_t *mark, const char *key, json_t *value)
{
    if (!json_object_get(mark, key))
        json_object_set_new(mark, key, json_array());
    json_array_append_new(json_object_get(mark, key), value);
}

/* of: the line or the facet of a point of a line. */
static void add_point(json_t *line, double x, double y, const char *key, const char *of)
{
    append(line, "x", json_number(x));
    append(line, "y", json_number(y));
    append(line, key, json_words(of));
}

static void add_dot(json_t *dots, double x, double y, const char *title, const char *symbol, const char *fill)
{
    add_point(dots, x, y, "title", title);
    append(dots, "symbol", json_string(symbol));
    append(dots, "fill", json_string(fill));
}

static json_t *height_axis(const double range[2])
{
    return json_of("label=%s grid=%c domain=%p", "height [m]", 0, json_numbers(2, range));
}

/* Mode shapes over the height z from `ground` on, each above its number, which sets it apart, its period and its
 * share of the mass. */
static json_t *modes_panel(const Building *b, int modes, double ground, const double range[2])
{
    json_t *heads = json_array(), *lines = json_of("mark=%s stroke=%s", "line", BLUE);
    char head[80];
    for (int mode = 0; mode < b->n && mode < modes; mode++) {
        double largest = 0;
        for (int j = 0; j < b->n; j++)
            largest = fmax(largest, fabs(b->phi[j * b->n + mode]));
        snprintf(head, sizeof head, "%d\n%.2g\n%.2g", mode + 1, 2 * M_PI / b->omega[mode],
                 100 * b->gamma[mode] * b->gamma[mode] / building_mass(b));
        json_array_append_new(heads, json_words(head));
        for (int j = 0; j <= b->n; j++)
            add_point(lines, j ? b->phi[(j - 1) * b->n + mode] / largest : 0, ground + height_of(b, j), "fx", head);
    }
    json_t *one = panel("Mode shapes, period [s], share of the mass [%]", json_of("axis=%p grid=%c", json_null(), 0),
                        height_axis(range), json_pack("[o]", lines));
    return json_put(one, "fx=%p", json_of("label=%p domain=%p", json_null(), heads));
}

Status building_drawing(const Building *b, const Frame *given, int modes, json_t **out, Err *err)
{
    Frame stick = {0};
    const Frame *f = given ? given : &stick;
    Status status = given ? STATUS_OK : make_stick(&stick, b, err);
    double x[2] = {HUGE_VAL, -HUGE_VAL}, z[2] = {HUGE_VAL, -HUGE_VAL}, ground = 0;
    json_t *lines = json_of("mark=%s stroke=%s", "line", "black"), *dots = json_of("mark=%s stroke=%s", "dot", "black");
    char title[200];

    /* 1. Elements as lines; a pin stands a twentieth of the element away from its end. */
    for (const FrameElement *e = f->element; e < f->element + f->n[FRAME_ELEMENTS]; e++) {
        snprintf(title, sizeof title, "%s: %s", e->name, f->section[e->section].name);
        for (int end = 0; end < 2; end++) {
            const FrameNode *here = &f->node[e->node[end]], *there = &f->node[e->node[!end]];
            add_point(lines, here->x, here->z, "z", e->name);
            append(lines, "title", json_words(title));
            if (e->pinned[end])
                add_dot(dots, here->x + (there->x - here->x) / 20, here->z + (there->z - here->z) / 20, title, "circle",
                        "white");
        }
    }

    /* 2. Floors as dots; a triangle where the ground holds z, a square where it holds x alone, filled where it holds
     * the rotation too. */
    for (const FrameNode *n = f->node; n < f->node + f->n[FRAME_NODES]; n++) {
        if (n->fixed[FRAME_X] || n->fixed[FRAME_Z])
            add_dot(dots, n->x, n->z, n->name, n->fixed[FRAME_Z] ? "triangle" : "square",
                    n->fixed[FRAME_ROT] ? "black" : "white");
        if (n->floor) {
            snprintf(title, sizeof title, "floor %d: %.4g t", n->floor, building_floor_mass(b, n->floor - 1) / 1e3);
            add_dot(dots, n->x, n->z, title, "circle", VERMILLION);
        }
        x[0] = fmin(x[0], n->x), x[1] = fmax(x[1], n->x);
        z[0] = fmin(z[0], n->z), z[1] = fmax(z[1], n->z);
        ground = n->floor == b->n ? n->z - height_of(b, b->n) : ground;
    }
    z[1] = fmax(z[1], z[0] + ROOM * (x[1] - x[0]));
    json_t *frame = panel("To scale", json_of("axis=%p grid=%c around=%g", json_null(), 0, (x[0] + x[1]) / 2),
                          height_axis(z), json_pack("[oo]", lines, dots));
    *out = json_of("title=%s names=%p height=%d columns=%p", "", json_array(), 500,
                   json_pack("[[o][o]]", frame, modes_panel(b, modes, ground, z)));
    frame_free(&stick);
    if (status != STATUS_OK)
        json_decref(*out);
    return status;
}
