/* search.limits that nothing keeps: an outcome with a name, not a failure of the program. */
#include "runs.h"

#include "store/run.h"

/* f1 + f2 + f3 of dtlz2 is 1 at least on and above its front, the unit sphere: these limits cannot be kept. */
static const char UNMET[] = DTLZ2_INI(6, 3) "[search]\ninitial = 12\npopulation = 12\nmax_evals = 40\nthreads = 1\n"
                                            "limits = f1<=0.2,f2<=0.2,f3<=0.2\n";

static double missed(const double f[])
{
    double sum = 0.0;
    for (int k = 0; k < 3; k++)
        sum += fmax(0.0, (f[k] - 0.2) / 0.2);
    return sum;
}

TEST(limits_that_nothing_keeps_end_with_the_nearest_designs)
{
    OWNED(forget) Said s;
    write_in_place("unmet.ini", UNMET);
    run(&s, "optimize @/unmet.ini --out @/unmet");
    assert_int_equal(s.code, 69);
    assert_non_null(strstr(s.err, "none of 40 designs keeps f1<=0.2,f2<=0.2,f3<=0.2"));
    assert_non_null(strstr(s.out, "nearest.csv"));

    OWNED(table_free) Table nearest = table_of("unmet/nearest.csv");
    OWNED(run_free) Run all = run_in("unmet");
    assert_int_equal(nearest.n_rows, NEAREST_MAX);
    assert_int_equal(all.table.n, 40);
    double last = 0.0;
    for (size_t i = 0; i < nearest.n_rows; i++) {
        const double *row = nearest.values + i * nearest.n_cols;
        size_t nearer = 0;
        assert_close(row[1], missed(row + 8), 1e-9);
        assert_at_most(last, row[1]);
        last = row[1];
        for (size_t j = 0; j < all.table.n; j++)
            nearer += missed(all.F + j * 3) < row[1] - 1e-9;
        assert_at_most(nearer, i);
    }

    FREED char *front = read_in_place("unmet/front.csv");
    assert_string_equal(strchr(front, '\n'), "\n");
    FOR_EACH (const char *, use, "choose @/unmet", "report @/unmet", "report @/unmet --pictures @/p") {
        expect(69, "none of 40 designs keeps f1<=0.2,f2<=0.2,f3<=0.2", *use);
        expect(69, "unmet/nearest.csv", *use);
    }
}

TEST(the_nearest_are_in_the_order_of_what_they_miss_without_failed_and_screened_ones)
{
    static const double VIOLATION[] = {5, 3, 9, 3, 1, 8, 2, 7, 6, 4, 0.5, 11, 10, 2.5};
    static const size_t WANTED[] = {10, 4, 1, 3, 9, 0, 8, 7, 5, 2};
    enum { N = sizeof VIOLATION / sizeof VIOLATION[0] };
    Evaluation row[N];
    RunPlace at[N];
    size_t rows[NEAREST_MAX];
    for (size_t i = 0; i < N; i++) {
        row[i] =
            (Evaluation){.id = (long)i + 1, .violation = VIOLATION[i], .kind = i == 13 ? KIND_SCREENED : KIND_SAMPLED};
        at[i] = (RunPlace){.ok = i != 6};
    }
    const Run h = {.table = {.n = N, .row = row}, .place = at};
    assert_int_equal(run_nearest(&h, rows), NEAREST_MAX);
    assert_memory_equal(rows, WANTED, sizeof WANTED);
    const Run few = {.table = {.n = 3, .row = row}, .place = at};
    assert_int_equal(run_nearest(&few, rows), 3);
    assert_int_equal(rows[0], 1);
    assert_int_equal(rows[2], 2);
}

static size_t simulated_shown;

static void see_progress(const StudyProgress *p, void *user)
{
    (void)user;
    assert_null(p->view);
    simulated_shown = p->progress.simulated;
}

/* Of the front how far its best design is behind f1 0.2, f2 0.2, f3 0.6 of whichever it is most behind: on the unit sphere
 * (0.2 + t)^2 + (0.2 + t)^2 + (0.6 + t)^2 = 1 gives t = 0.21235. */
static double most_behind(const char *name)
{
    OWNED(table_free) Table t = table_of(brief("%s/front.csv", name));
    double best = INFINITY;
    for (size_t i = 0; i < t.n_rows; i++) {
        const double *f = t.values + i * t.n_cols + table_column(&t, "f1");
        best = fmin(best, fmax(fmax(f[0] - 0.2, f[1] - 0.2), f[2] - 0.6));
    }
    return best;
}

TEST(a_search_with_levels_comes_near_them_in_150_evaluations_and_without_they_are_passed_by)
{
    write_in_place("plain.ini", DTLZ2_INI(8, 3));
    free(output_of("optimize @/plain.ini --out @/wished --max-evals 150 --set 'search.aspire=f1 0.2, f2 0.2,f3 0.6'"));
    free(output_of("optimize @/plain.ini --out @/plain --max-evals 150"));
    assert_less(most_behind("wished"), 0.21235 + 0.015);
    assert_less(0.21235, most_behind("wished"));
    assert_less(0.21235 + 0.02, most_behind("plain"));
}

TEST(levels_leave_limits_as_they_are_and_are_the_same_bytes_at_any_number_of_threads)
{
    write_in_place("levels.ini", DTLZ2_INI(6, 3) "[search]\nmax_evals = 120\n"
                                                 "aspire = f1 0.5,f2 0.1\nlimits = f1<=0.3\n");
    free(output_of("optimize @/levels.ini --out @/one --threads 1"));
    free(output_of("optimize @/levels.ini --out @/three --threads 3"));
    FREED char *one = read_in_place("one/front.csv"), *three = read_in_place("three/front.csv");
    assert_string_equal(one, three);
    OWNED(table_free) Table t = table_of("one/front.csv");
    assert_less(5, t.n_rows);
    for (size_t i = 0; i < t.n_rows; i++)
        assert_at_most(t.values[i * t.n_cols + table_column(&t, "f1")], 0.3);
    expect(65, "search.aspire: item 2 of 'f1 0.5,f2' is not NAME NUMBER",
           "optimize @/levels.ini --out @/no --set 'search.aspire=f1 0.5,f2'");
    expect(65, "search.aspire: f4 is no objective", "optimize @/levels.ini --out @/no --set 'search.aspire=f4 0.5'");
    expect(65, "search.aspire: f1 is given twice",
           "optimize @/levels.ini --out @/no --set 'search.aspire=f1 0.5,f1 0.2'");
}

TEST(a_run_without_a_front_says_why_there_is_none)
{
    const Settings s = settings_of(UNMET, "begun");
    StudySummary summary;
    assert_int_equal(study_run(&s, &(StudyOptions){.stop = stop_after, .progress = see_progress, .user = &(int){5}},
                               &summary, NULL, &err),
                     STATUS_STOPPED);
    assert_true(summary.n_simulated > 0 && summary.n_simulated < 12);
    assert_in_range(simulated_shown, 1, summary.n_simulated);
    FREED char *wanted = formatted("before the initial sample is complete; %zu designs", summary.n_simulated);
    expect(65, wanted, "choose @/begun");
    expect(65, wanted, "report @/begun");

    write_in_place("deaf.ini", DEAF);
    expect(70, "none of 8 simulations succeeded", "optimize @/deaf.ini --out @/failed --set problem.command=false");
    expect(70, "none of 8 simulations succeeded; 8 failed with: ", "choose @/failed");
    expect(70, "none of 8 simulations succeeded", "report @/failed");
}

SUITE(prepare, clear_place)
