#include <limits.h>
#include <sys/stat.h>
#include <unistd.h>

#include "cmd/commands.h"
#include "cmd/designs.h"
#include "motion/builtin.h"
#include "motion/suite.h"
#include "motion/motion_scale.h"
#include "report/report.h"
#include "settings/options.h"

enum { RECORDS_MAX = 32 };

typedef struct {
    size_t n, n_seen; /* n_seen: records of the run */
    const char *path[RECORDS_MAX];
    char own[RECORDS_MAX][OPTION_TEXT_MAX]; /* those that the run names */
} Records;

static Status take_own(const char *source, void *user, Err *err)
{
    Records *r = user;
    if (r->n_seen++ == 0 || r->n == RECORDS_MAX)
        return STATUS_OK;
    r->path[r->n] = r->own[r->n];
    return option_put_path(r->own[r->n++], source, err);
}

/* Those of the command line, else the further ones of the run, else the built-in motions that it did not use. */
static Status take_records(const Args *args, const Settings *run, Records *r, Err *err)
{
    static const char *const BUILT_IN[] = {BUILTIN_MOTION_LIST(CHOICE_WORD)};
    const char *path;
    const size_t n = suite_count(&run->motion);
    for (int i = 0; r->n < RECORDS_MAX && (path = args_next(args, "--record", &i));)
        r->path[r->n++] = path;
    const int is_given = r->n > 0;
    if (r->n == RECORDS_MAX)
        return misused(err, "--record: more than %d earthquakes make no report", RECORDS_MAX - 1);
    if (!is_given)
        TRY(suite_of_study(&run->motion, take_own, r, err));
    for (size_t i = 0; !is_given && n == 1 && i < N_OF(BUILT_IN); i++)
        if (strcmp(run->motion.record, BUILT_IN[i]) != 0)
            r->path[r->n++] = BUILT_IN[i];
    return STATUS_OK;
}

static Status open_report(const Args *args, const Run *run, Report *r, Err *err)
{
    const char *design = args_value(args, "--design");
    Settings other = *run->settings;
    Records records = {0};
    size_t row;
    long floor;
    DetailOptions options = {.other = &other, .records = records.path, .with_ladder = !args_has(args, "--pictures")};
    TRY(args_moved(args, &options.moved, err));
    TRY(args_apply(args, &other, NULL, NULL, err));
    TRY(take_records(args, &other, &records, err));
    options.n_records = records.n;
    TRY(args_whole(args, "--floor", 1, FLOORS_MAX, 0, &floor, err));
    options.floor = (int)floor - 1;
    TRY(design_of_run(run, design ? design : "knee", &row, NULL, err));
    return report_open(r, run, row, &options, err);
}

/* A folder that comes from elsewhere may hold a link in the report's place, which leads to another file. */
static void drop_link(const char *path)
{
    struct stat there;
    if (lstat(path, &there) == 0 && S_ISLNK(there.st_mode))
        unlink(path);
}

/* Where the page goes, or the pictures instead of it. */
static Status take_target(const Args *args, char path[PATH_MAX], Err *err)
{
    const char *page = args_value(args, "--out"), *folder = args_value(args, "--pictures");
    const char *given = page ? page : folder;
    TRY(args_alone(args, "--out", "--pictures", err));
    if (snprintf(path, PATH_MAX, "%s%s", given ? given : args->operand, given ? "" : "/report.html") >= PATH_MAX)
        return fail(err, STATUS_IO, "%.200s...: the path is too long", path);
    if (!given)
        drop_link(path);
    return STATUS_OK;
}

static Status report(const Args *args, const Run *run, Err *err)
{
    char path[PATH_MAX];
    Report r = {0};
    TRY(take_target(args, path, err));
    Status status = open_report(args, run, &r, err);
    if (status == STATUS_OK)
        status = args_has(args, "--pictures") ? report_pictures(&r, path, err) : report_page(&r, path, err);
    report_close(&r);
    if (status == STATUS_OK && strcmp(path, "-") != 0)
        printf("%s\n", path);
    return status;
}

static const ArgOption OPTIONS[] = {
    VALUE("--out", "FILE", "where the page goes (default: RUN/report.html); -: standard output"),
    VALUE("--pictures", "DIR", "instead of the page pictures for a paper into DIR, SVG and PNG, by gnuplot"),
    VALUE("--design", "ID", "the design shown in detail: an id of the run, knee (default) or best_NAME"),
    VALUES("--record", "FILE",
           "another earthquake for it; may be repeated (default: motion.records, else the built-in ones)"),
    VALUE("--floor", "N", "whose displacement is shown over time (default: the middle one)"),
    OPTION_MOVED,
    OPTION_CHANNEL,
    OPTION_PGA,
    OPTION_UNIT,
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
               "the displacement of a floor, and other earthquakes. --pga, --unit and --channel are for "
               "those; else\n"
               "they are scaled as the run's own. `imtet serve` shows the same page live.",
    .options = OPTIONS,
    .is_alone = 1,
    .run_of = report,
};
