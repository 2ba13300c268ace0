#include "report/panels.h"

#include "base/json.h"
#include "report/words.h"

const CaseLook CASE_LOOK[N_SCENES] = {[SCENE_IMPACT] = {"#0072b2", "\u25cf", "circle"},
                                      [SCENE_NO_CORE] = {"#d55e00", "\u25c6", "diamond2"},
                                      [SCENE_RIGID] = {"#8a6d00", "\u25b2", "triangle"},
                                      [SCENE_TMD] = {"#009e73", "\u25a0", "square"},
                                      [SCENE_LINKS] = {"#cc79a7", "\u2605", "star"}};
static const char INK[] = "#1b2430", SOFT[] = "#5b6675", PALE[] = "#c3cad2";

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

/* ---- the front ------------------------------------------------------------------------------------------------- */

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

static Words head_of(const Schema *schema, size_t k, char head[256])
{
    const Words w = words_of_objective(schema, k);
    snprintf(head, 256, w.unit[0] ? "%s [%s]" : "%s", w.title, w.unit);
    return w;
}

/* Objective k of the designs that are shown, in the unit of the eye. */
static json_t *column(const Report *r, size_t k)
{
    json_t *list = json_array();
    for (size_t i = 0; i < r->n_shown; i++)
        json_array_append_new(
            list, json_number(run_f(r->run, r->shown[i])[k] * words_of_objective(&r->run->schema, k).factor));
    return list;
}

/* One large symbol at two objectives f[k]. */
static json_t *spot(const Schema *schema, const size_t pair[2], double x, double y, const char *colour,
                    const char *symbol)
{
    return json_of("mark=%s x=%p y=%p fill=%s symbol=%s r=%d stroke=%s", "dot",
                   json_numbers(1, (double[]){x * words_of_objective(schema, pair[0]).factor}),
                   json_numbers(1, (double[]){y * words_of_objective(schema, pair[1]).factor}), colour, symbol, 6,
                   "white");
}

static json_t *front_panel(const Report *r, const size_t pair[2], int has_legend)
{
    const Schema *schema = &r->run->schema;
    const double *knee = run_f(r->run, r->knee);
    const size_t last = schema->n_obj - 1;
    char x[256], y[256], colour[256];
    head_of(schema, pair[0], x);
    head_of(schema, pair[1], y);
    head_of(schema, last, colour);
    json_t *dots =
        json_of("mark=%s x=%p y=%p fill=%p r=%d", "dot", column(r, pair[0]), column(r, pair[1]), column(r, last), 2);
    json_t *marks = json_pack("[oo]", dots, spot(schema, pair, knee[pair[0]], knee[pair[1]], INK, "circle"));
    for (int b = 0; r->has_detail && b < N_BASELINES; b++) {
        const Baseline *baseline = &r->detail.baseline[b];
        const CaseLook *look = &CASE_LOOK[SCENE_NO_CORE + b];
        if (baseline->outcome == OUTCOME_OK)
            json_array_append_new(marks, spot(schema, pair, baseline->value[schema->order.of[pair[0]]],
                                              baseline->value[schema->order.of[pair[1]]], look->colour, look->symbol));
    }
    json_t *one = panel("", json_of("label=%s zero=%c nice=%c ticks=%d", x, r->has_detail, 1, 5),
                        json_of("label=%s zero=%c nice=%c", y, r->has_detail, 1), marks);
    return json_put(
        one, "color=%p",
        json_of("scheme=%s type=%s label=%s legend=%c width=%d", "viridis", "linear", colour, has_legend, 240));
}

json_t *draw_front(const Report *r)
{
    size_t pairs[3][2] = {{0}};
    char all[40];
    const size_t n = choose_panels(&r->run->schema, pairs);
    json_t *columns = json_array(), *names = json_array();
    snprintf(all, sizeof all, "%zu designs", r->n_shown);
    json_array_append_new(names, name_of(all, "#21918c", "\u2022"));
    json_array_append_new(names, name_of("the knee", INK, "\u25cf"));
    for (int b = 0; r->has_detail && b < N_BASELINES; b++) {
        const CaseLook *look = &CASE_LOOK[SCENE_NO_CORE + b];
        json_array_append_new(names, name_of(baseline_words(b), look->colour, look->mark));
    }
    for (size_t i = 0; i < n; i++)
        json_array_append_new(columns, json_pack("[o]", front_panel(r, pairs[i], i + 1 == n)));
    return drawing("", names, 330, columns);
}

/* ---- the building ---------------------------------------------------------------------------------------------- */

/* Sizes in px. */
static const double HEIGHT = 640, WIDTH_MAX = 520, MODE_WIDTH = 64, LABELS = 95, HEAD = 30, FOOT = 14;
enum { MODES_SHOWN = 10 };

/* Places in px, to the right and upwards. */
typedef struct {
    const Building *b;
    double x0, z0, scale; /* [m] left and lower edge, [px/m] */
    double ground;        /* [m] where the first storey begins */
    double right;         /* [px] where the building ends */
    json_t *marks;
} Sheet;

/* Points of a mark, one by one, each with its words. */
typedef struct {
    json_t *x, *y, *words;
} Points;

static Points points(void)
{
    return (Points){json_array(), json_array(), json_array()};
}

static void add_point(Points *p, double x, double y, const char *words)
{
    json_array_append_new(p->x, json_number(x));
    json_array_append_new(p->y, json_number(y));
    json_array_append_new(p->words, json_words(words));
}

static double px(const Sheet *s, double x)
{
    return (x - s->x0) * s->scale;
}

static double py(const Sheet *s, double z)
{
    return FOOT + (z - s->z0) * s->scale;
}

static double height_of(const Building *b, int floor)
{
    double z = 0;
    for (int j = 0; j < floor; j++)
        z += b->storey_m[j];
    return z;
}

/* Elements as lines that name them; a pin at an end is a ring, 6 px along the element. */
static void add_elements(Sheet *s, const Frame *f)
{
    Points lines = points(), pins = points();
    json_t *z = json_array();
    char words[200];
    for (int i = 0; i < f->n[FRAME_ELEMENTS]; i++) {
        const FrameElement *e = &f->element[i];
        double x[2], y[2];
        snprintf(words, sizeof words, "%s: %s", e->name, f->section[e->section].name);
        for (int end = 0; end < 2; end++) {
            x[end] = px(s, f->node[e->node[end]].x);
            y[end] = py(s, f->node[e->node[end]].z);
            add_point(&lines, x[end], y[end], words);
            json_array_append_new(z, json_integer(i));
        }
        const double share = 6 / fmax(hypot(x[1] - x[0], y[1] - y[0]), 12);
        for (int end = 0; end < 2; end++)
            if (e->pinned[end])
                add_point(&pins, x[end] + share * (x[!end] - x[end]), y[end] + share * (y[!end] - y[end]), words);
    }
    json_array_append_new(s->marks, json_of("mark=%s x=%p y=%p z=%p title=%p stroke=%s strokeWidth=%g", "line", lines.x,
                                            lines.y, z, lines.words, SOFT, 1.5));
    json_array_append_new(s->marks, json_of("mark=%s x=%p y=%p title=%p r=%g fill=%s stroke=%s", "dot", pins.x, pins.y,
                                            pins.words, 2.5, "white", SOFT));
}

/* Floors as dots. A triangle where the ground holds z, turned where it holds x alone; filled where it holds the rotation
 * too. */
static void add_nodes(Sheet *s, const Frame *f)
{
    Points floors = points(), held[3] = {points(), points(), points()};
    char words[80];
    for (const FrameNode *n = f->node; n < f->node + f->n[FRAME_NODES]; n++) {
        const int kind = n->fixed[FRAME_Z] ? n->fixed[FRAME_ROT] != 0 : n->fixed[FRAME_X] ? 2 : -1;
        if (kind >= 0)
            add_point(&held[kind], px(s, n->x), py(s, n->z), n->name);
        snprintf(words, sizeof words, "floor %d: %.4g t", n->floor,
                 n->floor ? building_floor_mass(s->b, n->floor - 1) / 1e3 : 0.0);
        if (n->floor)
            add_point(&floors, px(s, n->x), py(s, n->z), words);
    }
    for (int kind = 0; kind < 3; kind++)
        json_array_append_new(
            s->marks, json_of("mark=%s x=%p y=%p title=%p r=%d symbol=%s rotate=%d dy=%d dx=%d fill=%s stroke=%s",
                              "dot", held[kind].x, held[kind].y, held[kind].words, 5, "triangle", kind == 2 ? 90 : 0,
                              kind == 2 ? 0 : 5, kind == 2 ? -5 : 0, kind == 1 ? SOFT : "white", SOFT));
    json_array_append_new(s->marks, json_of("mark=%s x=%p y=%p title=%p r=%d fill=%s", "dot", floors.x, floors.y,
                                            floors.words, 3, CASE_LOOK[SCENE_NO_CORE].colour));
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

/* Words at points, which the x of a text is the beginning (anchor start) or the middle of. */
static void add_words(json_t *marks, Points p, const char *anchor)
{
    json_array_append_new(
        marks, json_of("mark=%s x=%p y=%p text=%p textAnchor=%s fill=%s", "text", p.x, p.y, p.words, anchor, INK));
}

/* Heights of the floors, and the mode shapes over them with period and share of the mass. */
static void add_modes(Sheet *s, int modes)
{
    const Building *b = s->b;
    const double foot = py(s, s->ground), top = py(s, s->ground + height_of(b, b->n));
    Points heights = points(), heads = points();
    char words[80];
    for (int k = 0; k <= b->n; k += 1 + b->n / 25) {
        snprintf(words, sizeof words, "%d: %.4g m", k, height_of(b, k));
        add_point(&heights, s->right + 12, py(s, s->ground + height_of(b, k)), words);
    }
    for (int mode = 0; mode < modes; mode++) {
        const double middle = s->right + LABELS + MODE_WIDTH * (mode + 0.5);
        double largest = 0, x[FLOORS_MAX + 1] = {middle}, y[FLOORS_MAX + 1] = {foot};
        for (int j = 0; j < b->n; j++)
            largest = fmax(largest, fabs(b->phi[j * b->n + mode]));
        for (int j = 0; j < b->n; j++) {
            x[j + 1] = middle + 0.42 * MODE_WIDTH * b->phi[j * b->n + mode] / largest;
            y[j + 1] = py(s, s->ground + height_of(b, j + 1));
        }
        json_array_append_new(s->marks, curve(2, (double[]){middle, middle}, (double[]){foot, top}, PALE, 1));
        json_array_append_new(s->marks, curve((size_t)b->n + 1, x, y, CASE_LOOK[SCENE_IMPACT].colour, 1.5));
        snprintf(words, sizeof words, "%.4g s", 2 * M_PI / b->omega[mode]);
        add_point(&heads, middle, top + HEAD - 8, words);
        snprintf(words, sizeof words, "%.3g %%", 100 * b->gamma[mode] * b->gamma[mode] / building_mass(b));
        add_point(&heads, middle, top + HEAD - 22, words);
    }
    add_words(s->marks, heights, "start");
    add_words(s->marks, heads, "middle");
}

/* Axes that are not shown, of which a px is a px. */
static json_t *px_axis(double from, double to)
{
    return json_of("axis=%p grid=%c domain=%p", json_null(), 0, json_numbers(2, (double[]){from, to}));
}

static json_t *sheet(double left, double width, double height, json_t *marks)
{
    json_t *one = panel("", px_axis(left, width), px_axis(0, height), marks);
    return drawing("", json_array(), 0,
                   json_pack("[[o]]", json_put(one, "aspectRatio=%d marginLeft=%d marginBottom=%d", 1, 0, 0)));
}

static json_t *draw_frame(const Building *b, const Frame *f, int *width)
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
    const double scale = fmin(HEIGHT / (z1 - z0), WIDTH_MAX / fmax(x1 - x0, 1e-9));
    const int modes = MIN_OF(b->n, MODES_SHOWN);
    Sheet s = {b, x0, z0, scale, ground, (x1 - x0) * scale, json_array()};
    add_elements(&s, f);
    add_nodes(&s, f);
    add_modes(&s, modes);
    const double end = s.right + LABELS + MODE_WIDTH * modes;
    *width = 60 + (int)end;
    return sheet(-12, end, FOOT + (z1 - z0) * scale + HEAD, s.marks);
}

Status draw_building(const Building *b, const Frame *f, json_t **out, int *width, Err *err)
{
    Frame stick = {0};
    const Status status = f ? STATUS_OK : make_stick(&stick, b, err);
    if (status == STATUS_OK)
        *out = draw_frame(b, f ? f : &stick, width);
    frame_free(&stick);
    return status;
}

/* ---- one design ------------------------------------------------------------------------------------------------ */

static double largest_of(int n, const double v[])
{
    double most = 0;
    for (int j = 0; j < n; j++)
        most = isfinite(v[j]) ? fmax(most, v[j]) : most;
    return most;
}

static json_t *segment(double x0, double y0, double x1, double y1, const char *colour, double width)
{
    return curve(2, (double[]){x0, x1}, (double[]){y0, y1}, colour, width);
}

/* Between floor j and one side of the core, whose face is at x: the floor, its stop, its link. */
static void add_side(json_t *marks, const Detail *d, const Design *design, int j, double gap_px, double x, int side,
                     double y)
{
    const double end = x + 150 * side, face = isfinite(gap_px) ? x + side * gap_px : end;
    const int has_bumper = d->bumper_n_m[j] > 0;
    json_array_append_new(marks, segment(face, y, end, y, SOFT, 2.5));
    if (isfinite(gap_px))
        json_array_append_new(marks,
                              segment(face, y - 5, face, y + 5, CASE_LOOK[SCENE_NO_CORE].colour, has_bumper ? 6 : 3));
    if (design_has_link(design, j)) {
        json_array_append_new(marks, segment(x, y - 5, end, y - 5, CASE_LOOK[SCENE_TMD].colour, 1));
        json_array_append_new(marks,
                              segment(x + 45 * side, y - 5, x + 105 * side, y - 5, CASE_LOOK[SCENE_TMD].colour, 6));
    }
}

/* Number of the floor, its gap, the core's wall below it, and what else stands there. */
static void add_labels(Points *p, const Detail *d, const Design *design, int j, double y)
{
    char words[64];
    snprintf(words, sizeof words, "%d", j + 1);
    add_point(p, 8, y, words);
    snprintf(words, sizeof words, "%.1f mm", 1e3 * d->gap_m[j]);
    if (d->gap_sides == GAPS_EACH)
        snprintf(words, sizeof words, "%.1f | %.1f mm", 1e3 * d->gap_side_m[1][j], 1e3 * d->gap_side_m[0][j]);
    add_point(p, 460, y, isinf(d->gap_m[j]) ? "no stop" : words);
    snprintf(words, sizeof words, "%.1f mm", 1e3 * d->thickness_m[j]);
    add_point(p, 560, y, words);
    snprintf(words, sizeof words, "%.3g MN/m", 1e-6 * d->bumper_n_m[j]);
    if (design_has_link(design, j))
        add_point(p, 630, y, design->link[j] > 0 ? "link" : "friction");
    else if (d->bumper_n_m[j] > 0)
        add_point(p, 630, y, words);
}

json_t *draw_section(const Detail *d, const Design *design)
{
    enum { TALL = 430, ACROSS = 80, MIDDLE = 240, HALF = 34 };
    double height = 0, foot = FOOT;
    const double wide = fmax(largest_of(d->n_floors, d->gap_side_m[0]), largest_of(d->n_floors, d->gap_side_m[1]));
    const double thick = largest_of(d->n_floors, d->thickness_m);
    json_t *marks = json_array();
    Points labels = points();
    char words[100];
    for (int j = 0; j < d->n_floors; j++)
        height += d->storey_m[j];
    for (int j = 0; j < d->n_floors; j++) {
        const double y = foot + TALL * d->storey_m[j] / height,
                     wall = thick > 0 ? 2 + 8 * d->thickness_m[j] / thick : 4;
        for (int side = -1; side <= 1; side += 2) {
            const double x = MIDDLE + side * HALF, gap = d->gap_side_m[side < 0][j];
            json_array_append_new(marks, segment(x - side * wall / 2, foot, x - side * wall / 2, y, "#9aa4af", wall));
            add_side(marks, d, design, j, isfinite(gap) && wide > 0 ? ACROSS * gap / wide : INFINITY, x, side, y);
        }
        add_labels(&labels, d, design, j, y);
        foot = y;
    }
    add_point(&labels, 8, foot + 22, "floor");
    add_point(&labels, 460, foot + 22, "gap");
    add_point(&labels, 560, foot + 22, "core wall");
    snprintf(words, sizeof words, "tuned mass %.0f t, %.3g Hz, damping %.2g", 1e-3 * design->mass_kg, design->mass_hz,
             design->mass_damping);
    if (design->mass_kg > 0)
        add_point(&labels, MIDDLE - 120, foot + 22, words);
    for (int side = -1; side <= 1; side += 2)
        json_array_append_new(marks, segment(MIDDLE + 184 * side, FOOT, MIDDLE + 184 * side, foot, SOFT, 3));
    json_array_append_new(marks, segment(40, FOOT, 440, FOOT, SOFT, 3));
    add_words(marks, labels, "start");
    return sheet(0, 690, foot + HEAD, marks);
}

json_t *draw_history(const Detail *d)
{
    static const char *const NAMES[] = {"with core", "no core"};
    json_t *marks = json_array(), *names = json_array();
    char label[40];
    for (int i = 1; i >= 0; i--) {
        const CaseLook *look = &CASE_LOOK[i ? SCENE_NO_CORE : SCENE_IMPACT];
        const History *h = &d->history[i];
        json_array_append_new(marks, curve(h->n, h->t, h->u, look->colour, 1));
        json_array_append_new(names, name_of(NAMES[i], look->colour, look->mark));
    }
    snprintf(label, sizeof label, "floor %d [m]", d->floor + 1);
    return drawing(
        "", names, 220,
        json_pack("[[o]]", panel("", json_of("label=%s", "time [s]"), json_of("label=%s ticks=%d", label, 5), marks)));
}
