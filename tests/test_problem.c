#include <jansson.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include "check.h"
#include "evaluate/external.h"
#include "bench/textbook.h"
#include "evaluate/schema.h"
#include "evaluate/adapter.h"

enum { VAR = 22, OBJ = 7 };

/* -- textbook problems --------------------------------------------------------------------------------------------- */

typedef struct {
    const char *problem;
    double x[VAR], f[OBJ];
} Vector;

/* From pymoo's definitions. */
static const Vector VECTORS[] = {
    {"DTLZ2",
     {0.6369616873214543,   0.2697867137638703,   0.04097352393619469, 0.016527635528529094, 0.8132702392002724,
      0.9127555772777217,   0.6066357757671799,   0.7294965609839984,  0.5436249914654229,   0.9350724237877682,
      0.8158535541215322,   0.002738500170148095, 0.8574042765875693,  0.033585575305464355, 0.7296554464299441,
      0.17565562060255901,  0.8631789223498866,   0.5414612202490917,  0.2997118905373848,   0.42268722119765845,
      0.028319671145462966, 0.12428327649956394},
     {0.05136228908963543, 0.3724397592963827, 1.2448092946683758, 0.033766582413433444, 0.08383564892860178,
      0.5880195392361441, 2.229690804765558}},
    {"WFG4",
     {0.8328302590691092, 1.4514725883164763,  5.636847280388883,  5.177327491414728,  5.898510378815461,
      11.360932640821876, 5.627460441800157,   10.979187469284156, 3.0339008600393313, 16.677543984943345,
      7.219214019865753,  11.474526273414536,  0.713884163981751,  4.11254322150597,   24.431055051313777,
      21.624942643987588, 0.16750740250295393, 27.423104547813974, 23.81884771668542,  37.919458052393054,
      39.078723029385685, 18.558490647417493},
     {0.4950812816133456, 0.5498118270259136, 0.6013352139563748, 0.9760009416722084, 1.2459914741757427,
      1.6957522379391914, 14.354465569839618}}};

static void check_vector(const char *problem, const double x[], const double f[])
{
    double got[OBJ];
    if (strcmp(problem, "DTLZ2") == 0)
        textbook_dtlz2(VAR, OBJ, x, got);
    else
        textbook_wfg4(VAR, OBJ, 2 * (OBJ - 1), x, got);
    for (size_t k = 0; k < OBJ; k++)
        assert_less(fabs(got[k] - f[k]), 1e-9);
}

TEST(textbook_problems_give_the_numbers_of_an_independent_program)
{
    for (size_t i = 0; i < sizeof VECTORS / sizeof VECTORS[0]; i++)
        check_vector(VECTORS[i].problem, VECTORS[i].x, VECTORS[i].f);
}

static void take(const json_t *list, size_t n, double v[])
{
    assert_int_equal(json_array_size(list), n);
    for (size_t i = 0; i < n; i++)
        v[i] = json_number_value(json_array_get(list, i));
}

/* IMTET_VECTORS: a file of {"problem","x","f"} lines. */
TEST(textbook_problems_agree_with_a_file_of_vectors_where_there_is_one)
{
    const char *path = getenv("IMTET_VECTORS");
    FILE *file = fopen(path ? path : "../shared/moo/test_vectors.jsonl", "r");
    char line[16384];
    if (!file)
        skip();
    while (fgets(line, sizeof line, file)) {
        json_auto_t *o = json_loads(line, 0, NULL);
        double x[VAR], f[OBJ];
        take(json_object_get(o, "x"), VAR, x);
        take(json_object_get(o, "f"), OBJ, f);
        check_vector(json_string_value(json_object_get(o, "problem")), x, f);
    }
    fclose(file);
}

/* On the front of DTLZ2 sum f^2 = 1, of WFG4 sum (f_k / 2 k)^2 = 1; off it both are larger. */
TEST(optimal_designs_lie_on_the_known_fronts)
{
    for (uint32_t seed = 0; seed < 200; seed++) {
        Random r = random_stream(seed, RANDOM_TEST, 0, 0);
        double x[VAR], z[VAR], f[OBJ], sphere = 0.0, ellipsoid = 0.0;
        for (size_t d = 0; d < VAR; d++) {
            x[d] = d < OBJ - 1 ? random_uniform(&r) : 0.5;
            z[d] = 2.0 * (double)(d + 1) * (d < 12 ? random_uniform(&r) : 0.35);
        }
        textbook_dtlz2(VAR, OBJ, x, f);
        for (size_t k = 0; k < OBJ; k++)
            sphere += f[k] * f[k];
        textbook_wfg4(VAR, OBJ, 12, z, f);
        for (size_t k = 0; k < OBJ; k++)
            ellipsoid += f[k] * f[k] / (4.0 * (double)((k + 1) * (k + 1)));
        assert_close(sphere, 1.0, 1e-12);
        assert_close(ellipsoid, 1.0, 1e-12);
    }
}

/* -- workers ------------------------------------------------------------------------------------------------------- */

enum { N = 12 };

typedef struct {
    double X[N * 3], F[N * 2];
    struct {
        Outcome outcome;
        char reason[160];
    } answers[N];
    double seconds;
} Batch;

static ProblemOptions command_of(const char *command, double timeout_s, long n_var)
{
    ProblemOptions o = {.kind = PROBLEM_EXTERNAL,
                        .timeout_s = timeout_s,
                        .variables = n_var,
                        .objectives = 2,
                        .lower = "-1",
                        .upper = "1"};
    snprintf(o.command, sizeof o.command, "%s", command);
    return o;
}

/* Two batches: workers live on between them. */
static void ask(Batch *a, const char *command, size_t workers, double timeout_s)
{
    OWNED(problem_close) Problem p;
    Queue *q;
    Finished done;
    Random r = random_stream(1, RANDOM_TEST, 0, 0);
    const ProblemOptions options = command_of(command, timeout_s, 3);
    for (size_t i = 0; i < N * 3; i++)
        a->X[i] = random_uniform(&r) - 0.5;
    CHECK_OK(external_open(&p, &options, workers, &err), &err);
    const double start = clock_seconds();
    CHECK_OK(queue_open(&q, &p, &err), &err);
    for (size_t i = 0, came = 0; came < N; came++) {
        for (; i < N && i < came / (N / 2) * (N / 2) + N / 2; i++)
            CHECK_OK(queue_ask(q, &(Asked){.x = a->X + 3 * i}, &err), &err);
        CHECK_OK(queue_next(q, &done, &err), &err);
        memcpy(a->F + 2 * came, done.evaluation->f, 2 * sizeof *a->F);
        a->answers[came].outcome = done.evaluation->outcome;
        memcpy(a->answers[came].reason, ((const ExternalAnswer *)done.parts)->reason, 160);
    }
    queue_close(q);
    a->seconds = clock_seconds() - start;
}

static void expect_each(Outcome wanted, const char *command, size_t workers, double timeout_s)
{
    Batch a;
    ask(&a, command, workers, timeout_s);
    for (size_t i = 0; i < N; i++)
        assert_int_equal(a.answers[i].outcome, wanted);
}

static void expect_every_third(const char *mode, Outcome third, const char *reason, double timeout_s)
{
    for (size_t workers = 1; workers <= 3; workers += 2) {
        Batch a;
        ask(&a, brief("sh tests/worker.sh %s", mode), workers, timeout_s);
        for (size_t i = 0; i < N; i++) {
            const Outcome want = (i + 1) % 3 == 0 ? third : OUTCOME_OK;
            if (a.answers[i].outcome != want)
                fail_msg("%s, design %zu: %s (%s)", mode, i + 1, outcome_word(a.answers[i].outcome),
                         a.answers[i].reason);
            if (want == OUTCOME_OK) {
                assert_same_number(a.F[2 * i], a.X[3 * i]); /* 17 digits there and back */
                assert_same_number(a.F[2 * i + 1], a.X[3 * i + 1]);
            } else if (!strstr(a.answers[i].reason, reason)) {
                fail_msg("%s: '%s' does not say '%s'", mode, a.answers[i].reason, reason);
            }
        }
        assert_less(a.seconds, 30);
    }
}

TEST(a_good_worker_answers_every_design)
{
    expect_every_third("good", OUTCOME_OK, "", 20);
    expect_every_third("spaced", OUTCOME_OK, "", 20);
    expect_every_third("slowly", OUTCOME_OK, "", 20);
    expect_every_third("calm", OUTCOME_OK, "", 20);    /* with an error that is null */
    expect_every_third("real", OUTCOME_OK, "", 20);    /* id 17.0 */
    expect_every_third("largest", OUTCOME_OK, "", 20); /* a number that is finite, but not from its 2nd digit on */
}

TEST(a_reported_error_fails_that_design_with_its_reason)
{
    expect_every_third("error", OUTCOME_ERROR, "no, \"never\" this one", 20);
}

TEST(a_worker_that_dies_fails_one_design_and_is_replaced)
{
    expect_every_third("dies", OUTCOME_DEAD, "ended", 20);
    expect_every_third("killed", OUTCOME_DEAD, "ended", 20);
}

TEST(a_silent_worker_fails_one_design_and_is_replaced)
{
    expect_every_third("silent", OUTCOME_TIMEOUT, "0.4 s", 0.4);
}

/* One that answers once and ends is gone when the next request comes, or going: no design is lost by that. */
TEST(a_worker_that_ends_after_its_answer_costs_no_design)
{
    for (int i = 0; i < 5; i++)
        expect_every_third("once", OUTCOME_OK, "", 20);
}

/* Its child holds the output open for a minute. */
TEST(a_worker_that_leaves_a_child_behind_is_seen_to_be_dead)
{
    expect_every_third("child", OUTCOME_DEAD, "ended", 20);
}

TEST(millions_of_blank_lines_are_passed_over_quickly)
{
    struct rusage before, after;
    getrusage(RUSAGE_SELF, &before);
    expect_each(OUTCOME_OK, "sh tests/worker.sh blanks", 1, 60);
    getrusage(RUSAGE_SELF, &after);
    assert_less(after.ru_utime.tv_sec - before.ru_utime.tv_sec, 3);
}

TEST(messages_are_cut_between_characters_and_shown_whatever_they_are)
{
    expect_every_third("umlauts", OUTCOME_ERROR, "aääääääääää", 20);
    expect_every_third("latin", OUTCOME_GARBLED, "zu gro", 20);
    Evaluation e = {.room = (char[REASON_MAX]){0}};
    char want[160] = "a";
    for (int i = 0; i < 79; i++)
        strcat(want, "ä"); /* 159 bytes */
    evaluation_set_outcome(&e, OUTCOME_ERROR, brief("%sä", want));
    assert_string_equal(e.reason, want);
    evaluation_set_outcome(&e, OUTCOME_ERROR, "zu gro\337, \303");
    assert_string_equal(e.reason, "zu gro\\xDF; \\xC3");
    /* an apostrophe before it */
    evaluation_set_outcome(&e, OUTCOME_ERROR, brief("=%s", want));
    json_auto_t *string = json_string(e.reason);
    assert_non_null(string);
}

TEST(a_talkative_worker_fails_one_design_and_is_replaced)
{
    expect_every_third("garbled", OUTCOME_GARBLED, "convergence reached", 20);
    expect_every_third("huge", OUTCOME_GARBLED, "more than", 20);
    expect_every_third("flood", OUTCOME_GARBLED, "iteration", 20);
    expect_every_third("nothing", OUTCOME_GARBLED, "neither", 20);
    expect_every_third("stranger", OUTCOME_GARBLED, "123456", 20);
}

TEST(answers_that_are_no_objectives_fail_the_design_alone)
{
    FOR_EACH (const char *, how, "null", "short", "nan", "overflow", "infinity")
        expect_every_third(*how, OUTCOME_NOT_FINITE, "2 finite numbers", 20);
}

TEST(a_worker_that_never_behaves_fails_every_design_and_nothing_hangs)
{
    expect_each(OUTCOME_GARBLED, "sh tests/worker.sh unasked", 2, 5);
    expect_each(OUTCOME_TIMEOUT, "sh tests/worker.sh deaf", 3, 0.1);
    expect_each(OUTCOME_DEAD, "true", 2, 5);
}

TEST(words_of_the_command_may_be_quoted_and_no_shell_reads_them)
{
    expect_each(OUTCOME_OK, "  sh  'tests/worker.sh' \"go\\\"od\" '$(exit)' a\\ b  ", 1, 20);
    Problem p;
    ProblemOptions options = command_of("sh 'tests", 1, 3);
    assert_refused(external_open(&p, &options, 1, &err), STATUS_BAD_DATA, "quote");
    options = command_of("   ", 1, 3);
    assert_int_equal(external_open(&p, &options, 1, &err), STATUS_BAD_DATA);
}

/* The first child of a process: the helper of one of its workers. */
static pid_t helper_of(pid_t pid)
{
    char number[32] = "";
    FILE *f = popen(brief("pgrep -P %d", (int)pid), "r");
    assert_true(f && fgets(number, sizeof number, f));
    pclose(f);
    return (pid_t)atol(number);
}

/* A program whose two workers, run by that command, hold an end of a pipe and have each said one character into it. */
static pid_t start_with_workers(const char *command, int *end)
{
    const double X[4] = {0};
    double F[4];
    unsigned char ok[2];
    Problem p;
    Queue *q;
    const ProblemOptions options = command_of(command, 60, 2);
    err = (Err){0};
    int ends[2];
    char word;
    assert_int_equal(pipe(ends), 0);
    const pid_t pid = fork();
    if (pid == 0) {
        dup2(ends[1], STDERR_FILENO);
        close(ends[1]);
        if (external_open(&p, &options, 2, &err) == STATUS_OK && queue_open(&q, &p, &err) == STATUS_OK)
            queue_evaluate(q, 2, X, 0, F, NULL, ok, &err);
        _exit(1);
    }
    close(ends[1]);
    for (int n = 0; n < 2; n++)
        assert_int_equal(read(ends[0], &word, 1), 1);
    *end = ends[0];
    return pid;
}

/* The pipe ends when the last of those does that hold it. */
static void kill_and_expect_its_workers_to_end(pid_t pid, int end)
{
    char word;
    kill(pid, SIGKILL);
    assert_int_equal(waitpid(pid, NULL, 0), pid);
    do /* of workers that were asked again there may be more */
        assert_int_equal(poll(&(struct pollfd){end, POLLIN, 0}, 1, 20000), 1);
    while (read(end, &word, 1) > 0);
    close(end);
}

static const char WITH_CHILDREN[] = "sh -c 'read -r line; sleep 60 & printf ! >&2; wait'";

/* All at once, so that no helper can take the other's place. */
TEST(workers_end_with_a_program_and_a_helper_that_are_killed_together)
{
    int end;
    const pid_t pid = start_with_workers("sh -c 'read -r line; printf ! >&2; exec sleep 60'", &end);
    kill(helper_of(pid), SIGKILL);
    kill_and_expect_its_workers_to_end(pid, end);
}

TEST(workers_end_with_a_program_that_is_killed)
{
    int end;
    const pid_t pid = start_with_workers(WITH_CHILDREN, &end);
    kill_and_expect_its_workers_to_end(pid, end);
}

TEST(workers_end_with_a_program_whose_helper_was_killed_before)
{
    int end;
    const pid_t pid = start_with_workers(WITH_CHILDREN, &end);
    kill(helper_of(pid), SIGKILL);
    rest(1);
    kill_and_expect_its_workers_to_end(pid, end);
}

TEST(a_command_that_does_not_exist_ends_the_search_by_name)
{
    OWNED(problem_close) Problem p;
    Queue *q;
    double x[3] = {0}, f[2];
    unsigned char ok;
    const ProblemOptions options = command_of("no-such-simulator --fast", 1, 3);
    CHECK_OK(external_open(&p, &options, 1, &err), &err);
    CHECK_OK(queue_open(&q, &p, &err), &err);
    assert_refused(queue_evaluate(q, 1, x, 0, f, NULL, &ok, &err), STATUS_BAD_DATA, "no-such-simulator");
    queue_close(q);
}

/* -- adapters ------------------------------------------------------------------------------------------------------ */

static Settings external_settings(void)
{
    Settings s = default_settings();
    FOR_EACH (const char *, set, "problem.kind=external", "problem.command=sh tests/worker.sh good",
              "problem.variables=3", "problem.objectives=2", "problem.lower=-1,0,2", "problem.upper=3",
              "problem.senses=max,min", "problem.objective_names=profit, cost", "search.limits=profit>=-0.5,cost <= 2")
        CHECK_OK(settings_set(&s, *set, &err), &err);
    return s;
}

typedef struct {
    size_t n;
    long numbers;
    double violations;
    int last_ok;
} Heard;

static Status hear(const Evaluation *e, void *user, Err *why)
{
    (void)why;
    Heard *h = user;
    h->n++;
    h->numbers += e->id;
    h->violations += e->violation;
    h->last_ok = e->outcome == OUTCOME_OK;
    return STATUS_OK;
}

TEST(an_external_problem_has_the_bounds_senses_names_and_limits_of_its_settings)
{
    const Settings s = external_settings();
    Adapter *adapter;
    CHECK_OK(adapter_open(&adapter, &s, &err), &err);
    const Problem *p = adapter_problem(adapter);
    const Schema *schema = adapter_schema(adapter);
    assert_true(p->n_var == 3 && p->n_obj == 2 && p->n_con == 2);
    assert_true(p->lower[0] == -1 && p->lower[1] == 0 && p->lower[2] == 2 && p->upper[0] == 3 && p->upper[2] == 3);
    assert_string_equal(schema_objective(schema, 1)->name, "cost");
    assert_string_equal(schema_variable(schema, 2)->name, "x3");

    const double X[] = {-0.75, 1, 2, 0.25, 3, 2};
    double F[4], G[4];
    unsigned char ok[2];
    Heard heard = {0};
    adapter_observe(adapter, &(Observer){.done = hear, .user = &heard});
    Queue *q;
    CHECK_OK(queue_open(&q, p, &err), &err);
    CHECK_OK(queue_evaluate(q, 2, X, 0, F, G, ok, &err), &err);
    queue_close(q);
    assert_true(ok[0] && ok[1] && F[0] == 0.75 && F[1] == 1 && F[2] == -0.25 && F[3] == 3);
    assert_close(G[0], 0.5, 1e-15); /* -0.5 - -0.75 of 0.5 */
    assert_true(G[1] == -0.5 && G[2] < 0);
    assert_close(G[3], 0.5, 1e-15);
    assert_true(heard.n == 2 && heard.last_ok && heard.numbers == 1 + 2 && heard.violations > 0.0);
    adapter_close(adapter);
}

static void refused(const char *assignment, const char *said)
{
    Settings s = external_settings();
    Adapter *adapter;
    CHECK_OK(settings_set(&s, assignment, &err), &err);
    assert_refused(adapter_open(&adapter, &s, &err), STATUS_BAD_DATA, said);
}

TEST(lists_that_do_not_fit_are_refused_by_name)
{
    refused("problem.lower=0,1", "problem.lower: 2 numbers for 3");
    refused("problem.lower=0,,1", "problem.lower: number 2");
    refused("problem.upper=0,1,two", "problem.upper: 'two'");
    refused("problem.upper=0", "problem.lower");
    refused("problem.senses=min,max,min", "problem.senses");
    refused("problem.senses=less", "problem.senses");
    refused("problem.variable_names=a,b", "problem.variable_names");
    refused("problem.objective_names=a,a", "twice");
    refused("search.limits=speed<=3", "speed is no objective");
    refused("search.limits=cost=3", "search.limits");
    refused("search.limits=cost<=", "no number");
}

TEST(noise_has_the_spread_asked_for_and_the_same_seed_the_same_noise)
{
    enum { DRAWS = 2000 };
    static const TextbookOptions NOISY = {"dtlz2", VAR, OBJ, 0.03, 1, "real"};
    double first[OBJ], x[VAR], exact[OBJ], sum = 0, square = 0;
    for (size_t d = 0; d < VAR; d++)
        x[d] = 0.4;
    for (int again = 0; again < 2; again++) {
        OWNED(problem_close) Problem p;
        Queue *q;
        CHECK_OK(textbook_open(&p, &NOISY, &err), &err);
        CHECK_OK(queue_open(&q, &p, &err), &err);
        for (int i = 0; i < DRAWS; i++) {
            double f[OBJ];
            unsigned char ok;
            CHECK_OK(queue_evaluate(q, 1, x, 0, f, NULL, &ok, &err), &err);
            if (again == 0 && i == 0)
                memcpy(first, f, sizeof f);
            else if (i == 0)
                assert_memory_equal(first, f, sizeof f);
            textbook_exact(&p, x, exact);
            sum += (f[0] / exact[0] - 1) / (2 * DRAWS);
            square += (f[0] / exact[0] - 1) * (f[0] / exact[0] - 1) / (2 * DRAWS);
        }
        queue_close(q);
    }
    assert_less(fabs(sum), 0.003);
    assert_close(sqrt(square), 0.03, 0.06);
}

SUITE(NULL, NULL)
