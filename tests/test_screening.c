/* Screening: which designs are evaluated by the cheap level alone, and what becomes of them. */
#include <float.h>

#include "base/hash.h"
#include "moga/levels.h"
#include "searches.h"

enum { VAR = 5, OBJ = 3, PARTS = 4, CHEAP = 1, EVALS = 40, ROWS_MAX = 400 };

/* Four replicates of a function, of which the first is the cheap level; or a cheap level apart, by whose bias any answer of
 * it dominates any whole one, and the function. */
typedef struct {
    Problem problem;
    double lower[VAR], upper[VAR];
    double noise;     /* of a replicate */
    int is_unrelated; /* the first replicate is noise alone and not in the mean */
    double penalty;   /* at both levels where x1 is above 0.7; 0: none */
    int is_flat;      /* the last objective of the whole evaluation is 1 */
    size_t n_tasks, n_cheap_tasks;
    EvaluationTable done; /* in the order of the numbers */
} World;

typedef struct {
    double f[OBJ];
} Part;

/* In -1..1, of x, part and objective. */
static double noise_of(const double x[], size_t part, size_t k)
{
    const uint64_t keys[] = {hash_fnv1a(x, VAR * sizeof *x, HASH_SEED), part, k};
    const uint64_t h = hash_fnv1a(keys, sizeof keys, HASH_SEED) * 0x9E3779B97F4A7C15u;
    return (double)(h >> 11) * 0x1p-52 - 1.0;
}

static Part part_of(const World *w, const double x[], size_t part)
{
    Part p;
    for (size_t k = 0; k < OBJ; k++) {
        p.f[k] = 0.0;
        for (size_t d = 0; d < VAR; d++) /* distance from a corner of the first objectives */
            p.f[k] += pow(x[d] - (d == k ? 1.0 : 0.2 * (double)k), 2.0);
        p.f[k] = (w->is_unrelated && part == 0 ? 0.0 : p.f[k]) + w->noise * noise_of(x, part, k);
        p.f[k] = w->is_flat && part > 0 && k == OBJ - 1 ? 1.0 : p.f[k];
        p.f[k] = w->penalty > 0.0 && x[0] > 0.7 ? w->penalty : p.f[k];
    }
    return p;
}

static Status simulate(void *self, size_t worker, const Task *task, Err *why)
{
    World *w = self;
    (void)worker;
    (void)why;
#pragma omp atomic
    w->n_tasks++;
    if (task->part == 0) {
#pragma omp atomic
        w->n_cheap_tasks++;
    }
    *(Part *)task->result = part_of(w, task->x, task->part);
    return STATUS_OK;
}

static void mean_of(const World *w, size_t first, size_t n, const Part parts[], double f[])
{
    (void)w;
    for (size_t k = 0; k < OBJ; k++) {
        f[k] = 0.0;
        for (size_t i = first; i < n; i++)
            f[k] += parts[i].f[k] / (double)(n - first);
    }
}

static void combine(const Problem *p, size_t n, const void *parts, Evaluation *e)
{
    const World *w = p->self;
    mean_of(w, n > CHEAP && (w->is_unrelated || w->is_flat) ? 1 : 0, n, parts, e->f);
}

static const Simulator SIMULATOR = {.simulate = simulate, .combine = combine};

static Status note_done(const Evaluation *e, void *user, Err *why)
{
    World *w = user;
    return evaluation_table_append(&w->done, e, why);
}

static void open_world(World *w, size_t n_workers)
{
    *w = (World){.noise = 0.05, .done = evaluation_table(VAR, OBJ, 0)};
    for (size_t d = 0; d < VAR; d++)
        w->upper[d] = 1.0;
    w->problem = (Problem){.n_var = VAR,
                           .n_obj = OBJ,
                           .lower = w->lower,
                           .upper = w->upper,
                           .simulator = &SIMULATOR,
                           .self = w,
                           .n_parts = PARTS,
                           .n_cheap = CHEAP,
                           .part_size = sizeof(Part),
                           .n_workers = n_workers,
                           .observer = {.done = note_done, .user = w}};
}

static SearchConfig config_of(void)
{
    SearchConfig c = search_config(7, 12, 600);
    c.max_evals = EVALS;
    c.fidelity = FIDELITY_REPLICATES;
    return c;
}

typedef struct {
    World *world;
    Moments moments;
    size_t n, n_evaluations, n_screened, n_finished, views;
    double agreement;
    unsigned char kind[ROWS_MAX], on_front[ROWS_MAX];
    size_t generation[ROWS_MAX];
    double Y[ROWS_MAX * OBJ];
} Screened;

/* No view shows a screened design on the front, and the front is what is nondominated among the other rows. */
static void check_front(const SearchView *v)
{
    for (size_t i = 0; i < v->all->n; i++) {
        int is_dominated = 0;
        for (size_t j = 0; j < v->all->n; j++)
            is_dominated |=
                v->all->kind[j] != KIND_SCREENED && dominates(OBJ, v->all->Y + j * OBJ, v->all->Y + i * OBJ);
        assert_int_equal(v->all->on_front[i], v->all->kind[i] != KIND_SCREENED && !is_dominated);
    }
}

static int observe(const SearchView *v, const SearchTime *time, void *user)
{
    Screened *s = user;
    (void)time;
    assert_at_most(v->all->n, ROWS_MAX);
    check_front(v);
    s->views++;
    s->n = v->all->n;
    s->n_evaluations = v->n_evaluations;
    s->agreement = v->level_agreement;
    s->n_screened = s->n_finished = 0;
    for (size_t i = 0; i < v->all->n; i++) {
        s->n_screened += v->all->kind[i] == KIND_SCREENED;
        s->n_finished += v->all->kind[i] == KIND_FINISHED;
    }
    memcpy(s->kind, v->all->kind, v->all->n);
    memcpy(s->on_front, v->all->on_front, v->all->n);
    memcpy(s->generation, v->all->generation, v->all->n * sizeof *v->all->generation);
    memcpy(s->Y, v->all->Y, v->all->n * OBJ * sizeof *v->all->Y);
    moments_note(&s->moments, v);
    return 0;
}

static void run(World *w, Screened *s, const SearchStart *start)
{
    const SearchConfig config = config_of();
    StopReason reason;
    s->world = w;
    CHECK_OK(search_run(&w->problem, &config, start, observe, s, &reason, &err), &err);
    assert_int_equal(reason, STOP_EVALUATIONS);
}

static World world, other_world;
static Screened seen, other;

static void forget(World *w, Screened *s)
{
    moments_free(&s->moments);
    evaluation_table_free(&w->done);
}

static int set_up(void **state)
{
    linalg_pin();
    (void)state;
    open_world(&world, 1);
    run(&world, &seen, NULL);
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    forget(&world, &seen);
    forget(&other_world, &other);
    return 0;
}

/* Another world, in place of the one before. */
static void open_other(size_t n_workers)
{
    forget(&other_world, &other);
    memset(&other, 0, sizeof other);
    open_world(&other_world, n_workers);
}

static void assert_same_search(void)
{
    assert_int_equal(other.n, seen.n);
    assert_memory_equal(other.kind, seen.kind, seen.n);
    assert_memory_equal(other.on_front, seen.on_front, seen.n);
    assert_memory_equal(other.Y, seen.Y, seen.n * OBJ * sizeof *seen.Y);
    assert_int_equal(other.moments.n_state[other.moments.n - 1], seen.moments.n_state[seen.moments.n - 1]);
    assert_memory_equal(other.moments.state[other.moments.n - 1], seen.moments.state[seen.moments.n - 1],
                        seen.moments.n_state[seen.moments.n - 1]);
}

/* observe has looked at every view. */
TEST(no_screened_design_is_on_the_front)
{
    assert_true(seen.views > 5 && seen.n_screened > 90 && seen.n_finished > 15);
    assert_int_equal(seen.n, seen.n_screened + seen.n_finished);
}

TEST(every_simulation_is_made_once_and_counts_as_its_part_of_an_evaluation)
{
    assert_int_equal(world.n_tasks, seen.n_screened * CHEAP + seen.n_finished * (PARTS - CHEAP));
    assert_int_equal(seen.n_evaluations, world.n_tasks / PARTS);
    assert_true(world.n_tasks <= EVALS * PARTS && world.n_tasks + PARTS > EVALS * PARTS);
}

TEST(a_finished_design_has_the_bytes_of_one_evaluated_at_once)
{
    for (size_t i = 0; i < seen.n; i++) {
        const Evaluation *e = &world.done.row[i];
        Part parts[PARTS];
        double f[OBJ];
        for (size_t k = 0; k < PARTS; k++)
            parts[k] = part_of(&world, e->x, k);
        mean_of(&world, 0, seen.kind[i] == KIND_SCREENED ? CHEAP : PARTS, parts, f);
        assert_memory_equal(e->f, f, sizeof f);
        assert_memory_equal(seen.Y + i * OBJ, f, sizeof f); /* what was evaluated, not what is predicted */
    }
}

TEST(four_workers_make_the_bytes_of_one)
{
    open_other(4);
    run(&other_world, &other, NULL);
    assert_same_search();
}

/* As records in the order in which they speak for all: parts 2, 0, 3, 1. */
TEST(parts_taken_in_another_order_make_the_same_whole_and_another_cheap_level)
{
    static const size_t ORDER[PARTS] = {2, 0, 3, 1};
    open_other(1); /* of which the rows are done in the order of their numbers */
    other_world.problem.order = ORDER;
    run(&other_world, &other, NULL);
    assert_true(other.n_screened > 90 && other.n_finished > 15);
    for (size_t i = 0; i < other.n; i++) {
        const Evaluation *e = &other_world.done.row[i];
        const int is_screened = other.kind[i] == KIND_SCREENED;
        Part parts[PARTS];
        double f[OBJ];
        for (size_t k = 0; k < PARTS; k++)
            parts[k] = part_of(&other_world, e->x, is_screened ? ORDER[0] : k);
        mean_of(&other_world, 0, is_screened ? CHEAP : PARTS, parts, f);
        assert_memory_equal(other.Y + i * OBJ, f, sizeof f);
    }
}

/* At the end of a generation, and in the middle of the next one: what was screened is known, its simulations are not. */
TEST(resumed_anywhere_it_makes_the_same_bytes)
{
    const Moments *m = &seen.moments;
    for (size_t i = 0; i < seen.n; i++) {
        world.done.row[i].kind = (EvaluationKind)seen.kind[i];
        world.done.row[i].generation = (long)seen.generation[i];
    }
    for (size_t k = 0; k + 1 < m->n; k += 1 + m->n / 6) {
        const size_t later = (m->rows[k + 1] - m->rows[k]) * (k % 2) / 2;
        const SearchStart start = {
            .n = m->rows[k], .n_later = later, .row = world.done.row, .state = m->state[k], .n_state = m->n_state[k]};
        open_other(1);
        run(&other_world, &other, &start);
        assert_same_search();
    }
}

/* Row i is one of the sample, and a later one has all of its simulations. */
static int is_finished(const World *w, const Screened *s, size_t i)
{
    const size_t n = w->done.n_var;
    for (size_t j = i + 1; j < s->n; j++)
        if (s->kind[j] == KIND_FINISHED && memcmp(w->done.row[i].x, w->done.row[j].x, n * sizeof(double)) == 0)
            return 1;
    return 0;
}

TEST(levels_that_do_not_agree_turn_it_off)
{
    size_t later = 0, n_lost = 0;
    open_other(1);
    other_world.is_unrelated = 1;
    other_world.noise = 1.0;
    run(&other_world, &other, NULL);
    for (size_t i = 0; i < other.n; i++) {
        n_lost += other.generation[i] == 0 && !is_finished(&other_world, &other, i);
        later += other.kind[i] == KIND_SCREENED && other.generation[i] > 0;
    }
    assert_at_most(n_lost, 1);                      /* of the sample, for which no evaluation is left */
    assert_at_most(later, 2 * AHEAD);               /* until the first pairs, asked for behind the sample, are there */
    assert_at_most(EVALS, other.n_evaluations + 1); /* what was screened in vain may leave a part of one */
}

TEST(an_objective_that_is_the_same_for_all_designs_does_not_speak_against_the_cheap_level)
{
    open_other(1);
    other_world.is_flat = 1;
    other_world.noise = 0.0;
    run(&other_world, &other, NULL);
    assert_true(other.n_screened > 3 * LEVEL_PAIRS && other.agreement > 0.999);
}

TEST(penalties_whose_squares_overflow_do_not_end_a_search_with_levels)
{
    static const double PENALTIES[] = {1e160, 1e300, DBL_MAX};
    for (size_t i = 0; i < 3; i++) {
        open_other(1);
        other_world.penalty = PENALTIES[i];
        other_world.noise = 0.0;
        run(&other_world, &other, NULL);
        assert_less(3 * LEVEL_PAIRS, other.n_screened);
    }
}

/* Of sixteen parts one is cheap: more designs are asked for than evaluations are paid for. */
TEST(a_search_with_levels_has_room_for_more_designs_than_evaluations)
{
    SearchConfig c = config_of();
    StopReason reason;
    c.max_evals = 512;
    open_other(1);
    other_world.problem.n_parts = 16;
    CHECK_OK(search_run(&other_world.problem, &c, NULL, NULL, NULL, &reason, &err), &err);
    assert_less(1.2 * (double)c.max_evals, (double)other_world.done.n);
}

/* y = 2 + 3 y_cheap + d(x) for PAIRS designs at random, and the root mean square error of predictions at others, as a
 * share of what the line alone would leave. */
enum { PAIRS = 60 };

static double share_left(const World *w, int is_biased, double (*unseen)(const double x[]))
{
    static double x[2 * PAIRS][VAR], cheap[2 * PAIRS], whole[2 * PAIRS];
    const double *at[PAIRS];
    double left = 0.0, all = 0.0, y;
    Levels *levels;
    for (size_t i = 0; i < 2 * PAIRS; i++) {
        for (size_t d = 0; d < VAR; d++)
            x[i][d] = 0.5 + 0.5 * noise_of((const double[VAR]){(double)i}, d, 7);
        cheap[i] = noise_of(x[i], 0, 1);
        whole[i] = 2.0 + 3.0 * cheap[i] + unseen(x[i]);
        at[i % PAIRS] = x[i % PAIRS];
    }
    CHECK_OK(levels_fit(&levels, &w->problem, is_biased, PAIRS, 1, at, cheap, whole, &err), &err);
    for (size_t i = PAIRS; i < 2 * PAIRS; i++) {
        levels_predict(levels, x[i], cheap + i, &y);
        left += (y - whole[i]) * (y - whole[i]);
        all += unseen(x[i]) * unseen(x[i]);
    }
    levels_free(levels);
    return sqrt(left / all);
}

static double of_region(const double x[])
{
    return sin(3.0 * x[0]) * x[1] - 0.35;
}

static double of_nothing(const double x[])
{
    return noise_of(x, 3, 3);
}

TEST(what_the_line_between_levels_leaves_is_learned_where_designs_explain_it)
{
    open_other(1);
    assert_less(share_left(&other_world, 1, of_region), 0.35);
    assert_less(0.9, share_left(&other_world, 0, of_region));
    assert_less(share_left(&other_world, 1, of_nothing), 1.2);
}

TEST(without_a_cheap_level_nothing_is_screened)
{
    open_other(1);
    other_world.problem.n_cheap = 0;
    run(&other_world, &other, NULL);
    assert_int_equal(other.n, EVALS);
    assert_int_equal(other.n_screened + other.n_finished, 0);
    assert_int_equal(other_world.n_tasks, EVALS * PARTS);
}

SUITE(set_up, tear_down)
