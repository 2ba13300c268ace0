#include "report/report_json.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/json.h"
#include "base/text.h"
#include "base/hypervolume.h"
#include "report/words.h"
#include "settings/settings.h"
#include "store/provenance.h"

enum { HISTORY_POINTS = 3000 };

/* Every setting of the run. */
static json_t *json_of_settings(const Settings *s)
{
    char *text = NULL;
    size_t length;
    FILE *stream = text_open(&text, &length);
    if (!stream)
        return NULL;
    settings_write(s, stream, SETTINGS_PLAIN);
    json_t *string = text_close(stream) == 0 ? json_words(text) : NULL;
    free(text);
    return string;
}

/* ---- the chosen design ----------------------------------------------------------------------------------------- */

json_t *result_json(const SimResult *r, const MeasureOrder *order)
{
    const size_t n = (size_t)r->n_floors, n_modes = (size_t)r->n_modes;
    if (r->outcome != RUN_OK)
        return json_pack("{s:s}", "reason", r->reason);
    json_t *objectives = json_array();
    for (int k = 0; k < order->n_obj; k++)
        objectives = json_append(objectives, json_number(measure_value(r, order->of[k])));
    json_t *closings = json_array();
    for (size_t j = 0; j < n; j++)
        closings = json_append(closings, json_integer(r->closings[j]));
    return json_pack("{s:o, s:I, s:o, s:o, s:f, s:f, s:b, s:o, s:o, s:o, s:o}", "objectives", objectives, "impacts",
                     (json_int_t)r->impacts, "closings", closings, "core_pct", json_number(r->edcs_pct), "input_j",
                     r->input_energy_j, "contact_pct",
                     r->input_energy_j > 0 ? 100 * r->contact_loss_j / r->input_energy_j : 0.0, "beyond_law",
                     beyond_contact_law(r), "displacement_m", json_numbers(n, r->peak_displacement_m), "drift_m",
                     json_numbers(n, r->peak_drift_m), "acceleration_g", json_numbers(n, r->peak_acceleration_g),
                     "modes", json_numbers(n_modes, r->mode_share_pct));
}

static json_t *json_of_energies(const History *h, size_t step)
{
    static const char *const KEYS[N_ENERGIES] = {"kinetic",  "strain", "damped_building", "core", "damped_core",
                                                 "contacts", "input"};
    json_t *o = json_object();
    for (int k = 0; k < N_ENERGIES; k++)
        json_object_set_new(o, KEYS[k], json_numbers_every(step, h->n, h->energy[k]));
    return o;
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

/* What a building and a core have to bear. */
static const MeasureId LOADS[] = {MEASURE_DRIFT_RATIO, MEASURE_J3_FILTERED,   MEASURE_CONTACT_FORCE,
                                  MEASURE_CORE_STRESS, MEASURE_CORE_BUCKLING, MEASURE_BASE_SHEAR};
enum { N_LOADS = sizeof LOADS / sizeof LOADS[0] };

/* Under the first record, for the chosen design and its baselines. */
static json_t *json_of_loads(const Detail *d)
{
    static const char *const KEYS[N_SCENES] = {"impacts", "no_core", "rigid", "tmd", "links"};
    json_t *columns = json_array(), *rows = json_array();
    for (int k = 0; k < N_LOADS; k++) {
        const Words w = words_of_measure(LOADS[k]);
        columns = json_append(columns, json_pack("{s:s, s:s}", "title", w.title, "unit", w.unit));
    }
    for (int scene = 0; scene < N_SCENES; scene++) {
        double values[N_LOADS];
        for (int k = 0; k < N_LOADS; k++)
            values[k] = words_of_measure(LOADS[k]).factor * measure_value(&d->result[scene], LOADS[k]);
        if (d->result[scene].outcome == RUN_OK)
            rows =
                json_append(rows, json_pack("{s:s, s:o}", "key", KEYS[scene], "values", json_numbers(N_LOADS, values)));
    }
    return json_pack("{s:o, s:o}", "columns", columns, "rows", rows);
}

/* Of the design: the largest force on every floor by side of the core, stress of the core and of buckling by storey;
 * null where they were not computed. */
static json_t *json_of_forces(const SimResult *r)
{
    const SimForces *f = &r->forces;
    const size_t n = (size_t)r->n_floors;
    if (r->outcome != RUN_OK || !r->forces_known)
        return json_null();
    return json_pack("{s:[o,o], s:o, s:o}", "contact_n", json_numbers(n, f->contact_force_n[0]),
                     json_numbers(n, f->contact_force_n[1]), "stress_pa",
                     f->stress_known ? json_numbers(n, f->core_storey_stress_pa) : json_null(), "buckling_pa",
                     f->buckling_known ? json_numbers(n, f->core_buckling_pa) : json_null());
}

/* What every floor reaches at least and at most under the records of the run; empty: there is one. A record under which
 * the design fails is left out. */
static json_t *json_of_band(const Detail *d)
{
    static const char *const KEYS[] = {"displacement_m", "drift_m", "acceleration_g"};
    json_t *band = json_object();
    for (int k = 0; k < 3 && d->by_record; k++) {
        double low[FLOORS_MAX], high[FLOORS_MAX];
        for (int j = 0; j < d->n_floors; j++) {
            low[j] = INFINITY, high[j] = 0;
            for (size_t i = 0; i < d->n_records; i++) {
                const SimResult *r = &d->by_record[i];
                const double *peak[] = {r->peak_displacement_m, r->peak_drift_m, r->peak_acceleration_g};
                const double v = r->outcome == RUN_OK ? peak[k][j] : NAN;
                low[j] = fmin(low[j], v);
                high[j] = fmax(high[j], v);
            }
        }
        const size_t n = (size_t)d->n_floors;
        json_object_set_new(band, KEYS[k], json_pack("[o, o]", json_numbers(n, low), json_numbers(n, high)));
    }
    return band;
}

json_t *detail_json(const Detail *d, const MeasureOrder *order)
{
    static const char *const KEYS[N_SCENES] = {"with_core", "no_core", "rigid", "tmd", "links"};
    const size_t n = (size_t)d->n_floors;
    json_t *others = json_array();
    for (size_t i = 0; i < d->n_elsewhere; i++) {
        const Elsewhere *e = &d->elsewhere[i];
        others =
            json_append(others, json_pack("{s:o, s:f, s:f, s:f, s:o, s:o}", "record", json_words(e->record), "pga_g",
                                          e->pga_g, "scale", e->scale, "stretch", e->stretch, KEYS[0],
                                          result_json(&e->with_core, order), KEYS[1], result_json(&e->no_core, order)));
    }
    json_t *o =
        json_pack("{s:i, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:f, s:f, s:f, s:f, s:o, s:o, s:o, s:o, s:o, s:o}", "floor",
                  d->floor + 1, "storey_m", json_numbers(n, d->storey_m), "gap_m", json_numbers(n, d->gap_m),
                  "thickness_m", json_numbers(n, d->thickness_m), "bumper_n_m", json_numbers(n, d->bumper_n_m),
                  "building_hz", json_numbers(n, d->building_hz), "core_hz", json_numbers(n, d->core_hz), "record",
                  json_words(d->record), "pga_g", d->pga_g, "scale", d->scale, "stretch", d->stretch, "duration_s",
                  d->duration_s, "loads", json_of_loads(d), "baselines", json_of_baselines(d->baseline, order),
                  "history_with_core", json_of_history(&d->history[0], &d->spectrum[0]), "history_no_core",
                  json_of_history(&d->history[1], &d->spectrum[1]), "forces", json_of_forces(&d->result[SCENE_IMPACT]),
                  "elsewhere", others);
    json_t *error = json_array();
    for (int k = 0; k < order->n_obj; k++)
        json_array_append_new(error, json_number(d->error[order->of[k]]));
    json_object_set_new(o, "error", error);
    json_object_set_new(o, "band", json_of_band(d));
    json_object_set_new(o, "records", json_integer((json_int_t)d->n_records));
    if (d->gap_sides != GAPS_BOTH)
        json_object_set_new(o, "gap_side_m",
                            json_pack("[o,o]", json_numbers(n, d->gap_side_m[0]), json_numbers(n, d->gap_side_m[1])));
    for (int k = 0; k < N_SCENES; k++)
        json_object_set_new(o, KEYS[k], result_json(&d->result[k], order));
    return o;
}

/* ---- the run --------------------------------------------------------------------------------------------------- */

/* Lower and upper bounds of the search; null where the problem is not the tower. */
static json_t *json_of_bounds(const Report *r)
{
    double lower[DESIGN_VARIABLES_MAX], upper[DESIGN_VARIABLES_MAX];
    const Schema *schema = &r->run->schema;
    if (!r->has_detail)
        return json_null();
    design_bounds(&schema->design, &r->run->settings->design, lower, upper);
    return json_pack("{s:o, s:o}", "lower", json_numbers(schema->n_var, lower), "upper",
                     json_numbers(schema->n_var, upper));
}

/* Of objective k, or of measure k - n_obj. */
static json_t *json_of_result_column(const Schema *schema, size_t k)
{
    const Column *c = schema_objective(schema, k);
    const Words w = words_of_objective(schema, k);
    return json_pack("{s:o, s:o, s:s, s:f, s:f, s:o}", "name", json_words(c->name), "title", json_words(w.title),
                     "unit", w.unit, "factor", w.factor, "sense", c->sense, "what",
                     json_words(schema->order.n_obj > 0 ? measure(schema->order.of[k])->what : w.title));
}

static json_t *json_of_names(const Report *r)
{
    const Schema *schema = &r->run->schema;
    json_t *variables = json_array(), *objectives = json_array(), *limited = json_array();
    for (size_t j = 0; j < schema->n_var; j++)
        variables = json_append(variables, json_words(schema_variable(schema, j)->name));
    for (size_t k = 0; k < schema->n_obj; k++)
        objectives = json_append(objectives, json_of_result_column(schema, k));
    for (size_t k = 0; k < schema->n_limited; k++)
        limited = json_append(limited, json_of_result_column(schema, schema->n_obj + schema->limited[k]));
    return json_pack("{s:o, s:o, s:o, s:o}", "variables", variables, "objectives", objectives, "limited", limited,
                     "bounds", json_of_bounds(r));
}

/* Ids of the designs shown that are beyond the contact law. */
static json_t *json_of_beyond_law(const Report *r)
{
    const Run *run = r->run;
    json_t *ids = json_array();
    for (size_t e = 0; r->has_detail && e < run->schema.n_extra; e++)
        for (size_t i = 0; i < r->n_shown; i++) {
            const Evaluation *row = &run->table.row[r->shown[i]];
            if (run->schema.order.of[run->schema.n_obj + e] == MEASURE_BEYOND_LAW && row->extra[e] > 0)
                ids = json_append(ids, json_integer(row->id));
        }
    return ids;
}

static json_t *json_of_importance(const Importance *m, const Schema *schema)
{
    json_t *total = json_array();
    if (m->n_centres == 0) {
        json_decref(total);
        return json_null();
    }
    for (size_t k = 0; k < schema->n_obj; k++)
        total = json_append(total, json_numbers(schema->n_var, m->total + k * schema->n_var));
    return json_pack("{s:I, s:o, s:o}", "centres", (json_int_t)m->n_centres, "explained",
                     json_numbers(schema->n_obj, m->explained), "total", total);
}

json_t *growth_json(const Run *run)
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

json_t *report_json(const Report *r)
{
    const Run *run = r->run;
    char name[PATH_MAX];
    snprintf(name, sizeof name, "%s", run->folder);
    for (size_t n = strlen(name); n > 1 && name[n - 1] == '/'; n--)
        name[n - 1] = 0;
    const char *slash = strrchr(name, '/');
    double likely[OBJECTIVES_MAX];
    char rule[RULE_WORDS_MAX];
    const int has_errors = run_likely(run, r->chosen, likely);
    words_of_rule(run->settings, rule);
    return json_pack(
        "{s:s, s:o, s:s, s:s, s:o, s:o, s:b, s:b, s:o, s:s, s:I, s:I, s:o, s:I, s:I, s:I, s:o, s:o, s:o, s:o, "
        "s:o, s:o, s:s}",
        "rule", rule, "chosen_error", has_errors ? json_numbers(run->schema.n_obj, likely) : json_null(), "version",
        program_version(), "revision", program_revision(), "name", json_words(slash && slash[1] ? slash + 1 : name),
        "folder", json_words(name), "tower", r->has_detail, "robust", r->is_robust, "building",
        json_words(run->settings->building.model), "spread",
        spread_word(run->settings->sim.gap_tolerance_m, &run->settings->sim.uncertain), "knee",
        (json_int_t)run->table.row[r->knee].id, "chosen", (json_int_t)run->table.row[r->chosen].id, "chosen_f",
        json_numbers(run->schema.n_obj, run_f(run, r->chosen)), "evaluated", (json_int_t)n_evaluated(run), "failed",
        (json_int_t)run->n_failed, "front", (json_int_t)run->n_front, "schema", json_of_names(r), "beyond_law",
        json_of_beyond_law(r), "importance", json_of_importance(&r->importance, &run->schema), "convergence",
        growth_json(run), "detail", r->detail.n_floors > 0 ? detail_json(&r->detail, &run->schema.order) : json_null(),
        "settings", json_of_settings(run->settings), "provenance", run->provenance);
}
