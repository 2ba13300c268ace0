#include <pthread.h>

#include "api/named_values.h"
#include "base/linalg.h"
#include "evaluate/device.h"
#include "evaluate/tower.h"
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

static Status open_tower(const imtet_scene *s, Problem *p, Err *err)
{
    linalg_begin();
    const Status status = tower_open(p, &s->settings, TOWER_SINGLE, 1, err);
    linalg_end();
    return status;
}

static Status take_tower(imtet_scene *s, Problem *p, Err *err)
{
    Status status = STATUS_OK;
    pthread_mutex_lock(&s->lock);
    if (s->n_idle > 0)
        *p = s->idle[--s->n_idle];
    else
        status = open_tower(s, p, err);
    pthread_mutex_unlock(&s->lock);
    return status;
}

/* Kept for the next one; closed where there is no memory for it. */
static void give_back(imtet_scene *s, Problem *p)
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

static Status read_settings(Settings *s, const char *path, const char *const list[], Err *err)
{
    settings_defaults(s);
    if (path)
        TRY(settings_read(s, path, NULL, NULL, err));
    TRY(api_settings(s, list, err));
    return settings_check(s, err);
}

static Status open_scene(const char *path, const char *const list[], imtet_scene **out, Err *err)
{
    imtet_scene *s;
    Problem first;
    if (!out)
        return misused(err, "imtet_scene_open: out is NULL");
    *out = NULL;
    TRY_ROOM(s, 1, "a scene", err);
    pthread_mutex_init(&s->lock, NULL);
    Status status = read_settings(&s->settings, path, list, err);
    if (status == STATUS_OK)
        status = take_tower(s, &first, err);
    if (status == STATUS_OK) {
        give_back(s, &first);
        *out = s;
    } else {
        imtet_scene_free(&s);
    }
    return status;
}

imtet_status imtet_scene_open(const char *path, const char *const settings[], imtet_scene **out, imtet_error *error)
{
    Err err = {0};
    return api_status(open_scene(path, settings, out, &err), &err, error);
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
    const char *asked;
    const double *x;
    size_t n;
    double every_s;
    int is_history;
    SceneKind kind;
    imtet_result *result;
} Question;

typedef Status (*AnswerFn)(const Problem *p, const Question *q, Err *err);

static Status check_kind(Question *q, const SimOptions *o, Err *err)
{
    const char *keys[N_SCENES];
    if (!q->asked)
        return misused(err, "kind is NULL");
    for (SceneKind k = 0; k < N_SCENES; k++)
        keys[k] = SCENES[k].key;
    for (q->kind = 0; q->kind < N_SCENES && strcmp(keys[q->kind], q->asked) != 0;)
        q->kind++;
    if (q->kind == N_SCENES)
        return fail_no_word(err, STATUS_USAGE, "kind", q->asked, "case", keys, N_SCENES);
    if (o->engine != ENGINE_FAST && (SCENES[q->kind].has & IS_JOINED || q->is_history))
        return misused(err, "rigid and histories are of sim.engine = fast alone");
    return q->every_s == 0 || (q->every_s >= 1e-5 && q->every_s <= 1e6)
               ? STATUS_OK
               : misused(err, "every_s: %g is not between 1e-5 and 1e6 s, and not 0", q->every_s);
}

static Status check_design(const DesignSpace *space, const Question *q, Err *err)
{
    const size_t n_var = (size_t)space->n_var;
    if (q->kind == SCENE_NO_CORE)
        return STATUS_OK;
    if (!q->x || q->n != n_var)
        return misused(err, "x: has %zu numbers; a design of this scene has %zu", q->x ? q->n : 0, n_var);
    TRY(api_check_finite("x", n_var, q->x, "give finite ones", err));
    for (size_t j = 0; j < n_var; j++)
        TRY(design_check(space, (int)j, q->x[j], "x", err));
    return STATUS_OK;
}

static Status answer(imtet_scene *s, AnswerFn fn, Question *q, imtet_result **out, Err *err)
{
    Problem p;
    if (!s || !out)
        return misused(err, s ? "out is NULL" : "the scene is NULL: not opened, or freed");
    TRY(check_kind(q, &s->settings.sim, err));
    TRY(take_tower(s, &p, err));
    Status status = check_design(tower_design(tower_of(&p)), q, err);
    if (status == STATUS_OK)
        status = result_create(out, err);
    if (status == STATUS_OK) {
        q->result = *out;
        status = result_finish(out, fn(&p, q, err), err);
    }
    give_back(s, &p);
    return status;
}

static imtet_status ask(imtet_scene *s, AnswerFn fn, Question q, imtet_result **out, imtet_error *error)
{
    Err err = {0};
    if (out)
        *out = NULL;
    return api_status(answer(s, fn, &q, out, &err), &err, error);
}

/* -- the scene ----------------------------------------------------------------------------------------------------- */

typedef void (*NameFn)(const Tower *t, int k, char name[TABLE_NAME_MAX]);

static void variable(const Tower *t, int j, char name[TABLE_NAME_MAX])
{
    design_variable_name(tower_design(t), j, name);
}

static void objective(const Tower *t, int k, char name[TABLE_NAME_MAX])
{
    snprintf(name, TABLE_NAME_MAX, "%s", measures_name(tower_measures(t), tower_measures(t)->of[k]));
}

static void sense(const Tower *t, int k, char name[TABLE_NAME_MAX])
{
    snprintf(name, TABLE_NAME_MAX, "%s", measure(tower_measures(t)->of[k])->sense > 0 ? "min" : "max");
}

/* A comma list. */
static Status add_names(imtet_result *r, const char *what, const Tower *t, int n, NameFn name_of, Err *err)
{
    char name[TABLE_NAME_MAX], *names, *end;
    TRY_ROOM(names, (size_t)n * TABLE_NAME_MAX + 1, "names", err);
    end = names;
    for (int k = 0; k < n; k++) {
        name_of(t, k, name);
        end += sprintf(end, k ? ",%s" : "%s", name);
    }
    result_text(r, what, names);
    free(names);
    return STATUS_OK;
}

static Status describe(const Problem *p, const Question *q, Err *err)
{
    const Tower *t = tower_of(p);
    const int n_floors = tower_n_floors(t), n_obj = (int)p->n_obj;
    SceneModes modes;
    TRY(scene_frequencies(tower_record(t, 0)->scene, p->upper, &modes, err));
    result_numbers(q->result, "floors", 1, (double[]){n_floors});
    result_numbers(q->result, "lower", p->n_var, p->lower);
    result_numbers(q->result, "upper", p->n_var, p->upper);
    result_numbers(q->result, "building_hz", (size_t)n_floors, modes.building_hz);
    result_text(q->result, "record", tower_record(t, 0)->motion.name);
    TRY(add_names(q->result, "variables", t, (int)p->n_var, variable, err));
    TRY(add_names(q->result, "objectives", t, n_obj, objective, err));
    return add_names(q->result, "senses", t, n_obj, sense, err);
}

imtet_status imtet_scene_describe(imtet_scene *scene, imtet_result **out, imtet_error *error)
{
    return ask(scene, describe, (Question){.asked = SCENES[SCENE_NO_CORE].key}, out, error);
}

/* -- one response -------------------------------------------------------------------------------------------------- */

/* The best one in the place of the gaps, which the result then has too. */
static Status find_device(const Problem *p, const Question *q, LinearDevice *device, Err *err)
{
    DeviceSearch search = {.kind = q->kind, .x = q->x};
    if (SCENES[q->kind].has & HAS_DEVICE)
        TRY(devices_find(p, 1, &search, err));
    *device = search.device;
    if (q->kind == SCENE_TMD)
        result_numbers(q->result, "tmd_hz", 1, &device->tmd_hz);
    if (q->kind == SCENE_TMD)
        result_numbers(q->result, "tmd_damping", 1, &device->tmd_damping);
    if (q->kind == SCENE_LINKS)
        result_numbers(q->result, "link_ns_m", 1, &device->link_ns_m);
    return STATUS_OK;
}

static Status simulate(const Problem *p, const Question *q, Err *err)
{
    SimResult s;
    imtet_result *r = q->result;
    LinearDevice device;
    TRY(find_device(p, q, &device, err));
    TRY(tower_simulate(p, 1, &(SimTask){.kind = q->kind, .x = q->x, .device = device}, &s, err));
    for (int k = 0; k < MEASURES_LISTED; k++)
        result_numbers(r, measure(k)->name, 1, (double[]){measure_value(&s, k)});
    for (const ResultPart *part = RESULT_PARTS; part->name; part++) {
        double values[SIDES * FLOORS_MAX];
        size_t rows;
        const size_t n = result_part(&s, SCENES[q->kind].has, part, values, &rows);
        double *own = n > 0 ? result_table(r, part->name, rows > 1 ? rows : n, rows > 1 ? n : 1) : NULL;
        if (own)
            memcpy(own, values, rows * n * sizeof *own);
    }
    result_text(r, "outcome", outcome_word(measure_outcome(s.outcome)));
    result_text(r, "reason", s.reason);
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
        memcpy(own + i * n, t->rows + i * t->width + first, n * sizeof *own);
    return first + n;
}

static void add_history(imtet_result *r, const Track *t)
{
    static const char *const FLOORS[SAMPLE_PARTS] = {"floor_m", "floor_m_s", "drift_m",  "accel_g",
                                                     "core_m",  "core_m_s",  "contact_n"};
    static const char *const ENERGIES[N_ENERGIES] = {
        "kinetic_j", "strain_j", "damped_building_j", "core_j", "damped_core_j", "contacts_j", "input_j"};
    size_t at = add_columns(r, t, "ground_g", add_columns(r, t, "t_s", 0, 1), 1);
    for (size_t k = 0; k < SAMPLE_PARTS; k++)
        at = add_columns(r, t, FLOORS[k], at, t->n_floors);
    for (size_t k = 0; k < N_ENERGIES; k++)
        at = add_columns(r, t, ENERGIES[k], at, 1);
}

static Status history(const Problem *p, const Question *q, Err *err)
{
    Track t;
    LinearDevice device;
    TRY(find_device(p, q, &device, err));
    TRY(track_run(tower_record(tower_of(p), 0)->scene, q->kind, q->x, &device, q->every_s, &t, err));
    add_history(q->result, &t);
    result_text(q->result, "outcome", outcome_word(measure_outcome(t.outcome)));
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

static void add_motion(imtet_result *r, const Motion *m)
{
    result_numbers(r, "acceleration", m->n, m->accel);
    result_numbers(r, "dt_s", 1, &m->dt_s);
    result_text(r, "name", m->name);
    result_text(r, "format", m->format);
    result_text(r, "channel", m->channel);
    result_text(r, "processed", m->processed);
    result_text(r, "warning", m->warning);
}

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
    if (status == STATUS_OK)
        status = result_create(out, err);
    if (status == STATUS_OK) {
        add_motion(*out, &m);
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
