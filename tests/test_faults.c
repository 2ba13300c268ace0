/* Requests for memory, and writes, refused one after the other while the program runs: it says so and ends with the
 * status that stands for it, or it does without and the result is the same. FAULTS=800 in the environment: so many of
 * each kind and command, evenly spread where there are more. */
#include "runs.h"

enum { SOME = 3 }; /* refusals of one kind in one command */

typedef struct {
    const char *command; /* @: the test's own folder */
    const char *result;  /* a file there that must be the same; NULL: standard output */
} Deed;

#define STUDY(folder)                                                                                                  \
    "optimize configs/quick.ini " SIX_FLOORS "--max-evals 24 --threads 1 --out " folder " --set search.initial=16 "    \
    "--set search.population=8 --set sim.duration_s=6"

static const Deed DEEDS[] = {
    {"settings", NULL},
    {"check configs/quick.ini", NULL},
    {"building configs/quick.ini", NULL},
    {"simulate configs/quick.ini --design none --set sim.duration_s=20 --csv -", NULL},
    {"simulate configs/quick.ini --design none --set sim.duration_s=20 --set sim.engine=cvode --csv -", NULL},
    {"spectrum tests/motion/three.cosmos.v2 --set motion.channel=1 --json", NULL},
    {"evaluate @/done --design knee --record tests/motion/many_columns.csv --set motion.channel=NS", NULL},
    {"choose @/done --reference j1_m=0.3", NULL},
    {"export @/done --csv @/run", "run"},
    {"export @/done --json", NULL},
    {"report @/done --out @/run --record builtin:sylmar-like", "run"},
    {"report @/done --pictures @/run --record builtin:sylmar-like", "run/gaps.svg"},
    {"status @/done", NULL},
    {STUDY("@/run"), "run/front.csv"}};
enum { N_DEEDS = sizeof DEEDS / sizeof DEEDS[0] };

static void remove_run(void)
{
    shell_in_place("rm -rf run");
}

/* Without the lines of times that were measured. */
static char *result_of(const Deed *deed, const Said *said)
{
    static const char *const TIMES[] = {"\n  simulation_s ", "\n  search_s ", "\n  baselines_s ", "\n  seconds "};
    char *text = deed->result ? read_in_place(deed->result) : strdup(said->out);
    for (size_t i = 0; i < sizeof TIMES / sizeof TIMES[0] && !deed->result; i++) {
        char *line = strstr(text, TIMES[i]), *end = line ? strchr(line + 1, '\n') : NULL;
        if (end)
            memmove(line, end, strlen(end) + 1);
    }
    return text;
}

/* How one refusal may end. */
typedef struct {
    const char *what;
    int code;     /* of the exit */
    int or_other; /* also right, for a fault in the midst of something else */
} Ending;

static void judge(const Deed *deed, long k, const Said *said, const char *wanted, const Ending *ending)
{
    if (said->code == ending->code || said->code == ending->or_other) {
        if (!said->err[0])
            fail_msg("%s: %s %ld: ends with %d and says nothing", deed->command, ending->what, k, said->code);
        return;
    }
    if (said->code != 0)
        fail_msg("%s: %s %ld: exit %d: %s", deed->command, ending->what, k, said->code, said->err);
    FREED char *result = result_of(deed, said);
    if (strcmp(result, wanted) != 0)
        fail_msg("%s: %s %ld: exit 0, but the result differs", deed->command, ending->what, k);
}

static long steps_between(long n)
{
    const char *wanted = getenv("FAULTS");
    const long most = wanted ? strtol(wanted, NULL, 10) : SOME;
    assert_less(0, most);
    return n <= most ? 1 : (n + most - 1) / most;
}

/* ---- memory ---------------------------------------------------------------------------------------------------- */

static void refuse_memory(long k)
{
    char shim[PATH_MAX] = "";
    assert_less(0, readlink("/proc/self/exe", shim, PATH_MAX - 32));
    strcpy(strrchr(shim, '/'), "/fault/nomem.so");
    snprintf(place.under, sizeof place.under, "env LD_PRELOAD='%.120s' NOMEM_AT=%ld NOMEM_COUNT='%s/count' ", shim, k,
             place.folder);
}

static long count_requests(void)
{
    FREED char *text = read_in_place("count");
    return strtol(text, NULL, 10);
}

static void sweep_memory(const Deed *deed)
{
    static const Ending ENDING = {"request for memory", 71, 74}; /* 74: of a file that is being written */
    Said said;
    remove_run();
    refuse_memory(0);
    run(&said, "%s", deed->command);
    assert_int_equal(said.code, 0);
    FREED char *wanted = result_of(deed, &said);
    forget(&said);
    const long n = count_requests(), step = steps_between(n);
    for (long k = 1; k <= n; k += step) {
        remove_run();
        refuse_memory(k);
        run(&said, "%s", deed->command);
        place.under[0] = 0;
        judge(deed, k, &said, wanted, &ENDING);
        forget(&said);
    }
    print_message("%ld of %ld requests for memory refused: imtet %.60s\n", (n + step - 1) / step, n, deed->command);
}

TEST(without_memory_the_program_says_so_or_gives_the_same_result)
{
    for (int i = 0; i < N_DEEDS; i++)
        if (!strstr(DEEDS[i].command, "--pictures") || has_browser())
            sweep_memory(&DEEDS[i]);
}

/* A sanitizer needs more for itself. */
TEST(too_little_address_space_or_stack_is_said_at_once)
{
    static const struct {
        const char *limit, *command, *words;
    } CASES[] = {
        {"ulimit -v 300000; timeout 60", "building configs/quick.ini", "address space is limited to 292 MiB"},
        {"ulimit -s 64; timeout 60", "optimize @/textbook.ini --out @/narrow", "the stack is limited to 64 kB"}};
    write_in_place("textbook.ini", TEXTBOOK);
    for (size_t i = 0; i < sizeof CASES / sizeof CASES[0]; i++) {
        snprintf(place.under, sizeof place.under, "%s", CASES[i].limit);
        expect(71, CASES[i].words, CASES[i].command);
    }
    for (int kb = 250000; kb <= 650000; kb += 100000) { /* enough or not: it ends */
        OWNED(forget) Said said;
        snprintf(place.under, sizeof place.under, "ulimit -v %d; timeout -s KILL 60", kb);
        run(&said, "optimize @/textbook.ini --threads 2 --new --out @/narrow");
        if (said.code != 71 && (said.code != 0 || kb < 300000))
            fail_msg("%d kB: %d: %s", kb, said.code, said.err);
    }
    place.under[0] = 0;
}

/* ---- writes ---------------------------------------------------------------------------------------------------- */

/* What the system refuses, by strace, which changes nothing in the program. */
typedef struct {
    const char *call, *error; /* strace counts each call by itself */
    Ending ending;
} Refusal;

static const Refusal REFUSALS[] = {
    {"write", "ENOSPC", {"write", 74, 74}},      {"pwrite64", "ENOSPC", {"pwrite64", 74, 74}},
    {"ftruncate", "EIO", {"ftruncate", 74, 74}}, {"fsync", "EIO", {"fsync", 74, 74}},
    {"fdatasync", "EIO", {"fdatasync", 74, 74}}, {"rename", "EACCES", {"rename", 74, 74}}};

static long count_calls(const Refusal *r, const char *command)
{
    OWNED(forget) Said said;
    snprintf(place.under, sizeof place.under, "strace -f --seccomp-bpf -e trace=%s -o '%s/calls' ", r->call,
             place.folder);
    run(&said, "%s", command);
    place.under[0] = 0;
    assert_int_equal(said.code, 0);
    FREED char *calls = read_in_place("calls");
    return count(calls, "\n");
}

static void refuse_call(const Refusal *r, long k)
{
    snprintf(place.under, sizeof place.under,
             "strace -f --seccomp-bpf -e trace=%s -e inject=%s:error=%s:when=%ld -o /dev/null ", r->call, r->call,
             r->error, k);
}

/* What is left goes on to the same end, as if nothing had been. */
static void go_on(const Deed *deed, long k, const char *wanted)
{
    OWNED(forget) Said said;
    run(&said, "%s", deed->command);
    FREED char *result = said.code == 0 ? result_of(deed, &said) : strdup("");
    if (said.code != 0 || strcmp(result, wanted) != 0)
        fail_msg("%s: after refusal %ld it does not go on to the same end: exit %d: %s", deed->command, k, said.code,
                 said.err);
}

static void sweep_writes(const Deed *deed, const Refusal *r)
{
    Said said;
    remove_run();
    const long n = count_calls(r, deed->command), step = steps_between(5 * n);
    FREED char *wanted = result_of(deed, &(Said){.out = ""});
    for (long k = 1; k <= n; k += step) {
        remove_run();
        refuse_call(r, k);
        run(&said, "%s", deed->command);
        place.under[0] = 0;
        judge(deed, k, &said, wanted, &r->ending);
        forget(&said);
        go_on(deed, k, wanted);
    }
    print_message("%ld of %ld of %s refused: imtet %.60s\n", (n + step - 1) / step, n, r->call, deed->command);
}

TEST(a_write_that_fails_is_told_and_the_run_goes_on_to_the_same_front)
{
    static const Deed EXPORT = {"export @/done --csv @/run", "run"}, STUDY = {STUDY("@/run"), "run/front.csv"};
    if (system("strace -f -o /dev/null true >/dev/null 2>&1") != 0)
        skip();
    for (size_t i = 0; i < sizeof REFUSALS / sizeof REFUSALS[0]; i++) {
        sweep_writes(&EXPORT, &REFUSALS[i]);
        sweep_writes(&STUDY, &REFUSALS[i]);
    }
}

static void make_run(void)
{
    free(output_of(STUDY("@/done")));
}

SUITE_FILLED(make_place, make_run, clear_place)
