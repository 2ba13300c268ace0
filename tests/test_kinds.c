/* Whole numbers, choices and logarithms: what is simulated, what is found, and the words that stand for choices. */
#include "runs.h"
#include "searches.h"

#include <math.h>

#include "evaluate/kinds.h"
#include "evaluate/textbook.h"
#include "moga/variation.h"

static Run run_of(const char *name)
{
    Run run;
    Err err = {0};
    char path[PATH_MAX];
    CHECK_OK(run_read(&run, path_of(name, path), &err), &err);
    return run;
}

/* Position by tenths; distance 0 where the second number is 5 and both choices stand for 1/2. */
#define SMALL                                                                                                          \
    "[problem]\nkind = dtlz2\nvariables = 4\nobjectives = 2\nkinds = int, int, choice:a|b|c|d|e, choice:u|v|w\n"       \
    "[search]\ninitial = 40\npopulation = 20\nthreads = 2\nstop_after = 0\n"

TEST(all_eleven_points_of_a_front_are_found_among_1815_designs)
{
    write_in_place("small.ini", SMALL "max_evals = 200\n");
    free(output_of("optimize @/small.ini --out @/small"));
    Run run = run_of("small");
    size_t found[11] = {0};
    for (size_t i = 0; i < run.n_front; i++) {
        const double *f = run_f(&run, run.front[i]);
        assert_less(fabs(hypot(f[0], f[1]) - 1.0), 1e-12);
        found[(int)run_x(&run, run.front[i])[0]]++;
    }
    run_free(&run);
    for (int k = 0; k <= 10; k++)
        assert_int_equal(found[k], 1);
}

TEST(no_design_is_simulated_twice_and_all_are_on_their_numbers_and_words)
{
    write_in_place("small.ini", SMALL "max_evals = 200\n");
    free(output_of("optimize @/small.ini --out @/twice"));
    Run run = run_of("twice");
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
    run_free(&run);
}

/* With fewer designs than simulations every one is simulated, and the search ends. */
TEST(a_space_smaller_than_the_budget_is_searched_whole)
{
    write_in_place("tiny.ini", "[problem]\nkind = dtlz2\nvariables = 2\nobjectives = 2\nkinds = int, choice:a|b\n"
                               "[search]\ninitial = 8\npopulation = 8\nmax_evals = 60\ngenerations = 200\n");
    free(output_of("optimize @/tiny.ini --out @/tiny"));
    assert_int_equal(finished_in("tiny"), 22);
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
    size_t words[4] = {0};
    Random r = random_stream(1, RANDOM_TEST, 0, 0);
    for (int i = 0; i < TRIES; i++) {
        double x[] = {3.0 - 1e-3, 1.2, 2, 0.7};
        mutate_discrete(&r, 4, kind, lower, upper, before, x);
        assert_true(x[0] == 2.0 && x[2] == 2.0 && x[3] == 0.7);
        words[(int)x[1]]++;
    }
    assert_int_equal(words[1], 0);
    for (int w = 0; w < 4; w++)
        if (w != 1)
            assert_less(fabs((double)words[w] / TRIES - 1.0 / 3.0), 0.04);
}

TEST(workers_and_files_have_the_words_and_a_start_is_read_from_them)
{
    write_in_place("words.ini", "[problem]\nkind = external\ncommand = sh tests/worker.sh words\nvariables = 2\n"
                                "objectives = 2\nlower = 9, 0\nupper = 0, 5\nkinds = choice:steel|oak, int\n"
                                "[search]\ninitial = 6\npopulation = 4\nmax_evals = 12\nthreads = 1\n");
    free(output_of("optimize @/words.ini --out @/words"));
    char path[PATH_MAX], *front = read_in_place("words/front.csv"), *all = json_export(path_of("words", path));
    assert_non_null(strstr(front, ",steel,0,1,0\n"));
    assert_non_null(strstr(front, ",oak,0,0,10\n"));
    assert_non_null(strstr(all, "\"x\":[\"oak\","));
    free(front);
    free(all);
    free(output_of("optimize @/words.ini --out @/again --set search.start=@/words/front.csv"));
    Run run = run_of("again");
    assert_true(run_x(&run, 0)[1] == 0.0 && run_x(&run, 1)[1] == 0.0);
    assert_true(run_x(&run, 0)[0] + run_x(&run, 1)[0] == 1.0);
    run_free(&run);
}

TEST(kinds_that_make_no_sense_are_refused_by_their_key)
{
    static const struct {
        const char *kinds, *lower, *upper, *message;
    } BAD[] = {
        {"real, int", "0", "1", "problem.kinds: 2 kinds for 3 variables"},
        {"whole", "0", "1", "problem.kinds: 'whole' is none of real, log, int, choice:WORD|WORD"},
        {"log", "0", "1", "problem.lower: is 0 for variable 1, which is log: set it above 0"},
        {"int", "0", "1.5", "0 and 1.5 of variable 1, which is int, are no whole numbers"},
        {"choice:", "0", "1", "problem.kinds: choice:: word 1 is empty"},
        {"choice:a||b", "0", "1", "word 2 is empty"},
        {"choice:a|b|a", "0", "1", "problem.kinds: choice:a|b|a names a twice"},
        {"choice:a|b\tc", "0", "1", "word 2 is empty"},
        {"choice:a|\xff", "0", "1", "word 2 is empty"},
        {"choice: a|b", "0", "1", "word 1 is empty"},
        {"choice:a|=1+1", "0", "1", "word 2 is empty"},
    };
    for (size_t i = 0; i < sizeof BAD / sizeof *BAD; i++) {
        VariableKind kind[3];
        double lower[3], upper[3];
        Err err = {0};
        for (int j = 0; j < 3; j++) {
            lower[j] = atof(BAD[i].lower);
            upper[j] = atof(BAD[i].upper);
        }
        assert_int_equal(kinds_read(BAD[i].kinds, 3, kind, lower, upper, &err), STATUS_BAD_DATA);
        assert_non_null(strstr(err.text, BAD[i].message));
    }
}

int main(void)
{
    return RUN_TESTS(prepare, clear_place);
}
