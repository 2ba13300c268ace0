#include "evaluate/schema.h"

#include "base/visible.h"
#include "settings/options.h"
#include "scene/neighbour.h"

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

int schema_is_noisy(const Settings *s)
{
    return s->problem.noisy == NOISY_YES && s->search.replicates_max > 1 && s->search.replicate_share > 0.0;
}

/* Columns of another problem, by the settings; those of constraints are g_1 ... */
static Status name_columns(Schema *schema, const ProblemOptions *o, Err *err)
{
    Column *objectives = schema->column + schema->n_var;
    TRY(take_names("problem.variable_names", o->variable_names, "x", schema->n_var, schema->column, err));
    TRY(take_names("problem.objective_names", o->objective_names, "f", schema->n_obj, objectives, err));
    for (size_t c = 0; c < schema->n_extra; c++) {
        Column *constraint = objectives + schema->n_obj + c;
        snprintf(constraint->name, sizeof constraint->name, "g_%zu", c + 1);
        constraint->sense = 1.0;
        schema->limited[schema->n_limited++] = c;
    }
    const size_t count = list_count(o->senses);
    char word[16];
    if (count != 1 && count != schema->n_obj)
        return bad_data(err, "problem.senses: %zu words for %zu objectives", count, schema->n_obj);
    for (size_t k = 0; k < schema->n_obj; k++) {
        const int fits = list_item(o->senses, count == 1 ? 0 : k, word, sizeof word);
        if (!fits || (strcmp(word, "min") != 0 && strcmp(word, "max") != 0))
            return bad_data(err, "problem.senses: item %zu is neither min nor max", k + 1);
        objectives[k].sense = word[1] == 'i' ? 1.0 : -1.0;
    }
    return STATUS_OK;
}

Status schema_of(Schema *schema, const Settings *s, int n_floors, Err *err)
{
    const ProblemOptions *o = &s->problem;
    const int is_tower = o->kind == PROBLEM_TOWER;
    *schema = (Schema){.n_var = o->variables,
                       .n_obj = o->objectives,
                       .n_extra = o->constraints > 0 ? o->constraints : 0,
                       .replicates = s->sim.replicates,
                       .is_noisy = schema_is_noisy(s),
                       .has_spread = schema_is_noisy(s) || (is_tower && s->sim.replicates > 1)};
    if (is_tower) {
        TRY(design_space_make(&schema->design, &s->design, core_section(&s->core), n_floors, err));
        TRY(measures_order(&schema->order, s->search.objectives, s->search.limits, n_floors, err));
        schema->n_var = schema->design.n_var;
        schema->n_obj = schema->order.n_obj;
        schema->n_extra = schema->order.n - schema->order.n_obj;
    } else if (!kinds_are_real(o->kinds)) {
        memcpy(schema->kinds, o->kinds, sizeof schema->kinds);
    }
    TRY_ROOM(schema->column, schema->n_var + schema->n_obj + schema->n_extra, "columns", err);
    if (!is_tower)
        return name_columns(schema, o, err);
    for (int j = 0; j < schema->design.n_var; j++)
        design_variable_name(&schema->design, j, schema->column[j].name);
    for (int k = 0; k < schema->order.n; k++) {
        Column *c = &schema->column[schema->n_var + k];
        const int m = schema->order.of[k];
        text_copy(c->name, measures_name(&schema->order, m));
        c->sense = measure(m)->sense;
        if (k >= schema->order.n_obj && schema->order.limited >> m & 1)
            schema->limited[schema->n_limited++] = k - schema->order.n_obj;
    }
    return STATUS_OK;
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

Status schema_cell(const Schema *schema, size_t j, const Table *t, size_t row, double *x, Err *err)
{
    const char *name = schema_variable(schema, j)->name, *text = sheet_text(t, row, name);
    char where[sizeof t->path + TABLE_NAME_MAX + 16], word[KIND_WORD_MAX];
    if (schema->design.n_var > 0)
        return design_cell(&schema->design, (int)j, t, row, x, err);
    if (schema->kinds[0] && kinds_number(schema->kinds, j, text, x))
        return STATUS_OK;
    snprintf(where, sizeof where, "%s:%d: %s", t->path, t->line[row], name);
    Err why = {0};
    const Status status = sheet_number(t, row, name, NAN, x, &why);
    if (schema_word(schema, j, 0, word)) { /* a choice: its words, or the number of one */
        char words[200] = "";
        size_t n = 0;
        if (status == STATUS_OK && *x == floor(*x) && schema_word(schema, j, *x, word))
            return STATUS_OK;
        for (int i = 0; n < sizeof words && schema_word(schema, j, i, word); i++)
            n += snprintf(words + n, sizeof words - n, i > 0 ? ", %s" : "%s", word);
        return bad_data(err, "%s is '%.60s'; it is one of %s%s", where, text, words, n < sizeof words ? "" : "...");
    }
    if (status != STATUS_OK)
        *err = why;
    else if (schema->kinds[0] && !kinds_have(schema->kinds, j, *x))
        return bad_data(err, "%s is %g; it is a whole number, or one of its list (problem.kinds)", where, *x);
    return status;
}

double schema_value(const Schema *schema, int m, const double f[], const double extra[])
{
    for (size_t k = 0; k < schema->n_obj + schema->n_extra; k++)
        if (schema->order.of[k] == m)
            return k < schema->n_obj ? f[k] : extra[k - schema->n_obj];
    return NAN;
}

Status schema_pick(const Schema *schema, size_t n, const char *where, const char *name, size_t *k, Err *err)
{
    const char *names[OBJECTIVES_MAX + EXTRA_MAX];
    for (*k = 0; *k < n; ++*k) {
        names[*k] = schema_objective(schema, *k)->name;
        if (strcmp(names[*k], name) == 0)
            return STATUS_OK;
    }
    return fail_no_word(err, where[0] == '-' ? STATUS_USAGE : STATUS_BAD_DATA, where, name,
                        n > schema->n_obj ? "result" : "objective", names, (int)n);
}

void schema_free(Schema *schema)
{
    free(schema->column);
    memset(schema, 0, sizeof *schema);
}
