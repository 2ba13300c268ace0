#include "analysis/ladder.h"
#include "base/json.h"
#include "base/text.h"
#include "base/units.h"
#include "cmd/asked.h"
#include "cmd/commands.h"
#include "cmd/designs.h"
#include "cmd/selftest.h"
#include "cmd/show.h"
#include "moga/constants.h"
#include "motion/motion_scale.h"
#include "motion/suite.h"
#include "motion/motion.h"
#include "scene/frame.h"
#include "settings/settings.h"
#include "store/tables.h"
#include "evaluate/adapter.h"
#include "evaluate/limits.h"
#include "evaluate/race.h"
#include "evaluate/tower.h"
#include "scene/neighbour.h"
#include "study/named.h"

typedef struct {
    const Args *args;
    int as_json;
    json_t *out, *faults, *warnings;
    Status fatal; /* no fault of the configuration: nothing more can be said about it */
} Check;

enum { TRIED_MAX = 5 };

/* The scene that a tower's configuration makes. */
typedef struct {
    const Settings *s;
    Building building;
    Motion motion;
    double recorded_g; /* its peak before scaling */
    DesignSpace space;
    size_t n_tried; /* designs */
    double tried[TRIED_MAX][DESIGN_VARIABLES_MAX];
    const double *x; /* the one of them that stands for the others */
    long impacts;    /* of it */
    Design design;   /* the first */
    SceneSummary summary;
} CheckedScene;

/* ---- findings ------------------------------------------------------------------------------------------------- */

/* One that was found before is not said again, also where it was found in a line of the file. */
static void fault(Check *c, const char *text)
{
    size_t i;
    json_t *known;
    json_array_foreach(c->faults, i, known)
    {
        const size_t n = json_string_length(known), own = strlen(text);
        if (own <= n && strcmp(json_string_value(known) + n - own, text) == 0)
            return;
    }
    json_array_append_new(c->faults, json_string(text));
}

/* Takes a fault; 1: there is none. key: of a message that does not begin with "section.key:". */
static int note(Check *c, Status status, const char *key, const Err *e)
{
    Err placed = *e;
    const char *known;
    int has_key = 0;
    if (status == STATUS_OK)
        return 1;
    for (int i = 0; !has_key && (known = settings_key(i)); i++)
        has_key = strncmp(e->text, known, strlen(known)) == 0 && e->text[strlen(known)] == ':';
    if (!has_key)
        fail(&placed, status, "%s: %s", key, e->text);
    args_place(c->args, &placed);
    fault(c, placed.text);
    c->fatal = status == STATUS_NO_MEMORY ? status : c->fatal;
    return 0;
}

static void warn(const char *key, const char *text, void *user)
{
    Check *c = user;
    json_array_append_new(c->warnings, json_of("key=%s text=%s", key, text));
}

/* Every fault of the settings file is a line of its own. */
static Status read_settings(const Args *args, Check *c, Settings *s, Err *err)
{
    char *lines = NULL, *line;
    size_t length = 0;
    int n = 0;
    FILE *f = text_open(&lines, &length);
    if (!f)
        return fail_memory(err, 1, "faults");
    Status status = args_settings(args, s, f, &n, err);
    if (text_close(f) != 0)
        status = fail_memory(err, 1, "faults");
    else if (n > 0) /* else they could not be read */
        status = STATUS_OK;
    for (char *rest = lines; status == STATUS_OK && (line = strsep(&rest, "\n"));)
        if (*line)
            fault(c, line);
    free(lines);
    return status;
}

/* ---- building, core, motion ----------------------------------------------------------------------------------- */

/* Those of the box, or the first ones of --design. */
static int choose_designs(Check *c, CheckedScene *p, const char *path)
{
    Err e = {0};
    DesignSpace *s = &p->space;
    if (!note(c, design_space_make(s, &p->s->design, core_section(&p->s->core), p->building.n, &e), "design", &e))
        return 0;
    p->n_tried = TRIED_MAX;
    for (size_t k = 0; k < TRIED_MAX; k++)
        design_spread(s, &p->s->design, k, TRIED_MAX, INFINITY, p->tried[k]);
    p->x = p->tried[0];
    if (!path)
        return 1;
    Designs d;
    if (!note(c, designs_take(&d, path, s, NULL, 0, NULL, &e), "--design", &e))
        return 0;
    p->n_tried = MIN_OF(d.n, (size_t)TRIED_MAX);
    for (size_t i = 0; i < p->n_tried; i++)
        memcpy(p->tried[i], d.x + i * s->n_var, s->n_var * sizeof *d.x);
    warn_of_designs(&d, path, warn, c);
    design_free(&d);
    return 1;
}

/* Is there room for a core that is wider than a share of the building, of a plane frame's width, else of its height,
 * for then its plan is not known? */
static void ask_about_plan(Check *c, const CheckedScene *p)
{
    static const double SHARE_MAX = 0.4;
    const BuildingOptions *b = &p->s->building;
    const double side = p->design.side > 0 ? p->design.side : p->s->core.width_m;
    double least = INFINITY, most = -INFINITY;
    char text[160];
    Frame f = {0};
    if (frame_is(b->model) && frame_read(&f, b, &(Err){0}) == STATUS_OK)
        for (int i = 0; i < f.n[FRAME_NODES]; i++) {
            least = fmin(least, f.node[i].x);
            most = fmax(most, f.node[i].x);
        }
    frame_free(&f);
    const double width = most > least ? most - least : p->summary.height_m;
    if (core_section(&p->s->core) == CORE_EFFECTIVE || !(side > SHARE_MAX * width))
        return;
    snprintf(text, sizeof text, "%.4g m is %.0f %% of the building's %s of %.4g m: is there room for such a core?",
             side, 100 * side / width, most > least ? "width" : "height (its plan is not known)", width);
    warn("core.width_m", text, c);
}

/* What the scene is, and what is implausible in it. */
static int summarise(Check *c, CheckedScene *p)
{
    Err e = {0};
    CoreOptions core = p->s->core;
    design_of(&p->space, p->x, &p->design);
    if (p->design.side > 0)
        core.width_m = p->design.side;
    const Status status = scene_summarise(&p->summary, &p->building, &core, &p->s->building, &p->motion,
                                          p->design.t_base, p->design.t_top, &e);
    if (!note(c, status, "core", &e))
        return 0;
    scene_warnings(&p->summary, &p->s->core, &p->s->design, &p->motion, warn, c);
    ask_about_plan(c, p);
    if (!note(c, condensation_warnings(&p->building, &p->s->building, warn, c, &e), "building.model", &e))
        return 0;
    if (p->motion.warning[0])
        warn("motion.record", p->motion.warning, c);
    if (p->s->sim.duration_s > motion_duration(&p->motion) && strcmp(p->s->motion.record, "none") != 0) {
        char text[100];
        snprintf(text, sizeof text, "%g s is longer than the motion of %.4g s; the ground is at rest then",
                 p->s->sim.duration_s, motion_duration(&p->motion));
        warn("sim.duration_s", text, c);
    }
    const Settings *s = p->s;
    const SceneSummary *f = &p->summary;
    const Motion *m = &p->motion;
    size_t n_periods = 0;
    while (n_periods < 3 && f->period_s[n_periods] > 0)
        n_periods++;
    json_put(c->out, "building=%p core=%p motion=%p",
             json_of("model=%s floors=%d height_m=%g mass_kg=%g weight_n=%g floor_mass_min_kg=%g floor_mass_max_kg=%g "
                     "damping=%g period_s=%p first_mode_mass_share=%g base_shear_share=%g",
                     s->building.model, f->n_floors, f->height_m, f->mass_kg, f->mass_kg * GRAVITY,
                     f->floor_mass_min_kg, f->floor_mass_max_kg, f->damping[0], json_numbers(n_periods, f->period_s),
                     f->first_mode_mass, f->base_shear),
             json_of("foundation=%s theory=%s mass_kg=%g t_base_m=%g t_top_m=%g first_mode_hz=%g clamped_hz=%g "
                     "timoshenko_hz=%g euler_bernoulli_hz=%g modes_within_motion=%d",
                     s->core.foundation, core_word(&s->core), f->core_mass_kg, p->design.t_base, p->design.t_top,
                     f->core_hz, f->clamped_hz, f->timoshenko_hz, f->euler_bernoulli_hz, f->core_modes_within),
             json_of("record=%s samples=%ld duration_s=%g recorded_peak_g=%g peak_g=%g scale=%g stretch=%g "
                     "content_hz=%g processed=%s",
                     s->motion.record, m->n, motion_duration(m), p->recorded_g, motion_peak(m) / GRAVITY, m->scale,
                     s->motion.stretch, f->content_hz, m->processed));
    return 1;
}

/* ---- the study ------------------------------------------------------------------------------------------------ */

/* What a study does beside its simulations, for the time that it takes: per design and objective or limit, growing with
 * the root of the variables, at its surrogate and the search; and to find the devices of the baselines, by floor and
 * record. Source: processor time of `imtet-bench problem dtlz2 --max-evals 400` of 8 x 3 to 62 variables x 7
 * objectives, within 30 %, and of `imtet evaluate` of the quick study and of configs/engineer.ini. Their simulations:
 * of 16 designs for the gaps, and some with baselines; and of a design that is named 6 to 25 by their time, with more
 * steps. */
static const double SURROGATE_S = 0.9e-3, VARIABLES = 22, DEVICES_S = 0.045, YIELDING = 2;
enum { CLOSING_SIMULATIONS = 24, NAMED_SIMULATIONS = 12 };

/* [s] beside the simulations of a search, for every design that it looks at: of those that are screened one in
 * SCREENED_PER_FINISHED is simulated to its end. */
static double search_seconds(const Settings *s, const Problem *p)
{
    const size_t records = (size_t)suite_count(&s->motion);
    const double part = s->search.fidelity == FIDELITY_RECORDS ? (double)race_first(records) / (double)records
                                                               : 1.0 / (double)s->sim.replicates;
    const double each = settings_screens(s) ? part + (1 - part) / SCREENED_PER_FINISHED : 1;
    const double growth = sqrt((double)p->n_var / VARIABLES), outputs = (double)(p->n_obj + p->n_con);
    return s->search.surrogate == SURROGATE_OFF ? 0
                                                : SURROGATE_S * growth * outputs * (double)s->search.max_evals / each;
}

/* Of those that collide the one in the middle by its impacts; where none does the first. */
static size_t typical_of(size_t n, const SimResult r[])
{
    size_t colliding = 0;
    for (size_t i = 0; i < n; i++)
        colliding += r[i].impacts > 0;
    for (size_t i = 0; i < n; i++) {
        size_t fewer = 0, more = 0;
        for (size_t k = 0; k < n; k++) {
            fewer += r[k].impacts > 0 && r[k].impacts < r[i].impacts;
            more += r[k].impacts > r[i].impacts;
        }
        if (r[i].impacts > 0 && 2 * fewer <= colliding && 2 * more <= colliding)
            return i;
    }
    return 0;
}

/* The designs to try are simulated once, with forces where the core stands on ground that it may lift from; then the
 * wall times [s] of a study are known: of search and baselines beside the simulations, and of all. */
static void describe_study(Check *c, CheckedScene *p, const Problem *problem)
{
    Err e = {0};
    SimResult r[TRIED_MAX];
    SimTask task[TRIED_MAX];
    char text[NOTE_MAX];
    double seconds = 0;
    const Settings *s = p->s;
    json_t *impacts = json_array();
    for (size_t i = 0; i < p->n_tried; i++)
        task[i] = (SimTask){.kind = SCENE_IMPACT, .x = p->tried[i]};
    if (!note(c, tower_simulate(problem, p->n_tried, task, r, &e), "simulation", &e)) {
        json_decref(impacts);
        return;
    }
    for (size_t i = 0; i < p->n_tried; i++) {
        seconds += r[i].seconds / (double)p->n_tried;
        json_array_append_new(impacts, json_integer(r[i].impacts));
    }
    const size_t typical = typical_of(p->n_tried, r);
    p->x = p->tried[typical];
    p->impacts = r[typical].impacts;
    if (foundation_lifts(&r[typical]))
        warn("core.foundation", uplift_words(&r[typical], text), c);

    const long threads = (long)threads_wanted(s->search.threads), records = suite_count(&s->motion);
    const long simulations = s->search.max_evals * s->sim.replicates * records;
    const double named = named_are_known(s) ? NAMED_SIMULATIONS * (double)(problem->n_obj + 1 + NAMED_SPREAD) : 0;
    const double all =
        (double)simulations * (s->search.polish > 0 ? 1.1 : 1) + (CLOSING_SIMULATIONS + named) * (double)records;
    const double search_s = search_seconds(s, problem);
    const double baselines_s = DEVICES_S * p->building.n * (double)records * (p->building.yields ? YIELDING : 1);
    json_put(c->out, "study=%p",
             json_of("variables=%d gap_m=%p thickness_m=%p simulations=%ld threads=%ld simulation_s=%g impacts=%p "
                     "search_s=%g baselines_s=%g seconds=%g",
                     p->space.n_var, json_numbers(2, s->design.gap_m.at), json_numbers(2, s->design.thickness_m.at),
                     simulations, threads, seconds, impacts, search_s, baselines_s,
                     all * seconds / (double)threads + search_s + baselines_s));
}

/* Limits, further records and whatever else a search opens before it starts. */
static void open_study(Check *c, const Settings *s, CheckedScene *p)
{
    Err e = {0};
    Adapter *adapter;
    Settings with = *s;
    if (strcmp(s->core.foundation, "fixed") != 0)
        with.sim.forces = FORCES_YES;
    with.problem.constraints = ASKED_CONSTRAINTS(s);
    if (!note(c, adapter_open(&adapter, &with, &e), s->problem.kind == PROBLEM_TOWER ? "scene" : "problem", &e))
        return;
    const Schema *schema = adapter_schema(adapter);
    note(c, tables_have_room(schema, &e), "store", &e);
    if (s->problem.kind == PROBLEM_TOWER) {
        const char *objectives = s->search.objectives;
        const char *missing = measures_missing(&schema->order, objectives, schema->design.n_floors);
        const int has_bumpers = schema->design.n_bumpers > 0 || s->contact.bumper_stiffness_n_m > 0;
        json_t *names = json_array();
        for (size_t k = 0; k < schema->n_obj; k++)
            json_array_append_new(names, json_words(schema_objective(schema, k)->name));
        json_put(c->out, "objectives=%p", names);
        if (schema->order.objectives >> MEASURE_BUMPER_STRAIN & 1 && !has_bumpers)
            warn("search.objectives", "bumper_strain is 0 for every design: there is no bumper", c);
        if (missing && strcmp(objectives, "auto") != 0)
            warn("search.objectives", missing, c);
        else if (missing)
            json_put(c->out, "missing=%s", missing);
        if (json_array_size(c->faults) == 0)
            describe_study(c, p, adapter_problem(adapter));
    } else {
        json_put(c->out, "problem=%p", json_of("variables=%ld objectives=%ld", schema->n_var, schema->n_obj));

        /* A worker that says nothing that can be understood is a fault; what it says of the design may be of this one
         * alone. */
        Outcome outcome;
        Err why = {0};
        double each_s;
        if (s->problem.kind == PROBLEM_EXTERNAL && json_array_size(c->faults) == 0 &&
            note(c, asked_check(adapter, c->out, &each_s, &outcome, &why, &e), "problem.command", &e)) {
            const long n = s->search.max_evals, threads = (long)threads_wanted(s->search.threads);
            const double search_s = search_seconds(s, adapter_problem(adapter));
            if (outcome == OUTCOME_DEAD || outcome == OUTCOME_TIMEOUT || outcome == OUTCOME_GARBLED)
                note(c, STATUS_BAD_DATA, "problem.command", &why);
            else if (outcome != OUTCOME_OK)
                warn("problem.command", why.text, c);
            json_put(c->out, "study=%p",
                     json_of("simulations=%ld threads=%ld simulation_s=%g search_s=%g seconds=%g", n, threads, each_s,
                             search_s, (double)n * each_s / (double)threads + search_s));
        }
        note(c, tables_have_room(schema, &e), "store", &e); /* with the constraint values of its answer */
    }
    adapter_close(adapter);
}

/* ---- which effects it needs ----------------------------------------------------------------------------------- */

/* The ladder of the design that stands for the others: its gaps as a list, what else it has by name. */
static void climb(Check *c, const CheckedScene *p)
{
    Err e = {0};
    const DesignSpace *s = &p->space;
    Ladder *ladder = calloc(1, sizeof *ladder);
    const Status status = ladder ? ladder_find(p->s, p->x, LADDER_WHOLE, ladder, &e) : fail_memory(&e, 1, "a ladder");
    if (note(c, status, "--ladder", &e)) {
        json_t *design = json_of("impacts=%ld", p->impacts);
        if (s->n_gaps > 0)
            json_put(design, "gaps_m=%p", json_numbers(s->n_gaps, p->x));
        for (int j = s->n_gaps; j < s->n_var; j++) {
            char name[TABLE_NAME_MAX];
            const char *word = design_word(s, j, p->x[j]);
            design_variable_name(s, j, name);
            json_object_set_new(design, name, word ? json_string(word) : json_number(p->x[j]));
        }
        json_put(c->out, "ladder=%p", json_put(ladder_json(ladder), "design=%p", design));
    }
    if (p->impacts == 0 && !strstr(p->s->design.variables, "links") && !strstr(p->s->design.variables, "friction"))
        warn("--ladder",
             "no gap closes in any of the designs that were tried, so that the needs of core and contacts are "
             "unknown; take narrower gaps (design.gap_m), or a --design that collides",
             c);
    free(ladder);
}

static void check_tower(const Args *args, Check *c, const Settings *s)
{
    Err e = {0};
    CheckedScene p = {.s = s};
    Schema schema = {0};
    Limits limits;
    MeasureOrder order;

    /* 1. Objectives and limits by their names: a wrong one hides neither another nor what is wrong with the scene. */
    Settings any = *s;
    note(c, measures_order(&order, s->search.objectives, "none", 0, &e), "search.objectives", &e);
    snprintf(any.search.objectives, sizeof any.search.objectives, "auto");
    if (schema_of(&schema, &any, 0, &(Err){0}) == STATUS_OK)
        note(c, limits_read(&limits, &schema, s->search.limits, &e), "search.limits", &e);
    schema_free(&schema);

    /* 2. Building and motion, each with its faults. */
    const int has_building = note(c, building_load(&p.building, &s->building, &e), "building.model", &e);
    Status status = motion_open(&p.motion, &s->motion, &e);
    if (status == STATUS_OK) {
        p.recorded_g = motion_peak(&p.motion) / GRAVITY;
        status = motion_scale(&p.motion, &s->motion, &e);
    }

    /* 3. The scene of both, and what a study of it takes. */
    if (note(c, status, "motion.record", &e) && has_building && choose_designs(c, &p, args_value(args, "--design")) &&
        summarise(c, &p)) {
        if (json_array_size(c->faults) == 0)
            open_study(c, s, &p);
        if (args_has(args, "--ladder") && json_array_size(c->faults) == 0)
            climb(c, &p);
    }
    building_free(&p.building);
    motion_free(&p.motion);
}

/* ---- the command ---------------------------------------------------------------------------------------------- */

static Status give(const Args *args, Check *c, Err *err)
{
    static const char *const APART[] = {"faults", "warnings", "ladder"};
    static const char *const UNSHOWN[] = {"kept", "setting", "with", "otherwise"}; /* of an effect */
    const int faults = (int)json_array_size(c->faults), warnings = (int)json_array_size(c->warnings);
    Document d = {.data = json_incref(c->out)};
    json_t *figures = json_copy(c->out), *ladder = json_object_get(c->out, "ladder"), *found;
    size_t i;

    /* 1. The figures, in lines; of a ladder its effects in a table. */
    for (size_t k = 0; k < N_OF(APART); k++)
        json_object_del(figures, APART[k]);
    document_list(&d, figures);
    if (ladder) {
        json_t *table = document_table(&d);
        json_array_extend(table, json_object_get(ladder, "effects"));
        json_array_foreach(table, i, found)
        {
            found = json_copy(found);
            for (size_t k = 0; k < N_OF(UNSHOWN); k++)
                json_object_del(found, UNSHOWN[k]);
            json_array_set_new(table, i, found);
        }
        document_list(&d, json_incref(ladder));
    }
    if (c->fatal == STATUS_OK || !c->as_json)
        TRY(document_give(&d, args, err));
    else
        document_free(&d);

    /* 2. What is wrong comes last, below everything else on the screen. */
    fflush(stdout);
    json_array_foreach(c->as_json ? NULL : c->warnings, i, found)
        warn_on_stderr(json_text(found, "key"), json_text(found, "text"), NULL);
    json_array_foreach(c->as_json ? NULL : c->faults, i, found) fprintf(stderr, "%s\n", json_string_value(found));
    if (c->fatal != STATUS_OK)
        return fail(err, c->fatal, "%s: could not be checked", args->operand);
    if (faults)
        return bad_data(err, "%s: %d fault%s", args->operand, faults, faults == 1 ? "" : "s");
    if (!c->as_json && warnings)
        printf("%s: no fault, %d warning%s\n", args->operand, warnings, warnings == 1 ? "" : "s");
    else if (!c->as_json)
        printf("%s: everything is in order\n", args->operand);
    return STATUS_OK;
}

static Status run(const Args *args, Err *err)
{
    if (args_has(args, "--self"))
        return selftest(args_has(args, "--json"), err);
    if (!args->operand)
        return misused(err, "imtet check needs a CONFIG, or --self; for example: %s", CMD_CHECK.example);
    Check c = {.args = args, .as_json = args_has(args, "--json"), .out = json_object()};
    Settings s;
    c.faults = json_array();
    c.warnings = json_array();
    json_put(c.out, "faults=%p warnings=%p", c.faults, c.warnings);
    Status status = read_settings(args, &c, &s, err);
    if (status == STATUS_OK) {
        warn_of_settings(&s, warn, &c);
        if (s.problem.kind == PROBLEM_TOWER)
            check_tower(args, &c, &s);
        else if (args_has(args, "--ladder"))
            fault(&c, "--ladder: problem.kind is not tower: it has no effects to leave out");
        else if (json_array_size(c.faults) == 0)
            open_study(&c, &s, NULL);
        status = give(args, &c, err);
    }
    json_decref(c.out);
    return status;
}

const Command CMD_CHECK = {
    .name = "check",
    .group = GROUP_PREPARE,
    .operand = "[CONFIG]",
    .summary = "what a configuration describes, what is wrong with it and what is implausible",
    .example = "imtet check configs/quick.ini",
    .details =

        "Reads CONFIG, the building and the ground motion. Prints mass, height, periods, core, scaled\n"
        "motion, base shear, search box and the expected time of the study, which it estimates by simulating\n"
        "five designs of the box. Names every fault on standard error, not only the first (exit status 65).\n"
        "An implausible value is a warning (exit status 0): a first period outside 0.03 to 0.3 s per storey,\n"
        "floors outside 1e3 to 1e7 kg, floors listed from the top down, damping above 20 %, a peak above 3\n"
        "g, gaps above a metre, a core whose first mode is faster than the motion's samples. An external\n"
        "worker is started and evaluates one design, or two if it is quick; its answer, its time and that of\n"
        "the study are printed. --json has the same as an object, with arrays of faults and warnings.\n\n"
        "--ladder simulates a model with P-delta, ground, yielding storeys, flexible contacts and more, then\n"
        "the same without each effect. It prints what that changes in J1, drift and J3, what the effect\n"
        "costs, and whether it is needed (more than 2 % or the scatter as built), then the fewest settings\n"
        "that are enough (docs/ladder.md).\n\n"
        "--self compares five simulations of the built-in buildings and a search on a textbook problem with\n"
        "stored answers. The tolerances hold for every instruction set.",
    .options =
        {
            OPTIONS_MOTION,
            VALUE("--design", "FILE", "check these designs too and simulate the first five"),
            SWITCH("--ladder", "which effects of the model a typical design needs: what leaving out each one changes"),
            OPTION_JSON,
            OPTION_SET,
            SWITCH("--self", "compare this build with stored answers; exit status 70 if one differs"),
        },
    .is_alone = 1,
    .run = run,
};
