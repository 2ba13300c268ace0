#include "serve/what_if.h"

#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "base/json.h"
#include "base/units.h"
#include "moga/dominance.h"
#include "motion/motion_scale.h"
#include "settings/options.h"
#include "evaluate/tower.h"

enum { PAGES_MAX = 64 };

/* What a scene is opened with. */
typedef struct {
    double pga_g, stretch, restitution; /* pga_g 0: scaled as the run's */
} Ground;

struct WhatIf {
    Settings settings; /* of the run, its records where they are now */
    int is_single;     /* the run judges designs by one simulation */
    Ground own;        /* of the run, pga_g as its motion has it */
    double lower[DESIGN_VARIABLES_MAX], upper[DESIGN_VARIABLES_MAX];
    size_t n_var;
    pthread_mutex_t pages; /* of the next three */
    long page[PAGES_MAX], turn[PAGES_MAX];
    size_t next_page;
    pthread_mutex_t one; /* simulation at a time: of the rest */
    Ground ground;
    Problem problem; /* on that ground */
    int is_open;
    SimResult no_core, result;
};

typedef struct {
    long page, turn;
    Ground ground;
    double x[DESIGN_VARIABLES_MAX];
} Question;

/* -- the scene ----------------------------------------------------------------------------------------------------- */

static int is_same(const Ground *a, const Ground *b)
{
    return a->pga_g == b->pga_g && a->stretch == b->stretch && a->restitution == b->restitution;
}

static Status open_scene(WhatIf *w, const Ground *g, Err *err)
{
    if (w->is_open && is_same(g, &w->ground))
        return STATUS_OK;
    Settings s = w->settings;
    if (w->is_open)
        problem_close(&w->problem);
    w->is_open = 0;
    if (g->pga_g > 0) {
        motion_unscale(&s.motion);
        s.motion.pga_g = g->pga_g;
    }
    s.motion.stretch = g->stretch;
    s.contact.restitution = g->restitution;
    TRY(tower_open(&w->problem, &s, TOWER_SINGLE, 1, err));
    w->is_open = 1;
    w->ground = *g;
    return tower_simulate(&w->problem, 1, &(SimTask){.kind = SCENE_NO_CORE, .x = NULL}, &w->no_core, err);
}

Status what_if_open(WhatIf **out, const Run *run, const RecordPaths *moved, Err *err)
{
    *out = NULL;
    if (run->settings->problem.kind != PROBLEM_TOWER)
        return fail(err, STATUS_MISSING, "%s: is no run of the tower: nothing to change", run->folder);
    WhatIf *w = calloc(1, sizeof *w);
    if (!w)
        return fail(err, STATUS_NO_MEMORY, "no memory for a scene");
    pthread_mutex_init(&w->pages, NULL);
    pthread_mutex_init(&w->one, NULL);
    w->settings = *run->settings;
    w->settings.search.threads = 1;
    const SimOptions *sim = &w->settings.sim;
    w->is_single = sim->replicates == 1 && strcmp(w->settings.motion.records, "none") == 0;
    w->own = (Ground){0, w->settings.motion.stretch, w->settings.contact.restitution};
    Status status = record_paths_find(&w->settings, run->provenance, moved, err);
    if (status == STATUS_OK)
        status = open_scene(w, &w->own, err);
    if (status == STATUS_OK && w->problem.n_var != run->schema.n_var)
        status = fail(err, STATUS_BAD_DATA, "%s: its building has other variables now", run->folder);
    if (status != STATUS_OK) {
        what_if_close(w);
        return status;
    }
    w->own.pga_g = motion_peak(&tower_record(tower_of(&w->problem), 0)->motion) / GRAVITY;
    w->n_var = w->problem.n_var;
    memcpy(w->lower, w->problem.lower, w->n_var * sizeof *w->lower);
    memcpy(w->upper, w->problem.upper, w->n_var * sizeof *w->upper);
    *out = w;
    return STATUS_OK;
}

void what_if_close(WhatIf *w)
{
    if (!w)
        return;
    if (w->is_open)
        problem_close(&w->problem);
    pthread_mutex_destroy(&w->pages);
    pthread_mutex_destroy(&w->one);
    free(w);
}

/* -- the question -------------------------------------------------------------------------------------------------- */

/* Shares of the run's own between which motion and restitution may be changed. */
static const double PGA_SHARE = 4, STRETCH_SHARE = 2, RESTITUTION[2] = {0.05, 1};

/* Of `imtet simulate`, for the one simulation of the design as designed. */
static const char ONCE[] = " --set sim.replicates=1 --set sim.gap_tolerance_m=0 --set motion.records=none";
static const char CERTAIN[] = " --set sim.uncertain=none";

json_t *what_if_bounds(const WhatIf *w)
{
    const Ground *g = &w->own;
    char scalings[SCALINGS_TEXT_MAX];
    const int scales_otherwise = w->settings.motion.pga_g == 0 && motion_scalings(&w->settings.motion, scalings) > 0;
    return json_pack("{s:o, s:o, s:[f,f,f], s:[f,f,f], s:[f,f,f], s:b, s:s+, s:s}", "lower",
                     json_numbers(w->n_var, w->lower), "upper", json_numbers(w->n_var, w->upper), "pga_g",
                     g->pga_g / PGA_SHARE, g->pga_g, g->pga_g * PGA_SHARE, "stretch", g->stretch / STRETCH_SHARE,
                     g->stretch, g->stretch * STRETCH_SHARE, "restitution", RESTITUTION[0], g->restitution,
                     RESTITUTION[1], "is_comparable", w->is_single, "options", w->is_single ? "" : ONCE,
                     is_uncertain(&w->settings.sim.uncertain) ? CERTAIN : "", "pga_options",
                     scales_otherwise ? " --set motion.factor=1 --set motion.sa_g=0 --set motion.target=none" : "");
}

/* A number within bounds, rounding apart; `otherwise` where it is left out. */
static Status take_number(const json_t *o, const char *key, double least, double most, double otherwise, double *value,
                          Err *err)
{
    const json_t *given = json_object_get(o, key);
    const double slack = 1e-9 * fabs(most);
    *value = otherwise;
    if (!given || json_is_null(given))
        return STATUS_OK;
    *value = json_number_value(given);
    return json_is_number(given) && *value >= least - slack && *value <= most + slack
               ? STATUS_OK
               : fail(err, STATUS_BAD_DATA, "%s: a number from %g to %g is wanted", key, least, most);
}

static Status take_design(const WhatIf *w, const json_t *o, double x[], Err *err)
{
    const json_t *given = json_object_get(o, "x");
    if (json_array_size(given) != w->n_var)
        return fail(err, STATUS_BAD_DATA, "x: %zu numbers are wanted", w->n_var);
    for (size_t j = 0; j < w->n_var; j++) {
        const json_t *value = json_array_get(given, j);
        const double slack = 1e-9 * (w->upper[j] - w->lower[j]);
        x[j] = json_number_value(value);
        if (!json_is_number(value) || !(x[j] >= w->lower[j] - slack && x[j] <= w->upper[j] + slack))
            return fail(err, STATUS_BAD_DATA, "x: variable %zu is not within %g and %g", j + 1, w->lower[j],
                        w->upper[j]);
    }
    return STATUS_OK;
}

static Status take_question(const WhatIf *w, const char *text, size_t n, Question *q, Err *err)
{
    json_error_t error;
    json_t *o = json_loadb(text, n, JSON_REJECT_DUPLICATES, &error);
    const Ground *g = &w->own;
    if (!json_is_object(o)) {
        json_decref(o);
        return fail(err, STATUS_BAD_DATA, "the question is no JSON object");
    }
    *q = (Question){.page = (long)json_integer_value(json_object_get(o, "page")),
                    .turn = (long)json_integer_value(json_object_get(o, "turn"))};
    Status status = take_design(w, o, q->x, err);
    if (status == STATUS_OK)
        status = take_number(o, "pga_g", g->pga_g / PGA_SHARE, g->pga_g * PGA_SHARE, 0, &q->ground.pga_g, err);
    if (status == STATUS_OK)
        status = take_number(o, "stretch", g->stretch / STRETCH_SHARE, g->stretch * STRETCH_SHARE, g->stretch,
                             &q->ground.stretch, err);
    if (status == STATUS_OK)
        status =
            take_number(o, "restitution", RESTITUTION[0], RESTITUTION[1], g->restitution, &q->ground.restitution, err);
    json_decref(o);
    return status;
}

/* Notes the turn; 0: a later one of the same page is there. The oldest page gives its place to a new one. */
static int is_latest(WhatIf *w, const Question *q)
{
    pthread_mutex_lock(&w->pages);
    size_t i = 0;
    while (i < PAGES_MAX && w->page[i] != q->page)
        i++;
    if (i == PAGES_MAX) {
        i = w->next_page++ % PAGES_MAX;
        w->page[i] = q->page;
        w->turn[i] = q->turn;
    }
    const int latest = q->turn >= w->turn[i];
    if (latest)
        w->turn[i] = q->turn;
    pthread_mutex_unlock(&w->pages);
    return latest;
}

/* -- the answer ---------------------------------------------------------------------------------------------------- */

static json_t *json_of_peaks(const SimResult *r)
{
    const size_t n = (size_t)r->n_floors;
    if (r->outcome != RUN_OK)
        return json_null();
    return json_pack("{s:o, s:o, s:o}", "displacement_m", json_numbers(n, r->peak_displacement_m), "drift_m",
                     json_numbers(n, r->peak_drift_m), "acceleration_g", json_numbers(n, r->peak_acceleration_g));
}

/* Designs of the front that dominate f, and that it dominates. */
static void set_place(const Run *run, const double natural[], json_t *answer)
{
    const size_t m = run->schema.n_obj;
    double f[OBJECTIVES_MAX], other[OBJECTIVES_MAX];
    json_int_t by = 0, of = 0;
    for (size_t k = 0; k < m; k++)
        f[k] = schema_objective(&run->schema, k)->sense * natural[k];
    for (size_t i = 0; i < run->n_front; i++) {
        for (size_t k = 0; k < m; k++)
            other[k] = schema_objective(&run->schema, k)->sense * run_f(run, run->front[i])[k];
        by += dominates(m, other, f) != 0;
        of += dominates(m, f, other) != 0;
    }
    json_object_set_new(answer, "dominated_by", json_integer(by));
    json_object_set_new(answer, "dominates", json_integer(of));
}

static json_t *json_of_answer(const WhatIf *w, const Run *run, const Question *q)
{
    const SimResult *r = &w->result;
    const MeasureOrder *order = tower_measures(tower_of(&w->problem));
    double natural[OBJECTIVES_MAX];
    Design design;
    json_t *closings = json_array();
    design_of(tower_design(tower_of(&w->problem)), q->x, &design);
    for (int k = 0; k < order->n_obj; k++)
        natural[k] = measure_value(r, order->of[k]);
    for (int j = 0; j < r->n_floors; j++)
        closings = json_append(closings, json_integer(r->closings[j]));
    const int ok = r->outcome == RUN_OK;
    json_t *answer = json_pack("{s:I, s:s, s:s, s:o, s:o, s:o, s:o, s:o, s:I, s:b, s:f}", "turn", (json_int_t)q->turn,
                               "outcome", outcome_word(measure_outcome(r->outcome)), "reason", r->reason, "objectives",
                               ok ? json_numbers((size_t)order->n_obj, natural) : json_null(), "gap_m",
                               json_numbers((size_t)tower_n_floors(tower_of(&w->problem)), design.gap), "peaks",
                               json_of_peaks(r), "no_core", json_of_peaks(&w->no_core), "closings", closings, "impacts",
                               (json_int_t)r->impacts, "beyond_law", beyond_contact_law(r), "seconds", r->seconds);
    const int same_ground =
        q->ground.pga_g == 0 && q->ground.stretch == w->own.stretch && q->ground.restitution == w->own.restitution;
    if (ok && w->is_single && same_ground)
        set_place(run, natural, answer);
    return answer;
}

Status what_if_ask(WhatIf *w, const Run *run, const char *question, size_t n, json_t **answer, Err *err)
{
    Question q;
    TRY(take_question(w, question, n, &q, err));
    is_latest(w, &q);
    pthread_mutex_lock(&w->one);
    Status status = is_latest(w, &q) ? STATUS_OK : fail(err, STATUS_STOPPED, "a later question of this page is there");
    if (status == STATUS_OK)
        status = open_scene(w, &q.ground, err);
    if (status == STATUS_OK)
        status = tower_simulate(&w->problem, 1, &(SimTask){.kind = SCENE_IMPACT, .x = q.x}, &w->result, err);
    if (status == STATUS_OK)
        *answer = json_of_answer(w, run, &q);
    pthread_mutex_unlock(&w->one);
    return status;
}
