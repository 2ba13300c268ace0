#include "cmd/look.h"

#include <stdlib.h>
#include <string.h>

enum { RECORDS_MAX = 32 };

/* Those of the command line, or the built-in motions that the run did not use. */
static Status take_records(const Args *args, const Settings *run, const char *records[RECORDS_MAX], size_t *n, Err *err)
{
    static const char *const BUILT_IN[] = {"builtin:kobe-like", "builtin:elcentro-like", "builtin:sylmar-like"};
    *n = 0;
    for (int i = 0; i < args->n_given; i++) {
        if (strcmp(args->given[i].option->name, "--record") != 0)
            continue;
        if (*n == RECORDS_MAX)
            return fail(err, STATUS_USAGE, "--record: more than %d earthquakes make no report", RECORDS_MAX);
        records[(*n)++] = args->given[i].value;
    }
    for (size_t i = 0; !args_has(args, "--record") && i < sizeof BUILT_IN / sizeof BUILT_IN[0]; i++)
        if (strcmp(run->motion.record, BUILT_IN[i]) != 0)
            records[(*n)++] = BUILT_IN[i];
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
    const char *design = args_value(args, "--design"), *records[RECORDS_MAX];
    Settings other;
    DetailWish wish = {.other = &other, .records = records};
    TRY(run_settings(&other, args->operand, err));
    TRY(take_records(args, &other, records, &wish.n_records, err));
    TRY(take_floor(args, &wish.floor, err));
    TRY(args_apply(args, &other, NULL, NULL, err));
    return report_open(r, args->operand, design ? design : "knee", &wish, err);
}

Status look_target(const Args *args, const char *name, char path[PATH_MAX], Err *err)
{
    const char *given = args_value(args, "--out");
    const int n =
        given ? snprintf(path, PATH_MAX, "%s", given) : snprintf(path, PATH_MAX, "%s/%s", args->operand, name);
    return n < PATH_MAX ? STATUS_OK : fail(err, STATUS_IO, "%.200s...: the path is too long", given ? given : name);
}
