#include <stdlib.h>

#include "cmd/commands.h"
#include "store/export.h"
#include "store/output.h"
#include "store/run_read.h"

/* A well-spread choice of the front: the knee first, then again and again the design farthest from those chosen. */
static Status write_selected(const Args *args, const Run *run, FILE *f, Err *err)
{
    long wanted;
    TRY(args_whole(args, "--select", 1, 1000000, 0, &wanted, err));
    size_t *rows = calloc((size_t)wanted, sizeof *rows);
    if (!rows)
        return fail(err, STATUS_NO_MEMORY, "no memory for %ld designs", wanted);
    const size_t n = run_spread_out(run, (size_t)wanted, 1, rows);
    export_front_header(f, &run->schema);
    for (size_t i = 0; i < n; i++)
        export_design(f, run, rows[i]);
    free(rows);
    return STATUS_OK;
}

static Status select_designs(const Args *args, FILE *f, Err *err)
{
    Run run;
    TRY(run_read(&run, args->operand, err));
    const Status status = write_selected(args, &run, f, err);
    run_free(&run);
    return status;
}

/* Variables go from the database to the table as they are stored: they need no memory. */
static Status write_table(const Args *args, Err *err)
{
    Output o;
    TRY(output_open(&o, args_value(args, "--csv"), err));
    const Status status = args_has(args, "--select") ? select_designs(args, o.stream, err)
                          : args_has(args, "--all")
                              ? run_print_evaluations(args->operand, export_evaluations_header, o.stream, err)
                              : export_front_of(o.stream, args->operand, err);
    return output_end(&o, status, err);
}

static Status run(const Args *args, Err *err)
{
    if (!args_has(args, "--csv") && !args_has(args, "--json"))
        return fail(err, STATUS_USAGE, "--csv FILE is missing: where the table goes (or --json)");
    if (args_has(args, "--all") && args_has(args, "--select"))
        return fail(err, STATUS_USAGE, "--all and --select: every design, or some of the front; choose one");
    if (args_has(args, "--json"))
        TRY(export_json_of(stdout, args->operand, err));
    return args_has(args, "--csv") ? write_table(args, err) : STATUS_OK;
}

static const ArgOption OPTIONS[] = {
    {"--csv", "FILE", NULL, 0, "where it goes; -: standard output"},
    {"--all", NULL, NULL, 0, "every design that was evaluated, with its outcome, instead of the front"},
    {"--select", "N", NULL, 0, "N designs of the front that are spread over it, the knee first, instead of all of it"},
    {"--json", NULL, NULL, 0, "settings, columns, every design and every generation, as JSON on standard output"},
    OPTION_END,
};

const Command CMD_EXPORT = {
    .name = "export",
    .group = GROUP_DECIDE,
    .operand = "RUN",
    .summary = "the front of a run, or all of it, as CSV or JSON",
    .example = "imtet export results/quick --csv front.csv",
    .details =
        "The front of the folder RUN: one row per design with id, variables [m] and objectives in their natural "
        "signs.\n"
        "With --all every evaluated design, failed ones too: id, generation, kind, outcome and reason before the\n"
        "variables; kind is `unfinished` for those of a generation that is under way or was cut short.\n"
        "results/README.md explains every column. The run may still be going on.",
    .options = OPTIONS,
    .run = run,
    .only_reads = 1,
};
