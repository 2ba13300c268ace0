#include "cmd/dossier.h"

#include <stdarg.h>

#include "analysis/evaluations.h"
#include "analysis/fragility.h"
#include "analysis/full_model.h"
#include "analysis/sensitivity.h"
#include "base/text.h"
#include "cmd/show.h"
#include "evaluate/limits.h"
#include "report/panels.h"
#include "report/pictures.h"
#include "report/report_json.h"
#include "report/words.h"
#include "scene/building.h"
#include "settings/settings.h"
#include "store/folder.h"
#include "store/output.h"
#include "store/provenance.h"

enum { AS_BUILT = 16, LEVELS = 6 };
static const double LEVEL_STEP_G = 0.1, GAP_BUILT_M = 0.005, DRIFT_LIMIT = 0.02, YIELD_PA = 235e6;

static const MeasureId RESPONSE[] = {MEASURE_J1,  MEASURE_J2,     MEASURE_DRIFT_RATIO, MEASURE_J3,
                                     MEASURE_ED1, MEASURE_ED5_10, MEASURE_EDCS};
typedef struct {
    const Report *r;
    const Detail *d;
    const Settings *s;
    const double *x;
    FILE *out;
    json_t *drawings; /* by name, what the report's page does not have */
    size_t n_records;
    const SimResult *by_record; /* (n_records) the design under every record of the study */
    char record[200];           /* of the figures in detail: "builtin:kobe-like, the first of 22 records" */
} Dossier;

/* ---- figures --------------------------------------------------------------------------------------------------- */

static void put_text(json_t *row, const char *column, const char *text)
{
    json_object_set_new(row, column, json_words(text));
}

/* A line of what something is, in words. */
static void add_line(json_t *table, const char *what, const char *text)
{
    put_text(json_put(figures_row(table), "=%s", what), " ", text);
}

enum { HEAD_MAX = 80 };

static Words head_of(Words w, char head[HEAD_MAX])
{
    snprintf(head, HEAD_MAX, *w.unit ? "%s [%s]" : "%s", w.title, w.unit);
    return w;
}

static void put_named(json_t *row, Words words, double value, double error, double sd)
{
    char head[HEAD_MAX];
    const Words w = head_of(words, head);
    figures_put(row, head, w.factor * value, w.factor * error, w.factor * sd);
}

/* error (N_MEASURES); NULL: not known. */
static void add_response(json_t *table, const char *label, const SimResult *r, const double error[])
{
    json_t *row = json_put(figures_row(table), "=%s", label);
    for (size_t i = 0; i < N_OF(RESPONSE); i++)
        put_named(row, measure(RESPONSE[i])->words, r->outcome == RUN_OK ? measure_value(r, RESPONSE[i]) : NAN,
                  error ? error[RESPONSE[i]] : NAN, NAN);
    json_put(row, "impacts=%ld", r->impacts);
    if (r->outcome != RUN_OK)
        put_text(row, " ", r->reason);
}

/* The tags of the page itself, "p" or "/p". */
static void tag(const Dossier *o, const char *element)
{
    fprintf(o->out, "<%s>\n", element);
}

/* An element (empty: none) with its words: the one place where words come into the page. Tables have their own. */
__attribute__((format(printf, 3, 4))) static void put(const Dossier *o, const char *element, const char *format, ...)
{
    va_list list;
    char *words = NULL;
    va_start(list, format);
    if (vasprintf(&words, format, list) < 0)
        words = NULL;
    va_end(list);
    if (*element)
        fprintf(o->out, "<%s>", element);
    text_html(o->out, words ? words : "");
    if (*element)
        fprintf(o->out, "</%.*s>", (int)strcspn(element, " "), element);
    free(words);
}

static void heading(const Dossier *o, const char *title)
{
    put(o, "h2", "%s", title);
}

/* Where the page draws what it calls by that name (web/app/8-paper.js). */
static void draw(const Dossier *o, const char *name, const char *caption)
{
    tag(o, "figure");
    fprintf(o->out, "<div data-draw=\"%s\"></div>", name);
    put(o, "figcaption", "%s", caption);
    tag(o, "/figure");
}

/* A table that may have no rows: nothing then. */
static void show_any(const Dossier *o, json_t *table)
{
    if (json_array_size(table) > 0)
        figures_html(o->out, json_incref(table));
    json_decref(table);
}

static void say(const Dossier *o, const char *text)
{
    put(o, "p", "%s", text);
}

/* What is of one record, which it names. */
static void say_under(const Dossier *o, const char *text)
{
    put(o, "p", "%s under %s.", text, o->record);
}

/* Of a record; N_MEASURES: the shear stress of the core, which is no measure. NAN: the simulation failed. */
static double demand_of(const SimResult *r, int k)
{
    return r->outcome != RUN_OK ? NAN : k < N_MEASURES ? measure_value(r, k) : r->forces.core_shear_stress_pa;
}

/* Over the records of the study; NAN: none has it. */
static double largest(const Dossier *o, int k)
{
    double most = NAN;
    for (size_t i = 0; i < o->n_records; i++)
        most = fmax(most, demand_of(&o->by_record[i], k));
    return most;
}

/* ", which the core exceeds (under 7 of 22 records)", where it does. */
static void print_exceeded(const Dossier *o, int k, double bound, const char *what)
{
    size_t n = 0;
    for (size_t i = 0; i < o->n_records; i++)
        n += demand_of(&o->by_record[i], k) > bound;
    if (n > 0)
        put(o, "", ", which %s exceeds", what);
    if (n > 0 && o->n_records > 1)
        put(o, "", " under %zu of %zu records", n, o->n_records);
}

static void put_lines(json_t *table, const char *what, const char *format, double value)
{
    char text[64];
    snprintf(text, sizeof text, format, value);
    add_line(table, what, text);
}

/* ---- what it is ------------------------------------------------------------------------------------------------ */

static void add_standard_errors(const Dossier *o, json_t *table)
{
    const Schema *schema = &o->r->run->schema;
    char label[64];
    snprintf(label, sizeof label, "its standard error over %zu records", o->n_records);
    json_t *row = json_put(figures_row(table), "=%s", label);
    for (size_t k = 0; k < schema->n_obj; k++)
        put_named(row, words_of_objective(schema, k), o->d->standard_error[schema->order.of[k]], NAN, NAN);
}

/* A study of several simulations judges by none of them. */
static void add_judged(const Dossier *o, json_t *table)
{
    const Schema *schema = &o->r->run->schema;
    double error[OBJECTIVES_MAX];
    run_likely(o->r->run, o->r->chosen, error);
    for (int i = 0; i < N_SCENES; i++) {
        json_t *row = json_put(figures_row(table), "=%s", i == SCENE_IMPACT ? "this design" : SCENES[i].words);
        for (size_t k = 0; k < schema->n_obj; k++)
            put_named(row, words_of_objective(schema, k),
                      i == SCENE_IMPACT ? run_f(o->r->run, o->r->chosen)[k]
                                        : o->d->baseline[i].value[schema->order.of[k]],
                      i < 0 ? error[k] : NAN, NAN);
        if (i < 0 && o->n_records > 1)
            add_standard_errors(o, table);
    }
}

static void add_single(const Dossier *o, json_t *table)
{
    add_response(table, "this design", &o->d->result[SCENE_IMPACT], o->d->error);
    for (int k = SCENE_IMPACT + 1; k < N_SCENES; k++)
        add_response(table, SCENES[k].words, &o->d->baseline[k].first, NULL);
}

static void write_summary(const Dossier *o)
{
    const Detail *d = o->d;
    json_t *table = json_array();
    char now[24], rule[RULE_WORDS_MAX], *verdicts;
    size_t length;
    FILE *verdict = text_open(&verdicts, &length);
    utc_now(now);
    words_of_rule(o->s, rule);
    put(o, "h1", "Design %ld of %s", o->r->run->table.row[o->r->chosen].id, o->r->run->folder);
    put(o, "p class=\"note\"", "imtet %s (%s), %s. Found in %zu simulated designs%s%s, %zu of them nondominated.",
        program_version(), program_revision(), now, o->r->run->table.n, *rule ? ", objectives " : "", rule,
        o->r->run->n_front);
    (o->r->is_robust ? add_judged : add_single)(o, table);
    figures_html(o->out, table);
    if (o->r->is_robust)
        put(o, "p", "By what the study judges: %s%s.", rule,
            o->r->run->table.row[o->r->chosen].kind == KIND_SCREENED
                ? ", of which this design, screened only, has had a part"
                : "");
    else
        say_under(o, "All");
    say(o, "Behind the sign stands the error of the integration, which 95 % of such figures keep. The other "
           "rows use the same core: without gaps, as a mass at the roof (frequency and damping optimized), and with a "
           "dashpot on every floor (one constant, optimized).");
    if (verdict) {
        show_verdicts(verdict, o->r->run, o->r->chosen, d->baseline);
        text_close(verdict);
    }
    put(o, "p class=\"lines\"", "%s", verdicts ? verdicts : "");
    free(verdicts);
    tag(o, "p");
    put(o, "", "Largest force of a contact: ");
    put(o, "b", "%.3g MN", 1e-6 * largest(o, MEASURE_CONTACT_FORCE));
    put(o, "", ", of a link or tuned mass: ");
    put(o, "b", "%.3g MN", 1e-6 * largest(o, MEASURE_DEVICE_FORCE));
    put(o, "", ". Largest bending stress of the core: ");
    put(o, "b", "%.3g MPa", 1e-6 * largest(o, MEASURE_CORE_STRESS));
    put(o, "", ", %.3g times the buckling stress of its bare wall", largest(o, MEASURE_CORE_BUCKLING));
    if (o->n_records > 1)
        put(o, "", ", each over %zu records", o->n_records);
    put(o, "", ". Nothing here is designed for them.");
    tag(o, "/p");
}

static void write_building(const Dossier *o)
{
    Building b = {0};
    Frame frame = {0};
    Err e = {0};
    const int has_frame = frame_is(o->s->building.model);
    json_t *table = json_array(), *drawn = NULL;
    heading(o, "Building, core and ground motion");
    Status status = building_load(&b, &o->s->building, &e);
    if (status == STATUS_OK && has_frame)
        status = frame_read(&frame, &o->s->building, &e);
    THEN(status, building_drawing(&b, has_frame ? &frame : NULL, 8, &drawn, &e));
    if (status == STATUS_OK) {
        put_lines(table, "floors", "%.0f", b.n);
        put_lines(table, "mass of the building [t]", "%.0f", 1e-3 * building_mass(&b));
        put_lines(table, "first period of the building [s]", "%.3f", 1 / o->d->building_hz[0]);
        put_lines(table, "damping of its first mode [%]", "%.2f", 100 * b.zeta[0]);
        put_lines(table, "mass of the core [t]", "%.0f", 1e-3 * o->d->result[SCENE_IMPACT].mcore_kg);
        put_lines(table, "first period of the core [s]", "%.3f", 1 / o->d->core_hz[0]);
        put_lines(table, "damping of the core [%]", "%.2f", 100 * o->s->core.damping);
        put_lines(table, "outer side of the core [m]", "%.2f", o->s->core.width_m);
        put_lines(table, "coefficient of restitution", "%.2f", o->s->contact.restitution);
        put_lines(table, "radius of a contact [m]", "%.3f", o->s->contact.radius_m);
        put_lines(table, "peak ground acceleration [g]", "%.3f", o->d->pga_g);
        put_lines(table, "length of the motion [s]", "%.1f", o->d->duration_s);
        add_line(table, "model of the building", o->s->building.model);
        add_line(table, "foundation of the core", o->s->core.foundation);
        add_line(table, "ground motion", o->record);
        figures_html(o->out, table);
        json_object_set_new(o->drawings, "panels", drawn);
        draw(o, "panels", "The building to scale; its first mode shapes with period and share of the mass.");
    } else {
        json_decref(table);
    }
    if (status != STATUS_OK)
        say(o, e.text);
    building_free(&b);
    frame_free(&frame);
}

/* Constants of what stands on every floor and at the roof, and what it reaches under the first record. */
static void list_devices(const Dossier *o, const Design *design)
{
    const Detail *d = o->d;
    const SimResult *r = &d->result[SCENE_IMPACT];
    json_t *table = json_array();
    char link[64];
    const int is_even = d->gap_sides == GAPS_BOTH;
    snprintf(link, sizeof link, "link [MN (s/m)^%g]", o->s->design.link_exponent);
    for (int j = 0; j < d->n_floors; j++) {
        const char *const columns[] = {is_even ? "gap [mm]" : "gap right [mm]",
                                       "gap left [mm]",
                                       "bumper [MN/m]",
                                       "contact force [MN]",
                                       link,
                                       "friction [MN]",
                                       "link force [MN]",
                                       "link stroke [mm]"};
        const int has_stop = d->gap_m[j] < INFINITY;
        const double values[] = {1e3 * d->gap_side_m[0][j],
                                 is_even ? 0 : 1e3 * d->gap_side_m[1][j],
                                 has_stop * 1e-6 * d->bumper_n_m[j],
                                 1e-6 * fmax(r->forces.contact_force_n[0][j], r->forces.contact_force_n[1][j]),
                                 1e-6 * design->link[j],
                                 1e-6 * design->friction[j],
                                 1e-6 * r->device[j].force,
                                 1e3 * r->device[j].stroke};
        json_t *row = has_stop || design_has_link(design, j) ? json_put(figures_row(table), "floor=%d", j + 1) : NULL;
        for (size_t k = 0; row && k < N_OF(values); k++)
            if (values[k] > 0 && isfinite(values[k]))
                figures_put(row, columns[k], values[k], NAN, NAN);
    }
    figures_html(o->out, table);
    if (design->mass_kg > 0)
        put(o, "p", "Tuned mass: force %.3g MN, stroke %.3g mm.", 1e-6 * r->device[FLOORS_MAX].force,
            1e3 * r->device[FLOORS_MAX].stroke);
    say_under(o, "Forces and strokes");
}

static void write_design(const Dossier *o)
{
    const Schema *schema = &o->r->run->schema;
    Design design;
    design_of(&schema->design, o->x, &design);
    heading(o, "The design");
    draw(o, "gaps", "");
    list_devices(o, &design);
}

/* ---- how it responds ------------------------------------------------------------------------------------------- */

static Status simulate_with(const Dossier *o, const char *key, const char *value, SimResult *out, Err *err)
{
    Settings s = *o->s;
    Problem p;
    s.sim.steps_per_contact = 0; /* those of the value, and not those by which the run knows the design */
    TRY(settings_put(&s, key, value, err));
    TRY(settings_check(&s, err));
    TRY(tower_open(&p, &s, TOWER_SINGLE, 1, err));
    const Status status = tower_simulate(&p, 1, &(SimTask){.kind = SCENE_IMPACT, .x = o->x}, out, err);
    problem_close(&p);
    return status;
}

static void add_with(const Dossier *o, json_t *table, const char *label, const char *key, const char *value)
{
    SimResult r = {0};
    Err e = {0};
    if (simulate_with(o, key, value, &r, &e) == STATUS_OK)
        add_response(table, label, &r, NULL);
    else
        add_line(table, label, e.text);
}

static void add_full_model(const Dossier *o, json_t *table)
{
    FullModel m = {0};
    Err e = {0};
    char label[64];
    if (!frame_is(o->s->building.model)) {
        add_line(table, "full model", "this building has no degrees of freedom but its floors");
        return;
    }
    if (full_model_find(o->s, SCENE_IMPACT, 1, o->x, 0, &m, &e) == STATUS_OK) {
        snprintf(label, sizeof label, "full model, %d degrees of freedom", m.dofs[FULL]);
        add_response(table, label, m.result[FULL], NULL);
    } else {
        add_line(table, "full model", e.text);
    }
    full_model_free(&m);
}

static void write_response(const Dossier *o)
{
    const SimResult *r = o->d->result;
    json_t *table = json_array();
    heading(o, "The response, by four calculations");
    add_response(table, "as the study knows it", &r[SCENE_IMPACT], o->d->error);
    add_with(o, table, "accuracy fine", "sim.accuracy", "fine");
    add_with(o, table, "by CVODE (SUNDIALS)", "sim.engine", "cvode");
    add_full_model(o, table);
    figures_html(o->out, table);
    say_under(o, "All");
    say(o, "CVODE integrates the equations of motion without the study's engine. Contacts that graze may separate two "
           "calculations: J3 is then the least certain figure.");
    draw(o, "peaks", "Peaks over the height.");
    draw(o, "displacement", "Below each history its wavelet amplitude; dashed: natural frequencies of the building.");
}

/* ---- what it has to bear --------------------------------------------------------------------------------------- */

/* The study's limits, on what it judged: of several simulations none by itself. */
static void write_limits(const Dossier *o)
{
    const Run *run = o->r->run;
    json_t *table = json_array();
    Limits l = {0};
    if (limits_read(&l, &run->schema, o->s->search.limits, NULL) != STATUS_OK)
        l.n = 0;
    for (size_t i = 0; i < l.n; i++) {
        char head[HEAD_MAX], text[64];
        const Limit *limit = &l.limit[i];
        const Words w = head_of(words_of_objective(&run->schema, limit->result), head);
        const double value = run_result(run, o->r->chosen, limit->result);
        json_t *row = json_put(figures_row(table), "=%s", head);
        snprintf(text, sizeof text, "%s %.4g", limit->sign > 0 ? "<=" : ">=", w.factor * limit->bound);
        figures_put(row, "as the study judges it", w.factor * value, NAN, NAN);
        put_text(row, " limit of the study", text);
        put_text(row, " verdict",
                 isnan(value)                                ? "not known"
                 : limit->sign * (value - limit->bound) <= 0 ? "kept"
                                                             : "exceeded");
    }
    if (l.n == 0)
        say(o, "The study sets no limits.");
    show_any(o, table);
}

/* Row of a demand that it has: of the first record, and the largest. */
static void add_demand(const Dossier *o, json_t *table, int k, Words words, double error)
{
    const double value = demand_of(o->by_record, k), most = largest(o, k);
    char head[HEAD_MAX], column[220];
    if (!isfinite(most) || (most <= 0 && k != MEASURE_RESIDUAL_DRIFT)) /* it has no such device */
        return;
    const Words w = head_of(words, head);
    json_t *row = json_put(figures_row(table), "=%s", head);
    snprintf(column, sizeof column, "largest of %zu records", o->n_records);
    if (o->n_records > 1)
        figures_put(row, column, w.factor * most, NAN, NAN);
    snprintf(column, sizeof column, "under %s", o->record);
    figures_put(row, column, w.factor * value, w.factor * error, NAN);
}

/* Whether the stop of floor j has closed under any record. */
static int has_closed(const Dossier *o, int j)
{
    size_t i = 0;
    while (i < o->n_records && o->by_record[i].closings[j] == 0)
        i++;
    return i < o->n_records;
}

static void write_demand(const Dossier *o)
{
    int borne[MEASURES_LISTED];
    json_t *table = json_array();
    heading(o, "Forces and stresses, with their limits");
    for (int i = 0; i < measures_borne(borne); i++)
        add_demand(o, table, borne[i], measure(borne[i])->words, o->d->error[borne[i]]);
    add_demand(o, table, N_MEASURES, (Words){"core shear stress", "MPa", 1e-6}, NAN);
    figures_html(o->out, table);
    write_limits(o);
    tag(o, "p");
    put(o, "", "For comparison: ordinary steel yields at %.0f MPa", 1e-6 * YIELD_PA);
    print_exceeded(o, MEASURE_CORE_STRESS, YIELD_PA, "the core");
    put(o, "", ", in shear at %.0f MPa", 1e-6 * YIELD_PA / sqrt(3));
    print_exceeded(o, N_MEASURES, YIELD_PA / sqrt(3), "its shear stress");
    put(o, "", ". Stops that never close%s, on floors: ", o->n_records > 1 ? " under any of these records" : "");
    int n = 0;
    for (int j = 0; j < o->d->n_floors; j++)
        if (!has_closed(o, j) && o->d->gap_m[j] < INFINITY)
            put(o, "", "%s%d", n++ ? ", " : "", j + 1);
    put(o, "", n ? "." : "none.");
    tag(o, "/p");
    draw(o, "forces", "");
    say_under(o, "Both");
}

static void write_ladder(const Dossier *o)
{
    const Ladder *l = o->d->ladder;
    char verdict[64];
    json_t *table = json_array();
    heading(o, "Which effects the model needs");
    for (size_t i = 0; l && i < l->n; i++) {
        const LadderEffect *e = &l->effect[i];
        json_t *row = json_put(figures_row(table), "without=%s", e->words);
        for (int k = 0; k < LADDER_MEASURES; k++) {
            char head[64];
            snprintf(head, sizeof head, "%s [%%]", measure(LADDER_MEASURE[k])->words.title);
            figures_put(row, head, 100 * e->change[0][k], NAN, NAN);
        }
        put_text(row, " in the study", e->is_set ? "yes" : "no");
        snprintf(verdict, sizeof verdict,
                 e->is_needed && e->decided_in ? "needed: %s"
                 : e->is_needed                ? "needed"
                                               : "not needed",
                 SCENES[LADDER_SCENE[e->decided_in]].words);
        put_text(row, " verdict", verdict);
    }
    show_any(o, table);
    if (l)
        say_under(o, "All");
    say(o, l ? "What leaving out each effect changes of a model that has them all; needed: more than 2 % or the "
               "scatter as built, of the design, of the core rigidly connected or of the building alone, which is "
               "named. An "
               "effect that is needed and not in the study is an open point of this design."
           : *o->d->no_ladder.text ? o->d->no_ladder.text
                                   : "Only the engine fast has this.");
}

/* ---- other earthquakes ----------------------------------------------------------------------------------------- */

static void write_records(const Dossier *o)
{
    json_t *table = json_array();
    char label[200];
    heading(o, "Records one by one");
    for (size_t i = 0; i <= o->d->n_elsewhere; i++) {
        const Elsewhere *e = i ? &o->d->elsewhere[i - 1] : NULL;
        snprintf(label, sizeof label, "%.120s, %.3g g", basename(e ? e->record : o->d->record),
                 e ? e->pga_g : o->d->pga_g);
        add_response(table, label, e ? &e->with_core : &o->d->result[SCENE_IMPACT], NULL);
        add_response(table, "  no core", e ? &e->no_core : &o->d->result[SCENE_NO_CORE], NULL);
    }
    figures_html(o->out, table);
    say(o, "Those of the study first. builtin: motions are synthetic: judge by records.");
}

static void add_level(json_t *table, const Evaluations *e, size_t l, size_t *exceeded)
{
    static const MeasureId SHOWN[] = {MEASURE_J1, MEASURE_DRIFT_RATIO, MEASURE_J3};
    static const SceneKind CASES[] = {SCENE_IMPACT, SCENE_NO_CORE};
    json_t *row = json_put(figures_row(table), "PGA [g]=%g", e->level[l]);
    for (size_t k = 0; k < N_OF(SHOWN); k++)
        for (size_t c = 0; c < N_OF(CASES); c++) {
            const Words w = measure(SHOWN[k])->words;
            char head[96];
            snprintf(head, sizeof head, "%s [%s]%s", w.title, w.unit, c ? ", no core" : "");
            put_fractiles(row, head, e, l, CASES[c], SHOWN[k], w.factor);
        }
    for (size_t r = 0; r < e->n_records; r++)
        *exceeded += e->record[r].readable == STATUS_OK &&
                     ida_value(&e->run[r * e->n_levels + l], SCENE_IMPACT, MEASURE_DRIFT_RATIO) > DRIFT_LIMIT;
}

static void write_intensities(const Dossier *o, Evaluations *e)
{
    json_t *table = json_array();
    double level[LEVELS];
    size_t n_at[LEVELS], exceeded[LEVELS] = {0}, n_exceeded = 0;
    char text[400];
    for (size_t l = 0; l < LEVELS; l++) {
        level[l] = e->level[l];
        n_at[l] = e->n_read;
        add_level(table, e, l, &exceeded[l]);
        n_exceeded += exceeded[l];
    }
    figures_html(o->out, table);
    const Fragility f = fragility_fit(LEVELS, level, n_at, exceeded);
    int n = snprintf(text, sizeof text,
                     "Median (16 to 84 %%) of %zu records scaled to each peak. A drift ratio of %.0f %% is ", e->n_read,
                     100 * DRIFT_LIMIT);
    if (isfinite(f.median))
        snprintf(text + n, sizeof text - (size_t)n,
                 "exceeded with probability one half at %.2g g (logarithmic deviation %.2f): lognormal, by maximum "
                 "likelihood.",
                 f.median, f.beta);
    else
        snprintf(text + n, sizeof text - (size_t)n,
                 "exceeded by %zu of these simulations: too few, too many or too sudden for a curve.", n_exceeded);
    say(o, text);
}

static void write_ida(const Dossier *o, size_t n, const char *const records[])
{
    double level[LEVELS];
    Evaluations e = {.n_levels = LEVELS, .level = level, .intensity = "pga_g"};
    Settings s = *o->s;
    Err why = {0};
    Status status = STATUS_OK;
    for (size_t l = 0; l < LEVELS; l++)
        level[l] = LEVEL_STEP_G * (double)(l + 1);
    heading(o, "Against intensity");
    s.sim.forces = FORCES_AUTO;
    status = evaluations_add(&e, o->s->motion.record, 1, &why);
    for (size_t i = 0; i < n && status == STATUS_OK; i++)
        status = evaluations_add(&e, records[i], 1, &why);
    status = status == STATUS_OK ? evaluations_read(&e, &s, &why) : status;
    status = status == STATUS_OK ? evaluations_run(&e, o->r->run->schema.n_var, o->x, NULL, &why) : status;
    if (status == STATUS_OK)
        write_intensities(o, &e);
    else
        say(o, why.text);
    evaluations_free(&e);
}

/* ---- what it hangs on ------------------------------------------------------------------------------------------ */

static Status find_as_built(const Dossier *o, Settings *s, ReplicateSummary *out, Err *err)
{
    Problem p;
    SimResult shown;
    s->sim.replicates = AS_BUILT;
    if (!(s->sim.gap_tolerance_m > 0))
        s->sim.gap_tolerance_m = GAP_BUILT_M;
    TRY(tower_open(&p, s, TOWER_AS_SET, AS_BUILT, err));
    const Status status = tower_replicate(&p, 1, o->x, &shown, out, err);
    problem_close(&p);
    return status;
}

static void write_as_built(const Dossier *o)
{
    Settings s = *o->s;
    ReplicateSummary summary = {0};
    Err e = {0};
    char text[300];
    json_t *table = json_array(), *row = figures_row(table);
    heading(o, "As built, and what the figures hang on");
    const Status status = find_as_built(o, &s, &summary, &e);
    json_object_set_new(row, "",
                        json_sprintf("%s and standard deviation", status == STATUS_OK ? summary.rule : "mean"));
    if (status == STATUS_OK && !summary.n_failed)
        for (size_t i = 0; i < N_OF(RESPONSE); i++)
            put_named(row, measure(RESPONSE[i])->words, summary.mean[RESPONSE[i]], NAN, summary.sd[RESPONSE[i]]);
    figures_html(o->out, table);
    snprintf(text, sizeof text,
             "%d structures under every record of the study, whose gaps differ from the drawing by %g mm (standard "
             "deviation; none below 0)%s.",
             AS_BUILT, 1e3 * s.sim.gap_tolerance_m,
             spread_word(0, &s.sim.uncertain)[0] == 'a' ? ", with what sim.uncertain of the study says" : "");
    say(o, status != STATUS_OK ? e.text : text);
    if (summary.n_failed)
        say(o, "Some of these simulations failed: there is no mean.");
}

/* Gaps that move nothing are left out: they never close. */
static void write_sensitivities(const Dossier *o)
{
    static const MeasureId SHOWN[] = {MEASURE_J1, MEASURE_DRIFT_RATIO, MEASURE_CONTACT_FORCE, MEASURE_CORE_STRESS};
    Sensitivity *list = NULL;
    size_t n = 0;
    Err e = {0};
    json_t *table = json_array();
    if (sensitivity_find(o->s, o->x, 1, &list, &n, &e) != STATUS_OK)
        say(o, e.text);
    for (size_t i = 0; i < n; i++) {
        if (list[i].slope[MEASURE_J1] == 0 && list[i].slope[MEASURE_DRIFT_RATIO] == 0)
            continue;
        json_t *row =
            json_put(figures_row(table), "parameter=%s value=%g step=%g", list[i].name, list[i].value, list[i].step);
        for (size_t k = 0; k < N_OF(SHOWN); k++)
            put_named(row, measure(SHOWN[k])->words, list[i].step * list[i].slope[SHOWN[k]],
                      list[i].step * list[i].error[SHOWN[k]], NAN);
    }
    show_any(o, table);
    say_under(o, "Gaps that change nothing are left out. Change of each result for one step of a parameter, with its "
                 "error,");
    free(list);
}

/* ---- what it is not, and where it comes from ------------------------------------------------------------------- */

static void write_not_covered(const Dossier *o)
{
    const Settings *s = o->s;
    heading(o, "What is not covered");
    tag(o, "ul");
    put(o, "li", "Torsion, friction and the vertical motion. One contact per floor and side.");
    put(o, "li",
        "The mass of the core, %.0f t, is that of its bare walls. It has no stiffeners, diaphragms or connections%s.",
        1e-3 * o->d->result[SCENE_IMPACT].mcore_kg,
        largest(o, MEASURE_CORE_BUCKLING) > 1 ? ", and the bare wall would buckle: stiffeners are needed, "
                                                "and their mass is missing here and in every objective"
                                              : "");
    put(o, "li",
        "Connections for these forces, of which those of contacts last milliseconds: stops, links, bearings, floors as "
        "diaphragms, local stresses and fatigue are not designed.");
    if (strcmp(s->core.foundation, "fixed") == 0)
        put(o, "li", "The core is clamped: its foundation bears up to %.3g MN and %.4g MN m without giving way.",
            1e-6 * largest(o, MEASURE_CORE_SHEAR), 1e-6 * largest(o, MEASURE_CORE_OVERTURNING));
    if (!o->d->result[SCENE_IMPACT].yields)
        put(o, "li", "The tower is linear: nothing yields, whatever its drift.");
    if (!s->building.p_delta)
        put(o, "li", "P-delta is left out.");
    put(o, "li", "Comfort, sound and damage of what stands on the floors under accelerations of milliseconds.");
    tag(o, "/ul");
}

static void put_setting(const char *key, unsigned flags, const char *was, const char *is, void *user)
{
    (void)flags;
    (void)was;
    add_line(user, key, is);
}

static void list_provenance(json_t *table, json_t *o)
{
    const char *key;
    json_t *value;
    json_object_foreach(o, key, value)
    {
        if (json_is_object(value))
            list_provenance(table, value);
        else if (json_is_integer(value))
            put_lines(table, key, "%.0f", json_number_value(value));
        else if (json_is_string(value) && json_string_length(value) > 0 && strcmp(key, "flags") != 0)
            add_line(table, key, json_string_value(value));
    }
}

static void write_provenance(const Dossier *o)
{
    json_t *table = json_array(), *settings = json_array(), *from = json_loads(o->r->run->provenance, 0, NULL);
    Settings none;
    heading(o, "Provenance");
    list_provenance(table, from);
    figures_html(o->out, table);
    settings_defaults(&none);
    settings_compare(&none, o->r->run->settings, put_setting, settings);
    say(o, "Hashes are FNV-1a, 64 bit, of the bytes of the files. Settings that are no defaults:");
    figures_html(o->out, settings);
    char path[PATH_MAX], used[4 * PATH_MAX + 3], folder[4 * PATH_MAX + 3];
    folder_path(o->r->run->folder, "settings.ini", path);
    say(o, "The row of accuracy fine again:");
    put(o, "code", "imtet simulate %s --design %s:%ld --set sim.accuracy=fine --json", text_shell(path, used),
        text_shell(o->r->run->folder, folder), o->r->run->table.row[o->r->chosen].id);
    json_decref(from);
}

/* ---- the page -------------------------------------------------------------------------------------------------- */

/* body: the caller's. */
static Status write_body(char **body, json_t *drawings, const Report *r, const Settings *s, size_t n,
                         const char *const records[], Err *err)
{
    const Detail *d = &r->detail;
    size_t length;
    Dossier o = {
        .r = r, .d = d, .s = s, .x = run_x(r->run, r->chosen), .drawings = drawings, .n_records = d->n_records};
    o.by_record = d->by_record ? d->by_record : &d->result[SCENE_IMPACT];
    snprintf(o.record, sizeof o.record, o.n_records > 1 ? "%s, the first of %zu records" : "%s", d->record,
             o.n_records);
    o.out = text_open(body, &length);
    if (!o.out)
        return fail_memory(err, 1, "a dossier");
    tag(&o, "main class=\"paper\"");
    write_summary(&o);
    write_building(&o);
    write_design(&o);
    write_response(&o);
    write_demand(&o);
    write_ladder(&o);
    write_records(&o);
    write_ida(&o, n, records);
    write_as_built(&o);
    write_sensitivities(&o);
    write_not_covered(&o);
    write_provenance(&o);
    tag(&o, "/main");
    return text_close(o.out) ? fail_memory(err, 1, "a dossier") : STATUS_OK;
}

/* ---- the file -------------------------------------------------------------------------------------------------- */

static int is_pdf(const char *path)
{
    return text_ends(path, ".pdf");
}

Status dossier_check(const char *path, Err *err)
{
    if (!is_pdf(path) && !text_ends(path, ".html"))
        return misused(err, "--dossier %s: it is written as a page or a PDF; name the file .html or .pdf", path);
    return is_pdf(path) ? browser_check(path, err) : STATUS_OK;
}

static Status write_html(json_t *run, const char *body, const char *path, Err *err)
{
    Output o;
    Status status = output_open(&o, path, err);
    if (status != STATUS_OK)
        json_decref(run);
    return status == STATUS_OK ? output_end(&o, page_write(o.stream, run, NULL, body, err), err) : status;
}

Status dossier_write(const Report *r, const Settings *s, size_t n, const char *const records[], const char *path,
                     Err *err)
{
    char *body = NULL;
    json_t *drawings = json_object();
    Status status = write_body(&body, drawings, r, s, n, records, err);
    json_t *run = json_put(report_json(r), "paper=%p drawings=%p", json_array(), drawings);
    if (status == STATUS_OK)
        status = (is_pdf(path) ? page_print : write_html)(run, body, path, err);
    else
        json_decref(run);
    free(body);
    return status;
}
