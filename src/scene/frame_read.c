#include "base/text.h"
#include "scene/opensees.h"
#include "scene/sheets.h"
#include "scene/building_read.h"

/* ---- rows ----------------------------------------------------------------------------------------------------- */

static void set_switches(int on[FRAME_DOFS], const double x[FRAME_DOFS])
{
    for (int d = 0; d < FRAME_DOFS; d++)
        on[d] = (int)x[d];
}

static Status look_up(const Frame *f, FrameKind kind, const char *column, const char *word, int *index, Err *err)
{
    *index = frame_find(f, kind, word);
    return *index >= 0 ? STATUS_OK
                       : bad_data(err, "%s '%.40s' is not in %s", column, word,
                                  kind == FRAME_NODES ? "nodes.csv" : "sections.csv");
}

/* Adds a node with what holds it, its floor, and what the full model keeps of it. */
static Status add_node(void *frame, const SheetRow *r, Err *err)
{
    FrameNode node = {.x = r->x[1], .z = r->x[2], .floor = (int)fmin(r->x[6], 1e6)};
    text_copy(node.name, r->word[0]);
    set_switches(node.fixed, &r->x[3]);
    set_switches(node.keep, &r->x[7]);
    if (node.floor != r->x[6])
        return bad_data(err, "floor %g is no number of a floor", r->x[6]);
    return frame_add_node(frame, &node, err);
}

/* Adds a section. */
static Status add_section(void *frame, const SheetRow *r, Err *err)
{
    FrameSection section = {.area = r->x[1],
                            .inertia = r->x[2],
                            .E = r->x[3],
                            .shear_area = r->x[4],
                            .poisson = r->x[5],
                            .mass_per_m = r->x[6]};
    text_copy(section.name, r->word[0]);
    return frame_add_section(frame, &section, err);
}

/* Adds an element between nodes that are there. */
static Status add_element(void *frame, const SheetRow *r, Err *err)
{
    FrameElement e = {.pinned = {(int)r->x[4], (int)r->x[5]}, .added_mass = r->x[6]};
    text_copy(e.name, r->word[0]);
    TRY(look_up(frame, FRAME_NODES, "node_i", r->word[1], &e.node[0], err));
    TRY(look_up(frame, FRAME_NODES, "node_j", r->word[2], &e.node[1], err));
    TRY(look_up(frame, FRAME_SECTIONS, "section", r->word[3], &e.section, err));
    return frame_add_element(frame, &e, err);
}

/* Adds mass to a node; along z the same as along x unless its column says otherwise. */
static Status add_mass(void *frame, const SheetRow *r, Err *err)
{
    int node;
    TRY(look_up(frame, FRAME_NODES, "node", r->word[0], &node, err));
    double *mass = ((Frame *)frame)->node[node].mass; /* no column of the sheet may be negative */
    mass[FRAME_X] += r->x[1];
    mass[FRAME_Z] += r->x[*r->word[2] ? 2 : 1];
    mass[FRAME_ROT] += r->x[3];
    return STATUS_OK;
}

static Status add_tie(void *frame, const SheetRow *r, Err *err)
{
    int node, same_as, dof[FRAME_DOFS];
    TRY(look_up(frame, FRAME_NODES, "node", r->word[0], &node, err));
    TRY(look_up(frame, FRAME_NODES, "same_as", r->word[1], &same_as, err));
    set_switches(dof, &r->x[2]);
    return frame_tie(frame, node, same_as, dof, err);
}

/* ---- sheets --------------------------------------------------------------------------------------------------- */

/* In the order in which they refer to each other; the last two may be missing. */
static const SheetForm SHEETS[] = {
    {"nodes.csv",
     add_node,
     {{"node", COLUMN_NAME, NAN},
      {"x_m", COLUMN_NUMBER, NAN},
      {"z_m", COLUMN_NUMBER, NAN},
      {"fix_x", COLUMN_SWITCH, 0},
      {"fix_z", COLUMN_SWITCH, 0},
      {"fix_rot", COLUMN_SWITCH, 0},
      {"floor", COLUMN_LEAST_0, 0},
      {"keep_x", COLUMN_SWITCH, 0},
      {"keep_z", COLUMN_SWITCH, 0},
      {"keep_rot", COLUMN_SWITCH, 0}}},
    {"sections.csv",
     add_section,
     {{"section", COLUMN_NAME, NAN},
      {"A_m2", COLUMN_NUMBER, NAN},
      {"I_m4", COLUMN_NUMBER, NAN},
      {"E_pa", COLUMN_NUMBER, NAN},
      {"shear_area_m2", COLUMN_LEAST_0, 0},
      {"poisson", COLUMN_NUMBER, 0.3},
      {"mass_kg_per_m", COLUMN_LEAST_0, 0}}},
    {"elements.csv",
     add_element,
     {{"element", COLUMN_NAME, NAN},
      {"node_i", COLUMN_NAME, NAN},
      {"node_j", COLUMN_NAME, NAN},
      {"section", COLUMN_NAME, NAN},
      {"pin_i", COLUMN_SWITCH, 0},
      {"pin_j", COLUMN_SWITCH, 0},
      {"added_mass_kg", COLUMN_LEAST_0, 0}}},
    {"masses.csv",
     add_mass,
     {{"node", COLUMN_NAME, NAN},
      {"mass_kg", COLUMN_LEAST_0, NAN},
      {"mass_z_kg", COLUMN_LEAST_0, 0},
      {"rotary_kg_m2", COLUMN_LEAST_0, 0}}},
    {"ties.csv",
     add_tie,
     {{"node", COLUMN_NAME, NAN},
      {"same_as", COLUMN_NAME, NAN},
      {"x", COLUMN_SWITCH, 0},
      {"z", COLUMN_SWITCH, 0},
      {"rot", COLUMN_SWITCH, 0}}},
};
enum { N_SHEETS = N_OF(SHEETS), N_REQUIRED = N_SHEETS - 2 };

int frame_reads(const char *name)
{
    int i = 0;
    while (i < N_SHEETS && strcmp(name, SHEETS[i].file) != 0)
        i++;
    return i < N_SHEETS;
}

int frame_is(const char *model)
{
    return text_ends(model, ".tcl") || text_ends(model, ".ops") || model_has(model, SHEETS[0].file);
}

Status frame_read(Frame *f, const BuildingOptions *o, Err *err)
{
    const char *model = o->model;
    const BuildingUnit u = building_unit(o->units);
    const int is_program = !model_has(model, SHEETS[0].file);
    Status status = STATUS_OK;
    memset(f, 0, sizeof *f);
    if (is_program) {
        if (o->units == BUILDING_AUTO || u.stiffness != u.mass)
            return bad_data(err, "building.units: %s says none; set it to N_m_kg, kN_m_t, N_mm_t, kip_in or kip_ft",
                            model);
        status = opensees_read(f, model, u.length, u.stiffness * u.length, o->elastic, err);
    }
    for (int i = 0; i < N_SHEETS && !is_program && status == STATUS_OK; i++)
        if (i < N_REQUIRED || model_has(model, SHEETS[i].file))
            status = sheet_read(&SHEETS[i], model, f, err);
    THEN(status, frame_find_floors(f, model, o->rigid_floors, err));
    if (status != STATUS_OK)
        frame_free(f);
    return status;
}
