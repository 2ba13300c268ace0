/* A design simplified: what each step of the path promises, on a short study of the tower. */
#include "runs.h"

#include "study/simplify.h"

#define STEP 0.01
static const double PLATES[] = {0.008, 0.012, 0.02, 0.03};
static Run study;
static size_t row; /* its knee */

static void make_run(void)
{
    write_in_place(
        "s.ini",
        "[motion]\nrecord = builtin:elcentro-like\npga_g = 0.3\n[sim]\nduration_s = 4\n"
        "accuracy = coarse\n[search]\ninitial = 20\npopulation = 12\nmax_evals = 40\nthreads = 2\npolish = 0\n");
    free(output_of("optimize @/s.ini --out @/run"));
    study = run_in("run");
    row = run_knee(&study);
}

static int end_run(void **state)
{
    run_free(&study);
    return clear_place(state);
}

static ImproveConfig config_of(double slack)
{
    ImproveConfig c = {.gap_step = STEP, .n_plates = N_OF(PLATES)};
    memcpy(c.plate, PLATES, sizeof PLATES);
    for (size_t k = 0; k < study.schema.n_obj; k++)
        c.slack[k] = k == 0 ? slack : INFINITY;
    return c;
}

static Improved simplified(const ImproveConfig *c)
{
    Improved s;
    CHECK_OK(improve_design(&study, row, c, simplify_design, &s, &err), &err);
    return s;
}

static double off_step(double x, double step)
{
    return fabs(x / step - round(x / step));
}

TEST(the_path_loses_stops_only_and_ends_on_steps_within_what_may_be_lost)
{
    const ImproveConfig c = config_of(0.05);
    OWNED(improved_free) Improved s = simplified(&c);
    const Evaluation *e = s.designs.row;
    assert_int_equal(s.designs.n, SIMPLIFY_PATH);
    for (size_t i = 1; i < s.designs.n; i++)
        assert_at_most(s.n_left[i], s.n_left[i - 1]);
    for (int j = 0; j < study.schema.design.n_gaps; j++) {
        assert_true(e[SIMPLIFY_CLOSING].x[j] == e[SIMPLIFY_START].x[j] || e[SIMPLIFY_CLOSING].x[j] == DESIGN_OPEN_M);
        assert_less(off_step(e[s.designs.n - 1].x[j], STEP), 1e-9);
    }
    assert_at_most(e[s.designs.n - 1].f[0], 1.05 * e[0].f[0] * (1 + 1e-12));
    assert_true(s.loss[s.designs.n - 1] <= 1.0);
}

/* The run itself has simulated the design: the start is what it stored. */
TEST(the_start_is_the_design_of_the_run_and_idle_stops_change_no_bit)
{
    const ImproveConfig c = config_of(0.05);
    OWNED(improved_free) Improved s = simplified(&c);
    const Evaluation *e = s.designs.row;
    assert_memory_equal(e[SIMPLIFY_START].x, run_x(&study, row), study.schema.n_var * sizeof *e->x);
    assert_memory_equal(e[SIMPLIFY_START].f, e[SIMPLIFY_CLOSING].f, study.schema.n_obj * sizeof *e->f);
    assert_less(s.n_left[SIMPLIFY_CLOSING], s.n_left[SIMPLIFY_START]);
}

TEST(where_everything_may_be_lost_no_stop_is_left_and_where_nothing_may_none_goes_that_closes)
{
    const ImproveConfig anything = config_of(1e9), nothing = {0};
    OWNED(improved_free) Improved bare = simplified(&anything), s = simplified(&nothing);
    assert_int_equal(bare.n_left[bare.designs.n - 1], 0);
    for (size_t k = 0; k < study.schema.n_obj; k++)
        assert_at_most(s.designs.row[s.designs.n - 1].f[k] * (study.schema.column[study.schema.n_var + k].sense),
                       s.designs.row[0].f[k] * study.schema.column[study.schema.n_var + k].sense);
}

/* Mass is limited to just above the knee's: heavy plates alone would break it. */
TEST(limits_are_kept_or_nothing_is_stored)
{
    Settings limited = *study.settings, *before = study.settings;
    ImproveConfig c = {.n_plates = 1, .plate = {0.06}};
    for (size_t k = 0; k < study.schema.n_obj; k++)
        c.slack[k] = INFINITY;
    snprintf(limited.search.limits, sizeof limited.search.limits, "mcore_kg<=1e6");
    study.settings = &limited;
    OWNED(improved_free) Improved s = simplified(&c);
    study.settings = before;
    assert_int_equal(s.designs.n, SIMPLIFY_MOVED + 1);
    assert_true(s.loss[SIMPLIFY_MOVED] > 1.0 && s.loss[SIMPLIFY_START] <= 0.0);
}

TEST(the_command_stores_its_end_and_refuses_what_is_no_length)
{
    expect_output("stored in the run as design 41",
                  "simplify @/run --gap-step 10mm --plates 8,12,20,30 --keep j1_m=5%");
    free(output_of("simulate @/s.ini --design @/run:41"));
    expect(2, "--plates: '0.00001' is not a length in mm such as 5 or 5mm, from 0.1 to 10000",
           "simplify @/run --plates 0.00001");
    expect(2, "--gap-step: 'wide' is not a length in mm", "simplify @/run --gap-step wide");
    expect(2, "--keep: j1_m may lose -0.5 of its value", "simplify @/run --keep j1_m=-0.5");
    expect(2, "--plates: give them in ascending order", "simplify @/run --plates 12,8");
}

TEST(ten_of_twenty_stops_go_from_the_knee_all_numbers_are_as_sold_and_j1_is_kept_within_2_percent)
{
    free(output_of("simplify @/run --design knee --gap-step 5mm --plates 8,10,12,15,20,25,30,40,50 --keep j1_m=2%%"));
    OWNED(run_free) Run now = run_in("run");
    size_t pair[2], n_stops = 0, n_sold = 0;
    assert_false(run_simplified(&now, row + 1, pair));
    assert_true(run_simplified(&now, now.table.n - 1, pair) && pair[0] == row && pair[1] == now.table.n - 1);
    assert_true(run_simplified(&now, row, pair) && pair[0] == row && pair[1] == now.table.n - 1);
    const double *x = run_x(&now, pair[1]);
    for (size_t j = 0; j < 20; j++) {
        n_stops += x[j] < DESIGN_OPEN_M;
        assert_less(off_step(x[j], 0.005), 1e-9);
    }
    for (size_t j = 20; j < 22; j++)
        FOR_EACH (double, sold, 0.008, 0.010, 0.012, 0.015, 0.020, 0.025, 0.030, 0.040, 0.050)
            n_sold += fabs(x[j] - *sold) < 1e-12;
    assert_at_most(n_stops, 10);
    assert_int_equal(n_sold, 2);
    assert_at_most(run_f(&now, pair[1])[0], 1.02 * run_f(&now, row)[0]);
    free(output_of("report @/run --design knee"));
    expect_file("run/report.html", brief("\"pair\":[{\"id\":%ld,", now.table.row[row].id));
}

TEST(floors_of_a_zone_become_alike_and_stay_so_on_steps)
{
    ImproveConfig c = config_of(1e9);
    c.zones = 3;
    c.slack[0] = 0.3;
    OWNED(improved_free) Improved s = simplified(&c);
    for (size_t i = SIMPLIFY_ZONES; i < s.designs.n; i++)
        for (int a = 0; a < 20; a++)
            for (int b = 0; b < a; b++) {
                const double *x = s.designs.row[i].x;
                assert_true(3 * a / 20 != 3 * b / 20 || x[a] == x[b]);
            }
    assert_less(s.n_left[s.designs.n - 1], s.n_left[0]);
}

/* A mass of that size at the roof changes little, links do: where a tenth may be lost the mass goes and links stay. */
TEST(links_and_the_tuned_mass_go_by_their_words_as_far_as_they_earn_little)
{
    write_in_place("d.ini", "[motion]\nrecord = builtin:kobe-like\npga_g = 0.3\nstretch = 3.1\n[sim]\nduration_s = 20\n"
                            "accuracy = coarse\n[design]\nvariables = gaps, thickness, links, tuned_mass\n"
                            "devices = gap, link, none\ndevice_zones = 4\ngap_zones = 1\nlink_zones = 1\n"
                            "mass_kg = 1, 1e5\n[search]\npolish = 0\nobjectives = j1_m, devices\ninitial = "
                            "8\npopulation = 8\nmax_evals = 8\n");
    write_in_place("d.csv", "gap_m,t_base_m,t_top_m,link_n_s_m,tuned_mass_kg,tuned_mass_hz,tuned_mass_damping,"
                            "device_zone_1,device_zone_2,device_zone_3,device_zone_4,device_roof\n"
                            "9,0.02,0.02,7e5,10,0.3,0.1,gap,link,link,link,tuned_mass\n");
    free(output_of("optimize @/d.ini --out @/d --set search.start=@/d.csv"));
    FREED char *said = output_of("simplify @/d --design 1 --keep j1_m=10%%");
    assert_words(said, "as it is: 21, ", "idle ones gone: 16, ");
    const char *fewer = strstr(said, "fewer devices: ");
    const int left = fewer ? atoi(strchr(fewer, ':') + 1) : 99;
    assert_true(left == 5 || left == 10 || left == 15);
    assert_words(said, "device_zone_1       none\n", "device_roof         none\n");
}

/* Whoever asks for the same once more gets the same answer, and the run keeps one design of it. */
TEST(a_second_time_it_is_the_design_of_the_first)
{
    FREED char *before = all_of("run");
    FOR_EACH (const char *, again, "simplify @/run --gap-step 10mm --plates 8,12,20,30 --keep j1_m=5%",
              "simplify @/run --design 41 --gap-step 10mm --plates 8,12,20,30 --keep j1_m=0") {
        assert_words_in(output_of("%s", *again), "it is design 41 of the run: nothing new to store");
    }
    assert_text(all_of("run"), before);
}

/* The best one on steps is there, marked; the --keep that is named leads to a design that keeps it. */
TEST(what_loses_too_much_is_stored_and_named_with_the_keep_that_would_do)
{
    OWNED(forget) Said said;
    free(output_of("optimize @/run --new --out @/again"));
    run(&said, "simplify @/again --plates 8 --keep j1_m=0.1%% --json");
    assert_int_equal(said.code, 69);
    OWNED(run_free) Run now = run_in("again");
    const Evaluation *last = &now.table.row[now.table.n - 1];
    assert_int_equal(last->kind, KIND_POLISHED);
    assert_non_null(strstr(last->reason, " beyond --keep"));
    json_auto_t *out = json_loads(said.out, 0, NULL);
    const json_t *path = json_object_get(out, "path"), *end = json_array_get(path, json_array_size(path) - 1);
    const double loses = number(end, "j1_m") / number(json_array_get(path, 0), "j1_m") - 1;
    const char *at = strstr(said.err, "--keep j1_m=");
    assert_non_null(at);
    const double keep = strtod(at + strlen("--keep j1_m="), NULL);
    assert_true(keep >= loses && keep < loses + 1.1e-3);
    assert_words(said.err, brief("the best design on these steps is design %ld, but j1_m loses ", last->id));
    free(output_of("simplify @/again --plates 8 --keep j1_m=%g", keep));
}

TEST(what_cannot_be_simplified_says_so_by_its_status)
{
    expect(69, "j1_m loses ", "simplify @/run --plates 8 --keep j1_m=0.1%");
    expect(2, "--zones", "simplify @/run --zones 21");
}

SUITE_FILLED(make_place, make_run, end_run)
