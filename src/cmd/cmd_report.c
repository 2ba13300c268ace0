#include "cmd/commands.h"
#include "cmd/look.h"

static Status run(const Args *args, Err *err)
{
    return look_at_run(args, "report.html", report_page, err);
}

static const ArgOption OPTIONS[] = {
    {"--out", "FILE", NULL, 0, "where the page goes (default: RUN/report.html); -: standard output"},
    OPTIONS_LOOK,
    OPTION_END,
};

const Command CMD_REPORT = {
    .name = "report",
    .operand = "RUN",
    .summary = "one HTML page to look at a run: its front, and one design in detail",
    .example = "imtet report results/quick --design knee",
    .details =
        "Writes one file that needs no network: the front in parallel coordinates and a scatter matrix, designs "
        "chosen\n"
        "by ranges as a table and as CSV, the growth of the hypervolume; of one design, simulated again, its gaps,\n"
        "peaks, energies and the displacement of a floor, with other earthquakes. --pga, --stretch, --unit and "
        "--channel are\n"
        "for those; else they are scaled as the run's own.",
    .options = OPTIONS,
    .is_alone = 1,
    .run = run,
};
