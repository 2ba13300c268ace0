#include <unistd.h>

#include "base/clock.h"
#include "analysis/evaluations.h"
#include "base/figure.h"
#include "base/json.h"
#include "base/list.h"
#include "cmd/commands.h"
#include "cmd/demands.h"
#include "cmd/designs.h"
#include "cmd/fragilities.h"
#include "cmd/full_model.h"
#include "cmd/outputs.h"
#include "cmd/show.h"
#include "motion/motion_scale.h"
#include "motion/suite.h"
#include "report/panels.h"
#include "report/pictures.h"
#include "settings/settings.h"
#include "store/run_read.h"

/* A design of a run, or one from elsewhere, under the settings of the run or of a settings file. */
typedef struct {
    const Run *run; /* NULL: of a settings file */
    const Schema *schema;
    long id; /* in the run; 0: none */
    const double *x;
    const char *word; /* as it was asked for */
    Known known[N_MEASURES];
    Fragilities fragilities; /* without limits where none are asked for */
} Chosen;

/* ---- an incremental dynamic analysis: its first objectives, median, 16 % and 84 % -------------------------------- */

enum { IDA_SHOWN = 3 }; /* objectives; of the cases those without a device */
static const char *const IDA_FRACTILE_WORD[IDA_FRACTILES] = {"16 %", "median", "84 %"};

static int is_spectral(const Evaluations *e)
{
    return e->level && strcmp(e->intensity, "sa_g") == 0;
}

static void ida_print(const Evaluations *e, const MeasureOrder *order)
{
    for (SceneKind c = 0; c < N_SCENES; c++) {
        if (case_has_device(c))
            continue;
        json_t *table = json_array();
        printf(e->n_read == 1 ? "%s, %zu record\n" : "%s, %zu records: median (16 %% to 84 %%)\n", SCENES[c].words,
               e->n_read);
        for (size_t l = 0; l < e->n_levels; l++) {
            json_t *row = figures_row(table);
            json_object_set_new(row, e->intensity, json_number(e->level[l]));
            for (int i = 0; i < MIN_OF(order->n_obj, IDA_SHOWN); i++)
                put_fractiles(row, measures_name(order, order->of[i]), e, l, c, order->of[i], 1);
        }
        figures_print(table);
        putchar('\n');
    }
}

static json_t *json_fractiles(const Evaluations *e, SceneKind which, double p)
{
    json_t *o = json_object();
    for (int k = 0; k < MEASURES_LISTED; k++) {
        json_t *list = json_array();
        for (size_t l = 0; l < e->n_levels; l++)
            json_array_append_new(list, json_number(ida_fractile(e, l, which, k, p)));
        json_object_set_new(o, measure(k)->name, list);
    }
    return o;
}

static json_t *ida_json(const Evaluations *e)
{
    static const char *const KEYS[IDA_FRACTILES] = {"fractile_16", "median", "fractile_84"};
    json_t *o = json_object();
    json_object_set_new(o, e->intensity, json_numbers(e->n_levels, e->level));
    for (SceneKind c = 0; c < N_SCENES; c++) {
        if (case_has_device(c))
            continue;
        json_t *one = json_object();
        for (int i = 0; i < IDA_FRACTILES; i++)
            json_object_set_new(one, KEYS[i], json_fractiles(e, c, IDA_FRACTILE[i]));
        json_object_set_new(o, SCENES[c].key, one);
    }
    return o;
}

/* Intensity over measure k, of record r (fractile < 0) or of a fractile of a case. */
static json_t *ida_line(const Evaluations *e, int k, size_t r, SceneKind which, int fractile)
{
    double x[IDA_LEVELS_MAX];
    for (size_t l = 0; l < e->n_levels; l++)
        x[l] = fractile < 0 ? ida_value(&e->run[r * e->n_levels + l], which, k)
                            : ida_fractile(e, l, which, k, IDA_FRACTILE[fractile]);
    json_t *line =
        curve(e->n_levels, x, e->level, fractile < 0 ? "#b8c8d8" : CASE_LOOK[which].colour, fractile == 1 ? 2.5 : 1.2);
    return fractile == 0 || fractile == 2 ? dashed(line) : line;
}

/* A panel for each of the first objectives: the records pale, the fractiles of every case over them. */
static Status ida_draw(const Evaluations *e, const MeasureOrder *order, const char *path, Err *err)
{
    json_t *columns = json_array(), *names = json_array();
    char text[160];
    for (int k = 0; k < MIN_OF(order->n_obj, IDA_SHOWN); k++) {
        const Measure *of = measure(order->of[k]);
        json_t *lines = json_array();
        for (size_t r = 0; r < e->n_records; r++)
            if (e->record[r].readable == STATUS_OK)
                json_array_append_new(lines, ida_line(e, order->of[k], r, SCENE_IMPACT, -1));
        for (SceneKind c = 0; c < N_SCENES; c++)
            for (int i = 0; i < IDA_FRACTILES && !case_has_device(c); i++)
                json_array_append_new(lines, ida_line(e, order->of[k], 0, c, i));
        snprintf(text, sizeof text, "%s [%s]", of->what, of->unit);
        json_t *x = json_of("label=%s zero=%c ticks=%d", text, 1, 5);
        json_array_append_new(columns, json_pack("[o]", panel("", x, intensity_axis(e), lines)));
    }
    for (SceneKind c = 0; c < N_SCENES; c++) {
        if (case_has_device(c))
            continue;
        snprintf(text, sizeof text, "%s: median, 16 and 84 %%", SCENES[c].words);
        json_array_append_new(names, name_of(text, CASE_LOOK[c].colour, "\u25a0"));
    }
    return drawing_save(drawing("", names, 440, columns), 1300, path, err);
}

/* ---- results ----------------------------------------------------------------------------------------------------- */

static double level_of(const Evaluations *e, const EvaluatedRun *run)
{
    return e->level[(size_t)(run - e->run) % e->n_levels];
}

static json_t *describe(const Evaluations *e, const EvaluatedRun *run)
{
    const MeasureOrder *order = tower_measures(tower_of(&e->tower));
    json_t *o =
        json_of("record=%s pga_g=%g scale=%g stretch=%g", run->record->path, run->pga_g, run->scale, run->stretch);
    if (is_spectral(e))
        json_put(o, "sa_g=%g", level_of(e, run));
    for (SceneKind c = 0; c < N_SCENES; c++)
        if (evaluated_has(e, run, c))
            json_object_set_new(o, SCENES[c].key,
                                put_device(json_result(order, c, &run->result[c]), c, &run->device[c]));
    if (run->error_known)
        put_errors(json_object_get(o, SCENES[SCENE_IMPACT].key), run->error, run->sd);
    if (e->replicates > 0)
        json_put(o, "replicates=%p", json_replicates(order, &run->replicates));
    return o;
}

static Status show_as_json(const Args *args, const Chosen *c, const Evaluations *e, Err *err)
{
    json_t *all = json_object(), *records = json_array(), *unreadable = json_array();
    for (size_t i = 0; i < e->n_records * e->n_levels; i++)
        if (e->run[i].record->readable == STATUS_OK)
            json_array_append_new(records, describe(e, &e->run[i]));
    for (size_t i = 0; i < e->n_records; i++)
        if (e->record[i].readable != STATUS_OK)
            json_array_append_new(unreadable, json_of("record=%s reason=%s", e->record[i].path, e->record[i].why.text));
    json_put(all, "run=%s design=%p variables_m=%p records=%p unreadable=%p", args->operand,
             c->id > 0 ? json_integer(c->id) : json_words(c->word), json_numbers(c->schema->n_var, c->x), records,
             unreadable);
    if (e->level)
        json_put(all, "ida=%p", ida_json(e));
    if (c->fragilities.limits.n > 0)
        json_put(all, "fragility=%p", fragilities_json(&c->fragilities, e));
    if (c->fragilities.hazard)
        json_put(all, "annual_loss=%p", annual_losses(&c->fragilities, e, 0));
    return show_json(all, err);
}

/* Who it is of, then the motion: spectral acceleration, where that is the intensity, peak, scale, stretch. */
static json_t *begin_row(json_t *table, const Evaluations *e, const char *record, SceneKind which, const char *outcome,
                         const double motion[4])
{
    static const char *const KEYS[] = {"sa_g", "pga_g", "scale", "stretch"};
    json_t *row = json_put(figures_row(table), "record=%s scene=%s outcome=%s", record, SCENES[which].key, outcome);
    for (int i = !is_spectral(e); i < 4; i++)
        json_object_set_new(row, KEYS[i], json_number(motion[i]));
    return row;
}

static void add_rows(json_t *table, const Evaluations *e, size_t i)
{
    const EvaluatedRun *run = &e->run[i];
    const MeasureOrder *order = tower_measures(tower_of(&e->tower));
    for (SceneKind c = 0; c < N_SCENES; c++) {
        if (run->record->readable != STATUS_OK || !evaluated_has(e, run, c))
            continue;
        const Measured m = measured(&run->result[c]);
        const double level = e->level ? level_of(e, run) : NAN;
        const double motion[] = {level, e->level && !is_spectral(e) ? level : run->pga_g, run->scale, run->stretch};
        json_t *row = begin_row(table, e, run->record->path, c, outcome_word((Outcome)m.outcome), motion);
        put_measures(row, order, "", m.outcome == RUN_OK ? m.value : NULL, NULL, NULL);
        if (e->replicates > 0)
            put_replicates(row, order, c == SCENE_IMPACT ? &run->replicates : NULL);
    }
}

static void add_fractiles(json_t *table, const Evaluations *e, size_t level, SceneKind which)
{
    double values[N_MEASURES];
    const double at = e->level[level], motion[] = {at, is_spectral(e) ? NAN : at, NAN, NAN};
    for (int i = 0; i < IDA_FRACTILES; i++) {
        for (int k = 0; k < N_MEASURES; k++)
            values[k] = ida_fractile(e, level, which, k, IDA_FRACTILE[i]);
        put_measures(begin_row(table, e, IDA_FRACTILE_WORD[i], which, "", motion), NULL, "", values, NULL, NULL);
    }
}

static Status write_csv(const Evaluations *e, const char *path, Err *err)
{
    json_t *table = json_array();
    for (size_t i = 0; i < e->n_records * e->n_levels; i++)
        add_rows(table, e, i);
    for (size_t l = 0; e->level && l < e->n_levels; l++)
        for (SceneKind c = 0; c < N_SCENES; c++)
            if (!case_has_device(c))
                add_fractiles(table, e, l, c);
    return figures_csv(table, path, err);
}

/* ---- for people -------------------------------------------------------------------------------------------------- */

static void print_motion(const Evaluations *e, size_t i)
{
    Motion m;
    if (tower_motion(&e->tower, i, &m, &(Err){0}) == STATUS_OK) {
        show_motion(stdout, &m, e->duration_s);
        motion_free(&m);
    }
}

/* name: of the record, empty where there is one. With the device that was found for it. */
static void add_case(json_t *table, const char *name, const MeasureOrder *order, const EvaluatedRun *run, SceneKind c)
{
    char label[400], words[CASE_TEXT_MAX];
    snprintf(label, sizeof label, "%s%s%s", name, *name ? "  " : "", case_text(c, &run->device[c], words));
    const int is_known = c == SCENE_IMPACT && run->error_known;
    figures_result(table, label, order, &run->result[c], is_known ? run->error : NULL, is_known ? run->sd : NULL);
    if (c == SCENE_IMPACT && run->replicates.n_replicates > 0)
        figures_replicates(table, order, &run->replicates, is_known ? run->error : NULL);
}

/* In one table, the motions of those that were named above it. */
static void print_records(const Evaluations *e, const MeasureOrder *order)
{
    json_t *table = json_array();
    for (size_t i = 0; i < e->n_records; i++) {
        if (e->record[i].readable != STATUS_OK)
            continue;
        if (!e->record[i].from_folder)
            print_motion(e, i);
        for (SceneKind c = 0; c < N_SCENES; c++)
            if (evaluated_has(e, &e->run[i], c))
                add_case(table, e->n_records > 1 ? evaluated_name(&e->record[i]) : "", order, &e->run[i], c);
    }
    if (e->replicates > 0)
        puts("replicates are of the design with impacts; the other lines are as designed");
    figures_print(table);
}

static void print_refused(FILE *out, const Evaluations *e)
{
    size_t n = 0;
    for (size_t i = 0; i < e->n_records; i++)
        if (e->record[i].readable != STATUS_OK)
            fprintf(out, "%snot read: %s\n", n++ ? "" : "\n", e->record[i].why.text);
}

static void print_all(const Args *args, const Chosen *c, const Evaluations *e)
{
    const MeasureOrder *order = &c->schema->order;
    if (c->id > 0)
        printf("design %ld of %s\n\n", c->id, args->operand);
    else
        printf("design %s by the settings of %s\n\n", c->word, args->operand);
    if (c->fragilities.limits.n > 0)
        figures_print(fragilities_table(&c->fragilities, e));
    else if (e->level)
        ida_print(e, order);
    else
        print_records(e, order);
    if (c->fragilities.hazard) {
        putchar('\n');
        figures_print(annual_losses(&c->fragilities, e, 1));
    }
    print_refused(stdout, e);
}

/* All that is asked for; the tables where nothing is, those of fragilities wherever standard output is free. */
static Status give(const Args *args, const Chosen *c, const Evaluations *e, Err *err)
{
    if (args_has(args, "--csv"))
        TRY(write_csv(e, args_value(args, "--csv"), err));
    const char *svg = args_value(args, "--svg");
    if (svg && c->fragilities.limits.n > 0)
        TRY(fragilities_draw(&c->fragilities, e, svg, err));
    else if (svg)
        TRY(ida_draw(e, &c->schema->order, svg, err));
    if (args_has(args, "--pelicun"))
        TRY(demands_write(e, args_value(args, "--pelicun"), err));
    if (args_has(args, "--json"))
        return show_as_json(args, c, e, err);
    if (c->fragilities.limits.n > 0 ? !outputs_standard(args, 0)
                                    : !args_has(args, "--csv") && !svg && !args_has(args, "--pelicun"))
        print_all(args, c, e);
    return STATUS_OK;
}

/* ---- what is evaluated ------------------------------------------------------------------------------------------- */

static Status add_one(const char *source, void *user, Err *err)
{
    return evaluations_add(user, source, 0, err);
}

/* The run's own, where they are now. */
static Status add_own(Evaluations *e, const Settings *s, const Run *run, Err *err)
{
    TRY(record_paths_check(s, run, err));
    return suite_of_study(&s->motion, add_one, e, err);
}

static Status add_records(const Args *args, Evaluations *e, const Settings *s, const Run *run, Err *err)
{
    const char *path;
    if (!args_has(args, "--record"))
        return add_own(e, s, run, err);
    for (int i = 0; (path = args_next(args, "--record", &i));)
        TRY(evaluations_add_suite(e, path, err));
    return STATUS_OK;
}

/* The period of --sa is the building's first, unless another is set. */
static Status take_period(const Args *args, Settings *s, Err *err)
{
    Building b;
    if (args_gives(args, "motion.sa_period_s"))
        return STATUS_OK;
    TRY(building_load(&b, &s->building, err));
    s->motion.sa_period_s = 2 * M_PI / b.omega[0];
    building_free(&b);
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
        return misused(err, "--svg draws an incremental dynamic analysis: --pga FROM:STEP:TO, or --sa");
    if (args_has(args, "--pelicun") && is_range)
        return misused(err, "--pelicun is a file of one intensity: %s G", option);
    if (args_has(args, "--fragility") && !is_range)
        return misused(err, "--fragility wants intensities: --sa FROM:STEP:TO, or --pga");
    for (size_t i = 0; (sa || is_range) && i < N_OF(OTHERS); i++)
        if (args_gives(args, OTHERS[i]))
            return misused(err, "%s %.60s scales every record; %s does not go with it", option, text, OTHERS[i]);
    if (sa || is_range)
        motion_unscale(&s->motion);
    if (sa)
        TRY(take_period(args, s, err));
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

static Status run_and_give(const Args *args, Settings *s, const Chosen *c, Evaluations *e, Err *err)
{
    Progress p = {.told.tell = isatty(STDERR_FILENO) ? tell : NULL};
    TRY(add_records(args, e, s, c->run, err));
    TRY(evaluations_read(e, s, err));
    if (e->n_read == 0) {
        print_refused(stderr, e);
        return bad_data(err, "%s: holds no ground motion that can be read", args_value(args, "--record"));
    }
    TRY(evaluations_run(e, c->schema->n_var, c->x, &p.told, err));
    for (size_t i = 0; i < e->n_records * e->n_levels; i++)
        if (e->run[i].error_known)
            known_raise(c->known, &e->run[i].result[SCENE_IMPACT], e->run[i].sd);
    return give(args, c, e, err);
}

static Status take_fragilities(const Args *args, Settings *s, Chosen *c, Evaluations *e, Err *err)
{
    const char *limits = args_value(args, "--fragility"), *hazard = args_value(args, "--hazard");
    if (hazard && !limits)
        return misused(err, "--hazard is how often intensities come; --fragility says for which limits");
    e->has_links = limits != NULL;
    return limits ? fragilities_read(&c->fragilities, c->schema, limits, hazard, e->intensity, s, err) : STATUS_OK;
}

static Status take_and_run(const Args *args, Settings *s, Chosen *c, Evaluations *e, Err *err)
{
    TRY(take_fragilities(args, s, c, e, err));
    TRY(settings_check(s, err));
    if (e->level && s->sim.replicates > 1 && args_gives(args, "sim.replicates"))
        return misused(err, "sim.replicates = %ld: every intensity is shown once, without replicates",
                       s->sim.replicates);
    e->replicates = !e->level && s->sim.replicates > 1 ? s->sim.replicates : 0;
    return run_and_give(args, s, c, e, err);
}

static Status evaluate(const Args *args, Settings *s, Chosen *c, Err *err)
{
    double levels[IDA_LEVELS_MAX];
    Evaluations e = {.duration_s = s->sim.duration_s};
    TRY(take_intensities(args, s, levels, &e, err));
    const Status status = take_and_run(args, s, c, &e, err);
    evaluations_free(&e);
    fragilities_free(&c->fragilities);
    return status;
}

static Status is_no_tower(Err *err)
{
    return bad_data(err, "problem.kind: is no tower but another problem: no ground motion applies");
}

/* word: of the run's designs, or one from elsewhere. */
static Status evaluate_of_run(const Args *args, Settings *s, const Run *run, const char *word, Err *err)
{
    size_t row;
    Designs other;
    TRY(design_of_run(run, word, &row, &other, err));
    Chosen c = {.run = run, .schema = &run->schema, .x = other.x, .word = word};
    if (row < run->table.n) {
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
    if (!run_is_there(args->operand))
        return evaluate_with(args, &s, NULL, err);
    TRY(run_read(&r, args->operand, err));
    s = *r.settings;
    const Status status = evaluate_with(args, &s, &r, err);
    run_free(&r);
    return status;
}

static const ArgOption OPTIONS[] = {
    VALUE("--design", "ID", DESIGN_OF_RUN "; with --full-model also none: the building alone"),
    VALUES("--record", "FILE", "ground motion, or every one of a folder or list, sorted; may be repeated"),
    OPTION_CHANNEL,
    VALUE("--pga", "G",
          "scaled to this peak; FROM:STEP:TO: incremental dynamic analysis, every record at each of these"),
    VALUE("--sa", "G",
          "scaled to this spectral acceleration (5 %) at the building's first period, or motion.sa_period_s; "
          "FROM:STEP:TO as above"),
    VALUE("--fragility", "LIST",
          "of such a range: probability of exceeding drift_ratio=0.02,j3_g=5 by intensity (limits: the run's)"),
    VALUE("--hazard", "FILE",
          "CSV of sa_g (or pga_g) and rate_per_year: adds yearly rates of exceedance and the annual loss"),
    OPTION_UNIT,
    OPTION_TEXT,
    OPTION_SET,
    SETTING("--threads", "N", "search.threads", "0: one per processor"),
    SETTING(
        "--replicates", "N", "sim.replicates",
        "N replicates of the design under each record: mean and standard deviation, named; as the run's if not given"),
    OPTION_JSON,
    VALUE("--csv", "FILE", "a row per record, intensity and scene as CSV into FILE; -: standard output"),
    VALUE("--pelicun", "FILE",
          "peaks of every floor, a row per record: demand CSV of pelicun; named response.csv: of EE-UQ"),
    VALUE("--svg", "FILE",
          "of FROM:STEP:TO, drawn by Chromium: response against intensity with 16 %, median and 84 %, or fragilities"),
    SWITCH("--full-model", "on all degrees of freedom of the building's frame, beside the reduced model"),
    OPTION_END,
};

const Command CMD_EVALUATE = {
    .name = "evaluate",
    .group = GROUP_DECIDE,
    .operand = "CONFIG|RUN",
    .summary = "one design on other earthquakes, or on the full model of the building",
    .example = "imtet evaluate results/quick --design knee --record builtin:elcentro-like",
    .details =

        "Simulates one design, the knee if --design is not given, under each record (default: the run's own).\n"
        "The rigidly connected core and the building without a core are simulated for comparison. Files of a\n"
        "folder that cannot be read are listed with the reason. Peak, stretch, replicates and all else are\n"
        "the run's unless an option says otherwise; each record stands alone.\n"
        "--pga 0.05:0.05:0.6 or --sa makes an incremental dynamic analysis, without replicates. --fragility\n"
        "fits lognormal curves to it by maximum likelihood and adds viscous links (docs/risk.md). --hazard\n"
        "adds the expected annual loss of every scene as a share of a new building.\n"
        "--full-model simulates designs twice: on the building as the settings reduce it (building.modes;\n"
        "default: the floors alone) and on all degrees of freedom of its frame, with contacts at the floors\n"
        "and all modes (106 for the built-in tower). Shares by mode are assigned by shape. --json then has\n"
        "the objects reduced and full with the keys of `simulate --json`, and error: reduced / full - 1;\n"
        "several designs or records make a list.",
    .options = OPTIONS,
    .run = run,
};
