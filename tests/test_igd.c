/* IGD+ and what is said of it while a run goes on. */
#include "runs.h"

#include "base/random.h"
#include "moga/hypervolume.h"
#include "study/improvement.h"

enum { M = 3, N = 300, REF = 150 };

/* The definition, word for word. */
static double brute_force(size_t n_ref, const size_t ref[], size_t n, const double F[], const unsigned char counts[])
{
    double least[M], most[M], sum = 0.0;
    for (int k = 0; k < M; k++) {
        least[k] = INFINITY;
        most[k] = -INFINITY;
        for (size_t r = 0; r < n_ref; r++) {
            least[k] = fmin(least[k], F[ref[r] * M + k]);
            most[k] = fmax(most[k], F[ref[r] * M + k]);
        }
    }
    for (size_t r = 0; r < n_ref; r++) {
        double nearest = INFINITY;
        for (size_t i = 0; i < n; i++) {
            double square = 0.0;
            for (int k = 0; counts[i] && k < M; k++)
                square += pow(fmax(F[i * M + k] - F[ref[r] * M + k], 0.0) / (most[k] - least[k]), 2.0);
            if (counts[i])
                nearest = fmin(nearest, sqrt(square));
        }
        sum += nearest / (double)n_ref;
    }
    return sum;
}

static void test_two_points_by_hand(void **state)
{
    (void)state;
    static const double F[] = {0, 20, 1, 10}; /* widths 1 and 10 */
    const size_t rows[] = {0, 1};
    Igd *q;
    Err err = {0};
    CHECK_OK(igd_create(&q, 2, 2, rows, F, &err), &err);
    assert_true(isinf(igd_value(q)));
    igd_add(q, (double[]){0.5, 15});
    assert_close(igd_value(q), 0.5, 1e-15); /* half a width worse than either in one objective, better in the other */
    igd_add(q, (double[]){0.6, 16});
    assert_close(igd_value(q), 0.5, 1e-15); /* dominated: nothing changes */
    igd_add(q, (double[]){0.3, 14});
    assert_close(igd_value(q), 0.35, 1e-15); /* .3 of a width from the first, .4 from the second */
    igd_add(q, (double[]){-1, 5});
    assert_same_number(igd_value(q), 0.0);
    igd_free(q);
}

static void test_a_growing_set_is_that_of_the_definition(void **state)
{
    (void)state;
    static double F[N * M];
    size_t rows[REF];
    unsigned char all[N];
    Igd *q;
    Err err = {0};
    Random r = random_stream(3, RANDOM_TEST, 0, 0);
    for (size_t i = 0; i < N * M; i++)
        F[i] = random_uniform(&r);
    for (size_t i = 0; i < REF; i++)
        rows[i] = 2 * i;
    memset(all, 1, N);
    CHECK_OK(igd_create(&q, M, REF, rows, F, &err), &err);
    double last = INFINITY;
    for (size_t i = 0; i < N; i++) {
        igd_add(q, F + i * M);
        if (i % 60 == 7)
            assert_close(igd_value(q), brute_force(REF, rows, i + 1, F, all), 1e-12);
        assert_at_most(igd_value(q), last);
        last = igd_value(q);
    }
    assert_same_number(last, 0.0); /* the reference is among them */
    igd_free(q);
}

static void test_a_large_reference_is_thinned_evenly(void **state)
{
    (void)state;
    enum { MANY = 5 * IGD_REFERENCE_MAX };
    static double F[MANY];
    static size_t rows[MANY];
    Igd *q;
    Err err = {0};
    for (size_t i = 0; i < MANY; i++) {
        F[i] = (double)i;
        rows[i] = i;
    }
    CHECK_OK(igd_create(&q, 1, MANY, rows, F, &err), &err);
    igd_add(q, &(double){5.0 * (IGD_REFERENCE_MAX - 1)}); /* the last that is taken: the mean is half the range */
    assert_close(igd_value(q), 0.5, 1e-12);
    igd_free(q);
}

/* Every generation of a stored run with limits and noise, against the definition. */
static void test_the_advance_of_a_run_is_that_of_its_designs(void **state)
{
    (void)state;
    char path[PATH_MAX];
    Run h;
    Err err = {0};
    write_in_place("run.ini", TEXTBOOK);
    free(output_of("optimize @/run.ini --out @/run --threads 1"));
    CHECK_OK(run_read(&h, path_of("run", path), &err), &err);
    double *igd = calloc(h.n_generations, sizeof *igd);
    size_t *front = calloc(h.table.n, sizeof *front), n_front = 0;
    unsigned char *counts = calloc(h.table.n, 1);
    for (size_t i = 0; i < h.table.n; i++) {
        if (h.place[i].on_front)
            front[n_front++] = i;
        counts[i] = h.place[i].ok && !(h.table.row[i].violation > 0.0) && h.table.row[i].kind != KIND_REPEAT;
    }
    assert_true(n_front > 1 && n_front <= IGD_REFERENCE_MAX);
    CHECK_OK(improvement_of_run(&h, igd, &err), &err);
    for (size_t g = 0; g < h.n_generations; g++)
        assert_close(igd[g], brute_force(n_front, front, (size_t)h.generation[g].simulated, h.F, counts), 1e-12);
    assert_true(igd[0] > 0.0 && igd[h.n_generations - 1] == 0.0);

    json_t *o = json_of("status @/run --json");
    const json_t *first = json_array_get(json_object_get(o, "generations"), 0);
    assert_close(number(first, "igd_plus"), igd[0], 1e-12);
    const double share = number(first, "hypervolume");
    assert_close(number(first, "hypervolume_error"), sqrt(share * (1.0 - share) / HYPERVOLUME_SAMPLES), 1e-12);
    json_decref(o);

    char *log = read_in_place("run/log.jsonl");
    assert_non_null(strstr(log, "\"igd_plus\": "));
    assert_non_null(strstr(log, "\"hypervolume_error\": "));
    free(log);
    free(igd);
    free(front);
    free(counts);
    run_free(&h);
}

static void test_the_late_advance_leaves_out_the_last_tenth(void **state)
{
    (void)state;
    enum { ROWS = 20 };
    double F[ROWS * M], H[ROWS], igd;
    unsigned char ok[ROWS], on_front[ROWS] = {0}, counts[ROWS] = {0};
    size_t answers[ROWS];
    unsigned char kind[ROWS];
    Err err = {0};
    Random r = random_stream(4, RANDOM_TEST, 0, 0);
    for (size_t i = 0; i < ROWS * M; i++)
        F[i] = random_uniform(&r);
    for (size_t i = 0; i < ROWS; i++) {
        ok[i] = i != 3;
        H[i] = i == 4 ? 0.1 : -0.1;
        answers[i] = i != 5;
        kind[i] = i == 6 ? KIND_SCREENED : KIND_INFILL;
        counts[i] = i < 3 || i > 6;
    }
    const size_t front[] = {1, 17, 18, 19};
    for (size_t i = 0; i < 4; i++)
        on_front[front[i]] = 1;
    const SearchView v = {.n = ROWS,
                          .n_obj = M,
                          .n_con = 1,
                          .F = F,
                          .H = H,
                          .ok = ok,
                          .replicates = answers,
                          .kind = kind,
                          .on_front = on_front,
                          .n_front = 4};
    CHECK_OK(improvement_lately(&v, &igd, &err), &err);
    assert_close(igd, brute_force(4, front, 18, F, counts), 1e-12);
    const SearchView nobody = {.n = ROWS, .n_obj = M};
    CHECK_OK(improvement_lately(&nobody, &igd, &err), &err);
    assert_true(isnan(igd));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_two_points_by_hand),
        cmocka_unit_test(test_a_growing_set_is_that_of_the_definition),
        cmocka_unit_test(test_a_large_reference_is_thinned_evenly),
        cmocka_unit_test(test_the_advance_of_a_run_is_that_of_its_designs),
        cmocka_unit_test(test_the_late_advance_leaves_out_the_last_tenth),
    };
    return cmocka_run_group_tests_name("igd", tests, prepare, clear_place);
}
