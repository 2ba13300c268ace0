#include "serve/on_demand.h"

#include <pthread.h>
#include <stdatomic.h>

#include "base/json.h"
#include "report/elsewhere.h"
#include "report/report_json.h"
#include "report/what_if.h"
#include "settings/settings.h"

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
    pthread_mutex_t designs; /* of the rest */
    KnownDesign design[DESIGNS_KEPT];
    size_t next_design;
    char *scene; /* what_if_json as text; NULL: nobody asked yet */
};

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
    for (size_t i = 0; i < DESIGNS_KEPT; i++)
        free(o->design[i].text);
    pthread_mutex_destroy(&o->designs);
    free(o->provenance);
    free(o->scene);
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
                                   .run = run,
                                   .row = row,
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

Status on_demand_scene(OnDemand *o, const Run *run, char **text, Err *err)
{
    json_t *scene;
    pthread_mutex_lock(&o->designs);
    Status status = o->scene ? STATUS_OK : what_if_json(run, o->moved, &scene, err);
    if (status == STATUS_OK && !o->scene) {
        o->scene = json_dumps(scene, JSON_COMPACT);
        json_decref(scene);
    }
    *text = status == STATUS_OK ? strdup(o->scene) : NULL;
    pthread_mutex_unlock(&o->designs);
    return status;
}
