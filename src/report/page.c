#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/json.h"
#include "moga/hypervolume.h"
#include "report/report.h"
#include "store/output.h"
#include "store/provenance.h"
#include "settings/settings.h"

/* build/web/page.html: the page with a line MARK where the run goes. */
extern const char _binary_build_web_page_html_start[], _binary_build_web_page_html_end[];
static const char MARK[] = "<!-- the run -->\n";

enum { HISTORY_POINTS = 3000 };

/* Every setting of the run. */
static json_t *json_of_settings(const Settings *s)
{
    char *text = NULL;
    size_t length;
    FILE *stream = open_memstream(&text, &length);
    if (!stream)
        return NULL;
    settings_write(s, stream, 0);
    json_t *string = fclose(stream) == 0 ? json_words(text) : NULL;
    free(text);
    return string;
}

/* ---- the chosen design ----------------------------------------------------------------------------------------- */

static json_t *json_of_result(const SimResult *r, const MeasureOrder *order)
{
    const size_t n = (size_t)r->n_floors, n_modes = (size_t)r->n_modes;
    if (r->outcome != RUN_OK)
        return json_pack("{s:s}", "reason", r->reason);
    json_t *objectives = json_array();
    for (int k = 0; k < order->n_obj; k++)
        objectives = json_append(objectives, json_number(measure_value(r, order->of[k])));
    return json_pack("{s:o, s:I, s:f, s:f, s:b, s:o, s:o, s:o, s:o}", "objectives", objectives, "impacts",
                     (json_int_t)r->impacts, "input_j", r->input_energy_j, "contact_pct",
                     r->input_energy_j > 0 ? 100 * r->contact_loss_j / r->input_energy_j : 0.0, "beyond_law",
                     beyond_contact_law(r), "displacement_m", json_numbers(n, r->peak_displacement_m), "drift_m",
                     json_numbers(n, r->peak_drift_m), "acceleration_g", json_numbers(n, r->peak_acceleration_g),
                     "modes", json_numbers(n_modes, r->mode_share_pct));
}

static json_t *json_of_energies(const History *h, size_t step)
{
    return json_pack("{s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "kinetic",
                     json_numbers_every(step, h->n, h->energy[ENERGY_KINETIC]), "strain",
                     json_numbers_every(step, h->n, h->energy[ENERGY_STRAIN]), "damped_building",
                     json_numbers_every(step, h->n, h->energy[ENERGY_DAMPED_BUILDING]), "core",
                     json_numbers_every(step, h->n, h->energy[ENERGY_CORE]), "damped_core",
                     json_numbers_every(step, h->n, h->energy[ENERGY_DAMPED_CORE]), "contacts",
                     json_numbers_every(step, h->n, h->energy[ENERGY_CONTACTS]), "input",
                     json_numbers_every(step, h->n, h->energy[ENERGY_INPUT]));
}

static json_t *json_of_history(const History *h, const Spectrogram *s)
{
    const size_t step = h->n / HISTORY_POINTS + 1;
    if (h->n < 2)
        return json_null();
    return json_pack("{s:o, s:o, s:o, s:o, s:o, s:o}", "t", json_numbers_every(step, h->n, h->t), "u",
                     json_numbers_every(step, h->n, h->u), "energies", json_of_energies(h, step), "spectrum_f",
                     json_numbers(SPECTRUM_FREQUENCIES, s->f), "spectrum_t", json_numbers(SPECTRUM_TIMES, s->t),
                     "spectrum", json_numbers(SPECTRUM_FREQUENCIES * SPECTRUM_TIMES, s->amplitude));
}

/* Values of all records by the rule of the run. */
static json_t *json_of_baselines(const Baseline baseline[N_BASELINES], const MeasureOrder *order)
{
    json_t *list = json_array();
    for (int k = 0; k < N_BASELINES; k++) {
        double values[N_MEASURES];
        for (int i = 0; i < order->n_obj; i++)
            values[i] = baseline[k].value[order->of[i]];
        char device[DEVICE_TEXT_MAX];
        baseline_device_text((BaselineKind)k, &baseline[k].device, device);
        const int ok = baseline[k].outcome == OUTCOME_OK;
        list = json_append(list, json_pack("{s:s, s:s, s:s, s:o}", "key", baseline_key((BaselineKind)k), "words",
                                           baseline_words((BaselineKind)k), "device", device, "objectives",
                                           ok ? json_numbers((size_t)order->n_obj, values) : json_null()));
    }
    return list;
}

/* What a building and a core have to bear, as people read it. */
static const struct {
    MeasureId id;
    const char *title, *unit;
    double factor;
} LOADS[] = {{MEASURE_DRIFT_RATIO, "drift ratio", "%", 100},          {MEASURE_J3_FILTERED, "J3 filtered", "g", 1},
             {MEASURE_CONTACT_FORCE, "force on a floor", "MN", 1e-6}, {MEASURE_CORE_STRESS, "core stress", "MPa", 1e-6},
             {MEASURE_CORE_BUCKLING, "stress / buckling", "", 1},     {MEASURE_BASE_SHEAR, "base shear", "MN", 1e-6}};
enum { N_LOADS = sizeof LOADS / sizeof LOADS[0] };

/* Under the first record, for the chosen design and its baselines. */
static json_t *json_of_loads(const Detail *d)
{
    static const char *const WORDS[N_SCENES] = {"impacts", "no core", "rigidly connected", "tuned mass damper",
                                                "viscous links"};
    json_t *columns = json_array(), *rows = json_array();
    for (int k = 0; k < N_LOADS; k++)
        columns = json_append(columns, json_pack("{s:s, s:s}", "title", LOADS[k].title, "unit", LOADS[k].unit));
    for (int scene = 0; scene < N_SCENES; scene++) {
        double values[N_LOADS];
        for (int k = 0; k < N_LOADS; k++)
            values[k] = LOADS[k].factor * measure_value(&d->result[scene], LOADS[k].id);
        if (d->result[scene].outcome == RUN_OK)
            rows = json_append(rows,
                               json_pack("{s:s, s:o}", "words", WORDS[scene], "values", json_numbers(N_LOADS, values)));
    }
    return json_pack("{s:o, s:o}", "columns", columns, "rows", rows);
}

static json_t *json_of_detail(const Detail *d, const MeasureOrder *order)
{
    const size_t n = (size_t)d->n_floors;
    json_t *others = json_array();
    for (size_t i = 0; i < d->n_elsewhere; i++) {
        const Elsewhere *e = &d->elsewhere[i];
        others = json_append(others, json_pack("{s:o, s:f, s:f, s:f, s:o, s:o}", "record", json_words(e->record),
                                               "pga_g", e->pga_g, "scale", e->scale, "stretch", e->stretch, "with_core",
                                               json_of_result(&e->with_core, order), "no_core",
                                               json_of_result(&e->no_core, order)));
    }
    return json_pack(
        "{s:i, s:o, s:o, s:o, s:o, s:o, s:o, s:f, s:f, s:f, s:f, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o}",
        "floor", d->floor + 1, "gap_m", json_numbers(n, d->gap_m), "thickness_m", json_numbers(n, d->thickness_m),
        "bumper_n_m", json_numbers(n, d->bumper_n_m), "building_hz", json_numbers(n, d->building_hz), "core_hz",
        json_numbers(n, d->core_hz), "record", json_words(d->record), "pga_g", d->pga_g, "scale", d->scale, "stretch",
        d->stretch, "duration_s", d->duration_s, "with_core", json_of_result(&d->result[SCENE_IMPACT], order),
        "no_core", json_of_result(&d->result[SCENE_NO_CORE], order), "rigid",
        json_of_result(&d->result[SCENE_RIGID], order), "tmd", json_of_result(&d->result[SCENE_TMD], order), "links",
        json_of_result(&d->result[SCENE_LINKS], order), "loads", json_of_loads(d), "baselines",
        json_of_baselines(d->baseline, order), "history_with_core", json_of_history(&d->history[0], &d->spectrum[0]),
        "history_no_core", json_of_history(&d->history[1], &d->spectrum[1]), "elsewhere", others);
}

/* ---- the run --------------------------------------------------------------------------------------------------- */

static json_t *json_of_names(const Schema *schema)
{
    json_t *variables = json_array(), *objectives = json_array();
    for (size_t j = 0; j < schema->n_var; j++)
        variables = json_append(variables, json_words(schema_variable(schema, j)->name));
    for (size_t k = 0; k < schema->n_obj; k++) {
        const Column *c = schema_objective(schema, k);
        json_t *o = json_pack("{s:o, s:f}", "name", json_words(c->name), "sense", c->sense);
        if (schema->order.n_obj > 0) {
            json_object_set_new(o, "what", json_string(measure(schema->order.of[k])->what));
            json_object_set_new(o, "unit", json_string(measure(schema->order.of[k])->unit));
        }
        objectives = json_append(objectives, o);
    }
    return json_pack("{s:o, s:o}", "variables", variables, "objectives", objectives);
}

/* Growth of the hypervolume, the generations that have one. */
static json_t *json_of_growth(const Run *run)
{
    json_t *simulated = json_array(), *volume = json_array(), *error = json_array();
    for (size_t i = 0; i < run->n_generations; i++) {
        const double v = run->generation[i].hypervolume;
        if (!isfinite(v))
            continue;
        simulated = json_append(simulated, json_number((double)run->generation[i].simulated));
        volume = json_append(volume, json_number(v));
        error = json_append(error, json_number(hypervolume_error(v)));
    }
    return json_pack("{s:o, s:o, s:o}", "simulated", simulated, "volume", volume, "error", error);
}

static size_t n_evaluated(const Run *run)
{
    size_t n = 0;
    for (size_t i = 0; i < run->table.n; i++)
        n += run->table.row[i].kind != KIND_UNFINISHED;
    return n;
}

static json_t *json_of_run(const Report *r)
{
    const Run *run = r->run;
    char name[PATH_MAX];
    snprintf(name, sizeof name, "%s", run->folder);
    for (size_t n = strlen(name); n > 1 && name[n - 1] == '/'; n--)
        name[n - 1] = 0;
    const char *slash = strrchr(name, '/');
    return json_pack(
        "{s:s, s:s, s:o, s:o, s:b, s:b, s:s, s:I, s:I, s:o, s:I, s:I, s:o, s:o, s:o, s:o, s:s}", "version",
        program_version(), "revision", program_revision(), "name", json_words(slash && slash[1] ? slash + 1 : name),
        "folder", json_words(name), "tower", r->has_detail, "robust", r->is_robust, "spread",
        spread_word(run->settings->sim.gap_tolerance_m, &run->settings->uncertain), "knee",
        (json_int_t)run->table.row[r->knee].id, "chosen", (json_int_t)run->table.row[r->chosen].id, "chosen_f",
        json_numbers(run->schema.n_obj, run_f(run, r->chosen)), "evaluated", (json_int_t)n_evaluated(run), "failed",
        (json_int_t)run->n_failed, "schema", json_of_names(&run->schema), "convergence", json_of_growth(run), "detail",
        r->has_detail ? json_of_detail(&r->detail, &run->schema.order) : json_null(), "settings",
        json_of_settings(run->settings), "provenance", run->provenance);
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
static void write_rows(const Run *run, FILE *out)
{
    for (size_t i = 0; i < run->n_front; i++) {
        const size_t row = run->front[i];
        fprintf(out, "%ld", run->table.row[row].id);
        print_cells(out, run->schema.n_var, run_x(run, row));
        print_cells(out, run->schema.n_obj, run_f(run, row));
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
    write_rows(r->run, out);
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
