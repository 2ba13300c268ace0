#include "serve/on_demand.h"

#include <pthread.h>
#include <stdatomic.h>

#include "base/json.h"
#include "base/units.h"
#include "evaluate/tower.h"
#include "base/dominance.h"
#include "motion/motion_scale.h"
#include "motion/suite.h"
#include "report/elsewhere.h"
#include "report/report_json.h"
#include "settings/settings.h"

/* What a scene is opened with. */
typedef struct {
    double pga_g, stretch, restitution; /* pga_g 0: scaled as the run's */
    int is_whole;                       /* all records and replicates of the run, not one simulation */
} Ground;

typedef struct {
    long id;
    int has_devices;
    char *text; /* NULL: none */
} KnownDesign;

struct OnDemand {
    Settings settings; /* of the run, as is the provenance; neither changes */
    char *provenance;
    const RecordPaths *moved;
    atomic_int n_users;
    pthread_mutex_t designs; /* of the next two */
    KnownDesign design[DESIGNS_KEPT];
    size_t next_design;
    pthread_mutex_t scene; /* of the rest */
    Settings used;         /* those of the run, its records where they are now */
    size_t n_simulations;  /* by which the run judges a design */
    Ground own, ground;    /* of the run, pga_g as its motion has it; of the scene that is open */
    atomic_size_t n_var;   /* 0: none was opened yet; once it is set the settings, the run's ground and bounds stay */
    double lower[DESIGN_VARIABLES_MAX], upper[DESIGN_VARIABLES_MAX];
    json_t *values;  /* values_of */
    Problem problem; /* on that ground */
    int is_open;
    SimResult no_core, result;
    ReplicateSummary summary; /* of the result, where the ground is whole */
};

typedef struct {
    long turn;
    Ground ground;
    double x[DESIGN_VARIABLES_MAX];
} Question;

/* -- life ---------------------------------------------------------------------------------------------------------- */

Status on_demand_open(OnDemand **out, const Run *run, const RecordPaths *moved, Err *err)
{
    OnDemand *o = *out = NULL;
    TRY_ROOM(o, 1, "a run", err);
    o->provenance = strdup(run->provenance);
    if (!o->provenance) {
        free(o);
        return fail_memory(err, 1, "a run");
    }
    pthread_mutex_init(&o->designs, NULL);
    pthread_mutex_init(&o->scene, NULL);
    o->n_users = 1;
    o->settings = *run->settings;
    o->moved = moved;
    *out = o;
    return STATUS_OK;
}

OnDemand *on_demand_share(OnDemand *o)
{
    atomic_fetch_add(&o->n_users, 1);
    return o;
}

void on_demand_close(OnDemand *o)
{
    if (!o || atomic_fetch_sub(&o->n_users, 1) > 1)
        return;
    if (o->is_open)
        problem_close(&o->problem);
    for (size_t i = 0; i < DESIGNS_KEPT; i++)
        free(o->design[i].text);
    pthread_mutex_destroy(&o->designs);
    pthread_mutex_destroy(&o->scene);
    free(o->provenance);
    json_decref(o->values);
    free(o);
}

static void count_difference(const char *key, unsigned flags, const char *was, const char *is, void *user)
{
    int *n = user;
    (void)key;
    (void)was;
    (void)is;
    *n += !(flags & (SETTING_LIMIT | SETTING_FREE));
}

int on_demand_is_of(const OnDemand *o, const Run *run)
{
    int n = 0;
    settings_compare(&o->settings, run->settings, count_difference, &n);
    return n == 0 && strcmp(o->provenance, run->provenance) == 0;
}

/* -- a design of the run ------------------------------------------------------------------------------------------- */

/* One that is kept, or simulated now. What the further records of the run do is part of the detail already. The mutex
 * is held. */
static Status find_design(OnDemand *o, const Run *run, long id, char **text, Err *err)
{
    const size_t row = run_find(run, id);
    const int with_devices = run->n_front > 0 && row == run_knee(run);
    KnownDesign *place = &o->design[o->next_design];
    Settings s = *run->settings;
    OtherRecords others = {0};
    Detail d;
    *text = NULL;
    for (KnownDesign *known = o->design; known < o->design + DESIGNS_KEPT && !*text; known++)
        if (known->text && known->id == id && known->has_devices >= with_devices)
            *text = strdup(known->text);
    if (*text)
        return STATUS_OK;
    if (run->settings->problem.kind != PROBLEM_TOWER || row == run->table.n)
        return fail(err, STATUS_MISSING, "%s: has no design %ld to be simulated", run->folder, id);

    s.search.threads = 1;
    TRY(record_paths_find(&s, run->provenance, o->moved, err));
    run_steps(run, row, &s.sim);
    TRY(elsewhere_otherwise(&others, &s.motion, err));
    const DetailOptions options = {.moved = *o->moved,
                                   .with_ladder = with_devices,
                                   .other = &s,
                                   .without_devices = !with_devices,
                                   .n_records = others.n,
                                   .records = others.source};
    TRY(detail_make(&s, (int)run->schema.n_var, run_x(run, row), &options, &d, err));
    json_t *all = json_of("id=%ld objectives=%p detail=%p", id, json_numbers(run->schema.n_obj, run_f(run, row)),
                          detail_json(&d, &run->schema.order));
    *text = json_dumps(all, JSON_COMPACT | JSON_REAL_PRECISION(6));
    json_decref(all);
    detail_free(&d);
    free(place->text);
    *place = (KnownDesign){id, with_devices, strdup(*text)};
    o->next_design = (o->next_design + 1) % DESIGNS_KEPT;
    return STATUS_OK;
}

Status on_demand_design(OnDemand *o, const Run *run, long id, char **text, Err *err)
{
    pthread_mutex_lock(&o->designs);
    const Status status = find_design(o, run, id, text, err);
    pthread_mutex_unlock(&o->designs);
    return status;
}

/* -- the scene of a what-if ---------------------------------------------------------------------------------------- */

/* The scene on that ground, and its response without a core. */
static Status open_scene(OnDemand *o, const Ground *g, Err *err)
{
    const Ground *is = &o->ground;
    if (o->is_open && g->pga_g == is->pga_g && g->stretch == is->stretch && g->restitution == is->restitution &&
        g->is_whole == is->is_whole)
        return STATUS_OK;
    Settings s = o->used;
    if (o->is_open)
        problem_close(&o->problem);
    o->is_open = 0;
    if (g->pga_g > 0) {
        motion_unscale(&s.motion);
        s.motion.pga_g = g->pga_g;
    }
    s.motion.stretch = g->stretch;
    s.contact.restitution = g->restitution;
    TRY(tower_open(&o->problem, &s, g->is_whole ? TOWER_AS_SET : TOWER_SINGLE, 1, err));
    o->is_open = 1;
    o->ground = *g;
    return tower_simulate(&o->problem, 1, &(SimTask){.kind = SCENE_NO_CORE}, &o->no_core, err);
}

/* The scene of the run itself, once. values: those that whole numbers and steps take; of other variables null, and the
 * page has the words of a choice. The mutex is held. */
static Status open_first(OnDemand *o, const Run *run, Err *err)
{
    const Problem *p = &o->problem;
    if (o->n_var > 0)
        return STATUS_OK;
    if (run->settings->problem.kind != PROBLEM_TOWER)
        return fail(err, STATUS_MISSING, "%s: is no run of the tower: nothing to change", run->folder);
    o->used = o->settings;
    o->used.search.threads = 1;
    o->n_simulations = (size_t)o->used.sim.replicates * suite_count(&o->used.motion);
    o->own = (Ground){0, o->used.motion.stretch, o->used.contact.restitution, 0};
    TRY(record_paths_find(&o->used, o->provenance, o->moved, err));
    TRY(open_scene(o, &o->own, err));
    if (p->n_var != run->schema.n_var)
        return bad_data(err, "%s: its building has other variables now", run->folder);
    o->own.pga_g = motion_peak(&tower_record(tower_of(p), 0)->motion) / GRAVITY;
    memcpy(o->lower, p->lower, p->n_var * sizeof *o->lower);
    memcpy(o->upper, p->upper, p->n_var * sizeof *o->upper);
    o->values = json_array();
    for (size_t d = 0; d < p->n_var; d++) {
        const Steps *steps = problem_kind(p, d) == VARIABLE_STEPPED ? &p->steps[d] : NULL;
        json_t *list = steps || problem_kind(p, d) == VARIABLE_WHOLE ? json_array() : json_null();
        const size_t n = steps ? steps->n : (size_t)(p->upper[d] - p->lower[d]) + 1;
        for (size_t i = 0; json_is_array(list) && i < n; i++)
            json_array_append_new(list, json_number(steps ? steps_at(steps, i) : p->lower[d] + (double)i));
        json_array_append_new(o->values, list);
    }
    o->n_var = p->n_var;
    return STATUS_OK;
}

/* The lock is taken only until the scene was opened: then what it has stays. */
static Status prepare(OnDemand *o, const Run *run, Err *err)
{
    if (o->n_var > 0)
        return STATUS_OK;
    pthread_mutex_lock(&o->scene);
    const Status status = open_first(o, run, err);
    pthread_mutex_unlock(&o->scene);
    return status;
}

/* -- the question -------------------------------------------------------------------------------------------------- */

/* Shares of the run's own between which motion and restitution may be changed. */
static const double PGA_SHARE = 4, STRETCH_SHARE = 2, RESTITUTION[2] = {0.05, 1};

/* Of `imtet simulate`, for the one simulation of the design as designed. */
static const char ONCE[] = " --set sim.replicates=1 --set sim.gap_tolerance_m=0 --set motion.records=none "
                           "--set search.fidelity=off";
static const char CERTAIN[] = " --set sim.uncertain=none";
static const char SCALED_OTHERWISE[] = " --set motion.factor=1 --set motion.sa_g=0 --set motion.target=none";

Status on_demand_bounds(OnDemand *o, const Run *run, json_t **bounds, Err *err)
{
    const Ground *g = &o->own;
    char scalings[SCALINGS_TEXT_MAX], options[sizeof ONCE + sizeof CERTAIN];
    TRY(prepare(o, run, err));
    const int scales_otherwise = o->used.motion.pga_g == 0 && motion_scalings(&o->used.motion, scalings) > 0;
    snprintf(options, sizeof options, "%s%s", o->n_simulations == 1 ? "" : ONCE,
             is_uncertain(&o->used.sim.uncertain) ? CERTAIN : "");
    *bounds = json_of(
        "lower=%p upper=%p values=%p pga_g=%p stretch=%p restitution=%p simulations=%ld options=%s pga_options=%s",
        json_numbers(o->n_var, o->lower), json_numbers(o->n_var, o->upper), json_deep_copy(o->values),
        json_numbers(3, (double[]){g->pga_g / PGA_SHARE, g->pga_g, g->pga_g * PGA_SHARE}),
        json_numbers(3, (double[]){g->stretch / STRETCH_SHARE, g->stretch, g->stretch * STRETCH_SHARE}),
        json_numbers(3, (double[]){RESTITUTION[0], g->restitution, RESTITUTION[1]}), (long)o->n_simulations, options,
        scales_otherwise ? SCALED_OTHERWISE : "");
    return STATUS_OK;
}

/* A design, and numbers within bounds, rounding apart; one that is left out is that of the run. */
static Status take_question(const OnDemand *o, const char *text, size_t n, Question *q, Err *err)
{
    json_error_t error;
    json_t *given = json_loadb(text, n, JSON_REJECT_DUPLICATES, &error);
    const json_t *x = json_object_get(given, "x");
    const Ground *own = &o->own;
    const struct {
        const char *key;
        double least, most, otherwise, *value;
    } numbers[] = {
        {"pga_g", own->pga_g / PGA_SHARE, own->pga_g * PGA_SHARE, 0, &q->ground.pga_g},
        {"stretch", own->stretch / STRETCH_SHARE, own->stretch * STRETCH_SHARE, own->stretch, &q->ground.stretch},
        {"restitution", RESTITUTION[0], RESTITUTION[1], own->restitution, &q->ground.restitution}};
    *q = (Question){.turn = json_integer_value(json_object_get(given, "turn")),
                    .ground.is_whole = json_integer_value(json_object_get(given, "whole")) > 0};
    Status status = STATUS_OK;
    if (!json_is_object(given))
        status = bad_data(err, "the question is no JSON object");
    else if (json_array_size(x) != o->n_var)
        status = bad_data(err, "x: %zu numbers are wanted", o->n_var);
    for (size_t j = 0; j < o->n_var && status == STATUS_OK; j++) {
        const json_t *value = json_array_get(x, j);
        const double slack = 1e-9 * (o->upper[j] - o->lower[j]);
        q->x[j] = json_number_value(value);
        if (!json_is_number(value) || !(q->x[j] >= o->lower[j] - slack && q->x[j] <= o->upper[j] + slack))
            status = bad_data(err, "x: variable %zu is not within %g and %g", j + 1, o->lower[j], o->upper[j]);
    }
    for (size_t i = 0; i < N_OF(numbers) && status == STATUS_OK; i++) {
        const json_t *number = json_object_get(given, numbers[i].key);
        const double least = numbers[i].least, most = numbers[i].most, slack = 1e-9 * fabs(most);
        const int is_given = number && !json_is_null(number);
        const double value = *numbers[i].value = is_given ? json_number_value(number) : numbers[i].otherwise;
        if (is_given && !(json_is_number(number) && value >= least - slack && value <= most + slack))
            status = bad_data(err, "%s: a number from %g to %g is wanted", numbers[i].key, least, most);
    }
    json_decref(given);
    return status;
}

/* -- the answer ---------------------------------------------------------------------------------------------------- */

/* The response to a question, and where designs of the front dominate it, or it them. */
static json_t *json_of_answer(const OnDemand *o, const Run *run, const Question *q)
{
    const SimResult *r = &o->result;
    const Tower *tower = tower_of(&o->problem);
    const MeasureOrder *order = tower_measures(tower);
    double natural[OBJECTIVES_MAX], f[OBJECTIVES_MAX], other[OBJECTIVES_MAX], gap_m[FLOORS_MAX];
    Design design;
    design_of(tower_design(tower), q->x, &design);
    for (int j = 0; j < tower_n_floors(tower); j++)
        gap_m[j] = design_gap(&design, j);
    for (int k = 0; k < order->n_obj; k++)
        natural[k] = q->ground.is_whole ? o->summary.mean[order->of[k]] : measure_value(r, order->of[k]);
    const int ok = r->outcome == RUN_OK;
    json_t *answer = json_of(
        "turn=%ld outcome=%s reason=%s objectives=%p gap_m=%p peaks=%p no_core=%p beyond_law=%c seconds=%g", q->turn,
        outcome_word((Outcome)r->outcome), r->reason, ok ? json_numbers(order->n_obj, natural) : json_null(),
        json_numbers(tower_n_floors(tower), gap_m), ok ? result_json(r, order) : json_null(),
        o->no_core.outcome == RUN_OK ? result_json(&o->no_core, order) : json_null(), beyond_contact_law(r),
        r->seconds);
    const int same_ground =
        q->ground.pga_g == 0 && q->ground.stretch == o->own.stretch && q->ground.restitution == o->own.restitution;
    if (!(ok && (o->n_simulations == 1 || q->ground.is_whole) && same_ground))
        return answer;
    const size_t m = run->schema.n_obj;
    long by = 0, of = 0;
    for (size_t k = 0; k < m; k++)
        f[k] = schema_objective(&run->schema, k)->sense * natural[k];
    for (size_t i = 0; i < run->n_front; i++) {
        run_minimise(run, run->front[i], other);
        by += dominates(m, other, f) != 0;
        of += dominates(m, f, other) != 0;
    }
    return json_put(answer, "dominated_by=%ld dominates=%ld", by, of);
}

Status on_demand_what_if(OnDemand *o, const Run *run, const char *question, size_t n, json_t **answer, Err *err)
{
    Question q;
    TRY(prepare(o, run, err));
    TRY(take_question(o, question, n, &q, err));
    pthread_mutex_lock(&o->scene);
    Status status = open_scene(o, &q.ground, err);
    if (status == STATUS_OK && q.ground.is_whole)
        status = tower_replicate(&o->problem, 1, q.x, &o->result, &o->summary, err);
    else if (status == STATUS_OK)
        status = tower_simulate(&o->problem, 1, &(SimTask){.kind = SCENE_IMPACT, .x = q.x}, &o->result, err);
    if (status == STATUS_OK)
        *answer = json_of_answer(o, run, &q);
    pthread_mutex_unlock(&o->scene);
    return status;
}
