#include "store/export.h"

#include <unistd.h>

#include "base/json.h"
#include "base/text.h"
#include "settings/settings.h"
#include "store/folder.h"
#include "store/output.h"

/* -- one design ---------------------------------------------------------------------------------------------------- */

typedef enum {
    PART_END,
    PART_ID,
    PART_ORIGIN,
    PART_VIOLATION,
    PART_X,
    PART_F,
    PART_MEANS,
    PART_LIMITED,
    PART_EXTRA,
    PART_SD,
    PART_ERR,
    PART_ERR_EXTRA
} Part;

static const Part PARTS[][8] = {
    [EXPORT_FRONT] = {PART_ID, PART_X, PART_MEANS, PART_LIMITED, PART_SD, PART_ERR},
    [EXPORT_ALL] = {PART_ID, PART_ORIGIN, PART_X, PART_F, PART_EXTRA, PART_ERR, PART_ERR_EXTRA},
    [EXPORT_NEAREST] = {PART_ID, PART_VIOLATION, PART_X, PART_MEANS, PART_LIMITED},
    [EXPORT_PAGE] = {PART_ID, PART_X, PART_MEANS, PART_LIMITED, PART_ERR},
};

/* Numbers of a design, each behind a comma. */
typedef struct {
    size_t n;
    const Column *column;    /* (n) */
    const double *value;     /* (n) NULL: not known */
    const char *begin, *end; /* of their names; NULL: nothing */
    const size_t *of;        /* (n) these columns and values; NULL: in their order */
} Numbers;

/* f: its objectives as means over repeats. Errors are known of a tower alone. */
static Numbers numbers_of(const Schema *s, const Evaluation *e, const double f[], Part part)
{
    const Column *objectives = schema_objective(s, 0), *others = s->column + s->n_var + s->n_obj;
    const int is_tower = s->order.n_obj > 0;
    switch (part) {
    case PART_X:
        return (Numbers){s->n_var, s->column, e->x, .begin = ""};
    case PART_F:
        return (Numbers){s->n_obj, objectives, e->f, .begin = ""};
    case PART_MEANS:
        return (Numbers){s->n_obj, objectives, f, .begin = ""};
    case PART_LIMITED:
        return (Numbers){s->n_limited, others, e->extra, .of = s->limited};
    case PART_EXTRA:
        return (Numbers){s->n_extra, others, e->extra, .begin = ""};
    case PART_SD:
        return (Numbers){s->has_spread ? s->n_obj : 0, objectives, e->sd, .end = "_sd"};
    case PART_ERR:
        return (Numbers){is_tower ? s->n_obj : 0, objectives, e->err, .begin = "err_"};
    case PART_ERR_EXTRA:
        return (Numbers){is_tower ? s->n_extra : 0, others, e->err ? e->err + s->n_obj : NULL, .begin = "err_"};
    default:
        return (Numbers){0};
    }
}

/* The cells of a part of a design. */
static void put_cells(FILE *f, const Run *run, size_t row, Part part)
{
    const double none = NAN;
    char word[KIND_WORD_MAX];
    const Evaluation *e = &run->table.row[row];
    const Numbers n = numbers_of(&run->schema, e, run_f(run, row), part);
    if (part == PART_ID)
        fprintf(f, "%ld", e->id);
    if (part == PART_ORIGIN)
        fprintf(f, ",%ld,%s,%s,%s", e->generation, kind_word(e->kind), outcome_word(e->outcome), e->reason);
    if (part == PART_VIOLATION)
        print_cells(f, 1, &e->violation);
    for (size_t i = 0; i < n.n; i++)
        if (part == PART_X && schema_word(&run->schema, i, e->x[i], word))
            fprintf(f, ",%s", word);
        else
            print_cells(f, 1, n.value ? &n.value[n.of ? n.of[i] : i] : &none);
    if (part == PART_SD && n.n > 0)
        print_cells(f, 1, e->replicates > 0 ? &(double){e->replicates} : &none);
}

/* A member of an object: null where no value is known. */
static void put_list(FILE *f, const char *key, size_t n, const double values[])
{
    size_t k = 0;
    while (values && k < n && !isfinite(values[k]))
        k++;
    fputs(key, f);
    if (values && k < n)
        print_list(f, n, values);
    else
        fputs("null", f);
}

/* One value behind its separator. */
static void put_value(FILE *f, const char *before, json_t *value)
{
    fputs(before, f);
    json_dumpf(value, f, JSON_COMPACT | JSON_ENCODE_ANY | JSON_REAL_PRECISION(17));
    json_decref(value);
}

/* A design as an object of JSON. */
static void put_object(FILE *f, const Run *run, size_t i)
{
    char word[KIND_WORD_MAX];
    const Evaluation *e = &run->table.row[i];
    const Schema *s = &run->schema;
    fprintf(f, "%s{\"id\":%ld,\"generation\":%ld,\"kind\":\"%s\",\"outcome\":\"%s\"", i == 0 ? "\n" : ",\n", e->id,
            e->generation, kind_word(e->kind), outcome_word(e->outcome));
    put_value(f, ",\"reason\":", json_words(e->reason));
    fputs(",\"x\":[", f);
    for (size_t j = 0; j < s->n_var; j++) {
        fputs(j > 0 ? "," : "", f);
        if (schema_word(s, j, e->x[j], word))
            fprintf(f, "\"%s\"", word);
        else
            print_number(f, e->x[j]);
    }
    fputc(']', f);
    put_list(f, ",\"f\":", s->n_obj, e->f);
    fputs(run->place[i].on_front ? ",\"on_front\":true" : ",\"on_front\":false", f);
    put_list(f, ",\"sd\":", s->n_obj, e->sd);
    if (e->replicates > run->settings->sim.replicates)
        put_list(f, ",\"mean\":", s->n_obj, run_f(run, i));
    if (s->has_spread)
        fprintf(f, ",\"replicates\":%d", e->replicates);
    if (e->err)
        put_list(f, ",\"err\":", s->n_obj + s->n_extra, e->err);
    if (s->n_extra > 0) {
        fputs(s->order.n_obj > 0 ? ",\"measures\":" : ",\"g\":", f);
        print_list(f, s->n_extra, e->extra);
    }
    fputc('}', f);
}

/* -- many ---------------------------------------------------------------------------------------------------------- */

typedef struct {
    const Run *run;
    const Part *parts; /* NULL: objects of JSON */
    const size_t *rows;
} Many;

/* Designs first .. end - 1 of the list as lines of a table, or as objects. */
static void put_some(FILE *f, const Many *m, size_t first, size_t end)
{
    for (size_t i = first; i < end; i++) {
        const size_t row = m->rows ? m->rows[i] : i;
        if (!m->parts)
            put_object(f, m->run, row);
        for (const Part *p = m->parts; p && *p; p++)
            put_cells(f, m->run, row, *p);
        if (m->parts)
            fputc('\n', f);
    }
}

/* Numbers become text in blocks, by all threads. */
static Status put_all(FILE *f, const Many *m, size_t n, Err *err)
{
    enum { BLOCK = 2048 };
    int failed = 0;
    if (n <= BLOCK) {
        put_some(f, m, 0, n);
        return STATUS_OK;
    }
#pragma omp parallel for ordered schedule(static, 1)
    for (size_t first = 0; first < n; first += BLOCK) {
        char *text;
        size_t length;
        FILE *block = text_open(&text, &length);
        if (block)
            put_some(block, m, first, first + BLOCK < n ? first + BLOCK : n);
        const int fault = !block || text_close(block);
#pragma omp ordered
        {
            failed |= fault;
            if (text)
                fwrite(text, 1, length, f);
        }
        free(text);
    }
    return failed ? fail(err, STATUS_NO_MEMORY, "no memory for a table of %zu designs", n) : STATUS_OK;
}

Status export_designs(FILE *f, const Run *run, ExportTable table, size_t n, const size_t rows[], Err *err)
{
    static const char *const WORDS[] = {
        [PART_ID] = "id", [PART_ORIGIN] = ",generation,kind,outcome,reason", [PART_VIOLATION] = ",violation"};
    const Schema *s = &run->schema;
    for (const Part *p = PARTS[table]; table != EXPORT_PAGE && *p; p++) {
        const Numbers heads = numbers_of(s, &(Evaluation){0}, NULL, *p);
        fputs(*p <= PART_VIOLATION ? WORDS[*p] : "", f);
        for (size_t i = 0; i < heads.n; i++)
            fprintf(f, ",%s%s%s", heads.begin ? heads.begin : "", heads.column[heads.of ? heads.of[i] : i].name,
                    heads.end ? heads.end : "");
        fputs(*p == PART_SD && s->has_spread ? ",replicates" : "", f);
    }
    fputs(table != EXPORT_PAGE ? "\n" : "", f);
    return put_all(f, &(Many){run, PARTS[table], rows}, n, err);
}

/* -- files of the run's folder ------------------------------------------------------------------------------------- */

Status export_inside(const Run *run, ExportTable table, size_t n, const size_t rows[], Err *err)
{
    char path[PATH_MAX];
    Output o;
    folder_path(run->folder, table == EXPORT_FRONT ? "front.csv" : "nearest.csv", path);
    if (table == EXPORT_NEAREST && n == 0) {
        unlink(path);
        return STATUS_OK;
    }
    TRY(output_open_inside(&o, path, err));
    return output_end(&o, export_designs(o.stream, run, table, n, rows, err), err);
}

/* -- JSON ---------------------------------------------------------------------------------------------------------- */

static void put_setting(const char *key, const char *value, void *user)
{
    json_object_set_new(user, key, json_words(value));
}

Status export_json(FILE *f, const Run *run, Err *err)
{
    const Schema *s = &run->schema;
    json_t *settings = json_object(), *columns = json_array();
    settings_each(run->settings, NULL, put_setting, settings);
    for (size_t c = 0; c < s->n_var + s->n_obj + s->n_extra; c++) {
        const int is_objective = c >= s->n_var && c < s->n_var + s->n_obj;
        json_array_append_new(columns, json_of("name=%s role=%s sense=%s", s->column[c].name,
                                               c < s->n_var         ? "variable"
                                               : is_objective       ? "objective"
                                               : s->order.n_obj > 0 ? "measure"
                                                                    : "constraint",
                                               !is_objective              ? NULL
                                               : s->column[c].sense > 0.0 ? "min"
                                                                          : "max"));
    }
    put_value(f, "{\"settings\":", settings);
    put_value(f, ",\n\"columns\":", columns);
    fputs(",\n\"evaluations\":[", f);
    TRY(put_all(f, &(Many){run, NULL, NULL}, run->table.n, err));
    fputs("],\n\"generations\":[", f);
    for (const RunGeneration *g = run->generation; g < run->generation + run->n_generations; g++)
        put_value(f, g == run->generation ? "\n" : ",\n",
                  json_of("number=%ld simulated=%ld failed=%ld front=%ld surrogate_error=%g hypervolume=%g", g->number,
                          g->simulated, g->failed, g->front, g->surrogate_error, g->hypervolume));
    fputs("]}\n", f);
    return ferror(f) ? fail(err, STATUS_IO, "standard output: cannot be written") : STATUS_OK;
}
