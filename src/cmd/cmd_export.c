
#include "cmd/commands.h"
#include "store/export.h"
#include "store/output.h"

/* A well-spread choice of the front: the knee first, then again and again the design farthest from those chosen. */
static Status write_selected(const Args *args, const Run *run, FILE *f, Err *err)
{
    long wanted;
    TRY(args_whole(args, "--select", 1, 1000000, 0, &wanted, err));
    size_t *rows;
    TRY_ROOM(rows, wanted, "designs", err);
    const Status status = export_designs(f, run, EXPORT_FRONT, run_spread_out(run, wanted, 1, rows), rows, err);
    free(rows);
    return status;
}

static Status write_table(const Args *args, const Run *run, Err *err)
{
    Output o;
    TRY(output_open(&o, args_value(args, "--csv"), err));
    const Status status = args_has(args, "--select") ? write_selected(args, run, o.stream, err)
                          : args_has(args, "--all")
                              ? export_designs(o.stream, run, EXPORT_ALL, run->table.n, NULL, err)
                              : export_designs(o.stream, run, EXPORT_FRONT, run->n_front, run->front, err);
    return output_end(&o, status, err);
}

static Status check_options(const Args *args, Err *err)
{
    if (!args_has(args, "--csv") && !args_has(args, "--json"))
        return misused(err, "--csv FILE is missing, where the table goes (or --json)");
    return args_alone(args, "--all", "--select", err);
}

static Status export_run(const Args *args, const Run *run, Err *err)
{
    TRY(args_has(args, "--json") ? export_json(stdout, run, err) : STATUS_OK);
    return args_has(args, "--csv") ? write_table(args, run, err) : STATUS_OK;
}

static const ArgOption OPTIONS[] = {
    VALUE("--csv", "FILE", "write the table to FILE; -: standard output"),
    SWITCH("--all", "every evaluated design with its outcome, instead of the front"),
    VALUE("--select", "N", "only N designs spread over the front, the knee first"),
    SWITCH("--json", "settings, columns, every design and every generation, as JSON on standard output"),
    OPTION_END,
};

const Command CMD_EXPORT = {
    .name = "export",
    .group = GROUP_DECIDE,
    .operand = "RUN...",
    .summary = "the front of one or several runs, or all designs, as CSV or JSON",
    .example = "imtet export results/quick --csv front.csv",
    .details =

        "Writes the front of the folder RUN: one row per design with id, variables [m] and objectives in\n"
        "natural signs. --all writes every evaluated design, including failed ones: id, generation, kind,\n"
        "outcome and reason precede the variables, and kind is `unfinished` for designs of a generation that\n"
        "is not complete.\n\n"
        "Several runs of one problem give one front, on which each design appears once. results/README.md\n"
        "explains every column. The run may still be working.",
    .options = OPTIONS,
    .run = check_options,
    .run_of = export_run,
    .only_reads = 1,
};
