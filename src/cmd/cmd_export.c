
#include "cmd/commands.h"
#include "store/export.h"
#include "store/output.h"

static Status check_options(const Args *args, Err *err)
{
    return args_has(args, "--csv") || args_has(args, "--json")
               ? STATUS_OK
               : misused(err, "--csv FILE is missing, where the table goes (or --json)");
}

static Status export_run(const Args *args, const Run *run, Err *err)
{
    Output o;
    TRY(args_has(args, "--json") ? export_json(stdout, run, err) : STATUS_OK);
    if (!args_has(args, "--csv"))
        return STATUS_OK;
    TRY(output_open(&o, args_value(args, "--csv"), err));
    return output_end(&o,
                      args_has(args, "--all")
                          ? export_designs(o.stream, run, EXPORT_ALL, run->table.n, NULL, err)
                          : export_designs(o.stream, run, EXPORT_FRONT, run->n_front, run->front, err),
                      err);
}

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
    .options =
        {
            VALUE("--csv", "FILE", "write the table to FILE; -: standard output"),
            SWITCH("--all", "every evaluated design with its outcome, instead of the front"),
            SWITCH("--json", "settings, columns, every design and every generation, as JSON on standard output"),
        },
    .run = check_options,
    .run_of = export_run,
    .only_reads = 1,
};
