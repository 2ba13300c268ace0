#include "evaluate/limits.h"

#include <ctype.h>

/* The limit of that result on that side; NULL: there is none before limit n. */
static const Limit *find(const Limits *limits, size_t n, size_t result, double sign)
{
    for (size_t i = 0; i < n; i++)
        if (limits->limit[i].result == result && limits->limit[i].sign == sign)
            return &limits->limit[i];
    return NULL;
}

Status limits_read(Limits *limits, const Schema *schema, const char *list, Err *err)
{
    const int is_tower = schema->order.n_obj > 0;
    char text[128], name[TABLE_NAME_MAX], *end;
    limits->n = 0;
    if (strcmp(list, "none") == 0)
        return STATUS_OK;
    if (list_count(list) > LIMITS_MAX)
        return bad_data(err, "search.limits: more than %d", LIMITS_MAX);

    /* 1. NAME<=NUMBER or NAME>=NUMBER, where NAME may be a chance p(NAME>NUMBER). */
    for (size_t i = 0; i < list_count(list); i++) {
        Limit *l = &limits->limit[limits->n++];
        if (!list_item(list, i, text, sizeof text))
            return bad_data(err, "search.limits: item %zu is empty or too long", i + 1);
        const size_t inside = strncmp(text, "p(", 2) == 0 ? strcspn(text, ")") : 0;
        const char *relation = strpbrk(text + inside, "<>");
        if (!relation || relation == text || relation[1] != '=' || relation - text >= TABLE_NAME_MAX)
            return bad_data(err, "search.limits: '%.60s' is not NAME<=NUMBER or NAME>=NUMBER", text);
        snprintf(name, sizeof name, "%.*s", (int)(relation - text), text);
        for (char *last = name + strlen(name); last > name && isspace((unsigned char)last[-1]);)
            *--last = 0;
        TRY(schema_pick(schema, schema->n_obj + schema->n_extra, "search.limits", name, &l->result, err));
        l->sign = *relation == '<' ? 1.0 : -1.0;
        l->bound = strtod(relation + 2, &end);
        if (end == relation + 2 || *end || !isfinite(l->bound))
            return bad_data(err, "search.limits: '%.60s': no number behind %c=", text, *relation);
    }

    /* 2. One limit on a side, that of what is better only beside the other, and some number between both. */
    for (size_t i = 0; i < limits->n; i++) {
        const Limit *l = &limits->limit[i], *other = find(limits, limits->n, l->result, -l->sign);
        const Column *c = schema_objective(schema, l->result);
        const int is_upper = l->sign > 0;
        const char *relation = is_upper ? "<=" : ">=", *opposite = is_upper ? ">=" : "<=";
        if (find(limits, i, l->result, l->sign))
            return bad_data(err, "search.limits: %s%s is given twice", c->name, relation);
        if (is_upper && other && other->bound > l->bound)
            return bad_data(err, "search.limits: %s<=%g and >=%g contradict each other", c->name, l->bound,
                            other->bound);
        if (is_upper && l->bound < 0 && is_tower)
            return bad_data(err, "search.limits: %s<=%g: no design has less than 0", c->name, l->bound);
        if (is_upper && l->bound >= 1 && is_tower && measure_is_share(schema->order.of[l->result]))
            return bad_data(err, "search.limits: %s<=%g: this is a share of 1, no per cent; write %g for %g %%",
                            c->name, l->bound, 0.01 * l->bound, l->bound);
        if (!other && l->sign * c->sense < 0)
            return bad_data(
                err,
                "search.limits: %s%s%g excludes what is better: of %s %s is better; write %s, or give a limit on "
                "both sides",
                c->name, relation, l->bound, c->name, c->sense > 0 ? "less" : "more", opposite);
    }
    return STATUS_OK;
}

void limits_apply(const Limits *limits, size_t n_obj, const Evaluation *e, double g[])
{
    for (size_t c = 0; c < limits->n; c++) {
        const Limit *l = &limits->limit[c];
        const double value = l->result < n_obj ? e->f[l->result] : e->extra[l->result - n_obj];
        g[c] = l->sign * (value - l->bound) / (l->bound != 0.0 ? fabs(l->bound) : 1.0);
    }
}

Status aspirations_read(const double **aspire, double level[], const Schema *schema, const char *list, Err *err)
{
    char text[128], *end;
    const int is_wished = strcmp(list, "none") != 0;
    *aspire = is_wished ? level : NULL;
    for (size_t k = 0; k < schema->n_obj; k++)
        level[k] = NAN;
    for (size_t i = 0, k; is_wished && i < list_count(list); i++) {
        char *blank = list_item(list, i, text, sizeof text) ? strrchr(text, ' ') : NULL;
        const double value = blank ? strtod(blank, &end) : NAN;
        if (!blank || *end || !isfinite(value))
            return bad_data(err, "search.aspire: item %zu of '%.60s' is not NAME NUMBER", i + 1, list);
        *blank = 0;
        TRY(schema_pick(schema, schema->n_obj, "search.aspire", text, &k, err));
        if (!isnan(level[k]))
            return bad_data(err, "search.aspire: %s is given twice", text);
        level[k] = schema_objective(schema, k)->sense * value;
    }
    return STATUS_OK;
}
