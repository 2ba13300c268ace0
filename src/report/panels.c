#include "report/panels.h"

#include "base/json.h"

const CaseLook CASE_LOOK[N_SCENES] = {[SCENE_IMPACT] = {"#0072b2", "\u25cf", "circle"},
                                      [SCENE_NO_CORE] = {"#d55e00", "\u25c6", "diamond2"},
                                      [SCENE_RIGID] = {"#8a6d00", "\u25b2", "triangle"},
                                      [SCENE_TMD] = {"#009e73", "\u25a0", "square"},
                                      [SCENE_LINKS] = {"#cc79a7", "\u2605", "star"}};
enum { MODES_SHOWN = 10 };

json_t *drawing(const char *title, json_t *names, int height, json_t *columns)
{
    return json_of("title=%s names=%p height=%d columns=%p", title, names, height, columns);
}

json_t *panel(const char *title, json_t *x, json_t *y, json_t *marks)
{
    return json_of("title=%s x=%p y=%p marks=%p", title, x, y, marks);
}

json_t *curve(size_t n, const double x[], const double y[], const char *colour, double width)
{
    return json_of("mark=%s x=%p y=%p stroke=%s strokeWidth=%g", "line", json_numbers(n, x), json_numbers(n, y), colour,
                   width);
}

json_t *dashed(json_t *curve)
{
    return json_put(curve, "strokeDasharray=%s", "6 4");
}

json_t *name_of(const char *words, const char *colour, const char *mark)
{
    return json_pack("[oss]", json_words(words), colour, mark);
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

/* Nodes with what the ground holds of them, elements with the nodes and pins of their ends. */
static json_t *frame_json(const Building *b, const Frame *f)
{
    json_t *nodes = json_array(), *elements = json_array();
    char words[200];
    for (const FrameNode *n = f->node; n < f->node + f->n[FRAME_NODES]; n++) {
        snprintf(words, sizeof words, "floor %d: %.4g t", n->floor,
                 n->floor ? building_floor_mass(b, n->floor - 1) / 1e3 : 0);
        json_array_append_new(nodes, json_of("x=%g y=%g title=%s floor=%d held=%s", n->x, n->z,
                                             n->floor ? words : n->name, n->floor,
                                             !n->fixed[FRAME_Z]    ? n->fixed[FRAME_X] ? "x" : NULL
                                             : n->fixed[FRAME_ROT] ? "all"
                                                                   : "z"));
    }
    for (const FrameElement *e = f->element; e < f->element + f->n[FRAME_ELEMENTS]; e++) {
        snprintf(words, sizeof words, "%s: %s", e->name, f->section[e->section].name);
        json_array_append_new(elements,
                              json_of("title=%s ends=%p pins=%p", words, json_pack("[ii]", e->node[0], e->node[1]),
                                      json_pack("[ii]", e->pinned[0], e->pinned[1])));
    }
    return json_of("nodes=%p elements=%p", nodes, elements);
}

Status building_drawing(const Building *b, const Frame *f, json_t **out, Err *err)
{
    Frame stick = {0};
    const Status status = f ? STATUS_OK : make_stick(&stick, b, err);
    double z[FLOORS_MAX + 1];
    json_t *modes = json_array();
    for (int j = 0; j <= b->n; j++)
        z[j] = height_of(b, j);
    for (int mode = 0; mode < b->n && mode < MODES_SHOWN; mode++) {
        double shape[FLOORS_MAX];
        for (int j = 0; j < b->n; j++)
            shape[j] = b->phi[j * b->n + mode];
        json_array_append_new(modes, json_of("shape=%p period_s=%g mass_pct=%g", json_numbers(b->n, shape),
                                             2 * M_PI / b->omega[mode],
                                             100 * b->gamma[mode] * b->gamma[mode] / building_mass(b)));
    }
    *out = json_put(frame_json(b, f ? f : &stick), "heights=%p modes=%p", json_numbers((size_t)b->n + 1, z), modes);
    frame_free(&stick);
    return status;
}
