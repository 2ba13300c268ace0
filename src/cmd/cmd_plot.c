#include "cmd/commands.h"
#include "cmd/look.h"

static Status run(const Args *args, Err *err)
{
    return look_at_run(args, "pictures", report_pictures, err);
}

static const ArgOption OPTIONS[] = {
    {"--out", "DIR", NULL, 0, "folder of the pictures (default: RUN/pictures)"},
    OPTIONS_LOOK,
    OPTION_END,
};

const Command CMD_PLOT = {
    .name = "plot",
    .operand = "RUN",
    .summary = "pictures of a run for a paper, SVG and PNG, by gnuplot",
    .example = "imtet plot results/quick --design knee --out pictures",
    .details =
        "Draws what `imtet report` shows: the front, the growth of the hypervolume; of one design, simulated "
        "again, its\n"
        "gaps, peaks, modal energies, energies and displacement over time, and other earthquakes. Wants gnuplot.",
    .options = OPTIONS,
    .is_alone = 1,
    .run = run,
};
