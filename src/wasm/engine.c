/* The simulator as a module of WebAssembly: what the page of a report calls to see another design.
 *
 * The page writes the bytes of evaluate/portable.h to engine_room, opens them once, chooses record and ground, and
 * simulates. There are no files, no clock and one thread.
 *
 *   p = engine_open(room, n)          0: the bytes are none, engine_answer() says why
 *   engine_ground(p, record, pga_g, stretch, restitution)    record from 0; 0: as the study says; 1, or 0 and why
 *   engine_run(p, kind, whole)        a SceneKind, the design that stands at engine_design(p); whole: by all
 *                                     simulations by which the study judges a design, the ground then is of the
 *                                     first: 1, or 0 and why
 *   engine_histories(p)               of that design and without core (report/history.h)
 *
 * An answer is JSON: {"objectives": [n_obj] or none, "reason", "gap_m": [floors], "beyond_law", and every measure and
 * part of the result by its name (sim/result.h)}; of the whole the objectives by the rule of the study. Of histories
 * {"floor", "building_hz", "history_with_core", "history_no_core"} as of a design of the report. */
#include <stdarg.h>

#include "evaluate/measures.h"
#include "evaluate/portable.h"
#include "evaluate/replicates.h"
#include "evaluate/scenario.h"
#include "motion/motion_scale.h"
#include "report/history.h"
#include "sim/engine.h"

typedef struct {
    Portable portable;
    MeasureOrder order;
    Scenario scenario;
    size_t record;     /* of that ground */
    double ground[3];  /* as it was asked for: pga_g, stretch, restitution */
    SimWorker *worker; /* NULL: no ground was chosen */
    double x[DESIGN_VARIABLES_MAX];
    Design design;
    SimResult result;
} Page;

enum { ANSWER_MAX = 1 << 20 };

/* Of the one instance: what it was asked to open, and what it says. */
static struct {
    const Portable *open;
    size_t n;
    int digits; /* of the numbers of a list */
    char text[ANSWER_MAX];
} instance;

/* ---- what the program takes from files and libraries ------------------------------------------------------------- */

Status building_read(BuildingFiles *b, const BuildingOptions *o, Err *err)
{
    memset(b, 0, sizeof *b);
    return portable_building(instance.open, o->model, b, err);
}

Status engine_cvode(const SimModel *model, const Motion *motion, const EngineOptions *o, SimResult *r, Err *err)
{
    (void)model, (void)motion, (void)o, (void)r;
    return fail(err, STATUS_USAGE, "a page has the engine 'fast' alone");
}

/* Built-in motions and buildings come with the bytes, as all others do: there is no file of any name. */
const char *builtin_name(const char *source)
{
    return source;
}

int model_is_built_in(const char *model)
{
    (void)model;
    return 1;
}

/* ---- answers ----------------------------------------------------------------------------------------------------- */

__attribute__((format(printf, 1, 2))) static void say(const char *format, ...)
{
    va_list list;
    va_start(list, format);
    const int n = vsnprintf(instance.text + instance.n, ANSWER_MAX - instance.n, format, list);
    va_end(list);
    instance.n = n < 0 || instance.n + (size_t)n >= ANSWER_MAX ? ANSWER_MAX - 1 : instance.n + (size_t)n;
}

static int refuse(const Err *err)
{
    instance.n = 0;
    say("%s", err->text);
    return 0;
}

/* ,"name":number, or null where it is none. */
static void say_number(const char *name, double value)
{
    say(",\"%s\":", name);
    say(isfinite(value) ? "%.17g" : "null", value);
}

/* Every step-th of n. */
static void say_list(const char *name, size_t n, size_t step, const double values[])
{
    say(",\"%s\":[", name);
    for (size_t i = 0; i < n; i += step)
        say(isfinite(values[i]) ? "%s%.*g" : "%snull", i ? "," : "", instance.digits, values[i]);
    say("]");
}

const char *engine_answer(void)
{
    return instance.text;
}

/* ---- life -------------------------------------------------------------------------------------------------------- */

unsigned char *engine_room(size_t n)
{
    return malloc(n);
}

Page *engine_open(unsigned char *bytes, size_t n)
{
    Err err = {0};
    Page *p = calloc(1, sizeof *p);
    Status status = p ? portable_read(&p->portable, bytes, n, &err) : fail_memory(&err, 1, "a scene");
    THEN(status, measures_order(&p->order, p->portable.settings.search.objectives, p->portable.settings.search.limits,
                                0, &err));
    if (status == STATUS_OK) {
        instance.open = &p->portable;
        return p;
    }
    free(p);
    refuse(&err);
    return NULL;
}

/* Where x is to be written, and how many numbers there are. */
double *engine_design(Page *p)
{
    return p->x;
}

int engine_ground(Page *p, size_t record, double pga_g, double stretch, double restitution)
{
    Err err = {0};
    Settings s = p->portable.settings;
    if (record >= p->portable.n_records)
        return 0;
    memcpy(s.motion.record, p->portable.source[record], sizeof s.motion.record);
    if (pga_g > 0) {
        motion_unscale(&s.motion);
        s.motion.pga_g = pga_g;
    }
    s.motion.stretch = stretch > 0 ? stretch : s.motion.stretch;
    s.contact.restitution = restitution > 0 ? restitution : s.contact.restitution;
    s.sim.engine = ENGINE_FAST;
    measures_ask(p->order.judged, &s.sim);
    p->record = record;
    memcpy(p->ground, (const double[]){pga_g, stretch, restitution}, sizeof p->ground);
    sim_worker_free(p->worker);
    scenario_close(&p->scenario);
    p->worker = NULL;
    const SceneOptions options = settings_scene(&s);
    Status status = scenario_open(&p->scenario, &options, &s.motion, &p->portable.record[record], &err);
    THEN(status, sim_worker_create(&p->worker, p->scenario.scene, &err));
    return status == STATUS_OK ? 1 : refuse(&err);
}

/* Replicate k of the design, as evaluate/tower.c does it: its gaps, what it is built like, and what it is judged by. */
static Status run(Page *p, SceneKind kind, const ReplicatePlan *plan, size_t k, Err *err)
{
    const Settings *s = &p->portable.settings;
    const DesignSpace *space = scene_design(p->scenario.scene);
    design_of(space, p->x, &p->design);
    Design built = p->design;
    replicate_gaps((uint32_t)s->search.seed, k, s->sim.gap_tolerance_m, space, &built);
    const AsBuilt as = replicate_as_built((uint32_t)s->search.seed, k, &s->sim.uncertain);
    TRY(sim_worker_as_built(p->worker, k > 0 && is_uncertain(&s->sim.uncertain) ? &as : NULL, err));
    TRY(sim_run_built(p->worker, kind, &built, &p->result, err));
    p->result.rate_per_year = replicate_rate(plan, p->portable.source[p->record]);
    measures_chances(&p->order, &p->result);
    if (kind == SCENE_IMPACT)
        measures_settle(&p->result, p->order.judged);
    return STATUS_OK;
}

int engine_run(Page *p, int kind, int whole)
{
    ReplicatePlan plan = replicate_plan(&p->portable.settings.sim, whole ? p->portable.n_records : 1);
    plan.n_replicates = whole ? plan.n_replicates : 1;
    Measured *part = calloc(plan.n_records * plan.n_replicates, sizeof *part);
    Err err = {0};
    ReplicateSummary sum;
    double objectives[N_MEASURES], values[SIDES * FLOORS_MAX];
    const double *g = p->ground;
    Status status = part ? STATUS_OK : fail_memory(&err, plan.n_records, "simulations");

    /* The first record comes last, so that the ground and what is said besides are those of one simulation. */
    for (size_t r = plan.n_records; r-- > 0 && status == STATUS_OK;) {
        if (whole && !engine_ground(p, r, g[0], g[1], g[2])) {
            free(part);
            return 0;
        }
        for (size_t k = plan.n_replicates; k-- > 0 && status == STATUS_OK;) {
            status = run(p, (SceneKind)kind, &plan, k, &err);
            part[k * plan.n_records + r] = measured(&p->result);
        }
    }
    if (status == STATUS_OK)
        replicates_summarise(&plan, part, sizeof *part, 0, &sum);
    free(part);
    if (status != STATUS_OK)
        return refuse(&err);
    for (int k = 0; k < p->order.n_obj; k++)
        objectives[k] = sum.mean[p->order.of[k]];

    /* Every measure, and all else that there is of a result (RESULT_PARTS). */
    const SimResult *r = &p->result;
    instance.n = 0;
    instance.digits = 17;
    say("{\"reason\":\"%s\",\"beyond_law\":%s", r->reason, beyond_contact_law(r) ? "true" : "false");
    say_list("objectives", sum.outcome == OUTCOME_OK ? (size_t)p->order.n_obj : 0, 1, objectives);
    for (int j = 0; j < r->n_floors; j++)
        values[j] = design_gap(&p->design, j);
    say_list("gap_m", (size_t)r->n_floors, 1, values);
    for (int k = 0; k < MEASURES_LISTED; k++)
        say_number(measure(k)->name, measure_value(r, k));
    for (const ResultPart *part = RESULT_PARTS; part->name; part++) {
        size_t rows;
        const size_t n = result_part(r, SCENES[kind].has, part, values, &rows);
        if (part->shape >= PART_FLOORS && n > 0)
            say_list(part->name, rows * n, 1, values);
        else if (n > 0)
            say_number(part->name, values[0]);
    }
    say("}");
    return 1;
}

int engine_histories(Page *p)
{
    static const char *const NAMES[2] = {"history_with_core", "history_no_core"};
    const Building *b = scene_building(p->scenario.scene);
    const int floor = (b->n - 1) / 2;
    Track t[2] = {0};
    Err err = {0};
    double hz[FLOORS_MAX];
    const Status status = histories_run(&p->scenario, p->x, floor, t, &err);
    instance.n = 0;
    instance.digits = 6;
    for (int i = 0; i < b->n; i++)
        hz[i] = b->model.omega[i] / (2 * M_PI);
    say("{\"floor\":%d", floor + 1);
    say_list("building_hz", (size_t)b->n, 1, hz);
    for (int i = 0; i < 2; i++) {
        const size_t width = t[i].width, n = t[i].n * width, step = (t[i].n / HISTORY_POINTS + 1) * width;
        say(",\"%s\":{\"energies\":{\"\":0", NAMES[i]);
        for (size_t k = 0; k < N_ENERGIES; k++)
            say_list(ENERGY_KEYS[k], n, step, t[i].rows + width - N_ENERGIES + k);
        say("}");
        say_list("t", n, step, t[i].rows);
        say_list("u", n, step, t[i].rows + HISTORY_U + floor);
        say("}");
        track_free(&t[i]);
    }
    say("}");
    return status == STATUS_OK ? 1 : refuse(&err);
}
