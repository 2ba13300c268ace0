#include "evaluate/tower.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/list.h"
#include "evaluate/threads.h"
#include "evaluate/recipe.h"

typedef struct {
    Scenario scenario;  /* zeroed where the scene is borrowed */
    const Scene *scene; /* its own, or borrowed */
    SimWorker **worker; /* (n_workers) */
} Record;

struct Tower {
    uint32_t seed;
    double tolerance_m; /* standard deviation of a gap as built */
    UncertainOptions uncertain;
    MeasureSet judged; /* what is not finite there has failed */
    size_t n_workers, n_floors;
    ReplicatePlan plan; /* n_records of which are open */
    MeasureOrder order;
    Record record[TOWER_RECORDS_MAX];
    double lower[DESIGN_VARIABLES_MAX], upper[DESIGN_VARIABLES_MAX];
    Recipe recipe; /* of more tasks than one */
};

const DesignSpace *tower_design(const Tower *t)
{
    return scene_design(t->record[0].scene);
}

static Status simulate(void *self, size_t worker, const Task *task, Err *err)
{
    const Tower *t = self;
    const size_t n = t->plan.n_records, k = task->repeat * t->plan.n_replicates + task->part / n;
    const SceneKind kind = (SceneKind)task->variant;
    SimWorker *w = t->record[task->part % n].worker[worker];
    Design design = {0};
    if (kind != SCENE_NO_CORE)
        design_of(tower_design(t), task->x, &design);
    if (kind == SCENE_IMPACT)
        replicate_design(t->seed, k, t->tolerance_m, t->n_floors, design.gap);
    if (is_uncertain(&t->uncertain)) {
        const AsBuilt built = replicate_as_built(t->seed, k, &t->uncertain);
        TRY(sim_worker_as_built(w, kind == SCENE_IMPACT && k > 0 ? &built : NULL, err));
    }
    TRY(sim_run_built(w, kind, &design, task->result, err));
    if (kind == SCENE_IMPACT)
        measures_settle(task->result, t->judged);
    return STATUS_OK;
}

static void combine_as(const Tower *t, const ReplicatePlan *plan, const void *parts, Evaluation *e)
{
    ReplicateSummary sum;
    replicates_summarise(plan, parts, &sum);
    evaluation_set_outcome(e, sum.outcome, sum.shown->reason);
    for (int i = 0; i < t->order.n_obj; i++) {
        e->f[i] = sum.mean[t->order.of[i]];
        e->sd[i] = sum.sd[t->order.of[i]];
    }
    for (int i = t->order.n_obj; i < N_MEASURES; i++)
        e->extra[i - t->order.n_obj] = sum.mean[t->order.of[i]];
    e->seconds = sum.seconds;
    e->replicates = (int)sum.n_replicates;
}

static void combine(const void *self, const void *parts, Evaluation *e)
{
    const Tower *t = self;
    combine_as(t, &t->plan, parts, e);
}

/* The first replicate of every record. */
static void combine_cheap(const void *self, const void *parts, Evaluation *e)
{
    const Tower *t = self;
    ReplicatePlan plan = t->plan;
    plan.n_replicates = 1;
    combine_as(t, &plan, parts, e);
}

static void tower_close(void *self)
{
    Tower *t = self;
    for (size_t r = 0; t && r < t->plan.n_records; r++) {
        for (size_t i = 0; t->record[r].worker && i < t->n_workers; i++)
            sim_worker_free(t->record[r].worker[i]);
        free(t->record[r].worker);
        scenario_close(&t->record[r].scenario);
    }
    free(t);
}

static const Simulator TOWER = {simulate, combine, tower_close};

/* -- opening ------------------------------------------------------------------------------------------------------- */

static Status open_workers(Tower *t, Record *r, Err *err)
{
    r->worker = calloc(t->n_workers, sizeof *r->worker);
    if (!r->worker)
        return fail(err, STATUS_NO_MEMORY, "no memory for %zu workers", t->n_workers);
    for (size_t i = 0; i < t->n_workers; i++)
        TRY(sim_worker_create(&r->worker[i], r->scene, err));
    return STATUS_OK;
}

static Status open_record(Tower *t, const Settings *settings, const char *name, Err *err)
{
    SceneOptions options = settings_scene(settings);
    MotionOptions motion = settings->motion;
    Record *r = &t->record[t->plan.n_records];
    if (t->plan.n_records == TOWER_RECORDS_MAX)
        return fail(err, STATUS_BAD_DATA, "more than %d records", TOWER_RECORDS_MAX);
    snprintf(motion.record, sizeof motion.record, "%s", name);
    const unsigned needs = measures_need(t->judged);
    options.sim.filtered = options.sim.forces == FORCES_YES || (needs & NEEDS_FILTER);
    if (needs & NEEDS_FORCES)
        options.sim.forces = FORCES_YES;
    TRY(scenario_open(&r->scenario, &options, &motion, err));
    r->scene = r->scenario.scene;
    t->plan.n_records++;
    return open_workers(t, r, err);
}

static Status open_records(Tower *t, const Settings *s, TowerUse use, Err *err)
{
    const char *list = use == TOWER_SINGLE ? "none" : s->motion.records;
    char name[OPTION_TEXT_MAX];
    TRY(open_record(t, s, s->motion.record, err));
    for (size_t i = 0; strcmp(list, "none") != 0 && i < list_count(list); i++) {
        if (!list_item(list, i, name, sizeof name))
            return fail(err, STATUS_BAD_DATA, "motion.records: item %zu is empty or too long", i + 1);
        Err why = {0};
        const Status status = open_record(t, s, name, &why);
        if (status != STATUS_OK)
            return fail(err, status, "motion.records: %s", why.text);
    }
    return STATUS_OK;
}

/* Swapping keeps both thicknesses in the box and the sample spread out; clipping would pile designs up on
 * t_top = t_base. */
static void swap_if_top_heavy(double x[], const void *self)
{
    const Tower *t = self;
    double *t_base = &x[tower_design(t)->n_gaps], *t_top = t_base + 1;
    if (tower_design(t)->n_walls > 0 && *t_top > *t_base) {
        const double thicker = *t_top;
        *t_top = *t_base;
        *t_base = thicker;
    }
}

static Problem problem_on(Tower *t)
{
    return (Problem){.n_var = (size_t)tower_design(t)->n_var,
                     .n_obj = (size_t)t->order.n_obj,
                     .n_extra = (size_t)(N_MEASURES - t->order.n_obj),
                     .lower = t->lower,
                     .upper = t->upper,
                     .repair = swap_if_top_heavy,
                     .simulator = &TOWER,
                     .self = t,
                     .n_parts = t->plan.n_records * t->plan.n_replicates,
                     .combine_cheap = combine_cheap,
                     .n_cheap = t->plan.n_replicates > 1 ? t->plan.n_records : 0,
                     .part_size = sizeof(SimResult),
                     .n_workers = t->n_workers,
                     .executor = executor_for(t->n_workers)};
}

/* The problem, or what is there of the tower released. */
static Status finish_opening(Problem *p, Tower *t, const char *objectives, Status status, Err *err)
{
    if (status == STATUS_OK) {
        t->n_floors = (size_t)scene_n_floors(t->record[0].scene);
        status = measures_order(&t->order, objectives, (int)t->n_floors, err);
        t->judged |= t->order.objectives;
    }
    if (status != STATUS_OK) {
        tower_close(t);
        return status;
    }
    *p = problem_on(t);
    return STATUS_OK;
}

static uint64_t hash_of_files(const Tower *t)
{
    uint64_t hash = scene_building(t->record[0].scene)->hash;
    for (size_t r = 0; r < t->plan.n_records; r++)
        hash = (hash ^ t->record[r].scenario.motion.file_hash) * HASH_PRIME;
    return hash;
}

/* With the ranks of a cluster, where this process has some. */
static void share(Problem *p, Tower *t, const Settings *s, TowerUse use)
{
    t->recipe.settings = *s;
    t->recipe.settings.problem.kind = PROBLEM_TOWER;
    t->recipe.use = use;
    p->recipe = &t->recipe;
    p->recipe_size = sizeof t->recipe;
    p->inputs = hash_of_files(t);
    executor_choose(p);
}

Status tower_open(Problem *p, const Settings *s, TowerUse use, size_t n_tasks, Err *err)
{
    const size_t workers = threads_wanted(s->search.threads);
    MeasureOrder order;
    if (s->problem.kind != PROBLEM_TOWER)
        return fail(err, STATUS_BAD_DATA, "problem.kind: is no tower, which alone has a building, a core and a motion");
    TRY(measures_order(&order, s->search.objectives, 0, err));
    Tower *t = calloc(1, sizeof *t);
    if (!t)
        return fail(err, STATUS_NO_MEMORY, "no memory for a scene");
    t->seed = (uint32_t)s->search.seed;
    t->tolerance_m = s->sim.gap_tolerance_m;
    t->uncertain = s->sim.uncertain;
    t->n_workers = workers < n_tasks ? workers : n_tasks;
    t->plan = (ReplicatePlan){.n_replicates = use == TOWER_SINGLE ? 1 : (size_t)s->sim.replicates,
                              .rule = s->sim.robust,
                              .quantile = s->sim.quantile,
                              .spread = spread_word(s->sim.gap_tolerance_m, &s->sim.uncertain)};
    t->judged = order.objectives | measures_limited(s->search.limits);
    TRY(finish_opening(p, t, s->search.objectives, open_records(t, s, use, err), err));
    design_bounds(tower_design(t), &s->design, t->lower, t->upper);
    if (n_tasks > 1)
        share(p, t, s, use);
    return STATUS_OK;
}

Status tower_open_scene(Problem *p, const Scene *scene, size_t n_replicates, uint32_t seed, size_t n_workers, Err *err)
{
    Tower *t = calloc(1, sizeof *t);
    if (!t)
        return fail(err, STATUS_NO_MEMORY, "no memory for a scene");
    *t = (Tower){.seed = seed,
                 .n_workers = n_workers,
                 .plan = {.n_records = 1, .n_replicates = n_replicates, .spread = "predictability"},
                 .record[0].scene = scene};
    return finish_opening(p, t, "auto", open_workers(t, &t->record[0], err), err);
}

const Tower *tower_of(const Problem *p)
{
    return p->simulator == &TOWER ? p->self : NULL;
}

int tower_n_floors(const Tower *t)
{
    return (int)t->n_floors;
}

size_t tower_n_records(const Tower *t)
{
    return t->plan.n_records;
}

const MeasureOrder *tower_measures(const Tower *t)
{
    return &t->order;
}

const Scenario *tower_record(const Tower *t, size_t i)
{
    return &t->record[i].scenario;
}

size_t tower_n_workers(const Tower *t)
{
    return t->n_workers;
}

SimWorker *tower_worker(const Tower *t, size_t record, size_t worker)
{
    return t->record[record].worker[worker];
}

ReplicatePlan tower_plan(const Tower *t)
{
    return t->plan;
}

/* -- simulations outside a search ---------------------------------------------------------------------------------- */

static Status run_all(Queue *q, size_t n, const SimTask tasks[], SimResult results[], Err *err)
{
    Finished done;
    for (size_t i = 0; i < n; i++) {
        const Asked asked = {.x = tasks[i].x, .variant = (int)tasks[i].kind, .only_first = 1};
        TRY(queue_ask(q, &asked, err));
    }
    for (size_t i = 0; i < n; i++) {
        TRY(queue_next(q, &done, err));
        memcpy(&results[i], done.parts, sizeof results[i]);
    }
    return STATUS_OK;
}

Status tower_simulate(const Problem *p, size_t n, const SimTask tasks[], SimResult results[], Err *err)
{
    Queue *q;
    Problem few = *p;
    few.n_workers = n < few.n_workers ? n : few.n_workers;
    if (few.n_workers < 2)
        few.executor = executor_for(1);
    TRY(queue_open(&q, &few, QUEUE_AS_ASKED, 0, 0, err));
    const Status status = run_all(q, n, tasks, results, err);
    queue_close(q);
    return status;
}

typedef void TakeParts(const Problem *p, size_t i, const SimResult parts[], void *to);

static Status ask_all(Queue *q, size_t n, const double X[], TakeParts *take, void *to, Err *err)
{
    const Problem *p = queue_problem(q);
    Finished done;
    for (size_t i = 0; i < n; i++)
        TRY(queue_ask(q, &(Asked){.x = X + i * p->n_var}, err));
    for (size_t i = 0; i < n; i++) {
        TRY(queue_next(q, &done, err));
        take(p, i, done.parts, to); /* they are the queue's */
    }
    return STATUS_OK;
}

static Status each_part(const Problem *p, size_t n, const double X[], TakeParts *take, void *to, Err *err)
{
    Queue *q;
    TRY(queue_open(&q, p, QUEUE_AS_ASKED, 0, 0, err));
    const Status status = ask_all(q, n, X, take, to, err);
    queue_close(q);
    return status;
}

static void copy_parts(const Problem *p, size_t i, const SimResult parts[], void *to)
{
    memcpy((SimResult *)to + i * p->n_parts, parts, p->n_parts * sizeof *parts);
}

Status tower_parts(const Problem *p, size_t n, const double X[], SimResult results[], Err *err)
{
    return each_part(p, n, X, copy_parts, results, err);
}

typedef struct {
    SimResult *shown;
    ReplicateSummary *out;
} Summaries;

static void summarise_parts(const Problem *p, size_t i, const SimResult parts[], void *to)
{
    const Summaries *s = to;
    replicates_summarise(&tower_of(p)->plan, parts, &s->out[i]);
    s->shown[i] = *s->out[i].shown;
    s->out[i].shown = &s->shown[i];
}

Status tower_replicate(const Problem *p, size_t n, const double X[], SimResult shown[], ReplicateSummary out[],
                       Err *err)
{
    return each_part(p, n, X, summarise_parts, &(Summaries){shown, out}, err);
}
