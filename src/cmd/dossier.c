#include "cmd/dossier.h"

#include "analysis/full_model.h"
#include "base/text.h"
#include "cmd/designs.h"
#include "cmd/fragilities.h"
#include "cmd/show.h"
#include "evaluate/limits.h"
#include "report/panels.h"
#include "report/pictures.h"
#include "report/report_json.h"
#include "report/words.h"
#include "settings/settings.h"
#include "store/folder.h"
#include "store/output.h"
#include "store/provenance.h"

enum { LEVELS = 6 };
static const double LEVEL_STEP_G = 0.1;
static const char RESPONSE[] = "j1_m,j2_m,drift_ratio,j3_g,ed1_pct,ed5_10_pct,edcs_pct";

typedef struct {
    Document *doc;
    const Report *r;
    const Detail *d;
    const Settings *s;
    const double *x;
    json_t *drawings;   /* by name, what the report's page does not have */
    MeasureOrder order; /* RESPONSE */
    size_t n_records;
    const SimResult *by_record; /* (n_records) the design under every record of the study */
    char record[200];           /* of the figures in detail: "builtin:kobe-like, the first of 22 records" */
} Dossier;

/* Over the records of the study; NAN: none has it. */
static double largest(const Dossier *o, int k)
{
    double most = NAN;
    for (size_t i = 0; i < o->n_records; i++)
        most = fmax(most, o->by_record[i].outcome == RUN_OK ? measure_value(&o->by_record[i], k) : NAN);
    return most;
}

/* Without what has no room on paper: notes on a simulation that succeeded, and indentations, which the demands have. */
static void add_response(const Dossier *o, json_t *table, const char *label, const SimResult *r)
{
    json_t *row = figures_result(table, label, &o->order, r, NULL, NULL);
    json_object_del(row, "indentation");
    if (r->outcome == RUN_OK)
        json_object_del(row, " ");
}

/* ---- what it is ------------------------------------------------------------------------------------------------ */

static void say_summary(Dossier *o)
{
    Document *doc = o->doc;
    const Run *run = o->r->run;
    const Schema *schema = &run->schema;
    double error[OBJECTIVES_MAX];
    char now[24], rule[RULE_WORDS_MAX];
    utc_now(now);
    words_of_rule(o->s, rule);
    document_add(doc, "h1", "Design %ld of %s", run->table.row[o->r->chosen].id, run->folder);
    document_add(doc, "note", "imtet %s (%s), %s. Found in %zu simulated designs, %zu of them nondominated.",
                 program_version(), program_revision(), now, run->table.n, run->n_front);
    document_verdict(doc, run, o->r->chosen, o->s);
    json_t *table = document_table(doc);
    figures_of_run(table, run, "this design", o->r->chosen);
    for (size_t k = 0; k < schema->n_obj; k++)
        error[k] = o->d->standard_error[schema->order.of[k]];
    if (o->n_records > 1)
        figures_design(table, "its standard error over the records", 0, schema, error, NULL, NULL, NULL);
    figures_baselines(table, schema, o->d->baseline);
    document_say(doc, "Values as the study judges them: %s%s.", *rule ? rule : o->record,
                 run->table.row[o->r->chosen].kind == KIND_SCREENED
                     ? ", of which this design, only screened, has seen a part"
                     : "");
    document_say(
        doc, "Behind the sign stands the error of the integration, which 95 %% of such figures keep. The other rows "
             "use the same core: without gaps, as a mass at the roof (frequency and damping optimized), and with a "
             "dashpot on every floor (one constant, optimized).");
}

static void say_building(Dossier *o)
{
    Building b = {0};
    Frame frame = {0};
    Err e = {0};
    const Detail *d = o->d;
    const Settings *s = o->s;
    const int has_frame = frame_is(s->building.model);
    json_t *drawn = NULL;
    document_add(o->doc, "h2", "Building, core and ground motion");
    Status status = building_load(&b, &s->building, &e);
    if (has_frame)
        THEN(status, frame_read(&frame, &s->building, &e));
    THEN(status, building_drawing(&b, has_frame ? &frame : NULL, 8, &drawn, &e));
    if (status == STATUS_OK) {
        document_list(
            o->doc,
            json_of("floors=%d mass of the building [t]=%g first period of the building [s]=%g damping ratio=%g "
                    "mass of the core [t]=%g first period of the core [s]=%g damping ratio of the core=%g "
                    "side of the core [m]=%g restitution=%g radius of a contact [m]=%g "
                    "peak of the ground motion [g]=%g length of the motion [s]=%g model of the building=%s "
                    "foundation of the core=%s ground motion=%s",
                    b.n, 1e-3 * building_mass(&b), 1 / d->building_hz[0], b.zeta[0],
                    1e-3 * d->result[SCENE_IMPACT].mcore_kg, 1 / d->core_hz[0], s->core.damping, s->core.width_m,
                    s->contact.restitution, s->contact.radius_m, d->pga_g, d->duration_s, s->building.model,
                    s->core.foundation, o->record));
        json_object_set_new(o->drawings, "panels", drawn);
        document_draw(o->doc, "panels",
                      "The building to scale; its first mode shapes with period and share of the mass.");
    }
    document_say(o->doc, "%s", e.text);
    building_free(&b);
    frame_free(&frame);
}

/* Constants of what stands on every floor and at the roof, and what it reaches under the first record. */
static void say_design(Dossier *o)
{
    const Detail *d = o->d;
    const SimResult *r = &d->result[SCENE_IMPACT];
    Design design;
    design_of(&o->r->run->schema.design, o->x, &design);
    document_add(o->doc, "h2", "The design");
    document_draw(o->doc, "gaps", "");
    json_t *table = document_table(o->doc);
    for (int j = 0; j < d->n_floors; j++) {
        const int has_stop = d->gap_m[j] < INFINITY;
        const struct {
            const char *column;
            double value;
        } cells[] = {{"gap right [mm]", 1e3 * d->gap_side_m[0][j]},
                     {"gap left [mm]", 1e3 * d->gap_side_m[1][j]},
                     {"bumper [MN/m]", has_stop * 1e-6 * d->bumper_n_m[j]},
                     {"contact force right [MN]", 1e-6 * r->forces.contact_force_n[0][j]},
                     {"contact force left [MN]", 1e-6 * r->forces.contact_force_n[1][j]},
                     {"link [MN (s/m)^n]", 1e-6 * design.link[j]},
                     {"friction [MN]", 1e-6 * design.friction[j]},
                     {"link force [MN]", 1e-6 * r->device[j].force},
                     {"link stroke [mm]", 1e3 * r->device[j].stroke}};
        json_t *row = has_stop || design_has_link(&design, j) ? json_put(figures_row(table), "floor=%d", j + 1) : NULL;
        for (size_t k = 0; row && k < N_OF(cells); k++)
            if (cells[k].value > 0 && isfinite(cells[k].value))
                figures_number(row, cells[k].column, cells[k].value);
    }
    if (design.mass_kg > 0)
        document_say(o->doc, "Tuned mass: force %.3g MN, stroke %.3g mm.", 1e-6 * r->device[FLOORS_MAX].force,
                     1e3 * r->device[FLOORS_MAX].stroke);
    document_say(o->doc, "Forces and strokes under %s.", o->record);
}

/* ---- how it responds ------------------------------------------------------------------------------------------- */

/* The response by another value of a setting, with its steps and not those by which the run knows the design. */
static void add_with(Dossier *o, json_t *table, const char *label, const char *key, const char *value)
{
    Settings s = *o->s;
    Problem p;
    SimResult r = {0};
    Err e = {0};
    s.sim.steps_per_contact = 0;
    Status status = settings_put(&s, key, value, &e);
    THEN(status, settings_check(&s, &e));
    THEN(status, tower_open(&p, &s, TOWER_SINGLE, 1, &e));
    if (status == STATUS_OK) {
        status = tower_simulate(&p, 1, &(SimTask){.kind = SCENE_IMPACT, .x = o->x}, &r, &e);
        problem_close(&p);
    }
    if (status == STATUS_OK)
        add_response(o, table, label, &r);
    else
        json_put(json_put(figures_row(table), "=%s", label), " =%s", e.text);
}

static void say_response(Dossier *o)
{
    FullModel m = {0};
    Err e = {0};
    char label[64];
    document_add(o->doc, "h2", "The response by four calculations");
    json_t *table = document_table(o->doc);
    add_response(o, table, "as the study knows it", &o->d->result[SCENE_IMPACT]);
    add_with(o, table, "accuracy fine", "sim.accuracy", "fine");
    add_with(o, table, "by CVODE (SUNDIALS)", "sim.engine", "cvode");
    if (frame_is(o->s->building.model) && full_model_find(o->s, SCENE_IMPACT, 1, o->x, 0, &m, &e) == STATUS_OK) {
        snprintf(label, sizeof label, "full model, %d degrees of freedom", m.dofs[FULL]);
        add_response(o, table, label, m.result[FULL]);
    }
    full_model_free(&m);
    document_say(
        o->doc,
        "All under %s. CVODE integrates the equations of motion without the study's engine. Contacts that graze "
        "may separate two calculations: J3 is then the least certain figure. %s",
        o->record, e.text);
    document_draw(o->doc, "peaks", "Peaks over the height.");
    document_draw(o->doc, "displacement",
                  "Below each history its wavelet amplitude; dashed: natural frequencies of the building.");
}

/* ---- what it has to bear --------------------------------------------------------------------------------------- */

/* What it reaches, the study's limits on what it judged (of several simulations none by itself), and idle stops. */
static void say_demand(Dossier *o)
{
    Document *doc = o->doc;
    const Run *run = o->r->run;
    int borne[MEASURES_LISTED];
    char most[64], first[220], never[5 * FLOORS_MAX + 16] = "", text[64];
    Limits l = {0};
    document_add(doc, "h2", "Forces and stresses, with their limits");
    json_t *table = document_table(doc);
    snprintf(most, sizeof most, "largest of %zu records", o->n_records);
    snprintf(first, sizeof first, "under %s", o->record);
    for (int i = 0; i < measures_borne(borne); i++) {
        const double all = largest(o, borne[i]);
        if (!isfinite(all) || (all <= 0 && borne[i] != MEASURE_RESIDUAL_DRIFT)) /* it has no such device */
            continue;
        json_t *row = json_put(figures_row(table), "=%s", measure(borne[i])->name);
        if (o->n_records > 1)
            figures_number(row, most, all);
        figures_put(row, first, measure_value(o->by_record, borne[i]), o->d->error[borne[i]], NAN);
    }
    if (limits_read(&l, &run->schema, o->s->search.limits, NULL) != STATUS_OK || l.n == 0)
        document_say(doc, "The study sets no limits.");
    table = document_table(doc);
    for (size_t i = 0; i < l.n; i++) {
        const Limit *limit = &l.limit[i];
        const double value = run_result(run, o->r->chosen, limit->result);
        const int keeps = limit->sign * (value - limit->bound) <= 0;
        snprintf(text, sizeof text, "%s %.4g",
                 limit->sign > 0 ? "<=" : ">=", words_of_objective(&run->schema, limit->result).factor * limit->bound);
        json_t *row = json_put(figures_row(table), "=%s", schema_objective(&run->schema, limit->result)->name);
        figures_number(row, "as the study judges it", value);
        json_put(row, " limit of the study=%s", text);
        json_put(row, " verdict=%s", isnan(value) ? "not known" : keeps ? "kept" : "exceeded");
    }
    for (int j = 0; j < o->d->n_floors; j++) {
        size_t i = 0;
        while (i < o->n_records && o->by_record[i].closings[j] == 0)
            i++;
        if (i == o->n_records && o->d->gap_m[j] < INFINITY)
            snprintf(never + strlen(never), 16, "%s%d", *never ? ", " : "", j + 1);
    }
    document_say(doc, "Stops that never close%s, on floors: %s.", o->n_records > 1 ? " under any of these records" : "",
                 *never ? never : "none");
    document_draw(doc, "forces", "");
}

/* ---- other earthquakes ----------------------------------------------------------------------------------------- */

/* Records one by one; then all at every level, with the fragility of a drift ratio of 2 %. */
static void say_records(Dossier *o, size_t n, const char *const records[])
{
    Document *doc = o->doc;
    const Detail *d = o->d;
    char label[200];
    double level[LEVELS];
    Evaluations e = {.n_levels = LEVELS, .level = level, .intensity = "pga_g"};
    Settings s = *o->s;
    Err why = {0};
    Fragilities f = {0};
    MeasureOrder shown;
    document_add(doc, "h2", "Records one by one");
    json_t *table = document_table(doc);
    for (size_t i = 0; i <= d->n_elsewhere; i++) {
        const Elsewhere *at = i ? &d->elsewhere[i - 1] : NULL;
        snprintf(label, sizeof label, "%.120s, %.3g g", basename(at ? at->record : d->record),
                 at ? at->pga_g : d->pga_g);
        add_response(o, table, label, at ? &at->with_core : &d->result[SCENE_IMPACT]);
        add_response(o, table, "  no core", at ? &at->no_core : &d->result[SCENE_NO_CORE]);
    }
    document_say(doc, "The records of the study come first. builtin: motions are synthetic: judge by records.");
    document_add(doc, "h2", "Against intensity");
    for (size_t l = 0; l < LEVELS; l++)
        level[l] = LEVEL_STEP_G * (double)(l + 1);
    s.sim.forces = FORCES_AUTO;
    Status status = fragilities_read(&f, &o->r->run->schema, "drift_ratio=0.02", NULL, e.intensity, &s, &why);
    THEN(status, measures_order(&shown, "j1_m,drift_ratio,j3_g", "none", 0, &why));
    THEN(status, evaluations_add(&e, o->s->motion.record, 1, &why));
    for (size_t i = 0; i < n; i++)
        THEN(status, evaluations_add(&e, records[i], 1, &why));
    THEN(status, evaluations_read(&e, &s, &why));
    THEN(status, evaluations_run(&e, o->r->run->schema.n_var, o->x, NULL, &why));
    if (status == STATUS_OK) {
        document_ida(doc, &e, &shown);
        document_fragilities(doc, &f, &e);
    }
    document_say(doc, "%s", why.text);
    evaluations_free(&e);
    fragilities_free(&f);
}

static void say_sensitivities(Dossier *o)
{
    Sensitivity *list = NULL;
    size_t n = 0;
    Err e = {0};
    document_add(o->doc, "h2", "What the figures depend on");
    if (sensitivity_find(o->s, o->x, 1, &list, &n, &e) == STATUS_OK)
        document_slopes(o->doc, n, list);
    document_say(o->doc, "%s", e.text);
    free(list);
}

/* ---- what it is not, and where it comes from ------------------------------------------------------------------- */

static void say_not_covered(Dossier *o)
{
    const Settings *s = o->s;
    Document *doc = o->doc;
    char text[UPLIFT_WORDS_MAX];
    document_add(doc, "h2", "What is not covered");
    document_add(doc, "li",
                 "Torsion other than by contacts off the centre, ground motion in two directions, vertical motion. "
                 "One contact per floor and side, without friction.");
    document_add(doc, "li",
                 "The mass of the core, %.0f t, is that of its %s, without %sdiaphragms or connections. Where the wall "
                 "buckles, the mass of stiffeners against it is missing here and in every objective.",
                 1e-3 * o->d->result[SCENE_IMPACT].mcore_kg,
                 s->core.stiffeners > 0 ? "walls and core.stiffeners" : "bare walls",
                 s->core.stiffeners > 0 ? "" : "stiffeners, ");
    document_add(doc, "li",
                 "Connections for these forces: stops, links, bearings, collectors that yield, floors as diaphragms, "
                 "local stresses and fatigue are not designed. Contact forces last milliseconds.");
    if (foundation_lifts(&o->d->result[SCENE_IMPACT]))
        document_add(doc, "li", "Foundation: %s.", uplift_words(&o->d->result[SCENE_IMPACT], text));
    if (strcmp(s->core.foundation, "fixed") == 0)
        document_add(doc, "li",
                     "The core is clamped: its foundation is taken to carry %.3g MN and %.4g MN m without moving.",
                     1e-6 * largest(o, MEASURE_CORE_SHEAR), 1e-6 * largest(o, MEASURE_CORE_OVERTURNING));
    if (!o->d->result[SCENE_IMPACT].yields)
        document_add(doc, "li", "The tower is linear: nothing yields at any drift.");
    else
        document_add(doc, "li", "The tower keeps the damping of its elastic modes while storeys yield.");
    if (!s->building.p_delta)
        document_add(doc, "li", "P-delta is left out.");
    document_add(doc, "li", "Comfort, sound, and damage to contents by accelerations of milliseconds.");
}

static void put_setting(const char *key, unsigned, const char *, const char *is, void *user)
{
    json_object_set_new(user, key, json_words(is));
}

static void say_provenance(Dossier *o)
{
    const Run *run = o->r->run;
    json_t *settings = json_object(), *from = json_loads(run->provenance, 0, NULL);
    Settings none;
    char path[PATH_MAX], used[4 * PATH_MAX + 3], folder[4 * PATH_MAX + 3];
    document_add(o->doc, "h2", "Provenance");
    json_object_del(from, "flags");
    document_list(o->doc, from);
    settings_defaults(&none);
    settings_compare(&none, run->settings, put_setting, settings);
    document_say(o->doc,
                 "Hashes are FNV-1a, 64 bit, of the bytes of the files. Settings that differ from their defaults:");
    document_list(o->doc, settings);
    folder_path(run->folder, "settings.ini", path);
    document_say(o->doc, "To repeat the row of accuracy fine:");
    document_add(o->doc, "code", "imtet simulate %s --design %s:%ld --set sim.accuracy=fine --json",
                 text_shell(path, used), text_shell(run->folder, folder), run->table.row[o->r->chosen].id);
}

/* ---- the file -------------------------------------------------------------------------------------------------- */

static int is_pdf(const char *path)
{
    return text_ends(path, ".pdf");
}

Status dossier_check(const char *path, Err *err)
{
    if (!is_pdf(path) && !text_ends(path, ".html"))
        return misused(err, "--dossier %s: name the file .html or .pdf", path);
    return is_pdf(path) ? browser_check(path, err) : STATUS_OK;
}

Status dossier_write(const Report *r, const Settings *s, size_t n, const char *const records[], const char *path,
                     Err *err)
{
    char *body = NULL;
    size_t length;
    Output o;
    const Detail *d = &r->detail;
    Document doc = {0};
    Dossier all = {.doc = &doc, .r = r, .d = d, .s = s, .x = run_x(r->run, r->chosen), .n_records = d->n_records};
    TRY(measures_order(&all.order, RESPONSE, "none", 0, err));
    FILE *out = text_open(&body, &length);
    if (!out)
        return fail_memory(err, 1, "a dossier");
    all.drawings = json_object();
    all.by_record = d->by_record ? d->by_record : &d->result[SCENE_IMPACT];
    snprintf(all.record, sizeof all.record, all.n_records > 1 ? "%s, the first of %zu records" : "%s", d->record,
             all.n_records);
    say_summary(&all);
    say_building(&all);
    say_design(&all);
    say_response(&all);
    say_demand(&all);
    document_add(all.doc, "h2", "Which effects the model needs");
    if (d->ladder || d->no_ladder.text[0])
        document_draw(all.doc, "ladder", "");
    say_records(&all, n, records);
    say_sensitivities(&all);
    say_not_covered(&all);
    say_provenance(&all);
    fputs("<main class=\"paper\">\n", out);
    document_print(all.doc, out, 1);
    fputs("</main>\n", out);
    json_t *run = json_put(report_json(r), "paper=%p drawings=%p", json_array(), all.drawings);
    Status status = text_close(out) ? fail_memory(err, 1, "a dossier") : STATUS_OK;
    if (status == STATUS_OK && is_pdf(path))
        status = page_print(run, body, path, err);
    else if (status == STATUS_OK && (status = output_open(&o, path, err)) == STATUS_OK)
        status = output_end(&o, page_write(o.stream, run, NULL, body, err), err);
    else
        json_decref(run);
    free(body);
    return status;
}
