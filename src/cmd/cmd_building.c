#include <errno.h>
#include <sys/stat.h>

#include "base/text.h"
#include "base/units.h"
#include "cmd/commands.h"
#include "cmd/designs.h"
#include "cmd/show.h"
#include "report/panels.h"
#include "settings/settings.h"
#include "scene/neighbour.h"

/* Where no design is given: the core of the paper's Table 1, linear from 12 mm to 6.4 mm. */
static const double T_BASE_M = 0.012, T_TOP_M = 0.0064;

typedef struct {
    Settings s;
    int has_core; /* the operand is a CONFIG */
    Building b;
    Frame frame; /* without nodes where the building is none */
    Design design;
    CoreBeam core;
    double by_theory[2], zero_gap[FLOORS_MAX]; /* [Hz] first mode of the core by CoreTheory; modes of both as one */
} Model;

static double share(double gamma, double mass)
{
    return gamma * gamma / mass;
}

/* ---- what is asked for ---------------------------------------------------------------------------------------- */

/* Of a CONFIG also the core, and both rigidly connected. */
static Status open_model(const Args *args, Model *m, Err *err)
{
    struct stat st;
    const char *name = args->operand, *word = args_value(args, "--design");
    const int is_there = stat(name, &st) == 0;
    CoreOptions *core = &m->s.core;
    DesignSpace space;
    Designs d;
    m->has_core = !frame_is(name) && is_there && S_ISREG(st.st_mode);
    settings_defaults(&m->s);
    if (!is_there && strcmp(name, "guyan") != 0 && strcmp(name, "appendix") != 0) {
        errno = ENOENT;
        return fail_missing(err, name);
    }
    if (!m->has_core)
        TRY(option_put_path(m->s.building.model, name, err));
    TRY(m->has_core ? args_settings(args, &m->s, NULL, NULL, err) : args_apply(args, &m->s, NULL, NULL, err));
    if (m->s.problem.kind != PROBLEM_TOWER)
        return bad_data(err, "problem.kind is not tower: %s has no building", name);
    if (word && !m->has_core)
        return misused(err, "--design needs a CONFIG, which has a core");
    TRY(building_load(&m->b, &m->s.building, err));
    if (frame_is(m->s.building.model))
        TRY(frame_read(&m->frame, &m->s.building, err));
    if (!m->has_core)
        return STATUS_OK;
    m->design = (Design){.t_base = T_BASE_M, .t_top = T_TOP_M};
    TRY(design_space_make(&space, &m->s.design, core_section(core), m->b.n, err));
    if (word) {
        TRY(designs_take_one(&d, word, &space, NULL, 0, NULL, err));
        design_of(&space, d.x, &m->design);
        design_free(&d);
    }
    if (m->design.side > 0)
        core->width_m = m->design.side;
    for (CoreTheory k = CORE_TIMOSHENKO; k <= CORE_EULER_BERNOULLI && !neighbour_is_given(core); k++)
        TRY(core_beam_first_hz(core, k, m->b.n, m->b.storey_m, m->design.t_base, m->design.t_top, &m->by_theory[k],
                               err));
    TRY(core_make(&m->core, core, &m->s.building, &m->b, m->design.t_base, m->design.t_top, err));
    return building_joined_hz(&m->core, &m->b, m->zero_gap, err);
}

/* ---- answers -------------------------------------------------------------------------------------------------- */

/* Floors, then modes, in the order of both; and what stands beside them of a core. */
static void add_rows(const Model *m, json_t *floors, json_t *modes, json_t *cores)
{
    const Building *b = &m->b;
    double z = 0, moved = 0; /* mass of the core that the ground moves: all but half of its first storey's */
    for (int j = 0; j < b->n; j++)
        moved += m->core.gamma[j] * m->core.gamma[j];
    for (int j = 0; j < b->n; j++) {
        z += b->storey_m[j];
        json_array_append_new(floors, json_of("floor=%d z_m=%g storey_m=%g mass_kg=%g", j + 1, z, b->storey_m[j],
                                              building_floor_mass(b, j)));
        json_array_append_new(modes,
                              json_of("mode=%d hz=%g mass_share=%g damping=%g", j + 1, b->model.omega[j] / (2 * M_PI),
                                      share(b->model.gamma[j], building_mass(b)), b->model.zeta[j]));
        if (m->has_core)
            json_array_append_new(cores, json_of("core_hz=%g core_mass_share=%g zero_gap_hz=%g",
                                                 j < m->core.top ? m->core.omega[j] / (2 * M_PI) : NAN,
                                                 share(m->core.gamma[j], moved), m->zero_gap[j]));
    }
}

/* Mode by mode; the shapes on the floors have 1 as their largest. */
static void put_core(json_t *o, const Model *m, const json_t *modes, const json_t *cores)
{
    const BuildingModel *b = &m->b.model;
    json_t *shapes = json_array(), *horizontal = json_array();
    for (int i = 0; i < m->b.n; i++) {
        double largest = 0, shape[FLOORS_MAX];
        for (int j = 0; j < m->b.n; j++)
            if (fabs(b->phi[j * b->n + i]) > fabs(largest))
                largest = b->phi[j * b->n + i];
        for (int j = 0; j < m->b.n; j++)
            shape[j] = b->phi[j * b->n + i] / largest;
        json_array_append_new(shapes, json_numbers(m->b.n, shape));
        json_array_append_new(horizontal, json_boolean(b->like[i] >= 0));
    }
    json_put(o,
             "t_base_m=%g t_top_m=%g core_mass_kg=%g core_theory=%s core_timoshenko_hz=%g core_euler_bernoulli_hz=%g "
             "building_hz=%p building_mass_share=%p building_damping=%p building_shapes=%p building_horizontal=%p "
             "core_hz=%p core_mass_share=%p zero_gap_hz=%p",
             m->design.t_base, m->design.t_top, m->core.mass_kg, core_word(&m->s.core), m->by_theory[CORE_TIMOSHENKO],
             m->by_theory[CORE_EULER_BERNOULLI], json_column(modes, "hz"), json_column(modes, "mass_share"),
             json_column(modes, "damping"), shapes, horizontal, json_column(cores, "core_hz"),
             json_column(cores, "core_mass_share"), json_column(cores, "zero_gap_hz"));
}

static void say_all(Document *d, const Model *m)
{
    static const double BETWEEN_MIN = 1e-3; /* share of the mass that is not on the floors */
    const CoreOptions *core = &m->s.core;
    const double bending = m->by_theory[CORE_EULER_BERNOULLI], shearing = m->by_theory[CORE_TIMOSHENKO];
    const double mass = building_mass(&m->b);
    double between = mass;
    char walls[80] = " (effective section)";
    for (int j = 0; j < m->b.n; j++)
        between -= building_floor_mass(&m->b, j);
    document_say(d, "%s: %d floor%s, %.6g t, %.4g MN", m->s.building.model, m->b.n, m->b.n == 1 ? "" : "s", 1e-3 * mass,
                 1e-6 * GRAVITY * mass);
    if (between > BETWEEN_MIN * mass)
        document_say(d, "%.6g t of it are between the floors", 1e-3 * between);
    if (m->frame.n[FRAME_NODES])
        document_say(d, "plane frame of %d nodes, %d elements, %d sections, %d ties", m->frame.n[FRAME_NODES],
                     m->frame.n[FRAME_ELEMENTS], m->frame.n[FRAME_SECTIONS], m->frame.n_ties);
    if (core_section(core) != CORE_EFFECTIVE)
        snprintf(walls, sizeof walls, ", thickness %g to %g mm", 1e3 * m->design.t_base, 1e3 * m->design.t_top);
    if (m->has_core && neighbour_is_given(core))
        document_say(d, "neighbour of %.6g t, %d floors, %s; first mode: %.4g Hz", 1e-3 * m->core.mass_kg, m->core.top,
                     core->model, m->core.omega[0] / (2 * M_PI));
    else if (m->has_core)
        document_say(d,
                     "core of %.6g t%s, %s; first mode: %.4g Hz bending alone, %.4g Hz (%+.2g %%) with shear and "
                     "rotary inertia",
                     1e-3 * m->core.mass_kg, walls, core_theory_word(core->theory), bending, shearing,
                     100 * (shearing / bending - 1));
}

static Status show(const Args *args, const Model *m, Err *err)
{
    json_t *floors = json_array(), *modes = json_array(), *cores = json_array(), *row;
    size_t j;
    building_warnings(&m->b, warn_on_stderr, NULL);
    TRY(condensation_warnings(&m->b, &m->s.building, warn_on_stderr, NULL, err));
    add_rows(m, floors, modes, cores);
    Document d = {.data =
                      json_of("model=%s mass_kg=%g nodes=%d elements=%d floors=%p modes=%p", m->s.building.model,
                              building_mass(&m->b), m->frame.n[FRAME_NODES], m->frame.n[FRAME_ELEMENTS], floors, modes),
                  .drawing = "panels",
                  .width = 1100};
    if (args_has(args, "--svg"))
        TRY(building_drawing(&m->b, m->frame.n[FRAME_NODES] ? &m->frame : NULL, 10, &d.drawn, err));
    say_all(&d, m);
    if (m->has_core)
        put_core(d.data, m, modes, cores);
    json_t *table = document_table(&d);
    json_array_foreach(floors, j, row)
    {
        row = json_put(json_copy(row), "period_s=%g", 2 * M_PI / m->b.model.omega[j]);
        json_object_update(row, json_array_get(modes, j));
        json_object_update(row, json_array_get(cores, j));
        json_array_append_new(table, row);
    }
    json_decref(cores);
    return document_give(&d, args, err);
}

static Status run(const Args *args, Err *err)
{
    Model *m;
    TRY_ROOM(m, 1, "a building", err);
    Status status = open_model(args, m, err);
    THEN(status, show(args, m, err));
    building_free(&m->b);
    frame_free(&m->frame);
    free(m);
    return status;
}

const Command CMD_BUILDING = {
    .name = "building",
    .group = GROUP_PREPARE,
    .operand = "CONFIG|MODEL",
    .summary = "floors, masses and modes of a building, a drawing; with CONFIG also of the core and both together",
    .example = "imtet building my-tower --svg my-tower.svg",
    .details =

        "MODEL is a folder with K.csv and M.csv, storeys.csv or a plane frame (nodes.csv, sections.csv,\n"
        "elements.csv), an OpenSees model (FILE.tcl, units by --set building.units=kN_m_t), guyan or\n"
        "appendix. Prints floors with height and mass, and modes with period, participating mass and damping.\n"
        "For a CONFIG it also prints the modes of the core and those of building and core rigidly connected\n"
        "(zero gap). Without --design the core is 12 mm thick in the first storey and 6.4 mm in the last.\n"
        "With building.modes it lists the lowest modes of the fuller model, including vertical ones.",
    .options =
        {
            VALUE("--design", "FILE", "with CONFIG: a design that has the core's thickness: " DESIGN_WORDS),
            VALUE("--svg", "FILE", "draw it: frame or storeys to scale, first ten mode shapes"),
            OPTION_JSON,
            OPTION_SET,
        },
    .is_alone = 1,
    .run = run,
};
