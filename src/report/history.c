#include "report/history.h"

typedef struct {
    History *h;
    size_t room;
    int floor;
    const SimWorker *worker;
} Track;

static Status make_room(History *h, size_t room, Err *err)
{
    double *store;
    TRY_ROOM(store, room * (2 + N_ENERGIES), "samples", err);
    h->t = store;
    h->u = store + room;
    for (size_t k = 0; k < N_ENERGIES; k++)
        h->energy[k] = store + (2 + k) * room;
    return STATUS_OK;
}

static void note(const SimSample *sample, void *user)
{
    Track *track = user;
    History *h = track->h;
    double u[FLOORS_MAX], energy[N_ENERGIES];
    if (sample->t == 0)
        h->n = 0;
    if (h->n == track->room)
        return;
    sample_energies(sample, energy);
    sim_worker_floors(track->worker, sample, u);
    h->t[h->n] = sample->t;
    h->u[h->n] = u[track->floor];
    for (int k = 0; k < N_ENERGIES; k++)
        h->energy[k][h->n] = energy[k];
    h->n++;
}

static Status follow(const Scenario *scenario, const Scene *scene, SceneKind kind, const double x[], int floor,
                     History *out, Err *err)
{
    SimWorker *worker;
    SimResult result;
    const double wanted = scenario->options.sim.duration_s, dt = scenario->motion.dt_s;
    const size_t samples = wanted > 0 ? (size_t)(wanted / dt) + 2 : scenario->motion.n;
    TRY(make_room(out, samples, err));
    TRY(sim_worker_create(&worker, scene, err));
    Track track = {.h = out, .room = samples, .floor = floor, .worker = worker};
    sim_worker_sample(worker, 0, note, &track);
    const Status status = sim_run(worker, kind, x, &result, err);
    sim_worker_free(worker);
    if (status == STATUS_OK && result.outcome != RUN_OK)
        out->n = 0;
    return status;
}

Status history_run(const Scenario *scenario, SceneKind kind, const double x[], int floor, History *out, Err *err)
{
    Scene *scene;
    SceneOptions s = scenario->options;
    s.sim.engine = ENGINE_FAST; /* the others have no samples */
    *out = (History){.dt_s = scenario->motion.dt_s};
    TRY(scene_create(&scene, &s, &scenario->motion, err));
    const Status status = follow(scenario, scene, kind, x, floor, out, err);
    scene_free(scene);
    if (status != STATUS_OK)
        history_free(out);
    return status;
}

void history_free(History *h)
{
    free(h->t);
    memset(h, 0, sizeof *h);
}
