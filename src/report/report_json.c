#include "report/report_json.h"

#include "base/json.h"
#include "base/hypervolume.h"
#include "report/verdict.h"
#include "report/words.h"
#include "store/notes.h"
#include "settings/settings.h"
#include "store/provenance.h"

/* ---- the chosen design ----------------------------------------------------------------------------------------- */

/* One value, a list, or [u > v, u < v] of lists each. */
json_t *put_parts(json_t *o, SceneKind kind, const SimResult *r)
{
    for (const ResultPart *part = RESULT_PARTS; part->name; part++) {
        double values[SIDES * FLOORS_MAX];
        size_t rows;
        const size_t n = result_part(r, SCENES[kind].has, part, values, &rows);
        if (n > 0)
            json_object_set_new(o, part->name,
                                part->shape == PART_NUMBER  ? json_number(*values)
                                : part->shape == PART_FLAG  ? json_boolean(*values != 0)
                                : part->shape < PART_FLOORS ? json_integer((json_int_t)*values)
                                : rows == SIDES             ? json_pair(n, values, values + n)
                                                            : json_numbers(n, values));
    }
    return o;
}

json_t *result_json(SceneKind kind, const SimResult *r, const MeasureOrder *order)
{
    if (r->outcome != RUN_OK)
        return json_of("reason=%s", r->reason);
    double values[FLOORS_MAX + N_MEASURES];
    for (int k = 0; k < order->n_obj; k++)
        values[k] = measure_value(r, order->of[k]);
    json_t *o =
        json_of("objectives=%p beyond_law=%c", json_numbers((size_t)order->n_obj, values), beyond_contact_law(r));
    for (int j = 0; j < r->n_floors; j++)
        values[j] = (double)r->closings[j];
    json_put(o, "closings=%p", json_numbers((size_t)r->n_floors, values));
    for (int k = 0; k < MEASURES_LISTED; k++)
        json_object_set_new(o, measure(k)->name, json_number(measure_value(r, k)));
    put_parts(o, kind, r);
    json_object_del(o, "seconds"); /* of the clock: the same run has the same page */
    return o;
}

/* Column k of every so many rows. */
static json_t *json_of_column(const Track *t, size_t k)
{
    const size_t step = t->n / HISTORY_POINTS + 1;
    return json_numbers_every(step * t->width, t->n * t->width - k, t->rows + k);
}

static json_t *json_of_history(const Track *t, int floor)
{
    if (t->n < 2)
        return json_null();
    json_t *energies = json_object();
    for (size_t k = 0; k < N_ENERGIES; k++)
        json_object_set_new(energies, ENERGY_KEYS[k], json_of_column(t, t->width - N_ENERGIES + k));
    return json_of("t=%p u=%p energies=%p", json_of_column(t, 0), json_of_column(t, HISTORY_U + floor), energies);
}

/* Values of all records by the rule of the run, and whether the design is better (verdict_compare); null: of what the
 * case does not have: a core, whose mass is then 0, or what would dissipate a share. */
static json_t *json_of_baselines(const Detail *d, const MeasureOrder *order)
{
    json_t *list = json_array();
    double likely[OBJECTIVES_MAX];
    const int is_known = d->run && run_likely(d->run, d->row, likely);
    for (int k = SCENE_IMPACT + 1; k < N_SCENES; k++) {
        double values[N_MEASURES];
        char device[DEVICE_TEXT_MAX];
        json_t *better = json_array();
        for (int i = 0; i < order->n_obj; i++) {
            const int id = order->of[i], sense = (int)measure(id)->sense;
            values[i] = d->baseline[k].value[id];
            json_array_append_new(better,
                                  !d->run || (values[i] == 0 && (sense < 0 || id == MEASURE_MCORE))
                                      ? json_null()
                                      : json_integer(verdict_compare(sense, run_f(d->run, d->row)[i],
                                                                     is_known ? likely[i] : d->error[id], values[i])));
        }
        case_device_text(k, &d->baseline[k].device, device);
        const int ok = d->baseline[k].outcome == OUTCOME_OK;
        json_array_append_new(list, json_of("key=%s device=%s better=%p objectives=%p", SCENES[k].key, device, better,
                                            ok ? json_numbers(order->n_obj, values) : json_null()));
    }
    return list;
}

json_t *detail_json(const Detail *d, const MeasureOrder *order)
{
    static const char *const KEYS[] = {"peak_displacement_m", "peak_drift_m", "peak_acceleration_g"};
    const size_t n = d->n_floors;
    json_t *others = json_array(), *band = json_object();

    /* What every floor reaches at least and at most under the records of the run; empty: there is one. A record under
     * which the design fails is left out. */
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
        json_object_set_new(band, KEYS[k], json_pair(n, low, high));
    }
    for (size_t i = 0; i < d->n_elsewhere; i++) {
        const Elsewhere *e = &d->elsewhere[i];
        json_array_append_new(others,
                              json_of("record=%s pga_g=%g scale=%g stretch=%g with_core=%p no_core=%p", e->record,
                                      e->pga_g, e->scale, e->stretch, result_json(SCENE_IMPACT, &e->with_core, order),
                                      result_json(SCENE_NO_CORE, &e->no_core, order)));
    }
    json_t *o =
        json_of("floor=%d protection=%s storey_m=%p gap_m=%p thickness_m=%p bumper_n_m=%p building_hz=%p record=%s "
                "pga_g=%g scale=%g stretch=%g baselines=%p history_with_core=%p "
                "history_no_core=%p elsewhere=%p",
                d->floor + 1, d->protection, json_numbers(n, d->storey_m), json_numbers(n, d->gap_m),
                json_numbers(n, d->thickness_m), json_numbers(n, d->bumper_n_m), json_numbers(n, d->building_hz),
                d->record, d->pga_g, d->scale, d->stretch, json_of_baselines(d, order),
                json_of_history(&d->history[0], d->floor), json_of_history(&d->history[1], d->floor), others);
    json_t *error = json_array(), *standard = json_array();
    for (int k = 0; k < order->n_obj; k++) {
        json_array_append_new(error, json_number(d->error[order->of[k]]));
        json_array_append_new(standard, json_number(d->standard_error[order->of[k]]));
    }
    json_put(o, "error=%p standard_error=%p band=%p records=%ld", error, standard, band, d->n_records);
    if (d->ladder || d->no_ladder.text[0])
        json_put(o, "ladder=%p", d->ladder ? ladder_json(d->ladder) : json_of("reason=%s", d->no_ladder.text));
    json_put(o, "verdict=%s", d->verdict);
    if (d->gap_sides != GAPS_BOTH)
        json_put(o, "gap_side_m=%p", json_pair(n, d->gap_side_m[0], d->gap_side_m[1]));
    for (int k = 0; k < N_SCENES; k++)
        json_object_set_new(o, SCENES[k].key, result_json((SceneKind)k, &d->result[k], order));
    return o;
}

/* ---- the run --------------------------------------------------------------------------------------------------- */

/* Of objective k, or of measure k - n_obj. */
static json_t *json_of_result_column(const Schema *schema, size_t k)
{
    const Column *c = schema_objective(schema, k);
    const Words w = words_of_objective(schema, k);
    return json_of("name=%s title=%s unit=%s factor=%g sense=%g what=%s", c->name, w.title, w.unit, w.factor, c->sense,
                   schema->order.n_obj > 0 ? measure(schema->order.of[k])->what : w.title);
}

/* words: of a choice, in their order; null for other variables. bounds of the search: null where the problem is not the
 * tower. */
static json_t *json_of_names(const Report *r)
{
    const Schema *schema = &r->run->schema;
    double lower[DESIGN_VARIABLES_MAX], upper[DESIGN_VARIABLES_MAX];
    json_t *variables = json_array(), *words = json_array(), *objectives = json_array(), *limited = json_array();
    for (size_t j = 0; j < schema->n_var; j++) {
        char word[KIND_WORD_MAX];
        json_t *of_choice = schema_word(schema, j, 0, word) ? json_array() : json_null();
        for (int i = 0; json_is_array(of_choice) && schema_word(schema, j, i, word); i++)
            json_array_append_new(of_choice, json_words(word));
        json_array_append_new(variables, json_words(schema_variable(schema, j)->name));
        json_array_append_new(words, of_choice);
    }
    if (r->has_detail)
        design_bounds(&schema->design, &r->run->settings->design, lower, upper);
    for (size_t k = 0; k < schema->n_obj; k++)
        json_array_append_new(objectives, json_of_result_column(schema, k));
    for (size_t k = 0; k < schema->n_limited; k++)
        json_array_append_new(limited, json_of_result_column(schema, schema->n_obj + schema->limited[k]));
    return json_of("variables=%p words=%p objectives=%p limited=%p bounds=%p", variables, words, objectives, limited,
                   r->has_detail ? json_of("lower=%p upper=%p", json_numbers(schema->n_var, lower),
                                           json_numbers(schema->n_var, upper))
                                 : json_null());
}

json_t *importance_json(const Importance *m, const Schema *schema)
{
    if (m->n_centres == 0)
        return json_null();
    json_t *total = json_array();
    for (size_t k = 0; k < schema->n_obj; k++)
        json_array_append_new(total, json_numbers(schema->n_var, m->total + k * schema->n_var));
    return json_of("centres=%ld explained=%p total=%p", m->n_centres, json_numbers(schema->n_obj, m->explained), total);
}

json_t *growth_json(const Run *run)
{
    json_t *simulated = json_array(), *volume = json_array(), *error = json_array();
    for (size_t i = 0; i < run->n_generations; i++) {
        const double v = run->generation[i].hypervolume;
        if (!isfinite(v))
            continue;
        json_array_append_new(simulated, json_number((double)run->generation[i].simulated));
        json_array_append_new(volume, json_number(v));
        json_array_append_new(error, json_number(hypervolume_error(v)));
    }
    return json_of("simulated=%p volume=%p error=%p", simulated, volume, error);
}

/* The chosen design as found and to be built. */
static json_t *json_of_pair(const Run *run, size_t chosen)
{
    size_t pair[2];
    if (!run_simplified(run, chosen, pair))
        return json_null();
    json_t *list = json_array();
    for (int i = 0; i < 2; i++)
        json_array_append_new(list, json_of("id=%ld x=%p f=%p", run->table.row[pair[i]].id,
                                            json_numbers(run->schema.n_var, run_x(run, pair[i])),
                                            json_numbers(run->schema.n_obj, run_f(run, pair[i]))));
    return list;
}

json_t *kept_json(const Report *r)
{
    const Run *run = r->run;
    json_t *list = json_array();
    for (size_t i = run_first_polished(run); r->has_detail && i < run->table.n; i++) {
        char name[48];
        snprintf(name, sizeof name, "design %ld", run->table.row[i].id);
        if (run->table.row[i].kind == KIND_KEPT)
            json_array_append_new(list, json_of("name=%s id=%ld x=%p raw=%p ground=%p", name, run->table.row[i].id,
                                                json_numbers(run->schema.n_var, run_x(run, i)),
                                                json_numbers(run->schema.n_obj, run_f(run, i)),
                                                json_of("whole=%c", r->is_robust)));
    }
    return list;
}

json_t *report_json(const Report *r)
{
    const Run *run = r->run;
    char name[PATH_MAX];
    text_copy(name, run->folder);
    for (size_t n = strlen(name); n > 1 && name[n - 1] == '/'; n--)
        name[n - 1] = 0;
    const char *slash = strrchr(name, '/');
    double likely[OBJECTIVES_MAX];
    char rule[RULE_WORDS_MAX], *settings = settings_text(run->settings);
    Err fault = {0};
    const int has_errors = run_likely(run, r->chosen, likely);
    json_t *notes, *words = settings ? json_words(settings) : NULL;
    free(settings);
    notes_of_run(run, &notes, &fault);
    words_of_rule(run->settings, rule);

    /* Designs that were simulated; ids of those shown that are beyond the contact law; what has to be borne. */
    json_t *beyond_law = json_array(), *columns = json_array();
    int borne[MEASURES_LISTED];
    size_t n_evaluated = 0;
    for (size_t i = 0; i < run->table.n; i++)
        n_evaluated += run->table.row[i].kind != KIND_UNFINISHED;
    for (size_t i = 0; r->has_detail && i < r->n_shown; i++) {
        const Evaluation *row = &run->table.row[r->shown[i]];
        if (schema_value(&run->schema, MEASURE_BEYOND_LAW, row->f, row->extra) > 0)
            json_array_append_new(beyond_law, json_integer(row->id));
    }
    for (int i = 0, n = measures_borne(borne); i < n; i++) {
        const Measure *m = measure(borne[i]);
        json_array_append_new(columns, json_of("name=%s title=%s unit=%s factor=%g", m->name, m->words.title,
                                               m->words.unit, m->words.factor));
    }
    return json_of(
        "rule=%s chosen_error=%p version=%s revision=%s name=%s folder=%s id_step=%ld tower=%c robust=%c building=%s "
        "spread=%s "
        "knee=%ld chosen=%ld chosen_f=%p evaluated=%ld failed=%ld front=%ld schema=%p beyond_law=%p importance=%p "
        "convergence=%p detail=%p pair=%p borne=%p notes=%p notes_fault=%s settings=%p provenance=%s",
        rule, has_errors ? json_numbers(run->schema.n_obj, likely) : json_null(), program_version(), program_revision(),
        slash && slash[1] && !run->id_step ? slash + 1 : name, name, run->id_step, r->has_detail, r->is_robust,
        run->settings->building.model, spread_word(run->settings->sim.gap_tolerance_m, &run->settings->sim.uncertain),
        run->table.row[r->knee].id, run->table.row[r->chosen].id,
        json_numbers(run->schema.n_obj, run_f(run, r->chosen)), n_evaluated, run->n_failed, run->n_front,
        json_of_names(r), beyond_law, importance_json(&r->importance, &run->schema), growth_json(run),
        r->detail.n_floors > 0 ? detail_json(&r->detail, &run->schema.order) : json_null(),
        json_of_pair(run, r->chosen), columns, notes, fault.text, words, run->provenance);
}
