#include "api/named_values.h"

#include "base/carve.h"
#include "base/stat.h"

typedef struct {
    char name[48];
    size_t rows, columns;
    double *numbers; /* NULL: a text */
    char *text;
} NamedValue;

struct imtet_result {
    size_t n, room;
    NamedValue *value; /* (n) */
    int lacks_memory;
};

Status result_create(imtet_result **out, Err *err)
{
    TRY_ROOM(*out, 1, "a result", err);
    return STATUS_OK;
}

static const NamedValue *find(const imtet_result *r, const char *name)
{
    for (size_t i = 0; i < r->n; i++)
        if (strcmp(r->value[i].name, name) == 0)
            return &r->value[i];
    return NULL;
}

/* A name that is there keeps its value: NULL, as where there is no memory. */
static NamedValue *add(imtet_result *r, const char *name)
{
    if (find(r, name))
        return NULL;
    if (r->n == r->room) {
        const size_t room = 2 * r->room + 32;
        r->value = widened(r->value, room, sizeof *r->value, &r->lacks_memory);
        if (r->lacks_memory)
            return NULL;
        r->room = room;
    }
    NamedValue *v = &r->value[r->n++];
    *v = (NamedValue){0};
    text_copy(v->name, name);
    return v;
}

double *result_table(imtet_result *r, const char *name, size_t rows, size_t columns)
{
    NamedValue *v = add(r, name);
    if (!v)
        return NULL;
    v->rows = rows;
    v->columns = columns;
    v->numbers = calloc(rows * columns + 1, sizeof *v->numbers);
    r->lacks_memory |= !v->numbers;
    return v->numbers;
}

void result_numbers(imtet_result *r, const char *name, size_t n, const double numbers[])
{
    double *own = result_table(r, name, n, 1);
    if (own)
        copy_values(n, numbers, own);
}

void result_text(imtet_result *r, const char *name, const char *text)
{
    NamedValue *v = add(r, name);
    if (v)
        v->text = strdup(text);
    r->lacks_memory |= v && !v->text;
}

void imtet_result_free(imtet_result **result)
{
    imtet_result *r = result ? *result : NULL;
    if (!r)
        return;
    for (size_t i = 0; i < r->n; i++) {
        free(r->value[i].numbers);
        free(r->value[i].text);
    }
    free(r->value);
    free(r);
    *result = NULL;
}

Status result_finish(imtet_result **out, Status status, Err *err)
{
    if (status == STATUS_OK && (*out)->lacks_memory)
        status = fail_memory(err, 1, "a result");
    if (status != STATUS_OK)
        imtet_result_free(out);
    return status;
}

const char *imtet_result_name(const imtet_result *result, size_t i)
{
    return result && i < result->n ? result->value[i].name : NULL;
}

const char *imtet_result_text(const imtet_result *result, const char *name)
{
    const NamedValue *v = result && name ? find(result, name) : NULL;
    return v ? v->text : NULL;
}

imtet_status imtet_result_numbers(const imtet_result *result, const char *name, const double **numbers, size_t *rows,
                                  size_t *columns, imtet_error *error)
{
    Err err = {0};
    const NamedValue none = {0}, *v = result && name ? find(result, name) : NULL;
    if (!result || !name) {
        misused(&err, "imtet_result_numbers: %s is NULL", result ? "name" : "the result");
    } else if (!v) {
        const char **names = calloc(result->n + 1, sizeof *names);
        for (size_t i = 0; names && i < result->n; i++)
            names[i] = result->value[i].name;
        fail_no_word(&err, STATUS_USAGE, "imtet_result_numbers", name, "number of this result", names,
                     names ? (int)result->n : 0);
        free(names);
    } else if (!v->numbers) {
        misused(&err, "%s is a text of this result, not a number", name);
    }
    if (err.code != STATUS_OK)
        v = &none;
    if (numbers)
        *numbers = v->numbers;
    if (rows)
        *rows = v->rows;
    if (columns)
        *columns = v->columns;
    return api_status(err.code, &err, error);
}
