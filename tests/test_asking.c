/* A search that is asked and told (include/imtet.h): the designs of `imtet optimize`, whatever happens in between; and
 * calls that make no sense. */
#include "runs.h"

#include "bench/textbook.h"
#include "imtet.h"

enum { ROWS_MAX = 200, VAR_MAX = 6, OBJ_MAX = 3, CON_MAX = 2, ASKED_MAX = 64 };

/* Minimised f, g and NULL, or why it failed, of design number id. */
typedef const char *(*AnswerFn)(long id, const double x[], double f[], double g[]);

typedef struct {
    const char *name, *ini, *kinds, *aspire;
    size_t n_var, n_obj, n_con, n;
    double upper;
    AnswerFn answer;
} Exercise;

static const char *answer_dtlz2(long id, const double x[], double f[], double g[])
{
    (void)id;
    (void)g;
    textbook_dtlz2(6, 3, x, f);
    return NULL;
}

/* tests/worker.sh, as the words of its first argument. */
static const char *answer_bounded(long id, const double x[], double f[], double g[])
{
    (void)id;
    f[0] = x[0];
    f[1] = 20 - x[0] + x[1] + (x[2] == 1 ? 3 : 0);
    g[0] = 6 - x[0];
    g[1] = x[0] + x[1] - 15;
    return NULL;
}

static const char *answer_tenth(long id, const double x[], double f[], double g[])
{
    (void)g;
    f[0] = x[0];
    f[1] = x[1];
    return id % 10 == 0 ? "every tenth" : NULL;
}

static const char *answer_parabola(long id, const double x[], double f[], double g[])
{
    (void)id, (void)g;
    f[0] = x[0];
    f[1] = (5 - x[0]) * (5 - x[0]);
    return NULL;
}

#define WORKER(mode, kinds)                                                                                            \
    "[problem]\nkind = external\ncommand = sh tests/worker.sh " mode "\nvariables = 3\nobjectives = 2\nupper = 20\n"   \
    "kinds = " kinds "\n"
#define SEARCH "[search]\ninitial = 16\npopulation = 12\nmax_evals = 40\nthreads = 1\n"
#define SPHERE DTLZ2_INI(6, 3) SEARCH
#define WISH   "f1 0.2,f2 0.2,f3 0.6"

static const Exercise EXERCISES[] = {
    {"dtlz2", SPHERE, "real", "none", 6, 3, 0, 40, 1, answer_dtlz2},
    {"wished", SPHERE "aspire = " WISH "\n", "real", WISH, 6, 3, 0, 40, 1, answer_dtlz2},
    {"bounded", WORKER("bounded", "int, int, choice:a|b") SEARCH, "int,int,choice:a|b", "none", 3, 2, 2, 40, 20,
     answer_bounded},
    {"tenth", WORKER("tenth", "real") SEARCH, "real", "none", 3, 2, 0, 40, 20, answer_tenth}};

/* What the last call said of its fault. */
static imtet_error error;

static void must(imtet_status status)
{
    if (status != IMTET_OK)
        fail_msg("%s", error.text);
}

static void assert_says(imtet_status status, imtet_status wanted, const char *words)
{
    if (status != wanted || !strstr(error.text, words))
        fail_msg("status %d (wanted %d), said: %s; wanted: %s", (int)status, (int)wanted, error.text, words);
    assert_int_equal(error.status, wanted);
}

static imtet_search *search_of(const Exercise *e)
{
    const char *aspire = brief("search.aspire=%s", e->aspire);
    const char *const settings[] = {
        "search.initial=16", "search.population=12", "search.max_evals=40", "search.threads=1", aspire, NULL};
    double upper[VAR_MAX];
    imtet_search *s;
    for (size_t j = 0; j < e->n_var; j++)
        upper[j] = e->upper;
    const imtet_search_options o = {.size = sizeof o,
                                    .variables = e->n_var,
                                    .objectives = e->n_obj,
                                    .constraints = e->n_con,
                                    .upper = upper,
                                    .kinds = e->kinds,
                                    .settings = settings};
    must(imtet_search_create(&o, &s, &error));
    return s;
}

/* -- the same designs as `imtet optimize` -------------------------------------------------------------------------- */

typedef struct {
    size_t n;
    long id[ASKED_MAX];
    double X[ASKED_MAX * VAR_MAX];
} UnderWay;

static void save_and_load(imtet_search **s)
{
    char path[PATH_MAX];
    must(imtet_search_save(*s, path_of("saved", path), &error));
    imtet_search_free(s);
    assert_null(*s);
    must(imtet_search_load(path, s, &error));
}

/* Tells one of those that are under way, in the order of the dice. */
static void tell_one(imtet_search *s, const Exercise *e, UnderWay *u, Random *dice)
{
    const size_t i = dice ? random_below(dice, u->n) : 0;
    double f[OBJ_MAX], g[CON_MAX];
    const char *failed = e->answer(u->id[i], u->X + i * e->n_var, f, g);
    must(imtet_search_tell(s, 1, &u->id[i], f, g, &failed, &error));
    u->n--;
    memmove(&u->id[i], &u->id[i + 1], (u->n - i) * sizeof *u->id);
    memmove(u->X + i * e->n_var, u->X + (i + 1) * e->n_var, (u->n - i) * e->n_var * sizeof *u->X);
}

/* Asked in portions, told at once; with dice: in any portions and order, saved and loaded whenever they say so. */
static imtet_search *drive(const Exercise *e, size_t portion, Random *dice)
{
    imtet_search *s = search_of(e);
    UnderWay u = {0};
    size_t n;
    for (;;) {
        const size_t wanted = dice ? 1 + random_below(dice, 9) : portion;
        if (dice && random_below(dice, 6) == 0) {
            save_and_load(&s);
            u.n = 0; /* asked for again */
        }
        must(imtet_search_ask(s, MIN_OF(wanted, ASKED_MAX - u.n), u.id + u.n, u.X + u.n * e->n_var, &n, &error));
        u.n += n;
        if (u.n == 0)
            return s;
        for (size_t k = dice ? random_below(dice, u.n + 1) : u.n; k > 0; k--)
            tell_one(s, e, &u, dice);
    }
}

static void assert_same_designs(imtet_search *s, const Exercise *e, const Run *run)
{
    static long ids[ROWS_MAX];
    static double X[ROWS_MAX * VAR_MAX], F[ROWS_MAX * OBJ_MAX], G[ROWS_MAX * CON_MAX];
    size_t n;
    must(imtet_search_designs(s, IMTET_TOLD, ROWS_MAX, ids, X, F, G, &n, &error));
    assert_int_equal(n, run->table.n);
    for (size_t i = 0; i < n; i++) {
        const Evaluation *row = &run->table.row[i];
        assert_int_equal(ids[i], row->id);
        assert_memory_equal(X + i * e->n_var, row->x, e->n_var * sizeof *X);
        if (row->outcome == OUTCOME_OK)
            assert_memory_equal(F + i * e->n_obj, row->f, e->n_obj * sizeof *F);
        else
            assert_true(isnan(F[i * e->n_obj]));
        for (size_t c = 0; c < e->n_con; c++)
            assert_same_number(G[i * e->n_con + c], row->extra[c]);
    }
    must(imtet_search_designs(s, IMTET_FRONT, ROWS_MAX, ids, NULL, NULL, NULL, &n, &error));
    assert_int_equal(n, run->n_front);
    for (size_t i = 0; i < n; i++)
        assert_int_equal(ids[i], run->table.row[run->front[i]].id);
}

/* The run of `imtet optimize`, made once for all tests. */
static Run optimized(const Exercise *e)
{
    write_in_place(brief("%s.ini", e->name), e->ini);
    if (access(there(e->name), F_OK) != 0)
        free(output_of("optimize @/%s.ini --out @/%s", e->name, e->name));
    const Run run = run_in(e->name);
    assert_int_equal(run.table.n, e->n);
    return run;
}

TEST(asked_in_any_portions_the_designs_and_the_front_are_those_of_optimize)
{
    for (size_t k = 0; k < N_OF(EXERCISES); k++) {
        OWNED(run_free) Run run = optimized(&EXERCISES[k]);
        FOR_EACH (size_t, portion, 1, 8, 64) {
            OWNED(imtet_search_free) imtet_search *s = drive(&EXERCISES[k], *portion, NULL);
            assert_same_designs(s, &EXERCISES[k], &run);
        }
    }
}

TEST(told_in_any_order_saved_and_loaded_anywhere_they_are_the_same)
{
    for (size_t k = 0; k < N_OF(EXERCISES); k++) {
        OWNED(run_free) Run run = optimized(&EXERCISES[k]);
        for (uint32_t seed = 0; seed < (SANITIZED ? 2 : 5); seed++) {
            Random dice = random_stream(seed, RANDOM_TEST, 0, 0);
            OWNED(imtet_search_free) imtet_search *s = drive(&EXERCISES[k], 0, &dice);
            assert_same_designs(s, &EXERCISES[k], &run);
        }
    }
}

TEST(answers_of_designs_that_were_under_way_when_it_was_saved_are_taken_by_the_one_that_loads_it)
{
    const Exercise *e = &EXERCISES[0];
    OWNED(imtet_search_free) imtet_search *s = search_of(e);
    UnderWay u = {0}, again = {0};
    const double F[OBJ_MAX] = {1, 1, 1};
    must(imtet_search_ask(s, 8, u.id, u.X, &u.n, &error));
    save_and_load(&s);
    for (size_t k = 0; k < 4; k++)
        tell_one(s, e, &u, NULL);
    must(imtet_search_ask(s, 8, again.id, again.X, &again.n, &error));
    assert_int_equal(again.id[0], 5);
    assert_memory_equal(again.X, u.X, 4 * e->n_var * sizeof *u.X);
    must(imtet_search_tell(s, 1, (const long[]){16}, F, NULL, NULL, &error)); /* it may have been asked for */
    must(imtet_search_ask(s, 8, again.id, again.X, &again.n, &error));
    assert_true(again.n == 3 && again.id[2] == 15); /* of the first sample */
    assert_says(imtet_search_tell(s, 1, (const long[]){17}, F, NULL, NULL, &error), IMTET_MISUSED,
                "no design has the id 17; 16 were asked for");
}

TEST(it_says_how_far_it_is_and_why_it_ends)
{
    imtet_search *s = drive(&EXERCISES[3], 8, NULL);
    imtet_search_state now = {.size = sizeof now};
    must(imtet_search_look(s, &now, &error));
    assert_true(now.done && now.told == 40 && now.failed == 4 && now.left == 0 && now.under_way == 0);
    assert_string_equal(now.why, "all simulations spent");
    imtet_search_free(&s);
    s = search_of(&EXERCISES[3]);
    double X[5 * 3];
    long ids[5];
    size_t n;
    must(imtet_search_ask(s, 5, ids, X, &n, &error));
    must(imtet_search_look(s, &now, &error));
    assert_true(!now.done && now.told == 0 && now.left == 35 && now.under_way == 5);
    imtet_search_free(&s);
}

TEST(a_search_ends_when_every_design_of_its_space_is_known)
{
    static const Exercise SPACES[] = {
        {"six", "", "int", "none", 1, 2, 0, 6, 5, answer_parabola},
        {"ten", "", "list:4|5|8|10|300,choice:a|b", "none", 2, 2, 0, 10, 1, answer_parabola},
        {"all", "", "int,int", "none", 2, 2, 0, 36, 5, answer_parabola}};
    for (size_t k = 0; k < sizeof SPACES / sizeof *SPACES; k++) {
        OWNED(imtet_search_free) imtet_search *s = drive(&SPACES[k], 8, NULL);
        imtet_search_state end = {.size = sizeof end};
        must(imtet_search_look(s, &end, &error));
        assert_int_equal(end.told, SPACES[k].n);
        assert_string_equal(end.why, "every design has been simulated");
    }
}

TEST(objectives_that_are_to_be_large_keep_their_signs)
{
    static const char *const settings[] = {"search.max_evals=60", NULL};
    const imtet_search_options o = {
        .size = sizeof o, .variables = 2, .objectives = 2, .senses = "max,min", .settings = settings};
    OWNED(imtet_search_free) imtet_search *s;
    double X[16], F[16], front[120];
    long ids[8];
    size_t n;
    must(imtet_search_create(&o, &s, &error));
    while (imtet_search_ask(s, 8, ids, X, &n, &error) == IMTET_OK && n > 0) {
        for (size_t i = 0; i < n; i++) {
            F[2 * i] = X[2 * i] - X[2 * i + 1];
            F[2 * i + 1] = X[2 * i] * X[2 * i] + X[2 * i + 1];
        }
        must(imtet_search_tell(s, n, ids, F, NULL, NULL, &error));
    }
    must(imtet_search_designs(s, IMTET_FRONT, 60, NULL, NULL, front, NULL, &n, &error));
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < n; k++)
            assert_false(front[2 * k] >= front[2 * i] && front[2 * k + 1] < front[2 * i + 1]);
    assert_less(5, n);
}

TEST(given_designs_come_first)
{
    const double start[] = {0.25, 0.75, 2.0, -1.0};
    const imtet_search_options o = {.size = sizeof o, .variables = 2, .objectives = 1, .starts = 2, .start = start};
    OWNED(imtet_search_free) imtet_search *s;
    double X[4];
    long ids[2];
    size_t n;
    must(imtet_search_create(&o, &s, &error));
    must(imtet_search_ask(s, 2, ids, X, &n, &error));
    assert_true(n == 2 && X[0] == 0.25 && X[1] == 0.75 && X[2] == 1.0 && X[3] == 0.0);
}

/* -- what makes no sense ------------------------------------------------------------------------------------------- */

static void create_fails(imtet_search_options o, imtet_status wanted, const char *words)
{
    imtet_search *s = (imtet_search *)(uintptr_t)1;
    assert_says(imtet_search_create(&o, &s, &error), wanted, words);
    assert_null(s);
}

TEST(options_that_are_wrong_in_one_way_are_named)
{
    const double low[] = {0, 2}, high[] = {1, 1}, nan[] = {NAN, 0};
#define WITH(...)     ((imtet_search_options){.size = sizeof(imtet_search_options), .objectives = 2, __VA_ARGS__})
#define OF_TWO(...)   WITH(.variables = 2, __VA_ARGS__)
#define SETTING(text) .settings = (const char *const[]){text, NULL}
    create_fails((imtet_search_options){.size = 8, .variables = 2, .objectives = 2}, IMTET_MISUSED, "sizeof options");
    create_fails(WITH(.variables = 0), IMTET_BAD_DATA, "problem.variables");
    create_fails((imtet_search_options){.size = sizeof(imtet_search_options), .variables = 2, .objectives = 1000},
                 IMTET_BAD_DATA, "problem.objectives");
    create_fails(OF_TWO(.constraints = 101), IMTET_BAD_DATA, "constraints: 101 are more than 100");
    create_fails(OF_TWO(.lower = low, .upper = high), IMTET_BAD_DATA, "variable 2 has the bounds 2 and 1");
    create_fails(OF_TWO(.lower = nan, .upper = high), IMTET_BAD_DATA, "variable 1");
    create_fails(OF_TWO(.kinds = "real,real,real"), IMTET_BAD_DATA, "3 kinds for 2 variables");
    create_fails(OF_TWO(.senses = "least"), IMTET_BAD_DATA, "neither min nor max");
    create_fails(OF_TWO(.starts = 1), IMTET_MISUSED, "start is NULL");
    create_fails(OF_TWO(.starts = 1, .start = nan), IMTET_BAD_DATA, "start: number 1 is nan");
    create_fails(OF_TWO(SETTING("search.populaton=20")), IMTET_BAD_DATA, "did you mean search.population?");
    create_fails(OF_TWO(SETTING("search.population=2")), IMTET_BAD_DATA, "search.population");
    create_fails(OF_TWO(SETTING("search.aspire=f3 1")), IMTET_BAD_DATA, "search.aspire: f3 is no objective");
    create_fails(OF_TWO(SETTING("search.polish=2")), IMTET_BAD_DATA,
                 "search.polish is no setting of a search that is asked and told");
    assert_int_equal(imtet_search_create(NULL, NULL, NULL), IMTET_MISUSED);
}

TEST(answers_that_make_no_sense_are_refused_as_a_whole)
{
    OWNED(imtet_search_free) imtet_search *s = search_of(&EXERCISES[2]);
    imtet_search_state now = {.size = sizeof now};
    double X[4 * 3], F[4 * 2] = {1, 2, 3, 4, 5, 6, 7, 8}, G[4 * 2] = {0};
    long ids[4], bad[4];
    size_t n;
    must(imtet_search_ask(s, 4, ids, X, &n, &error));
    memcpy(bad, ids, sizeof bad);
    bad[3] = 1000;
    assert_says(imtet_search_tell(s, 4, bad, F, G, NULL, &error), IMTET_MISUSED, "no design has the id 1000");
    bad[3] = 5; /* the search has it, and nobody has asked for it */
    assert_says(imtet_search_tell(s, 4, bad, F, G, NULL, &error), IMTET_MISUSED,
                "no design has the id 5; 4 were asked for");
    bad[3] = -5;
    assert_says(imtet_search_tell(s, 4, bad, F, G, NULL, &error), IMTET_MISUSED, "id -5");
    bad[3] = ids[0];
    assert_says(imtet_search_tell(s, 4, bad, F, G, NULL, &error), IMTET_MISUSED, "told twice");
    F[7] = NAN;
    assert_says(imtet_search_tell(s, 4, ids, F, G, NULL, &error), IMTET_BAD_DATA, "F of design 4: number 2 is nan");
    F[7] = 1;
    G[6] = INFINITY;
    assert_says(imtet_search_tell(s, 4, ids, F, G, NULL, &error), IMTET_BAD_DATA, "G of design 4: number 1 is inf");
    assert_says(imtet_search_tell(s, 4, ids, F, NULL, NULL, &error), IMTET_MISUSED, "its G is NULL");
    assert_says(imtet_search_tell(s, 4, NULL, F, G, NULL, &error), IMTET_MISUSED, "ids is NULL");
    must(imtet_search_look(s, &now, &error));
    assert_int_equal(now.told, 0);
    G[6] = 0;
    must(imtet_search_tell(s, 4, ids, F, G, NULL, &error));
    assert_says(imtet_search_tell(s, 1, ids, F, G, NULL, &error), IMTET_MISUSED, "told already");
}

TEST(a_handle_that_is_not_there_is_said_so_by_every_call)
{
    imtet_search *s = search_of(&EXERCISES[0]), *gone = NULL;
    imtet_search_state now = {.size = sizeof now};
    size_t n;
    imtet_search_free(&s);
    imtet_search_free(&s);
    imtet_search_free(NULL);
    static const char WORDS[] = "the search is NULL";
    assert_says(imtet_search_ask(s, 1, NULL, NULL, &n, &error), IMTET_MISUSED, WORDS);
    assert_says(imtet_search_tell(s, 0, NULL, NULL, NULL, NULL, &error), IMTET_MISUSED, WORDS);
    assert_says(imtet_search_look(s, &now, &error), IMTET_MISUSED, WORDS);
    assert_says(imtet_search_designs(s, IMTET_TOLD, 0, NULL, NULL, NULL, NULL, &n, &error), IMTET_MISUSED, WORDS);
    assert_says(imtet_search_save(gone, "x", &error), IMTET_MISUSED, WORDS);
    assert_says(imtet_search_load(NULL, &s, &error), IMTET_MISUSED, "path is NULL");
    assert_says(imtet_search_load("/nowhere/at/all", &s, &error), IMTET_MISSING, "/nowhere/at/all");
}

TEST(a_fork_is_told_to_load_a_saved_search)
{
    imtet_search *s = drive(&EXERCISES[0], 64, NULL);
    size_t n;
    const pid_t child = fork();
    if (child == 0) {
        const int refused =
            imtet_search_ask(s, 1, NULL, NULL, &n, &error) == IMTET_MISUSED && strstr(error.text, "fork");
        imtet_search_free(&s);
        _exit(!refused);
    }
    int status;
    waitpid(child, &status, 0);
    assert_int_equal(status, 0);
    imtet_search_free(&s);
}

TEST(designs_that_all_fail_are_said_once_then_asked_for_on_and_the_front_says_the_commonest_reason)
{
    static const char *const settings[] = {"search.failures_max=5", "search.max_evals=40", NULL};
    const char *failed[1];
    const imtet_search_options o = {.size = sizeof o, .variables = 2, .objectives = 1, .settings = settings};
    OWNED(imtet_search_free) imtet_search *s;
    imtet_status status = IMTET_OK;
    double X[2];
    long id;
    size_t n, told = 0, said = 0;
    must(imtet_search_create(&o, &s, &error));
    for (;;) {
        status = imtet_search_ask(s, 1, &id, X, &n, &error);
        if (status != IMTET_OK) {
            assert_says(status, IMTET_INTERNAL,
                        "the last 5 designs failed (search.failures_max), the last one: no licence");
            said++;
            continue;
        }
        if (n == 0)
            break;
        must(imtet_search_designs(s, IMTET_FRONT, 0, NULL, NULL, NULL, NULL, &n, &error));
        failed[0] = id < 3 ? "a rare fault" : "no licence";
        must(imtet_search_tell(s, 1, &id, NULL, NULL, failed, &error));
        told++;
    }
    assert_true(told == 40 && said == 8);
    assert_says(imtet_search_designs(s, IMTET_FRONT, 0, NULL, NULL, NULL, NULL, &n, &error), IMTET_INTERNAL,
                "none of 40 simulations succeeded; 38 failed with: no licence");
}

TEST(a_file_that_is_damaged_is_refused)
{
    char path[PATH_MAX], *bytes;
    size_t length;
    imtet_search *s = drive(&EXERCISES[2], 8, NULL);
    must(imtet_search_save(s, path_of("whole.search", path), &error));
    imtet_search_free(&s);
    CHECK_OK(file_read(path, FILE_LARGEST, &bytes, &length, &err), &err);
    Random dice = random_stream(1, RANDOM_TEST, 0, 0);
    for (int i = 0; i < 200; i++) {
        const size_t at = random_below(&dice, length), end = i % 2 ? length : at;
        FILE *f = fopen(path_of("damaged.search", path), "w");
        bytes[at] ^= 4;
        fwrite(bytes, 1, end, f);
        fclose(f);
        bytes[at] ^= 4;
        if (imtet_search_load(path, &s, &error) == IMTET_OK)
            fail_msg("byte %zu of %zu, %zu written", at, length, end);
        assert_null(s);
    }
    free(bytes);
    const imtet_status status = imtet_search_load("configs/quick.ini", &s, &error);
    assert_says(status, IMTET_BAD_DATA, "configs/quick.ini: is no saved search");
}

/* -- random calls -------------------------------------------------------------------------------------------------- */

enum { HANDLES = 4 };

static double any_number(Random *dice)
{
    static const double ODD[] = {NAN, INFINITY, -INFINITY, 0.0, -0.0, 1e308, -1e308, 1e-320};
    return random_below(dice, 20) == 0 ? ODD[random_below(dice, N_OF(ODD))] : random_uniform(dice);
}

static imtet_search *any_search(Random *dice)
{
    static const char *const KINDS[] = {"real", "int", "choice:a|b|c", "log", "x"};
    static const char *const SETTINGS[][4] = {
        {"search.max_evals=30", "search.population=8", NULL},
        {"search.max_evals=12", "search.failures_max=3", "search.surrogate=off", NULL},
        {"search.seed=-1", NULL}};
    double lower[4], upper[4];
    for (int j = 0; j < 4; j++) {
        lower[j] = random_below(dice, 4) == 0 ? any_number(dice) : 1.0;
        upper[j] = random_below(dice, 8) == 0 ? any_number(dice) : 4.0;
    }
    const imtet_search_options o = {.size = random_below(dice, 20) ? sizeof o : random_below(dice, 200),
                                    .variables = random_below(dice, 5),
                                    .objectives = random_below(dice, 4),
                                    .constraints = random_below(dice, 3),
                                    .lower = lower,
                                    .upper = upper,
                                    .kinds = KINDS[random_below(dice, N_OF(KINDS))],
                                    .settings = SETTINGS[random_below(dice, N_OF(SETTINGS))]};
    imtet_search *s = NULL;
    imtet_search_create(&o, &s, NULL);
    return s;
}

static void any_answers(imtet_search *s, Random *dice)
{
    double F[8 * 4], G[8 * 3];
    const char *failed[8];
    long ids[8];
    const size_t n = random_below(dice, 9);
    for (size_t i = 0; i < 32; i++)
        F[i] = random_below(dice, 10) ? random_uniform(dice) : any_number(dice);
    for (size_t i = 0; i < 24; i++)
        G[i] = random_uniform(dice) - 0.8;
    for (size_t i = 0; i < 8; i++) {
        ids[i] = (long)random_below(dice, 34) - 1;
        failed[i] = random_below(dice, 5) ? NULL : random_below(dice, 2) ? "" : "a,\"b\"\n\xff";
    }
    imtet_search_tell(s, random_below(dice, 3) ? 1 : n, ids, random_below(dice, 30) ? F : NULL,
                      random_below(dice, 30) ? G : NULL, random_below(dice, 3) ? NULL : failed, NULL);
}

static void any_call(imtet_search **s, const char *path, Random *dice)
{
    double X[8 * 4], F[40 * 4];
    long ids[40];
    size_t n;
    imtet_search_state state = {.size = random_below(dice, 10) ? sizeof state : 3};
    switch (random_below(dice, 10)) {
    case 0:
        imtet_search_save(*s, random_below(dice, 10) ? path : NULL, NULL);
        break;
    case 1:
        if (random_below(dice, 4) == 0) {
            imtet_search_free(s);
            imtet_search_load(path, s, NULL);
        }
        break;
    case 2:
        imtet_search_look(*s, &state, NULL);
        break;
    case 3:
        imtet_search_designs(*s, (imtet_set)random_below(dice, 3), random_below(dice, 40), ids, NULL, F, NULL, &n,
                             NULL);
        break;
    case 4:
    case 5:
        imtet_search_ask(*s, random_below(dice, 9), ids, random_below(dice, 20) ? X : NULL, &n, NULL);
        break;
    case 6:
        if (random_below(dice, 20) == 0 || !*s) {
            imtet_search_free(s);
            *s = any_search(dice);
        }
        break;
    default:
        any_answers(*s, dice);
    }
}

TEST(random_calls_end_in_errors_at_most)
{
    imtet_search *s[HANDLES] = {0};
    char path[PATH_MAX];
    const char *wanted = getenv("API_CALLS");
    const long calls = wanted ? atol(wanted) : 4000;
    Random dice = random_stream(7, RANDOM_TEST, 0, 0);
    path_of("any.search", path);
    for (long i = 0; i < calls; i++)
        any_call(&s[random_below(&dice, HANDLES)], path, &dice);
    for (int k = 0; k < HANDLES; k++)
        imtet_search_free(&s[k]);
}

static int begin(void **state)
{
    linalg_pin();
    return prepare(state);
}

SUITE(begin, clear_place)
