#include "analysis/horizon.h"

/* States of one run, sample by sample: sqrt(2 energy) per mode, as pairs (w q, q'). */
typedef struct {
    size_t n, n_modes, room;
    double *t, *state; /* (n) [s], (n, 2 n_modes) [sqrt(J)] */
    int no_memory;
} Track;

static void note(const SimSample *sample, void *user)
{
    Track *track = user;
    const size_t m = (size_t)sample->n_modes;
    if (sample->t == 0)
        track->n = 0;
    if (track->n == track->room) {
        const size_t room = track->room ? 2 * track->room : 1024;
        double *times = realloc(track->t, room * sizeof *times);
        track->t = times ? times : track->t;
        double *states = times ? realloc(track->state, room * 2 * m * sizeof *states) : NULL;
        track->state = states ? states : track->state;
        if (!states) {
            track->no_memory = 1;
            return;
        }
        track->room = room;
    }
    track->n_modes = m;
    double *row = track->state + track->n * 2 * m;
    for (size_t i = 0; i < m; i++) {
        row[2 * i] = sample->omega[i] * sample->q[i];
        row[2 * i + 1] = sample->v[i];
    }
    track->t[track->n++] = sample->t;
}

static Status follow(const Scenario *scenario, const double x[], Track *track, Err *err)
{
    SimWorker *worker;
    SimResult result;
    TRY(sim_worker_create(&worker, scenario->scene, err));
    sim_worker_sample(worker, 0, note, track);
    Status status = sim_run(worker, SCENE_IMPACT, x, &result, err);
    sim_worker_free(worker);
    if (status == STATUS_OK && track->no_memory)
        status = fail(err, STATUS_NO_MEMORY, "no memory to keep a run of %zu samples", track->n);
    if (status == STATUS_OK && result.outcome != RUN_OK)
        status = bad_data(err, "the design cannot be simulated: %s", result.reason);
    return status;
}

static void compare(const Track *a, const Track *b, Horizon *out)
{
    double largest = 0;
    *out = (Horizon){.reached_s = {NAN, NAN, NAN, NAN}};
    for (size_t k = 0; k < a->n && k < b->n; k++) {
        double apart = 0, whole = 0;
        for (size_t i = 0; i < 2 * a->n_modes; i++) {
            const double x = a->state[k * 2 * a->n_modes + i], y = b->state[k * 2 * a->n_modes + i];
            apart += (x - y) * (x - y);
            whole += x * x;
        }
        largest = fmax(largest, whole);
        out->end_s = a->t[k];
        out->distance_at_end = largest > 0 ? sqrt(apart / largest) : 0;
        for (int level = 0; level < HORIZON_LEVELS; level++)
            if (isnan(out->reached_s[level]) && out->distance_at_end > HORIZON_LEVEL[level])
                out->reached_s[level] = a->t[k];
    }
}

Status horizon_find(const Scenario *scenario, const double x[], double change, Horizon *out, Err *err)
{
    const DesignSpace *design = scene_design(scenario->scene);
    double changed[DESIGN_VARIABLES_MAX];
    Track one = {0}, other = {0};
    for (int j = 0; j < design->n_var; j++)
        changed[j] = x[j] * (j < design->n_gaps ? 1 + change : 1);
    Status status = follow(scenario, x, &one, err);
    THEN(status, follow(scenario, changed, &other, err));
    if (status == STATUS_OK)
        compare(&one, &other, out);
    free(one.t);
    free(one.state);
    free(other.t);
    free(other.state);
    return status;
}
