/* Ranks of MPI: the bytes of one process, whoever evaluates; a rank that dies, hangs or is another program is named.
 * IMTET_MPI in the environment: the program; MPI_RANKS: how many at most, 4 if not given. */
#include "program.h"

#include <fcntl.h>
#include <omp.h>
#include <spawn.h>

#include "mpi/message.h"

static const char TOWER[] = "[motion]\nrecord = builtin:kobe-like\nrecords = builtin:elcentro-like\npga_g = 0.3\n"
                            "[sim]\nduration_s = 6\nreplicates = 2\ngap_tolerance_m = 0.001\n"
                            "[search]\ninitial = 24\npopulation = 16\nmax_evals = 48\n"
                            "threads = 1\n";
static const char STEADY[] = "[problem]\nkind = external\ncommand = sh tests/worker.sh steady\nvariables = 3\n"
                             "objectives = 2\nnoisy = yes\n[search]\ninitial = 36\npopulation = 12\nmax_evals = 150\n"
                             "surrogate = off\nthreads = 1\n";

/* Designs see one of eight motions first; which, every session finds out anew. */
static const char RACE[] = "[building]\nmodel = /proc/self/cwd/configs/neighbours/tower\n[core]\nwidth_m = 5\n"
                           "[design]\ngap_m = 0.001, 0.05\n[motion]\nrecord = builtin:suite-01\n"
                           "records = builtin:suite-02, builtin:suite-03, builtin:suite-04, builtin:suite-05, "
                           "builtin:suite-06, builtin:suite-07, builtin:suite-08\n"
                           "[sim]\nduration_s = 4\naccuracy = coarse\n"
                           "[search]\nobjectives = j3_g, loss, p(drift_ratio>0.012)\nlimits = p(j1_m>0.2)<=0.5\n"
                           "fidelity = records\ninitial = 24\npopulation = 16\nmax_evals = 40\nthreads = 1\n";

static const char *program(void)
{
    const char *name = getenv("IMTET_MPI");
    if (!name || system("command -v mpirun >/dev/null") != 0)
        skip();
    return name;
}

static pid_t spawn(const char *command)
{
    pid_t pid;
    char *words[] = {"sh", "-c", (char *)command, NULL};
    assert_int_equal(posix_spawnp(&pid, "sh", NULL, NULL, words, environ), 0);
    return pid;
}

static const char *launcher = "mpirun";

/* `mpirun -n RANKS imtet_mpi ARGUMENTS` in the background, @ as in run(); what it says is in @/said. The shell becomes
 * mpirun. */
__attribute__((format(printf, 2, 3))) static pid_t launch(int ranks, const char *format, ...)
{
    char arguments[2048];
    va_list list;
    va_start(list, format);
    spread(arguments, sizeof arguments, format, list);
    va_end(list);
    return spawn(
        brief("exec %s -n %d '%s' %s >'%s/said' 2>&1 </dev/null", launcher, ranks, program(), arguments, place.folder));
}

/* The ranks are mpirun's children, in their order; how many there are. */
static int ranks_of(pid_t mpirun, long pid[16])
{
    int n = 0;
    FILE *f = opened(brief("/proc/%d/task/%d/children", (int)mpirun, (int)mpirun), "r");
    while (n < 16 && fscanf(f, "%ld", &pid[n]) == 1)
        n++;
    fclose(f);
    return n;
}

static int have_ended(pid_t mpirun)
{
    char state;
    long pid[16];
    const int n = ranks_of(mpirun, pid);
    int n_ended = 0;
    for (int i = 0; i < n; i++) {
        FILE *f = fopen(brief("/proc/%ld/stat", pid[i]), "r");
        n_ended += f && fscanf(f, "%*d (%*[^)]) %c", &state) == 1 && state == 'Z';
        if (f)
            fclose(f);
    }
    return n > 0 && n_ended == n;
}

static void give_up(const char *mpirun_does)
{
    print_message("mpirun %s: its status is not to be had\n", mpirun_does);
    skip();
}

/* Debian's mpirun sometimes locks itself up or crashes on its way out, in PMIx_server_finalize, when all of its ranks
 * have ended. */
static int code_of(pid_t pid)
{
    static const double ENDS_S = 30;
    int status;
    for (double since = clock_seconds(); waitpid(pid, &status, WNOHANG) == 0; rest(0.02)) {
        since = have_ended(pid) ? since : clock_seconds();
        if (clock_seconds() - since > ENDS_S) {
            kill(pid, SIGKILL);
            give_up("does not end, all of its ranks have");
        }
    }
    if (WIFSIGNALED(status) && WTERMSIG(status) == SIGSEGV)
        give_up("crashed itself");
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

static void expect_code(pid_t pid, int wanted)
{
    const int code = code_of(pid);
    FREED char *said = read_in_place("said");
    if (code != wanted)
        fail_msg("exit %d, wanted %d: %s", code, wanted, said);
}

/* Words that stand in what it has said, or behind a ! do not. */
#define expect_said(...)                                                                                               \
    do {                                                                                                               \
        FREED char *all_said = read_in_place("said");                                                                  \
        assert_words(all_said, __VA_ARGS__);                                                                           \
    } while (0)

static void assert_same_text(char *first, char *second, const char *a, const char *b, const char *what)
{
    if (strcmp(first, second) != 0)
        fail_msg("%s differs from %s: %s", b, a, what);
    free(first);
    free(second);
}

static char *front_of(const char *run)
{
    return read_in_place(brief("%s/front.csv", run));
}

static void assert_same_evaluations(const char *a, const char *b)
{
    assert_same_text(all_of(a), all_of(b), a, b, "evaluations");
    assert_same_text(front_of(a), front_of(b), a, b, "front.csv");
}

static pid_t process_of(pid_t mpirun, int rank)
{
    long pid[16];
    assert_less(rank, ranks_of(mpirun, pid));
    return (pid_t)pid[rank];
}

/* Until the run has a generation. */
static void wait_for_evaluations(const char *run)
{
    const double until = clock_seconds() + 60;
    while (finished_in(run) < 9 && clock_seconds() < until)
        rest(0.02);
    assert_at_most(9, finished_in(run));
    rest(0.3); /* into the next generation */
}

TEST(the_ordinary_program_does_not_link_mpi)
{
    expect_shell("ldd '%s' | grep -q libc && ! ldd '%s' | grep -qi libmpi", getenv("IMTET"), getenv("IMTET"));
    expect_shell("ldd '%s' | grep -qi libmpi", program());
}

TEST(a_batch_has_the_same_bytes_at_any_number_of_ranks_and_threads)
{
    static const int RANKS[] = {1, 2, 4, 8};
    const int most = getenv("MPI_RANKS") ? atoi(getenv("MPI_RANKS")) : 4;
    program();
    write_in_place("tower.ini", TOWER);
    free(output_of("optimize @/tower.ini --out @/alone"));
    for (size_t i = 0; i < N_OF(RANKS) && RANKS[i] <= most; i++) {
        FREED char *run_name = formatted("on-%d", RANKS[i]);
        expect_code(launch(RANKS[i], "optimize @/tower.ini --out @/%s --threads %zu", run_name, 2 - i % 2), 0);
        assert_same_evaluations("alone", run_name);
    }
}

/* A study by one process, with options of its own, of which it says the words, and over so many ranks. */
static void expect_same_bytes(const char *name, const char *study, const char *options, const char *words, int ranks)
{
    program();
    FREED char *ini = formatted("%s.ini", name), *over = formatted("%s-on-%d", name, ranks);
    write_in_place(ini, study);
    assert_words_in(output_of("optimize @/%s --out @/%s %s", ini, name, options), words);
    expect_code(launch(ranks, "optimize @/%s --out @/%s", ini, over), 0);
    assert_same_evaluations(name, over);
}

TEST(a_race_over_a_suite_has_the_same_bytes_at_any_number_of_ranks)
{
    FOR_EACH (int, ranks, 2, 4)
        expect_same_bytes("race", RACE, "", "", *ranks);
}

TEST(polishing_goes_over_the_ranks)
{
    expect_same_bytes("polished",
                      "[motion]\nrecord = builtin:kobe-like\npga_g = 0.3\n[sim]\nduration_s = 6\nreplicates = 4\n"
                      "[search]\ninitial = 30\npopulation = 16\nmax_evals = 100\nsurrogate = off\n"
                      "polish = 1\nthreads = 1\n",
                      "", "polished: ", 3);
}

TEST(an_external_simulator_runs_beside_every_rank)
{
    expect_same_bytes("steady", STEADY, "--threads 3", "", 4);
}

TEST(constraints_whole_numbers_and_words_have_the_same_bytes_over_ranks)
{
    expect_same_bytes(
        "bounded",
        "[problem]\nkind = external\ncommand = sh tests/worker.sh bounded\nvariables = 3\nobjectives = 2\n"
        "lower = 0\nupper = 20\nkinds = int, int, choice:a|b\n[search]\ninitial = 16\npopulation = 12\n"
        "max_evals = 60\nthreads = 1\n",
        "", "", 3);
}

TEST(devices_have_the_same_bytes_over_ranks)
{
    expect_same_bytes(
        "devices",
        "[motion]\nrecord = builtin:kobe-like\npga_g = 0.3\n[sim]\nduration_s = 6\n[design]\nvariables = "
        "gaps, thickness, links, tuned_mass\ndevices = gap, link, none\ngap_zones = 2\nlink_zones = 2\n"
        "device_zones = 2\n[search]\ninitial = 12\npopulation = 12\nmax_evals = 24\npolish = 0\nthreads = 1\n",
        "", "", 3);
}

TEST(isolated_simulations_have_the_same_bytes_over_ranks)
{
    expect_same_bytes("isolated", ISOLATED, "--set run.isolate=no", "", 3);
}

/* Three processes that simulate for ranks are shot while they run. */
TEST(an_isolated_simulation_that_crashes_ends_its_design_alone_on_a_rank_too)
{
    program();
    write_in_place("isolated.ini", ISOLATED);
    const pid_t pid = launch(3, "optimize @/isolated.ini --out @/shot --max-evals 250 --set sim.accuracy=fine");
    wait_for_evaluations("shot");
    const pid_t rank[] = {process_of(pid, 1), process_of(pid, 2)};
    const double until = clock_seconds() + 60; /* one that has ended is there until it is waited for */
    for (int n = 0, k = 0; n < 3 && clock_seconds() < until; k++) {
        rest(0.005);
        n += signal_child_of(rank[k % 2], "KILL");
    }
    expect_code(pid, 0);
    assert_words_in(all_of("shot"), "its process ended: Killed");
}

TEST(other_commands_give_their_tasks_to_the_ranks)
{
    program();
    static const char SIMULATE[] = "simulate @/tower.ini --design @/designs.csv --replicates 3 --csv -";
    const char *variables = "gap_01_m,gap_02_m,gap_03_m,gap_04_m,gap_05_m,gap_06_m,gap_07_m,gap_08_m,gap_09_m,gap_10_m,"
                            "gap_11_m,gap_12_m,gap_13_m,gap_14_m,gap_15_m,gap_16_m,gap_17_m,gap_18_m,gap_19_m,gap_20_m,"
                            "t_base_m,t_top_m\n";
    char designs[4096] = "";
    append(designs, "%s", variables);
    for (int i = 0; i < 6; i++)
        for (int j = 0; j < 22; j++)
            append(designs, "%g%c", j < 20 ? 0.01 + 0.003 * ((i + j) % 7) : 0.02 - 0.005 * (j - 20),
                   j < 21 ? ',' : '\n');
    write_in_place("designs.csv", designs);
    write_in_place("tower.ini", TOWER);
    static const char EVALUATE[] = "evaluate @/alone --design knee --record builtin:kobe-like --record "
                                   "builtin:elcentro-like --replicates 3 --csv -";
    static const char IDA[] = "evaluate @/alone --design knee --pga 0.1:0.1:0.3 --csv -";
    static const char SLOPES[] = "simulate @/tower.ini --design @/alone:knee --replicates 2 --sensitivity --csv -";
    if (finished_in("alone") == 0)
        free(output_of("optimize @/tower.ini --out @/alone"));
    FOR_EACH (const char *, command, SIMULATE, EVALUATE, IDA, SLOPES) {
        FREED char *alone = output_of("%s", *command);
        expect_code(launch(3, "%s", *command), 0);
        assert_text(read_in_place("said"), alone);
    }
}

/* -- faults ---------------------------------------------------------------------------------------------------------- */

enum { MPIRUN = -1 };

static void remove_run(const char *name)
{
    expect_shell("rm -rf '%s/%s'", place.folder, name);
}

static void kill_and_resume(const char *study, int rank, int code)
{
    program();
    write_in_place("killed.ini", study);
    remove_run("killed");
    remove_run("whole");
    const pid_t mpirun = launch(4, "optimize @/killed.ini --out @/killed");
    wait_for_evaluations("killed");
    const size_t before = finished_in("killed");
    kill(rank == MPIRUN ? mpirun : process_of(mpirun, rank), SIGKILL);
    assert_int_equal(code_of(mpirun), code);
    rest(rank == MPIRUN ? 2.0 : 0.0);
    assert_at_most(before, finished_in("killed"));
    expect_said("!stopped on request", rank > 0 ? "process rank 2" : "");
    expect_code(launch(3, "optimize @/killed"), 0);
    free(output_of("optimize @/killed.ini --out @/whole --threads 3"));
    assert_same_evaluations("whole", "killed");
}

TEST(a_killed_rank_is_named_and_the_same_command_goes_on)
{
    static const char LONGER[] = "[motion]\nrecord = builtin:kobe-like\nrecords = builtin:elcentro-like\npga_g = 0.3\n"
                                 "[sim]\nduration_s = 12\nreplicates = 2\ngap_tolerance_m = 0.001\n"
                                 "[search]\ninitial = 24\npopulation = 16\nmax_evals = 160\nsurrogate = off\n"
                                 "threads = 1\n";
    kill_and_resume(LONGER, 2, 128 + SIGKILL);
}

/* Also while it finds out which motions are seen first; every start has another number of ranks. A run that ends before
 * it is killed makes room for the next. */
TEST(a_race_that_is_killed_at_random_moments_ends_with_the_same_bytes)
{
    enum { STARTS = 5 };
    static const char START[] = "optimize @/race.ini --out @/killed";
    int n_killed = 0;
    program();
    remove_run("killed");
    write_in_place("race.ini", RACE);
    const double begun = clock_seconds();
    expect_code(launch(3, "optimize @/race.ini --out @/race-on-3"), 0);
    const double whole = clock_seconds() - begun;
    srand(7);
    for (int i = 0; i < STARTS; i++) {
        long pid[16];
        const pid_t mpirun = launch(2 + i % 3, "%s", START);
        rest(whole * rand() / RAND_MAX);
        const int n = ranks_of(mpirun, pid);
        if (n > 0)
            kill((pid_t)pid[rand() % n], SIGKILL);
        if (code_of(mpirun) != 0) {
            n_killed++;
            continue;
        }
        assert_same_evaluations("race-on-3", "killed");
        remove_run("killed");
    }
    assert_less(0, n_killed);
    expect_code(launch(4, "%s", START), 0);
    assert_same_evaluations("race-on-3", "killed");
}

TEST(a_killed_rank_0_loses_nothing)
{
    kill_and_resume(STEADY, 0, 128 + SIGKILL);
}

TEST(a_killed_mpirun_loses_nothing)
{
    kill_and_resume(STEADY, MPIRUN, 128 + SIGKILL);
}

TEST(a_rank_that_hangs_is_taken_for_dead_and_named)
{
    program();
    write_in_place("steady.ini", STEADY);
    const pid_t mpirun = launch(3, "optimize @/steady.ini --out @/hangs");
    wait_for_evaluations("hangs");
    kill(process_of(mpirun, 1), SIGSTOP);
    expect_code(mpirun, 75);
    expect_said("rank 1 on ", "was taken for dead", "Resume it with");
}

TEST(a_simulator_that_does_not_answer_is_a_timeout_on_a_rank_that_lives)
{
    program();
    write_in_place("deaf.ini", "[problem]\nkind = external\ncommand = sh tests/worker.sh silent\nvariables = 3\n"
                               "objectives = 2\ntimeout_s = 0.5\n[search]\nmax_evals = 12\ninitial = 12\n"
                               "population = 12\nthreads = 1\n");
    expect_code(launch(4, "optimize @/deaf.ini --out @/deaf"), 0);
    FREED char *all = all_of("deaf");
    assert_int_equal(count(all, ",timeout,"), 4);
}

TEST(a_stop_passed_on_by_mpirun_ends_with_75_and_goes_on)
{
    program();
    write_in_place("steady.ini", STEADY);
    const pid_t mpirun = launch(3, "optimize @/steady.ini --out @/stopped");
    wait_for_evaluations("stopped");
    kill(mpirun, SIGUSR1);
    expect_code(mpirun, 75);
    expect_said("Resume it with");
    expect_code(launch(2, "optimize @/stopped"), 0);
    free(output_of("optimize @/steady.ini --out @/never-stopped"));
    assert_same_evaluations("never-stopped", "stopped");
}

static pid_t child_of(pid_t parent)
{
    const double until = clock_seconds() + 10;
    while (clock_seconds() < until) {
        long pid[16];
        if (ranks_of(parent, pid) > 0)
            return (pid_t)pid[0];
        rest(0.05);
    }
    fail_msg("process %d has no child", (int)parent);
    return 0;
}

/* What mpirun makes of it otherwise: 1, 143, 137. */
TEST(under_imtet_mpirun_a_signal_and_a_killed_rank_end_with_75)
{
    program();
    write_in_place("steady.ini", STEADY);
    launcher = "scripts/imtet-mpirun";
    pid_t wrapper = launch(3, "optimize @/steady.ini --out @/wrapped --max-evals 1500");
    wait_for_evaluations("wrapped");
    kill(wrapper, SIGTERM);
    expect_code(wrapper, 75);
    expect_said("Resume it with");
    wrapper = launch(3, "optimize @/wrapped");
    rest(2.5);
    kill(process_of(child_of(wrapper), 1), SIGKILL);
    expect_code(wrapper, 75);
    expect_said("process rank 1");
    launcher = "mpirun";
}

TEST(another_program_or_record_on_a_rank_is_refused_by_name)
{
    const char *other = getenv("IMTET_MPI_OTHER");
    program();
    if (!other)
        skip();
    expect_shell(
        "cd '%s' && mkdir -p here there && seq 1 400 | awk '{ print 0.01 * $1 \",\" sin($1 / 9) }' > here/r.csv && "
        "awk -F, '{ print $1 \",\" (-$2) }' here/r.csv > there/r.csv",
        place.folder);
    write_in_place("tower.ini", TOWER);
    const char *in = place.folder;
    expect_code(spawn(brief("exec mpirun -n 2 '%s' optimize '%s/tower.ini' --out '%s/x' : "
                            "-n 1 '%s' optimize x >'%s/said' 2>&1",
                            program(), in, in, other, in)),
                65);
    expect_said("rank 2 on ", "all ranks must be one program");
    expect_code(spawn(brief("set -- optimize '%s/tower.ini' --set motion.records=none --set motion.record=r.csv "
                            "--set motion.unit=m_s2 --out '%s/y'; exec mpirun -n 2 -wdir '%s/here' '%s' \"$@\" : "
                            "-n 1 -wdir '%s/there' '%s' \"$@\" >'%s/said' 2>&1",
                            in, in, in, program(), in, program(), in)),
                65);
    expect_said("rank 2 on ", "reads other files than rank 0");
    expect_code(spawn(brief("exec mpirun -n 2 '%s' optimize '%s/tower.ini' --out '%s/z' : "
                            "-n 1 '%s' status '%s' >'%s/said' 2>&1",
                            program(), in, in, program(), in, in)),
                65);
    expect_said("has another command line than rank 0");
}

/* Rank 1 reads millions of samples, of which rank 0 knows nothing; without the stop it is refused for them. */
TEST(a_stop_while_ranks_open_the_problem_ends_at_once)
{
    int reads = 0;
    program();
    write_in_place("tower.ini", TOWER);
    write_in_place("said", "");
    expect_shell(
        "cd '%s' && mkdir -p long short && seq 1 2000000 | awk '{ print 0.01 * $1 \",\" sin($1 / 9) }' > long/r.csv && "
        "head -400 long/r.csv > short/r.csv",
        place.folder);
    const pid_t mpirun =
        spawn(brief("set -- optimize '%s/tower.ini' --set motion.records=none --set motion.record=r.csv --set "
                    "motion.unit=m_s2 --out '%s/y'; "
                    "exec mpirun -n 1 -wdir '%s/short' '%s' \"$@\" : -n 1 -wdir '%s/long' '%s' \"$@\" >'%s/said' 2>&1",
                    place.folder, place.folder, place.folder, program(), place.folder, program(), place.folder));
    for (int i = 0; i < 1000 && !reads; i++) {
        rest(0.02);
        FREED char *said = read_in_place("said");
        reads = strstr(said, "r.csv: ") != NULL;
    }
    kill(mpirun, SIGUSR1);
    expect_code(mpirun, 75);
}

/* A server for hours keeps no processor of a cluster. */
TEST(of_a_command_without_evaluations_only_rank_0_goes_on)
{
    long pid[16];
    program();
    write_in_place("small.ini", DTLZ2_INI(4, 2) "[search]\ninitial = 12\n"
                                                "population = 12\nmax_evals = 24\nsurrogate = off\nthreads = 1\n");
    free(output_of("optimize @/small.ini --out @/small"));
    write_in_place("said", "");
    const pid_t mpirun = launch(3, "serve @/small");
    int n = 0;
    for (int i = 0; i < 200; i++) {
        FREED char *said = read_in_place("said");
        const int serves = strstr(said, "Ctrl-C") != NULL;
        if ((n = ranks_of(mpirun, pid)) == 1 && serves)
            break;
        rest(0.1);
    }
    assert_int_equal(n, 1);
    assert_int_equal(kill((pid_t)pid[0], SIGINT), 0);
    expect_code(mpirun, 0);
}

TEST(a_message_that_is_cut_or_of_no_worker_is_none)
{
    union {
        Answer head;
        char bytes[sizeof(Answer) + 64];
    } right = {.head = {.worker = 3, .n_done = 1}}, bad = {.head = {.why.code = STATUS_BAD_DATA}};
    char part[16];
    const Task task = {.result = part, .size = sizeof part};
    const size_t none = sizeof(Answer), whole = none + sizeof part;
    for (size_t n = 0; n < whole + 2; n++) {
        assert_int_equal(order_take(&right.head, n, &(Worker){.task = &task, .n = 1}), n == whole);
        assert_int_equal(order_take(&bad.head, n, &(Worker){.task = &task, .n = 1}), n == none);
        assert_int_equal(is_answer_of(&right.head, n, 4), n >= none);
        assert_false(is_answer_of(&right.head, n, 3));
    }
    right.head.n_done = 2;
    assert_false(order_take(&right.head, whole + sizeof part, &(Worker){.task = &task, .n = 1}));
    bad.head.why.code = STATUS_COUNT;
    assert_false(order_take(&bad.head, none, &(Worker){.task = &task, .n = 1}));
}

static int prepare(void **state)
{
    if (geteuid() == 0) {
        setenv("OMPI_ALLOW_RUN_AS_ROOT", "1", 1);
        setenv("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1", 1);
    }
    setenv("OMPI_MCA_rmaps_base_oversubscribe", "1", 1);
    setenv("OMP_WAIT_POLICY", "passive", 0);
    return make_place(state);
}

SUITE(prepare, clear_place)
