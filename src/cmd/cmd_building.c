#include <math.h>
#include <string.h>

#include "base/units.h"
#include "cmd/commands.h"
#include "cmd/show.h"
#include "scene/building_svg.h"
#include "settings/settings.h"
#include "store/output.h"

typedef struct {
    const Settings *s;
    Building building;
    Frame frame; /* without nodes where the building is none */
} Model;

static Status open_model(Model *m, const Settings *s, Err *err)
{
    *m = (Model){.s = s};
    TRY(building_load(&m->building, &s->building, err));
    const Status status =
        frame_is(s->building.model) ? frame_read(&m->frame, s->building.model, FLOORS_MAX, err) : STATUS_OK;
    if (status != STATUS_OK)
        building_free(&m->building);
    return status;
}

static void close_model(Model *m)
{
    building_free(&m->building);
    frame_free(&m->frame);
}

static double row_mass(const Building *b, int j)
{
    double sum = 0;
    for (int k = 0; k < b->n; k++)
        sum += b->M[j * b->n + k];
    return sum;
}

/* Share of it that is not on the floors, below which nothing is said of it. */
static const double BETWEEN_MIN = 1e-3;

static void print_mass(const Building *b)
{
    const double mass = building_mass(b);
    double between = mass;
    for (int j = 0; j < b->n; j++)
        between -= row_mass(b, j);
    printf("%.5g kg, %.4g MN\n", mass, 1e-6 * GRAVITY * mass);
    if (between > BETWEEN_MIN * mass)
        printf("of it %.4g kg are between the floors\n", between);
}

static double mass_share(const Building *b, int mode)
{
    return b->gamma[mode] * b->gamma[mode] / building_mass(b);
}

static void print_text(const Model *m)
{
    const Building *b = &m->building;
    double z = 0;
    printf("%s: %d floor%s, ", m->s->building.model, b->n, b->n == 1 ? "" : "s");
    print_mass(b);
    if (m->frame.n_nodes)
        printf("plane frame of %d nodes, %d elements, %d sections, %d ties\n", m->frame.n_nodes, m->frame.n_elements,
               m->frame.n_sections, m->frame.n_ties);
    printf("\nfloor    z [m]  storey [m]    mass [kg]     mode  period [s]  freq [Hz]  mass [%%]  damping [%%]\n");
    for (int j = 0; j < b->n; j++) {
        z += b->storey_m[j];
        printf("%5d %8.3f %11.3f %12.5g    %5d %11.4g %10.4g %9.3g %12.3g\n", j + 1, z, b->storey_m[j], row_mass(b, j),
               j + 1, 2 * M_PI / b->omega[j], b->omega[j] / (2 * M_PI), 100 * mass_share(b, j), 100 * b->zeta[j]);
    }
}

static Status print_json(const Model *m, Err *err)
{
    const Building *b = &m->building;
    json_t *floors = json_array(), *modes = json_array();
    double z = 0;
    for (int j = 0; j < b->n; j++) {
        z += b->storey_m[j];
        json_array_append_new(floors, json_pack("{s:i, s:f, s:f, s:f}", "floor", j + 1, "z_m", z, "storey_m",
                                                b->storey_m[j], "mass_kg", row_mass(b, j)));
        json_array_append_new(modes, json_pack("{s:i, s:f, s:f, s:f}", "mode", j + 1, "hz", b->omega[j] / (2 * M_PI),
                                               "mass_share", mass_share(b, j), "damping", b->zeta[j]));
    }
    return show_json(json_pack("{s:s, s:f, s:i, s:i, s:o, s:o}", "model", m->s->building.model, "mass_kg",
                               building_mass(b), "nodes", m->frame.n_nodes, "elements", m->frame.n_elements, "floors",
                               floors, "modes", modes),
                     err);
}

static Status write_svg(const Model *m, const char *path, Err *err)
{
    Output o;
    TRY(output_open(&o, path, err));
    building_svg(o.stream, &m->building, m->frame.n_nodes ? &m->frame : NULL);
    return output_close(&o, err);
}

static Status run(const Args *args, Err *err)
{
    Settings s;
    Model m;
    const char *svg = args_value(args, "--svg");
    settings_defaults(&s);
    TRY(option_put_path(s.building.model, args->operand, err));
    TRY(args_apply(args, &s, NULL, NULL, err));
    TRY(open_model(&m, &s, err));
    Status status = svg ? write_svg(&m, svg, err) : STATUS_OK;
    if (status == STATUS_OK && args_has(args, "--json"))
        status = print_json(&m, err);
    else if (status == STATUS_OK)
        print_text(&m);
    close_model(&m);
    return status;
}

static const ArgOption OPTIONS[] = {
    {"--svg", "FILE", NULL, 0, "draw it: frame or storeys to scale, first three mode shapes"},
    OPTION_JSON,
    OPTION_SET,
    OPTION_END,
};

const Command CMD_BUILDING = {
    .name = "building",
    .group = GROUP_PREPARE,
    .operand = "FOLDER",
    .summary = "a building's floors, masses, modes and a drawing of it",
    .example = "imtet building my-tower --svg my-tower.svg",
    .details =
        "FOLDER holds K.csv and M.csv, storeys.csv or a plane frame (nodes.csv, sections.csv, elements.csv), or is\n"
        "guyan or appendix. Floors with height and mass, modes with period, participating mass and damping.\n"
        "Settings of [building] are given by --set, as in --set building.units=kN_m_t.",
    .options = OPTIONS,
    .is_alone = 1,
    .run = run,
};
