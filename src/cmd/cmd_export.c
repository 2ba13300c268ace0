#include <limits.h>
#include <stdlib.h>

#include "cmd/commands.h"
#include "run/export.h"
#include "run/front.h"
#include "run/output.h"

/* A run without a database has the tables as files. */
static Status copy_file(const char *folder, const char *name, const char *path, Err *err)
{
    char from[PATH_MAX], *text;
    size_t length;
    Front front;
    Output o;
    TRY(front_read(&front, folder, err)); /* a damaged front is not handed on */
    front_free(&front);
    snprintf(from, sizeof from, "%s/%s", folder, name);
    TRY(file_read(from, &text, &length, err));
    Status status = output_open(&o, path, err);
    if (status == STATUS_OK) {
        fwrite(text, 1, length, o.stream); /* a failed write is seen on closing */
        status = output_close(&o, err);
    }
    free(text);
    return status;
}

static Status write_tables(const Args *args, const Saved *h, Err *err)
{
    Output o;
    if (args_has(args, "--json")) {
        TRY(export_json(stdout, h, err));
        if (!args_has(args, "--csv"))
            return STATUS_OK;
    }
    TRY(output_open(&o, args_value(args, "--csv"), err));
    if (args_has(args, "--all")) {
        export_evaluations_header(o.stream, &h->schema);
        export_evaluations(o.stream, h);
    } else {
        export_front(o.stream, h);
    }
    return output_close(&o, err);
}

static Status run(const Args *args, Err *err)
{
    char path[PATH_MAX];
    const int json = args_has(args, "--json"), all = args_has(args, "--all");
    if (!args_has(args, "--csv") && !json)
        return fail(err, STATUS_USAGE, "--csv FILE is missing: where the table goes (or --json)");
    if (!saved_path(args->operand, path, sizeof path))
        return json ? fail(err, STATUS_MISSING, "%s: is not there; a run without a database has no JSON export", path)
                    : copy_file(args->operand, all ? "evaluations.csv" : "front.csv", args_value(args, "--csv"), err);
    Saved h;
    TRY(saved_read(&h, args->operand, err));
    const Status status = write_tables(args, &h, err);
    saved_free(&h);
    return status;
}

static const ArgOption OPTIONS[] = {
    {"--csv", "FILE", NULL, 0, "where it goes; -: standard output"},
    {"--all", NULL, NULL, 0, "every design that was evaluated, with its outcome, instead of the front"},
    {"--json", NULL, NULL, 0, "settings, columns, every design and every generation, as JSON on standard output"},
    OPTION_END,
};

const Command CMD_EXPORT = {
    .name = "export",
    .operand = "RUN",
    .summary = "the front of a run, or all of it, as CSV or JSON",
    .example = "imtet export results/quick --csv front.csv",
    .details =
        "The front of the folder RUN: one row per design with id, variables [m] and objectives in their natural "
        "signs.\n"
        "With --all every evaluated design, failed ones too: id, generation, kind, outcome and reason before the\n"
        "variables. results/README.md explains every column. The run may still be going on.",
    .options = OPTIONS,
    .run = run,
};
