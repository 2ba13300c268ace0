/* Devices of a design: links and the tuned mass against the baselines, and engines against each other where
 * floors and core collide as well. */
#include "scene_options.h"
#include "sim/device.h"

enum { FLOORS = 20, LINKS_AT = FLOORS + 2, MASS_AT = LINKS_AT + FLOORS, FEW = 6 };

typedef struct {
    Settings settings;
    double x[MASS_AT + 3 + FLOORS];
} Tower;

/* The paper's tower under a motion of the program, with a link on every floor and a tuned mass. */
static void tower_set(Tower *t, const char *variables, Engine engine, double gap)
{
    *t = (Tower){.settings = paper_settings()};
    t->settings.sim.duration_s = 15;
    t->settings.sim.accuracy = ACCURACY_FINE;
    t->settings.sim.forces = FORCES_YES;
    t->settings.sim.engine = engine;
    snprintf(t->settings.design.variables, OPTION_TEXT_MAX, "%s", variables);
    snprintf(t->settings.motion.record, OPTION_TEXT_MAX, "builtin:sylmar-like");
    for (int j = 0; j < FLOORS; j++)
        t->x[j] = gap * (j + 1);
    t->x[FLOORS] = 0.030;
    t->x[FLOORS + 1] = 0.0216;
}

static SimResult tower_run(Tower *t, SceneKind kind, LinearDevice device)
{
    SimResult r;
    const SceneOptions options = settings_scene(&t->settings);
    const char *record = t->settings.motion.record;
    OWNED(motion_free) Motion motion = motion_of(record, 0.3, record[0] == 'b' ? 1 : 3);
    OWNED(one_scene_free) OneScene stage = one_scene_of(&options, &motion);
    sim_worker_device(stage.worker, &device);
    CHECK_OK(sim_run(stage.worker, kind, t->x, &r, &err), &err);
    assert_ran(&r);
    return r;
}

static void fit_links(Tower *t, double damping)
{
    for (int j = 0; j < FLOORS; j++)
        t->x[LINKS_AT + j] = damping;
}

static void fit_mass(double x[], double kg, double hz, double damping)
{
    x[0] = kg;
    x[1] = hz;
    x[2] = damping;
}

static const LinearDevice NONE;

/* Energies in joules: of the tuned mass alone the input of the core is not part. */
static void assert_alike(const SimResult *r, const SimResult *wanted, double tolerance)
{
    assert_close_in(*r, *wanted, tolerance, j1_m, j2_m, j3_g);
    assert_close(r->ed1_pct * r->input_energy_j, wanted->ed1_pct * wanted->input_energy_j, tolerance);
    assert_close_in(*r, *wanted, tolerance, damped_building_j, stroke_m);
    assert_less(r->energy_balance_error, 1e-5);
}

TEST(links_of_a_design_alone_are_the_baseline_of_links)
{
    Tower t;
    tower_set(&t, "gaps, thickness", ENGINE_FAST, 1);
    const SimResult exact = tower_run(&t, SCENE_LINKS, (LinearDevice){.link_ns_m = 0.865e6});
    tower_set(&t, "gaps, thickness, links", ENGINE_FAST, 1);
    fit_links(&t, 0.865e6);
    const SimResult fine = tower_run(&t, SCENE_IMPACT, NONE);
    assert_alike(&fine, &exact, 1e-6);
    assert_close_in(fine, exact, 1e-6, dashpot_n, input_energy_j, device_loss_j, forces.base_shear_n);
    assert_less(50, fine.ed_devices_pct);
    t.settings.sim.accuracy = ACCURACY_STANDARD;
    const SimResult r = tower_run(&t, SCENE_IMPACT, NONE);
    assert_alike(&r, &exact, 1e-3);
    assert_true(10 * r.steps < fine.steps);
}

TEST(a_tuned_mass_of_a_design_alone_is_the_baseline)
{
    Tower t;
    tower_set(&t, "gaps, thickness", ENGINE_FAST, 1);
    const SimResult exact = tower_run(&t, SCENE_TMD, (LinearDevice){.tmd_hz = 0.25, .tmd_damping = 0.1});
    tower_set(&t, "gaps, thickness, tuned_mass", ENGINE_FAST, 1);
    fit_mass(t.x + LINKS_AT, exact.mcore_kg, 0.25, 0.1);
    SimResult r = tower_run(&t, SCENE_IMPACT, NONE);
    assert_alike(&r, &exact, 1e-6);
    assert_close(r.forces.building_base_shear_n, exact.forces.building_base_shear_n, 1e-5);
    t.settings.sim.accuracy = ACCURACY_STANDARD;
    r = tower_run(&t, SCENE_IMPACT, NONE);
    assert_alike(&r, &exact, 1e-3);
}

/* Of six floors some have links, or friction links where the exponent is 0, all have gaps, storeys yield and a mass hangs
 * at the roof. */
static SimResult run_all(Engine engine, double exponent, double yield_drift)
{
    Tower t;
    tower_set(&t, exponent > 0 ? "gaps, thickness, links, tuned_mass" : "gaps, thickness, friction, tuned_mass", engine,
              0.003);
    six_floors(&t.settings.building, &t.settings.core);
    t.settings.design.link_exponent = exponent;
    t.settings.building.yield_drift = yield_drift;
    t.settings.sim.duration_s = 4.2;
    t.x[FEW] = t.x[FEW + 1] = 0.02;
    for (int j = 0; j < FEW; j++)
        t.x[FEW + 2 + j] = j % 3 == 0 ? 0.2e6 : 0;
    fit_mass(t.x + 2 * FEW + 2, 3e4, 1, 0.1);
    return tower_run(&t, SCENE_IMPACT, NONE);
}

TEST(both_engines_agree_on_devices_beside_impacts_and_yielding)
{
    static const double EXPONENT[] = {1, 0.3, 1, 0}, YIELD[] = {0, 0, 0.002, 0.002};
    for (int i = 0; i < 4; i++) {
        const SimResult fast = run_all(ENGINE_FAST, EXPONENT[i], YIELD[i]);
        const SimResult cvode = run_all(ENGINE_CVODE, EXPONENT[i], YIELD[i]);
        assert_true(fast.impacts > 20);
        assert_less(5, fast.ed_devices_pct);
        assert_true(YIELD[i] == 0 || fast.ed_hysteresis_pct > 0.5);
        assert_close(fast.hysteresis_j, cvode.hysteresis_j, 2e-3);
        assert_alike(&fast, &cvode, 2e-3);
        assert_close(fast.dashpot_n, cvode.dashpot_n, 1e-4);
        double most = 0;
        for (int j = 0; j <= FLOORS_MAX; j++) {
            const int is_there = j < FEW ? j % 3 == 0 : j == FLOORS_MAX;
            assert_int_equal(fast.device[j].force > 0, is_there);
            assert_close(fast.device[j].stroke, cvode.device[j].stroke, 2e-3);
            most = fmax(most, fast.device[j].force);
        }
        assert_same_number(most, fast.dashpot_n);
        assert_close(fast.device_loss_j, cvode.device_loss_j, 2e-3);
    }
}

TEST(links_of_zero_change_no_bit)
{
    Tower t;
    tower_set(&t, "gaps, thickness", ENGINE_FAST, 0.006);
    SimResult without = tower_run(&t, SCENE_IMPACT, NONE);
    tower_set(&t, "gaps, thickness, links", ENGINE_FAST, 0.006);
    SimResult with = tower_run(&t, SCENE_IMPACT, NONE);
    assert_true(with.impacts > 20);
    assert_true(with.j1_m == without.j1_m && with.j3_g == without.j3_g && with.edcs_pct == without.edcs_pct &&
                with.steps == without.steps && with.device_loss_j == 0);
}

/* A mass that coasts on a power law: m v' = -c v^a, so that v^(1 - a) falls by (1 - a) c / m a second. */
TEST(a_power_law_stops_a_mass_as_its_closed_form_says)
{
    const Device law = {.damping = 3e5, .exponent = 0.3};
    const double mass = 1e5, h = 1e-5;
    double v = 1, t = 0, slope;
    for (; t < 0.2; t += h) {
        const double middle = v - 0.5 * h * device_viscous(&law, v, &slope) / mass;
        v -= h * device_viscous(&law, middle, &slope) / mass;
    }
    assert_close(pow(v, 0.7), 1 - 0.7 * 3 * t, 1e-5);
    const double e = 1e-6, up = device_viscous(&law, 0.1 + e, &slope), down = device_viscous(&law, 0.1 - e, &slope);
    device_viscous(&law, 0.1, &slope);
    assert_close(slope, 0.5 * (up - down) / e, 1e-6);
}

/* SPEC of the reference: links of 0.865 MN s/m on the early window of Sylmar. */
TEST(links_have_the_reference_numbers)
{
    Tower t;
    tower_set(&t, "gaps, thickness, links", ENGINE_FAST, 1);
    snprintf(t.settings.motion.record, OPTION_TEXT_MAX, "../shared/records/northridge_sylmar_ns.csv");
    need_file(t.settings.motion.record);
    t.settings.sim.duration_s = 11;
    fit_links(&t, 0.865e6);
    const SimResult r = tower_run(&t, SCENE_IMPACT, NONE);
    assert_close(r.j1_m, 0.336538, 1e-4);
    assert_close(r.j2_m, 0.040207, 1e-4);
    assert_close(r.j3_g, 0.18920, 1e-3);
    assert_close(r.input_energy_j, 1.81885e6, 2e-3);
    assert_close(r.ed1_pct, 2.066, 2e-3);
    assert_close(r.edcs_pct, 0.098, 5e-3);
    assert_close(r.dashpot_n, 0.387e6, 2e-3);
}

/* Floors 1 to 10 have a stop, 11 to 20 what the word says. */
static SimResult run_choice(int word)
{
    Tower t;
    tower_set(&t, "gaps, thickness, links", ENGINE_FAST, 0.006);
    snprintf(t.settings.design.devices, OPTION_TEXT_MAX, "gap, link, none");
    t.settings.design.device_zones = 2;
    t.settings.sim.duration_s = 8;
    fit_links(&t, 1e6);
    t.x[MASS_AT] = 0;
    t.x[MASS_AT + 1] = word;
    return tower_run(&t, SCENE_IMPACT, NONE);
}

TEST(a_floor_has_the_device_that_is_chosen_alone)
{
    const SimResult stops = run_choice(0), links = run_choice(1), none = run_choice(2);
    Tower t;
    tower_set(&t, "gaps, thickness, links", ENGINE_FAST, 0.006);
    t.settings.sim.duration_s = 8;
    const SimResult plain = tower_run(&t, SCENE_IMPACT, NONE);
    assert_true(stops.j1_m == plain.j1_m && stops.j3_g == plain.j3_g && stops.impacts == plain.impacts);
    for (int j = FLOORS / 2; j < FLOORS; j++)
        t.x[j] = 5, t.x[LINKS_AT + j] = 1e6;
    const SimResult wanted = tower_run(&t, SCENE_IMPACT, NONE);
    assert_close(links.j1_m, wanted.j1_m, 1e-6);
    assert_close(links.ed_devices_pct, wanted.ed_devices_pct, 1e-3);
    assert_true(links.n_devices == FLOORS && none.n_devices == FLOORS / 2 && none.device_loss_j == 0);
    assert_true(none.closings[FLOORS - 1] == 0 && links.closings[FLOORS - 1] == 0 && stops.closings[FLOORS - 1] > 0);
}

/* Floors 1 to 10 have a bumper, 11 to 20 what the word says. */
TEST(the_cost_is_that_of_the_table_of_prices)
{
    static const double BY_WORD[] = {10 * (3 + 0.5), 10 * 7, 0};
    for (int word = 0; word < 3; word++)
        for (int has_mass = 0; has_mass < 2; has_mass++) {
            Tower t;
            tower_set(&t, "gaps, thickness, bumper, links, tuned_mass", ENGINE_FAST, 0.006);
            snprintf(t.settings.design.devices, OPTION_TEXT_MAX, "bumper, link, none");
            t.settings.design.prices = (PriceOptions){3, 0.5, 7, 11, 13, 0};
            t.settings.design.device_zones = 2;
            t.settings.design.link_zones = 1;
            t.settings.sim.duration_s = 3;
            const double others[] = {9, 1e6, 2e5, 0.3, 0.1, 0, word, 1 - has_mass};
            memcpy(t.x + LINKS_AT, others, sizeof others);
            const SimResult r = tower_run(&t, SCENE_IMPACT, NONE);
            assert_int_equal(r.n_devices, 10 + (word < 2 ? 10 : 0) + has_mass);
            assert_close(r.cost, 10 * (3 + 0.5) + BY_WORD[word] + (has_mass ? 200 * 11 : 0) + 13e-3 * r.mcore_kg,
                         1e-12);
        }
    Tower t;
    tower_set(&t, "gaps, thickness", ENGINE_FAST, 1);
    t.settings.sim.duration_s = 3;
    t.settings.design.prices = (PriceOptions){3, 0.5, 7, 11, 13, 0};
    const SimResult links = tower_run(&t, SCENE_LINKS, (LinearDevice){.link_ns_m = 1e6});
    const SimResult mass = tower_run(&t, SCENE_TMD, (LinearDevice){.tmd_hz = 0.25, .tmd_damping = 0.1});
    assert_true(links.n_devices == FLOORS && mass.n_devices == 1);
    assert_close(links.cost, FLOORS * 7 + 13e-3 * links.mcore_kg, 1e-12);
    assert_close(mass.cost, 11e-3 * mass.mcore_kg, 1e-12);
}

/* (A - 1) W of anchors A, as a variable and as a setting; of a mat that never lifts what would hold it. */
TEST(anchors_of_a_design_hold_its_mat_and_cost_what_their_force_does)
{
    SimResult r[3];
    for (int i = 0; i < 3; i++) {
        static const char *const GROUND[] = {"soil=C radius=8 weight=1e6 anchors=9",
                                             "soil=C radius=8 weight=1e6 anchors=2",
                                             "soil=C radius=8 weight=1e6 anchors=inf"};
        Tower t;
        tower_set(&t, i == 0 ? "gaps, thickness, anchors" : "gaps, thickness", ENGINE_FAST, 0.006);
        snprintf(t.settings.core.foundation, OPTION_TEXT_MAX, "%s", GROUND[i]);
        t.settings.sim.forces = FORCES_YES;
        t.settings.sim.duration_s = 6;
        t.settings.design.prices = (PriceOptions){.core_t = 13, .anchor_mn = 17};
        t.x[FLOORS + 2] = 2;
        r[i] = tower_run(&t, SCENE_IMPACT, NONE);
        const double weight = 1e6 + 9.81 * r[i].mcore_kg, force = i < 2 ? weight : 0;
        assert_close(r[i].cost, 13e-3 * r[i].mcore_kg + 17e-6 * force, 1e-12);
        assert_close(r[i].forces.anchor_force_n, i < 2 ? force : (r[i].forces.uplift_ratio - 1) * weight, 1e-12);
    }
    assert_same_number(r[0].j1_m, r[1].j1_m);
    assert_same_number(r[0].forces.uplift_ratio, r[1].forces.uplift_ratio);
    assert_less(2, r[1].forces.uplift_ratio);
    assert_less(2 * r[2].forces.base_rotation_rad, r[1].forces.base_rotation_rad);
}

TEST(devices_are_refused_by_name)
{
    static const struct {
        const char *variables, *devices, *why;
    } bad[] = {{"gaps, thickness", "gap, link", "add links to design.variables"},
               {"gaps, thickness, links", "gap, lnk", "lnk"},
               {"gaps, thickness, links", "gap, gap", "gap stands there twice"},
               {"gaps, thickness, links", "link", "link alone is no choice"},
               {"gaps, thickness", "gap, bumper", "add bumper to design.variables"},
               {"gaps, thickness, links", "gap, friction", "add friction to design.variables"},
               {"gaps, thickness, links, friction", "all", "design.devices = link, friction chooses"}};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        DesignOptions o = scene_defaults().design;
        DesignSpace s;
        snprintf(o.variables, sizeof o.variables, "%s", bad[i].variables);
        snprintf(o.devices, sizeof o.devices, "%s", bad[i].devices);
        assert_refused(design_space_make(&s, &o, CORE_BOX, FLOORS, &err), STATUS_BAD_DATA, bad[i].why);
    }
}

TEST(kinds_of_the_variables_of_devices)
{
    DesignOptions o = scene_defaults().design;
    DesignSpace s;
    char name[TABLE_NAME_MAX];
    double lower[DESIGN_VARIABLES_MAX], upper[DESIGN_VARIABLES_MAX];
    snprintf(o.variables, sizeof o.variables, "gaps, thickness, links, friction, tuned_mass");
    snprintf(o.devices, sizeof o.devices, "friction, link, none");
    o.gap_zones = o.link_zones = o.device_zones = 2;
    CHECK_OK(design_space_make(&s, &o, CORE_BOX, FLOORS, &err), &err);
    static const char *const NAMES[] = {
        "gap_zone_1_m",       "gap_zone_2_m",      "t_base_m",          "t_top_m",       "link_zone_1_n_s_m",
        "link_zone_2_n_s_m",  "friction_zone_1_n", "friction_zone_2_n", "tuned_mass_kg", "tuned_mass_hz",
        "tuned_mass_damping", "device_zone_1",     "device_zone_2",     "device_roof"};
    assert_int_equal(s.n_var, 14);
    design_bounds(&s, &o, lower, upper);
    for (int j = 0; j < s.n_var; j++) {
        design_variable_name(&s, j, name);
        assert_string_equal(name, NAMES[j]);
        assert_int_equal(design_word(&s, j, 0) != NULL, j >= 11);
        assert_int_equal(design_is_log(&s, j), j >= 4 && j < 11);
        assert_less(lower[j], upper[j]);
        if (j >= 11)
            assert_true(lower[j] == 0 && upper[j] == (j < 13 ? 2 : 1));
    }
    assert_string_equal(design_word(&s, 12, 1), "link");
    assert_string_equal(design_word(&s, 13, 0), "tuned_mass");
    assert_true(!design_word(&s, 12, 3) && !design_word(&s, 13, 2));
}

SUITE(NULL, NULL)
