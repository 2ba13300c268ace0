#include "cmd/pairs.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static Status split(const char *option, const char *text, double otherwise, char name[TABLE_NAME_MAX], double *value,
                    Err *err)
{
    char *end;
    const size_t length = strcspn(text, "=");
    if (length >= TABLE_NAME_MAX || (!text[length] && isnan(otherwise)))
        return fail(err, STATUS_USAGE, "%s: '%.60s' is not NAME=NUMBER", option, text);
    snprintf(name, TABLE_NAME_MAX, "%.*s", (int)length, text);
    *value = text[length] ? strtod(text + length + 1, &end) : otherwise;
    if (text[length] && (end == text + length + 1 || *end || !isfinite(*value)))
        return fail(err, STATUS_USAGE, "%s: '%.60s' has no number behind =", option, text);
    return STATUS_OK;
}

Status pair_take(const Schema *schema, const char *option, const char *text, size_t *k, double *value, Err *err)
{
    char name[TABLE_NAME_MAX];
    TRY(split(option, text, NAN, name, value, err));
    return schema_pick_result(schema, option, name, STATUS_USAGE, k, err);
}

Status pairs_take(const Schema *schema, const char *option, const char *list, double otherwise, double values[],
                  Err *err)
{
    char item[TABLE_NAME_MAX + 40], name[TABLE_NAME_MAX];
    for (size_t j = 0; j < list_count(list); j++) {
        size_t k;
        double value;
        if (!list_item(list, j, item, sizeof item))
            return fail(err, STATUS_USAGE, "%s: item %zu is empty or too long", option, j + 1);
        TRY(split(option, item, otherwise, name, &value, err));
        TRY(schema_pick_objective(schema, option, name, STATUS_USAGE, &k, err));
        values[k] = value;
    }
    return STATUS_OK;
}

/* A negative one would ask for the worst; nothing but zeros asks for nothing. */
Status weights_check(const Schema *schema, const char *option, const double weights[], Err *err)
{
    double sum = 0;
    for (size_t k = 0; k < schema->n_obj; k++) {
        if (weights[k] < 0)
            return fail(err, STATUS_USAGE, "%s: %s=%g is negative; every weight asks for more of what is good", option,
                        schema_objective(schema, k)->name, weights[k]);
        sum += weights[k];
    }
    return sum > 0 ? STATUS_OK : fail(err, STATUS_USAGE, "%s: all of them are 0", option);
}
