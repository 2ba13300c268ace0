#include "analysis/ladder.h"

#include "base/json.h"
#include "scene/frame.h"
#include "scene/neighbour.h"
#include "settings/settings.h"

enum { REPLICATES = 8 };

/* Values of a setting with an effect, where it is not set, and without it. NULL: set_values
 * has it. */
static const struct {
    const char *words, *key, *with, *without;
} EFFECTS[] = {
    {"between the floors", "building.modes", "100000", "0"},
    {"shear of the core", "core.theory", "timoshenko", "euler_bernoulli"},
    {"P-delta", "building.p_delta", "on", "off"},
    {"ground under the core", "core.foundation", NULL, "fixed"},
    {"core that lifts", "core.foundation", NULL, NULL},
    {"walls that buckle", "core.wall", "effective", "full"},
    {"storeys that yield", "building.yield_drift", "0.01", "0"},
    {"flexibility at contacts", "contact.bumper_stiffness_n_m", "5e8", "0"},
    {"contacts off the centre", "contact.eccentricity", "0.05", "0"},
    {"weak end of the record", "sim.duration_s", NULL, NULL},
    {"steps, modes of the core", "sim.accuracy", "fine", NULL},
};
enum { BETWEEN, SHEAR, P_DELTA, GROUND, LIFT, WALLS, YIELDING, FLEXIBILITY, OFF_CENTRE, END, STEPS, KINDS };

typedef struct {
    Settings s; /* as given, but for objectives and limits */
    Settings all;
    const double *x;
    double strong_s;
    int is_brief;
    int kind[LADDER_MAX]; /* of an effect: its line above */
    Ladder *out;
    Measured parts[1 + LADDER_MAX][REPLICATES];    /* with all, without each; 0 is the design, the others tell time */
    Measured scene[1 + LADDER_MAX][LADDER_SCENES]; /* the same of the scenes; of the design as in parts */
} Job;

static void take_value(const char *key, const char *value, void *to)
{
    (void)key;
    snprintf(to, OPTION_TEXT_MAX, "%s", value);
}

/* -- effects ------------------------------------------------------------------------------------------------------- */

/* Those of the settings, else weight alone; and a mat that never lifts. */
static void set_anchors(const char *now, int is_set, LadderEffect *e)
{
    const char *word = strstr(now, " anchors=");
    const int n = word ? (int)(word - now) : (int)strlen(now);
    e->is_set = is_set;
    snprintf(e->without, sizeof e->without, "%.*s anchors=inf%s", n, now,
             word ? word + 1 + strcspn(word + 1, " ") : "");
    if (!is_set)
        snprintf(e->with, sizeof e->with, "%.*s anchors=1%s", n, now, word ? word + 1 + strcspn(word + 1, " ") : "");
}

static void set_values(const Job *job, int kind, const char *now, LadderEffect *e)
{
    Foundation f;
    const char *with = EFFECTS[kind].with ? EFFECTS[kind].with : now;
    const char *without = EFFECTS[kind].without ? EFFECTS[kind].without : now;
    *e = (LadderEffect){.words = EFFECTS[kind].words, .key = EFFECTS[kind].key};
    e->is_set = kind == STEPS ? strcmp(now, with) == 0 : strcmp(now, without) != 0 || kind == END;
    snprintf(e->with, sizeof e->with, "%s", e->is_set ? now : with);
    snprintf(e->without, sizeof e->without, "%s", kind == STEPS && e->is_set ? "standard" : without);
    if (kind == END)
        snprintf(e->without, sizeof e->without, "%.6g", job->strong_s);
    if (kind == GROUND && !e->is_set) /* a mat twice as wide as the core, held down */
        snprintf(e->with, sizeof e->with, "soil=C radius=%g anchors=inf", job->s.core.width_m);
    if (kind == LIFT)
        set_anchors(now, foundation_parse(job->s.core.foundation, 1, &f, NULL) == STATUS_OK && f.anchors > 0, e);
}

static int is_there(const Job *job, int kind)
{
    const Settings *s = &job->s;
    Foundation f;
    Err err;
    switch (kind) {
    case BETWEEN:
        return frame_is(s->building.model);
    case SHEAR:
    case GROUND:
        return !neighbour_is_given(&s->core);
    case LIFT:
        return !neighbour_is_given(&s->core) && foundation_parse(s->core.foundation, 1, &f, &err) == STATUS_OK &&
               f.radius_m > 0 && f.rotation > 0;
    case WALLS:
        return s->core.stiffeners > 0 || s->core.wall_factor > 0 || s->core.wall != WALL_FULL;
    case END:
        return s->sim.duration_s == 0 || job->strong_s < s->sim.duration_s;
    case STEPS:
        return !job->is_brief;
    default:
        return 1;
    }
}

static Status find_hardening(const Settings *s, double *hardening, Err *err)
{
    Building b;
    TRY(building_load(&b, &s->building, err));
    *hardening = b.yields ? b.hardening : 0;
    building_free(&b);
    return STATUS_OK;
}

static Status list_effects(Job *job, Err *err)
{
    Ladder *l = job->out;
    job->all = job->s;
    for (int kind = 0; kind < KINDS; kind++) {
        char now[OPTION_TEXT_MAX] = "";
        LadderEffect *e = &l->effect[l->n];
        if (!is_there(job, kind))
            continue;
        settings_each(&job->all, EFFECTS[kind].key, take_value, now);
        set_values(job, kind, now, e);
        job->kind[l->n++] = kind;
        TRY(settings_put(&job->all, e->key, kind == STEPS ? e->without : e->with, err));
    }
    for (int i = 0; i < YIELDING_KEYS; i++)
        settings_each(&job->s, YIELDING_KEY[i], take_value, l->yielding[i]);
    return find_hardening(&job->all, &l->all_hardening, err);
}

Status ladder_effects(const Settings *s, double strong_s, Ladder *out, Settings *all, Err *err)
{
    Job *job;
    TRY_ROOM(job, 1, "a ladder", err);
    *job = (Job){.s = *s, .strong_s = strong_s, .is_brief = 1, .out = out};
    *out = (Ladder){0};
    const Status status = list_effects(job, err);
    free(job);
    *all = *s;
    for (size_t i = 0; i < out->n && status == STATUS_OK; i++) {
        LadderEffect *e = &out->effect[i];
        e->is_set = settings_gives(s, e->key);
        e->cost_s = NAN;
        if (e->is_set)
            settings_each(s, e->key, take_value, e->with);
        else
            TRY(settings_put(all, e->key, e->with, err));
    }
    return status;
}

Status ladder_judge(Settings *s, Err *err)
{
    TRY(settings_put(s, "search.objectives", "j1_m, drift_ratio, j3_g", err));
    return settings_put(s, "search.limits", "none", err);
}

void ladder_as_built(SimOptions *o, long replicates)
{
    static const double GAP_SD_M = 1e-3;
    o->replicates = replicates;
    o->gap_tolerance_m = o->gap_tolerance_m > 0 ? o->gap_tolerance_m : GAP_SD_M;
}

/* -- what each changes --------------------------------------------------------------------------------------------- */

/* Of two orders of the same sums. */
static const double ROUNDING = 1e-11;

double ladder_change(const Measured *to, const Measured *from, int k)
{
    const int is_known = to->outcome == RUN_OK && from->outcome == RUN_OK;
    const double by = is_known ? to->value[LADDER_MEASURE[k]] / from->value[LADDER_MEASURE[k]] - 1 : NAN;
    return fabs(by) < ROUNDING ? 0 : by;
}

double ladder_largest(const Ladder *l, double changes[LADDER_SCENES][LADDER_MEASURES], int *scene)
{
    double most = -1;
    for (int i = 0; i < LADDER_SCENES; i++)
        for (int k = 0; k < LADDER_MEASURES; k++) {
            const double of = fabs(changes[i][k]) / (i == 0 ? l->tolerance[k] : LADDER_TOLERANCE);
            if (!(of <= most)) {
                most = isnan(of) ? INFINITY : of;
                *scene = i;
            }
        }
    return most;
}

/* Of the simulations that were made: other processes disturb. NAN: one alone tells nothing. */
static double least_seconds(const Job *job, const Measured parts[REPLICATES])
{
    double least = job->is_brief ? NAN : parts[0].seconds;
    for (int i = 1; i < REPLICATES; i++)
        if (parts[i].seconds > 0 && !job->is_brief)
            least = fmin(least, parts[i].seconds);
    return least;
}

static void conclude(Job *job, const ReplicateSummary *as_built)
{
    Ladder *l = job->out;
    l->all_s = least_seconds(job, job->parts[0]);
    for (int k = 0; k < LADDER_MEASURES; k++) {
        const double scatter = as_built->sd[LADDER_MEASURE[k]] / as_built->mean[LADDER_MEASURE[k]];
        l->value[k] = job->parts[0][0].value[LADDER_MEASURE[k]];
        l->tolerance[k] = fmax(LADDER_TOLERANCE, isfinite(scatter) ? scatter : 0);
    }
    for (size_t i = 0; i < l->n; i++) {
        LadderEffect *e = &l->effect[i];
        const int is_finer = job->kind[i] == STEPS; /* of which the model with all has the other value */
        const size_t with = is_finer ? 1 + i : 0, without = is_finer ? 0 : 1 + i;
        for (int c = 0; c < LADDER_SCENES; c++)
            for (int k = 0; k < LADDER_MEASURES; k++)
                e->change[c][k] = ladder_change(&job->scene[without][c], &job->scene[with][c], k);
        e->cost_s = least_seconds(job, job->parts[with]) - least_seconds(job, job->parts[without]);
        e->most = ladder_largest(l, e->change, &e->decided_in);
        e->is_needed = e->is_kept = e->most > 1;
        if (job->kind[i] == LIFT && e->is_kept)
            l->effect[i - 1].is_kept = 1;
    }
}

/* Scene 0 has all, the others lack an effect each. */
static Status leave_out_each(Job *job, Err *err)
{
    const Ladder *l = job->out;
    const char *const record = job->s.motion.record;
    SceneChange scene[1 + LADDER_MAX] = {{0}};
    SimTask task[(1 + LADDER_MAX) * LADDER_SCENES];
    ReplicateSummary as_built;
    size_t n = 0;
    Settings s = job->all;
    Problem p;
    ladder_as_built(&s.sim, REPLICATES);
    for (size_t i = 0; i < l->n; i++)
        snprintf(scene[1 + i].setting, sizeof scene->setting, "%s=%s", l->effect[i].key,
                 job->kind[i] == STEPS ? l->effect[i].with : l->effect[i].without);
    TRY(tower_open_scenes(&p, &s, 1, &record, 1 + l->n, scene, err));
    for (size_t i = 0; i <= l->n; i++) {
        const int is_once = i > 0 && (job->kind[i - 1] == STEPS || job->is_brief);
        task[n++] = (SimTask){.x = job->x,
                              .scene = i,
                              .n_parts = is_once ? 1 : REPLICATES,
                              .parts = job->parts[i],
                              .summary = i == 0 ? &as_built : NULL};
        for (int c = 1; c < LADDER_SCENES; c++)
            task[n++] = (SimTask){.kind = LADDER_SCENE[c], .x = job->x, .scene = i, .parts = &job->scene[i][c]};
    }
    const Status status = tower_run(&p, n, task, NULL, NULL, err);
    problem_close(&p);
    for (size_t i = 0; i <= l->n; i++)
        job->scene[i][0] = job->parts[i][0];
    for (int c = 0; c < LADDER_SCENES && status == STATUS_OK; c++)
        if (job->scene[0][c].outcome != RUN_OK)
            return bad_data(err, "ladder: the model with all effects failed (%s): %s", SCENES[LADDER_SCENE[c]].words,
                            job->scene[0][c].reason);
    if (status == STATUS_OK)
        conclude(job, &as_built);
    return status;
}

/* -- the set ------------------------------------------------------------------------------------------------------- */

Status ladder_put_set(const Ladder *l, Settings *s, Err *err)
{
    for (size_t i = 0; i < l->n; i++)
        if (ladder_says(l, i))
            TRY(settings_put(s, l->effect[i].key, l->effect[i].is_kept ? l->effect[i].with : l->effect[i].without,
                             err));
    return STATUS_OK;
}

static Status simulate_set(const Job *job, Measured out[LADDER_SCENES], Err *err)
{
    Ladder *l = job->out;
    Settings s = job->s;
    Problem p;
    SimTask task[LADDER_SCENES];
    s.sim.replicates = 1;
    TRY(ladder_put_set(l, &s, err));
    for (int i = 0; i < LADDER_SCENES; i++)
        task[i] = (SimTask){.kind = LADDER_SCENE[i], .x = job->x, .parts = &out[i]};
    TRY(find_hardening(&s, &l->hardening, err));
    TRY(tower_open(&p, &s, TOWER_SINGLE, LADDER_SCENES, err));
    const Status status = tower_run(&p, LADDER_SCENES, task, NULL, NULL, err);
    problem_close(&p);
    return status;
}

LadderEffect *ladder_largest_left_out(Ladder *l)
{
    LadderEffect *found = NULL;
    for (size_t i = 0; i < l->n; i++)
        if (!l->effect[i].is_kept && (!found || l->effect[i].most > found->most))
            found = &l->effect[i];
    return found;
}

static Status shorten(Job *job, Err *err)
{
    Ladder *l = job->out;
    for (LadderEffect *back = NULL;;) {
        Measured set[LADDER_SCENES];
        int scene;
        const int is_fine = job->kind[l->n - 1] == STEPS && l->effect[l->n - 1].is_kept;
        TRY(simulate_set(job, set, err));
        for (int i = 0; i < LADDER_SCENES; i++)
            for (int k = 0; k < LADDER_MEASURES; k++) {
                l->off[i][k] = ladder_change(&set[i], &job->scene[is_fine ? l->n : 0][i], k);
                l->set[i][k] = set[i].outcome == RUN_OK ? set[i].value[LADDER_MEASURE[k]] : NAN;
            }
        l->set_s = job->is_brief ? NAN : set->seconds;
        back = ladder_largest_left_out(l);
        if (!back || ladder_largest(l, l->off, &scene) <= 1)
            return STATUS_OK;
        back->is_kept = 1;
    }
}

Status ladder_find(const Settings *s, const double x[], double strong_s, int is_brief, Ladder *out, Err *err)
{
    Job job = {.s = *s, .x = x, .strong_s = strong_s, .is_brief = is_brief, .out = out};
    *out = (Ladder){0};
    TRY(ladder_judge(&job.s, err));
    TRY(list_effects(&job, err));
    TRY(leave_out_each(&job, err));
    return shorten(&job, err);
}

/* -- in words ------------------------------------------------------------------------------------------------------ */

/* By the names of the measures and `end`, times `factor`. */
static json_t *json_by_measure(const double values[], const char *end, double factor)
{
    json_t *o = json_object();
    for (int k = 0; k < LADDER_MEASURES; k++) {
        char name[40];
        snprintf(name, sizeof name, "%s%s", measure(LADDER_MEASURE[k])->name, end);
        json_object_set_new(o, name, json_number(factor * values[k]));
    }
    return o;
}

json_t *ladder_json(const Ladder *l)
{
    json_t *effects = json_array(), *all = json_by_measure(l->value, "", 1), *settings = json_object(),
           *set = json_by_measure(l->off[0], "_pct", 100), *by_set = json_object();
    for (size_t i = 0; i < l->n; i++) {
        const LadderEffect *e = &l->effect[i];
        json_t *row = json_of("without=%s", e->words);
        json_object_update_new(row, json_by_measure(e->change[0], "_pct", 100));
        json_put(row, "most_in=%s in_tolerances=%g costs_ms=%g verdict=%s is_set=%s setting=%s with=%s otherwise=%s",
                 SCENES[LADDER_SCENE[e->decided_in]].key, e->most, 1e3 * e->cost_s, e->is_needed ? "needed" : "not",
                 e->is_set ? "yes" : "no", e->key, e->with, e->without);
        json_array_append_new(effects, row);
        if (ladder_says(l, i))
            json_object_set_new(settings, e->key, json_string(e->is_kept ? e->with : e->without));
    }
    if (l->hardening > 0)
        json_put(settings, "building.hardening=%g", l->hardening);
    for (int i = 0; l->hardening > 0 && i < (strcmp(l->yielding[0], "bilinear") == 0 ? 1 : YIELDING_KEYS); i++)
        json_object_set_new(settings, YIELDING_KEY[i], json_string(l->yielding[i]));
    for (int i = 0; i < LADDER_SCENES; i++)
        json_object_set_new(by_set, SCENES[LADDER_SCENE[i]].key, json_by_measure(l->set[i], "", 1));
    json_put(all, "ms=%g hardening=%g", 1e3 * l->all_s, l->all_hardening);
    json_put(set, "ms=%g", 1e3 * l->set_s);
    return json_of("effects=%p with_all=%p tolerance=%p enough=%p by_the_set=%p settings=%p", effects, all,
                   json_by_measure(l->tolerance, "_pct", 100), set, by_set, settings);
}
