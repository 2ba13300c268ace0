#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "report/report.h"
#include "simulator/measures.h"
#include "store/output.h"
#include "store/provenance.h"
#include "settings/settings.h"

/* build/web/page.html: the page with a line MARK where the run goes. */
extern const char _binary_build_web_page_html_start[], _binary_build_web_page_html_end[];
static const char MARK[] = "<!-- the run -->\n";

enum { HISTORY_POINTS = 3000 };

/* Appends and returns the list, or NULL: json_pack then refuses the whole, so that no memory never means a value less.
 */
static json_t *append(json_t *list, json_t *value)
{
    if (json_array_append_new(list, value) == 0)
        return list;
    json_decref(list);
    return NULL;
}

static json_t *number(double value)
{
    return isfinite(value) ? json_real(value) : json_null();
}

/* Every step-th of n. */
static json_t *numbers(size_t n, size_t step, const double values[])
{
    json_t *list = json_array();
    for (size_t i = 0; i < n; i += step)
        list = append(list, number(values[i]));
    return list;
}

/* Every setting of the run. */
static json_t *json_of_settings(const Settings *s)
{
    char *text = NULL;
    size_t length;
    FILE *stream = open_memstream(&text, &length);
    if (!stream)
        return NULL;
    settings_write(s, stream, 0);
    json_t *string = fclose(stream) == 0 ? json_string(text) : NULL;
    free(text);
    return string;
}

/* ---- the chosen design ----------------------------------------------------------------------------------------- */

static json_t *json_of_result(const SimResult *r)
{
    const size_t n = (size_t)r->n_floors, n_modes = (size_t)r->n_modes;
    if (r->outcome != RUN_OK)
        return json_pack("{s:s}", "reason", r->reason);
    json_t *objectives = json_array();
    for (int k = 0; k < N_OBJECTIVES; k++)
        objectives = append(objectives, number(measure_value(r, k)));
    return json_pack("{s:o, s:I, s:f, s:f, s:b, s:o, s:o, s:o, s:o}", "objectives", objectives, "impacts",
                     (json_int_t)r->impacts, "input_j", r->input_energy_j, "contact_pct",
                     r->input_energy_j > 0 ? 100 * r->contact_loss_j / r->input_energy_j : 0.0, "beyond_law",
                     r->beyond_contact_law, "displacement_m", numbers(n, 1, r->peak_displacement_m), "drift_m",
                     numbers(n, 1, r->peak_drift_m), "acceleration_g", numbers(n, 1, r->peak_acceleration_g), "modes",
                     numbers(n_modes, 1, r->mode_share_pct));
}

static json_t *json_of_energies(const History *h, size_t step)
{
    return json_pack(
        "{s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "kinetic", numbers(h->n, step, h->energy[ENERGY_KINETIC]), "strain",
        numbers(h->n, step, h->energy[ENERGY_STRAIN]), "damped_building",
        numbers(h->n, step, h->energy[ENERGY_DAMPED_BUILDING]), "core", numbers(h->n, step, h->energy[ENERGY_CORE]),
        "damped_core", numbers(h->n, step, h->energy[ENERGY_DAMPED_CORE]), "contacts",
        numbers(h->n, step, h->energy[ENERGY_CONTACTS]), "input", numbers(h->n, step, h->energy[ENERGY_INPUT]));
}

static json_t *json_of_history(const History *h, const Spectrogram *s)
{
    const size_t step = h->n / HISTORY_POINTS + 1;
    if (h->n < 2)
        return json_null();
    return json_pack("{s:o, s:o, s:o, s:o, s:o, s:o}", "t", numbers(h->n, step, h->t), "u", numbers(h->n, step, h->u),
                     "energies", json_of_energies(h, step), "spectrum_f", numbers(SPECTRUM_FREQUENCIES, 1, s->f),
                     "spectrum_t", numbers(SPECTRUM_TIMES, 1, s->t), "spectrum",
                     numbers(SPECTRUM_FREQUENCIES * SPECTRUM_TIMES, 1, s->amplitude));
}

static json_t *json_of_detail(const Detail *d)
{
    const size_t n = (size_t)d->n_floors;
    json_t *others = json_array();
    for (size_t i = 0; i < d->n_elsewhere; i++) {
        const Elsewhere *e = &d->elsewhere[i];
        others = append(others, json_pack("{s:s, s:f, s:f, s:o, s:o}", "record", e->record, "pga_g", e->pga_g,
                                          "stretch", e->stretch, "with_core", json_of_result(&e->with_core), "no_core",
                                          json_of_result(&e->no_core)));
    }
    return json_pack("{s:i, s:o, s:o, s:o, s:o, s:s, s:f, s:f, s:f, s:o, s:o, s:o, s:o, s:o, s:o}", "floor",
                     d->floor + 1, "gap_m", numbers(n, 1, d->gap_m), "wall_m", numbers(n, 1, d->wall_m), "building_hz",
                     numbers(n, 1, d->building_hz), "core_hz", numbers(n, 1, d->core_hz), "record", d->record, "pga_g",
                     d->pga_g, "stretch", d->stretch, "duration_s", d->duration_s, "with_core",
                     json_of_result(&d->result[SCENE_IMPACT]), "no_core", json_of_result(&d->result[SCENE_NO_CORE]),
                     "tied", json_of_result(&d->result[SCENE_TIED]), "history_with_core",
                     json_of_history(&d->history[0], &d->spectrum[0]), "history_no_core",
                     json_of_history(&d->history[1], &d->spectrum[1]), "elsewhere", others);
}

/* ---- the run --------------------------------------------------------------------------------------------------- */

static json_t *json_of_names(const Schema *schema)
{
    json_t *variables = json_array(), *objectives = json_array();
    for (size_t j = 0; j < schema->n_var; j++)
        variables = append(variables, json_string(schema_variable(schema, j)->name));
    for (size_t k = 0; k < schema->n_obj; k++) {
        const Column *c = schema_objective(schema, k);
        objectives = append(objectives, json_pack("{s:s, s:f}", "name", c->name, "sense", c->sense));
    }
    return json_pack("{s:o, s:o}", "variables", variables, "objectives", objectives);
}

static json_t *json_of_run(const Report *r)
{
    const Convergence *c = &r->convergence;
    char name[PATH_MAX];
    snprintf(name, sizeof name, "%s", r->folder);
    for (size_t n = strlen(name); n > 1 && name[n - 1] == '/'; n--)
        name[n - 1] = 0;
    const char *slash = strrchr(name, '/');
    return json_pack(
        "{s:s, s:s, s:s, s:s, s:b, s:b, s:I, s:I, s:I, s:I, s:o, s:{s:o, s:o, s:o}, s:o, s:o, s:o}", "version",
        program_version(), "revision", program_revision(), "name", slash && slash[1] ? slash + 1 : name, "folder", name,
        "tower", r->has_detail, "robust", r->is_robust, "knee", (json_int_t)front_id(&r->front, r->knee), "chosen",
        (json_int_t)front_id(&r->front, r->chosen), "evaluated", (json_int_t)c->n_evaluated, "failed",
        (json_int_t)c->n_failed, "schema", json_of_names(&r->front.schema), "convergence", "simulated",
        numbers(c->n, 1, c->simulated), "volume", numbers(c->n, 1, c->volume), "error",
        numbers(c->n, 1, c->standard_error), "detail", r->has_detail ? json_of_detail(&r->detail) : json_null(),
        "settings", json_of_settings(&r->settings), "provenance",
        r->provenance ? json_string(r->provenance) : json_null());
}

/* JSON in which no text can end the script element or begin a comment: < stands only inside strings. */
static Status write_json(json_t *all, FILE *out, Err *err)
{
    char *text = all ? json_dumps(all, JSON_COMPACT | JSON_ENSURE_ASCII | JSON_REAL_PRECISION(6)) : NULL;
    json_decref(all);
    if (!text)
        return fail(err, STATUS_NO_MEMORY, "the report cannot be put together: no memory, or a name is not UTF-8");
    for (const char *p = text; *p; p++)
        if (*p == '<')
            fputs("\\u003c", out);
        else
            fputc(*p, out);
    free(text);
    return STATUS_OK;
}

/* One line per design as in front.csv: id, variables, objectives. */
static void write_rows(const Front *front, FILE *out)
{
    for (size_t i = 0; i < front->n; i++) {
        fprintf(out, "%ld", front_id(front, i));
        for (size_t j = 0; j < (size_t)front->n_var + front->n_obj; j++) {
            fputc(',', out);
            print_number(out, front_x(front, i)[j]); /* the objectives follow the variables */
        }
        fputc('\n', out);
    }
}

static Status write_page(const Report *r, FILE *out, Err *err)
{
    const char *start = _binary_build_web_page_html_start, *end = _binary_build_web_page_html_end;
    const char *mark = memmem(start, (size_t)(end - start), MARK, sizeof MARK - 1);
    if (!mark)
        return fail(err, STATUS_INTERNAL, "the page of the report has no place for the run");
    fwrite(start, 1, (size_t)(mark - start), out); /* a failed write is seen on closing */
    fputs("<script type=\"application/json\" id=\"run\">", out);
    TRY(write_json(json_of_run(r), out, err));
    fputs("</script>\n<script type=\"text/plain\" id=\"rows\">\n", out);
    write_rows(&r->front, out);
    fputs("</script>\n", out);
    mark += sizeof MARK - 1;
    fwrite(mark, 1, (size_t)(end - mark), out);
    return STATUS_OK;
}

Status report_page(const Report *r, const char *path, Err *err)
{
    Output o;
    TRY(output_open(&o, path, err));
    const Status status = write_page(r, o.stream, err);
    if (status != STATUS_OK) {
        output_abandon(&o);
        return status;
    }
    return output_close(&o, err);
}
