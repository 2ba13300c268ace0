#include "analysis/full_model.h"

#include "analysis/estimate.h"

/* Above the degrees of freedom of any frame. */
enum { ALL_MODES = 100000 };

/* Both models as scenes of one tower, then the designs by each. */
static Status find(const Settings *s, SceneKind kind, size_t n, const double X[], SimTask *tasks, FullModel *m,
                   Err *err)
{
    SceneChange scene[MODELS] = {{0}, {0}};
    const char *const record = s->motion.record;
    Problem p;
    snprintf(scene[FULL].setting, sizeof scene->setting, "building.modes=%d", ALL_MODES);
    for (int model = 0; model < MODELS; model++) {
        BuildingOptions options = s->building;
        Building b;
        double z = 0;
        options.modes = model == FULL ? ALL_MODES : options.modes;
        TRY(building_load(&b, &options, err));
        m->dofs[model] = b.model.n;
        m->n_floors = b.n;
        for (int j = 0; j < b.n; j++)
            m->z[j] = z += b.storey_m[j];
        building_free(&b);
    }
    TRY(tower_open_scenes(&p, s, 1, &record, MODELS, scene, err));
    for (size_t i = 0; i < MODELS * n; i++)
        tasks[i] = (SimTask){
            .kind = kind, .x = X ? X + i % n * p.n_var : NULL, .scene = i / n, .result = &m->result[i / n][i % n]};
    Status status = tower_motion(&p, REDUCED, &m->motion, err);
    THEN(status, tower_run(&p, MODELS * n, tasks, NULL, NULL, err));
    if (status == STATUS_OK && m->error)
        status = estimate_designs(&p, n, tasks, m->result[REDUCED], m->error, NULL, err);
    problem_close(&p);
    return status;
}

Status full_model_find(const Settings *settings, SceneKind kind, size_t n, const double X[], int estimates,
                       FullModel *out, Err *err)
{
    Settings s = *settings;
    SimTask *tasks = calloc(MODELS * n, sizeof *tasks);
    s.sim.replicates = 1;
    *out = (FullModel){.result = {calloc(n, sizeof(SimResult)), calloc(n, sizeof(SimResult))}};
    if (estimates)
        out->error = calloc(n, N_MEASURES * sizeof *out->error);
    const int is_there = tasks && out->result[REDUCED] && out->result[FULL] && (out->error || !estimates);
    const Status status = is_there ? find(&s, kind, n, X, tasks, out, err) : fail_memory(err, n, "simulations");
    free(tasks);
    if (status != STATUS_OK)
        full_model_free(out);
    return status;
}

void full_model_free(FullModel *m)
{
    motion_free(&m->motion);
    for (int i = 0; i < MODELS; i++)
        free(m->result[i]);
    free(m->error);
    *m = (FullModel){0};
}
