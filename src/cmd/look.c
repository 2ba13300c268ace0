#include "cmd/look.h"

#include <stdlib.h>
#include <string.h>

enum { RECORDS_MAX = 32 };

typedef struct {
    size_t n;
    const char *path[RECORDS_MAX];
    char own[RECORDS_MAX][SETTINGS_TEXT_MAX]; /* those that the run names */
} Records;

/* Those of the command line, else the further ones of the run, else the built-in motions that it did not use. */
static Status take_records(const Args *args, const Settings *run, Records *r, Err *err)
{
    static const char *const BUILT_IN[] = {"builtin:kobe-like", "builtin:elcentro-like", "builtin:sylmar-like"};
    r->n = 0;
    for (int i = 0; i < args->n_given; i++) {
        if (strcmp(args->given[i].option->name, "--record") != 0)
            continue;
        if (r->n == RECORDS_MAX)
            return fail(err, STATUS_USAGE, "--record: more than %d earthquakes make no report", RECORDS_MAX);
        r->path[r->n++] = args->given[i].value;
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

static Status take_floor(const Args *args, int *floor, Err *err)
{
    const char *text = args_value(args, "--floor");
    char *end;
    const long n = text ? strtol(text, &end, 10) : 0;
    if (text && (end == text || *end || n < 1 || n > FLOORS_MAX))
        return fail(err, STATUS_USAGE, "--floor: '%.40s' is no number of a floor, the lowest is 1", text);
    *floor = (int)n - 1;
    return STATUS_OK;
}

Status look_open(const Args *args, Report *r, Err *err)
{
    const char *design = args_value(args, "--design");
    Settings other;
    Records records;
    DetailWish wish = {.other = &other, .records = records.path};
    TRY(args_moved(args, &wish.moved, err));
    TRY(run_settings(&other, args->operand, err));
    TRY(args_apply(args, &other, NULL, NULL, err));
    TRY(take_records(args, &other, &records, err));
    wish.n_records = records.n;
    TRY(take_floor(args, &wish.floor, err));
    return report_open(r, args->operand, design ? design : "knee", &wish, err);
}

Status look_target(const Args *args, const char *name, char path[PATH_MAX], Err *err)
{
    const char *given = args_value(args, "--out");
    const int n =
        given ? snprintf(path, PATH_MAX, "%s", given) : snprintf(path, PATH_MAX, "%s/%s", args->operand, name);
    return n < PATH_MAX ? STATUS_OK : fail(err, STATUS_IO, "%.200s...: the path is too long", given ? given : name);
}
