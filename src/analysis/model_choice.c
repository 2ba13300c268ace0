#include "analysis/model_choice.h"

#include "motion/suite.h"
#include "settings/settings.h"

enum { DESIGNS = 3, COPIES = 3, SIMULATIONS_MIN = 60 };
static const double SHARE = 0.03;

/* What adds up over time: it hangs on the weak end of a record, where peaks do not. */
static const MeasureSet ADDED_UP = (MeasureSet)1 << MEASURE_ED1 | (MeasureSet)1 << MEASURE_ED5_10 |
                                   (MeasureSet)1 << MEASURE_EDCS | (MeasureSet)1 << MEASURE_INPUT |
                                   (MeasureSet)1 << MEASURE_BALANCE | (MeasureSet)1 << MEASURE_IMPACTS |
                                   (MeasureSet)1 << MEASURE_PLASTIC_DRIFT | (MeasureSet)1 << MEASURE_RESIDUAL_DRIFT |
                                   (MeasureSet)1 << MEASURE_HYSTERESIS | (MeasureSet)1 << MEASURE_DEVICE_SHARE;

/* A case by a model: the design, whose copies tell the time, and the other scenes. */
typedef struct {
    Measured scene[LADDER_SCENES], copy[COPIES];
    double least_s;
} Tried;

typedef struct {
    size_t record;
    const double *x;
    Tried all, set; /* by all effects, by the set at hand */
} Case;

typedef struct {
    Settings s, all;
    Ladder *l;
    const Observer *stop;
    MeasureSet judged;                     /* by the study */
    size_t n_records, n_cases, most, used; /* most: simulations that may be used */
    char record[TOWER_RECORDS_MAX][OPTION_TEXT_MAX];
    Measured bare[TOWER_RECORDS_MAX]; /* the building alone by the model with all; of records that some case has had */
    unsigned char has_bare[TOWER_RECORDS_MAX];
    size_t n_copies;                  /* with which a set is tried */
    double variance[LADDER_MEASURES]; /* relative, of structures as built; summed over the cases */
    double X[DESIGNS * DESIGN_VARIABLES_MAX];
    Case *at; /* (n_cases) */
} Choosing;

/* -- what is open -------------------------------------------------------------------------------------------------- */

static Status take_record(const char *source, void *user, Err *err)
{
    Choosing *c = user;
    if (c->n_records == TOWER_RECORDS_MAX)
        return bad_data(err, "motion.records: more than %d records", TOWER_RECORDS_MAX);
    return option_put_path(c->record[c->n_records++], source, err);
}

/* A tower whose scene i has record i of these. */
static Status open_records(Choosing *c, Problem *p, const Settings *s, Err *err)
{
    const char *path[TOWER_RECORDS_MAX];
    SceneChange scene[TOWER_RECORDS_MAX] = {{0}};
    for (size_t i = 0; i < c->n_records; i++) {
        path[i] = c->record[i];
        scene[i].record = i;
    }
    return tower_open_scenes(p, s, c->n_records, path, c->n_records, scene, err);
}

/* Where the strong part of all records is over; INFINITY: behind the end of one of them. */
static Status find_strong_part(Choosing *c, double *strong_s, Err *err)
{
    Problem p;
    Building b;
    Motion m;
    double shortest = INFINITY;
    *strong_s = 0;
    TRY(building_load(&b, &c->s.building, err));
    const double period = 2 * M_PI / b.omega[0];
    building_free(&b);
    TRY(open_records(c, &p, &c->s, err));
    Status status = STATUS_OK;
    for (size_t i = 0; i < c->n_records && (status = tower_motion(&p, i, &m, err)) == STATUS_OK; i++) {
        *strong_s = fmax(*strong_s, motion_strong_part(&m, period));
        shortest = fmin(shortest, motion_duration(&m));
        motion_free(&m);
    }
    problem_close(&p);
    *strong_s = *strong_s < shortest ? *strong_s : INFINITY;
    return status;
}

/* The effects of the scene; those that are not open are kept as the settings have them. */
static Status open_effects(Choosing *c, Err *err)
{
    const Settings *s = &c->s;
    double strong_s;
    TRY(find_strong_part(c, &strong_s, err));
    TRY(ladder_effects(s, strong_s, c->l, &c->all, err));
    for (size_t i = 0; i < c->l->n; i++) {
        LadderEffect *e = &c->l->effect[i];
        if (strcmp(e->key, "sim.duration_s") == 0)
            e->is_set |= c->judged & ADDED_UP || isinf(strong_s);
        e->is_kept = e->is_set;
        if (e->is_set)
            memcpy(e->without, e->with, sizeof e->without);
    }
    for (int k = 0; k < LADDER_MEASURES; k++)
        c->l->tolerance[k] = LADDER_TOLERANCE;
    return STATUS_OK;
}

static Status begin(Choosing **out, const Settings *s, const Observer *stop, Ladder *l, Err *err)
{
    Choosing *c;
    MeasureOrder order;
    TRY_ROOM(c, 1, "the choice of a model", err);
    *out = c;
    TRY(measures_order(&order, s->search.objectives, s->search.limits, 0, err));
    TRY(suite_of_study(&s->motion, take_record, c, err));
    const double all = (double)s->search.max_evals * (double)s->sim.replicates * (double)c->n_records;
    c->most = MAX_OF((size_t)(SHARE * all), (size_t)SIMULATIONS_MIN);
    c->judged = order.judged;
    c->s = *s;
    c->l = l;
    c->stop = stop;
    return ladder_judge(&c->s, err);
}

/* -- simulations --------------------------------------------------------------------------------------------------- */

static Status run_tasks(Choosing *c, Problem *p, size_t n, const SimTask task[], Err *err)
{
    p->observer = *c->stop;
    for (size_t i = 0; i < n; i++)
        c->used += MAX_OF(task[i].n_parts, 1);
    const Status status = tower_run(p, n, task, NULL, NULL, err);
    problem_close(p);
    return status;
}

/* Of the same design: other processes disturb. */
static void take_copies(Tried *t, size_t n)
{
    t->scene[0] = t->copy[0];
    t->least_s = t->copy[0].seconds;
    for (size_t i = 1; i < n; i++)
        t->least_s = fmin(t->least_s, t->copy[i].seconds);
}

/* Every case in all scenes by those settings: by the set, or is_all. */
static Status simulate_cases(Choosing *c, const Settings *with, int is_all, Err *err)
{
    Problem p;
    SimTask *task;
    Settings s = *with;
    Measured bare[TOWER_RECORDS_MAX];
    int wants_bare[TOWER_RECORDS_MAX] = {0};
    size_t n = 0;
    s.sim.replicates = (long)c->n_copies;
    TRY_ROOM(task, c->n_cases * (LADDER_SCENES - 1) + c->n_records, "simulations", err);
    for (size_t i = 0; i < c->n_cases; i++) {
        Case *k = &c->at[i];
        Tried *t = is_all ? &k->all : &k->set;
        task[n++] = (SimTask){.x = k->x, .scene = k->record, .n_parts = c->n_copies, .parts = t->copy};
        task[n++] = (SimTask){.kind = SCENE_RIGID, .x = k->x, .scene = k->record, .parts = &t->scene[1]};
        wants_bare[k->record] = 1;
    }
    for (size_t r = 0; r < c->n_records; r++)
        if (wants_bare[r])
            task[n++] = (SimTask){.kind = SCENE_NO_CORE, .scene = r, .parts = &bare[r]};
    Status status = open_records(c, &p, &s, err);
    THEN(status, run_tasks(c, &p, n, task, err));
    for (size_t i = 0; i < c->n_cases && status == STATUS_OK; i++) {
        Tried *t = is_all ? &c->at[i].all : &c->at[i].set;
        take_copies(t, c->n_copies);
        t->scene[2] = bare[c->at[i].record];
    }
    free(task);
    return status;
}

/* The set in all cases, and how far it is from all effects at most. */
static Status try_set(Choosing *c, int *is_enough, Err *err)
{
    Ladder *l = c->l;
    Settings s = c->s;
    int scene;
    TRY(ladder_put_set(l, &s, err));
    TRY(simulate_cases(c, &s, 0, err));
    memset(l->off, 0, sizeof l->off);
    l->all_s = l->set_s = 0;
    for (size_t i = 0; i < c->n_cases; i++) {
        const Case *k = &c->at[i];
        l->all_s += k->all.least_s / (double)c->n_cases;
        l->set_s += k->set.least_s / (double)c->n_cases;
        for (int j = 0; j < LADDER_SCENES; j++)
            for (int m = 0; m < LADDER_MEASURES; m++) {
                const double by = ladder_change(&k->set.scene[j], &k->all.scene[j], m);
                l->off[j][m] = fabs(by) <= fabs(l->off[j][m]) ? l->off[j][m] : by;
                if (i == 0)
                    l->set[j][m] = k->set.scene[j].value[LADDER_MEASURE[m]];
            }
    }
    *is_enough = ladder_largest(l, l->off, &scene) <= 1;
    return STATUS_OK;
}

/* What is left out and changes most joins the set until that is enough, or cannot be tried any more. */
static Status settle(Choosing *c, Err *err)
{
    for (size_t before = c->used;; before = c->used) {
        int is_enough;
        TRY(try_set(c, &is_enough, err));
        LadderEffect *back = ladder_largest_left_out(c->l);
        if (is_enough || !back)
            return STATUS_OK;
        back->is_kept = 1;
        if (2 * c->used - before > c->most)
            return STATUS_OK;
    }
}

/* -- each effect is left out --------------------------------------------------------------------------------------- */

/* The building alone has neither core nor contacts, and a rigid connection no contacts. */
static int reaches(const LadderEffect *e, SceneKind scene)
{
    return scene == SCENE_IMPACT ||
           (strncmp(e->key, "contact.", 8) != 0 && (scene == SCENE_RIGID || strncmp(e->key, "core.", 5) != 0));
}

/* Has effect i to be left out in that scene of a case? */
static int is_asked(const Choosing *c, const Case *k, size_t i, SceneKind scene)
{
    const LadderEffect *e = &c->l->effect[i];
    return !e->is_set && !e->is_needed && reaches(e, scene) && !(scene == SCENE_NO_CORE && c->has_bare[k->record]);
}

static size_t simulations_of(const Choosing *c, const Case *k)
{
    size_t n = COPIES + 1 + !c->has_bare[k->record];
    for (size_t i = 0; i < c->l->n; i++)
        for (int scene = 0; scene < LADDER_SCENES; scene++)
            n += is_asked(c, k, i, LADDER_SCENE[scene]);
    return n;
}

/* What a case says: the scatter as built, and what each effect changes. The model with all has worked in it. */
static void learn(Choosing *c, const Case *k, const ReplicateSummary *as_built,
                  const Measured without[LADDER_MAX][LADDER_SCENES])
{
    Ladder *l = c->l;
    for (int m = 0; m < LADDER_MEASURES; m++) {
        const double scatter = as_built->sd[LADDER_MEASURE[m]] / as_built->mean[LADDER_MEASURE[m]];
        c->variance[m] += isfinite(scatter) ? scatter * scatter : 0;
        l->tolerance[m] = fmax(LADDER_TOLERANCE, sqrt(c->variance[m] / (double)c->n_cases));
        if (c->n_cases == 1)
            l->value[m] = k->all.scene[0].value[LADDER_MEASURE[m]];
    }
    for (size_t i = 0; i < l->n; i++) {
        LadderEffect *e = &l->effect[i];
        double change[LADDER_SCENES][LADDER_MEASURES] = {{0}};
        int scene = 0;
        if (e->is_set || e->is_needed)
            continue;
        for (int s = 0; s < LADDER_SCENES; s++)
            for (int m = 0; m < LADDER_MEASURES && is_asked(c, k, i, LADDER_SCENE[s]); m++)
                change[s][m] = ladder_change(&without[i][s], &k->all.scene[s], m);
        const double most = ladder_largest(l, change, &scene);
        if (c->n_cases == 1 || most > e->most) {
            memcpy(e->change, change, sizeof change);
            e->most = most;
            e->decided_in = scene;
        }
        e->is_needed = e->is_kept = most > 1;
    }
}

/* Leave out each effect in a case; one in which the model with all fails is no case. */
static Status try_case(Choosing *c, size_t record, const double *x, Err *why, Err *err)
{
    const Ladder *l = c->l;
    Case *k = &c->at[c->n_cases];
    SceneChange scene[1 + LADDER_MAX] = {{0}};
    SimTask task[(1 + LADDER_MAX) * LADDER_SCENES];
    Measured without[LADDER_MAX][LADDER_SCENES];
    ReplicateSummary as_built;
    Settings s = c->all;
    Problem p;
    size_t n = 0;
    *k = (Case){.record = record, .x = x};
    ladder_as_built(&s.sim, COPIES);
    task[n++] = (SimTask){.x = x, .n_parts = COPIES, .parts = k->all.copy, .summary = &as_built};
    task[n++] = (SimTask){.kind = SCENE_RIGID, .x = x, .parts = &k->all.scene[1]};
    if (!c->has_bare[record])
        task[n++] = (SimTask){.kind = SCENE_NO_CORE, .parts = &c->bare[record]};
    for (size_t i = 0; i < l->n; i++) {
        snprintf(scene[1 + i].setting, sizeof scene->setting, "%s=%s", l->effect[i].key, l->effect[i].without);
        for (int j = 0; j < LADDER_SCENES; j++)
            if (is_asked(c, k, i, LADDER_SCENE[j]))
                task[n++] = (SimTask){.kind = LADDER_SCENE[j], .x = x, .scene = 1 + i, .parts = &without[i][j]};
    }
    TRY(tower_open_scenes(&p, &s, 1, &(const char *){c->record[record]}, 1 + l->n, scene, err));
    TRY(run_tasks(c, &p, n, task, err));
    take_copies(&k->all, COPIES);
    k->all.scene[2] = c->bare[record];
    for (int j = 0; j < LADDER_SCENES; j++)
        if (k->all.scene[j].outcome != RUN_OK) {
            bad_data(why,
                     "sim.model: the model with all effects fails (%s): %s; set sim.model = given, and the effects "
                     "that the scene needs",
                     SCENES[LADDER_SCENE[j]].words, k->all.scene[j].reason);
            return STATUS_OK;
        }
    c->n_cases++;
    learn(c, k, &as_built, without);
    c->has_bare[record] = 1;
    return STATUS_OK;
}

/* Designs whose gaps are spread up to where the bare building sways. */
static Status spread_designs(Choosing *c, DesignSpace *space, Err *err)
{
    Problem p;
    TRY(open_records(c, &p, &c->all, err));
    *space = *tower_design(tower_of(&p));
    TRY(run_tasks(c, &p, 1, &(SimTask){.kind = SCENE_NO_CORE, .parts = c->bare}, err));
    const double sway_m = c->bare[0].outcome == RUN_OK ? c->bare[0].value[MEASURE_J1] : INFINITY;
    c->has_bare[0] = 0; /* what each effect changes there is not known yet */
    for (size_t i = 0; i < DESIGNS; i++)
        design_spread(space, &c->s.design, i, DESIGNS, sway_m, c->X + i * (size_t)space->n_var);
    return STATUS_OK;
}

/* Every design under every record: first each of both once. */
static Status try_cases(Choosing *c, size_t n_var, Err *err)
{
    const size_t n = c->n_records;
    Err why = {0};
    for (size_t i = 0; i < DESIGNS * n; i++) {
        const size_t record = i % n, design = (i + (n % DESIGNS == DESIGNS - 1 ? 0 : i / n)) % DESIGNS;
        const size_t to_try = (COPIES + 1) * (c->n_cases + 1) + MIN_OF(n, c->n_cases + 1);
        if (c->n_cases > 0 && c->used + simulations_of(c, &(Case){.record = record}) + to_try > c->most)
            break;
        TRY(try_case(c, record, c->X + design * n_var, &why, err));
    }
    if (c->n_cases == 0)
        *err = why;
    return c->n_cases > 0 ? STATUS_OK : why.code;
}

/* -- all of it ----------------------------------------------------------------------------------------------------- */

static Status choose(Choosing *c, Err *err)
{
    DesignSpace space;
    size_t n_open = 0;
    c->n_copies = COPIES;
    TRY(open_effects(c, err));
    for (size_t i = 0; i < c->l->n; i++)
        n_open += !c->l->effect[i].is_set;
    if (n_open == 0)
        return STATUS_OK;
    TRY_ROOM(c->at, DESIGNS * c->n_records, "designs", err);
    TRY(spread_designs(c, &space, err));
    TRY(try_cases(c, (size_t)space.n_var, err));
    return settle(c, err);
}

static void end(Choosing *c)
{
    if (c)
        free(c->at);
    free(c);
}

Status model_choose(Settings *s, const Observer *stop, ModelChoice *out, Err *err)
{
    Choosing *c = NULL;
    *out = (ModelChoice){.n_designs = DESIGNS};
    Status status = begin(&c, s, stop, &out->ladder, err);
    THEN(status, choose(c, err));
    THEN(status, ladder_put_set(&out->ladder, s, err));
    if (status == STATUS_OK) {
        out->n_records = c->n_records;
        out->n_cases = c->n_cases;
        out->n_simulations = c->used;
    }
    end(c);
    return status;
}

/* As many designs under records as can be tried three times, by all effects; one in which these fail is no case. */
static Status list_cases(Choosing *c, size_t n, size_t n_var, const double X[], Err *err)
{
    c->all = c->s;
    c->n_copies = 1;
    for (size_t i = 0; i < c->l->n; i++)
        if (!c->l->effect[i].is_set)
            TRY(settings_put(&c->all, c->l->effect[i].key, c->l->effect[i].with, err));
    TRY_ROOM(c->at, n * c->n_records, "designs", err);
    for (size_t i = 0; i < n * c->n_records && 3 * (2 * (i + 1) + c->n_records) <= c->most; i++)
        c->at[c->n_cases++] = (Case){.record = i % c->n_records, .x = X + i / c->n_records * n_var};
    TRY(simulate_cases(c, &c->all, 1, err));
    size_t n_known = 0;
    for (size_t i = 0; i < c->n_cases; i++) {
        int works = 1;
        for (int scene = 0; scene < LADDER_SCENES; scene++)
            works &= c->at[i].all.scene[scene].outcome == RUN_OK;
        if (works)
            c->at[n_known++] = c->at[i];
    }
    c->n_cases = n_known;
    return STATUS_OK;
}

static Status confirm(Choosing *c, ModelCase cases[], Err *err)
{
    int is_enough;
    if (c->n_cases == 0)
        return STATUS_OK;
    TRY(try_set(c, &is_enough, err));
    for (size_t i = 0; i < c->n_cases; i++)
        cases[i] = (ModelCase){.x = c->at[i].x, .record = c->at[i].record, .by_set = c->at[i].set.scene[0]};
    LadderEffect *back = ladder_largest_left_out(c->l);
    if (!is_enough && back) {
        back->is_kept = 1;
        TRY(settle(c, err));
    }
    for (size_t i = 0; i < c->n_cases; i++)
        cases[i].by_more = c->at[i].set.scene[0];
    return STATUS_OK;
}

Status model_confirm(const Settings *s, size_t n, size_t n_var, const double X[], const Observer *stop, Ladder *l,
                     ModelCase **cases, size_t *n_cases, Err *err)
{
    Choosing *c = NULL;
    *cases = NULL;
    Status status = begin(&c, s, stop, l, err);
    THEN(status, list_cases(c, n, n_var, X, err));
    if (status == STATUS_OK && !(*cases = calloc(c->n_cases + 1, sizeof **cases)))
        status = fail_memory(err, c->n_cases, "designs");
    THEN(status, confirm(c, *cases, err));
    *n_cases = status == STATUS_OK ? c->n_cases : 0;
    end(c);
    return status;
}
