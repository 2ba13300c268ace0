#include "scene/core_beam.h"
#include "scene/design.h"
#include "cmd/commands.h"
#include "cmd/show.h"
#include "simulator/scenario.h"
#include "settings/settings.h"

/* Where no design is given: the core of the paper's Table 1, linear from 12 mm to 6.4 mm. */
static const double T_BASE_M = 0.012, T_TOP_M = 0.0064;

typedef struct {
    int n;
    double building[FLOORS_MAX], core[FLOORS_MAX], zero_gap[FLOORS_MAX];
    double core_mass_kg, t_base_m, t_top_m;
    double by_theory[2]; /* [Hz] first mode of the core, by CoreTheory */
} Modes;

static Status choose_thickness(const Args *args, Modes *m, Err *err)
{
    const char *path = args_value(args, "--design");
    Designs d;
    m->t_base_m = T_BASE_M;
    m->t_top_m = T_TOP_M;
    if (!path)
        return STATUS_OK;
    TRY(design_read(&d, path, m->n, err));
    m->t_base_m = d.x[m->n];
    m->t_top_m = d.x[m->n + 1];
    design_free(&d);
    return STATUS_OK;
}

static Status compute(const Args *args, const Scenario *w, Modes *m, Err *err)
{
    double x[FLOORS_MAX + 2] = {0};
    m->n = scene_n_floors(w->scene);
    TRY(choose_thickness(args, m, err));
    x[m->n] = m->t_base_m;
    x[m->n + 1] = m->t_top_m;
    for (CoreTheory k = CORE_TIMOSHENKO; k <= CORE_EULER_BERNOULLI; k++)
        TRY(core_beam_first_hz(&w->options.core, k, m->n, scene_building(w->scene)->storey_m, m->t_base_m, m->t_top_m,
                               &m->by_theory[k], err));
    return scene_frequencies(w->scene, x, m->building, m->core, m->zero_gap, &m->core_mass_kg, err);
}

static Status print_json(const Modes *m, const Settings *s, Err *err)
{
    json_t *o = json_object();
    json_object_set_new(o, "building", json_string(s->building.model));
    json_object_set_new(o, "t_base_m", json_number(m->t_base_m));
    json_object_set_new(o, "t_top_m", json_number(m->t_top_m));
    json_object_set_new(o, "core_mass_kg", json_number(m->core_mass_kg));
    json_object_set_new(o, "core_theory", json_string(core_theory_word(s->core.theory)));
    json_object_set_new(o, "core_timoshenko_hz", json_number(m->by_theory[CORE_TIMOSHENKO]));
    json_object_set_new(o, "core_euler_bernoulli_hz", json_number(m->by_theory[CORE_EULER_BERNOULLI]));
    json_object_set_new(o, "building_hz", json_numbers((size_t)m->n, m->building));
    json_object_set_new(o, "core_hz", json_numbers((size_t)m->n, m->core));
    json_object_set_new(o, "zero_gap_hz", json_numbers((size_t)m->n, m->zero_gap));
    return show_json(o, err);
}

static void print_table(const Modes *m, const Settings *s)
{
    printf("building %s, %d floors; core of %.4g kg", s->building.model, m->n, m->core_mass_kg);
    if (s->core.section == CORE_EFFECTIVE)
        printf(" (effective section), %s\n", core_theory_word(s->core.theory));
    else
        printf(", thickness %g to %g mm, %s\n", 1e3 * m->t_base_m, 1e3 * m->t_top_m, core_theory_word(s->core.theory));
    const double bending = m->by_theory[CORE_EULER_BERNOULLI], shearing = m->by_theory[CORE_TIMOSHENKO];
    printf("first mode of the core: %.4g Hz bending alone, %.4g Hz (%+.2g %%) with shear and rotary inertia\n\n",
           bending, shearing, 100 * (shearing / bending - 1));
    printf("mode  building_hz      core_hz  zero_gap_hz\n");
    for (int i = 0; i < m->n; i++)
        printf("%4d %12.4f %12.4f %12.4f\n", i + 1, m->building[i], m->core[i], m->zero_gap[i]);
}

static Status run(const Args *args, Err *err)
{
    Settings s;
    Scenario w;
    Modes m = {0};
    TRY(args_settings(args, &s, NULL, NULL, err));
    TRY(scenario_open_still(&w, &s, err));
    Status status = compute(args, &w, &m, err);
    scenario_close(&w);
    if (status == STATUS_OK && args_has(args, "--json"))
        status = print_json(&m, &s, err);
    else if (status == STATUS_OK)
        print_table(&m, &s);
    return status;
}

static const ArgOption OPTIONS[] = {
    {"--design", "FILE", NULL, 0, "take the core's thickness from the first row of a design file"},
    OPTION_JSON,
    OPTION_SET,
    OPTION_END,
};

const Command CMD_MODES = {
    .name = "modes",
    .operand = "CONFIG",
    .summary = "natural frequencies of building, core and zero-gap assembly",
    .example = "imtet modes configs/quick.ini",
    .details =
        "Natural frequencies [Hz] of the building, of the core and of the two rigidly connected (zero gap). Without\n"
        "--design the core's thickness runs from 12 mm in the first storey to 6.4 mm in the last; an effective "
        "section\n"
        "(core.section) does not depend on it.",
    .options = OPTIONS,
    .run = run,
};
