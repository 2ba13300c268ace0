/* Where a search begins: with designs that somebody has, none of them twice. */
#include "runs.h"

static const char BEGIN[] = DTLZ2_INI(4, 2) "[search]\ninitial = 12\npopulation = 12\nmax_evals = 30\nthreads = 1\n";

/* In another order of columns, one outside the box, one given twice. */
static const char GIVEN[] = "x2,x1,comment,x4,x3\n0.2,0.1,7,0.4,0.3\n-3,0.5,7,0.5,9\n0.2,0.1,8,0.4,0.3\n1,1,7,1,1\n";
static const double WANTED[3][4] = {{0.1, 0.2, 0.3, 0.4}, {0.5, 0, 1, 0.5}, {1, 1, 1, 1}};

TEST(given_designs_come_first_inside_the_box_and_once)
{
    write_in_place("begin.ini", BEGIN);
    write_in_place("given.csv", GIVEN);
    free(output_of("optimize @/begin.ini --out @/off --set search.start=%s/given.csv", place.folder));
    OWNED(run_free) Run h = run_in("off");
    assert_int_equal(h.table.n, 30);
    assert_memory_equal(h.table.x, WANTED, sizeof WANTED);
    for (size_t i = 0; i < h.table.n; i++)
        for (size_t j = 0; j < i; j++)
            assert_memory_not_equal(h.table.x + i * 4, h.table.x + j * 4, 4 * sizeof *h.table.x);
    write_in_place("short.csv", "x1,x2,x4\n0,0,0\n");
    expect(65, "x3", brief("optimize @/begin.ini --out @/no --set search.start=%s/short.csv", place.folder));
}

TEST(several_starts_are_taken_one_behind_the_other)
{
    write_in_place("begin.ini", BEGIN);
    write_in_place("given.csv", GIVEN);
    write_in_place("more.csv", "x1,x2,x3,x4\n0.9,0.8,0.7,0.6\n0.1,0.2,0.3,0.4\n");
    free(output_of("optimize @/begin.ini --out @/earlier --set search.seed=2"));
    free(output_of("optimize @/begin.ini --out @/both --set search.start=%s/given.csv,%s/more.csv", place.folder,
                   place.folder));
    Run h = run_in("both");
    assert_memory_equal(h.table.x, WANTED, sizeof WANTED);
    assert_memory_equal(h.table.x + 12, ((double[]){0.9, 0.8, 0.7, 0.6}), 4 * sizeof(double));
    run_free(&h);
    free(output_of("optimize @/begin.ini --out @/after --set search.start=%s/more.csv,%s/earlier", place.folder,
                   place.folder));
    h = run_in("after");
    OWNED(run_free) Run earlier = run_in("earlier");
    assert_less(0, earlier.n_front);
    for (size_t i = 0; i < earlier.n_front && i < 10; i++)
        assert_memory_equal(run_x(&h, 2 + i), run_x(&earlier, earlier.front[i]), 4 * sizeof(double));
    run_free(&h);
}

static const char TOWER[] = SIX_FLOORS_INI "record = builtin:elcentro-like\nrecords = builtin:sylmar-like\n"
                                           "[sim]\nreplicates = 2\nduration_s = 4\n"
                                           "[search]\ninitial = 12\npopulation = 12\nmax_evals = 45\npolish = 0\n";

TEST(a_tower_under_records_with_replicates_has_the_same_rows_at_any_number_of_threads)
{
    write_in_place("tower.ini", TOWER);
    free(output_of("optimize @/tower.ini --out @/one --threads 1"));
    free(output_of("optimize @/tower.ini --out @/three --threads 3"));
    OWNED(run_free) Run one = run_in("one"), three = run_in("three");
    const size_t n = 45, n_var = one.schema.n_var, m = one.schema.n_obj;
    assert_true(one.table.n == n && three.table.n == n);
    assert_memory_equal(one.table.x, three.table.x, n * n_var * sizeof(double));
    assert_memory_equal(one.F, three.F, n * m * sizeof(double));
    assert_memory_equal(one.table.sd, three.table.sd, n * m * sizeof(double));
}

SUITE(prepare, clear_place)
