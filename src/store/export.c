#include "store/export.h"

#include <math.h>

#include "base/json.h"
#include "store/output.h"
#include "store/rows.h"
#include "store/run_read.h"
#include "settings/settings.h"

/* Variables and the first n results. */
static void put_names(FILE *f, const char *before, const Schema *schema, size_t n)
{
    fputs(before, f);
    for (size_t c = 0; c < schema->n_var + n; c++)
        fprintf(f, ",%s", schema->column[c].name);
}

void export_names(FILE *f, const char *before, const Schema *schema)
{
    put_names(f, before, schema, schema->n_obj);
    for (size_t k = 0; k < schema->n_limited; k++)
        fprintf(f, ",%s", schema_extra(schema, schema->limited[k])->name);
}

void export_front_header(FILE *f, const Schema *schema)
{
    export_names(f, "id", schema);
    for (size_t k = 0; schema->has_spread && k < schema->n_obj; k++)
        fprintf(f, ",%s_sd", schema_objective(schema, k)->name);
    fputs(schema->has_spread ? ",replicates\n" : "\n", f);
}

static void put_limited(FILE *f, const Schema *schema, const double extra[])
{
    double values[N_MEASURES];
    schema_limited(schema, extra, values);
    print_cells(f, schema->n_limited, values);
}

void export_numbers(FILE *f, const Run *run, size_t row)
{
    print_cells(f, run->schema.n_var, run_x(run, row));
    print_cells(f, run->schema.n_obj, run_f(run, row));
    put_limited(f, &run->schema, run->table.row[row].extra);
}

static void put_results(FILE *f, const Schema *schema, const Evaluation *e, const double means[])
{
    print_cells(f, schema->n_obj, means);
    put_limited(f, schema, e->extra);
    if (schema->has_spread) {
        print_cells(f, schema->n_obj, e->sd);
        fputc(',', f);
        if (e->replicates > 0)
            fprintf(f, "%d", e->replicates);
    }
    fputc('\n', f);
}

void export_design_as(FILE *f, const Schema *schema, const Evaluation *e, const double means[])
{
    fprintf(f, "%ld", e->id);
    print_cells(f, schema->n_var, e->x);
    put_results(f, schema, e, means);
}

void export_design(FILE *f, const Run *run, size_t row)
{
    export_design_as(f, &run->schema, &run->table.row[row], run_f(run, row));
}

void export_front(FILE *f, const Run *run)
{
    export_front_header(f, &run->schema);
    for (size_t i = 0; i < run->n_front; i++)
        export_design(f, run, run->front[i]);
}

static Status no_number(const Run *run, size_t row, Err *err)
{
    return fail(err, STATUS_IO, "%s: is damaged: a number of evaluation %ld cannot be read", run->folder,
                run->table.row[row].id);
}

static Status begin_front(const Run *run, void *f, Err *err)
{
    (void)err;
    export_front_header(f, &run->schema);
    return STATUS_OK;
}

static Status visit_front(const Run *run, size_t row, const RowNumbers *stored, void *f, Err *err)
{
    Evaluation e = run->table.row[row];
    double extra[N_MEASURES];
    const Schema *s = &run->schema;
    /* else means, deviations or some of the further results are wanted */
    const int as_stored = !s->has_spread && s->n_limited == 0 && run->F == run->table.f;
    if (!run->place[row].on_front)
        return STATUS_OK;
    fprintf(f, "%ld", e.id);
    if (stored->x[0] != '[' || !rows_put_texts(f, stored->x, s->n_var, ",", "") ||
        !(as_stored ? rows_put_texts(f, stored->f, s->n_obj, ",", "")
                    : rows_numbers(stored->extra, 0, s->n_extra, e.extra = extra)))
        return no_number(run, row, err);
    if (as_stored)
        fputc('\n', f);
    else
        put_results(f, s, &e, run_f(run, row));
    return STATUS_OK;
}

Status export_front_of(FILE *f, const char *folder, Err *err)
{
    static const RunVisitor VISITOR = {begin_front, visit_front, NULL};
    return run_visit(folder, &VISITOR, f, err);
}

void export_evaluations_header(FILE *f, const Schema *schema)
{
    put_names(f, "id,generation,kind,outcome,reason", schema, schema->n_obj + schema->n_extra);
    fputc('\n', f);
}

void export_evaluations(FILE *f, const EvaluationTable *t)
{
    for (size_t i = 0; i < t->n; i++) {
        const Evaluation *e = &t->row[i];
        if (e->kind == KIND_UNFINISHED)
            continue;
        fprintf(f, "%ld,%ld,%s,%s,%s", e->id, e->generation, kind_word(e->kind), outcome_word(e->outcome), e->reason);
        print_cells(f, t->n_var, e->x);
        print_cells(f, t->n_obj, e->f);
        print_cells(f, t->n_extra, e->extra);
        fputc('\n', f);
    }
}

/* -- JSON ---------------------------------------------------------------------------------------------------------- */

static void put_setting(const char *key, const char *value, void *user)
{
    json_object_set_new(user, key, json_words(value));
}

static json_t *json_settings(const Settings *s)
{
    json_t *o = json_object();
    settings_each(s, put_setting, o);
    return o;
}

static json_t *json_columns(const Schema *schema)
{
    json_t *list = json_array();
    for (size_t c = 0; c < schema->n_var + schema->n_obj + schema->n_extra; c++) {
        const int is_objective = c >= schema->n_var && c < schema->n_var + schema->n_obj;
        json_array_append_new(list, json_pack("{s:o, s:s, s:s*}", "name", json_words(schema->column[c].name), "role",
                                              c < schema->n_var ? "variable"
                                              : is_objective    ? "objective"
                                                                : "measure",
                                              "sense",
                                              !is_objective                   ? NULL
                                              : schema->column[c].sense > 0.0 ? "min"
                                                                              : "max"));
    }
    return list;
}

static Status not_put(FILE *f, Err *err)
{
    return ferror(f) ? fail(err, STATUS_IO, "standard output: cannot be written")
                     : fail(err, STATUS_NO_MEMORY, "no memory for the run as JSON");
}

/* One value behind its separator; a line each, so that a run of any size needs no memory here. */
static int put_value(FILE *f, const char *before, json_t *value)
{
    fputs(before, f);
    const int failed = json_dumpf(value, f, JSON_COMPACT | JSON_ENCODE_ANY | JSON_REAL_PRECISION(17));
    json_decref(value);
    return failed;
}

static int is_any_known(size_t n, const double values[])
{
    size_t k = 0;
    while (k < n && !isfinite(values[k]))
        k++;
    return k < n;
}

static void put_list(FILE *f, const char *key, size_t n, const double values[], int known)
{
    fputs(key, f);
    if (known)
        print_list(f, n, values);
    else
        fputs("null", f);
}

/* Numbers in the fewest digits that read back as the same, as they are stored. */
static Status visit_evaluation(const Run *run, size_t i, const RowNumbers *stored, void *user, Err *err)
{
    FILE *f = user;
    const Evaluation *e = &run->table.row[i];
    const Schema *s = &run->schema;
    int failed = 0;
    fprintf(f, "%s{\"id\":%ld,\"generation\":%ld,\"kind\":\"%s\",\"outcome\":\"%s\",\"reason\":", i == 0 ? "\n" : ",\n",
            e->id, e->generation, kind_word(e->kind), outcome_word(e->outcome));
    if (e->reason[0])
        failed = put_value(f, "", json_words(e->reason));
    else
        fputs("\"\"", f);
    fputs(",\"x\":", f);
    int known = stored->x[0] == '[' && rows_put_texts(f, stored->x, s->n_var, "[", "null");
    fputs("],\"f\":", f);
    if (isfinite(e->f[0]))
        known = rows_put_texts(f, stored->f, s->n_obj, "[", "null") && known;
    fputs(isfinite(e->f[0]) ? "]" : "null", f);
    fputs(run->place[i].on_front ? ",\"on_front\":true" : ",\"on_front\":false", f);
    put_list(f, ",\"sd\":", s->n_obj, e->sd, is_any_known(s->n_obj, e->sd));
    if (e->replicates > run->settings->sim.replicates)
        put_list(f, ",\"mean\":", s->n_obj, run_f(run, i), 1);
    if (s->has_spread)
        fprintf(f, ",\"replicates\":%d", e->replicates);
    if (s->n_extra > 0) {
        fputs(",\"measures\":", f);
        known = rows_put_texts(f, stored->extra, s->n_extra, "[", "null") && known;
        fputc(']', f);
    }
    fputc('}', f);
    if (!known)
        return no_number(run, i, err);
    return failed ? not_put(f, err) : STATUS_OK;
}

static json_t *json_generation(const RunGeneration *g)
{
    return json_pack("{s:I, s:I, s:I, s:I, s:I, s:o, s:o}", "number", (json_int_t)g->number, "simulated",
                     (json_int_t)g->simulated, "failed", (json_int_t)g->failed, "front", (json_int_t)g->front,
                     "predicted", (json_int_t)g->predicted, "surrogate_error", json_number(g->surrogate_error),
                     "hypervolume", json_number(g->hypervolume));
}

static Status begin_json(const Run *run, void *user, Err *err)
{
    FILE *f = user;
    int failed = put_value(f, "{\"settings\":", json_settings(run->settings));
    failed |= put_value(f, ",\n\"columns\":", json_columns(&run->schema));
    fputs(",\n\"evaluations\":[", f);
    return failed ? not_put(f, err) : STATUS_OK;
}

static Status end_json(const Run *run, void *user, Err *err)
{
    FILE *f = user;
    int failed = 0;
    fputs("],\n\"generations\":[", f);
    for (size_t g = 0; g < run->n_generations; g++)
        failed |= put_value(f, g == 0 ? "\n" : ",\n", json_generation(&run->generation[g]));
    fputs("]}\n", f);
    return failed ? not_put(f, err) : STATUS_OK;
}

Status export_json_of(FILE *f, const char *folder, Err *err)
{
    static const RunVisitor VISITOR = {begin_json, visit_evaluation, end_json};
    return run_visit(folder, &VISITOR, f, err);
}
