#include <unistd.h>

#include "base/clock.h"
#include "analysis/evaluations.h"
#include "base/json.h"
#include "base/text.h"
#include "cmd/commands.h"
#include "cmd/demands.h"
#include "cmd/designs.h"
#include "cmd/fragilities.h"
#include "cmd/full_model.h"
#include "cmd/show.h"
#include "motion/motion_scale.h"
#include "motion/suite.h"
#include "report/verdict.h"
#include "settings/settings.h"
#include "store/run_read.h"

/* A design of a run, or one from elsewhere, under the settings of the run or of a settings file. */
typedef struct {
    const Run *run; /* NULL: of a settings file */
    const Schema *schema;
    size_t row; /* of the run */
    long id;    /* in the run; 0: none */
    const double *x;
    const char *word; /* as it was asked for */
    Known known[N_MEASURES];
    Fragilities fragilities; /* without limits where none are asked for */
} Chosen;

/* ---- for programs: data and rows --------------------------------------------------------------------------------- */

static int is_spectral(const Evaluations *e)
{
    return e->level && strcmp(e->intensity, "sa_g") == 0;
}

/* Who it is of, then the motion: level, where that is the intensity, peak, scale, stretch. */
static json_t *begin_row(json_t *table, const Evaluations *e, const char *record, SceneKind which, const char *outcome,
                         double level, double pga_g, const EvaluatedRun *run)
{
    json_t *row = json_put(figures_row(table), "record=%s scene=%s outcome=%s", record, SCENES[which].key, outcome);
    if (is_spectral(e))
        json_put(row, "sa_g=%g", level);
    return json_put(row, "pga_g=%g scale=%g stretch=%g", pga_g, run ? run->scale : NAN, run ? run->stretch : NAN);
}

/* Every case under one record at one intensity: an object, which is returned, and a row for each. */
static json_t *add_run(Document *d, const Evaluations *e, size_t i)
{
    const EvaluatedRun *run = &e->run[i];
    const MeasureOrder *order = tower_measures(tower_of(&e->tower));
    const double level = e->level ? e->level[i % e->n_levels] : NAN;
    json_t *o =
        json_of("record=%s pga_g=%g scale=%g stretch=%g", run->record->path, run->pga_g, run->scale, run->stretch);
    if (is_spectral(e))
        json_put(o, "sa_g=%g", level);
    for (SceneKind c = 0; c < N_SCENES; c++) {
        const Measured m = measured(&run->result[c]);
        if (!evaluated_has(e, run, c))
            continue;
        json_object_set_new(o, SCENES[c].key, put_device(json_result(order, c, &run->result[c]), c, &run->device[c]));
        json_t *row = begin_row(d->rows, e, run->record->path, c, outcome_word((Outcome)m.outcome), level,
                                e->level && !is_spectral(e) ? level : run->pga_g, run);
        put_measures(row, order, "", m.outcome == RUN_OK ? m.value : NULL, NULL, NULL);
        if (e->replicates > 0)
            put_replicates(row, order, c == SCENE_IMPACT ? &run->replicates : NULL);
    }
    if (run->error_known)
        put_errors(json_object_get(o, SCENES[SCENE_IMPACT].key), run->error, run->sd);
    return e->replicates > 0 ? json_put(o, "replicates=%p", json_replicates(order, &run->replicates)) : o;
}

/* Fractiles of an incremental dynamic analysis: lists by intensity, and a row for each. */
static json_t *add_fractiles(Document *d, const Evaluations *e)
{
    static const char *const KEYS[IDA_FRACTILES][2] = {
        {"fractile_16", "16 %"}, {"median", "median"}, {"fractile_84", "84 %"}};
    json_t *o = json_object();
    json_object_set_new(o, e->intensity, json_numbers(e->n_levels, e->level));
    for (SceneKind c = 0; c < N_SCENES; c++) {
        json_t *one = json_object();
        for (int f = 0; f < IDA_FRACTILES && !case_has_device(c); f++) {
            json_t *rows = json_array(), *lists = json_object();
            for (size_t l = 0; l < e->n_levels; l++) {
                double values[N_MEASURES];
                for (int k = 0; k < N_MEASURES; k++)
                    values[k] = ida_fractile(e, l, c, k, IDA_FRACTILE[f]);
                put_measures(
                    begin_row(rows, e, KEYS[f][1], c, "", e->level[l], is_spectral(e) ? NAN : e->level[l], NULL), NULL,
                    "", values, NULL, NULL);
            }
            for (int k = 0; k < MEASURES_LISTED; k++)
                json_object_set_new(lists, measure(k)->name, json_column(rows, measure(k)->name));
            json_object_set_new(one, KEYS[f][0], lists);
            json_array_extend(d->summaries, rows);
            json_decref(rows);
        }
        if (json_object_size(one) > 0)
            json_object_set(o, SCENES[c].key, one);
        json_decref(one);
    }
    return o;
}

static Document describe_all(const Args *args, const Chosen *c, const Evaluations *e)
{
    Document d = {.rows = json_array(), .summaries = json_array()};
    json_t *records = json_array(), *unreadable = json_array();
    for (size_t i = 0; i < e->n_records * e->n_levels; i++)
        if (e->run[i].record->readable == STATUS_OK)
            json_array_append_new(records, add_run(&d, e, i));
    for (size_t i = 0; i < e->n_records; i++)
        if (e->record[i].readable != STATUS_OK)
            json_array_append_new(unreadable, json_of("record=%s reason=%s", e->record[i].path, e->record[i].why.text));
    d.data = json_of("run=%s design=%p variables_m=%p records=%p unreadable=%p ida=%p", args->operand,
                     c->id > 0 ? json_integer(c->id) : json_words(c->word), json_numbers(c->schema->n_var, c->x),
                     records, unreadable, e->level ? add_fractiles(&d, e) : NULL);
    return d;
}

/* ---- for people -------------------------------------------------------------------------------------------------- */

/* In one table, the motions of those that were named above it; each with the device that was found for it. */
static void say_records(Document *d, const Evaluations *e, const MeasureOrder *order)
{
    char label[400], words[CASE_TEXT_MAX];
    Motion m;
    for (size_t i = 0; i < e->n_records; i++)
        if (e->record[i].readable == STATUS_OK && !e->record[i].from_folder &&
            tower_motion(&e->tower, i, &m, &(Err){0}) == STATUS_OK) {
            document_motion(d, &m, e->duration_s);
            motion_free(&m);
        }
    if (e->replicates > 0)
        document_say(d, "replicates exist for the design with impacts only; the other lines are as designed");
    json_t *table = document_table(d);
    for (size_t i = 0; i < e->n_records; i++)
        for (SceneKind c = 0; c < N_SCENES && e->record[i].readable == STATUS_OK; c++) {
            const EvaluatedRun *run = &e->run[i];
            const int is_known = c == SCENE_IMPACT && run->error_known, has_name = e->n_records > 1;
            if (!evaluated_has(e, run, c))
                continue;
            snprintf(label, sizeof label, "%s%s%s", has_name ? evaluated_name(run->record) : "", has_name ? "  " : "",
                     case_text(c, &run->device[c], words));
            figures_result(table, label, order, &run->result[c], is_known ? run->error : NULL,
                           is_known ? run->sd : NULL);
            if (c == SCENE_IMPACT && run->replicates.n_replicates > 0)
                figures_replicates(table, order, &run->replicates, is_known ? run->error : NULL);
        }
}

static void say_refused(Document *d, const Evaluations *e)
{
    for (size_t i = 0; i < e->n_records; i++)
        if (e->record[i].readable != STATUS_OK)
            document_say(d, "not read: %s", e->record[i].why.text);
}

/* With nothing but --design that of the run, else one over these records; NULL: why tells. */
static char *find_verdict(const Args *args, const Chosen *c, const Settings *s, const Evaluations *e, Err *why)
{
    char *text = NULL, *operand = NULL, quoted[4 * PATH_MAX + 3], id[24];
    size_t length;
    if (c->id > 0 && args->n_given == args_has(args, "--design") + args_has(args, "--json"))
        return stored_verdict(c->run, c->row, NULL, why);
    FILE *out = text_open(&operand, &length);
    if (out)
        fputs(text_shell(args->operand, quoted), out);
    for (int i = 0; i < args->n_given && out; i++) {
        const Given *g = &args->given[i];
        const char *name = g->option->name, *key = g->option->setting;
        key = strcmp(name, "--pga") == 0 ? "motion.pga_g" : strcmp(name, "--sa") == 0 ? "motion.sa_g" : key;
        if (key)
            text_set(out, "%s=%s", key, g->value);
        else if (strcmp(name, "--set") == 0)
            text_set(out, "%s", g->value);
    }
    snprintf(id, sizeof id, "%ld", c->id);
    if (!out || text_close(out) != 0) {
        fail_memory(why, 1, "a verdict");
    } else {
        const char *design = strstr(operand, " --set ") || !c->run ? NULL : c->id > 0 ? id : c->word;
        verdict_find(s, e, c->x, &(VerdictOf){operand, design, NULL}, &text, why);
    }
    free(operand);
    return text;
}

static Status give(const Args *args, const Chosen *c, const Settings *s, const Evaluations *e, Err *err)
{
    const MeasureOrder *order = &c->schema->order;
    const int is_fragility = c->fragilities.limits.n > 0;
    if (args_has(args, "--pelicun"))
        TRY(demands_write(e, args_value(args, "--pelicun"), err));
    Document d = describe_all(args, c, e);
    d.drawing = is_fragility ? "fragility" : "ida";
    d.width = is_fragility ? 30 + 400 * (int)c->fragilities.limits.n : 1300;
    json_t *shown = json_array();
    for (int i = 0; i < MIN_OF(order->n_obj, IDA_SHOWN); i++) {
        const Measure *m = measure(order->of[i]);
        json_array_append_new(shown, json_pack("[so]", m->name, json_sprintf("%s [%s]", m->what, m->unit)));
    }
    if (c->id > 0)
        document_add(&d, "h1", "design %ld of %s", c->id, args->operand);
    else
        document_add(&d, "h1", "design %s by the settings of %s", c->word, args->operand);
    /* What is asked for; why records were left out; at one intensity the verdict, unless only a file is asked for. */
    if (is_fragility)
        document_fragilities(&d, &c->fragilities, e);
    else if (e->level)
        document_ida(&d, e, order);
    else
        say_records(&d, e, order);
    say_refused(&d, e);
    if (!e->level && !args_has(args, "--csv")) {
        Err why = {0};
        char *text = find_verdict(args, c, s, e, &why);
        if (c->id > 0)
            document_add(&d, "h2", "Verdict on design %ld", c->id);
        else
            document_add(&d, "h2", "Verdict on design %s", c->word);
        document_say(&d, "%s", text ? text : why.text);
        json_put(d.data, "verdict=%s", text);
        free(text);
    }
    d.drawn = json_put(json_copy(d.data), "shown=%p", shown);
    return document_give(&d, args, err);
}

/* ---- what is evaluated ------------------------------------------------------------------------------------------- */

static Status add_one(const char *source, void *user, Err *err)
{
    return evaluations_add(user, source, 0, err);
}

/* By default the run's own, where they are now. */
static Status add_records(const Args *args, Evaluations *e, const Settings *s, const Run *run, Err *err)
{
    const char *path;
    if (!args_has(args, "--record")) {
        TRY(record_paths_check(s, run, err));
        return suite_of_study(&s->motion, add_one, e, err);
    }
    for (int i = 0; (path = args_next(args, "--record", &i));)
        TRY(evaluations_add_suite(e, path, err));
    return STATUS_OK;
}

/* --pga or --sa: one is a setting, a range the intensities of an incremental dynamic analysis. */
static Status take_intensities(const Args *args, Settings *s, double levels[], Evaluations *e, Err *err)
{
    static const char *const OTHERS[] = {"motion.pga_g", "motion.factor", "motion.sa_g", "motion.target"};
    const char *sa = args_value(args, "--sa"), *text = sa ? sa : args_value(args, "--pga");
    const char *option = sa ? "--sa" : "--pga";
    const int is_range = text && strchr(text, ':');
    e->n_levels = 1;
    e->intensity = sa ? "sa_g" : "pga_g";
    TRY(args_alone(args, "--sa", "--pga", err));
    if (args_has(args, "--svg") && !is_range)
        return misused(err, "--svg draws an incremental dynamic analysis: give --pga FROM:STEP:TO, or --sa");
    if (args_has(args, "--pelicun") && is_range)
        return misused(err, "--pelicun writes one intensity: give %s G", option);
    if (args_has(args, "--fragility") && !is_range)
        return misused(err, "--fragility needs intensities: --sa FROM:STEP:TO, or --pga");
    for (size_t i = 0; (sa || is_range) && i < N_OF(OTHERS); i++)
        if (args_gives(args, OTHERS[i]))
            return misused(err, "%s %.60s scales every record; %s does not go with it", option, text, OTHERS[i]);
    if (sa || is_range)
        motion_unscale(&s->motion);
    if (sa && !args_gives(args, "motion.sa_period_s")) { /* the period is the building's first, unless another is set */
        Building b;
        TRY(building_load(&b, &s->building, err));
        s->motion.sa_period_s = 2 * M_PI / b.omega[0];
        building_free(&b);
    }
    if (!is_range)
        return !text ? STATUS_OK : settings_put(s, sa ? "motion.sa_g" : "motion.pga_g", text, err);
    e->level = levels;
    return ida_levels(option, text, levels, &e->n_levels, err);
}

typedef struct {
    EvaluationsTold told; /* first: what tell gets */
    double began_s, told_s;
} Progress;

/* A line in place of the one before, four times a second. */
static void tell(size_t n_done, void *user)
{
    Progress *p = user;
    const double now = clock_seconds(), n = (double)n_done, all = (double)p->told.n_all;
    if (n_done <= 1 || p->began_s == 0)
        p->began_s = now;
    if (n_done == p->told.n_all && p->told_s > 0)
        fprintf(stderr, "\r%60s\r", "");
    else if (now - p->began_s > 1 && now - p->told_s > 0.25) {
        fprintf(stderr, "\r%zu of %.0f simulations, %.0f s left ", n_done, all, (now - p->began_s) * (all - n) / n);
        fflush(stderr);
        p->told_s = now;
    }
}

/* e: its intensities are known. */
static Status run_and_give(const Args *args, Settings *s, Chosen *c, Evaluations *e, Err *err)
{
    Progress p = {.told.tell = isatty(STDERR_FILENO) ? tell : NULL};
    const char *limits = args_value(args, "--fragility"), *hazard = args_value(args, "--hazard");
    /* 1. Which limits, how many replicates. */
    if (hazard && !limits)
        return misused(err, "--hazard needs --fragility, which names the limits");
    e->has_links = limits != NULL;
    TRY(limits ? fragilities_read(&c->fragilities, c->schema, limits, hazard, e->intensity, s, err) : STATUS_OK);
    TRY(settings_check(s, err));
    if (e->level && s->sim.replicates > 1 && args_gives(args, "sim.replicates"))
        return misused(err, "sim.replicates = %ld is ignored: every intensity is simulated once", s->sim.replicates);
    e->replicates = !e->level && s->sim.replicates > 1 ? s->sim.replicates : 0;
    if (!e->level) /* for the verdict; CSV has the numbers of JSON */
        s->sim.forces = FORCES_YES;
    /* 2. Every record is read before anything is simulated. */
    TRY(add_records(args, e, s, c->run, err));
    TRY(evaluations_read(e, s, err));
    if (e->n_read == 0) {
        Document why = {0};
        say_refused(&why, e);
        document_print(&why, stderr, 0);
        return bad_data(err, "%s: holds no ground motion that can be read", args_value(args, "--record"));
    }
    /* 3. What the run knows of a design that cannot be predicted stands where it is more than was found now. */
    TRY(evaluations_run(e, c->schema->n_var, c->x, &p.told, err));
    for (size_t i = 0; i < e->n_records * e->n_levels; i++)
        if (e->run[i].error_known)
            known_raise(c->known, &e->run[i].result[SCENE_IMPACT], e->run[i].sd);
    return give(args, c, s, e, err);
}

static Status evaluate(const Args *args, Settings *s, Chosen *c, Err *err)
{
    double levels[IDA_LEVELS_MAX];
    Evaluations e = {.duration_s = s->sim.duration_s};
    TRY(take_intensities(args, s, levels, &e, err));
    const Status status = run_and_give(args, s, c, &e, err);
    evaluations_free(&e);
    fragilities_free(&c->fragilities);
    return status;
}

static Status is_no_tower(Err *err)
{
    return bad_data(err, "problem.kind is not tower: it has no ground motion");
}

/* word: of the run's designs, or one from elsewhere. */
static Status evaluate_of_run(const Args *args, Settings *s, const Run *run, const char *word, Err *err)
{
    size_t row;
    Designs other;
    TRY(design_of_run(run, word, &row, &other, err));
    Chosen c = {.run = run, .schema = &run->schema, .x = other.x, .word = word};
    if (row < run->table.n) {
        c.row = row;
        c.id = run->table.row[row].id;
        c.x = run_x(run, row);
        run_steps(run, row, &s->sim);
        known_of_run(run, row, c.known);
    }
    const Status status = s->problem.kind == PROBLEM_TOWER ? evaluate(args, s, &c, err) : is_no_tower(err);
    design_free(&other);
    return status;
}

static Status evaluate_by_config(const Args *args, Settings *s, const char *word, Err *err)
{
    DesignSpace space;
    Schema schema;
    Designs d;
    Chosen c = {.schema = &schema, .word = word};
    TRY(tower_space(s, &space, err));
    TRY(designs_take_one(&d, word, &space, s, !args_gives(args, "sim.accuracy"), c.known, err));
    Status status = schema_of(&schema, s, space.n_floors, err);
    if (status == STATUS_OK) {
        c.x = d.x;
        status = evaluate(args, s, &c, err);
        schema_free(&schema);
    }
    design_free(&d);
    return status;
}

/* run NULL: the operand is a CONFIG, else the settings are of that run. */
static Status evaluate_with(const Args *args, Settings *s, const Run *run, Err *err)
{
    const char *given = args_value(args, "--design"), *word = given || !run ? given : "knee";
    TRY(run ? args_apply(args, s, NULL, NULL, err) : args_settings(args, s, NULL, NULL, err));
    if (s->problem.kind != PROBLEM_TOWER && !run)
        return is_no_tower(err);
    if (args_has(args, "--full-model"))
        return show_full_model(args, s, run, err);
    if (!word)
        return misused(err, "--design FILE is missing: which design of %s", args->operand);
    return run ? evaluate_of_run(args, s, run, word, err) : evaluate_by_config(args, s, word, err);
}

static Status run(const Args *args, Err *err)
{
    Settings s;
    Run r = {0};
    TRY(args_alone(args, "--counts",
                   "--design --record --pga --sa --fragility --set --csv --pelicun --full-model --replicates", err));
    if (args_has(args, "--counts") == !!args->operand)
        return misused(err, "imtet evaluate takes a CONFIG, a RUN or --counts; for example: %s", CMD_EVALUATE.example);
    if (!args->operand) { /* of simulations that others have made */
        Fragilities f = {0};
        Document d = {.drawing = "fragility", .width = 430};
        Status status = counts_read(&f, args_value(args, "--counts"), args_value(args, "--hazard"), err);
        if (status == STATUS_OK) {
            const Evaluations e = {.intensity = f.intensity, .n_levels = f.n_levels, .level = f.level};
            d.data = json_of("ida=%p", json_pack("{so}", f.intensity, json_numbers(f.n_levels, f.level)));
            document_fragilities(&d, &f, &e);
            status = document_give(&d, args, err);
        }
        fragilities_free(&f);
        return status;
    }
    if (!run_is_there(args->operand))
        return evaluate_with(args, &s, NULL, err);
    TRY(run_read(&r, args->operand, err));
    s = *r.settings;
    const Status status = evaluate_with(args, &s, &r, err);
    run_free(&r);
    return status;
}

const Command CMD_EVALUATE = {
    .name = "evaluate",
    .group = GROUP_DECIDE,
    .operand = "[CONFIG|RUN]",
    .summary = "one design on other earthquakes, or on the full model of the building",
    .example = "imtet evaluate results/quick --design knee --record builtin:elcentro-like",
    .details =

        "Simulates one design (default: the knee) under each record (default: the run's own). For comparison\n"
        "it simulates the rigidly connected core and the building without a core. Files of a folder that\n"
        "cannot be read are listed with the reason. Peak, stretch, replicates and all else are the run's\n"
        "unless an option says otherwise; each record is judged alone.\n\n"
        "--pga 0.05:0.05:0.6 or --sa makes an incremental dynamic analysis, without replicates. --fragility\n"
        "fits lognormal curves to it by maximum likelihood and adds viscous links (docs/risk.md). --hazard\n"
        "adds the expected annual loss of every scene as a share of a new building.\n\n"
        "--full-model simulates designs twice: on the building as the settings reduce it (building.modes;\n"
        "default: the floors alone) and on all degrees of freedom of its frame, with contacts at the floors\n"
        "and all modes (106 for the built-in tower). Shares by mode are assigned by shape. --json then has\n"
        "the objects reduced and full with the keys of `simulate --json`, and error: reduced / full - 1;\n"
        "several designs or records make a list.",
    .options =
        {
            VALUE("--design", "ID", DESIGN_OF_RUN "; with --full-model also none: the building alone"),
            VALUES("--record", "FILE", "a ground motion, or all of a folder or list, sorted; may be repeated"),
            VALUE("--pga", "G", "scale every record to this peak [g]; FROM:STEP:TO: incremental dynamic analysis"),
            VALUE("--sa", "G",
                  "scale to this Sa (5 %) at the building's first period or motion.sa_period_s [g]; FROM:STEP:TO as "
                  "above"),
            VALUE("--fragility", "LIST",
                  "with FROM:STEP:TO: probability of exceeding drift_ratio=0.02,j3_g=5 by intensity; limits: those of "
                  "the run"),
            VALUE("--counts", "FILE",
                  "fragility by a CSV of intensity (such as sa_g), exceeded and of, without a design"),
            VALUE("--hazard", "FILE",
                  "CSV of sa_g (or pga_g) and rate_per_year: adds yearly rates of exceedance and the annual loss"),
            OPTION_UNIT,
            OPTION_TEXT,
            OPTION_SET,
            SETTING("--threads", "N", "search.threads", "number of threads; 0: one per processor"),
            SETTING("--replicates", "N", "sim.replicates",
                    "replicates of the design under each record: mean and standard deviation; default: as the run's"),
            OPTION_JSON,
            VALUE("--csv", "FILE", "a row per record, intensity and scene as CSV into FILE; -: standard output"),
            VALUE("--pelicun", "FILE",
                  "peaks of every floor, a row per record: demand CSV of pelicun, or of EE-UQ if named response.csv"),
            VALUE("--svg", "FILE",
                  "with FROM:STEP:TO, by Chromium: response (16 %, median, 84 %) against intensity, or fragilities"),
            SWITCH("--full-model", "simulate all degrees of freedom of the building's frame too"),
        },
    .run = run,
};
