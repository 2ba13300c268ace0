/* The program as a person meets it: runs $IMTET in the repository's root and reads what it prints. */
#include "program.h"

/* A design file of 20 floors: gap_j = gap * j. */
static void write_designs(const char *name, int n, const double gap[], const double t_base[], const double t_top[])
{
    FREED char *text = NULL;
    size_t length = 0;
    FILE *f = open_memstream(&text, &length);
    for (int j = 1; j <= 20; j++)
        fprintf(f, "gap_%02d_m,", j);
    fprintf(f, "t_base_m,t_top_m\n");
    for (int i = 0; i < n; i++) {
        for (int j = 1; j <= 20; j++)
            fprintf(f, "%.17g,", gap[i] * j);
        fprintf(f, "%.17g,%.17g\n", t_base[i], t_top[i]);
    }
    fclose(f);
    write_in_place(name, text);
}

TEST(optimize_and_polish_answer_as_json)
{
    json_auto_t *study = as_json("optimize configs/quick.ini " SIX_FLOORS
                                 "--max-evals 60 --set sim.duration_s=4 --set search.initial=30 "
                                 "--set search.population=16 --out @/spoken --json");
    json_t *knee = json_object_get(study, "knee");
    assert_int_equal(json_integer_value(json_object_get(study, "simulated")), 60);
    FREED char *design = formatted("simulate @/spoken/settings.ini --design @/spoken:%" JSON_INTEGER_FORMAT " --json",
                                   json_integer_value(json_object_get(knee, "design")));
    json_auto_t *alone = as_json("%s", design);
    assert_close(number(knee, "j1_m"), number(alone, "j1_m"), 1e-3);
    assert_at_most(number(json_object_get(json_object_get(study, "best"), "j1_m"), "j1_m"), number(knee, "j1_m"));
    assert_true(json_object_get(json_object_get(study, "baselines"), "links") != NULL);
    json_auto_t *polished = as_json("polish @/spoken --design knee --improve j2_m --max-evals 24 --json");
    json_t *row = json_array_get(json_object_get(polished, "polished"), 0);
    assert_close(number(row, "j1_m_before"), number(knee, "j1_m"), 1e-2);
    assert_non_null(json_string_value(json_object_get(polished, "verdict")));
}

TEST(the_spectrum_is_the_same_as_json_and_as_csv)
{
    json_auto_t *o =
        as_json("spectrum builtin:kobe-like --pga 0.3 --set motion.stretch=3.1 --json --csv @/spectrum.csv");
    OWNED(table_free) Table t = table_of("spectrum.csv");
    assert_close(number(o, "pga_g"), 0.3, 1e-12);
    const json_t *psa = json_object_get(o, "psa_m_s2");
    assert_int_equal(json_array_size(psa), t.n_rows);
    for (size_t i = 0; i < t.n_rows; i++)
        assert_same_number(json_real_value(json_array_get(psa, i)), t.values[i * t.n_cols + 1]);
}

/* Husid's curve ends at 1, velocity and displacement reach the peaks of the table. */
TEST(the_histories_reach_the_figures_of_the_motion)
{
    json_auto_t *o = as_json("spectrum tests/motion/jma.csv --set motion.channel=EW --json --history @/history.csv");
    OWNED(table_free) Table t = table_of("history.csv");
    assert_int_equal(t.n_rows, 43);
    assert_int_equal(t.n_cols, 5);
    assert_string_equal(json_string_value(json_object_get(o, "format")), "jma");
    assert_string_equal(json_string_value(json_object_get(o, "channel")), "EW");
    assert_close(number(o, "pga_m_s2"), 0.987, 1e-12);
    double largest[5] = {0};
    for (size_t i = 0; i < t.n_rows; i++)
        for (size_t j = 0; j < t.n_cols; j++)
            largest[j] = fmax(largest[j], fabs(t.values[i * t.n_cols + j]));
    assert_close(largest[0], number(o, "duration_s"), 1e-12);
    assert_close(largest[1], number(o, "pga_m_s2"), 1e-12);
    assert_close(largest[2], number(o, "pgv_m_s"), 0.05); /* its peak lies between samples */
    assert_close(largest[3], number(o, "pgd_m"), 0.05);
    assert_close(t.values[t.n_rows * t.n_cols - 1], 1, 1e-12);
}

/* A short stretch of shaking: enough for some hundred impacts, short enough for a test. */
#define SHORT " --set motion.stretch=1 --set sim.duration_s=8 "

TEST(simulate_gives_the_same_numbers_as_json_and_as_csv)
{
    write_designs("two.csv", 2, (double[]){0.001, 0.004}, (double[]){0.012, 0.03}, (double[]){0.0064, 0.01});
    json_auto_t *list = as_json("simulate configs/quick.ini" SHORT "--design @/two.csv --json");
    free(output_of("simulate configs/quick.ini" SHORT "--design @/two.csv --csv @/results.csv"));
    char *csv = read_in_place("results.csv"), *line, *rest = csv;
    assert_text(output_of("simulate configs/quick.ini" SHORT "--design @/two.csv --csv -"), csv);
    assert_int_equal(json_array_size(list), 2);
    assert_words_in(output_of("simulate configs/quick.ini" SHORT "--design @/two.csv"), "\ntwo.csv:2  ", "!e+0");
    FREED char *names = strdup(strsep(&rest, "\n"));
    assert_int_equal(strncmp(names, "design,j1_m,j2_m,j3_g,ed1_pct,ed5_10_pct,edcs_pct,mcore_kg,input_energy_j,", 72),
                     0);
    assert_words(names, ",impacts,", ",core_stress_pa,");
    for (size_t i = 0; i < 2; i++) {
        const json_t *o = json_array_get(list, i);
        assert_string_equal(json_string_value(json_object_get(o, "outcome")), "ok");
        assert_int_equal(json_array_size(json_object_get(o, "peak_drift_m")), 20);
        line = strsep(&rest, "\n");
        assert_int_equal(strtol(strsep(&line, ","), NULL, 10), (long)i + 1);
        char *copy = strdup(names), *left = copy, *name;
        for (strsep(&left, ","); strcmp(name = strsep(&left, ","), "outcome") != 0;) {
            const json_t *value = json_object_get(o, name);
            const char *text = strsep(&line, ",");
            const double cell = strtod(text, NULL);
            if (json_is_null(value)) /* what the scene does not have */
                assert_string_equal(text, "");
            else
                assert_true(json_is_boolean(value) ? cell == json_is_true(value) : cell == number(o, name));
        }
        free(copy);
        assert_string_equal(line, "ok");
        assert_less(0, number(o, "impacts"));
    }
    free(csv);
}

/* ------------------------------------------------------------------------------------------- another building --- */

/* A shear building of five floors, all alike: its circular frequencies are 2 sqrt(k/m) sin((2i - 1) pi / 22). */
static void write_five_floors(double k, double m)
{
    char stiffness[512] = "", mass[512] = "";
    size_t nk = 0, nm = 0;
    for (int i = 0; i < 5; i++)
        for (int j = 0; j < 5; j++) {
            const double v = i == j ? (i < 4 ? 2 * k : k) : abs(i - j) == 1 ? -k : 0;
            nk += (size_t)snprintf(stiffness + nk, sizeof stiffness - nk, "%g%s", v, j < 4 ? "," : "\n");
            nm += (size_t)snprintf(mass + nm, sizeof mass - nm, "%g%s", i == j ? m : 0, j < 4 ? "," : "\n");
        }
    write_in_place("five/K.csv", stiffness);
    write_in_place("five/M.csv", mass);
    write_in_place("five.ini", "[building]\nmodel = five\nheights_m = 4, 3\n[core]\nwidth_m = 5\n"
                               "[motion]\npga_g = 0.6\n[sim]\nduration_s = 8\n"
                               "[search]\ninitial = 12\npopulation = 8\nmax_evals = 20\n");
    write_in_place("five.csv", "gap_01_m,gap_02_m,gap_03_m,gap_04_m,gap_05_m,t_base_m,t_top_m\n"
                               "0.002,0.004,0.006,0.008,0.01,0.012,0.0064\n");
}

TEST(a_building_of_five_floors_goes_all_the_way)
{
    const double k = 4e8, m = 6e5;
    write_five_floors(k, m);
    free(output_of("check @/five.ini"));
    json_auto_t *o = as_json("building @/five.ini --json");
    for (int i = 0; i < 5; i++)
        assert_close(json_real_value(json_array_get(json_object_get(o, "building_hz"), (size_t)i)),
                     sqrt(k / m) * sin((2 * i + 1) * M_PI / 22) / M_PI, 1e-9);

    json_auto_t *fast = as_json("simulate @/five.ini --design @/five.csv --set sim.accuracy=fine --json");
    json_auto_t *slow = as_json("simulate @/five.ini --design @/five.csv --set sim.engine=cvode --json");
    assert_int_equal(json_array_size(json_object_get(fast, "peak_drift_m")), 5);
    assert_less(10, number(fast, "impacts"));
    assert_close(number(fast, "j1_m"), number(slow, "j1_m"), 1e-3);

    free(output_of("optimize @/five.ini --set sim.duration_s=6 --out @/five.run"));
    FREED char *front = read_in_place("five.run/front.csv");
    assert_int_equal(strncmp(front, "id,gap_01_m,gap_02_m,gap_03_m,gap_04_m,gap_05_m,t_base_m,", 57), 0);
    free(output_of("evaluate @/five.run --design knee --record builtin:elcentro-like"));
    expect(65, "a design of 20 floors has gap_06_m there", "simulate configs/quick.ini --design @/five.csv");
}

SUITE(make_place, clear_place)
