/* kill -9 at any moment: the run stays readable, what was acknowledged stays, and it ends as if nothing had happened.
 * TORTURE_KILLS in the environment: how many, 8 if not given; the figures are printed (`make torture`). */
#include "program.h"

#include <fcntl.h>
#include <spawn.h>

#include "store/run_read.h"

typedef struct {
    const char *name, *settings;
} Prey;

static const Prey PREYS[] = {
    {"textbook", "[problem]\nkind = external\ncommand = " TEXTBOOK_WORKER
                 " dtlz2 8 3 0.02\nvariables = 8\nobjectives = 3\nnoisy = yes\n"
                 "[search]\ninitial = 24\npopulation = 16\nmax_evals = 120\nthreads = 1\n"},
    {"tower", SIX_FLOORS_INI "[sim]\nduration_s = 5\n"
                             "[search]\ninitial = 24\npopulation = 16\nmax_evals = 50\nthreads = 2\n"},
    /* designs see one of four records first; objectives with probabilities */
    {"race", "[building]\nmodel = /proc/self/cwd/configs/neighbours/tower\n[core]\nwidth_m = 5\n"
             "[design]\ngap_m = 0.001, 0.05\n[motion]\nrecord = builtin:suite-01\n"
             "records = builtin:suite-02, builtin:suite-03, builtin:suite-04\n"
             "[sim]\nduration_s = 3\naccuracy = coarse\nrobust = cvar\ntail = 0.5\n"
             "[search]\nobjectives = j3_g, loss, p(drift_ratio>0.012)\nfidelity = records\n"
             "initial = 24\npopulation = 16\nmax_evals = 40\nthreads = 2\n"},
    /* an answer takes 40 ms: kills come in the middle of a batch */
    {"worker", "[problem]\nkind = external\ncommand = sh tests/worker.sh steady\nvariables = 3\nobjectives = 2\n"
               "[search]\ninitial = 36\npopulation = 12\nmax_evals = 46\nthreads = 2\n"}};
enum { N_PREYS = sizeof PREYS / sizeof PREYS[0] };

typedef struct {
    long kills, early, unreadable, acknowledged, lost, in_batch, finished, different;
} Figures;

/* While a start makes its database: files are there in part. */
static const double EARLY_S = 0.08;

static void demand_success(int status)
{
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
        fail_msg("ended with %d: %s", status, read_in_place("said"));
}

static pid_t start(const Prey *prey, const char *folder, int by_folder)
{
    pid_t pid;
    posix_spawn_file_actions_t quiet;
    FREED char *config = formatted("%s/%s.ini", place.folder, prey->name);
    char *by_config[] = {getenv("IMTET"), "optimize", config, "--out", (char *)folder, NULL};
    char *goes_on[] = {getenv("IMTET"), "optimize", (char *)folder, NULL};
    posix_spawn_file_actions_init(&quiet);
    posix_spawn_file_actions_addopen(&quiet, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_addopen(&quiet, STDERR_FILENO, there("said"), O_WRONLY | O_CREAT | O_TRUNC, 0666);
    assert_int_equal(posix_spawn(&pid, getenv("IMTET"), &quiet, NULL, by_folder ? goes_on : by_config, environ), 0);
    posix_spawn_file_actions_destroy(&quiet);
    return pid;
}

/* What the database tells: 0 where there is none yet, -1 where it cannot be read. */
static int look(const char *folder, Run *h)
{
    err = (Err){0};
    memset(h, 0, sizeof *h);
    if (!run_is_there(folder))
        return 0;
    if (run_read(h, folder, &err) == STATUS_OK)
        return 1;
    print_error("%s\n", err.text);
    return -1;
}

/* Evaluations of `before` that are not the same in `after`; what is named at the end gets better values, with errors. */
static long count_lost(const Run *before, const Run *after)
{
    long lost = 0;
    const size_t n_var = before->schema.n_var, m = before->schema.n_obj;
    for (size_t i = 0; i < before->table.n; i++) {
        const size_t j = run_find(after, before->table.row[i].id);
        const int is_named = j < after->table.n && !before->table.row[i].err && after->table.row[j].err;
        lost +=
            j == after->table.n ||
            memcmp(before->table.x + i * n_var, after->table.x + j * n_var, n_var * sizeof(double)) != 0 ||
            (before->place[i].ok && !is_named && memcmp(before->F + i * m, after->F + j * m, m * sizeof(double)) != 0);
    }
    return lost;
}

static int same_file(const char *a, const char *b, const char *name)
{
    FREED char *first = text_of(brief("%s/%s", a, name)), *second = text_of(brief("%s/%s", b, name));
    return strcmp(first, second) == 0;
}

/* Every evaluation, digests included. */
static int same_run(const char *a, const char *b)
{
    OWNED(run_free) Run first, second;
    const int seen = look(a, &first) == 1 && look(b, &second) == 1;
    return seen && first.table.n == second.table.n && count_lost(&first, &second) == 0;
}

static void judge_end(const char *reference, const char *folder, Figures *f)
{
    f->finished++;
    f->different += !same_file(reference, folder, "front.csv") || !same_run(reference, folder);
    expect_shell("rm -rf '%s'", folder);
}

/* One start, killed after `delay` unless it is finished before; 1: it was killed. */
static int start_and_kill(const Prey *prey, const char *folder, double delay, Figures *f)
{
    Run before, after;
    int status;
    const int has_run = look(folder, &before) == 1;
    const pid_t pid = start(prey, folder, has_run && f->kills % 2 == 1);
    run_free(&before);
    rest(delay);
    const int seen = look(folder, &before); /* all of this has been acknowledged */
    kill(pid, SIGKILL);
    assert_int_equal(waitpid(pid, &status, 0), pid);
    const int killed = WIFSIGNALED(status);
    if (!killed)
        demand_success(status);
    const int found = look(folder, &after);
    f->unreadable += found < 0 || seen < 0;
    if (seen == 1) {
        f->acknowledged += (long)before.table.n;
        f->lost += found == 1 ? count_lost(&before, &after) : (long)before.table.n;
        f->in_batch +=
            killed && found == 1 && after.table.n > 0 && after.table.row[after.table.n - 1].kind == KIND_UNFINISHED;
    }
    run_free(&before);
    run_free(&after);
    return killed;
}

static void torture(const Prey *prey, long kills)
{
    Figures f = {0};
    FREED char *reference = formatted("%s/%s-whole", place.folder, prey->name);
    FREED char *folder = formatted("%s/%s-killed", place.folder, prey->name);
    const double begun = clock_seconds();
    int status;
    assert_true(waitpid(start(prey, reference, 0), &status, 0) > 0 && WIFEXITED(status) && WEXITSTATUS(status) == 0);
    const double whole = clock_seconds() - begun;
    srand(7);
    while (f.kills < kills) {
        const int is_early = f.kills % 6 >= 4; /* twice in a row */
        if (start_and_kill(prey, folder, (is_early ? EARLY_S : whole) * rand() / RAND_MAX, &f)) {
            f.kills++;
            f.early += is_early;
        } else
            judge_end(reference, folder, &f);
    }
    assert_true(waitpid(start(prey, folder, 0), &status, 0) > 0);
    demand_success(status);
    judge_end(reference, folder, &f);
    print_message(
        "%s: %ld kills, %ld of them within the first %.0f ms of a start, %ld between the simulations of a batch: %ld "
        "unreadable, %ld of %ld acknowledged evaluations lost, %ld of %ld fronts different\n",
        prey->name, f.kills, f.early, 1e3 * EARLY_S, f.in_batch, f.unreadable, f.lost, f.acknowledged, f.different,
        f.finished);
    assert_int_equal(f.unreadable, 0);
    assert_int_equal(f.lost, 0);
    assert_int_equal(f.different, 0);
}

TEST(no_kill_loses_an_evaluation_or_changes_the_front)
{
    setenv("OMP_WAIT_POLICY", "passive", 0); /* busy waiting costs more than it saves where processors are few */
    const char *kills = getenv("TORTURE_KILLS"), *only = getenv("TORTURE_RUN");
    for (int i = 0; i < N_PREYS; i++) {
        if (only && strcmp(only, PREYS[i].name) != 0)
            continue;
        write_in_place(brief("%s.ini", PREYS[i].name), PREYS[i].settings);
        torture(&PREYS[i], ((kills ? strtol(kills, NULL, 10) : 8) + N_PREYS - 1) / N_PREYS);
    }
}

SUITE(make_place, clear_place)
