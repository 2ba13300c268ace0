#include "evaluate/tower.h"

#include <pthread.h>
#include <unistd.h>

#include "base/hash.h"
#include "evaluate/isolated.h"
#include "motion/builtin.h"
#include "motion/motion_scale.h"
#include "motion/suite.h"
#include "settings/settings.h"
#include "scene/neighbour.h"

/* A part of a simulation whose whole result is wanted (Variant.is_full). */
typedef struct {
    Measured measured;
    SimResult result;
} FullResult;

typedef struct {
    pthread_mutex_t lock;
    int is_read;
    Status status;
    Err why;
    Motion motion;        /* as read, not scaled */
    double rate_per_year; /* of SimResult */
} Record;

/* A scene, opened by the first worker that comes and closed by the last one that leaves. */
typedef struct {
    pthread_mutex_t lock;
    size_t n_users;
    Scenario *scenario; /* NULL: it is not open */
} Place;

struct Tower {
    MeasureSet judged; /* what is not finite there has failed */
    size_t n_workers;
    ReplicatePlan plan; /* of a design: n_records of the scenes */
    DesignSpace design;
    MeasureOrder order;
    double lower[DESIGN_VARIABLES_MAX], upper[DESIGN_VARIABLES_MAX];
    VariableKind kind[DESIGN_VARIABLES_MAX];
    Steps steps[DESIGN_VARIABLES_MAX];
    int has_kinds;      /* some are not real */
    Record *record;     /* (n_records) */
    size_t n_places;    /* the scenes, then the same at each level of steps */
    Place *place;       /* (n_places) */
    SimWorker **worker; /* (n_places, n_workers) NULL: it is not there */
    size_t *at;         /* (n_workers) of a sweep: one more than the place where the worker is; 0: nowhere */
    Recipe *recipe;
    Isolated isolated; /* {0}: simulated in this process */
};

/* -- scenes -------------------------------------------------------------------------------------------------------- */

static Record *record_of(const Tower *t, size_t place)
{
    return &t->record[t->recipe->scene[place % t->recipe->n_scenes].record];
}

/* The settings of a place, for free, and its record, which the first who comes reads. */
static Status read_scene(const Tower *t, size_t place, Settings **out, Err *err)
{
    const Recipe *recipe = t->recipe;
    const SceneChange *c = &recipe->scene[place % recipe->n_scenes];
    Record *r = record_of(t, place);

    /* 1. The settings of all, at the level of steps of this place, computing what is judged and no more. */
    TRY_ROOM(*out, 1, "a set of settings", err);
    Settings *s = *out;
    *s = recipe->settings;
    memcpy(s->motion.record, recipe_record(recipe, c->record), sizeof s->motion.record);
    for (size_t level = place / recipe->n_scenes; level > 0; level--)
        estimate_options(&s->sim, &s->sim);
    measures_ask(t->judged, &s->sim);
    if (c->setting[0])
        TRY(settings_set(s, c->setting, err));

    /* 2. The record; all who want it hear of the same fault. */
    pthread_mutex_lock(&r->lock);
    if (!r->is_read)
        r->status = motion_open(&r->motion, &s->motion, &r->why);
    r->is_read = 1;
    pthread_mutex_unlock(&r->lock);
    if (r->status != STATUS_OK)
        *err = r->why;
    return r->status;
}

Status tower_motion(const Problem *p, size_t scene, Motion *out, Err *err)
{
    Settings *s;
    Status status = read_scene(p->self, scene, &s, err);
    THEN(status, motion_scale_copy(out, &record_of(p->self, scene)->motion, &s->motion, err));
    free(s);
    return status;
}

void tower_release(Tower *t, size_t place)
{
    Place *p = &t->place[place];
    pthread_mutex_lock(&p->lock);
    if (--p->n_users == 0) {
        scenario_close(p->scenario);
        free(p->scenario);
        p->scenario = NULL;
    }
    pthread_mutex_unlock(&p->lock);
}

/* Keep the scene of a place open. The first who comes opens it and checks that it has what every measure that is judged
 * needs. */
Status tower_acquire(Tower *t, size_t place, const Scenario **out, Err *err)
{
    Place *p = &t->place[place];
    Settings *s = NULL;
    Status status = STATUS_OK;
    pthread_mutex_lock(&p->lock);
    if (!p->scenario) {
        Scenario *w = p->scenario = calloc(1, sizeof *w);
        status = w ? read_scene(t, place, &s, err) : fail_memory(err, 1, "a scene");
        if (status == STATUS_OK) {
            const SceneOptions options = settings_scene(s);
            status = scenario_open(w, &options, &s->motion, &record_of(t, place)->motion, err);
        }
        THEN(status, measures_check(t->judged, &w->options.core, scene_building(w->scene), err));
        if (status == STATUS_OK && s->sim.uncertain.strength > 0 && !scene_building(w->scene)->yields)
            status = bad_data(err, "sim.uncertain: strength: no storey yields; set building.yield_drift");
        if (w && status != STATUS_OK)
            scenario_close(w);
        free(s);
    }
    p->n_users += status == STATUS_OK;
    if (status != STATUS_OK) {
        free(p->scenario);
        p->scenario = NULL;
    }
    *out = p->scenario;
    pthread_mutex_unlock(&p->lock);
    return status;
}

static void detach(Tower *t, size_t place, size_t worker)
{
    SimWorker **w = &t->worker[place * t->n_workers + worker];
    if (*w) {
        sim_worker_free(*w);
        *w = NULL;
        tower_release(t, place);
    }
}

/* The integrator of a worker at a place. In a sweep it leaves the scene where it was. */
static Status attach(Tower *t, size_t place, size_t worker, SimWorker **out, Err *err)
{
    SimWorker **w = &t->worker[place * t->n_workers + worker];
    if (!*w) {
        if (t->recipe->is_sweep && t->at[worker] > 0)
            detach(t, t->at[worker] - 1, worker);
        t->at[worker] = place + 1;
        const Scenario *scenario;
        TRY(tower_acquire(t, place, &scenario, err));
        const Status status = sim_worker_create(w, scenario->scene, err);
        if (status != STATUS_OK) {
            *w = NULL;
            tower_release(t, place);
            return status;
        }
    }
    *out = *w;
    return STATUS_OK;
}

/* -- the simulator ------------------------------------------------------------------------------------------------- */

/* Simulate one part of a design: a replicate of it under one record. */
static Status simulate(void *self, size_t worker, const Task *task, Err *err)
{
    Tower *t = self;
    const Settings *s = &t->recipe->settings;
    const Variant *v = &task->variant;
    const size_t n = t->plan.n_records, k = task->repeat * t->plan.n_replicates + task->part / n;
    const size_t place = v->scene + task->part % n;
    const SceneKind kind = v->kind;
    SimResult own, *result = v->is_full ? &((FullResult *)task->result)->result : &own;
    Design design = {0};
    SimWorker *w;

    /* 1. What is built: the design, and of a case with gaps replicate k of it. */
    TRY(attach(t, place, worker, &w, err));
    if (kind != SCENE_NO_CORE)
        design_of(&t->design, task->x, &design);
    if (kind == SCENE_IMPACT)
        replicate_gaps((uint32_t)s->search.seed, k, s->sim.gap_tolerance_m, &t->design, &design);
    if (is_uncertain(&s->sim.uncertain)) {
        const AsBuilt built = replicate_as_built((uint32_t)s->search.seed, k, &s->sim.uncertain);
        TRY(sim_worker_as_built(w, kind == SCENE_IMPACT && k > 0 ? &built : NULL, err));
    }

    /* 2. The run, to the end of the motion or of its strong part. */
    sim_worker_device(w, &(LinearDevice){v->device[0], v->device[1], v->device[2]});
    sim_worker_brief(w, v->is_brief);
    TRY(sim_run_built(w, kind, &design, result, err));

    /* 3. What it is judged by. */
    result->rate_per_year = record_of(t, place)->rate_per_year;
    measures_chances(&t->order, result);
    if (kind == SCENE_IMPACT)
        measures_settle(result, t->judged);
    *(Measured *)task->result = measured(result);
    return STATUS_OK;
}

static const Simulator HERE = {.simulate = simulate};

static void write_lost(const Task *task, const char *reason)
{
    SimResult lost = {.outcome = RUN_ENGINE_FAILED};
    text_copy(lost.reason, reason);
    *(Measured *)task->result = measured(&lost);
    if (task->variant.is_full)
        ((FullResult *)task->result)->result = lost;
}

static Pool *processes(void *self)
{
    Pool *pool = &((Tower *)self)->isolated.pool;
    return pool->n_workers > 0 ? pool : NULL;
}

/* An evaluation is the summary of its parts; its reason is that of the part that failed first. */
static void combine(const Problem *p, size_t n, const void *parts, Evaluation *e)
{
    const Tower *t = p->self;
    const MeasureOrder *order = &t->order;
    const ReplicatePlan plan = tower_plan(t, n);
    ReplicateSummary sum;
    replicates_summarise(&plan, parts, p->part_size, 0, &sum);
    evaluation_set_outcome(e, sum.outcome, measured_part(parts, p->part_size, sum.shown)->reason);
    for (int i = 0; i < order->n_obj; i++) {
        e->f[i] = sum.mean[order->of[i]];
        e->sd[i] = sum.sd[order->of[i]];
    }
    for (int i = order->n_obj; i < order->n; i++)
        e->extra[i - order->n_obj] = sum.mean[order->of[i]];
    e->seconds = sum.seconds;
    e->replicates = (int)sum.n_replicates;
}

/* Also of a tower that was opened in part. */
static void tower_close(void *self)
{
    Tower *t = self;
    pool_close(&t->isolated.pool);
    for (size_t i = 0; t->worker && i < t->n_places * t->n_workers; i++)
        detach(t, i / t->n_workers, i % t->n_workers);
    for (size_t i = 0; t->place && i < t->n_places; i++)
        pthread_mutex_destroy(&t->place[i].lock);
    for (size_t i = 0; t->record && i < t->recipe->n_records; i++) {
        motion_free(&t->record[i].motion);
        pthread_mutex_destroy(&t->record[i].lock);
    }
    free(t->worker);
    free(t->at);
    free(t->place);
    free(t->record);
    free(t->recipe);
    free(t);
}

static const Simulator TOWER = {.simulate = simulate, .pool = processes, .combine = combine, .close = tower_close};

/* -- opening ------------------------------------------------------------------------------------------------------- */

Status tower_space(const Settings *s, DesignSpace *out, Err *err)
{
    Building b;
    TRY(building_load(&b, &s->building, err));
    const int n_floors = b.n;
    building_free(&b);
    return design_space_make(out, &s->design, core_section(&s->core), n_floors, err);
}

/* Swapping keeps both thicknesses in the box and the sample spread out; clipping would pile designs up on
 * t_top = t_base. */
static void swap_if_top_heavy(double x[], const void *self)
{
    const Tower *t = self;
    double *t_base = &x[t->design.n_gaps], *t_top = t_base + 1;
    if (t->design.n_walls > 0 && *t_top > *t_base) {
        const double thicker = *t_top;
        *t_top = *t_base;
        *t_base = thicker;
    }
}

/* Variables that take values that are sold: gaps multiples of a step, thicknesses those of a list; their bounds become
 * the first and the last value within. */
static Status set_steps(Tower *t, const DesignOptions *o, Err *err)
{
    const DesignSpace *space = &t->design;
    const NumberList *plates = &o->step_thickness_m;
    const double step = o->step_gap_m;
    Steps gaps = {0}, walls = {.n = plates->n, .at = plates->at};
    for (int i = 1; i < plates->n; i++)
        if (!(plates->at[i] > plates->at[i - 1]))
            return bad_data(err, "design.step_thickness_m: %g stands behind %g; give them in ascending order",
                            plates->at[i], plates->at[i - 1]);
    if (step > 0.0) {
        const double first = ceil(o->gap_m.at[0] / step - 1e-9), last = floor(o->gap_m.at[1] / step + 1e-9);
        if (step < 1e-4)
            return bad_data(err, "design.step_gap_m: %g m is no step that is kept on site; give 0.0001 or more", step);
        if (first > last)
            return bad_data(err, "design.step_gap_m: no multiple of %g lies within design.gap_m", step);
        gaps = (Steps){.n = (size_t)(last - first) + 1, .first = first, .step = step};
    }
    for (int j = 0; j < space->n_gaps + space->n_walls; j++) {
        const Steps *s = j < space->n_gaps ? &gaps : &walls;
        if (s->n == 0)
            continue;
        t->has_kinds = 1;
        t->kind[j] = VARIABLE_STEPPED;
        t->steps[j] = *s;
        t->lower[j] = steps_at(s, 0);
        t->upper[j] = steps_at(s, s->n - 1);
    }
    return STATUS_OK;
}

/* Everything that a tower has of its recipe. */
static Status prepare(Tower *t, Err *err)
{
    const Recipe *r = t->recipe;
    const Settings *s = &r->settings;
    DesignSpace *space = &t->design;
    SimWorker *unused;

    /* 1. Room for records, scenes and workers. */
    TRY(measures_order(&t->order, s->search.objectives, s->search.limits, 0, err));
    t->judged = t->order.judged;
    t->n_places = (1 + TOWER_LEVELS) * r->n_scenes;
    TRY_ROOM(t->record, r->n_records, "records", err);
    TRY_ROOM(t->place, t->n_places, "scenes", err);
    for (size_t i = 0; i < r->n_records; i++) {
        pthread_mutex_init(&t->record[i].lock, NULL);
        t->record[i].rate_per_year = replicate_rate(&t->plan, recipe_record(r, i));
    }
    for (size_t i = 0; i < t->n_places; i++)
        pthread_mutex_init(&t->place[i].lock, NULL);
    TRY_ROOM(t->worker, t->n_places * t->n_workers, "scenes", err);
    TRY_ROOM(t->at, t->n_workers, "workers", err);

    /* 2. The scenes of a search, for every worker; of a sweep the building alone is read now. */
    for (size_t i = 0; !r->is_sweep && i < r->n_scenes * t->n_workers; i++) {
        Err why = {0};
        const Status status = attach(t, i / t->n_workers, i % t->n_workers, &unused, &why);
        if (status != STATUS_OK)
            return fail(err, status, "%s%s", i < t->n_workers ? "" : "motion.records: ", why.text);
    }
    if (r->is_sweep)
        TRY(tower_space(s, space, err));
    else
        *space = *scene_design(t->place[0].scenario->scene);

    /* 3. Objectives and variables. */
    TRY(measures_order(&t->order, s->search.objectives, s->search.limits, space->n_floors, err));
    design_bounds(space, &s->design, t->lower, t->upper);
    for (int j = 0; j < space->n_var; j++)
        if (design_is_log(space, j) || design_word(space, j, 0)) {
            t->has_kinds = 1;
            t->kind[j] = design_is_log(space, j) ? VARIABLE_LOG : VARIABLE_CHOICE;
        }
    TRY(set_steps(t, &s->design, err));

    /* 4. Processes, which are forked with all of this. */
    t->isolated.doer = (Doer){.simulator = &HERE, .self = t, .n_var = space->n_var};
    t->isolated.lost = write_lost;
    return s->run.isolate == SWITCH_ON ? isolated_open(&t->isolated, t->n_workers, err) : STATUS_OK;
}

/* The problem of a recipe, which it takes, for free; with the ranks of a cluster, where this process has some. */
static Status open_recipe(Problem *p, Recipe *recipe, size_t n_tasks, Err *err)
{
    const Settings *s = &recipe->settings;
    const size_t workers = threads_wanted(s->search.threads);
    Tower *t = calloc(1, sizeof *t);
    if (!t) {
        free(recipe);
        return fail_memory(err, 1, "a scene");
    }
    t->recipe = recipe;
    t->n_workers = MIN_OF(workers, n_tasks);
    t->plan = replicate_plan(&s->sim, recipe->is_sweep ? 1 : recipe->n_records);
    const Status status = prepare(t, err);
    if (status != STATUS_OK) {
        tower_close(t);
        return status;
    }
    *p = (Problem){.n_var = t->design.n_var,
                   .n_obj = t->order.n_obj,
                   .n_extra = t->order.n - t->order.n_obj,
                   .lower = t->lower,
                   .upper = t->upper,
                   .kind = t->has_kinds ? t->kind : NULL,
                   .steps = t->steps,
                   .repair = swap_if_top_heavy,
                   .simulator = &TOWER,
                   .self = t,
                   .n_parts = t->plan.n_records * t->plan.n_replicates,
                   .n_cheap = t->plan.n_replicates > 1 ? t->plan.n_records : 0,
                   .part_size = sizeof(Measured),
                   .n_workers = t->n_workers};
    if (n_tasks > 1) {
        p->recipe = recipe;
        p->recipe_size = recipe_size(recipe->n_records, recipe->n_scenes);
        p->inputs = recipe->is_sweep ? 0 : scene_building(t->place[0].scenario->scene)->hash;
        for (size_t r = 0; !recipe->is_sweep && r < recipe->n_records; r++)
            p->inputs = (p->inputs ^ t->record[r].motion.file_hash ^ t->record[r].motion.forces_hash) * HASH_PRIME;
        executor_choose(p);
    }
    return STATUS_OK;
}

static Status make_recipe(Recipe **out, const Settings *s, size_t n_records, size_t n_scenes, Err *err)
{
    if (s->problem.kind != PROBLEM_TOWER)
        return bad_data(err, "problem.kind: this needs problem.kind = tower, which alone has a building, a core and a "
                             "motion");
    *out = calloc(1, recipe_size(n_records, n_scenes));
    if (!*out)
        return fail_memory(err, n_scenes, "scenes");
    **out = (Recipe){.settings = *s, .n_records = n_records, .n_scenes = n_scenes};
    return STATUS_OK;
}

/* The records of a study. */
typedef struct {
    size_t n;
    int needs_rates; /* each has to say how often it comes */
    char path[TOWER_RECORDS_MAX][OPTION_TEXT_MAX];
} RecordList;

/* Add a record to the list once it is known to be there, and how often it comes where that is needed. */
static Status list_record(const char *source, void *user, Err *err)
{
    RecordList *list = user;
    const char *key = list->n > 0 ? "motion.records" : "motion.record";
    Source s;
    Err why;
    if (list->n == TOWER_RECORDS_MAX)
        return bad_data(err, "motion.records: more than %d records", TOWER_RECORDS_MAX);
    TRY(source_read(source, &s, err));
    if (list->n > 0 && !builtin_name(s.path) && access(s.path, F_OK) != 0) {
        fail_missing(&why, s.path);
        return fail(err, why.code, "%s: %s", key, why.text);
    }
    if (list->needs_rates && !(s.rate > 0))
        return bad_data(err,
                        "%s: %s: annual_loss wants the events of a year that every record stands for: write "
                        "rate=NUMBER behind it",
                        key, source);
    return option_put_path(list->path[list->n++], source, err);
}

/* List motion.record alone, or all of the study; a sum over them, annual_loss, wants more of them and of the
 * settings. */
static Status list_records(const Settings *s, TowerUse use, RecordList *list, Err *err)
{
    MeasureOrder order;
    MotionOptions scaled = s->motion;
    char scaling[SCALINGS_TEXT_MAX];
    TRY(measures_order(&order, s->search.objectives, s->search.limits, 0, err));
    if (use == TOWER_SINGLE)
        return list_record(s->motion.record, list, err);
    list->needs_rates = (order.objectives | order.limited) >> MEASURE_ANNUAL_LOSS & 1;
    if (list->needs_rates && (s->sim.robust != ROBUST_MEAN || s->sim.quantile > 0))
        return bad_data(err, "sim.robust: annual_loss (search.objectives or search.limits) is a sum over the records, "
                             "as many times their mean: set sim.robust = mean");
    scaled.factor = 1;
    if (list->needs_rates && motion_scalings(&scaled, scaling) > 0)
        return bad_data(err,
                        "%s: annual_loss (search.objectives or search.limits) wants every record as strong as the "
                        "events that it stands for: write factor=NUMBER behind each, and leave this out",
                        scaling);
    return suite_of_study(&s->motion, list_record, list, err);
}

Status tower_open(Problem *p, const Settings *s, TowerUse use, size_t n_tasks, Err *err)
{
    RecordList *list;
    Recipe *r;
    TRY_ROOM(list, 1, "a list of records", err);
    Status status = list_records(s, use, list, err);
    THEN(status, make_recipe(&r, s, list->n, list->n, err));
    if (status == STATUS_OK) {
        memcpy(recipe_record(r, 0), list->path, list->n * sizeof list->path[0]);
        for (size_t i = 0; i < list->n; i++)
            r->scene[i].record = i;
        if (use == TOWER_SINGLE)
            r->settings.sim.replicates = 1;
        status = open_recipe(p, r, n_tasks, err);
    }
    free(list);
    return status;
}

Status tower_open_scenes(Problem *p, const Settings *s, size_t n_records, const char *const records[], size_t n_scenes,
                         const SceneChange scenes[], Err *err)
{
    Recipe *r;
    TRY(make_recipe(&r, s, n_records, n_scenes, err));
    r->is_sweep = 1;
    memcpy(r->scene, scenes, n_scenes * sizeof *scenes);
    Status status = STATUS_OK;
    for (size_t i = 0; i < n_records && status == STATUS_OK; i++)
        status = option_put_path(recipe_record(r, i), records[i], err);
    if (status == STATUS_OK)
        return open_recipe(p, r, SIZE_MAX, err);
    free(r);
    return status;
}

Status tower_reopen(Problem *p, const Recipe *recipe, Err *err)
{
    Recipe *own;
    TRY(make_recipe(&own, &recipe->settings, recipe->n_records, recipe->n_scenes, err));
    memcpy(own, recipe, recipe_size(recipe->n_records, recipe->n_scenes));
    return open_recipe(p, own, SIZE_MAX, err);
}

const Tower *tower_of(const Problem *p)
{
    return p->simulator == &TOWER ? p->self : NULL;
}

const DesignSpace *tower_design(const Tower *t)
{
    return &t->design;
}

size_t tower_n_records(const Tower *t)
{
    return t->plan.n_records;
}

ReplicatePlan tower_plan(const Tower *t, size_t n)
{
    ReplicatePlan plan = t->plan;
    plan.n_records = MIN_OF(n, plan.n_records);
    plan.n_replicates = n / plan.n_records;
    return plan;
}

const MeasureOrder *tower_measures(const Tower *t)
{
    return &t->order;
}

const Scenario *tower_record(const Tower *t, size_t i)
{
    return t->place[i].scenario;
}

/* -- simulations outside a search ---------------------------------------------------------------------------------- */

Variant tower_variant(const Tower *t, const SimTask *task)
{
    const LinearDevice *d = &task->device;
    return (Variant){.kind = task->kind,
                     .is_brief = task->is_brief,
                     .scene = task->scene + task->level * t->recipe->n_scenes,
                     .device = {d->tmd_hz, d->tmd_damping, d->link_ns_m}};
}

void tower_standard_errors(const Tower *t, const SimResult by_record[], double error[N_MEASURES])
{
    const ReplicatePlan plan = tower_plan(t, t->plan.n_records);
    Measured parts[TOWER_RECORDS_MAX];
    ReplicateSummary sum;
    for (size_t i = 0; i < plan.n_records; i++)
        parts[i] = measured(&by_record[i]);
    replicates_summarise(&plan, parts, sizeof *parts, 1, &sum);
    memcpy(error, sum.error, sizeof sum.error);
}

/* Ask a queue of its own for all tasks. Some more are under way at once than there are workers: parts of all would need
 * memory. */
Status tower_run(const Problem *p, size_t n, const SimTask tasks[], SimTell *tell, void *user, Err *err)
{
    Queue *q;
    Problem own = *p;
    size_t n_simulations = 0;
    int is_full = 0;
    own.observer.done = NULL;
    own.order = NULL;
    own.n_parts = 1;
    for (size_t i = 0; i < n; i++) {
        n_simulations += MAX_OF(tasks[i].n_parts, 1);
        own.n_parts = MAX_OF(tasks[i].n_parts, own.n_parts);
        is_full |= tasks[i].result != NULL;
    }
    own.part_size = is_full ? sizeof(FullResult) : own.part_size;
    own.n_workers = MIN_OF(n_simulations, own.n_workers);
    if (own.n_workers < 2)
        own.executor = NULL;
    TRY(queue_open(&q, &own, err));
    Status status = STATUS_OK;
    for (size_t asked = 0, i = 0; i < n && status == STATUS_OK;) {
        Finished done;
        if (asked < n && queue_pending(q) < 4 * own.n_workers) {
            const SimTask *task = &tasks[asked++];
            Asked design = {.x = task->x, .variant = tower_variant(p->self, task), .n_parts = MAX_OF(task->n_parts, 1)};
            design.variant.is_full = is_full;
            status = queue_ask(q, &design, err);
        } else if ((status = queue_next(q, &done, err)) == STATUS_OK) {
            /* A task that is done gets what it wants of its parts. */
            const SimTask *task = &tasks[i++];
            const size_t n_parts = MAX_OF(task->n_parts, 1);
            const ReplicatePlan plan = tower_plan(p->self, n_parts);
            ReplicateSummary sum;
            replicates_summarise(&plan, done.parts, own.part_size, task->summary != NULL, &sum);
            if (task->summary)
                *task->summary = sum;
            if (task->result)
                *task->result = ((const FullResult *)measured_part(done.parts, own.part_size, sum.shown))->result;
            for (size_t k = 0; task->parts && k < n_parts; k++)
                task->parts[k] = *measured_part(done.parts, own.part_size, k);
            if (tell)
                tell(i, user);
        }
    }
    queue_close(q);
    return status;
}

Status tower_simulate(const Problem *p, size_t n, const SimTask tasks[], SimResult results[], Err *err)
{
    SimTask *own;
    TRY_ROOM(own, n, "simulations", err);
    for (size_t i = 0; i < n; i++) {
        own[i] = tasks[i];
        own[i].result = &results[i];
    }
    const Status status = tower_run(p, n, own, NULL, NULL, err);
    free(own);
    return status;
}

Status tower_replicate(const Problem *p, size_t n, const double X[], SimResult shown[], ReplicateSummary out[],
                       Err *err)
{
    SimTask *tasks;
    TRY_ROOM(tasks, n, "designs", err);
    for (size_t i = 0; i < n; i++)
        tasks[i] = (SimTask){.x = X + i * p->n_var, .n_parts = p->n_parts, .summary = &out[i]};
    const Status status = tower_simulate(p, n, tasks, shown, err);
    free(tasks);
    return status;
}
