/* A search that is asked and told: which questions come, and what they are made from, follows from their numbers alone,
 * whoever answers, in whatever order, and however often it is interrupted. */
#include "runs.h"
#include "searches.h"

enum { VAR = 5, OBJ = 2, ROWS_MAX = 400 };

typedef struct {
    Problem problem;
    SearchConfig config;
    double lower[VAR], upper[VAR];
    size_t n;
    double X[ROWS_MAX][VAR], F[ROWS_MAX][OBJ]; /* by number, as they were told */
    unsigned char kind[ROWS_MAX], ok[ROWS_MAX];
    StopReason reason;
} Told;

/* One design in 17 fails. */
static void answer(const double x[], double f[], Evaluation *e)
{
    textbook_dtlz2(VAR, OBJ, x, f);
    *e = (Evaluation){.f = f, .reason = "", .outcome = (size_t)(1e9 * x[0]) % 17 == 0 ? OUTCOME_ERROR : OUTCOME_OK};
}

static void prepare_search(Told *a, long ahead, size_t max_evals)
{
    memset(a, 0, sizeof *a);
    for (size_t d = 0; d < VAR; d++)
        a->upper[d] = 1.0;
    a->problem =
        (Problem){.n_var = VAR, .n_obj = OBJ, .lower = a->lower, .upper = a->upper, .n_parts = 1, .n_workers = 1};
    a->config = search_config(3, 24, 60);
    a->config.initial = 20;
    a->config.max_evals = max_evals;
    a->config.ahead = ahead;
}

typedef struct {
    size_t n, number[ROWS_MAX];
} Out;

/* All that may be asked now. 1: the search waits for answers; 0: it is over. */
static int ask_all(Told *a, Search *s, Out *out)
{
    for (SearchMove move = SEARCH_ASKS;;) {
        Question q;
        CHECK_OK(search_ask(s, &move, &q, &err), &err);
        if (move == SEARCH_ENDS || move == SEARCH_WAITS)
            return move == SEARCH_WAITS;
        if (move == SEARCH_STEPS)
            continue;
        assert_in_range(q.number, 1, ROWS_MAX);
        memcpy(a->X[q.number - 1], q.x, sizeof a->X[0]);
        a->kind[q.number - 1] = (unsigned char)q.kind;
        a->n = MAX_OF(a->n, q.number);
        out->number[out->n++] = q.number;
    }
}

static void tell(Told *a, Search *s, Out *out, size_t i)
{
    Evaluation e;
    const size_t number = out->number[i];
    answer(a->X[number - 1], a->F[number - 1], &e);
    a->ok[number - 1] = e.outcome == OUTCOME_OK;
    CHECK_OK(search_tell(s, number, &e, NULL, &err), &err);
    memmove(out->number + i, out->number + i + 1, (--out->n - i) * sizeof *out->number);
}

static Search *search_from(Told *a, const SearchStart *start)
{
    Search *s;
    CHECK_OK(search_create(&s, &a->problem, &a->config, start, &err), &err);
    return s;
}

/* Told one, or `together`, at a time, the first ones or any. */
static void run_told(Told *a, size_t together, uint32_t shuffled)
{
    Search *s = search_from(a, NULL);
    Random r = random_stream(shuffled, RANDOM_TEST, 0, 0);
    Out out = {0};
    while (ask_all(a, s, &out))
        for (size_t i = 0; i < together && out.n > 0; i++)
            tell(a, s, &out, shuffled ? random_below(&r, out.n) : 0);
    a->reason = search_look(s).reason;
    assert_true(out.n == 0 && search_look(s).all->n == a->n);
    search_free(s);
}

static void assert_same_questions(const Told *a, const Told *b)
{
    assert_int_equal(a->n, b->n);
    assert_memory_equal(a->X, b->X, a->n * sizeof a->X[0]);
    assert_memory_equal(a->kind, b->kind, a->n);
    assert_int_equal(a->reason, b->reason);
}

static Told once, again;

TEST(the_order_of_answers_changes_no_question)
{
    prepare_search(&once, -1, 200);
    run_told(&once, 1, 0);
    assert_int_equal(once.n, 200);
    FOR_EACH (size_t, together, 1, 8, 40)
        for (uint32_t shuffled = 0; shuffled < 3; shuffled++) {
            prepare_search(&again, -1, 200);
            run_told(&again, *together, shuffled);
            assert_same_questions(&once, &again);
        }
}

/* With answers that come in time or late: a question follows from those to all but the last `ahead` before its group. */
TEST(no_more_is_under_way_than_the_look_ahead_and_a_group)
{
    FOR_EACH (long, given, 0, 1, 7, 40) {
        Out out = {0};
        prepare_search(&once, *given, 120);
        Search *s = search_from(&once, NULL);
        while (ask_all(&once, s, &out)) {
            if (once.n > once.config.initial)
                assert_at_most(out.n, 2 * (size_t)*given + 1);
            tell(&once, s, &out, 0);
        }
        assert_int_equal(once.n, 120);
        search_free(s);
    }
}

/* At any moment: before questions are answered, between answers that came out of turn, behind a step. What was told and
 * has not entered is told again. */
TEST(a_search_that_is_interrupted_a_hundred_times_asks_the_same)
{
    prepare_search(&once, -1, 260);
    run_told(&once, 1, 0);
    prepare_search(&again, -1, 260);
    Random r = random_stream(9, RANDOM_TEST, 0, 0);
    Search *s = search_from(&again, NULL);
    Out out = {0};
    while (ask_all(&again, s, &out)) {
        for (size_t n = random_below(&r, 6); n > 0 && out.n > 0; n--)
            tell(&again, s, &out, random_below(&r, MIN_OF(out.n, 10)));
        if (random_below(&r, 3) > 0)
            continue;
        OWNED(evaluation_table_free) EvaluationTable rows = evaluation_table(VAR, OBJ, 0);
        const SearchView v = search_look(s);
        for (size_t i = 0; i < v.all->n; i++) {
            Evaluation e = {.kind = (EvaluationKind)v.all->kind[i],
                            .generation = (long)v.all->generation[i],
                            .outcome = v.all->ok[i] ? OUTCOME_OK : OUTCOME_ERROR,
                            .reason = "",
                            .x = v.all->X + i * VAR,
                            .f = v.all->Y + i * OBJ};
            CHECK_OK(evaluation_table_append(&rows, &e, &err), &err);
        }
        Search *next =
            search_from(&again, &(SearchStart){.n = rows.n, .row = rows.row, .state = v.state, .n_state = v.n_state});
        search_free(s);
        s = next;
        Out told = out, open = {0};
        assert_int_equal(ask_all(&again, s, &open), 1);
        for (size_t i = open.n; i-- > 0;) { /* those that were told before it was interrupted */
            int is_open = 0;
            for (size_t k = 0; k < told.n; k++)
                is_open |= told.number[k] == open.number[i];
            if (!is_open && open.number[i] <= again.n)
                tell(&again, s, &open, i);
        }
        out = open;
    }
    again.reason = search_look(s).reason;
    search_free(s);
    assert_same_questions(&once, &again);
}

TEST(what_was_not_asked_for_or_is_told_already_is_refused)
{
    Evaluation e;
    Out out = {0};
    prepare_search(&once, -1, 60);
    Search *s = search_from(&once, NULL);
    answer(once.lower, once.F[0], &e);
    assert_int_equal(search_tell(s, 1, &e, NULL, &err), STATUS_INTERNAL);
    assert_int_equal(ask_all(&once, s, &out), 1);
    tell(&once, s, &out, 3);
    assert_int_equal(search_tell(s, 4, &e, NULL, &err), STATUS_INTERNAL);
    assert_int_equal(search_tell(s, 0, &e, NULL, &err), STATUS_INTERNAL);
    assert_int_equal(search_tell(s, 10000, &e, NULL, &err), STATUS_INTERNAL);
    search_free(s);
}

/* Every tenth request takes 100 ms, the others 5. */
#define UNEVEN(max_evals)                                                                                              \
    "[problem]\nkind = external\ncommand = sh tests/worker.sh uneven\nvariables = 2\nobjectives = 2\n[search]\n"       \
    "population = 24\ninitial = 20\nthreads = 4\nsurrogate = off\nmax_evals = " max_evals "\n"

/* How many of 60 designs fail where the 30th is answered only after eight later ones have been asked for. */
static long failed_where_one_waits(const char *name, int tenths, const char *more)
{
    free(output_of("optimize @/uneven.ini --out @/%s --max-evals 60 --set 'problem.command=sh tests/worker.sh waits "
                   "@/%s.ids 38 %d' %s",
                   name, name, tenths, more));
    json_auto_t *o = as_json("status @/%s --json", name);
    const long failed = (long)number(o, "failed");
    assert_same_number(number(o, "simulated"), 60);
    return failed;
}

TEST(workers_of_uneven_speed_do_not_wait_for_each_other)
{
    write_in_place("uneven.ini", UNEVEN("120"));
    assert_int_equal(failed_where_one_waits("one_by_one", 5, "--set search.ahead=0"), 1);
    assert_int_equal(failed_where_one_waits("ahead", 600, ""), 0);
}

/* Long enough that it does not end between two commits. */
TEST(a_killed_run_goes_on_with_every_result_it_had)
{
    Run before, after;
    write_in_place("killed.ini", UNEVEN("400"));
    for (int kill_at = 10; kill_at < 110; kill_at += 90) {
        FREED char *name = formatted("killed%d", kill_at), *path = in_place(name);
        const pid_t pid = start("killed.ini", name);
        for (size_t n = 0; n < (size_t)kill_at; rest(0.01))
            if (run_read(&before, path, &err) == STATUS_OK) {
                n = before.table.n;
                run_free(&before);
            }
        kill(pid, SIGKILL);
        wait_end(pid);
        CHECK_OK(run_read(&before, path, &err), &err);
        assert_in_range(before.table.n, kill_at, 399);
        free(output_of("optimize %s", path));
        CHECK_OK(run_read(&after, path, &err), &err);
        assert_int_equal(after.table.n, 400);
        for (size_t i = 0; i < before.table.n; i++) {
            const size_t row = (size_t)before.table.row[i].id - 1;
            assert_memory_equal(before.table.row[i].x, after.table.row[row].x, 2 * sizeof(double));
            assert_same_number(before.table.row[i].seconds, after.table.row[row].seconds);
        }
        for (size_t i = 0; i < after.table.n; i++) {
            assert_int_equal(after.table.row[i].id, i + 1);
            assert_int_not_equal(after.table.row[i].kind, KIND_UNFINISHED);
        }
        run_free(&before);
        run_free(&after);
    }
}

SUITE(make_place, clear_place)
