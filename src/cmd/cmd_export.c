#include <limits.h>
#include <stdlib.h>

#include "cmd/commands.h"
#include "run/front.h"
#include "run/output.h"

static Status copy(const char *folder, const char *name, const char *path, Err *err)
{
    char from[PATH_MAX], *text;
    size_t length;
    Output o;
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

static Status run(const Args *args, Err *err)
{
    Front front;
    if (!args_has(args, "--csv"))
        return fail(err, STATUS_USAGE, "--csv FILE is missing: where the table goes");
    TRY(front_read(&front, args->operand, err)); /* a damaged front is not handed on */
    front_free(&front);
    return copy(args->operand, args_has(args, "--all") ? "evaluations.csv" : "front.csv", args_value(args, "--csv"),
                err);
}

static const ArgOption OPTIONS[] = {
    {"--csv", "FILE", NULL, 0, "where it goes; -: standard output"},
    {"--all", NULL, NULL, 0, "every design that was evaluated, with its outcome, instead of the front"},
    OPTION_END,
};

const Command CMD_EXPORT = {
    .name = "export",
    .operand = "RUN",
    .summary = "the front of a run, or all of it, as CSV",
    .example = "imtet export results/quick --csv front.csv",
    .details =
        "Copies the front of the folder RUN: one row per design with id, variables [m] and objectives in their\n"
        "natural signs. With --all every evaluated design, failed ones too: id, generation, kind, outcome and reason\n"
        "before the variables. results/README.md explains every column.",
    .options = OPTIONS,
    .run = run,
};
