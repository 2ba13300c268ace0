#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/stat.h"
#include "scene/compiled_in.h"
#include "scene/building_read.h"
#include "scene/opensees.h"

/* ---- sheets --------------------------------------------------------------------------------------------------- */

static void path_of(char path[600], const char *folder, const char *name)
{
    snprintf(path, 600, "%s/%s", folder, name);
}

static int is_there(const char *folder, const char *name)
{
    char path[600];
    path_of(path, folder, name);
    return is_compiled_in(folder) ? compiled_in(folder, name).text != NULL : access(path, F_OK) == 0;
}

static int is_tcl(const char *model)
{
    const size_t n = strlen(model);
    return n > 4 && strcmp(model + n - 4, ".tcl") == 0;
}

int frame_is(const char *model)
{
    return is_tcl(model) || is_there(model, "nodes.csv");
}

static Status open_sheet(Sheet *s, const char *folder, const char *name, const char *required, const char *optional,
                         Err *err)
{
    char path[600];
    const CompiledIn own = compiled_in(folder, name);
    path_of(path, folder, name);
    TRY(own.text ? sheet_parse(s, path, own.text, own.length, err) : sheet_read(s, path, err));
    const Status status = sheet_expect(s, required, optional, err);
    if (status != STATUS_OK)
        table_free(s);
    return status;
}

static Status read_switch(const Sheet *s, size_t row, const char *column, int *on, Err *err)
{
    double value;
    TRY(sheet_number(s, row, column, 0, &value, err));
    if (value != 0 && value != 1)
        return fail(err, STATUS_BAD_DATA, "%s:%d: %s is %g; it is 0 or 1", s->path, s->line[row], column, value);
    *on = (int)value;
    return STATUS_OK;
}

static Status read_positive(const Sheet *s, size_t row, const char *column, double *value, Err *err)
{
    TRY(sheet_number(s, row, column, NAN, value, err));
    return *value > 0 ? STATUS_OK
                      : fail(err, STATUS_BAD_DATA, "%s:%d: %s is %g; it must be above 0", s->path, s->line[row], column,
                             *value);
}

/* 0 where the column is missing. */
static Status read_share(const Sheet *s, size_t row, const char *column, double *value, Err *err)
{
    TRY(sheet_number(s, row, column, 0, value, err));
    return *value >= 0 ? STATUS_OK
                       : fail(err, STATUS_BAD_DATA, "%s:%d: %s is %g; it must not be negative", s->path, s->line[row],
                              column, *value);
}

static Status read_name(const Sheet *s, size_t row, const char *column, char name[TABLE_NAME_MAX], Err *err)
{
    const char *text = sheet_text(s, row, column);
    if (!*text || strlen(text) >= TABLE_NAME_MAX)
        return fail(err, STATUS_BAD_DATA, "%s:%d: %s '%.60s' is no name of 1 to %d characters", s->path, s->line[row],
                    column, text, TABLE_NAME_MAX - 1);
    snprintf(name, TABLE_NAME_MAX, "%s", text);
    return STATUS_OK;
}

/* ---- names of nodes and sections ------------------------------------------------------------------------------ */

typedef struct {
    const char *name;
    int index;
} Entry;

static int by_name(const void *a, const void *b)
{
    return strcmp(((const Entry *)a)->name, ((const Entry *)b)->name);
}

/* Nodes by name, for the sheets that refer to them, and what is tied to what. */
typedef struct {
    int n;
    Entry *entry; /* (n) sorted */
    int *root;    /* (n * FRAME_DOFS) another displacement that is equal, or itself */
} Index;

/* The rows of a sheet by name: its first column, of which none may be there twice. */
static Status sort_names(Entry entry[], const Sheet *s, const char *column, Err *err)
{
    for (size_t i = 0; i < s->n_rows; i++)
        entry[i] = (Entry){sheet_text(s, i, column), (int)i};
    qsort(entry, s->n_rows, sizeof *entry, by_name);
    for (size_t i = 1; i < s->n_rows; i++)
        if (strcmp(entry[i].name, entry[i - 1].name) == 0)
            return fail(err, STATUS_BAD_DATA, "%s:%d: %s %s is there twice", s->path,
                        s->line[entry[entry[i].index > entry[i - 1].index ? i : i - 1].index], column, entry[i].name);
    return STATUS_OK;
}

static Status check_names(const Sheet *s, const char *column, Err *err)
{
    Entry *entry = malloc(s->n_rows * sizeof *entry);
    if (!entry)
        return fail(err, STATUS_NO_MEMORY, "%s: no memory for %zu rows", s->path, s->n_rows);
    const Status status = sort_names(entry, s, column, err);
    free(entry);
    return status;
}

static Status index_nodes(Index *x, const Frame *f, Err *err)
{
    x->n = f->n_nodes;
    x->entry = malloc((size_t)x->n * sizeof *x->entry);
    x->root = malloc((size_t)x->n * FRAME_DOFS * sizeof *x->root);
    if (!x->entry || !x->root)
        return fail(err, STATUS_NO_MEMORY, "frame: no memory for %d nodes", x->n);
    for (int i = 0; i < x->n; i++)
        x->entry[i] = (Entry){f->node[i].name, i};
    for (int i = 0; i < x->n * FRAME_DOFS; i++)
        x->root[i] = i;
    qsort(x->entry, (size_t)x->n, sizeof *x->entry, by_name);
    return STATUS_OK;
}

static Status look_up(const Index *x, const Sheet *s, size_t row, const char *column, int *node, Err *err)
{
    const Entry wanted = {sheet_text(s, row, column), 0};
    const Entry *found = bsearch(&wanted, x->entry, (size_t)x->n, sizeof *x->entry, by_name);
    if (!found)
        return fail(err, STATUS_BAD_DATA, "%s:%d: %s '%.40s' is not in nodes.csv", s->path, s->line[row], column,
                    wanted.name);
    *node = found->index;
    return STATUS_OK;
}

/* ---- the parts ------------------------------------------------------------------------------------------------ */

static Status take_node(Frame *f, const Index *x, const Sheet *s, size_t row, Err *err)
{
    static const char *const FIX[] = {"fix_x", "fix_z", "fix_rot"}, *const KEEP[] = {"keep_x", "keep_z", "keep_rot"};
    (void)x;
    FrameNode *node = &f->node[row];
    double floor;
    TRY(read_name(s, row, "node", node->name, err));
    TRY(sheet_number(s, row, "x_m", NAN, &node->x, err));
    TRY(sheet_number(s, row, "z_m", NAN, &node->z, err));
    for (int d = 0; d < FRAME_DOFS; d++) {
        TRY(read_switch(s, row, FIX[d], &node->fixed[d], err));
        TRY(read_switch(s, row, KEEP[d], &node->keep[d], err));
    }
    TRY(read_share(s, row, "floor", &floor, err));
    node->floor = (int)fmin(floor, 1e6);
    return node->floor == floor
               ? STATUS_OK
               : fail(err, STATUS_BAD_DATA, "%s:%d: floor %g is no number of a floor", s->path, s->line[row], floor);
}

static Status take_section(Frame *f, const Index *x, const Sheet *s, size_t row, Err *err)
{
    (void)x;
    FrameSection *section = &f->section[row];
    double area, poisson;
    TRY(read_name(s, row, "section", section->name, err));
    TRY(read_positive(s, row, "A_m2", &section->area, err));
    TRY(read_positive(s, row, "I_m4", &section->inertia, err));
    TRY(read_positive(s, row, "E_pa", &section->E, err));
    TRY(read_share(s, row, "shear_area_m2", &area, err));
    TRY(sheet_number(s, row, "poisson", 0.3, &poisson, err));
    TRY(read_share(s, row, "mass_kg_per_m", &section->mass_per_m, err));
    if (!(poisson > -1 && poisson <= 0.5))
        return fail(err, STATUS_BAD_DATA, "%s:%d: poisson is %g; it must be above -1 and at most 0.5", s->path,
                    s->line[row], poisson);
    section->kGA = section->E / (2 * (1 + poisson)) * area;
    return STATUS_OK;
}

static Status find_section(const Frame *f, const Sheet *s, size_t row, int *section, Err *err)
{
    const char *name = sheet_text(s, row, "section");
    for (*section = 0; *section < f->n_sections; ++*section)
        if (strcmp(f->section[*section].name, name) == 0)
            return STATUS_OK;
    return fail(err, STATUS_BAD_DATA, "%s:%d: section '%.40s' is not in sections.csv", s->path, s->line[row], name);
}

static Status take_element(Frame *f, const Index *x, const Sheet *s, size_t row, Err *err)
{
    FrameElement *e = &f->element[row];
    TRY(read_name(s, row, "element", e->name, err));
    TRY(look_up(x, s, row, "node_i", &e->node[0], err));
    TRY(look_up(x, s, row, "node_j", &e->node[1], err));
    TRY(find_section(f, s, row, &e->section, err));
    TRY(read_switch(s, row, "pin_i", &e->pinned[0], err));
    TRY(read_switch(s, row, "pin_j", &e->pinned[1], err));
    TRY(read_share(s, row, "added_mass_kg", &e->added_mass, err));
    const FrameNode *a = &f->node[e->node[0]], *b = &f->node[e->node[1]];
    if (!(hypot(b->x - a->x, b->z - a->z) > 0))
        return fail(err, STATUS_BAD_DATA, "%s:%d: element %s has no length: nodes %s and %s are at one place", s->path,
                    s->line[row], e->name, a->name, b->name);
    return STATUS_OK;
}

static Status take_mass(Frame *f, const Index *x, const Sheet *s, size_t row, Err *err)
{
    double along_x, along_z, rotary;
    int node;
    TRY(look_up(x, s, row, "node", &node, err));
    TRY(sheet_number(s, row, "mass_kg", NAN, &along_x, err));
    TRY(sheet_number(s, row, "mass_z_kg", along_x, &along_z, err));
    TRY(read_share(s, row, "rotary_kg_m2", &rotary, err));
    if (along_x < 0 || along_z < 0)
        return fail(err, STATUS_BAD_DATA, "%s:%d: %s is %g; it must not be negative", s->path, s->line[row],
                    along_x < 0 ? "mass_kg" : "mass_z_kg", along_x < 0 ? along_x : along_z);
    f->node[node].mass[FRAME_X] += along_x;
    f->node[node].mass[FRAME_Z] += along_z;
    f->node[node].mass[FRAME_ROT] += rotary;
    return STATUS_OK;
}

static int find_root(const Index *x, int i)
{
    while (x->root[i] != i)
        i = x->root[i];
    return i;
}

/* Two displacements become one; they are not yet. */
static Status unite(const Index *x, const FrameTie *tie, int dof, const Sheet *s, size_t row, Err *err)
{
    const int a = find_root(x, tie->node * FRAME_DOFS + dof), b = find_root(x, tie->same_as * FRAME_DOFS + dof);
    if (a == b)
        return fail(err, STATUS_BAD_DATA, "%s:%d: node %s and node %s are one, or tied already: a circle of ties",
                    s->path, s->line[row], sheet_text(s, row, "node"), sheet_text(s, row, "same_as"));
    x->root[a] = b;
    return STATUS_OK;
}

static Status take_tie(Frame *f, const Index *x, const Sheet *s, size_t row, Err *err)
{
    FrameTie *tie = &f->tie[row];
    static const char *const DOF[] = {"x", "z", "rot"};
    TRY(look_up(x, s, row, "node", &tie->node, err));
    TRY(look_up(x, s, row, "same_as", &tie->same_as, err));
    for (int d = 0; d < FRAME_DOFS; d++) {
        TRY(read_switch(s, row, DOF[d], &tie->dof[d], err));
        if (tie->dof[d])
            TRY(unite(x, tie, d, s, row, err));
    }
    return tie->dof[FRAME_X] || tie->dof[FRAME_Z] || tie->dof[FRAME_ROT]
               ? STATUS_OK
               : fail(err, STATUS_BAD_DATA, "%s:%d: ties nothing: none of x, z, rot is 1", s->path, s->line[row]);
}

/* A file of the folder; its rows are a list of the frame, or add to what is there (size 0). */
typedef struct {
    const char *name, *required, *optional, *named; /* named: the column of names; NULL: none */
    int may_be_missing;
    Status (*take)(Frame *f, const Index *x, const Sheet *s, size_t row, Err *err);
    size_t size, list, count; /* of an entry; where list and number are in a Frame */
} Part;

#define LIST(name) sizeof *((Frame *)0)->name, offsetof(Frame, name), offsetof(Frame, n_##name##s)
static const Part PARTS[] = {
    {"nodes.csv", "node x_m z_m", "fix_x fix_z fix_rot floor keep_x keep_z keep_rot", "node", 0, take_node, LIST(node)},
    {"sections.csv", "section A_m2 I_m4 E_pa", "shear_area_m2 poisson mass_kg_per_m", "section", 0, take_section,
     LIST(section)},
    {"elements.csv", "element node_i node_j section", "pin_i pin_j added_mass_kg", "element", 0, take_element,
     LIST(element)},
    {"masses.csv", "node mass_kg", "mass_z_kg rotary_kg_m2", NULL, 1, take_mass, 0, 0, 0},
    {"ties.csv", "node same_as", "x z rot", NULL, 1, take_tie, LIST(tie)},
};

int frame_reads(const char *name)
{
    for (size_t i = 0; i < sizeof PARTS / sizeof PARTS[0]; i++)
        if (strcmp(name, PARTS[i].name) == 0)
            return 1;
    return 0;
}

static Status make_list(Frame *f, const Part *part, size_t n, Err *err)
{
    void *list = calloc(n, part->size);
    if (!list)
        return fail(err, STATUS_NO_MEMORY, "frame: no memory for %zu rows of %s", n, part->name);
    memcpy((char *)f + part->list, &list, sizeof list);
    *(int *)((char *)f + part->count) = (int)n;
    return STATUS_OK;
}

static Status read_part(Frame *f, Index *x, const char *folder, const Part *part, Err *err)
{
    Sheet s;
    if (part->may_be_missing && !is_there(folder, part->name))
        return STATUS_OK;
    TRY(open_sheet(&s, folder, part->name, part->required, part->optional, err));
    Status status = part->size > 0 ? make_list(f, part, s.n_rows, err) : STATUS_OK;
    for (size_t i = 0; i < s.n_rows && status == STATUS_OK; i++)
        status = part->take(f, x, &s, i, err);
    if (status == STATUS_OK && part->named)
        status = check_names(&s, part->named, err);
    if (status == STATUS_OK && !x->entry)
        status = index_nodes(x, f, err);
    table_free(&s);
    return status;
}

/* ---- floors --------------------------------------------------------------------------------------------------- */

static double frame_extent(const Frame *f)
{
    double lo = f->node[0].z, hi = lo;
    for (int i = 1; i < f->n_nodes; i++) {
        lo = fmin(lo, f->node[i].z);
        hi = fmax(hi, f->node[i].z);
    }
    return hi - lo;
}

/* Heights of the level elements whose ends may move sideways, each once: *n of z, ascending. */
static void find_levels(const Frame *f, double tolerance, double z[], int *n)
{
    int found = 0;
    *n = 0;
    for (int e = 0; e < f->n_elements; e++) {
        const FrameNode *a = &f->node[f->element[e].node[0]], *b = &f->node[f->element[e].node[1]];
        if (fabs(a->z - b->z) <= tolerance && !a->fixed[FRAME_X] && !b->fixed[FRAME_X])
            z[found++] = a->z;
    }
    sort_values((size_t)found, z);
    for (int i = 0; i < found; i++)
        if (*n == 0 || z[i] - z[*n - 1] > tolerance)
            z[(*n)++] = z[i];
}

static Status number_floors(Frame *f, Err *err)
{
    double *z = malloc((size_t)f->n_elements * sizeof *z);
    if (!z)
        return fail(err, STATUS_NO_MEMORY, "frame: no memory for %d elements", f->n_elements);
    const double tolerance = 1e-6 * frame_extent(f);
    int n;
    find_levels(f, tolerance, z, &n);
    for (int i = 0; i < f->n_nodes; i++)
        for (int k = 0; k < n; k++)
            if (fabs(f->node[i].z - z[k]) <= tolerance && !f->node[i].fixed[FRAME_X])
                f->node[i].floor = k + 1;
    free(z);
    return STATUS_OK;
}

/* Mean height of the nodes of a floor; 0: the ground under the first one. *count: its nodes. */
static double floor_height(const Frame *f, int floor, int *count)
{
    double sum = 0;
    *count = 0;
    for (int i = 0; i < f->n_nodes; i++)
        if (f->node[i].floor == floor) {
            sum += f->node[i].z;
            ++*count;
        }
    return sum / (*count > 0 ? *count : 1);
}

/* The highest node that is held sideways below a height. */
static int ground_below(const Frame *f, double height, double *z)
{
    *z = -HUGE_VAL;
    for (int i = 0; i < f->n_nodes; i++)
        if (f->node[i].fixed[FRAME_X] && f->node[i].z < height)
            *z = fmax(*z, f->node[i].z);
    return isfinite(*z);
}

static Status measure_storeys(Frame *f, const char *folder, Err *err)
{
    double below = 0;
    for (int k = 1; k <= f->n_floors; k++) {
        int count;
        const double z = floor_height(f, k, &count);
        if (count == 0)
            return fail(err, STATUS_BAD_DATA, "%s: there is no floor %d, but a floor %d", folder, k, f->n_floors);
        if (k == 1 && !ground_below(f, z, &below))
            return fail(err, STATUS_BAD_DATA, "%s: no node below the first floor (z %g m) is held along x", folder, z);
        if (!(z > below))
            return fail(err, STATUS_BAD_DATA, "%s: floor %d at %g m is not above %g m; bottom floor first", folder, k,
                        z, below);
        f->storey_m[k - 1] = z - below;
        below = z;
    }
    return STATUS_OK;
}

static Status find_floors(Frame *f, const char *folder, Err *err)
{
    int named = 0;
    for (int i = 0; i < f->n_nodes; i++)
        named |= f->node[i].floor;
    if (!named)
        TRY(number_floors(f, err));
    for (int i = 0; i < f->n_nodes; i++)
        f->n_floors = f->node[i].floor > f->n_floors ? f->node[i].floor : f->n_floors;
    if (f->n_floors == 0)
        return fail(err, STATUS_BAD_DATA, "%s: no floors: no level element has ends that may move sideways", folder);
    if (f->n_floors > FLOORS_MAX)
        return fail(err, STATUS_BAD_DATA, "%s: %d floors; at most %d are supported", folder, f->n_floors, FLOORS_MAX);
    f->storey_m = calloc((size_t)f->n_floors, sizeof *f->storey_m);
    if (!f->storey_m)
        return fail(err, STATUS_NO_MEMORY, "frame: no memory for %d floors", f->n_floors);
    return measure_storeys(f, folder, err);
}

/* ---- the folder ----------------------------------------------------------------------------------------------- */

static Status read_sheets(Frame *f, const char *folder, Err *err)
{
    Index x = {0};
    Status status = STATUS_OK;
    for (size_t i = 0; i < sizeof PARTS / sizeof PARTS[0] && status == STATUS_OK; i++)
        status = read_part(f, &x, folder, &PARTS[i], err);
    free(x.entry);
    free(x.root);
    return status;
}

static Status read_tcl(Frame *f, const BuildingOptions *o, Err *err)
{
    const BuildingUnit u = building_unit(o->units);
    if (o->units == BUILDING_AUTO || u.stiffness != u.mass)
        return fail(err, STATUS_BAD_DATA,
                    "building.units: an OpenSees model says none; set it to N_m_kg, kN_m_t, N_mm_t, kip_in or kip_ft "
                    "for %s",
                    o->model);
    return opensees_read(f, o->model, u.length, u.stiffness * u.length, err);
}

Status frame_read(Frame *f, const BuildingOptions *o, Err *err)
{
    memset(f, 0, sizeof *f);
    Status status = is_tcl(o->model) ? read_tcl(f, o, err) : read_sheets(f, o->model, err);
    if (status == STATUS_OK)
        status = find_floors(f, o->model, err);
    if (status != STATUS_OK)
        frame_free(f);
    return status;
}

void frame_free(Frame *f)
{
    free(f->node);
    free(f->section);
    free(f->element);
    free(f->tie);
    free(f->storey_m);
    memset(f, 0, sizeof *f);
}
