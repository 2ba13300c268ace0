#include "moga/archive.h"
#include "moga/credit.h"
#include "moga/directions.h"
#include "moga/normalisation.h"
#include "base/hypervolume.h"
#include "moga/infill.h"
#include "moga/nd_tree.h"
#include "moga/selection.h"
#include "moga/variation.h"
#include "wfg.h"

/* Numbers on a coarse grid, so that equal and dominated points are frequent. */
static void coarse_points(uint32_t seed, size_t n, size_t m, double F[])
{
    Random r = random_stream(seed, RANDOM_TEST, 0, 0);
    for (size_t i = 0; i < n * m; i++)
        F[i] = (double)random_below(&r, 6);
}

/* -- dominance ----------------------------------------------------------------------------------------------------- */

/* Peeling by definition: rank r are those that only points of lower rank dominate. */
TEST(nondominated_sort_equals_peeling_by_definition)
{
    enum { N = 60, SEEDS = 200 };
    double F[N * 4], violation[N];
    size_t rank[N], scratch[3 * N];
    for (uint32_t seed = 0; seed < SEEDS; seed++) {
        const size_t m = 1 + seed % 4;
        coarse_points(seed, N, m, F);
        for (size_t i = 0; i < N; i++)
            violation[i] = seed % 3 == 0 ? (double)(i % 3) : 0.0;
        const size_t layers = nondominated_sort(N, m, F, violation, rank, scratch);
        size_t most = 0;
        for (size_t i = 0; i < N; i++) {
            most = rank[i] > most ? rank[i] : most;
            int by_layer_above = rank[i] == 0;
            for (size_t j = 0; j < N; j++)
                if (dominates_constrained(m, F + j * m, violation[j], F + i * m, violation[i])) {
                    assert_less(rank[j], rank[i]);
                    by_layer_above |= rank[j] + 1 == rank[i];
                }
            assert_true(by_layer_above);
        }
        assert_int_equal(layers, most + 1);
    }
}

/* -- hypervolume --------------------------------------------------------------------------------------------------- */

static double exact(size_t n, size_t m, const double F[], double reference)
{
    double corner[8];
    for (size_t k = 0; k < m; k++)
        corner[k] = reference;
    return wfg_hypervolume(n, m, F, corner);
}

TEST(hypervolume_of_boxes_and_of_a_known_union)
{
    const double box[] = {0.5, 0.25, 0.0, 0.75};
    assert_close(exact(1, 4, box, 1.0), 0.5 * 0.75 * 1.0 * 0.25, 1e-14);
    const double stairs[] = {1, 3, 2, 2, 3, 1};
    assert_close(exact(3, 2, stairs, 4.0), 6.0, 1e-14);
    /* three slabs: 3 (1 . 2 . 2) - 3 (1 . 1 . 2) + 1 in the cube of side 2 */
    const double slabs[] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    assert_close(exact(3, 3, slabs, 2.0), 12.0 - 6.0 + 1.0, 1e-14);
    const double outside[] = {0.5, 3.0};
    assert_same_number(exact(1, 2, outside, 2.0), 0.0);
    assert_same_number(exact(0, 2, outside, 2.0), 0.0);
}

/* On integer coordinates the volume is the number of unit cells that some point covers. */
TEST(hypervolume_counts_the_cells_of_a_grid)
{
    double F[12 * 4];
    for (uint32_t seed = 0; seed < 100; seed++) {
        coarse_points(seed, 12, 4, F);
        size_t cells = 0;
        for (size_t cell = 0; cell < 6 * 6 * 6 * 6; cell++) {
            const double at[] = {(double)(cell % 6), (double)(cell / 6 % 6), (double)(cell / 36 % 6),
                                 (double)(cell / 216)};
            int covered = 0;
            for (size_t i = 0; i < 12; i++)
                covered |= F[i * 4] <= at[0] && F[i * 4 + 1] <= at[1] && F[i * 4 + 2] <= at[2] && F[i * 4 + 3] <= at[3];
            cells += (size_t)covered;
        }
        assert_close(exact(12, 4, F, 6.0), (double)cells, 1e-12);
    }
}

static void sphere_points(uint32_t seed, size_t n, size_t m, double F[])
{
    Random r = random_stream(seed, RANDOM_TEST, 1, 0);
    for (size_t i = 0; i < n; i++) {
        double square = 0.0;
        for (size_t k = 0; k < m; k++) {
            F[i * m + k] = fabs(random_normal(&r));
            square += F[i * m + k] * F[i * m + k];
        }
        for (size_t k = 0; k < m; k++)
            F[i * m + k] /= sqrt(square);
    }
}

TEST(hypervolume_ignores_order_and_never_shrinks_when_a_point_is_added)
{
    enum { N = 20, M = 5 };
    double F[N * M], G[N * M];
    for (uint32_t seed = 0; seed < 20; seed++) {
        sphere_points(seed, N, M, F);
        for (size_t i = 0; i < N; i++)
            memcpy(G + i * M, F + (N - 1 - i) * M, M * sizeof *F);
        assert_close(exact(N, M, G, 1.1), exact(N, M, F, 1.1), 1e-12);
        double last = 0.0;
        for (size_t n = 1; n <= N; n++) {
            const double now = exact(n, M, F, 1.1);
            assert_at_most(last * (1 - 1e-12), now);
            last = now;
        }
    }
}

TEST(the_estimate_is_within_four_standard_errors_of_the_exact_hypervolume)
{
    enum { N = 25, M = 7 };
    double F[N * M], lower[M] = {0}, reference[M];
    for (size_t k = 0; k < M; k++)
        reference[k] = 1.1;
    for (uint32_t seed = 0; seed < 10; seed++) {
        Hypervolume *estimate;
        sphere_points(seed, N, M, F);
        CHECK_OK(hypervolume_create(&estimate, M, lower, reference, seed, &err), &err);
        for (size_t i = 0; i < N; i++)
            hypervolume_add(estimate, F + i * M);
        const double share = hypervolume_share(estimate), error = hypervolume_error(share);
        assert_less(0.0, error);
        assert_less(fabs(share - exact(N, M, F, 1.1) / pow(1.1, M)), 4 * error);
        hypervolume_free(estimate);
    }
}

/* -- directions ---------------------------------------------------------------------------------------------------- */

static Directions lattice(size_t n_obj, size_t outer, size_t inner)
{
    Directions d;
    CHECK_OK(directions_create(&d, n_obj, outer, inner, &err), &err);
    return d;
}

/* As many of them as a population has members. */
static Directions lattice_for(size_t n_obj, size_t population)
{
    size_t outer, inner;
    directions_choose(n_obj, population, &outer, &inner);
    return lattice(n_obj, outer, inner);
}

TEST(reference_directions_are_as_many_as_binomials_say_and_lie_on_the_simplex)
{
    const struct {
        size_t m, outer, inner, n;
    } cases[] = {{2, 4, 0, 5}, {3, 12, 0, 91}, {7, 3, 1, 84 + 7}, {8, 3, 2, 120 + 36}, {1, 1, 0, 1}};
    for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++) {
        const size_t m = cases[c].m;
        OWNED(directions_free) Directions d = lattice(m, cases[c].outer, cases[c].inner);
        assert_int_equal(d.n, cases[c].n);
        for (size_t i = 0; i < d.n; i++) {
            double sum = 0.0;
            for (size_t k = 0; k < m; k++) {
                assert_at_most(0.0, d.W[i * m + k]);
                sum += d.W[i * m + k];
            }
            assert_close(sum, 1.0, 1e-14);
            for (size_t j = 0; j < i; j++)
                assert_memory_not_equal(d.W + i * m, d.W + j * m, m * sizeof *d.W);
        }
    }
}

TEST(directions_fill_the_population_asked_for)
{
    const size_t objectives[] = {2, 3, 5, 7, 10}, populations[] = {20, 92, 300};
    for (size_t i = 0; i < 5; i++)
        for (size_t j = 0; j < 3; j++) {
            size_t outer, inner;
            directions_choose(objectives[i], populations[j], &outer, &inner);
            OWNED(directions_free) Directions d = lattice(objectives[i], outer, inner);
            OWNED(directions_free) Directions next = lattice(objectives[i], outer + 1, 0);
            assert_at_most(d.n, populations[j]);
            assert_true(d.n >= objectives[i] && next.n > populations[j]);
        }
}

/* -- variation ----------------------------------------------------------------------------------------------------- */

/* A pair that is far from its bounds is spread evenly to both sides, so the mean of the children is that of the
 * parents; bounds one-sided would move it. */
TEST(crossover_stays_in_bounds_and_keeps_the_mean_of_the_parents)
{
    enum { PAIRS = 20000 };
    const double lower[] = {-5.0, 0.0, 2.0}, upper[] = {7.0, 1.0, 2.0};
    const double mother[] = {0.0, 0.0, 2.0}, father[] = {2.0, 0.9, 2.0};
    double sum = 0.0, a[3], b[3];
    size_t moved = 0;
    Random r = random_stream(1, RANDOM_TEST, 0, 0);
    for (int i = 0; i < PAIRS; i++) {
        crossover_sbx(&r, 3, lower, upper, 2.0, mother, father, a, b);
        for (size_t d = 0; d < 3; d++) {
            assert_true(a[d] >= lower[d] && a[d] <= upper[d]);
            assert_true(b[d] >= lower[d] && b[d] <= upper[d]);
        }
        sum += 0.5 * (a[0] + b[0]) / PAIRS;
        moved += a[0] != mother[0];
    }
    assert_less(fabs(sum - 1.0), 0.01);
    assert_less(fabs((double)moved / PAIRS - 0.5), 0.02);
}

TEST(mutation_stays_in_bounds_and_touches_the_wanted_share_of_variables)
{
    enum { TRIES = 20000 };
    const double lower[] = {-5.0, 0.0, 2.0}, upper[] = {7.0, 1.0, 2.0};
    Random r = random_stream(1, RANDOM_TEST, 0, 0);
    size_t touched = 0;
    double shift = 0.0;
    for (int i = 0; i < TRIES; i++) {
        double x[] = {1.0, 0.01, 2.0};
        mutate_polynomial(&r, 3, lower, upper, 0.25, 20.0, x);
        for (size_t d = 0; d < 3; d++)
            assert_true(x[d] >= lower[d] && x[d] <= upper[d]);
        touched += x[0] != 1.0;
        shift += (x[0] - 1.0) / 12.0 / TRIES;
    }
    assert_less(fabs((double)touched / TRIES - 0.25), 0.02);
    assert_less(fabs(shift), 1e-3);
}

TEST(a_latin_hypercube_has_one_sample_in_every_slice_of_every_variable)
{
    enum { N = 50, D = 6 };
    double X[N * D];
    size_t slices[N];
    latin_hypercube(3, 0, N, D, X, slices);
    for (size_t d = 0; d < D; d++) {
        size_t count[N] = {0};
        for (size_t i = 0; i < N; i++)
            count[(size_t)(N * X[i * D + d])]++;
        for (size_t k = 0; k < N; k++)
            assert_int_equal(count[k], 1);
    }
}

/* -- environmental selection --------------------------------------------------------------------------------------- */

/* The intercepts of points on the plane f1/2 + f2/4 + f3/10 = 1 are 2, 4 and 10, also after a shift. */
TEST(normalisation_finds_the_intercepts_of_a_plane)
{
    const double F[] = {12, 100, -5, 10, 104, -5, 10, 100, 5, 10.5, 101, 0};
    const size_t list[] = {0, 1, 2, 3};
    double ideal[3], width[3], plane[12];
    int pivot[3];
    Normalisation frame = {.n_obj = 3, .ideal = ideal, .width = width, .plane = plane, .pivot = pivot};
    normalisation_fit(&frame, 4, list, F);
    assert_close(width[0], 2, 1e-9);
    assert_close(width[1], 4, 1e-9);
    assert_close(width[2], 10, 1e-9);
    assert_close(ideal[2], -5, 1e-12);
}

TEST(selection_keeps_the_wanted_number_the_best_layers_and_the_corners_of_the_front)
{
    enum { N = 200, M = 3, KEEP = 40 };
    double F[N * M];
    size_t chosen[N], rank[N], scratch[3 * N];
    OWNED(directions_free) Directions d = lattice_for(M, KEEP);
    FREED Selection *s;
    CHECK_OK(selection_create(&s, N, &d, NULL, &err), &err);
    for (uint32_t seed = 0; seed < 50; seed++) {
        sphere_points(seed, N, M, F);
        for (size_t i = 0; i < N; i++)
            for (size_t k = 0; k < M; k++)
                F[i * M + k] *= (i % 4 == 0 ? 2.0 : 1.0) * (k == 0 ? 1e4 : 1.0);
        for (size_t k = 0; k < M; k++)
            for (size_t j = 0; j < M; j++)
                F[k * M + j] = j != k ? 0.0 : k == 0 ? 1e4 : 1.0;
        Random random = random_stream(seed, RANDOM_NICHING, 0, 0);
        const size_t n = selection_select(s, N, F, NULL, KEEP, &random, chosen);
        assert_int_equal(n, KEEP);
        assert_true(chosen[0] == 0 && chosen[1] == 1 && chosen[2] == 2);
        nondominated_sort(N, M, F, NULL, rank, scratch);
        size_t worst_kept = 0, best_left = N;
        for (size_t i = 0, j = 0; i < N; i++) {
            const int kept = j < n && chosen[j] == i;
            j += (size_t)kept;
            if (kept && rank[i] > worst_kept)
                worst_kept = rank[i];
            if (!kept && rank[i] < best_left)
                best_left = rank[i];
        }
        assert_at_most(worst_kept, best_left);
    }
    assert_int_equal(selection_select(s, 5, F, NULL, KEEP, &(Random){0}, chosen), 5);
}

TEST(feasible_designs_survive_before_infeasible_ones)
{
    enum { N = 30, M = 2 };
    double F[N * M], violation[N];
    size_t chosen[N];
    OWNED(directions_free) Directions d = lattice(M, 9, 0);
    FREED Selection *s;
    CHECK_OK(selection_create(&s, N, &d, NULL, &err), &err);
    for (size_t i = 0; i < N; i++) { /* the infeasible ones would dominate */
        F[i * M] = (double)i;
        F[i * M + 1] = i < 20 ? -(double)i : 100.0 - (double)i;
        violation[i] = i < 20 ? 1.0 + (double)i : 0.0;
    }
    assert_int_equal(selection_select(s, N, F, violation, 12, &(Random){0}, chosen), 12);
    assert_int_equal(chosen[0], 0); /* the two least violating, then all ten feasible ones */
    assert_int_equal(chosen[1], 1);
    for (size_t i = 2; i < 12; i++)
        assert_int_equal(chosen[i], 18 + i);
}

/* n^2 of them at most: it was n^3. */
TEST(thousands_of_designs_are_selected_in_seconds)
{
    enum { M = 7, WANTED = 3000, N = 2 * WANTED };
    FREED double *F = calloc(N * M, sizeof *F);
    FREED size_t *selected = calloc(N, sizeof *selected);
    OWNED(directions_free) Directions d = lattice_for(M, WANTED);
    FREED Selection *s;
    Random r = random_stream(1, RANDOM_TEST, 0, 0);
    assert_true(F && selected);
    sphere_points(1, N, M, F); /* none dominates another */
    CHECK_OK(selection_create(&s, N, &d, NULL, &err), &err);
    const clock_t begun = clock();
    assert_int_equal(selection_select(s, N, F, NULL, WANTED, &r, selected), WANTED);
    assert_at_most((double)(clock() - begun) / CLOCKS_PER_SEC, 5.0);
}

/* -- archive and infill -------------------------------------------------------------------------------------------- */

/* Of stream number `seed`: on a coarse grid with ties, free, or near a sphere where few are dominated; every fifth point is
 * an earlier one again. */
static void make_stream(uint32_t seed, size_t n, size_t m, double F[])
{
    Random r = random_stream(seed, RANDOM_TEST, 2, 0);
    for (size_t i = 0; i < n; i++) {
        double square = 0.0;
        for (size_t k = 0; k < m; k++) {
            F[i * m + k] = seed % 2 ? (double)random_below(&r, 2 + seed % 7) : random_uniform(&r);
            square += (F[i * m + k] + 1e-3) * (F[i * m + k] + 1e-3);
        }
        for (size_t k = 0; k < m && seed % 3 == 0; k++)
            F[i * m + k] = (F[i * m + k] + 1e-3) / sqrt(square) * (seed % 6 ? 1.0 : 1.0 + 0.1 * random_uniform(&r));
        for (size_t k = 0; k < m && seed % 10 == 8; k++) /* so large that their differences, or squares, are none */
            F[i * m + k] = seed % 20 == 8 ? (F[i * m + k] - 0.5) * 1.7e308 : F[i * m + k] * 1e300;
        if (i > 0 && random_below(&r, 5) == 0)
            memcpy(F + i * m, F + random_below(&r, i) * m, m * sizeof *F);
    }
}

static void insert_by_definition(size_t m, const double F[], size_t row, unsigned char in[])
{
    in[row] = 1;
    for (size_t j = 0; j < row && in[row]; j++)
        in[row] = !(in[j] && dominates(m, F + j * m, F + row * m));
    for (size_t j = 0; j < row && in[row]; j++)
        in[j] = in[j] && !dominates(m, F + row * m, F + j * m);
}

TEST(the_tree_of_the_front_equals_brute_force_on_200_streams)
{
    enum { N = 400, M_MAX = 10 };
    static double F[N * M_MAX];
    for (uint32_t seed = 0; seed < 200; seed++) {
        const size_t m = 2 + seed % (M_MAX - 1);
        unsigned char in[N] = {0}, wanted[N] = {0};
        NdTree *t;
        NdChange change;
        make_stream(seed, N, m, F);
        CHECK_OK(nd_tree_create(&t, m, &err), &err);
        for (size_t i = 0; i < N; i++) {
            CHECK_OK(nd_tree_insert(t, F, i, &change, &err), &err);
            in[i] = change.is_in != 0;
            for (size_t j = 0; j < change.n_removed; j++) {
                assert_int_equal(in[change.removed[j]], 1);
                in[change.removed[j]] = 0;
            }
            insert_by_definition(m, F, i, wanted);
            assert_memory_equal(in, wanted, N);
        }
        nd_tree_free(t);
    }
}

TEST(front_flags_equal_a_brute_force_filter_after_every_insertion)
{
    enum { N = 80, M = 3 };
    double F[N * M], G[N], X[N];
    unsigned char ok[N];
    for (uint32_t seed = 0; seed < 20; seed++) {
        OWNED(pareto_archive_free) Archive a;
        CHECK_OK(pareto_archive_init(&a, 3, 1, M, 1, &err), &err);
        coarse_points(seed, N, M, F);
        for (size_t i = 0; i < N; i++) {
            X[i] = (double)i;
            G[i] = i % 7 == 3 ? 0.5 : -1.0;
            ok[i] = i % 10 != 4;
        }
        F[20 * M] = NAN; /* counts as failed */
        for (size_t i = 0; i < N; i++) {
            CHECK_OK(pareto_archive_insert(&a, X + i, F + i * M, G + i, ok[i], KIND_SAMPLED, i, &err), &err);
            size_t n_front = 0;
            for (size_t j = 0; j <= i; j++) {
                int wanted = ok[j] && G[j] <= 0.0 && j != 20;
                for (size_t l = 0; l <= i && wanted; l++)
                    wanted = !(ok[l] && G[l] <= 0.0 && l != 20 && dominates(M, F + l * M, F + j * M));
                assert_int_equal(a.on_front[j], wanted);
                n_front += (size_t)wanted;
            }
            assert_int_equal(a.n_front, n_front);
        }
        assert_int_equal(a.n_failed, 8 + 1);
        assert_int_equal(pareto_archive_find(&a, X + 33), 33);
        assert_int_equal(pareto_archive_find(&a, (const double[]){0.5}), N);
    }
}

TEST(a_batch_spreads_over_the_directions_instead_of_crowding)
{
    const double front[] = {2, 0, 0, 2, 1.5, 1.5};
    const size_t rows[] = {0, 1, 2};
    /* two twins near the middle, one smaller gain elsewhere, one without any gain, one that is infeasible */
    const double offered[] = {0.5, 0.5, 0.5, 0.5, 1.6, 0.1, 3, 3, 0, 0};
    const double violation[] = {0, 0, 0, 0, 1}, uncertainty[] = {0.1, 0.1, 0.1, 0.2, 0.3};
    unsigned char allowed[] = {1, 1, 1, 1, 1};
    OWNED(directions_free) Directions d = lattice(2, 10, 0);
    FREED Infill *q;
    CHECK_OK(infill_create(&q, INFILL_PBI, 5, &d, NULL, &err), &err);
    infill_measure(q, 3, rows, front);
    assert_same_number(infill_distance(q, front), 0.0);
    assert_less(0.0, infill_distance(q, offered + 6));
    infill_offer(q, 5, offered, violation, uncertainty, NULL);
    assert_int_equal(infill_pick(q, allowed), 0);
    assert_int_equal(infill_pick(q, allowed), 2);
    assert_int_equal(infill_pick(q, allowed), 3); /* the least certain of those without gain */
    assert_int_equal(infill_pick(q, allowed), 1);
    assert_int_equal(infill_pick(q, allowed), 4);
    assert_same_number(infill_pick(q, allowed), SIZE_MAX);
    const double chance[] = {0.01, 0.01, 0.9, 1, 1e-6}; /* the smaller gain that is nearly sure comes first */
    memset(allowed, 1, sizeof allowed);
    infill_measure(q, 3, rows, front);
    infill_offer(q, 5, offered, violation, uncertainty, chance);
    assert_int_equal(infill_pick(q, allowed), 2);
    assert_int_equal(infill_pick(q, allowed), 0);
    assert_int_equal(infill_pick(q, allowed), 4); /* infeasible most likely, but the one with a gain */
}

TEST(picks_are_those_of_gains_computed_anew_each_time)
{
    enum { N = 60, M = 3, SEEDS = 200 };
    double F[N * M], violation[N], uncertainty[N];
    size_t rows[N], taken[2 * N];
    for (uint32_t seed = 0; seed < SEEDS; seed++) {
        unsigned char allowed[N], asked[N];
        OWNED(directions_free) Directions d = lattice(M, 5, 0);
        FREED Infill *lazy, *anew;
        Random r = random_stream(seed, RANDOM_TEST, 1, 0);
        coarse_points(seed, N, M, F);
        for (size_t i = 0; i < N; i++) {
            rows[i] = i;
            violation[i] = seed % 3 == 0 ? (double)random_below(&r, 2) : 0.0;
            uncertainty[i] = (double)random_below(&r, 3);
            allowed[i] = random_below(&r, 8) > 0;
        }
        CHECK_OK(infill_create(&lazy, (InfillKind)(seed % 2), N, &d, NULL, &err), &err);
        CHECK_OK(infill_create(&anew, (InfillKind)(seed % 2), N, &d, NULL, &err), &err);
        infill_measure(lazy, 5, rows, F);
        infill_offer(lazy, N, F, violation, uncertainty, NULL);
        for (size_t k = 0, n = 0; k < N; k++) {
            infill_measure(anew, 5, rows, F);
            infill_offer(anew, N, F, violation, uncertainty, NULL);
            for (size_t i = 0; i < n; i++)
                infill_take(anew, taken[i]);
            memcpy(asked, allowed, sizeof asked);
            const size_t wanted = infill_pick(anew, asked), picked = infill_pick(lazy, allowed);
            assert_same_number(picked, wanted);
            if (picked != SIZE_MAX)
                taken[n++] = picked;
            if (k % 4 == 0) { /* the other criterion's */
                taken[n] = random_below(&r, N);
                infill_take(lazy, taken[n++]);
            }
        }
    }
}

/* The chosen are farther apart than twice as many drawn at random are in the mean, and the axes are there. */
TEST(spread_directions_have_the_axes_and_keep_apart)
{
    for (size_t m = 2; m <= 7; m++) {
        OWNED(directions_free) Directions d;
        const size_t n = 40;
        CHECK_OK(directions_spread(&d, m, n, &err), &err);
        double least = INFINITY;
        for (size_t i = 0; i < n; i++) {
            double sum = 0.0;
            for (size_t k = 0; k < m; k++) {
                assert_at_most(0.0, d.W[i * m + k]);
                assert_true(i >= m || d.W[i * m + k] == (i == k));
                sum += d.W[i * m + k];
            }
            assert_close(sum, 1.0, 1e-12);
            for (size_t j = 0; j < i; j++) {
                double apart = 0.0;
                for (size_t k = 0; k < m; k++)
                    apart += (d.W[i * m + k] - d.W[j * m + k]) * (d.W[i * m + k] - d.W[j * m + k]);
                least = fmin(least, sqrt(apart));
            }
        }
        /* in two objectives 40 on a line of length sqrt(2); in more there is more room */
        assert_less((m == 2 ? 0.35 * sqrt(2.0) / 39 : 0.05), least);
    }
}

/* The mean over rays of length^m, spread over the positive sphere, is the hypervolume up to a constant: of two sets the
 * one with the greater rays has the greater hypervolume. Here the ratio is known: boxes of edge 1 and 1/2. */
TEST(the_lengths_of_rays_measure_the_hypervolume)
{
    const double front[] = {0, 0.5, 1, 1, 0, 0.5, 0.5, 1, 0}; /* 0..1 in every objective */
    OWNED(directions_free) Directions d;
    FREED Infill *q;
    CHECK_OK(directions_spread(&d, 3, 300, &err), &err);
    CHECK_OK(infill_create(&q, INFILL_HYPERVOLUME, 2, &d, NULL, &err), &err);
    infill_measure(q, 3, (const size_t[]){0, 1, 2}, front);
    double unused[3], ratio = 0.0;
    for (size_t r = 3; r < d.n; r++) {
        const double one = infill_slope(q, r, (const double[]){0.1, 0.1, 0.1}, unused);
        const double half = infill_slope(q, r, (const double[]){0.6, 0.6, 0.6}, unused);
        assert_close(one / half, 2.0, 1e-9);
        ratio += pow(one / half, 3.0) / (double)(d.n - 3);
    }
    assert_close(ratio, 8.0, 1e-6);
}

TEST(the_slope_of_pbi_equals_differences)
{
    enum { M = 4, ROWS = 30 };
    double F[ROWS * M], slope[M];
    size_t rows[ROWS];
    Random r = random_stream(5, RANDOM_TEST, 0, 0);
    for (size_t i = 0; i < ROWS; i++) {
        rows[i] = i;
        for (size_t k = 0; k < M; k++)
            F[i * M + k] = (double)(k + 1) * random_uniform(&r);
    }
    OWNED(directions_free) Directions d;
    FREED Infill *q;
    CHECK_OK(directions_spread(&d, M, 12, &err), &err);
    CHECK_OK(infill_create(&q, INFILL_PBI, ROWS, &d, NULL, &err), &err);
    infill_measure(q, ROWS, rows, F);
    for (size_t direction = 0; direction < d.n; direction++) {
        double f[M], unused[M];
        assert_less(infill_best(q, direction), ROWS);
        for (size_t k = 0; k < M; k++)
            f[k] = 0.3 + random_uniform(&r);
        infill_slope(q, direction, f, slope);
        for (size_t k = 0; k < M; k++) {
            const double at = f[k], h = 1e-6;
            f[k] = at + h;
            const double up = infill_slope(q, direction, f, unused);
            f[k] = at - h;
            const double down = infill_slope(q, direction, f, unused);
            f[k] = at;
            assert_less(fabs(slope[k] - (up - down) / (2 * h)), 1e-6);
        }
    }
}

/* By either measure the second one's designs add four times as much each, of which it has fewer. */
TEST(the_criterion_whose_designs_add_more_is_preferred_and_nothing_is_learnt_from_one_alone)
{
    Credit c = {0.5, 0.5};
    const CreditResults alone = {{{9, 0}, {3, 0}}, {6, 0}}, both = {{{6, 4}, {3, 2}}, {6, 1}};
    credit_learn(&c, &alone);
    assert_true(c.gain == 0.5 && c.designs == 0.5);
    credit_learn(&c, &both);
    assert_close(c.gain, 0.5 + 0.1 * (0.6 - 0.5), 1e-15);
    assert_close(c.designs, 0.5 + 0.1 * (6.0 / 7.0 - 0.5), 1e-15);
    assert_false(credit_prefers_first(&c));
}

SUITE(NULL, NULL)
