#include "scene/sheets.h"

#include <unistd.h>

#include "base/text.h"

/* ---- files ---------------------------------------------------------------------------------------------------- */

#define FILES(X)                                                                                                       \
    X("guyan", "K.csv", guyan_K)                                                                                       \
    X("guyan", "M.csv", guyan_M)                                                                                       \
    X("guyan", "nodes.csv", frame_nodes)                                                                               \
    X("guyan", "sections.csv", frame_sections)                                                                         \
    X("guyan", "elements.csv", frame_elements)                                                                         \
    X("appendix", "K.csv", appendix_K)                                                                                 \
    X("appendix", "M.csv", appendix_M)

#define X(model, file, name)                                                                                           \
    extern const char _binary_configs_sac20_##name##_csv_start[], _binary_configs_sac20_##name##_csv_end[];
FILES(X)
#undef X

typedef struct {
    const char *model, *file, *start, *end;
} BuiltIn;

static const BuiltIn BUILT_IN[] = {
#define X(model, file, name)                                                                                           \
    {model, file, _binary_configs_sac20_##name##_csv_start, _binary_configs_sac20_##name##_csv_end},
    FILES(X)
#undef X
};

/* NULL: there is no such file. */
static const BuiltIn *built_in(const char *model, const char *file)
{
    for (size_t i = 0; i < N_OF(BUILT_IN); i++)
        if (!strcmp(model, BUILT_IN[i].model) && !strcmp(file, BUILT_IN[i].file))
            return &BUILT_IN[i];
    return NULL;
}

int model_is_built_in(const char *model)
{
    return built_in(model, "K.csv") != NULL;
}

enum { PATH_SIZE = 600 };
static void path_of(char path[PATH_SIZE], const char *model, const char *file)
{
    snprintf(path, PATH_SIZE, "%s/%s", model, file);
}

int model_has(const char *model, const char *file)
{
    char path[PATH_SIZE];
    path_of(path, model, file);
    return model_is_built_in(model) ? built_in(model, file) != NULL : access(path, F_OK) == 0;
}

Status model_table(Table *t, const char *model, const char *file, TableForm form, Err *err)
{
    char path[PATH_SIZE];
    const BuiltIn *own = built_in(model, file);
    path_of(path, model, file);
    return own ? table_parse(t, path, own->start, own->end - own->start, form, err) : table_read(t, path, form, err);
}

/* ---- columns -------------------------------------------------------------------------------------------------- */

/* The columns that must be there, or those that may be, by name. */
static void list_columns(const SheetForm *form, int required, char list[200])
{
    *list = 0;
    for (const Column *c = form->column; c < form->column + COLUMNS_MAX && c->name; c++)
        if (isnan(c->otherwise) == required)
            text_join(list, 200, " ", "%s", c->name);
}

/* Refuses a file without a column that must be there, or with one that is not known. */
static Status check_columns(const SheetForm *form, const Table *s, Err *err)
{
    char required[200], optional[200];
    list_columns(form, 1, required);
    list_columns(form, 0, optional);
    for (const Column *c = form->column; c < form->column + COLUMNS_MAX && c->name; c++)
        if (isnan(c->otherwise) && table_column(s, c->name) < 0)
            return bad_data(err, "%s: has no column %s; it needs %s, and may have %s", s->path, c->name, required,
                            optional);
    for (size_t j = 0; j < s->n_cols; j++) {
        const Column *c = form->column;
        while (c < form->column + COLUMNS_MAX && c->name && strcmp(c->name, s->names[j]) != 0)
            c++;
        if (c == form->column + COLUMNS_MAX || !c->name)
            return bad_data(err, "%s: column '%s' is not known; there are %s %s", s->path, s->names[j], required,
                            optional);
    }
    return STATUS_OK;
}

/* Takes the cells of a row by their columns and hands it over. */
static Status read_row(const SheetForm *form, const Table *s, size_t row, void *user, Err *err)
{
    SheetRow r = {.n_rows = s->n_rows, .row = row};
    Err wrong = {0};
    for (size_t j = 0; j < COLUMNS_MAX && form->column[j].name && wrong.code == STATUS_OK; j++) {
        const Column *c = &form->column[j];
        const char *word = r.word[j] = sheet_text(s, row, c->name);
        const double *x = &r.x[j];
        if (c->kind != COLUMN_NAME)
            TRY(sheet_number(s, row, c->name, c->otherwise, &r.x[j], err));
        else if (!*word || strlen(word) >= TABLE_NAME_MAX)
            bad_data(&wrong, "%s '%.60s' is no name of 1 to %d characters", c->name, word, TABLE_NAME_MAX - 1);
        const char *must = c->kind == COLUMN_ABOVE_0 && !(*x > 0) && *word     ? "it must be above 0"
                           : c->kind == COLUMN_LEAST_0 && !(*x >= 0)           ? "it must not be negative"
                           : c->kind == COLUMN_SWITCH && !(*x == 0 || *x == 1) ? "it is 0 or 1"
                                                                               : NULL;
        if (must)
            bad_data(&wrong, "%s is %g; %s", c->name, *x, must);
    }
    if (wrong.code == STATUS_OK)
        form->take(user, &r, &wrong);
    return wrong.code == STATUS_OK ? STATUS_OK : fail(err, wrong.code, "%s:%d: %s", s->path, s->line[row], wrong.text);
}

Status sheet_read(const SheetForm *form, const char *model, void *user, Err *err)
{
    Table s;
    TRY(model_table(&s, model, form->file, TABLE_WORDS, err));
    Status status = check_columns(form, &s, err);
    for (size_t i = 0; i < s.n_rows; i++)
        THEN(status, read_row(form, &s, i, user, err));
    table_free(&s);
    return status;
}
