/* The simulator as a module of WebAssembly: what the page of a report calls to see another design.
 *
 * The page writes the bytes of evaluate/portable.h to engine_room, opens them once, chooses record and ground, and
 * simulates. Answers are JSON. There are no files, no clock and one thread; a Page is what the module has.
 *
 *   e = engine_open(room, n)          0: engine_answer() says why
 *   engine_ground(e, record, pga_g, stretch, restitution)     1, or 0 and why; pga_g 0: scaled as the study says
 *   engine_run(e, kind, x)            a SceneKind, the n_var numbers of a design: 1, or 0 and why */
#include <stdarg.h>

#include "evaluate/measures.h"
#include "evaluate/portable.h"
#include "evaluate/scenario.h"
#include "motion/motion_scale.h"
#include "sim/engine.h"

#define EXPORT(name) __attribute__((export_name(#name)))

typedef struct {
    unsigned char *bytes;
    Portable portable;
    MeasureOrder order;
    Scenario scenario;
    SimWorker *worker;
    double x[DESIGN_VARIABLES_MAX];
    SimResult result;
} Page;

enum { ANSWER_MAX = 1 << 17 };

/* Of the one instance: what it was asked to open, and what it says. */
static struct {
    const Portable *open;
    size_t n;
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

/* "name":number, or null where it is none. */
static void say_number(const char *name, double value)
{
    say("%s\"%s\":", instance.text[instance.n - 1] == '{' ? "" : ",", name);
    say(isfinite(value) ? "%.17g" : "null", value);
}

/* Every measure, and all else that there is of a result (RESULT_PARTS), lists as arrays. */
static void say_result(const SimResult *r, unsigned scene)
{
    double values[SIDES * FLOORS_MAX];
    instance.n = 0;
    say("{");
    for (int k = 0; k < MEASURES_LISTED; k++)
        say_number(measure(k)->name, measure_value(r, k));
    for (const ResultPart *part = RESULT_PARTS; part->name; part++) {
        size_t rows;
        const size_t n = result_part(r, scene, part, values, &rows);
        if (part->shape < PART_FLOORS && n > 0)
            say_number(part->name, values[0]);
        if (part->shape < PART_FLOORS || n == 0)
            continue;
        say(",\"%s\":[", part->name);
        for (size_t i = 0; i < rows * n; i++)
            say(isfinite(values[i]) ? "%s%.17g" : "%snull", i ? "," : "", values[i]);
        say("]");
    }
    say(",\"closings\":[");
    for (int j = 0; j < r->n_floors; j++)
        say("%s%ld", j ? "," : "", r->closings[j]);
    say("],\"beyond_law\":%s,\"outcome\":%d,\"reason\":\"%s\"}", beyond_contact_law(r) ? "true" : "false", r->outcome,
        r->reason);
}

EXPORT(engine_answer) const char *engine_answer(void)
{
    return instance.text;
}

/* ---- life -------------------------------------------------------------------------------------------------------- */

EXPORT(engine_room) unsigned char *engine_room(size_t n)
{
    return malloc(n);
}

EXPORT(engine_open) Page *engine_open(unsigned char *bytes, size_t n)
{
    Err err = {0};
    Page *e = calloc(1, sizeof *e);
    Status status = e ? portable_read(&e->portable, bytes, n, &err) : fail_memory(&err, 1, "a scene");
    THEN(status, measures_order(&e->order, e->portable.settings.search.objectives, e->portable.settings.search.limits, 0,
                                &err));
    if (status == STATUS_OK) {
        instance.open = &e->portable;
        return e;
    }
    free(e);
    refuse(&err);
    return NULL;
}

/* Where x is to be written, and how many numbers there are. */
EXPORT(engine_design) double *engine_design(Page *e)
{
    return e->x;
}

EXPORT(engine_ground) int engine_ground(Page *e, size_t record, double pga_g, double stretch, double restitution)
{
    Err err = {0};
    Settings s = e->portable.settings;
    const unsigned needs = measures_need(e->order.judged);
    if (record >= e->portable.n_records)
        return 0;
    memcpy(s.motion.record, e->portable.source[record], sizeof s.motion.record);
    if (pga_g > 0) {
        motion_unscale(&s.motion);
        s.motion.pga_g = pga_g;
    }
    s.motion.stretch = stretch > 0 ? stretch : s.motion.stretch;
    s.contact.restitution = restitution > 0 ? restitution : s.contact.restitution;
    s.sim.engine = ENGINE_FAST;
    s.sim.filtered = (needs & NEEDS_FILTER) != 0;
    if (needs & (NEEDS_FORCES | NEEDS_FEW_FORCES))
        s.sim.forces = FORCES_YES;
    sim_worker_free(e->worker);
    scenario_close(&e->scenario);
    e->worker = NULL;
    const SceneOptions options = settings_scene(&s);
    Status status = scenario_open(&e->scenario, &options, &s.motion, &e->portable.record[record], &err);
    THEN(status, sim_worker_create(&e->worker, e->scenario.scene, &err));
    return status == STATUS_OK ? 1 : refuse(&err);
}

EXPORT(engine_run) int engine_run(Page *e, int kind)
{
    Err err = {0};
    const Status status = sim_run(e->worker, (SceneKind)kind, e->x, &e->result, &err);
    if (status != STATUS_OK)
        return refuse(&err);
    say_result(&e->result, SCENES[kind].has);
    return 1;
}
