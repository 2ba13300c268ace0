#include "cmd/look.h"

#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "cmd/designs.h"
#include "motion/builtin.h"
#include "settings/options.h"

#include "store/run_read.h"

enum { RECORDS_MAX = 32 };

typedef struct {
    size_t n;
    const char *path[RECORDS_MAX];
    char own[RECORDS_MAX][OPTION_TEXT_MAX]; /* those that the run names */
} Records;

/* Those of the command line, else the further ones of the run, else the built-in motions that it did not use. */
static Status take_records(const Args *args, const Settings *run, Records *r, Err *err)
{
    static const char *const BUILT_IN[] = {BUILTIN_MOTION_LIST(CHOICE_WORD)};
    const char *path;
    r->n = 0;
    for (int i = 0; (path = args_next(args, "--record", &i));) {
        if (r->n == RECORDS_MAX)
            return fail(err, STATUS_USAGE, "--record: more than %d earthquakes make no report", RECORDS_MAX);
        r->path[r->n++] = path;
    }
    if (args_has(args, "--record"))
        return STATUS_OK;
    const size_t further = strcmp(run->motion.records, "none") == 0 ? 0 : list_count(run->motion.records);
    for (size_t i = 0; i < further && r->n < RECORDS_MAX; i++)
        if (list_item(run->motion.records, i, r->own[r->n], sizeof r->own[0])) {
            r->path[r->n] = r->own[r->n];
            r->n++;
        }
    for (size_t i = 0; further == 0 && i < sizeof BUILT_IN / sizeof BUILT_IN[0]; i++)
        if (strcmp(run->motion.record, BUILT_IN[i]) != 0)
            r->path[r->n++] = BUILT_IN[i];
    return STATUS_OK;
}

static Status open_report(const Args *args, const Run *run, Report *r, Err *err)
{
    const char *design = args_value(args, "--design");
    Settings other = *run->settings;
    Records records;
    size_t row;
    long floor;
    DetailOptions options = {.other = &other, .records = records.path};
    TRY(args_moved(args, &options.moved, err));
    TRY(args_apply(args, &other, NULL, NULL, err));
    TRY(take_records(args, &other, &records, err));
    options.n_records = records.n;
    TRY(args_whole(args, "--floor", 1, FLOORS_MAX, 0, &floor, err));
    options.floor = (int)floor - 1;
    TRY(design_of_run(run, design ? design : "knee", &row, NULL, err));
    return report_open(r, run, row, &options, err);
}

static Status take_target(const Args *args, const char *name, char path[PATH_MAX], Err *err)
{
    const char *given = args_value(args, "--out");
    const int n =
        given ? snprintf(path, PATH_MAX, "%s", given) : snprintf(path, PATH_MAX, "%s/%s", args->operand, name);
    return n < PATH_MAX ? STATUS_OK : fail(err, STATUS_IO, "%.200s...: the path is too long", given ? given : name);
}

/* A folder that comes from elsewhere may hold a link in the report's place, which leads to another file. */
static void drop_link(const char *path)
{
    struct stat there;
    if (lstat(path, &there) == 0 && S_ISLNK(there.st_mode))
        unlink(path);
}

Status look_at_run(const Args *args, const char *name, LookFn show, Err *err)
{
    char path[PATH_MAX];
    Run run;
    Report r = {0};
    TRY(take_target(args, name, path, err));
    TRY(run_read(&run, args->operand, err));
    if (!args_value(args, "--out"))
        drop_link(path);
    Status status = open_report(args, &run, &r, err);
    if (status == STATUS_OK)
        status = show(&r, path, err);
    report_close(&r);
    run_free(&run);
    if (status == STATUS_OK && strcmp(path, "-") != 0)
        printf("%s\n", path);
    return status;
}
