#include <pthread.h>

#include "api/named_values.h"
#include "base/linalg.h"
#include "base/text.h"
#include "evaluate/device.h"
#include "motion/motion_scale.h"
#include "settings/settings.h"
#include "sim/samples.h"

/* A tower of one worker for every simulation that is under way at once; they are opened when they are needed. */
struct imtet_scene {
    pthread_mutex_t lock;
    Settings settings;
    size_t n_idle, room;
    Problem *idle; /* (n_idle) */
};

/* -- towers -------------------------------------------------------------------------------------------------------- */

/* A tower that no other simulation uses: an idle one, or a new one. */
static Status acquire_tower(imtet_scene *s, Problem *p, Err *err)
{
    Status status = STATUS_OK;
    pthread_mutex_lock(&s->lock);
    if (s->n_idle > 0) {
        *p = s->idle[--s->n_idle];
    } else {
        linalg_begin();
        status = tower_open(p, &s->settings, TOWER_SINGLE, 1, err);
        linalg_end();
    }
    pthread_mutex_unlock(&s->lock);
    return status;
}

/* Kept for the next one; closed where there is no memory for it. */
static void release_tower(imtet_scene *s, Problem *p)
{
    pthread_mutex_lock(&s->lock);
    if (s->n_idle == s->room) {
        Problem *wider = realloc(s->idle, (s->room + 8) * sizeof *wider);
        s->idle = wider ? wider : s->idle;
        s->room += wider ? 8 : 0;
    }
    if (s->n_idle < s->room)
        s->idle[s->n_idle++] = *p;
    else
        problem_close(p);
    pthread_mutex_unlock(&s->lock);
}

/* Read the settings and open the first tower, which finds what is wrong with them. */
static Status open_scene(imtet_scene **out, const char *path, const char *const list[], Err *err)
{
    Problem first;
    TRY_ROOM(*out, 1, "a scene", err);
    imtet_scene *s = *out;
    pthread_mutex_init(&s->lock, NULL);
    settings_defaults(&s->settings);
    if (path)
        TRY(settings_read(&s->settings, path, NULL, NULL, err));
    TRY(api_settings(&s->settings, list, err));
    TRY(settings_check(&s->settings, err));
    TRY(acquire_tower(s, &first, err));
    release_tower(s, &first);
    return STATUS_OK;
}

imtet_status imtet_scene_open(const char *path, const char *const settings[], imtet_scene **out, imtet_error *error)
{
    Err err = {0};
    if (!out)
        return api_status(misused(&err, "imtet_scene_open: out is NULL"), &err, error);
    const Status status = open_scene(out, path, settings, &err);
    if (status != STATUS_OK)
        imtet_scene_free(out);
    return api_status(status, &err, error);
}

void imtet_scene_free(imtet_scene **scene)
{
    imtet_scene *s = scene ? *scene : NULL;
    if (!s)
        return;
    for (size_t i = 0; i < s->n_idle; i++)
        problem_close(&s->idle[i]);
    pthread_mutex_destroy(&s->lock);
    free(s->idle);
    free(s);
    *scene = NULL;
}

/* -- what is asked of one tower, into a result --------------------------------------------------------------------- */

typedef struct {
    const char *asked; /* a case by its key */
    const double *x;   /* (n) */
    size_t n;
    double every_s;
    int is_history;
    SceneKind kind; /* that is asked */
    Problem problem;
    const Tower *tower;
    imtet_result *result;
} Question;

/* Whether a scene of these settings and this design space has an answer; finds the case. */
static Status check_question(Question *q, const SimOptions *o, const DesignSpace *space, Err *err)
{
    const char *keys[N_SCENES];
    const size_t n_var = space->n_var;
    if (!q->asked)
        return misused(err, "kind is NULL");
    for (SceneKind k = 0; k < N_SCENES; k++)
        keys[k] = SCENES[k].key;
    q->kind = (SceneKind)index_of_word(q->asked, keys, N_SCENES);
    if (q->kind == N_SCENES)
        return fail_no_word(err, STATUS_USAGE, "kind", q->asked, "case", keys, N_SCENES);
    if (o->engine != ENGINE_FAST && (SCENES[q->kind].has & IS_JOINED || q->is_history))
        return misused(err, "rigid and histories are of sim.engine = fast alone");
    if (q->every_s != 0 && !(q->every_s >= 1e-5 && q->every_s <= 1e6))
        return misused(err, "every_s: %g is not between 1e-5 and 1e6 s, and not 0", q->every_s);
    if (q->kind == SCENE_NO_CORE)
        return STATUS_OK;
    if (!q->x || q->n != n_var)
        return misused(err, "x: has %zu numbers; a design of this scene has %zu", q->x ? q->n : 0, n_var);
    TRY(api_check_finite("x", n_var, q->x, "give finite ones", err));
    for (size_t j = 0; j < n_var; j++)
        TRY(design_check(space, (int)j, q->x[j], "x", err));
    return STATUS_OK;
}

/* Let a tower of the scene answer the question. */
static imtet_status ask(imtet_scene *s, Status answer(Question *q, Err *err), Question q, imtet_result **out,
                        imtet_error *error)
{
    Err err = {0};
    if (out)
        *out = NULL;
    if (!s || !out)
        return api_status(misused(&err, s ? "out is NULL" : "the scene is NULL: not opened, or freed"), &err, error);
    Status status = acquire_tower(s, &q.problem, &err);
    if (status != STATUS_OK)
        return api_status(status, &err, error);
    q.tower = tower_of(&q.problem);
    status = check_question(&q, &s->settings.sim, tower_design(q.tower), &err);
    THEN(status, result_create(out, &err));
    if (status == STATUS_OK) {
        q.result = *out;
        status = result_finish(out, answer(&q, &err), &err);
    }
    release_tower(s, &q.problem);
    return api_status(status, &err, error);
}

/* -- the scene ----------------------------------------------------------------------------------------------------- */

enum { VARIABLES, OBJECTIVES, SENSES };

/* A comma list of n names of one of these. */
static Status add_names(const Question *q, const char *what, int list, size_t n, Err *err)
{
    const MeasureOrder *order = tower_measures(q->tower);
    const size_t size = n * TABLE_NAME_MAX + 1;
    char name[TABLE_NAME_MAX], *names;
    TRY_ROOM(names, size, "names", err);
    for (size_t k = 0; k < n; k++) {
        if (list == VARIABLES)
            design_variable_name(tower_design(q->tower), (int)k, name);
        else
            text_copy(name, list == OBJECTIVES                 ? measures_name(order, order->of[k])
                            : measure(order->of[k])->sense > 0 ? "min"
                                                               : "max");
        text_join(names, size, ",", "%s", name);
    }
    result_text(q->result, what, names);
    free(names);
    return STATUS_OK;
}

/* Put the box of a search, its names and the frequencies of the building into the result. */
static Status describe(Question *q, Err *err)
{
    const Problem *p = &q->problem;
    const Scenario *scenario = tower_record(q->tower, 0);
    const int n_floors = tower_design(q->tower)->n_floors;
    SceneModes modes;
    TRY(scene_frequencies(scenario->scene, p->upper, &modes, err));
    result_numbers(q->result, "floors", 1, (double[]){n_floors});
    result_numbers(q->result, "lower", p->n_var, p->lower);
    result_numbers(q->result, "upper", p->n_var, p->upper);
    result_numbers(q->result, "building_hz", n_floors, modes.building_hz);
    result_text(q->result, "record", scenario->motion.name);
    TRY(add_names(q, "variables", VARIABLES, p->n_var, err));
    TRY(add_names(q, "objectives", OBJECTIVES, p->n_obj, err));
    return add_names(q, "senses", SENSES, p->n_obj, err);
}

imtet_status imtet_scene_describe(imtet_scene *scene, imtet_result **out, imtet_error *error)
{
    return ask(scene, describe, (Question){.asked = SCENES[SCENE_NO_CORE].key}, out, error);
}

/* -- one response -------------------------------------------------------------------------------------------------- */

/* The best device in the place of the gaps, where the case has one; the result then has it too. */
static Status find_device(const Question *q, LinearDevice *device, Err *err)
{
    DeviceSearch search = {.kind = q->kind, .x = q->x};
    const char *name;
    double value;
    if (case_has_device(q->kind))
        TRY(devices_find(&q->problem, 1, &search, err));
    *device = search.device;
    for (int i = 0; (name = case_device_number(q->kind, device, i, &value)); i++)
        result_numbers(q->result, name, 1, &value);
    return STATUS_OK;
}

/* Simulate once; the result has every measure and part that the case has. */
static Status simulate(Question *q, Err *err)
{
    SimResult s;
    SimTask task = {.kind = q->kind, .x = q->x};
    TRY(find_device(q, &task.device, err));
    TRY(tower_simulate(&q->problem, 1, &task, &s, err));
    for (int k = 0; k < MEASURES_LISTED; k++)
        result_numbers(q->result, measure(k)->name, 1, (double[]){measure_value(&s, k)});
    for (const ResultPart *part = RESULT_PARTS; part->name; part++) {
        double values[SIDES * FLOORS_MAX];
        size_t rows;
        const size_t n = result_part(&s, SCENES[q->kind].has, part, values, &rows);
        double *own = n > 0 ? result_table(q->result, part->name, rows > 1 ? rows : n, rows > 1 ? n : 1) : NULL;
        if (own)
            copy_values(rows * n, values, own);
    }
    result_text(q->result, "outcome", outcome_word((Outcome)s.outcome));
    result_text(q->result, "reason", s.reason);
    return STATUS_OK;
}

imtet_status imtet_scene_simulate(imtet_scene *scene, const char *kind, const double x[], size_t n, imtet_result **out,
                                  imtet_error *error)
{
    return ask(scene, simulate, (Question){.asked = kind, .x = x, .n = n}, out, error);
}

/* -- over time ----------------------------------------------------------------------------------------------------- */

/* The next n columns of the rows. */
static size_t add_columns(imtet_result *r, const Track *t, const char *name, size_t first, size_t n)
{
    double *own = result_table(r, name, t->n, n);
    for (size_t i = 0; own && i < t->n; i++)
        copy_values(n, t->rows + i * t->width + first, own + i * n);
    return first + n;
}

/* Simulate once more with samples, whose columns become tables. */
static Status history(Question *q, Err *err)
{
    static const char *const FLOORS[SAMPLE_PARTS] = {"floor_m", "floor_m_s", "drift_m",  "accel_g",
                                                     "core_m",  "core_m_s",  "contact_n"};
    static const char *const ENERGIES[N_ENERGIES] = {
        "kinetic_j", "strain_j", "damped_building_j", "core_j", "damped_core_j", "contacts_j", "input_j"};
    Track t;
    LinearDevice device;
    TRY(find_device(q, &device, err));
    TRY(track_run(tower_record(q->tower, 0)->scene, q->kind, q->x, &device, q->every_s, &t, err));
    size_t at = add_columns(q->result, &t, "t_s", 0, 1);
    at = add_columns(q->result, &t, "ground_g", at, 1);
    for (size_t k = 0; k < SAMPLE_PARTS; k++)
        at = add_columns(q->result, &t, FLOORS[k], at, t.n_floors);
    for (size_t k = 0; k < N_ENERGIES; k++)
        at = add_columns(q->result, &t, ENERGIES[k], at, 1);
    result_text(q->result, "outcome", outcome_word((Outcome)t.outcome));
    track_free(&t);
    return STATUS_OK;
}

imtet_status imtet_scene_history(imtet_scene *scene, const char *kind, const double x[], size_t n, double every_s,
                                 imtet_result **out, imtet_error *error)
{
    return ask(scene, history, (Question){.asked = kind, .x = x, .n = n, .every_s = every_s, .is_history = 1}, out,
               error);
}

/* -- a record ------------------------------------------------------------------------------------------------------ */

/* Read a record as a run does, with the settings of the caller. */
static Status read_motion(const char *path, const char *const list[], imtet_result **out, Err *err)
{
    Settings s;
    Motion m;
    if (!path || !out)
        return misused(err, "imtet_motion_read: %s is NULL", out ? "path" : "out");
    settings_defaults(&s);
    TRY(option_put_path(s.motion.record, path, err));
    TRY(api_settings(&s, list, err));
    TRY(settings_check(&s, err));
    TRY(motion_open(&m, &s.motion, err));
    Status status = motion_scale(&m, &s.motion, err);
    THEN(status, result_create(out, err));
    if (status == STATUS_OK) {
        imtet_result *r = *out;
        result_numbers(r, "acceleration", m.n, m.accel);
        result_numbers(r, "dt_s", 1, &m.dt_s);
        result_text(r, "name", m.name);
        result_text(r, "format", m.format);
        result_text(r, "channel", m.channel);
        result_text(r, "processed", m.processed);
        result_text(r, "warning", m.warning);
        status = result_finish(out, STATUS_OK, err);
    }
    motion_free(&m);
    return status;
}

imtet_status imtet_motion_read(const char *path, const char *const settings[], imtet_result **out, imtet_error *error)
{
    Err err = {0};
    if (out)
        *out = NULL;
    return api_status(read_motion(path, settings, out, &err), &err, error);
}
