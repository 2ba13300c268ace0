#include "evaluate/schema.h"

#include "base/visible.h"
#include "settings/options.h"
#include "scene/neighbour.h"

static Status allocate(Schema *schema, Err *err)
{
    schema->column = calloc(schema->n_var + schema->n_obj + schema->n_extra, sizeof *schema->column);
    return schema->column ? STATUS_OK : fail_memory(err, schema->n_var, "columns");
}

static Status schema_of_tower(Schema *schema, const Settings *s, int n_floors, Err *err)
{
    MeasureOrder order;
    DesignSpace design;
    TRY(design_space_make(&design, &s->design, core_section(&s->core), n_floors, err));
    TRY(measures_order(&order, s->search.objectives, s->search.limits, n_floors, err));
    *schema = (Schema){.n_var = design.n_var,
                       .design = design,
                       .n_obj = order.n_obj,
                       .n_extra = order.n - order.n_obj,
                       .order = order};
    TRY(allocate(schema, err));
    for (int j = 0; j < design.n_var; j++)
        design_variable_name(&design, j, schema->column[j].name);
    for (int k = 0; k < order.n; k++) {
        Column *c = &schema->column[design.n_var + k];
        snprintf(c->name, sizeof c->name, "%s", measures_name(&order, order.of[k]));
        c->sense = measure(order.of[k])->sense;
    }
    for (int k = order.n_obj; k < order.n; k++)
        if (order.limited >> order.of[k] & 1)
            schema->limited[schema->n_limited++] = k - order.n_obj;
    return STATUS_OK;
}

/* Names of n columns: those of the list, or "x1", "x2", ... where the list is "auto". */
static Status take_names(const char *key, const char *list, const char *letter, size_t n, Column columns[], Err *err)
{
    const int given = strcmp(list, "auto") != 0;
    if (given && list_count(list) != n)
        return bad_data(err, "%s: %zu names for %zu", key, list_count(list), n);
    for (size_t i = 0; i < n; i++) {
        char *name = columns[i].name, item[TABLE_NAME_MAX - 1];
        if (!given)
            snprintf(name, TABLE_NAME_MAX, "%s%zu", letter, i + 1);
        else if (!list_item(list, i, item, sizeof item) || strpbrk(item, "\"\r\n"))
            return bad_data(err, "%s: name %zu is empty, too long or holds a quote", key, i + 1);
        else
            cell_text(name, TABLE_NAME_MAX, item);
        for (size_t j = 0; given && j < i; j++)
            if (strcmp(columns[j].name, name) == 0)
                return bad_data(err, "%s: %s stands there twice", key, name);
    }
    return STATUS_OK;
}

static Status take_senses(const char *list, size_t n, Column columns[], Err *err)
{
    const size_t count = list_count(list);
    char word[16];
    if (count != 1 && count != n)
        return bad_data(err, "problem.senses: %zu words for %zu objectives", count, n);
    for (size_t k = 0; k < n; k++) {
        const int fits = list_item(list, count == 1 ? 0 : k, word, sizeof word);
        if (!fits || (strcmp(word, "min") != 0 && strcmp(word, "max") != 0))
            return bad_data(err, "problem.senses: item %zu is neither min nor max", k + 1);
        columns[k].sense = word[1] == 'i' ? 1.0 : -1.0;
    }
    return STATUS_OK;
}

static Status fill_from_settings(Schema *schema, const Settings *s, Err *err)
{
    Column *objectives = schema->column + schema->n_var;
    TRY(take_names("problem.variable_names", s->problem.variable_names, "x", schema->n_var, schema->column, err));
    TRY(take_names("problem.objective_names", s->problem.objective_names, "f", schema->n_obj, objectives, err));
    for (size_t c = 0; c < schema->n_extra; c++) {
        Column *constraint = objectives + schema->n_obj + c;
        snprintf(constraint->name, sizeof constraint->name, "g_%zu", c + 1);
        constraint->sense = 1.0;
        schema->limited[schema->n_limited++] = c;
    }
    return take_senses(s->problem.senses, schema->n_obj, objectives, err);
}

int schema_is_noisy(const Settings *s)
{
    return s->problem.noisy == NOISY_YES && s->search.replicates_max > 1 && s->search.replicate_share > 0.0;
}

Status schema_of(Schema *schema, const Settings *s, int n_floors, Err *err)
{
    if (s->problem.kind == PROBLEM_TOWER) {
        TRY(schema_of_tower(schema, s, n_floors, err));
        schema->replicates = s->sim.replicates;
        schema->is_noisy = schema_is_noisy(s);
        schema->has_spread = s->sim.replicates > 1 || schema->is_noisy;
        return STATUS_OK;
    }
    *schema = (Schema){.n_var = s->problem.variables,
                       .n_obj = s->problem.objectives,
                       .n_extra = s->problem.constraints > 0 ? s->problem.constraints : 0,
                       .replicates = s->sim.replicates,
                       .is_noisy = schema_is_noisy(s),
                       .has_spread = schema_is_noisy(s)};
    if (!kinds_are_real(s->problem.kinds))
        memcpy(schema->kinds, s->problem.kinds, sizeof schema->kinds);
    TRY(allocate(schema, err));
    const Status status = fill_from_settings(schema, s, err);
    if (status != STATUS_OK)
        schema_free(schema);
    return status;
}

const Column *schema_variable(const Schema *schema, size_t j)
{
    return &schema->column[j];
}

const Column *schema_objective(const Schema *schema, size_t k)
{
    return &schema->column[schema->n_var + k];
}

const Column *schema_extra(const Schema *schema, size_t k)
{
    return &schema->column[schema->n_var + schema->n_obj + k];
}

int schema_word(const Schema *schema, size_t j, double x, char word[KIND_WORD_MAX])
{
    const char *device = schema->design.n_var > 0 ? design_word(&schema->design, (int)j, x) : NULL;
    if (device)
        snprintf(word, KIND_WORD_MAX, "%s", device);
    return device || (schema->kinds[0] && kinds_word(schema->kinds, j, x, word));
}

static Status fail_word(const Schema *schema, size_t j, const char *where, const char *text, Err *err)
{
    char words[200] = "", word[KIND_WORD_MAX];
    size_t n = 0;
    for (int i = 0; n < sizeof words && schema_word(schema, j, i, word); i++)
        n += (size_t)snprintf(words + n, sizeof words - n, i > 0 ? ", %s" : "%s", word);
    return bad_data(err, "%s is '%.60s'; it is one of %s%s", where, text, words, n < sizeof words ? "" : "...");
}

Status schema_cell(const Schema *schema, size_t j, const Table *t, size_t row, double *x, Err *err)
{
    const char *name = schema_variable(schema, j)->name, *text = sheet_text(t, row, name);
    char where[sizeof t->path + TABLE_NAME_MAX + 16], word[KIND_WORD_MAX];
    Err why = {0};
    if (schema->design.n_var > 0)
        return design_cell(&schema->design, (int)j, t, row, x, err);
    if (schema->kinds[0] && kinds_number(schema->kinds, j, text, x))
        return STATUS_OK;
    snprintf(where, sizeof where, "%s:%d: %s", t->path, t->line[row], name);
    const Status status = sheet_number(t, row, name, NAN, x, &why);
    if (schema_word(schema, j, 0, word))
        return status == STATUS_OK && *x == floor(*x) && schema_word(schema, j, *x, word)
                   ? STATUS_OK
                   : fail_word(schema, j, where, text, err);
    if (status != STATUS_OK)
        *err = why;
    else if (schema->kinds[0] && kinds_are_whole(schema->kinds, j) && *x != floor(*x))
        return bad_data(err, "%s is %g; it is a whole number (problem.kinds)", where, *x);
    return status;
}

double schema_value(const Schema *schema, int m, const double f[], const double extra[])
{
    for (size_t k = 0; k < schema->n_obj + schema->n_extra; k++)
        if (schema->order.of[k] == m)
            return k < schema->n_obj ? f[k] : extra[k - schema->n_obj];
    return NAN;
}

size_t schema_find_objective(const Schema *schema, const char *name)
{
    size_t k = 0;
    while (k < schema->n_obj && strcmp(schema_objective(schema, k)->name, name) != 0)
        k++;
    return k;
}

/* Of n columns behind the variables; noun: what a name is meant to be. */
static Status pick(const Schema *schema, size_t n, const char *noun, const char *where, const char *name, Status status,
                   size_t *k, Err *err)
{
    const char *names[OBJECTIVES_MAX + EXTRA_MAX];
    for (*k = 0; *k < n; ++*k)
        if (strcmp(schema_objective(schema, *k)->name, name) == 0)
            return STATUS_OK;
    for (size_t i = 0; i < n; i++)
        names[i] = schema_objective(schema, i)->name;
    return fail_no_word(err, status, where, name, noun, names, (int)n);
}

Status schema_pick_objective(const Schema *schema, const char *where, const char *name, Status status, size_t *k,
                             Err *err)
{
    return pick(schema, schema->n_obj, "objective", where, name, status, k, err);
}

Status schema_pick_result(const Schema *schema, const char *where, const char *name, Status status, size_t *k, Err *err)
{
    return pick(schema, schema->n_obj + schema->n_extra, schema->n_extra > 0 ? "result" : "objective", where, name,
                status, k, err);
}

void schema_free(Schema *schema)
{
    free(schema->column);
    memset(schema, 0, sizeof *schema);
}
