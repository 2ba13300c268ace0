#include <limits.h>
#include <sys/stat.h>
#include <unistd.h>

#include "cmd/commands.h"
#include "cmd/designs.h"
#include "cmd/dossier.h"
#include "cmd/show.h"
#include "report/elsewhere.h"
#include "report/pictures.h"
#include "report/report.h"
#include "settings/options.h"
#include "store/notes.h"

/* Where the page goes, or the pictures or the dossier instead of it. */
static Status take_target(const Args *args, char path[PATH_MAX], Err *err)
{
    static const char *const PLACES[] = {"--out", "--pictures", "--dossier"};
    const char *given = NULL;
    struct stat there;
    for (size_t i = 0; i < N_OF(PLACES); i++)
        given = given ? given : args_value(args, PLACES[i]);
    TRY(args_alone(args, "--out", "--pictures --dossier", err));
    TRY(args_alone(args, "--pictures", "--dossier", err));
    if (!given && args->n_operands > 1)
        return misused(err, "--out FILE is missing, where the page of several runs goes");
    if (snprintf(path, PATH_MAX, "%s%s", given ? given : args->operand, given ? "" : "/report.html") >= PATH_MAX)
        return fail(err, STATUS_IO, "%.200s...: the path is too long", path);

    /* A folder that comes from elsewhere may hold a link in the report's place, which leads to another file. */
    if (!given && lstat(path, &there) == 0 && S_ISLNK(there.st_mode))
        unlink(path);
    return STATUS_OK;
}

static Status report(const Args *args, const Run *run, Err *err)
{
    const int is_dossier = args_has(args, "--dossier"), has_pictures = args_has(args, "--pictures");
    char path[PATH_MAX];
    Settings s = *run->settings;
    Report r = {0};
    OtherRecords records = {.notes = stderr};
    RecordPaths moved;
    json_t *notes;

    /* 1. Before anything is simulated: notes that cannot be shown are not left out in silence. */
    Status status = notes_of_run(run, &notes, err);
    json_decref(notes);
    TRY(status);
    TRY(args_moved(args, &moved, err));
    TRY(take_target(args, path, err));
    if (is_dossier && s.problem.kind != PROBLEM_TOWER)
        return bad_data(err, "%s: --dossier needs a tower (problem.kind)", run->folder);
    TRY(is_dossier                         ? dossier_check(path, err)
        : has_pictures && run->n_front > 0 ? browser_check(path, err)
                                           : STATUS_OK);

    /* 2. The design in detail, under the records of the study and those of --record, or built-in ones. */
    const char *design = args_value(args, "--design"), *record;
    Settings other = s; /* of the records that are not the run's */
    size_t row;
    TRY(args_apply(args, &other, NULL, NULL, err));
    TRY(elsewhere_of_study(&records, &other.motion, err));
    for (int i = 0; (record = args_next(args, "--record", &i));)
        TRY(elsewhere_add(&records, record, err));
    TRY(elsewhere_otherwise(&records, &other.motion, err));
    TRY(design_of_run(run, design ? design : "knee", &row, NULL, err));
    const DetailOptions options = {.other = &other,
                                   .moved = moved,
                                   .records = records.source,
                                   .n_records = records.n,
                                   .with_ladder = !has_pictures};
    status = report_open(&r, run, row, &options, err);

    /* 3. Dossier and page simulate with the records of the run, where they are now. */
    if (is_dossier) {
        THEN(status, record_paths_find(&s, run->provenance, &moved, err));
        if (status == STATUS_OK) {
            run_steps(run, r.chosen, &s.sim);
            status = dossier_write(&r, &s, records.n, records.source, path, err);
        }
    } else if (has_pictures) {
        THEN(status, report_pictures(&r, path, err));
    } else {
        if (r.has_detail && !args_has(args, "--no-engine"))
            THEN(status, what_if_json(run, &moved, &r.scene, err));
        THEN(status, report_page(&r, path, err));
    }
    report_close(&r);
    TRY(status);
    if (args_has(args, "--json"))
        return show_json(json_of("written=%s", path), err);
    if (strcmp(path, "-") != 0)
        printf("%s\n", path);
    return STATUS_OK;
}

const Command CMD_REPORT = {
    .name = "report",
    .group = GROUP_DECIDE,
    .operand = "RUN...",
    .summary = "one HTML page of a run: its front, and one design in detail",
    .example = "imtet report results/quick --design knee",
    .details =

        "Writes one HTML file that needs no network. It begins with what was studied and found, and with\n"
        "warnings. The front follows: parallel coordinates whose axes can be moved, reversed and hidden; any\n"
        "two columns; gaps as a heat map; all pairs with their correlations; typical designs; which\n"
        "variables matter (Sobol indices); a table and a CSV of designs within chosen ranges; the growth of\n"
        "the hypervolume. One design is simulated again: its gaps, peaks, forces, energies, the displacement\n"
        "of a floor, and other earthquakes. --pga and --unit apply to those (of several components one is\n"
        "named behind the file, 'kobe.v2 channel=N00E'); by default they are scaled as the run's own. `imtet\n"
        "serve` shows the same page live.\n\n"
        "--dossier writes one document of some ten pages on the design: building, core, devices and\n"
        "drawings; simulation at accuracy fine, by CVODE and on the full model; forces with limits, the\n"
        "ladder, every record, intensities, the design as built, sensitivities, what is not covered, and\n"
        "provenance. CVODE takes minutes under a long record. A PDF needs Chromium.",
    .options =
        {
            VALUE("--out", "FILE", "where the page goes (default: RUN/report.html); -: standard output"),
            VALUE("--pictures", "DIR",
                  "write pictures for a paper into DIR instead of the page, SVG and PNG, by Chromium"),
            VALUE("--dossier", "FILE",
                  "write a document for the checker of the design instead of the page, .html or .pdf"),
            VALUE("--design", "ID", "the design shown in detail: an id of the run, knee (default) or best_NAME"),
            VALUES(
                "--record", "FILE",
                "further earthquakes for the design, a file, folder or list; may be repeated (default: built-in ones)"),
            SWITCH("--json", "print where the page was written, as an object"),
            SWITCH("--no-engine", "leave out the simulator and the records, so that the page cannot simulate"),
            OPTION_MOVED,
            OPTION_PGA,
            OPTION_UNIT,
            OPTION_TEXT,
        },
    .is_alone = 1,
    .run_of = report,
};
