#include <string.h>

#include "bench/parted.h"
#include "bench/throughput.h"
#include "cmd/commands.h"
#include "store/output.h"
#include "scene/motion_source.h"
#include "settings/settings.h"

typedef struct {
    SceneOptions options;
    Motion motion;
    Sweep sweep;
    Parted parted;
    SweepPlan plan;
    unsigned scenes; /* bit by scene */
    int quick;
} Bench;

static const double PARTED_LIMIT_S = 0.4; /* for one run; there are 64 */

/* The words of a comma-separated list as bits; NULL: all. */
static Status choose(const char *list, const char *what, const char *const known[], int n, unsigned *bits, Err *err)
{
    *bits = list ? 0 : (1u << n) - 1;
    while (list && *list) {
        const size_t length = strcspn(list, ",");
        char word[64];
        snprintf(word, sizeof word, "%.*s", (int)length, list);
        int k = 0;
        while (k < n && strcmp(word, known[k]) != 0)
            k++;
        if (k == n)
            return args_unknown(what, word, known, n, "`imtet bench --help`", err);
        *bits |= 1u << k;
        list += length + (list[length] == ',');
    }
    return STATUS_OK;
}

static Status prepare(const Args *args, Bench *b, Err *err)
{
    const char *scenes[N_BENCH_SCENES], *engines[ENGINE_COUNT];
    for (int k = 0; k < N_BENCH_SCENES; k++)
        scenes[k] = bench_scene(k)->name;
    for (int k = 0; k < ENGINE_COUNT; k++)
        engines[k] = engine_entry((Engine)k)->name;
    TRY(choose(args_value(args, "--scene"), "scene", scenes, N_BENCH_SCENES, &b->scenes, err));
    TRY(choose(args_value(args, "--engine"), "engine", engines, ENGINE_COUNT, &b->plan.engines, err));
    b->quick = args_has(args, "--quick");
    b->plan.limit_s = b->quick ? 0.3 : 2;
    Settings s;
    settings_defaults(&s);
    s.core.theory = CORE_EULER_BERNOULLI; /* the core of the paper, as in configs/kobe.ini */
    TRY(args_apply(args, &s, NULL, NULL, err));
    TRY(settings_check(&s, err));
    b->options = settings_scene(&s);
    TRY(motion_load(&b->motion, s.motion.record, s.motion.unit, err));
    return motion_prepare(&b->motion, s.motion.pga_g, s.motion.stretch, err);
}

static Status run_scene(Bench *b, int k, Err *err)
{
    Stage stage = {0};
    Status status = stage_open(&stage, bench_scene(k), &b->options, &b->motion, b->quick, err);
    if (status == STATUS_OK)
        status = sweep_scene(&b->sweep, k, &stage, &b->plan, stderr, err);
    if (status == STATUS_OK && !b->quick && strcmp(stage.scene->name, "irregular") == 0)
        status = parted_run(&b->parted, &b->sweep, &stage, &b->options, PARTED_LIMIT_S, stderr, err);
    stage_close(&stage);
    return status;
}

static Status write_to(const char *path, const Bench *b, int markdown, Err *err)
{
    Output o;
    TRY(output_open(&o, path, err));
    if (markdown) {
        sweep_write_markdown(&b->sweep, &b->motion, o.stream);
        parted_write_markdown(&b->parted, o.stream);
    } else {
        sweep_write_csv(&b->sweep, o.stream);
    }
    return output_close(&o, err);
}

static Status run_sweep(const Args *args, Bench *b, Err *err)
{
    Status status = STATUS_OK;
    for (int k = 0; k < N_BENCH_SCENES && status == STATUS_OK; k++)
        if (b->scenes >> k & 1)
            status = run_scene(b, k, err);
    TRY(status);
    if (!b->quick)
        TRY(sweep_find_noise(&b->sweep, &b->options, &b->motion, err));
    if (args_has(args, "--markdown"))
        TRY(write_to(args_value(args, "--markdown"), b, 1, err));
    if (args_has(args, "--csv"))
        return write_to(args_value(args, "--csv"), b, 0, err);
    if (!args_has(args, "--markdown"))
        sweep_write_csv(&b->sweep, stdout);
    return STATUS_OK;
}

static Status run(const Args *args, Err *err)
{
    Bench b = {0};
    Status status = prepare(args, &b, err);
    if (status == STATUS_OK)
        status = args_has(args, "--throughput")
                     ? throughput_print(&b.options, &b.motion, b.quick, args_has(args, "--count"), stdout, err)
                     : run_sweep(args, &b, err);
    sweep_free(&b.sweep);
    motion_free(&b.motion);
    return status;
}

static const ArgOption OPTIONS[] = {
    {"--scene", "NAME,...", NULL, 0, "linear, one-impact, irregular, tiny, zero; all unless given"},
    {"--engine", "NAME,...", NULL, 0, "as the setting sim.engine; all unless given"},
    {"--throughput", NULL, NULL, 0, "instead: designs per second over the whole motion, and ratios of engines"},
    {"--count", NULL, NULL, 0, "with --throughput: four designs by the fast engine, and nothing else"},
    {"--quick", NULL, NULL, 0, "half the time, fewer settings and designs"},
    {"--markdown", "FILE", NULL, 0, "tables of what each engine needs for a given error, and of what failed"},
    OPTION_CSV,
    OPTION_RECORD,
    OPTION_PGA,
    OPTION_STRETCH,
    OPTION_UNIT,
    OPTION_SET,
    OPTION_END,
};

const Command CMD_BENCH = {
    .name = "bench",
    .operand = NULL,
    .summary = "speed against accuracy of every engine",
    .example = "imtet bench --quick --scene irregular --engine fast,etdrk4",
    .details =
        "Runs every engine at many settings of its knob on short windows of one ground motion and compares each\n"
        "run with a reference that two unrelated methods agree on. What it does goes to standard error, the\n"
        "table to standard output. Timings want the machine to themselves.",
    .options = OPTIONS,
    .run = run,
};
