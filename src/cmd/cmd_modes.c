#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/json.h"
#include "base/units.h"
#include "scene/core_beam.h"
#include "motion/spectrum.h"
#include "cmd/commands.h"
#include "cmd/designs.h"
#include "cmd/show.h"
#include "report/heights.h"
#include "evaluate/scenario.h"
#include "settings/options.h"

/* Where no design is given: the core of the paper's Table 1, linear from 12 mm to 6.4 mm. */
static const double T_BASE_M = 0.012, T_TOP_M = 0.0064;

typedef struct {
    int n;
    double building[FLOORS_MAX], core[FLOORS_MAX], zero_gap[FLOORS_MAX];
    double core_mass_kg, t_base_m, t_top_m;
    double by_theory[2]; /* [Hz] first mode of the core, by CoreTheory */
    double damping[FLOORS_MAX], building_share[FLOORS_MAX], core_share[FLOORS_MAX]; /* [-] participating masses */
    double psa_building[FLOORS_MAX], psa_zero_gap[FLOORS_MAX]; /* [g] with --spectrum, at their periods */
    int has_spectrum;
    double z[FLOORS_MAX];                 /* [m] of the floors */
    double shape[FLOORS_MAX][FLOORS_MAX]; /* [mode][floor] of the building, largest 1 */
    int vertical[FLOORS_MAX];             /* resembles no mode of the floors */
} Modes;

/* x, and the core by it. */
static Status choose_core(const Args *args, const Scenario *w, Modes *m, CoreOptions *core, double x[], Err *err)
{
    const char *path = args_value(args, "--design");
    const DesignSpace *space = scene_design(w->scene);
    Designs d;
    Design design;
    if (space->n_walls > 0) {
        x[space->n_gaps] = T_BASE_M;
        x[space->n_gaps + 1] = T_TOP_M;
    }
    if (space->has_side)
        x[space->n_var - 1] = w->options.core.side_m;
    if (path) {
        TRY(designs_take_one(&d, path, space, err));
        memcpy(x, d.x, (size_t)space->n_var * sizeof *x);
        design_free(&d);
    }
    design_of(space, x, &design);
    m->t_base_m = design.t_base;
    m->t_top_m = design.t_top;
    *core = w->options.core;
    if (design.side > 0)
        core->side_m = design.side;
    return STATUS_OK;
}

/* gamma_i^2 over their sum, which is the whole mass; of `all` modes the first n. */
static void mass_shares(int n, int all, const double gamma[], double share[])
{
    double mass = 0;
    for (int i = 0; i < all; i++)
        mass += gamma[i] * gamma[i];
    for (int i = 0; i < n; i++)
        share[i] = gamma[i] * gamma[i] / mass;
}

static void find_shapes(const Building *b, Modes *m)
{
    double z = 0;
    for (int i = 0; i < m->n; i++) {
        double largest = 0;
        for (int j = 0; j < m->n; j++) {
            const double value = b->model.phi[j * b->model.n + i];
            largest = fabs(value) > fabs(largest) ? value : largest;
        }
        for (int j = 0; j < m->n; j++)
            m->shape[i][j] = b->model.phi[j * b->model.n + i] / largest;
        m->vertical[i] = b->model.like[i] < 0;
        m->z[i] = z += b->storey_m[i];
    }
}

static Status participate(const Scenario *w, const CoreOptions *options, Modes *m, Err *err)
{
    const Building *b = scene_building(w->scene);
    CoreBeam *core = malloc(sizeof *core);
    if (!core)
        return fail(err, STATUS_NO_MEMORY, "modes: no memory for %d storeys", m->n);
    const Status status = core_beam_make(core, options, m->n, b->storey_m, m->t_base_m, m->t_top_m, err);
    if (status == STATUS_OK)
        mass_shares(m->n, m->n, core->gamma, m->core_share);
    free(core);
    mass_shares(m->n, b->model.n, b->model.gamma, m->building_share);
    memcpy(m->damping, b->model.zeta, (size_t)m->n * sizeof *m->damping);
    find_shapes(b, m);
    return status;
}

/* Pseudo-acceleration at the periods, by the building's damping. */
static void find_spectrum(const Scenario *w, Modes *m)
{
    for (int i = 0; i < m->n; i++) {
        const double period[2] = {1 / m->building[i], 1 / m->zero_gap[i]}, zeta = fmin(m->damping[i], 0.99);
        spectrum_psa(&w->motion, zeta, 1, &period[0], &m->psa_building[i]);
        spectrum_psa(&w->motion, zeta, 1, &period[1], &m->psa_zero_gap[i]);
        m->psa_building[i] /= GRAVITY;
        m->psa_zero_gap[i] /= GRAVITY;
    }
    m->has_spectrum = 1;
}

static Status compute(const Args *args, const Scenario *w, Modes *m, Err *err)
{
    double x[DESIGN_VARIABLES_MAX] = {0};
    CoreOptions core;
    m->n = scene_n_floors(w->scene);
    TRY(choose_core(args, w, m, &core, x, err));
    for (CoreTheory k = CORE_TIMOSHENKO; k <= CORE_EULER_BERNOULLI; k++)
        TRY(core_beam_first_hz(&core, k, m->n, scene_building(w->scene)->storey_m, m->t_base_m, m->t_top_m,
                               &m->by_theory[k], err));
    TRY(participate(w, &core, m, err));
    TRY(scene_frequencies(w->scene, x, m->building, m->core, m->zero_gap, &m->core_mass_kg, err));
    if (args_has(args, "--spectrum"))
        find_spectrum(w, m);
    return STATUS_OK;
}

static Status print_json(const Modes *m, const Settings *s, Err *err)
{
    json_t *o = json_object();
    json_object_set_new(o, "building", json_words(s->building.model));
    json_object_set_new(o, "t_base_m", json_number(m->t_base_m));
    json_object_set_new(o, "t_top_m", json_number(m->t_top_m));
    json_object_set_new(o, "core_mass_kg", json_number(m->core_mass_kg));
    json_object_set_new(o, "core_theory", json_string(core_theory_word(s->core.theory)));
    json_object_set_new(o, "core_timoshenko_hz", json_number(m->by_theory[CORE_TIMOSHENKO]));
    json_object_set_new(o, "core_euler_bernoulli_hz", json_number(m->by_theory[CORE_EULER_BERNOULLI]));
    json_object_set_new(o, "building_hz", json_numbers((size_t)m->n, m->building));
    json_object_set_new(o, "core_hz", json_numbers((size_t)m->n, m->core));
    json_object_set_new(o, "zero_gap_hz", json_numbers((size_t)m->n, m->zero_gap));
    json_object_set_new(o, "building_mass_share", json_numbers((size_t)m->n, m->building_share));
    json_object_set_new(o, "core_mass_share", json_numbers((size_t)m->n, m->core_share));
    json_object_set_new(o, "building_damping", json_numbers((size_t)m->n, m->damping));
    json_t *shapes = json_array(), *horizontal = json_array();
    for (int i = 0; i < m->n; i++) {
        json_array_append_new(shapes, json_numbers((size_t)m->n, m->shape[i]));
        json_array_append_new(horizontal, json_boolean(!m->vertical[i]));
    }
    json_object_set_new(o, "building_shapes", shapes);
    json_object_set_new(o, "building_horizontal", horizontal);
    if (m->has_spectrum) {
        json_object_set_new(o, "building_psa_g", json_numbers((size_t)m->n, m->psa_building));
        json_object_set_new(o, "zero_gap_psa_g", json_numbers((size_t)m->n, m->psa_zero_gap));
    }
    return show_json(o, err);
}

static void print_table(const Modes *m, const Settings *s)
{
    printf("building %s, %d floor%s; core of %.4g kg", s->building.model, m->n, m->n == 1 ? "" : "s", m->core_mass_kg);
    if (s->core.section == CORE_EFFECTIVE)
        printf(" (effective section), %s\n", core_theory_word(s->core.theory));
    else
        printf(", thickness %g to %g mm, %s\n", 1e3 * m->t_base_m, 1e3 * m->t_top_m, core_theory_word(s->core.theory));
    const double bending = m->by_theory[CORE_EULER_BERNOULLI], shearing = m->by_theory[CORE_TIMOSHENKO];
    printf("first mode of the core: %.4g Hz bending alone, %.4g Hz (%+.2g %%) with shear and rotary inertia\n\n",
           bending, shearing, 100 * (shearing / bending - 1));
    printf("mode  building_hz  mass_pct  damping_pct      core_hz  mass_pct  zero_gap_hz%s\n",
           m->has_spectrum ? "  building_psa_g  zero_gap_psa_g" : "");
    for (int i = 0; i < m->n; i++) {
        printf("%4d %12.4f %9.3g %12.3g %12.4f %9.3g %12.4f", i + 1, m->building[i], 100 * m->building_share[i],
               100 * m->damping[i], m->core[i], 100 * m->core_share[i], m->zero_gap[i]);
        if (m->has_spectrum)
            printf(" %15.4g %15.4g", m->psa_building[i], m->psa_zero_gap[i]);
        putchar('\n');
    }
}

enum { SHAPES_DRAWN = 10, COLUMNS = 5 };

/* The first horizontal modes of the building. */
static Status draw_shapes(const Modes *m, const Settings *s, const char *path, Err *err)
{
    HeightPanel panels[SHAPES_DRAWN] = {{0}};
    char titles[SHAPES_DRAWN][64], title[OPTION_TEXT_MAX + 64];
    int n = 0;
    for (int i = 0; i < m->n && n < SHAPES_DRAWN; i++) {
        if (m->vertical[i])
            continue;
        snprintf(titles[n], sizeof titles[n], "mode %d: %.4g Hz, %.3g %%", i + 1, m->building[i],
                 100 * m->building_share[i]);
        panels[n] = (HeightPanel){.title = titles[n], .curve = {m->shape[i]}, .from_ground = 1};
        n++;
    }
    snprintf(title, sizeof title, "mode shapes of %s: frequency, participating mass", s->building.model);
    const Heights h = {title, m->n, m->z, n < COLUMNS ? n : COLUMNS, n, panels};
    return heights_draw(&h, path, err);
}

static Status run(const Args *args, Err *err)
{
    Settings s;
    Scenario w;
    Modes m = {0};
    TRY(args_settings(args, &s, NULL, NULL, err));
    const SceneOptions options = settings_scene(&s);
    TRY(args_has(args, "--spectrum") ? scenario_open(&w, &options, &s.motion, err)
                                     : scenario_open_still(&w, &options, err));
    Status status = compute(args, &w, &m, err);
    scenario_close(&w);
    if (status == STATUS_OK && args_has(args, "--svg"))
        status = draw_shapes(&m, &s, args_value(args, "--svg"), err);
    if (status == STATUS_OK && args_has(args, "--json"))
        status = print_json(&m, &s, err);
    else if (status == STATUS_OK)
        print_table(&m, &s);
    return status;
}

static const ArgOption OPTIONS[] = {
    {"--design", "FILE", NULL, 0, "take the core's thickness from it: " DESIGN_WORDS},
    {"--spectrum", NULL, NULL, 0,
     "pseudo-acceleration of the configured motion at the periods [g], with the building's damping"},
    {"--svg", "FILE", NULL, 0, "the building's first ten mode shapes, drawn by gnuplot"},
    OPTION_JSON,
    OPTION_SET,
    OPTION_END,
};

const Command CMD_MODES = {
    .name = "modes",
    .operand = "CONFIG",
    .summary = "natural frequencies and participating masses of building, core and zero-gap assembly",
    .example = "imtet modes configs/quick.ini",
    .details =
        "Natural frequencies [Hz] of the building, of the core and of the two rigidly connected (zero gap), with the\n"
        "share of the mass that takes part in each mode and the building's damping. Without --design the core's\n"
        "thickness runs from 12 mm in the first storey to 6.4 mm in the last; an effective section (core.section)\n"
        "does not depend on it. With building.modes the lowest modes of the fuller model are listed, vertical ones "
        "included.",
    .options = OPTIONS,
    .is_alone = 1,
    .run = run,
};
