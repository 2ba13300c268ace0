#include "store/export.h"

#include <math.h>

#include "base/json.h"
#include "store/output.h"
#include "settings/settings.h"

static void write_names(FILE *f, const char *before, const Schema *schema, size_t n_extra, int with_sd)
{
    fputs(before, f);
    for (size_t j = 0; j < schema->n_var; j++)
        fprintf(f, ",%s", schema_variable(schema, j)->name);
    for (size_t k = 0; k < schema->n_obj; k++)
        fprintf(f, ",%s", schema_objective(schema, k)->name);
    for (size_t k = 0; k < n_extra; k++)
        fprintf(f, ",%s", schema_extra(schema, k)->name);
    for (size_t k = 0; with_sd && k < schema->n_obj; k++)
        fprintf(f, ",%s_sd", schema_objective(schema, k)->name);
    if (with_sd)
        fputs(",replicates", f);
    fputc('\n', f);
}

void export_front_header(FILE *f, const Schema *schema)
{
    write_names(f, "id", schema, 0, schema->has_spread);
}

void export_design_as(FILE *f, const Schema *schema, const Evaluation *e, const double means[])
{
    fprintf(f, "%ld", e->id);
    print_cells(f, schema->n_var, e->x);
    print_cells(f, schema->n_obj, means);
    if (schema->has_spread) {
        print_cells(f, schema->n_obj, e->sd);
        fputc(',', f);
        if (e->replicates > 0)
            fprintf(f, "%d", e->replicates);
    }
    fputc('\n', f);
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

void export_evaluations_header(FILE *f, const Schema *schema)
{
    write_names(f, "id,generation,kind,outcome,reason", schema, schema->n_extra, 0);
}

void export_evaluations(FILE *f, const EvaluationTable *t, size_t first, int unfinished_too)
{
    for (size_t i = first; i < t->n; i++) {
        const Evaluation *e = &t->row[i];
        if (e->kind == KIND_UNFINISHED && !unfinished_too)
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

static json_t *json_evaluation(const Run *run, size_t i)
{
    const Evaluation *e = &run->table.row[i];
    const Schema *schema = &run->schema;
    json_t *o = json_pack("{s:I, s:I, s:s, s:s, s:s, s:o, s:o, s:b}", "id", (json_int_t)e->id, "generation",
                          (json_int_t)e->generation, "kind", kind_word(e->kind), "outcome", outcome_word(e->outcome),
                          "reason", e->reason, "x", json_numbers(schema->n_var, e->x), "f",
                          isfinite(e->f[0]) ? json_numbers(schema->n_obj, e->f) : json_null(), "on_front",
                          run->place[i].on_front);
    int known = 0;
    for (size_t k = 0; k < schema->n_obj; k++)
        known = known || isfinite(e->sd[k]);
    json_object_set_new(o, "sd", known ? json_numbers(schema->n_obj, e->sd) : json_null());
    if (e->replicates > run->settings->sim.replicates)
        json_object_set_new(o, "mean", json_numbers(schema->n_obj, run_f(run, i)));
    if (schema->has_spread)
        json_object_set_new(o, "replicates", json_integer(e->replicates));
    if (schema->n_extra > 0)
        json_object_set_new(o, "measures", json_numbers(schema->n_extra, e->extra));
    return o;
}

static json_t *json_generation(const RunGeneration *g)
{
    return json_pack("{s:I, s:I, s:I, s:I, s:I, s:o, s:o}", "number", (json_int_t)g->number, "simulated",
                     (json_int_t)g->simulated, "failed", (json_int_t)g->failed, "front", (json_int_t)g->front,
                     "predicted", (json_int_t)g->predicted, "surrogate_error", json_number(g->surrogate_error),
                     "hypervolume", json_number(g->hypervolume));
}

/* One value behind its separator; a line each, so that a run of any size needs no memory here. */
static int put_value(FILE *f, const char *before, json_t *value)
{
    fputs(before, f);
    const int failed = json_dumpf(value, f, JSON_COMPACT | JSON_REAL_PRECISION(17));
    json_decref(value);
    return failed;
}

Status export_json(FILE *f, const Run *run, Err *err)
{
    int failed = put_value(f, "{\"settings\":", json_settings(run->settings));
    failed |= put_value(f, ",\n\"columns\":", json_columns(&run->schema));
    fputs(",\n\"evaluations\":[", f);
    for (size_t i = 0; i < run->table.n; i++)
        failed |= put_value(f, i == 0 ? "\n" : ",\n", json_evaluation(run, i));
    fputs("],\n\"generations\":[", f);
    for (size_t g = 0; g < run->n_generations; g++)
        failed |= put_value(f, g == 0 ? "\n" : ",\n", json_generation(&run->generation[g]));
    fputs("]}\n", f);
    return failed ? fail(err, STATUS_NO_MEMORY, "no memory for the run as JSON") : STATUS_OK;
}
