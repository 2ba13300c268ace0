#include "report/history.h"

static Status take_columns(const Track *t, size_t floor, History *h, Err *err)
{
    double *store;
    TRY_ROOM(store, t->n * (2 + N_ENERGIES) + 1, "samples", err);
    h->t = store;
    h->u = store + t->n;
    h->n = t->outcome == RUN_OK ? t->n : 0;
    for (size_t k = 0; k < N_ENERGIES; k++)
        h->energy[k] = store + (2 + k) * t->n;
    for (size_t i = 0; i < h->n; i++) {
        h->t[i] = track_at(t, i, 0);
        h->u[i] = track_at(t, i, 2 + floor);
        for (size_t k = 0; k < N_ENERGIES; k++)
            h->energy[k][i] = track_at(t, i, t->width - N_ENERGIES + k);
    }
    return STATUS_OK;
}

Status history_run(const Scenario *scenario, SceneKind kind, const double x[], int floor, History *out, Err *err)
{
    Scene *scene;
    Track track = {0};
    SceneOptions s = scenario->options;
    s.sim.engine = ENGINE_FAST; /* the others have no samples */
    *out = (History){.dt_s = scenario->motion.dt_s};
    TRY(scene_create(&scene, &s, &scenario->motion, err));
    Status status = track_run(scene, kind, x, &(LinearDevice){0}, 0, &track, err);
    THEN(status, take_columns(&track, (size_t)floor, out, err));
    track_free(&track);
    scene_free(scene);
    return status;
}

void history_free(History *h)
{
    free(h->t);
    memset(h, 0, sizeof *h);
}
