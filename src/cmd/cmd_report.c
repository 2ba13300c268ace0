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
    .group = GROUP_DECIDE,
    .operand = "RUN",
    .summary = "one HTML page to look at a run: its front, and one design in detail",
    .example = "imtet report results/quick --design knee",
    .details = "Writes one file that needs no network. First what was studied and found, with warnings; then the "
               "front: parallel\n"
               "coordinates whose axes are moved, turned over and hidden, any two columns, gaps as a heat map, all "
               "pairs with\n"
               "their correlations, typical designs, which variables matter (Sobol indices), designs chosen by ranges "
               "as a table\n"
               "and as CSV; the growth of the hypervolume; of one design, simulated again, its gaps, peaks, forces, "
               "energies,\n"
               "the displacement of a floor, and other earthquakes. --pga, --stretch, --unit and --channel are for "
               "those; else\n"
               "they are scaled as the run's own. `imtet serve` shows the same page live.",
    .options = OPTIONS,
    .is_alone = 1,
    .run = run,
};
