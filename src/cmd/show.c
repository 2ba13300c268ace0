#include "cmd/show.h"

#include "analysis/estimate.h"
#include "base/text.h"
#include "motion/suite.h"
#include "report/report_json.h"
#include "report/verdict.h"
#include "report/words.h"
#include "store/output.h"
#include "study/record_paths.h"

/* ---- results ----------------------------------------------------------------------------------------------------- */

json_t *json_result(const MeasureOrder *order, SceneKind kind, const SimResult *r)
{
    json_t *o =
        json_of("scene=%s outcome=%s reason=%s", SCENES[kind].key, outcome_word((Outcome)r->outcome), r->reason);
    json_t *damage = json_object();
    put_measures(o, order, "", measured(r).value, NULL, NULL);
    json_put(o, "beyond_contact_law=%c peak_filtered_g=%p", beyond_contact_law(r),
             r->filtered_known ? json_numbers(r->n_floors, r->peak_filtered_g) : json_null());
    put_parts(o, kind, r);
    for (DamagedPart p = 0; p < N_PARTS && r->outcome == RUN_OK; p++) {
        const double *by = p == PART_ACCELERATION ? r->peak_acceleration_g : r->drift_ratio;
        json_t *list = json_array();
        for (int j = 0; j < r->n_floors; j++)
            json_array_append_new(list, json_string(damage_word(damage_state(p, by[j]))));
        json_object_set_new(damage, DAMAGE_PARTS[p].key, list);
    }
    if (r->outcome == RUN_OK)
        json_object_set(o, "damage", damage);
    json_decref(damage);
    return o;
}

json_t *put_device(json_t *o, SceneKind kind, const LinearDevice *device)
{
    const char *name;
    double value;
    for (int i = 0; (name = case_device_number(kind, device, i, &value)); i++)
        json_object_set_new(o, name, json_number(value));
    return o;
}

void put_measures(json_t *o, const MeasureOrder *order, const char *end, const double values[], const char *other,
                  const double others[])
{
    char name[64];
    for (int k = 0; k < (order ? N_MEASURES : MEASURES_LISTED) && *measures_name(order, k); k++) {
        snprintf(name, sizeof name, "%s%s", measures_name(order, k), end);
        json_object_set_new(o, name, json_number(values ? values[k] : NAN));
        snprintf(name, sizeof name, "%s%s", measures_name(order, k), other ? other : "");
        if (other)
            json_object_set_new(o, name, json_number(others ? others[k] : NAN));
    }
}

/* The values that are known, by the names of their measures. */
static json_t *json_known(const double value[], double times)
{
    json_t *o = json_object();
    for (int k = 0; k < MEASURES_LISTED; k++)
        if (isfinite(value[k]))
            json_object_set_new(o, measure(k)->name, json_real(times * value[k]));
    return o;
}

void put_errors(json_t *o, const double likely[], const double sd[])
{
    json_t *bound = json_known(likely, ESTIMATE_FACTOR);
    json_object_set(o, "estimated_error", bound);
    json_put(o, "error=%p",
             json_of("likely=%p bound=%p sd_gaps_1_um=%p", json_known(likely, 1), bound, json_known(sd, 1)));
}

static json_t *json_measures(const MeasureOrder *order, const double values[])
{
    json_t *o = json_object();
    put_measures(o, order, "", values, NULL, NULL);
    return o;
}

json_t *json_replicates(const MeasureOrder *order, const ReplicateSummary *r)
{
    const int known = !r->n_failed;
    return json_of("n=%ld records=%ld failed=%ld spread=%s rule=%s mean=%p sd=%p standard_error=%p", r->n_replicates,
                   r->n_records, r->n_failed, r->spread, r->rule, json_measures(order, known ? r->mean : NULL),
                   json_measures(order, known ? r->sd : NULL), json_measures(order, known ? r->error : NULL));
}

void put_replicates(json_t *row, const MeasureOrder *order, const ReplicateSummary *r)
{
    static const char *const KEYS[] = {"records", "replicates", "rule", "spread"};
    const int known = r && !r->n_failed;
    for (size_t i = 0; i < N_OF(KEYS) && !r; i++)
        json_object_set_new(row, KEYS[i], json_null());
    if (r)
        json_put(row, "records=%zu replicates=%zu rule=%s spread=%s", r->n_records, r->n_replicates, r->rule,
                 r->spread);
    put_measures(row, order, "_mean", known ? r->mean : NULL, "_sd", known ? r->sd : NULL);
}

void document_ida(Document *d, const Evaluations *e, const MeasureOrder *order)
{
    for (SceneKind c = 0; c < N_SCENES; c++) {
        if (case_has_device(c))
            continue;
        document_say(d, e->n_read == 1 ? "%s, %zu record" : "%s, %zu records: median (16 %% to 84 %%)", SCENES[c].words,
                     e->n_read);
        json_t *table = document_table(d);
        for (size_t l = 0; l < e->n_levels; l++) {
            json_t *row = figures_row(table);
            json_object_set_new(row, e->intensity, json_number(e->level[l]));
            for (int i = 0; i < MIN_OF(order->n_obj, IDA_SHOWN); i++) {
                double at[IDA_FRACTILES];
                for (int f = 0; f < IDA_FRACTILES; f++)
                    at[f] = e->n_read > 1 || f == 1 ? ida_fractile(e, l, c, order->of[i], IDA_FRACTILE[f]) : NAN;
                figures_put_as(row, measures_name(order, order->of[i]), at[1], at[0], at[2], e->n_read > 1 ? "(" : "");
            }
        }
    }
}

void document_slopes(Document *d, size_t n, const Sensitivity list[])
{
    static const MeasureId SHOWN[] = {MEASURE_J1, MEASURE_DRIFT_RATIO, MEASURE_J2, MEASURE_CORE_STRESS};
    document_say(d, "change for one step, with its error from the replicates and from halving the step");
    json_t *table = document_table(d);
    for (size_t i = 0; i < n; i++) {
        const Sensitivity *s = &list[i];
        if (s->slope[MEASURE_J1] == 0 && s->slope[MEASURE_J2] == 0)
            continue;
        json_t *row = json_put(figures_row(table), "parameter=%s value=%g step=%g", s->name, s->value, s->step);
        for (size_t k = 0; k < N_OF(SHOWN); k++)
            if (isfinite(s->slope[SHOWN[k]]))
                figures_put(row, measure(SHOWN[k])->name, s->slope[SHOWN[k]] * s->step, s->error[SHOWN[k]] * s->step,
                            NAN);
    }
}

void document_motion(Document *d, const Motion *m, double duration_s)
{
    char peak[MOTION_PEAK_TEXT_MAX], first[40] = "";
    motion_peak_text(m, peak);
    if (duration_s > 0 && duration_s < motion_duration(m))
        snprintf(first, sizeof first, "the first %.4g of ", duration_s);
    document_say(d, "%s: %s%.4g s, %s", m->name, first, motion_duration(m), peak);
    if (m->processed[0])
        document_say(d, "  %s", m->processed);
    if (m->warning[0])
        document_say(d, "  warning: %s", m->warning);
}

/* What there is of errors and deviations; NULL: nothing. error: likely ones, behind the sign stands their bound,
 * which 95 % keep, as the errors of named designs do. word: what the deviation is, in the place of "sd". */
static void put_objectives(json_t *row, const MeasureOrder *order, const double value[], const double error[],
                           const double sd[], const char *word)
{
    for (int i = 0; i < order->n_obj; i++) {
        const int k = order->of[i];
        figures_put_as(row, measures_name(order, k), value[k], error ? ESTIMATE_FACTOR * error[k] : NAN,
                       sd ? sd[k] : NAN, word);
    }
}

json_t *figures_result(json_t *table, const char *label, const MeasureOrder *order, const SimResult *r,
                       const double error[], const double sd[])
{
    char note[NOTE_MAX] = "";
    json_t *row = json_put(figures_row(table), "=%s", label);
    put_objectives(row, order, measured(r).value, error, sd, "sd 1 um");
    json_put(row, "impacts=%ld", r->impacts);
    figures_number(row, "indentation", r->indentation_ratio);
    if (r->outcome != RUN_OK)
        snprintf(note, sizeof note, "%s: %s", outcome_word((Outcome)r->outcome), r->reason);
    else if (beyond_contact_law(r))
        snprintf(note, sizeof note, "deeper than %g of the contact's radius: beyond the contact law",
                 INDENTATION_RATIO_MAX);
    else if (r->bumper_bottoms_out)
        snprintf(note, sizeof note, "a bumper is compressed by %.3g of its thickness: it bottoms out",
                 r->bumper_strain);
    else if (foundation_lifts(r))
        uplift_words(r, note);
    else if (r->filtered_known && r->j3_filtered_g > r->j3_g)
        snprintf(note, sizeof note, "j3_filtered_g above j3_g: the filter overshoots (docs/theory.md)");
    if (note[0])
        json_put(row, " =%s", note);
    return row;
}

void figures_replicates(json_t *table, const MeasureOrder *order, const ReplicateSummary *r, const double error[])
{
    char label[96];
    const int by_replicates = r->n_replicates > 1 && isfinite(r->sd[order->of[0]]);
    const double *sd = by_replicates ? r->sd : r->n_records > 1 ? r->error : NULL;
    json_t *row = figures_row(table);
    if (r->n_failed)
        snprintf(label, sizeof label, "  %zu of its simulations failed: no mean", r->n_failed);
    else if (r->n_records > 1)
        snprintf(label, sizeof label, "  %s, %zu records x %zu", r->rule, r->n_records, r->n_replicates);
    else
        snprintf(label, sizeof label, "  %s of %zu", r->rule, r->n_replicates);
    if (sd && !r->n_failed)
        snprintf(label + strlen(label), sizeof label - strlen(label), by_replicates ? ", sd %s" : ", standard error",
                 r->spread);
    json_put(row, "=%s", label);
    if (r->n_failed)
        return;
    put_objectives(row, order, r->mean, error, sd, by_replicates ? "sd" : "se");
    figures_put(row, "impacts", r->mean[MEASURE_IMPACTS], NAN, by_replicates ? sd[MEASURE_IMPACTS] : NAN);
}

json_t *figures_design(json_t *table, const char *label, long id, const Schema *schema, const double natural[],
                       const double error[], const double sd[], const double extra[])
{
    json_t *row = json_put(figures_row(table), "=%s design=%p", label, id > 0 ? json_integer(id) : json_string("-"));
    for (size_t k = 0; k < schema->n_obj; k++)
        figures_put(row, schema_objective(schema, k)->name, natural[k], error ? error[k] : NAN, sd ? sd[k] : NAN);
    for (size_t k = 0; k < schema->n_limited; k++)
        figures_number(row, schema_extra(schema, schema->limited[k])->name, extra ? extra[schema->limited[k]] : NAN);
    return row;
}

void figures_baselines(json_t *table, const Schema *schema, const Baseline baseline[N_SCENES])
{
    for (int k = SCENE_IMPACT + 1; k < N_SCENES; k++) {
        const double *value = baseline[k].value;
        double natural[OBJECTIVES_MAX], extra[N_MEASURES];
        for (size_t i = 0; i < schema->n_obj + schema->n_extra && i < N_MEASURES; i++)
            *(i < schema->n_obj ? &natural[i] : &extra[i - schema->n_obj]) = value[schema->order.of[i]];
        figures_design(table, SCENES[k].words, 0, schema, natural, NULL, NULL, extra);
    }
}

json_t *json_review(const FrontReview *r)
{
    json_t *smallest = json_array(), *largest = json_array(), *never = json_array();
    for (size_t j = 0; j < r->n_gaps; j++) {
        json_array_append_new(smallest, json_integer(r->at_smallest[j]));
        json_array_append_new(largest, json_integer(r->at_largest[j]));
    }
    for (size_t j = 0; j < r->n_floors; j++)
        if (r->closes[j] == 0 && r->has_stop[j])
            json_array_append_new(never, json_integer(j + 1));
    json_t *o =
        json_of("beyond_contact_law=%ld gaps_on_smallest=%p gaps_on_largest=%p", r->n_beyond, smallest, largest);
    if (r->n_simulated > 0)
        return json_put(o, "designs_simulated=%zu never_closing=%p", r->n_simulated, never);
    json_decref(never);
    return o;
}

char *stored_verdict(const Run *run, size_t row, const Settings *used, Err *why)
{
    Settings s = *(used ? used : run->settings);
    char *text = NULL;
    Status status = used ? STATUS_OK : record_paths_find(&s, run->provenance, &(RecordPaths){0}, why);
    run_steps(run, row, &s.sim);
    THEN(status, verdict_of_run(run, row, &s, NULL, &text, why));
    return text;
}

void document_verdict(Document *d, const Run *run, size_t row, const Settings *used)
{
    Err why = {0};
    if (run->settings->problem.kind != PROBLEM_TOWER)
        return;
    char *text = stored_verdict(run, row, used, &why);
    document_add(d, "h2", "Verdict on design %ld", run->table.row[row].id);
    document_say(d, "%s", text ? text : why.text);
    free(text);
}

/* ---- warnings ---------------------------------------------------------------------------------------------------- */

void warn_on_stderr(const char *key, const char *text, void *)
{
    fprintf(stderr, "warning: %s: %s\n", key, text);
}

static Status count_source(const char *source, void *counts, Err *)
{
    json_object_set_new(counts, source, json_integer(json_integer_value(json_object_get(counts, source)) + 1));
    return STATUS_OK;
}

/* Every record counts as often as it is listed. */
void warn_of_settings(const Settings *s, WarnFn warn, void *user)
{
    json_t *counts = json_object(), *n;
    const char *source, *twice = NULL;
    char text[OPTION_TEXT_MAX + 80];
    if (s->problem.kind == PROBLEM_TOWER)
        suite_of_study(&s->motion, count_source, counts, NULL);
    json_object_foreach(counts, source, n) twice = json_integer_value(n) > 1 && !twice ? source : twice;
    if (twice) {
        snprintf(text, sizeof text, "%s appears twice (motion.record is one of them) and counts twice", twice);
        warn("motion.records", text, user);
    }
    json_decref(counts);
}

void warn_of_designs(const Designs *d, const char *word, WarnFn warn, void *user)
{
    const DesignSpace *s = &d->space;
    char name[TABLE_NAME_MAX], text[900], line[16] = "";
    for (size_t i = 0; i < d->n; i++)
        for (int j = 0; j < s->n_gaps; j++) {
            const double gap = d->x[i * s->n_var + j];
            if (!(gap > GAP_MAX_M) || gap == DESIGN_OPEN_M)
                continue;
            if (d->line && !d->id)
                snprintf(line, sizeof line, ":%d", d->line[i]);
            design_variable_name(s, j, name);
            snprintf(text, sizeof text, "%.600s%s: %s is %g m and does not close; gaps are in metres", word, line, name,
                     gap);
            warn("--design", text, user);
            return;
        }
}
