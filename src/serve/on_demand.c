#include "serve/on_demand.h"

#include <pthread.h>
#include <stdatomic.h>

#include "base/json.h"
#include "report/elsewhere.h"
#include "report/report_json.h"
#include "report/what_if.h"
#include "settings/settings.h"
#include "store/store.h"
#include "study/improver.h"

struct OnDemand {
    char *provenance; /* of the run, with when it began: it does not change */
    const RecordPaths *moved;
    atomic_int n_users;
    pthread_mutex_t designs; /* of the rest */
    long knee;               /* of the last one that stood beside all baselines, */
    char *knee_text;         /* its answer; NULL: none */
    char *scene;             /* what_if_json as text; NULL: nobody asked yet */
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
    free(o->knee_text);
    pthread_mutex_destroy(&o->designs);
    free(o->provenance);
    free(o->scene);
    free(o);
}

int on_demand_is_of(const OnDemand *o, const Run *run)
{
    return strcmp(o->provenance, run->provenance) == 0;
}

/* -- a design of the run ------------------------------------------------------------------------------------------- */

/* One that is kept, or simulated now. What the further records of the run do is part of the detail already. The mutex
 * is held. */
static Status find_design(OnDemand *o, const Run *run, long id, char **text, Err *err)
{
    const size_t row = run_find(run, id);
    const int with_devices = run->n_front > 0 && row == run_knee(run);
    Settings s = *run->settings;
    OtherRecords others = {0};
    Detail d;
    *text = with_devices && o->knee_text && o->knee == id ? strdup(o->knee_text) : NULL;
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
    if (with_devices) {
        free(o->knee_text);
        o->knee_text = strdup(*text);
        o->knee = id;
    }
    return STATUS_OK;
}

Status on_demand_design(OnDemand *o, const Run *run, long id, char **text, Err *err)
{
    pthread_mutex_lock(&o->designs);
    const Status status = find_design(o, run, id, text, err);
    pthread_mutex_unlock(&o->designs);
    return status;
}

/* An ImproveMethod: the design that the user brings is simulated as the run does, and is the next one of the path. */
static Status try_kept(Improver *m, Err *err)
{
    const double *x = m->config->user;
    for (size_t j = 0; j < m->problem->n_var; j++)
        if (!(x[j] >= m->problem->lower[j] && x[j] <= m->problem->upper[j]))
            return bad_data(err, "%s: %g is outside of its bounds", schema_variable(&m->run->schema, j)->name, x[j]);
    double built[DESIGN_VARIABLES_MAX]; /* of a tower */
    memcpy(built, x, m->problem->n_var * sizeof *x);
    problem_repair(m->problem, built);
    if (memcmp(built, x, m->problem->n_var * sizeof *x) != 0)
        return bad_data(
            err, "cannot be built so: steps, stock plates, whole choices, and no core that is thicker at its top");
    TRY(improver_note(m, 1, &x, 0, err));
    return improver_check(m, err);
}

Status on_demand_keep(OnDemand *o, const Run *run, size_t n, double x[], long *id, Err *err)
{
    Settings s = *run->settings;
    Run now = {0}, with = *run;
    Improved tried = {0};
    RunStore *store;
    if (run->n_front == 0)
        return run_why_empty(run, err);
    if (n != run->schema.n_var || s.problem.kind != PROBLEM_TOWER)
        return bad_data(err, "a design to keep is of a tower; one of %s has %zu variables", run->folder,
                        run->schema.n_var);
    for (size_t i = 0; i < run->table.n; i++)
        if (memcmp(run_x(run, i), x, n * sizeof *x) == 0) {
            *id = run->table.row[i].id;
            return STATUS_OK;
        }
    TRY(record_paths_find(&s, run->provenance, o->moved, err));
    TRY(store_open(&store, run->folder, 0, err));
    with.settings = &s;
    Status status = improve_design(&with, run_knee(run), &(ImproveConfig){.user = x}, try_kept, &tried, err);
    if (status == STATUS_OK) {
        Evaluation *kept = &tried.designs.row[1];
        kept->kind = KIND_KEPT;
        status = store_polished(store, kept, run->tried_to_polish, run->polished_at, id, err);
        THEN(status, store_write_front(store, &now, err));
    }
    run_free(&now);
    improved_free(&tried);
    store_free(store);
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
