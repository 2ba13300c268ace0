/* Whole numbers, choices and logarithms: what is simulated, what is found, and the words that stand for choices. */
#include "runs.h"
#include "searches.h"

#include "analysis/baselines.h"
#include "evaluate/kinds.h"
#include "moga/variation.h"

/* DTLZ2 of two objectives and variables of other kinds, whole numbers of 0 to 10. */
#define MIXED(n_var, kinds)                                                                                            \
    "[problem]\nkind = external\ncommand = " TEXTBOOK_WORKER " dtlz2 " #n_var " 2 0 1 '" kinds                         \
    "'\nvariables = " #n_var "\nobjectives = 2\nupper = 10\nkinds = " kinds "\n"

/* Position by tenths; distance 0 where the second number is 5 and both choices stand for 1/2. */
#define SMALL                                                                                                          \
    MIXED(4, "int, int, choice:a|b|c|d|e, choice:u|v|w")                                                               \
    "[search]\ninitial = 40\npopulation = 20\nthreads = 2\nstop_after = 0\n"

TEST(all_eleven_points_of_a_front_are_found_among_1815_designs)
{
    write_in_place("small.ini", SMALL "max_evals = 200\n");
    free(output_of("optimize @/small.ini --out @/small"));
    OWNED(run_free) Run run = run_in("small");
    size_t found[11] = {0};
    for (size_t i = 0; i < run.n_front; i++) {
        const double *f = run_f(&run, run.front[i]);
        assert_less(fabs(hypot(f[0], f[1]) - 1.0), 1e-12);
        found[(int)run_x(&run, run.front[i])[0]]++;
    }
    for (int k = 0; k <= 10; k++)
        assert_int_equal(found[k], 1);
}

/* From any place, of a box whose ends are 0 and 12 and of values that are sold every 2.5, 20 in all. */
TEST(a_step_to_another_value_goes_to_a_neighbour_on_either_side_and_changes_nothing_else)
{
    static const double lower[] = {0, 0, 2.5}, upper[] = {1, 12, 50};
    static const VariableKind kind[] = {VARIABLE_REAL, VARIABLE_WHOLE, VARIABLE_STEPPED};
    static const Steps steps[3] = {[2] = {.n = 20, .first = 1, .step = 2.5}};
    const Problem p = {.n_var = 3, .lower = lower, .upper = upper, .kind = kind, .steps = steps};
    const double width[] = {0, 1, 2.5};
    Random r = random_stream(1, RANDOM_TEST, 0, 0);
    for (size_t d = 1; d < 3; d++)
        for (double at = lower[d]; at <= upper[d]; at += width[d]) {
            int n_below = 0, n_above = 0;
            for (int i = 0; i < 100; i++) {
                const double from[] = {0.3, d == 1 ? at : 4, d == 2 ? at : 10};
                double x[3];
                step_discrete(&r, &p, d, from, x);
                assert_true(x[d] == at - width[d] || x[d] == at + width[d]);
                assert_true(x[0] == from[0] && x[3 - d] == from[3 - d]);
                n_below += x[d] < at;
                n_above += x[d] > at;
            }
            assert_true((n_below > 0) == (at > lower[d]) && (n_above > 0) == (at < upper[d]));
        }
}

TEST(no_design_is_simulated_twice_and_all_are_on_their_numbers_and_words)
{
    write_in_place("small.ini", SMALL "max_evals = 200\n");
    free(output_of("optimize @/small.ini --out @/twice"));
    OWNED(run_free) Run run = run_in("twice");
    const double most[] = {10, 10, 4, 2};
    for (size_t i = 0; i < run.table.n; i++) {
        const double *x = run_x(&run, i);
        for (size_t j = 0; j < 4; j++)
            assert_true(x[j] == floor(x[j]) && x[j] >= 0.0 && x[j] <= most[j]);
        for (size_t k = 0; k < i; k++) {
            const double *y = run_x(&run, k);
            assert_true(x[0] != y[0] || x[1] != y[1] || x[2] != y[2] || x[3] != y[3]);
        }
    }
    assert_int_equal(run.table.n, 200);
}

TEST(samples_give_every_number_and_word_the_same_share_and_logarithms_every_decade)
{
    enum { N = 300, WORDS = 3 };
    const VariableKind kind[] = {VARIABLE_WHOLE, VARIABLE_CHOICE, VARIABLE_LOG};
    const double lower[] = {-2, 0, 1e-3}, upper[] = {2, 2, 1};
    const Problem p = {.n_var = 3, .kind = kind, .lower = lower, .upper = upper};
    double X[N * 3];
    size_t slices[N], count[3][5] = {0};
    latin_hypercube(5, 0, N, 3, X, slices);
    for (size_t i = 0; i < N; i++) {
        count[0][(int)problem_spread(&p, 0, X[3 * i]) + 2]++;
        count[1][(int)problem_spread(&p, 1, X[3 * i + 1])]++;
        count[2][(int)(3.0 + log10(problem_spread(&p, 2, X[3 * i + 2])))]++;
    }
    for (int k = 0; k < 5; k++)
        assert_int_equal(count[0][k], N / 5);
    for (int k = 0; k < WORDS; k++) {
        assert_int_equal(count[1][k], N / WORDS);
        assert_int_equal(count[2][k], N / 3);
    }
}

TEST(a_mutated_number_moves_by_one_at_least_and_a_mutated_choice_to_any_other_word)
{
    enum { TRIES = 3000 };
    const VariableKind kind[] = {VARIABLE_WHOLE, VARIABLE_CHOICE, VARIABLE_CHOICE, VARIABLE_REAL};
    const double lower[4] = {0}, upper[] = {3, 3, 3, 1}, before[] = {3, 1, 2, 0.5};
    const Problem p = {.n_var = 4, .kind = kind, .lower = lower, .upper = upper};
    size_t words[4] = {0};
    Random r = random_stream(1, RANDOM_TEST, 0, 0);
    for (int i = 0; i < TRIES; i++) {
        double x[] = {3.0 - 1e-3, 1.2, 2, 0.7};
        mutate_discrete(&r, &p, before, x);
        assert_true(x[0] == 2.0 && x[2] == 2.0 && x[3] == 0.7);
        words[(int)x[1]]++;
    }
    assert_int_equal(words[1], 0);
    for (int w = 0; w < 4; w++)
        if (w != 1)
            assert_less(fabs((double)words[w] / TRIES - 1.0 / 3.0), 0.04);
}

TEST(a_value_that_is_sold_is_the_nearest_and_mutation_takes_another)
{
    const double sold[] = {0.008, 0.010, 0.012, 0.015, 0.020}, lower[] = {0.005, 0.008}, upper[] = {0.5, 0.020};
    const Steps steps[] = {{.n = 100, .first = 1, .step = 0.005}, {.n = N_OF(sold), .at = sold}};
    const VariableKind kind[] = {VARIABLE_STEPPED, VARIABLE_STEPPED};
    const Problem p = {.n_var = 2, .kind = kind, .steps = steps, .lower = lower, .upper = upper};
    Random r = random_stream(2, RANDOM_TEST, 0, 0);
    size_t seen[N_OF(sold)] = {0};
    for (int i = 0; i < 500; i++) {
        double x[] = {0.6 * random_uniform(&r), 0.03 * random_uniform(&r)}, before[2];
        const double wanted[] = {x[0], x[1]};
        problem_repair(&p, x);
        for (size_t k = 0; k < 100; k++)
            assert_true(fabs(x[0] - wanted[0]) <= fabs((double)(k + 1) / 200.0 - wanted[0]) + 1e-15);
        for (size_t k = 0; k < N_OF(sold); k++)
            assert_true(fabs(x[1] - wanted[1]) <= fabs(sold[k] - wanted[1]) + 1e-15);
        memcpy(before, x, sizeof before);
        x[0] += random_uniform(&r) < 0.5 ? 1e-6 : -1e-6;
        x[1] += random_uniform(&r) < 0.5 ? 1e-6 : -1e-6;
        mutate_discrete(&r, &p, before, x);
        assert_less(fabs(fabs(x[0] - before[0]) - 0.005), 1e-12);
        assert_true(x[1] != before[1]);
        seen[steps_nearest(&steps[1], problem_spread(&p, 1, ((double)i + 0.5) / 500.0))]++;
    }
    for (size_t k = 0; k < N_OF(sold); k++)
        assert_int_equal(seen[k], 100);
}

/* Gaps of 5 mm, five plates; of a study whose designs would differ by less than that at its end. */
TEST(a_tower_on_steps_is_simulated_on_them_alone_and_no_design_twice)
{
    write_in_place("steps.ini", SIX_FLOORS_INI
                   "[sim]\nduration_s = 4\n[design]\n"
                   "gap_zones = 2\nstep_gap_m = 0.005\nstep_thickness_m = 0.008, 0.01, 0.012, 0.015, 0.02\n"
                   "[search]\ninitial = 20\npopulation = 12\nmax_evals = 120\npolish = 0\n");
    free(output_of("optimize @/steps.ini --out @/steps --threads 1"));
    free(output_of("optimize @/steps.ini --out @/steps-2 --threads 2"));
    FREED char *one = all_of("steps"), *two = all_of("steps-2");
    assert_string_equal(one, two);
    OWNED(run_free) Run run = run_in("steps");
    for (size_t i = 0; i < run.table.n; i++) {
        const double *x = run_x(&run, i);
        for (int j = 0; j < 2; j++)
            assert_true(x[j] == round(200.0 * x[j]) / 200.0);
        for (int j = 2; j < 4; j++)
            assert_true(x[j] == 0.008 || x[j] == 0.01 || x[j] == 0.012 || x[j] == 0.015 || x[j] == 0.02);
        for (size_t k = 0; k < i; k++) {
            const double *y = run_x(&run, k);
            assert_true(x[0] != y[0] || x[1] != y[1] || x[2] != y[2] || x[3] != y[3]);
        }
    }
    assert_int_equal(run.table.n, 120);
    expect(65, "design.step_gap_m: no multiple of 0.9 lies within design.gap_m",
           "optimize @/steps.ini --out @/no --set design.step_gap_m=0.9");
    expect(65, "design.step_thickness_m: 0.01 stands behind 0.02; give them in ascending order",
           "optimize @/steps.ini --out @/no --set 'design.step_thickness_m=0.02, 0.01'");
}

/* Stops, links or nothing in two zones, a tuned mass or none at the roof. */
#define DEVICES                                                                                                        \
    SIX_FLOORS_INI                                                                                                     \
    "[design]\nvariables = gaps, thickness, links, tuned_mass\n"                                                       \
    "devices = gap, link, none\ngap_zones = 2\nlink_zones = 2\ndevice_zones = 2\nmass_hz = 0.05, 3\nmass_damping = "   \
    "0.01, 1\n[search]\npolish = 0\n"                                                                                  \
    "objectives = j1_m, j2_m, j3_g\ninitial = 12\npopulation = 12\nmax_evals = 36\n[sim]\nduration_s = 8\naccuracy = " \
    "coarse\n"

TEST(a_search_of_devices_starts_from_tuned_links_and_a_tuned_mass_and_never_ends_below_them)
{
    static const SceneKind KIND[] = {SCENE_LINKS, SCENE_TMD};
    Settings s = settings_of(DEVICES, "unused");
    OWNED(problem_close) Problem p;
    write_in_place("devices.ini", DEVICES);
    free(output_of("optimize @/devices.ini --out @/devices"));
    OWNED(run_free) Run run = run_in("devices");
    CHECK_OK(tower_open(&p, &s, TOWER_AS_SET, SIZE_MAX, &err), &err);
    for (size_t i = 0; i < 2; i++) {
        Baseline b[N_SCENES];
        const double *f = run_f(&run, i);
        CHECK_OK(baselines_find(&p, run_x(&run, i), 1, b, &err), &err);
        for (int k = 0; k < 3; k++)
            assert_close(f[k], b[KIND[i]].value[k], 1e-6);
        for (size_t j = 0; j < run.n_front; j++) {
            const double *of = run_f(&run, run.front[j]);
            assert_false(run.front[j] != i && f[0] <= of[0] && f[1] <= of[1] && f[2] <= of[2]);
        }
    }
}

TEST(devices_have_the_same_bytes_at_any_number_of_threads_and_after_a_kill)
{
    write_in_place("devices.ini", DEVICES);
    free(output_of("optimize @/devices.ini --out @/whole"));
    free(output_of("optimize @/devices.ini --out @/two --threads 2"));
    for (size_t least = 12; least < 24; least += 6) {
        const pid_t pid = start("devices.ini", "cut");
        while (finished_in("cut") < least)
            rest(0.02);
        kill(pid, SIGKILL);
        wait_end(pid);
    }
    free(output_of("optimize @/devices.ini --out @/cut"));
    FREED char *all = all_of("whole"), *two = all_of("two"), *cut = all_of("cut");
    assert_string_equal(all, two);
    assert_string_equal(all, cut);
    assert_words(all, ",link,link,none,", ",none,none,tuned_mass,");
}

TEST(workers_and_files_have_the_words_and_a_start_is_read_from_them)
{
    write_in_place("words.ini", "[problem]\nkind = external\ncommand = sh tests/worker.sh words\nvariables = 2\n"
                                "objectives = 2\nlower = 9, 0\nupper = 0, 5\nkinds = choice:steel|oak, int\n"
                                "[search]\ninitial = 6\npopulation = 4\nmax_evals = 12\nthreads = 1\n");
    free(output_of("optimize @/words.ini --out @/words"));
    FREED char *front = read_in_place("words/front.csv"), *all = json_export(there("words"));
    assert_words(front, ",steel,0,1,0\n", ",oak,0,0,10\n");
    assert_words(all, "\"x\":[\"oak\",");
    free(output_of("optimize @/words.ini --out @/again --set search.start=@/words/front.csv"));
    OWNED(run_free) Run run = run_in("again");
    assert_true(run_x(&run, 0)[1] == 0.0 && run_x(&run, 1)[1] == 0.0);
    assert_true(run_x(&run, 0)[0] + run_x(&run, 1)[0] == 1.0);
}

TEST(kinds_that_make_no_sense_are_refused_by_their_key)
{
    static const struct {
        const char *kinds, *lower, *upper, *message;
    } BAD[] = {
        {"real, int", "0", "1", "problem.kinds: 2 kinds for 3 variables"},
        {"whole", "0", "1", "problem.kinds: 'whole' is none of real, log, int, list:NUMBER|NUMBER, choice:WORD|WORD"},
        {"log", "0", "1", "problem.lower: is 0 for variable 1, which is log: set it above 0"},
        {"int", "0", "1.5", "0 and 1.5 of variable 1, which is int, are no whole numbers"},
        {"choice:", "0", "1", "problem.kinds: choice:: word 1 is empty"},
        {"choice:a||b", "0", "1", "word 2 is empty"},
        {"choice:a|b|a", "0", "1", "problem.kinds: choice:a|b|a names a twice"},
        {"choice:a|b\tc", "0", "1", "word 2 is empty"},
        {"choice:a|\xff", "0", "1", "word 2 is empty"},
        {"choice: a|b", "0", "1", "word 1 is empty"},
        {"choice:a|=1+1", "0", "1", "word 2 is empty"},
        {"list:4||8", "0", "1", "problem.kinds: list:4||8: item 2 is no number"},
        {"list:4|5.5|inf", "0", "1", "item 3 is no number"},
        {"list:4|5m", "0", "1", "item 2 is no number"},
        {"list:4|8|5", "0", "1", "problem.kinds: list:4|8|5: 5 stands behind 8; give them in ascending order"}};
    for (size_t i = 0; i < sizeof BAD / sizeof *BAD; i++) {
        VariableKind kind[3];
        double bounds[6];
        FREED Steps *steps;
        for (int j = 0; j < 3; j++) {
            bounds[j] = atof(BAD[i].lower);
            bounds[3 + j] = atof(BAD[i].upper);
        }
        assert_refused(kinds_read(BAD[i].kinds, 3, kind, bounds, &steps, &err), STATUS_BAD_DATA, BAD[i].message);
    }
}

SUITE(prepare, clear_place)
