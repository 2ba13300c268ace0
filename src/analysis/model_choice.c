#include "analysis/model_choice.h"

#include "motion/suite.h"
#include "settings/settings.h"

enum { DESIGNS = 3, COPIES = 3, STRUCTURES = 8, SIMULATIONS_MIN = 60 };
enum { BARE = LADDER_SCENES - 1 }; /* of LADDER_SCENE: the building alone */
static const double SHARE = 0.03, GAP_SD_M = 1e-3;

/* What adds up over time: it hangs on the weak end of a record, where peaks do not. */
static const MeasureSet ADDED_UP = (MeasureSet)1 << MEASURE_ED1 | (MeasureSet)1 << MEASURE_ED5_10 |
                                   (MeasureSet)1 << MEASURE_EDCS | (MeasureSet)1 << MEASURE_INPUT |
                                   (MeasureSet)1 << MEASURE_BALANCE | (MeasureSet)1 << MEASURE_IMPACTS |
                                   (MeasureSet)1 << MEASURE_PLASTIC_DRIFT | (MeasureSet)1 << MEASURE_RESIDUAL_DRIFT |
                                   (MeasureSet)1 << MEASURE_HYSTERESIS | (MeasureSet)1 << MEASURE_DEVICE_SHARE;

/* A case by a model: the design, whose copies tell the time, and the other scenes. */
typedef struct {
    Measured scene[LADDER_SCENES], copy[STRUCTURES];
    double least_s;
} Tried;

typedef struct {
    size_t record;
    const double *x;
    Tried all, set;                /* by all effects, by the set at hand */
    Measured added[LADDER_SCENES]; /* by all and the effect that is added to them */
} Case;

typedef struct {
    LadderForm form;
    Settings s, all;
    Ladder *l;
    Observer stop;
    MeasureSet judged;                     /* by the study */
    size_t n_records, n_cases, most, used; /* most: simulations that may be used */
    char record[TOWER_RECORDS_MAX][OPTION_TEXT_MAX];
    Measured bare[TOWER_RECORDS_MAX]; /* the building alone by the model with all; of records that some case has had */
    unsigned char has_bare[TOWER_RECORDS_MAX];
    size_t n_structures;              /* as built, by all effects */
    size_t n_each, n_copies;          /* of the design without an effect, and by a set */
    double variance[LADDER_MEASURES]; /* relative, of structures as built; summed over the cases */
    double whole_s;                   /* sim.duration_s as it is given */
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

/* The effects of the scene; in a study's choice those that are not open are kept as the settings have them. */
static Status open_effects(Choosing *c, Err *err)
{
    Problem p;
    const Scenario *w;
    double strong_s = 0, shortest = INFINITY; /* where the strong part of all records is over; the shortest record */
    TRY(open_records(c, &p, &c->s, err));
    Status status = STATUS_OK;
    for (size_t i = 0; i < c->n_records && (status = tower_acquire(p.self, i, &w, err)) == STATUS_OK; i++) {
        strong_s = fmax(strong_s, motion_strong_part(&w->motion, 2 * M_PI / scene_building(w->scene)->omega[0]));
        shortest = fmin(shortest, motion_duration(&w->motion));
        tower_release(p.self, i);
    }
    problem_close(&p);
    TRY(status);
    if (c->form == LADDER_BRIEF && strong_s < (c->whole_s > 0 ? c->whole_s : shortest))
        c->s.sim.duration_s = strong_s;
    TRY(ladder_effects(&c->s, strong_s, c->form, c->l, &c->all, err));
    for (size_t i = 0; i < c->l->n && c->form == LADDER_OPEN; i++) {
        LadderEffect *e = &c->l->effect[i];
        if (strcmp(e->key, "sim.duration_s") == 0)
            e->is_set |= c->judged & ADDED_UP || !(strong_s < shortest);
        e->is_kept = e->is_set;
        if (e->is_set)
            memcpy(e->without, e->with, sizeof e->without);
    }
    return STATUS_OK;
}

static Status begin(Choosing **out, const Settings *s, Ladder *l, Err *err)
{
    TRY_ROOM(*out, 1, "the choice of a model", err);
    Choosing *c = *out;
    c->s = *s;
    c->whole_s = s->sim.duration_s;
    c->l = l;
    c->s.sim.forces = FORCES_AUTO;
    TRY(settings_put(&c->s, "search.objectives", "j1_m, drift_ratio, j3_g", err)); /* LADDER_MEASURE */
    return settings_put(&c->s, "search.limits", "none", err);
}

/* Of a study: its records, and what it may cost. */
static Status begin_study(Choosing **out, const Settings *s, const Observer *stop, Ladder *l, Err *err)
{
    MeasureOrder order;
    TRY(begin(out, s, l, err));
    Choosing *c = *out;
    TRY(measures_order(&order, s->search.objectives, s->search.limits, 0, err));
    TRY(suite_of_study(&s->motion, take_record, c, err));
    const double all = (double)s->search.max_evals * (double)s->sim.replicates * (double)c->n_records;
    c->form = LADDER_OPEN;
    c->most = MAX_OF((size_t)(SHARE * all), (size_t)SIMULATIONS_MIN);
    c->judged = order.judged;
    c->stop = *stop;
    c->n_structures = c->n_copies = COPIES;
    c->n_each = 1;
    return STATUS_OK;
}

/* -- simulations --------------------------------------------------------------------------------------------------- */

static Status run_tasks(Choosing *c, Problem *p, size_t n, const SimTask task[], Err *err)
{
    p->observer = c->stop;
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

/* Scene j of a case: of the design n parts, which are its copies. */
static SimTask task_of(Tried *t, int j, size_t n, const Case *k, size_t scene)
{
    return (SimTask){.kind = LADDER_SCENE[j],
                     .x = k->x,
                     .scene = scene,
                     .n_parts = j == 0 ? n : 1,
                     .parts = j == 0 ? t->copy : &t->scene[j]};
}

/* The first scene that fails, or LADDER_SCENES. */
static int failing(const Tried *t)
{
    int j = 0;
    while (j < LADDER_SCENES && t->scene[j].outcome == RUN_OK)
        j++;
    return j;
}

/* Every case in all scenes by those settings: by the set, or is_all. Cases under the same record have the building
 * alone in common, which the first of them simulates. */
static Status simulate_cases(Choosing *c, const Settings *with, int is_all, Err *err)
{
    Problem p;
    SimTask *task;
    Settings s = *with;
    const Measured *bare[TOWER_RECORDS_MAX] = {NULL};
    size_t n = 0;
    s.sim.replicates = (long)c->n_copies;
    TRY_ROOM(task, c->n_cases * LADDER_SCENES, "simulations", err);
    for (size_t i = 0; i < c->n_cases; i++) {
        Case *k = &c->at[i];
        Tried *t = is_all ? &k->all : &k->set;
        for (int j = 0; j < (bare[k->record] ? BARE : LADDER_SCENES); j++)
            task[n++] = task_of(t, j, c->n_copies, k, k->record);
        bare[k->record] = bare[k->record] ? bare[k->record] : &t->scene[BARE];
    }
    Status status = open_records(c, &p, &s, err);
    THEN(status, run_tasks(c, &p, n, task, err));
    for (size_t i = 0; i < c->n_cases && status == STATUS_OK; i++) {
        Tried *t = is_all ? &c->at[i].all : &c->at[i].set;
        take_copies(t, c->n_copies);
        t->scene[BARE] = *bare[c->at[i].record];
        for (int j = 0; j < LADDER_SCENES && i == 0 && !is_all; j++)
            for (int m = 0; m < LADDER_MEASURES; m++)
                c->l->set[j][m] = t->scene[j].outcome == RUN_OK ? t->scene[j].value[LADDER_MEASURE[m]] : NAN;
    }
    free(task);
    return status;
}

/* The set in all cases, and how far it is from all effects at most. */
static Status try_set(Choosing *c, int *is_enough, Err *err)
{
    Ladder *l = c->l;
    const LadderEffect *last = &l->effect[l->n - 1];
    Settings s = c->s;
    int scene;
    TRY(ladder_put_set(l, &s, err));
    TRY(simulate_cases(c, &s, 0, err));
    memset(l->off, 0, sizeof l->off);
    l->all_s = l->set_s = 0;
    for (size_t i = 0; i < c->n_cases; i++) {
        const Case *k = &c->at[i];
        const Measured *whole = last->is_added && last->is_kept ? k->added : k->all.scene;
        l->all_s += k->all.least_s / (double)c->n_cases;
        l->set_s += k->set.least_s / (double)c->n_cases;
        for (int j = 0; j < LADDER_SCENES; j++)
            for (int m = 0; m < LADDER_MEASURES; m++) {
                const double by = ladder_change(&k->set.scene[j], &whole[j], m);
                l->off[j][m] = fabs(by) <= fabs(l->off[j][m]) ? l->off[j][m] : by;
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
        ladder_keep(c->l, back);
        if (2 * c->used - before > c->most)
            return STATUS_OK;
    }
}

/* -- each effect is left out --------------------------------------------------------------------------------------- */

/* The building alone has neither core nor contacts; a rigid connection has no contacts, but may be off the centre. */
static int reaches(const LadderEffect *e, SceneKind scene)
{
    const int is_of_contacts = strncmp(e->key, "contact.", 8) == 0, is_of_core = strncmp(e->key, "core.", 5) == 0;
    return scene == SCENE_IMPACT ||
           (scene == SCENE_RIGID ? !is_of_contacts || strcmp(e->key, "contact.eccentricity") == 0
                                 : !is_of_contacts && !is_of_core);
}

/* A ladder asks what the settings have too. */
static int is_open(const Choosing *c, const LadderEffect *e)
{
    return c->form != LADDER_OPEN || !e->is_set;
}

/* Has effect i to be left out in that scene of a case? */
static int is_asked(const Choosing *c, const Case *k, size_t i, SceneKind scene)
{
    const LadderEffect *e = &c->l->effect[i];
    return is_open(c, e) && !e->is_needed && reaches(e, scene) && !(scene == SCENE_NO_CORE && c->has_bare[k->record]);
}

/* What each effect changes in a case, and how the design scatters as built, over all cases. The model with all has
 * worked in it. */
static void learn(Choosing *c, Case *k, const ReplicateSummary *as_built, const Tried without[LADDER_MAX])
{
    Ladder *l = c->l;
    for (int m = 0; m < LADDER_MEASURES; m++) {
        const double scatter = as_built->sd[LADDER_MEASURE[m]] / as_built->mean[LADDER_MEASURE[m]];
        c->variance[m] += isfinite(scatter) ? scatter * scatter : 0;
        l->tolerance[m] = fmax(LADDER_TOLERANCE, sqrt(c->variance[m] / (double)c->n_cases));
    }
    for (size_t i = 0; i < l->n; i++) {
        LadderEffect *e = &l->effect[i];
        double change[LADDER_SCENES][LADDER_MEASURES] = {{0}};
        int scene = 0;
        if (!is_open(c, e) || e->is_needed)
            continue;
        for (int s = 0; s < LADDER_SCENES; s++)
            for (int m = 0; m < LADDER_MEASURES && is_asked(c, k, i, LADDER_SCENE[s]); m++) {
                const Measured *other = &without[i].scene[s], *whole = &k->all.scene[s];
                change[s][m] = e->is_added ? ladder_change(whole, other, m) : ladder_change(other, whole, m);
            }
        const double most = ladder_largest(l, change, &scene), less_s = k->all.least_s - without[i].least_s;
        if (c->n_cases == 1 || most > e->most) {
            memcpy(e->change, change, sizeof change);
            e->most = most;
            e->decided_in = scene;
        }
        if (c->form == LADDER_WHOLE)
            e->cost_s = e->is_added ? -less_s : less_s;
        if (e->is_added)
            memcpy(k->added, without[i].scene, sizeof k->added);
        e->is_needed = most > 1;
        if (e->is_needed)
            ladder_keep(l, e);
    }
    if (l->effect->is_added) /* nothing is left out of the model with all from here on */
        memcpy(k->all.scene, k->added, sizeof k->added);
    for (int m = 0; m < LADDER_MEASURES && c->n_cases == 1; m++)
        l->value[m] = k->all.scene[0].value[LADDER_MEASURE[m]];
}

/* Leave out each effect in a case; one in which the model with all fails is no case. */
static Status try_case(Choosing *c, size_t record, const double *x, Err *why, Err *err)
{
    const Ladder *l = c->l;
    Case *k = &c->at[c->n_cases];
    SceneChange scene[1 + LADDER_MAX] = {{0}};
    SimTask task[(1 + LADDER_MAX) * LADDER_SCENES];
    Tried without[LADDER_MAX];
    ReplicateSummary as_built;
    Settings s = c->all;
    Problem p;
    size_t n = 0;
    *k = (Case){.record = record, .x = x};
    s.sim.replicates = (long)c->n_structures;
    s.sim.gap_tolerance_m = s.sim.gap_tolerance_m > 0 ? s.sim.gap_tolerance_m : GAP_SD_M;
    for (int j = 0; j < LADDER_SCENES - c->has_bare[record]; j++)
        task[n++] = task_of(&k->all, j, c->n_structures, k, 0);
    task->summary = &as_built;
    k->all.scene[BARE] = c->bare[record];
    for (size_t i = 0; i < l->n; i++) {
        const LadderEffect *e = &l->effect[i];
        snprintf(scene[1 + i].setting, sizeof scene->setting, "%s=%s", e->key, e->is_added ? e->with : e->without);
        for (int j = 0; j < LADDER_SCENES; j++)
            if (is_asked(c, k, i, LADDER_SCENE[j]))
                task[n++] = task_of(&without[i], j, c->n_each, k, 1 + i);
    }
    TRY(tower_open_scenes(&p, &s, 1, &(const char *){c->record[record]}, 1 + l->n, scene, err));
    TRY(run_tasks(c, &p, n, task, err));
    take_copies(&k->all, c->n_copies); /* as many as of the set: their times are compared */
    for (size_t i = 0; i < l->n; i++)
        if (is_asked(c, k, i, SCENE_IMPACT))
            take_copies(&without[i], c->n_each);
    c->bare[record] = k->all.scene[BARE];
    const Tried *whole = l->effect->is_added && failing(&k->all) == LADDER_SCENES ? without : &k->all;
    const int fails = failing(whole);
    if (fails < LADDER_SCENES) {
        bad_data(why, "the model with all effects fails (%s): %s", SCENES[LADDER_SCENE[fails]].words,
                 whole->scene[fails].reason);
        return STATUS_OK;
    }
    c->n_cases++;
    learn(c, k, &as_built, without);
    c->has_bare[record] = 1;
    return STATUS_OK;
}

/* -- all of it ----------------------------------------------------------------------------------------------------- */

static Status choose(Choosing *c, Err *err)
{
    Problem p;
    DesignSpace space;
    Err why = {0};
    size_t n_open = 0;
    const size_t n = c->n_records;
    TRY(open_effects(c, err));
    for (size_t i = 0; i < c->l->n; i++)
        n_open += !c->l->effect[i].is_set;
    if (n_open == 0)
        return STATUS_OK;

    /* 1. Designs whose gaps are spread up to where the bare building sways. What each effect changes there is not known
     * yet. */
    TRY_ROOM(c->at, DESIGNS * n, "designs", err);
    TRY(open_records(c, &p, &c->all, err));
    space = *tower_design(tower_of(&p));
    TRY(run_tasks(c, &p, 1, &(SimTask){.kind = SCENE_NO_CORE, .parts = c->bare}, err));
    const double sway_m = c->bare[0].outcome == RUN_OK ? c->bare[0].value[MEASURE_J1] : INFINITY;
    for (size_t i = 0; i < DESIGNS; i++)
        design_spread(&space, &c->s.design, i, DESIGNS, sway_m, c->X + i * (size_t)space.n_var);

    /* 2. Every design under every record, first each of both once, as long as the set can still be tried. */
    for (size_t i = 0; i < DESIGNS * n; i++) {
        const size_t record = i % n, design = (i + (n % DESIGNS == DESIGNS - 1 ? 0 : i / n)) % DESIGNS;
        const Case k = {.record = record};
        size_t to_use = c->used + c->n_structures + 1 + !c->has_bare[record] + (COPIES + 1) * (c->n_cases + 1) +
                        MIN_OF(c->n_cases + 1, n); /* the building alone: once under each record */
        for (size_t e = 0; e < c->l->n; e++)
            for (int scene = 0; scene < LADDER_SCENES; scene++)
                to_use += is_asked(c, &k, e, LADDER_SCENE[scene]);
        if (c->n_cases > 0 && to_use > c->most)
            break;
        TRY(try_case(c, record, c->X + design * (size_t)space.n_var, &why, err));
    }
    return c->n_cases > 0
               ? settle(c, err)
               : bad_data(err, "sim.model: %s; set sim.model = given, and the effects that the scene needs", why.text);
}

static void end(Choosing *c)
{
    if (c)
        free(c->at);
    free(c);
}

/* One case, in which everything is asked; the set is tried as often as it takes. */
static Status climb(Choosing *c, const double x[], Err *err)
{
    Err why = {0};
    c->most = SIZE_MAX;
    c->n_structures = STRUCTURES;
    c->n_each = c->n_copies = c->form == LADDER_WHOLE ? COPIES : 1;
    TRY(take_record(c->s.motion.record, c, err));
    TRY(open_effects(c, err));
    TRY_ROOM(c->at, 1, "designs", err);
    TRY(try_case(c, 0, x, &why, err));
    if (c->n_cases == 0)
        return bad_data(err, "%s", why.text);
    TRY(settle(c, err));
    if (c->form == LADDER_BRIEF) /* one simulation tells no time: other processes disturb */
        c->l->all_s = c->l->set_s = NAN;
    if (c->s.sim.duration_s == c->whole_s)
        return STATUS_OK;
    c->s.sim.duration_s = c->whole_s; /* of which the values by the set are */
    TRY(ladder_put_set(c->l, &c->s, err));
    return simulate_cases(c, &c->s, 0, err);
}

Status ladder_find(const Settings *s, const double x[], LadderForm form, Ladder *out, Err *err)
{
    Choosing *c = NULL;
    Status status = begin(&c, s, out, err);
    if (status == STATUS_OK) {
        c->form = form;
        status = climb(c, x, err);
    }
    end(c);
    return status;
}

Status model_choose(Settings *s, const Observer *stop, ModelChoice *out, Err *err)
{
    Choosing *c = NULL;
    *out = (ModelChoice){.n_designs = DESIGNS};
    Status status = begin_study(&c, s, stop, &out->ladder, err);
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
    for (size_t i = 0; i < n * c->n_records && 3 * LADDER_SCENES * (i + 1) <= c->most; i++)
        c->at[c->n_cases++] = (Case){.record = i % c->n_records, .x = X + i / c->n_records * n_var};
    TRY(simulate_cases(c, &c->all, 1, err));
    size_t n_known = 0;
    for (size_t i = 0; i < c->n_cases; i++)
        if (failing(&c->at[i].all) == LADDER_SCENES)
            c->at[n_known++] = c->at[i];
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
        ladder_keep(c->l, back);
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
    Status status = begin_study(&c, s, stop, l, err);
    THEN(status, list_cases(c, n, n_var, X, err));
    if (status == STATUS_OK && !(*cases = calloc(c->n_cases + 1, sizeof **cases)))
        status = fail_memory(err, c->n_cases, "designs");
    THEN(status, confirm(c, *cases, err));
    *n_cases = status == STATUS_OK ? c->n_cases : 0;
    end(c);
    return status;
}
