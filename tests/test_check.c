/* `imtet check`: what it says of a sound building, and which warning each implausible one gets. */
#include "runs.h"

#include "evaluate/tower.h"
#include "scene/summary.h"
#include "scene_options.h"

enum { N = 6 };

/* A shear building of six storeys of 3.5 m: k [N/m] and m [kg] of every one, times the factors; rows top first if asked
 * for. */
static void write_building(double k_factor, double m_factor, int top_first)
{
    const double k = 4.5e8 * k_factor, m = 3e5 * m_factor;
    char stiffness[2048] = "", mass[2048] = "";
    for (int r = 0; r < N; r++)
        for (int c = 0; c < N; c++) {
            const int i = top_first ? N - 1 - r : r, j = top_first ? N - 1 - c : c;
            const double v = i == j ? (i < N - 1 ? 2 * k : k) : abs(i - j) == 1 ? -k : 0;
            append(stiffness, "%g%s", v, c < N - 1 ? "," : "\n");
            append(mass, "%g%s", i == j ? m : 0, c < N - 1 ? "," : "\n");
        }
    write_in_place("six/K.csv", stiffness);
    write_in_place("six/M.csv", mass);
    write_in_place("six.ini", "[building]\nmodel = six\nheights_m = 3.5\n[core]\nwidth_m = 3\n"
                              "[motion]\npga_g = 0.3\nstretch = 1\n[sim]\nduration_s = 0.5\naccuracy = coarse\n");
}

/* The keys of the warnings are "a b c". */
static void expect_warnings(const char *wanted, const char *arguments)
{
    char keys[512] = "";
    size_t i;
    json_auto_t *o = as_json("check @/six.ini --json %s", arguments);
    json_t *w;
    assert_int_equal(json_array_size(json_object_get(o, "faults")), 0);
    json_array_foreach(json_object_get(o, "warnings"), i, w)
    {
        assert_less(20, strlen(json_string_value(json_object_get(w, "text"))));
        append(keys, "%s%s", i ? " " : "", json_string_value(json_object_get(w, "key")));
    }
    if (strcmp(keys, wanted) != 0)
        fail_msg("imtet check @/six.ini %s\n  warned of '%s', wanted '%s'", arguments, keys, wanted);
}

static void expect_text(const char *wanted, const char *arguments)
{
    OWNED(forget) Said s;
    run(&s, "check @/six.ini %s", arguments);
    assert_int_equal(s.code, 0);
    assert_words(s.err, wanted);
    assert_words(s.out, "no fault, ");
}

static void expect_fault(const char *wanted, const char *arguments)
{
    expect(65, wanted, brief("check %s/six.ini %s", place.folder, arguments));
}

TEST(deviations_and_objectives_that_make_no_sense_are_noticed)
{
    write_building(1, 1, 0);
    expect_warnings("search.objectives", "--set search.objectives=j1_m,bumper_strain");
    expect_warnings("", "--set search.objectives=j1_m,bumper_strain --set contact.bumper_stiffness_n_m=1e8");
    expect_warnings("motion.records",
                    "--record builtin:kobe-like --set motion.records=builtin:sylmar-like,builtin:kobe-like");
    expect_warnings("motion.records", "--set motion.records=builtin:sylmar-like,builtin:sylmar-like");
    expect_warnings("", "--set motion.records=builtin:sylmar-like,builtin:elcentro-like");
    expect_fault("design.variables: gaps stands there twice", "--set design.variables=gaps,gaps,thickness");
    expect_fault("search.limits: j3_g<=-1: no design has less than 0", "--set 'search.limits=j3_g<=-1'");
    expect_fault("search.limits: '<=5' is not NAME<=NUMBER", "--set 'search.limits=<=5'");
    expect(65, "1 fault\n", "check configs/quick.ini --pga 0 --set motion.target=nonsense");
}

TEST(a_sound_building_is_in_order_with_its_figures)
{
    write_building(1, 1, 0);
    expect_warnings("", "");
    expect_warnings("core.width_m", "--set core.width_m=14");
    expect_text("is there room for such a core?", "--set core.width_m=14");
    expect_output("everything is in order", "check @/six.ini");
    json_auto_t *o = as_json("check @/six.ini --json");
    const json_t *b = json_object_get(o, "building"), *motion = json_object_get(o, "motion");
    assert_close(number(b, "mass_kg"), 6 * 3e5, 1e-12);
    assert_close(number(b, "weight_n"), 6 * 3e5 * 9.81, 1e-12);
    assert_close(number(b, "height_m"), 21, 1e-12);
    assert_close(json_real_value(json_array_get(json_object_get(b, "period_s"), 0)),
                 M_PI / (sqrt(4.5e8 / 3e5) * sin(M_PI / 26)), 1e-9);
    assert_close(number(motion, "scale") * number(motion, "recorded_peak_g"), 0.3, 1e-12);
    assert_int_equal((int)number(json_object_get(o, "study"), "variables"), 8);
    assert_less(0, number(json_object_get(o, "study"), "simulation_s"));
}

/* On standard error, each once; standard output is the JSON alone. */
TEST(simulate_and_optimize_say_what_check_finds_implausible)
{
    static const char *const COMMANDS[] = {"simulate @/six.ini --design @/mm.csv --json",
                                           "optimize @/six.ini --max-evals 8 --set search.initial=8 --out @/six-run"};
    write_building(1e-3, 1, 0);
    expect_shell("printf '[search]\\nfidelity = replicates\\n[sim]\\nreplicates = 2\\n' >>%s/six.ini", place.folder);
    write_in_place("mm.csv", "gap_01_m,gap_02_m,gap_03_m,gap_04_m,gap_05_m,gap_06_m,t_base_m,t_top_m\n"
                             "0.1,0.1,0.1,0.1,50,50,0.01,0.02\n0.1,0.1,0.1,0.1,50,50,0.01,0.02\n");
    for (int i = 0; i < 2; i++) {
        OWNED(forget) Said s;
        json_error_t why;
        run(&s,
            "%s --set sim.duration_s=4 --set building.units=N_m_kg --set "
            "motion.records=builtin:sylmar-like,builtin:sylmar-like",
            COMMANDS[i]);
        assert_int_equal(s.code, 0);
        assert_int_equal(count(s.err, "warning: building.model: the first period"), 1);
        assert_int_equal(count(s.err, "warning: motion.records: builtin:sylmar-like appears twice"), 1);
        if (i == 0) {
            assert_int_equal(count(s.err, "mm.csv:2: gap_05_m is 50 m and does not close; gaps are in metres"), 1);
            json_auto_t *o = json_loads(s.out, 0, &why);
            assert_int_equal(json_array_size(o), 2);
        }
    }
}

TEST(units_that_are_wrong_are_refused_with_those_that_fit)
{
    write_building(1e-3, 1, 0);
    expect_fault("set building.units to what the files are in: kN_m_kg (", "");
    expect_fault("floors of 300 t), MN_m_t (", "");
    expect_fault("floors of 3e+05 t)", "");
    expect_warnings("", "--set building.units=kN_m_kg");
    expect_warnings("building.model", "--set building.units=N_m_kg");
    write_building(1, 1e-3, 0);
    expect_fault("set building.units to what the files are in: N_m_t (", "");
    expect_warnings("", "--set building.units=N_m_t");
    expect_warnings("building.model building.model", "--set building.units=N_m_kg");
    write_building(1e-3, 1e-3, 0); /* the period stays as it is */
    expect_fault("floors of 300 kg if stiffness is in N/m and mass in kg (then N_m_kg); set building.units to what the "
                 "files are in: kN_m_t (",
                 "");
    expect_warnings("building.model", "--set building.units=N_m_kg");
    expect_warnings("", "--set building.units=kN_m_t");
    write_building(1 / 175126.8352464764, 1 / 175126.8352464764, 0);
    expect_warnings("", "--set building.units=kip_in");
    write_building(1e3, 1e3, 0);
    expect_warnings("building.model", "");
    expect_text("floor 1 has a mass of 3e+05 t; a floor usually has 1 to 10000 t", ""); /* 300 t, a thousand times */
}

/* Kilonewtons and tonnes together leave every period as it is: only the files can say so. */
TEST(units_are_taken_from_the_comments_of_the_files)
{
    static const struct {
        const char *K, *M;
        double stiffness, mass;
    } CASES[] = {{"# kN/m\n", "# t\n", 1e3, 1e3},
                 {"\xef\xbb\xbf# stiffness [MN/m]; floors upwards\n", "#masses (kg)\n", 1e6, 1},
                 {"# in N/m\n", "", 1, 1}};
    for (int i = 0; i < 3; i++) {
        const double k = 3e8 / CASES[i].stiffness, m = 3e5 / CASES[i].mass;
        FREED char *folder = formatted("units%d", i);
        FREED char *stiffness = formatted("%s%.17g,%.17g\n%.17g,%.17g\n", CASES[i].K, 2 * k, -k, -k, k);
        write_in_place(brief("%s/K.csv", folder), stiffness);
        write_in_place(brief("%s/M.csv", folder), brief("%s%.17g,0\n0,%.17g\n", CASES[i].M, m, m));
        json_auto_t *o = as_json("building @/%s --json", folder);
        assert_close(number(o, "mass_kg"), 6e5, 1e-12);
        const json_t *mode = json_array_get(json_object_get(o, "modes"), 0);
        assert_close(number(mode, "hz"), sqrt(1e3) * (sqrt(5) - 1) / (4 * M_PI), 1e-9);
    }
    expect(65, "units0/K.csv: says that it is in kN/m; leave building.units at auto",
           "building @/units0 --set building.units=N_m_kg");
    free(output_of("building @/units0 --set building.units=kN_m_t"));
}

TEST(heights_that_were_assumed_or_are_no_storeys_are_noticed)
{
    write_building(1, 1, 0);
    expect_warnings("building.heights_m", "--set building.heights_m=5.4864,3.9624");
    expect_text("the files have no heights: those of the built-in tower are assumed, 25.3 m in all; give "
                "building.heights_m = FIRST, OTHERS in m, from the bottom",
                "--set building.heights_m=5.4864,3.9624");
    expect_warnings("building.model", "--set building.heights_m=3,31");
    expect_warnings("building.model", "--set building.heights_m=0.9,3");
    expect_warnings("", "--set building.heights_m=1,30");
}

TEST(floors_from_the_top_down_are_noticed)
{
    static const char HEAD[] = "height_m,mass_t,stiffness_kn_m\n", *const STOREYS[] = {"3.5,300,4e5\n", "3.5,300,5e5\n",
                                                                                       "3.5,350,6e5\n"};
    write_building(1, 1, 1);
    expect_warnings("building.model", "");
    expect_text("bottom floor first", "");
    write_in_place("storeys/storeys.csv", brief("%s%s%s%s", HEAD, STOREYS[0], STOREYS[1], STOREYS[2]));
    expect_warnings("building.model", "--set building.model=@/storeys --set core.width_m=1");
    expect_text("the storeys become stiffer and the floors heavier); they are wanted bottom floor first",
                "--set building.model=@/storeys --set core.width_m=1");
    /* its first storey is soft */
    write_in_place("storeys/storeys.csv", brief("%s%s%s", HEAD, STOREYS[0], STOREYS[1]));
    expect_warnings("", "--set building.model=@/storeys --set core.width_m=1");
}

TEST(damping_peak_and_gaps_beyond_reason_are_noticed)
{
    write_building(1, 1, 0);
    expect_warnings("building.damping", "--set building.damping=3");
    expect_warnings("core.damping", "--set core.damping=0.25");
    expect_warnings("motion.pga_g", "--pga 3.1");
    expect_warnings("design.gap_m", "--set design.gap_m=0.001,9");
    expect_warnings("sim.duration_s", "--set sim.duration_s=1e5");
    write_in_place("push.csv", "time_s,floor_03_n\n0,0\n0.5,1e6\n1,0\n");
    expect_warnings("", "--set motion.record=none --pga 0 --set motion.forces=@/push.csv --set sim.duration_s=5");
    write_in_place("wide.csv", "gap_01_m,gap_02_m,gap_03_m,gap_04_m,gap_05_m,gap_06_m,t_base_m,t_top_m\n"
                               "0.1,0.1,20,0.1,0.1,0.1,0.012,0.01\n");
    expect_warnings("--design", "--design @/wide.csv");
}

#define LIFTS "--design @/lifts.csv --set sim.duration_s=8 --set "

/* No weight holds a core on a disc of 1 m; where nothing is said, weight alone holds it. Springs of their own may be anchored. */
TEST(a_foundation_that_would_lift_is_noticed)
{
    write_building(1, 1, 0);
    write_in_place("lifts.csv", "gap_01_m,gap_02_m,gap_03_m,gap_04_m,gap_05_m,gap_06_m,t_base_m,t_top_m\n"
                                "0.001,0.001,0.001,0.001,0.001,0.001,0.012,0.01\n");
    expect_warnings("core.foundation", LIFTS "'core.foundation=soil=C radius=1'");
    expect_text("the core's mat lifts: it turns by", LIFTS "'core.foundation=soil=C radius=1'");
    expect_text("anchors must hold it down by", LIFTS "'core.foundation=soil=C radius=1 anchors=inf'");
    expect_warnings("", LIFTS "'core.foundation=soil=C radius=10 weight=1e9'");
    expect_warnings("", LIFTS "core.foundation=rotation=1e11");
    expect_output("mat lifts", "simulate @/six.ini --set sim.forces=yes " LIFTS "'core.foundation=soil=C radius=1'");
}

TEST(an_objective_or_a_limit_that_no_run_can_have_is_a_fault)
{
    static const struct {
        const char *name, *wanted, *setting;
    } cases[] = {{"core_stress_pa", "the core has no section", "core.section=effective"},
                 {"core_stress_pa", "the core has no section", "core.model=@/six"},
                 {"core_buckling_ratio", "the core has no walls", "core.section=plate"},
                 {"base_rotation_rad", "the core's base does not turn", "core.foundation=translation=1e9"},
                 {"uplift_ratio", "no radius is known", "core.foundation=rotation=1e11"},
                 {"ductility", "no storey yields", "building.yield_drift=0"},
                 {"ed_hysteresis_pct", "no storey yields", "building.yield_drift=0"}};
    write_building(1, 1, 0);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
        for (int limit = 0; limit < 2; limit++) {
            OWNED(forget) Said s;
            const int is_more = strncmp(cases[i].name, "ed_", 3) == 0;
            run(&s, "check @/six.ini --set 'search.%s=%s%s' --set '%s'", limit ? "limits" : "objectives", cases[i].name,
                !limit    ? ",j1_m"
                : is_more ? "<=50"
                          : "<=1",
                cases[i].setting);
            assert_int_equal(s.code, 65);
            assert_words(
                s.err, brief("search.objectives: %s (there or in search.limits): %s", cases[i].name, cases[i].wanted));
        }
}

TEST(a_core_beyond_the_motions_samples_is_noticed)
{
    write_building(1, 1, 0);
    expect_warnings("motion.record",
                    "--set motion.stretch=50 --set sim.duration_s=0.5"); /* a sample each second: 0.5 Hz */
    expect_text(
        "impacts alone make it vibrate. Right where the ground shakes no faster; else take a record of smaller steps",
        "--set motion.stretch=50 --set sim.duration_s=0.5");
}

TEST(a_squat_core_without_shear_is_noticed)
{
    write_building(1, 1, 0);
    expect_warnings("core.theory", "--set core.theory=euler_bernoulli --set core.width_m=7");
    expect_warnings("", "--set core.width_m=7");
}

/* Its folder is a building of it. */
TEST(a_settings_file_beside_its_building_is_named_once)
{
    write_building(1, 1, 0);
    write_in_place("six/study.ini", "[building]\nmodel = .\n[motion]\npga_g = much\n");
    FREED char *at_line = formatted("imtet: %s/six/study.ini:4:9: motion.pga_g: 'much' is", place.folder);
    expect(65, at_line, "simulate @/six/study.ini --design none");
    expect(65, brief("imtet: %s/six/study.ini: 1 fault", place.folder), "check @/six/study.ini");
}

TEST(a_study_that_was_begun_beside_its_files_is_checked_from_elsewhere)
{
    FREED char *here = realpath(getenv("IMTET"), NULL);
    write_building(1, 1, 0);
    expect_shell("cd %s && %s new begun --set building.model=six --set building.heights_m=3.5 >said && "
                 "grep -qx 'out = results/begun' begun/study.ini && cd begun && %s "
                 "check study.ini --set "
                 "sim.duration_s=1 >sound && cd /proc && %s check %s/begun/study.ini --set sim.duration_s=1 >/dev/null",
                 place.folder, here, here, here, place.folder);
}

TEST(faults_come_as_json_too)
{
    OWNED(forget) Said s;
    write_building(1, 1, 0);
    run(&s, "check @/six.ini --json --set search.sead=3 --record nowhere.csv");
    assert_int_equal(s.code, 65);
    json_auto_t *o = json_loads(s.out, 0, NULL);
    assert_int_equal(json_array_size(json_object_get(o, "faults")), 2);
}

/* One mass: the base shear is the spectral acceleration, as a share of g. */
TEST(the_base_shear_of_one_mass_is_its_spectral_acceleration)
{
    double omega = 9, M = 1e5, K = 81e5, zeta = 0.03, storey = 4, psa;
    const double period = 2 * M_PI / omega;
    const SceneOptions s = scene_defaults();
    double phi = 1 / sqrt(M), gamma = sqrt(M);
    const Building b = {.n = 1,
                        .K = &K,
                        .M = &M,
                        .phi = &phi,
                        .omega = &omega,
                        .gamma = &gamma,
                        .zeta = &zeta,
                        .storey_m = &storey,
                        .model = {.n = 1, .phi = &phi, .omega = &omega, .gamma = &gamma, .zeta = &zeta}};
    SceneSummary f;
    OWNED(motion_free) Motion m = motion_of("builtin:sylmar-like", 0.3, 1);
    CHECK_OK(scene_summarise(&f, &b, &s.core, &s.building, &m, 0.01, 0.01, &err), &err);
    spectrum_psa(&m, zeta, 1, &period, &psa);
    assert_close(f.base_shear, psa / 9.81, 1e-12);
    assert_close(f.first_mode_mass, 1, 1e-12);
}

/* What check says of a study's times by itself; how fast this machine is only scales them. */
static double part_of_study(const char *part, const char *sets)
{
    json_auto_t *o = as_json("check @/six.ini --json --set search.max_evals=150 --set search.threads=2 %s", sets);
    const json_t *study = json_object_get(o, "study");
    return part ? number(study, part)
                : (number(study, "seconds") - number(study, "search_s") - number(study, "baselines_s")) /
                      (number(study, "simulation_s") / number(study, "threads"));
}

/* 24 close it, a tenth more polish it, and of the twelve that are named each takes 12: knee, the best of seven
 * objectives, four spread over the front. Of replicates none is named. */
TEST(the_time_of_a_study_is_that_of_its_simulations_its_search_and_its_baselines)
{
    static const char RECORDS[] = "--set motion.records=builtin:sylmar-like", NO_POLISH[] = "--set search.polish=0";
    write_building(1, 1, 0);
    assert_close(part_of_study(NULL, NO_POLISH), 150 + 24 + 12 * 12, 1e-9);
    assert_close(part_of_study(NULL, ""), 1.1 * 150 + 24 + 12 * 12, 1e-9);
    assert_close(part_of_study(NULL, RECORDS), 2 * (1.1 * 150 + 24 + 12 * 12), 1e-9);
    assert_close(part_of_study(NULL, "--set sim.replicates=4 --set sim.gap_tolerance_m=0.001"), 4.4 * 150 + 24, 1e-9);
    const double search_s = part_of_study("search_s", ""), baselines_s = part_of_study("baselines_s", "");
    assert_true(search_s > 0 && baselines_s > 0);
    assert_close(part_of_study("search_s", "--set search.max_evals=600"), 4 * search_s, 1e-9);
    assert_same_number(part_of_study("search_s", "--set search.surrogate=off"), 0);
    assert_close(part_of_study("baselines_s", RECORDS), 2 * baselines_s, 1e-9);
    assert_close(part_of_study("baselines_s", "--set building.model=guyan --set building.heights_m=5.4864,3.9624"),
                 baselines_s * 20 / N, 1e-9);
}

/* Five of them; the one that stands for all has the middle number of impacts of those that have any. */
TEST(the_designs_that_are_tried_collide_where_gaps_of_the_box_do)
{
#define COLLIDES "check @/six.ini --set sim.duration_s=8 --set core.width_m=5 "
    write_building(1, 1, 0);
    json_auto_t *o = as_json(COLLIDES "--ladder --json");
    const json_t *tried = json_object_get(json_object_get(o, "study"), "impacts");
    const json_t *of = json_object_get(json_object_get(o, "ladder"), "design");
    const double chosen = number(of, "impacts");
    int fewer = 0, more = 0, colliding = 0;
    assert_int_equal(json_array_size(tried), 5);
    for (size_t i = 0; i < 5; i++) {
        const double n = json_number_value(json_array_get(tried, i));
        colliding += n > 0;
        fewer += n > 0 && n < chosen;
        more += n > chosen;
    }
    assert_true(chosen > 0 && 2 * fewer <= colliding && 2 * more <= colliding);
    assert_int_equal(json_array_size(json_object_get(of, "gaps_m")), N);
    assert_close(number(of, "t_base_m"), 0.022, 1e-12);
    write_in_place("wide.csv", "gap_01_m,gap_02_m,gap_03_m,gap_04_m,gap_05_m,gap_06_m,t_base_m,t_top_m\n"
                               "5,5,5,5,5,5,0.012,0.01\n");
    FOR_EACH (const char *, wide, "--set design.gap_m=5,9", "--design @/wide.csv") {
        OWNED(forget) Said s;
        run(&s, COLLIDES "--ladder %s", *wide);
        assert_words(s.err, "no gap closes in any of the designs that were tried");
    }
}

/* The first has its gaps so wide that it never collides, the second does. */
TEST(designs_of_a_file_are_simulated_one_by_one)
{
    write_building(1, 1, 0);
    write_in_place("both.csv", "gap_01_m,gap_02_m,gap_03_m,gap_04_m,gap_05_m,gap_06_m,t_base_m,t_top_m\n"
                               "5,5,5,5,5,5,0.012,0.01\n0.001,0.001,0.001,0.001,0.001,0.001,0.012,0.01\n");
    json_auto_t *o = as_json(COLLIDES "--design @/both.csv --json");
    const json_t *impacts = json_object_get(json_object_get(o, "study"), "impacts");
    assert_int_equal(json_array_size(impacts), 2);
    assert_int_equal(json_integer_value(json_array_get(impacts, 0)), 0);
    assert_less(0, json_integer_value(json_array_get(impacts, 1)));
}

TEST(what_is_wrong_stands_below_everything_else)
{
    OWNED(forget) Said s;
    write_building(1, 1, 0);
    run(&s, "check @/six.ini --set core.width_m=14 --set search.sead=3 2>&1");
    const char *figures = strstr(s.out, "base_shear_share"), *warning = strstr(s.out, "is there room"),
               *fault = strstr(s.out, "search.seed");
    assert_true(figures && figures < warning && warning < fault);
    assert_int_equal(s.code, 65);
}

static double search_time(const char *settings)
{
    json_auto_t *o = as_json("check configs/quick.ini " SIX_FLOORS
                             "--json --set sim.duration_s=3 --set motion.record=builtin:suite-01 --set "
                             "motion.records=builtin:suite-02,builtin:suite-03,builtin:suite-04 %s",
                             settings);
    return number(json_object_get(o, "study"), "search_s");
}

/* Screened by one of four records and one in five finished, a design takes 1/4 + 3/4/5 of an evaluation. */
TEST(the_time_of_a_search_counts_what_it_screens_and_its_limits)
{
    const double plain = search_time("");
    assert_less(0, plain);
    assert_close(search_time("--set search.fidelity=records") / plain, 1 / (0.25 + 0.75 / 5), 1e-9);
    assert_close(search_time("--set search.objectives=j1_m,j3_g") / plain, 2.0 / 7, 1e-9);
    assert_close(search_time("--set search.objectives=j1_m,j3_g --set 'search.limits=j2_m<=1'") / plain, 3.0 / 7, 1e-9);
}

/* Its cases take the devices as given: to look for them would simulate the same some two hundred times. */
TEST(a_study_of_the_most_floors_ends_and_has_all_cases_that_it_is_compared_with)
{
    static const SceneKind KINDS[] = {SCENE_IMPACT, SCENE_NO_CORE, SCENE_RIGID, SCENE_TMD, SCENE_LINKS};
    char storeys[64 * (FLOORS_MAX + 1)] = "";
    SimTask task[N_OF(KINDS)];
    SimResult result[N_OF(KINDS)];
    OWNED(run_free) Run run;
    StudySummary summary;
    OWNED(problem_close) Problem p;
    for (int s = 0; s < FLOORS_MAX; s++)
        strcat(storeys, "3.5,1e5,2e8\n");
    FREED char *folder = in_place("tall");
    write_storeys_in_place("tall", storeys);
    FREED char *text = formatted("[building]\nmodel = %s\n[motion]\npga_g = 0.3\nstretch = 0.05\n[sim]\nduration_s = "
                                 "1\n[search]\nobjectives = j1_m, j3_g\n"
                                 "population = 4\ninitial = 4\nmax_evals = 4\npolish = 0\nthreads = 1\n",
                                 folder);
    const Settings s = settings_of(text, "tall-run");
    CHECK_OK(study_run(&s, &(StudyOptions){0}, &summary, NULL, &err), &err);
    CHECK_OK(run_read(&run, s.run.out, &err), &err);
    assert_int_equal(summary.n_simulated, 4);
    for (size_t k = 0; k < N_OF(KINDS); k++)
        task[k] = (SimTask){.kind = KINDS[k],
                            .x = run_x(&run, run_knee(&run)),
                            .device = {.tmd_hz = 0.2, .tmd_damping = 0.1, .link_ns_m = 1e6}};
    CHECK_OK(tower_open(&p, &s, TOWER_AS_SET, SIZE_MAX, &err), &err);
    CHECK_OK(tower_simulate(&p, N_OF(KINDS), task, result, &err), &err);
    for (size_t k = 0; k < N_OF(KINDS); k++)
        assert_true(result[k].outcome == RUN_OK && result[k].n_floors == FLOORS_MAX && result[k].j3_g > 0);
}

/* Also a test of selftest itself: every check has something to compare, and says by how much it may differ. */
TEST(this_build_gives_the_stored_answers)
{
    json_auto_t *all = as_json("check --self --json");
    json_t *check;
    size_t i, n_zero = 0;
    assert_true(json_is_true(json_object_get(all, "trusted")));
    assert_less(30, json_array_size(json_object_get(all, "checks")));
    json_array_foreach(json_object_get(all, "checks"), i, check)
    {
        const double stored = number(check, "stored"), tolerance = number(check, "tolerance");
        assert_true(tolerance > 0 && tolerance < 1);
        assert_at_most(fabs(number(check, "value") - stored), tolerance * fabs(stored));
        n_zero += stored == 0;
    }
    assert_int_equal(n_zero, 2); /* the core of a building without one */
    FREED char *line = output_of("check --self");
    assert_int_equal(strncmp(line, "this build can be trusted: ", 27), 0);
    assert_ptr_equal(strchr(line, '\n'), line + strlen(line) - 1);
}

SUITE(prepare, clear_place)
