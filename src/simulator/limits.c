#include "simulator/limits.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static Status read_limit(Limits *limits, const Schema *schema, const char *text, Err *err)
{
    char name[TABLE_NAME_MAX], *end;
    const char *relation = strpbrk(text, "<>");
    if (!relation || relation[1] != '=' || relation - text >= TABLE_NAME_MAX)
        return fail(err, STATUS_BAD_DATA, "search.limits: '%.60s' is not NAME<=NUMBER or NAME>=NUMBER", text);
    snprintf(name, sizeof name, "%.*s", (int)(relation - text), text);
    for (char *last = name + strlen(name); last > name && isspace((unsigned char)last[-1]);)
        *--last = 0;
    Limit *l = &limits->limit[limits->n++];
    TRY(schema_pick_objective(schema, "search.limits", name, STATUS_BAD_DATA, &l->objective, err));
    l->sign = *relation == '<' ? 1.0 : -1.0;
    l->bound = strtod(relation + 2, &end);
    if (end == relation + 2 || *end || !isfinite(l->bound))
        return fail(err, STATUS_BAD_DATA, "search.limits: '%.60s': no number behind %c=", text, *relation);
    return STATUS_OK;
}

/* No number keeps both of two limits of one objective where the greatest allowed is below the smallest. */
static Status check(const Limits *limits, const Schema *schema, Err *err)
{
    for (size_t a = 0; a < limits->n; a++)
        for (size_t b = 0; b < limits->n; b++) {
            const Limit *max = &limits->limit[a], *min = &limits->limit[b];
            if (max->objective == min->objective && max->sign > 0.0 && min->sign < 0.0 && min->bound > max->bound)
                return fail(err, STATUS_BAD_DATA, "search.limits: %s<=%g and >=%g contradict each other",
                            schema_objective(schema, max->objective)->name, max->bound, min->bound);
        }
    return STATUS_OK;
}

Status limits_read(Limits *limits, const Schema *schema, const char *list, Err *err)
{
    char text[128];
    limits->n = 0;
    if (strcmp(list, "none") == 0)
        return STATUS_OK;
    if (list_count(list) > LIMITS_MAX)
        return fail(err, STATUS_BAD_DATA, "search.limits: more than %d", LIMITS_MAX);
    for (size_t i = 0; i < list_count(list); i++) {
        if (!list_item(list, i, text, sizeof text))
            return fail(err, STATUS_BAD_DATA, "search.limits: item %zu is empty or too long", i + 1);
        TRY(read_limit(limits, schema, text, err));
    }
    return check(limits, schema, err);
}

void limits_apply(const Limits *limits, const double f[], double g[])
{
    for (size_t c = 0; c < limits->n; c++) {
        const Limit *l = &limits->limit[c];
        g[c] = l->sign * (f[l->objective] - l->bound) / (l->bound != 0.0 ? fabs(l->bound) : 1.0);
    }
}
