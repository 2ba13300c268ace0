/* bench/main.c -- the program imtet-bench: engines compared by speed, accuracy and reliability.
 *
 *   imtet-bench sweep | throughput | promise | stability | laws | search | loop | schedule | problem [--option [VALUE]] ... */
#include <cblas.h>
#include <string.h>

#include "base/text.h"
#include "bench/schedule.h"
#include "bench/search/factors.h"
#include "bench/search/loop.h"
#include "bench/stability/laws.h"
#include "bench/stability/stability.h"
#include "bench/sweep.h"
#include "bench/throughput.h"
#include "bench/promise.h"
#include "bench/paper.h"
#include "bench/problem.h"
#include "cmd/args.h"
#include "cmd/document.h"
#include "motion/motion_scale.h"
#include "store/output.h"

typedef struct {
    SceneOptions options;
    Motion motion;
    int quick;
} Bench;

/* The defaults as the command line changes them. */
static Status settings_of(const Args *args, void (*defaults)(Settings *), Settings *s, Err *err)
{
    defaults(s);
    TRY(args_apply(args, s, NULL, NULL, err));
    return settings_check(s, err);
}

static Status prepare(const Args *args, Bench *b, Err *err)
{
    b->quick = args_has(args, "--quick");
    Settings s;
    TRY(settings_of(args, paper_defaults, &s, err));
    b->options = settings_scene(&s);
    TRY(motion_load(&b->motion, s.motion.record, UNIT_FROM_FILE, err));
    return motion_prepare(&b->motion, s.motion.pga_g, s.motion.stretch, err);
}

/* ---- speed against accuracy -------------------------------------------------------------------------------------- */

typedef struct {
    Bench bench;
    Sweep sweep;
    SweepPlan plan;
    unsigned kinds; /* bit by benchmark case */
} Chart;

/* The words of a comma-separated list as bits; NULL: all. */
static Status choose(const char *list, const char *what, const char *const known[], int n, unsigned *bits, Err *err)
{
    *bits = list ? 0 : (1u << n) - 1;
    while (list && *list) {
        const size_t length = strcspn(list, ",");
        char word[64];
        snprintf(word, sizeof word, "%.*s", (int)length, list);
        const int k = (int)index_of_word(word, known, (size_t)n);
        if (k == n)
            return args_unknown(what, word, known, n, "`imtet-bench sweep --help`", err);
        *bits |= 1u << k;
        list += length + (list[length] == ',');
    }
    return STATUS_OK;
}

static Status choose_all(const Args *args, Chart *c, Err *err)
{
    const char *kinds[N_BENCH_KINDS], *engines[BENCH_ENGINES];
    for (int k = 0; k < N_BENCH_KINDS; k++)
        kinds[k] = bench_kind(k)->name;
    for (int k = 0; k < BENCH_ENGINES; k++)
        engines[k] = bench_engine(k)->name;
    TRY(choose(args_value(args, "--case"), "case", kinds, N_BENCH_KINDS, &c->kinds, err));
    return choose(args_value(args, "--engine"), "engine", engines, BENCH_ENGINES, &c->plan.engines, err);
}

static Status run_case(Chart *c, int k, Err *err)
{
    const Bench *b = &c->bench;
    BenchCase bench_case = {0};
    Status status = bench_case_open(&bench_case, bench_kind(k), &b->options, &b->motion, b->quick, err);
    THEN(status, sweep_run(&c->sweep, k, &bench_case, &c->plan, stderr, err));
    bench_case_close(&bench_case);
    return status;
}

static Status make_chart(const Args *args, Chart *c, Err *err)
{
    TRY(choose_all(args, c, err));
    TRY(prepare(args, &c->bench, err));
    c->plan.limit_s = c->bench.quick ? 0.3 : 2;
    for (int k = 0; k < N_BENCH_KINDS; k++)
        if (c->kinds >> k & 1)
            TRY(run_case(c, k, err));
    Output o;
    TRY(output_open(&o, args_has(args, "--csv") ? args_value(args, "--csv") : "-", err));
    sweep_write(&c->sweep, o.stream);
    return output_close(&o, err);
}

static Status run_sweep(const Args *args, Err *err)
{
    Chart c = {0};
    const Status status = make_chart(args, &c, err);
    sweep_free(&c.sweep);
    motion_free(&c.bench.motion);
    return status;
}

/* ---- designs per second ------------------------------------------------------------------------------------------ */

static Status run_throughput(const Args *args, Err *err)
{
    Bench b = {0};
    Status status = prepare(args, &b, err);
    THEN(status, throughput_print(&b.options, &b.motion, b.quick, args_has(args, "--count"), stdout, err));
    motion_free(&b.motion);
    return status;
}

/* ---- what the accuracies hold ------------------------------------------------------------------------------------ */

enum { RECORDS_MAX = 8 };

/* Every --record, prepared; the built-in motions without one. */
static Status load_records(const Args *args, const Settings *s, Motion records[RECORDS_MAX], int *n, Err *err)
{
    static const char *const BUILTIN[] = {"builtin:kobe-like", "builtin:elcentro-like", "builtin:sylmar-like"};
    const int builtin = !args_has(args, "--record");
    int at = 0;
    for (*n = 0; *n < (builtin ? 3 : RECORDS_MAX);) {
        const char *name = builtin ? BUILTIN[*n] : args_next(args, "--record", &at);
        if (!name)
            break;
        TRY(motion_load(&records[*n], name, UNIT_FROM_FILE, err));
        ++*n;
        TRY(motion_prepare(&records[*n - 1], s->motion.pga_g, s->motion.stretch, err));
    }
    return STATUS_OK;
}

static Status write_promise(const PromisePlan *plan, const char *path, Err *err)
{
    Output o;
    TRY(output_open(&o, path ? path : "-", err));
    return output_end(&o, promise_write(plan, o.stream, stderr, err), err);
}

static Status run_promise(const Args *args, Err *err)
{
    Settings s;
    Motion records[RECORDS_MAX] = {0};
    PromisePlan plan = {.records = records, .front = args_value(args, "--front")};
    TRY(args_whole(args, "--scenes", 1, 100000, 60, &plan.n_scenes, err));
    TRY(settings_of(args, paper_defaults, &s, err));
    const SceneOptions options = settings_scene(&s);
    plan.options = &options;
    Status status = load_records(args, &s, records, &plan.n_records, err);
    THEN(status, write_promise(&plan, args_value(args, "--out"), err));
    for (int k = 0; k < plan.n_records; k++)
        motion_free(&records[k]);
    return status;
}

/* ---- where methods fail ------------------------------------------------------------------------------------------ */

static Status run_stability(const Args *args, Err *err)
{
    StabilityPlan plan = {.size = args_has(args, "--quick")  ? SIZE_QUICK
                                  : args_has(args, "--long") ? SIZE_LONG
                                                             : SIZE_FULL,
                          .engine = args_value(args, "--engine"),
                          .one_case = args_value(args, "--case"),
                          .out = args_value(args, "--out")};
    TRY(args_whole(args, "--seconds", 1, 1000000, 20, &plan.seconds, err));
    return stability(&plan, err);
}

static Status run_laws(const Args *args, Err *err)
{
    return laws(&(LawTables){.curves = args_value(args, "--csv"),
                             .tower = args_value(args, "--tower"),
                             .engines = args_value(args, "--engines")},
                err);
}

/* ---- the search -------------------------------------------------------------------------------------------------- */

static Status run_factors(const Args *args, Err *err)
{
    Settings s;
    FactorPlan plan = {.settings = &s,
                       .problems = args_value(args, "--problem"),
                       .aside = args_has(args, "--mixed") ? 3 : args_has(args, "--aside")};
    const long budgets[] = {300, 500, 1000};
    TRY(settings_of(args, settings_defaults, &s, err));
    TRY(args_whole(args, "--seeds", 1, 16, 5, &plan.n_seeds, err));
    TRY(args_whole(args, "--first-seed", 0, 1000000, 101, &plan.first_seed, err));
    if (args_has(args, "--evals"))
        TRY(args_whole(args, "--evals", 100, 100000, 300, &plan.budgets[0], err));
    else
        memcpy(plan.budgets, budgets, sizeof budgets);
    return factors_run(&plan, stdout, err);
}

static Status run_loop(const Args *args, Err *err)
{
    Settings s;
    Output o;
    LoopPlan plan = {.settings = &s};
    TRY(settings_of(args, paper_defaults, &s, err));
    TRY(args_whole(args, "--seeds", 1, 100, 3, &plan.n_seeds, err));
    TRY(args_whole(args, "--iterations", 1, 10000, 100, &plan.iterations, err));
    TRY(args_number(args, "--error", 0.0, 1e9, 0.15, &plan.error_max, err));
    TRY(output_open(&o, args_has(args, "--csv") ? args_value(args, "--csv") : "-", err));
    return output_end(&o, loop_run(&plan, o.stream, err), err);
}

static Status run_schedule(const Args *args, Err *err)
{
    SchedulePlan plan = {.folder = args->operand};
    TRY(args_whole(args, "--from", 0, LONG_MAX, 0, &plan.from, err));
    TRY(args_whole(args, "--apart", 0, 4096, 0, &plan.apart, err));
    return schedule(&plan, stdout, err);
}

/* ---- the command line -------------------------------------------------------------------------------------------- */
#define COMMAND(word, takes, function, sentence, first_example, text, ...)                                             \
    {                                                                                                                  \
        .name = word, .operand = takes, .run = function, .summary = sentence, .example = first_example,                \
        .details = text, .program = "imtet-bench", .options = {                                                        \
            __VA_ARGS__                                                                                                \
        }                                                                                                              \
    }
static const Command COMMANDS[] = {
    COMMAND("sweep", NULL, run_sweep, "speed against accuracy of every engine",
            "imtet-bench sweep --quick --case irregular --engine fast,etdrk4",
            "Runs every engine at many tolerances on short windows of one ground motion and compares each run with\n"
            "a reference that two unrelated methods agree on. Progress goes to standard error, the table to\n"
            "standard output. Timings want the machine to themselves.",
            {"--case", "NAME,...", NULL, 0, "linear, one-impact, irregular, tiny, zero; all unless given"},
            {"--engine", "NAME,...", NULL, 0, "all unless given"}, {"--quick", NULL, NULL, 0, "half the time"},
            OPTION_CSV, OPTIONS_MOTION, OPTION_SET),
    COMMAND("throughput", NULL, run_throughput, "designs per second over the whole motion, and ratios of engines",
            "imtet-bench throughput --quick",
            "Runs 24 designs with irregular gaps by the engine fast on one thread and compares its time\n"
            "with that of other engines at equal error. Timings want the machine to themselves.",
            {"--count", NULL, NULL, 0, "four designs by the fast engine, and nothing else: counts of its work"},
            {"--quick", NULL, NULL, 0, "fewer designs, shorter comparisons"}, OPTIONS_MOTION, OPTION_SET),
    COMMAND("promise", NULL, run_promise, "how often every accuracy holds what it promises",
            "imtet-bench promise --scenes 10",
            "Runs random scenes of six kinds of gaps, and of four effects, by the engine fast at every "
            "accuracy: quantiles of the errors\n"
            "against accuracy fine, share of the predictable ones that hold the promise, time; true over likely\n"
            "error; and fine against CVODE in a tenth of the log-uniform ones. Ten scenes take a minute.",
            {"--record", "FILE", NULL, 1, "a ground motion; may be repeated; the built-in ones unless given"},
            {"--scenes", "N", NULL, 0, "random scenes of each of the ten kinds; 60 unless given"},
            {"--front", "FILE", NULL, 0,
             "designs to simulate under all of the first record, as `imtet export` writes them"},
            {"--out", "FILE", NULL, 0, "the table, as CSV"}, OPTION_PGA, OPTION_UNIT, OPTION_SET),
    COMMAND("stability", NULL, run_stability, "where methods fail: every engine through every case",
            "imtet-bench stability --quick --engine fast",
            "Fails where an engine answers wrongly in silence, or where the engine fast does anything but hold. Each\n"
            "cell runs in a process of its own: a crash is a failure of that cell, no answer in time a refusal.",
            {"--quick", NULL, NULL, 0, "smaller cases, for tests"},
            {"--long", NULL, NULL, 0, "also cases of 1e6 and 1e7 steps"},
            {"--engine", "NAME", NULL, 0, "one engine; all unless given"},
            {"--case", "NAME", NULL, 0, "one case; all unless given"},
            {"--seconds", "N", NULL, 0, "processor time of one cell [s]; 20 unless given"},
            {"--out", "FILE", NULL, 0, "the table, as CSV"}),
    COMMAND("laws", NULL, run_laws, "rebound of the contact laws, measured", "imtet-bench laws --csv laws.csv",
            "Rebound against restitution by the engine fast and by an independent integrator, and what the limit "
            "of\nv0 changes. Fails where a law does not return what it is known to, and with --engines where fast or "
            "etdrk4\nis farther from cvode than docs/promise.md says.",
            {"--csv", "FILE", NULL, 0, "the rebound curves"},
            {"--tower", "FILE", NULL, 0, "what the law changes in the tower, as CSV"},
            {"--engines", "FILE", NULL, 0, "fast, cvode and etdrk4 in the tower under every law, as CSV"}),
    COMMAND(
        "search", NULL, run_factors, "evaluations that the surrogate saves, on problems of other families",
        "imtet-bench search --seeds 3",
        "How many evaluations a plain search needs for the IGD+ and the hypervolume that the surrogate reaches, as\n"
        "a multiple, 20 at most: medians over the seeds, the geometric mean over the problems.",
        {"--problem", "LIST", NULL, 0, "some of the problems; all but those kept aside unless given"},
        {"--aside", NULL, NULL, 0, "those kept aside instead"},
        {"--mixed", NULL, NULL, 0, "those with whole numbers and choices instead"},
        {"--evals", "N", NULL, 0, "evaluations; a search of 1000, read after 300, 500 and 1000, unless given"},
        {"--seeds", "N", NULL, 0, "5 unless given"}, {"--first-seed", "N", NULL, 0, "101 unless given"}, OPTION_SET),
    COMMAND("loop", NULL, run_loop, "the loop of the paper's Fig. 6a beside the search",
            "imtet-bench loop --iterations 20 --seeds 1",
            "The paper's genetic algorithm on radial basis functions, and this program's search with as many\n"
            "simulations from the same first designs: a row of every iteration and generation, as CSV.",
            {"--iterations", "N", NULL, 0, "100 unless given"},
            {"--error", "SHARE", NULL, 0, "of the range, that is acceptable; 0.15 unless given; 0: none is"},
            {"--seeds", "N", NULL, 0, "3 unless given; the first is search.seed"}, OPTION_CSV, OPTIONS_MOTION,
            OPTION_SET),
    COMMAND("schedule", "RUN", run_schedule, "a run of one thread replayed on 1 to 64 workers",
            "imtet-bench schedule results/kobe",
            "Efficiency, critical path and waiting, from the times of its designs and of its search. As CSV.",
            {"--from", "N", NULL, 0, "of what is done once the first N designs are there"},
            {"--apart", "N", NULL, 0, "processors that choose designs beside the workers; those choose unless given"}),
    COMMAND("problem", "NAME", problem_run, "the search on a problem from a textbook: dtlz2, wfg4",
            "imtet-bench problem dtlz2 --max-evals 500 --seed 1 --csv dtlz2.csv",
            "Of 22 variables and 7 objectives (problem.variables, problem.objectives); every evaluated design, one "
            "row\neach in their order: variables, then objectives. With --noise the noisy objectives of the search "
            "stand\nbefore the exact ones.",
            SETTING("--max-evals", "N", "search.max_evals", "stop after so many evaluations"),
            SETTING("--seed", "N", "search.seed", "same seed, same settings: same bytes"),
            SETTING("--threads", "N", "search.threads", "0: one per processor"),
            {"--noise", "SHARE", NULL, 0,
             "standard deviation of an objective that the search sees, as a share of its value"},
            OPTION_CSV, OPTION_SET)};
enum { N_COMMANDS = sizeof COMMANDS / sizeof COMMANDS[0] };

static void print_usage(FILE *out)
{
    fprintf(out, "usage: imtet-bench COMMAND [options]\n\n");
    for (int k = 0; k < N_COMMANDS; k++)
        fprintf(out, "  %-11s %s\n", COMMANDS[k].name, COMMANDS[k].summary);
    fprintf(out, "\n`imtet-bench COMMAND --help` shows an example and every option.\n");
}

static Status find_command(const char *word, const Command **command, Err *err)
{
    const char *names[N_COMMANDS];
    for (int k = 0; k < N_COMMANDS; k++) {
        names[k] = COMMANDS[k].name;
        *command = &COMMANDS[k];
        if (strcmp(names[k], word) == 0)
            return STATUS_OK;
    }
    return args_unknown("command", word, names, N_COMMANDS, "`imtet-bench --help`", err);
}

static Status run(int argc, char *argv[], Err *err)
{
    const Command *command;
    Args args;
    if (argc < 2 || strcmp(argv[1], "--help") == 0) {
        print_usage(argc < 2 ? stderr : stdout);
        return argc < 2 ? fail(err, STATUS_USAGE, "no command was given") : STATUS_OK;
    }
    TRY(find_command(argv[1], &command, err));
    Status status = args_parse(&args, command, argc - 2, argv + 2, err);
    if (status == STATUS_OK && args.help)
        command_help(command, stdout);
    else
        THEN(status, command->run(&args, err));
    args_free(&args);
    return status;
}

int main(int argc, char *argv[])
{
    Err err = {0};
    setvbuf(stdout, NULL, _IOLBF, 0);
    openblas_set_num_threads(1); /* designs run side by side */
    Status status = run(argc, argv, &err);
    if ((fflush(stdout) != 0 || ferror(stdout)) && status == STATUS_OK)
        status = fail(&err, STATUS_IO, "standard output: cannot be written");
    if (status != STATUS_OK)
        fprintf(stderr, "imtet-bench: %s\n", err.text[0] ? err.text : status_words(status));
    return status_exit_code(status);
}
