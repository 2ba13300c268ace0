#include "sim/samples.h"

#include "base/carve.h"
#include "base/units.h"

void sample_energies(const SimSample *s, double energy[N_ENERGIES])
{
    for (int k = 0; k < N_ENERGIES; k++)
        energy[k] = s->damped_j ? 0 : NAN;
    for (int i = 0; s->damped_j && i < s->n_modes; i++) {
        const double wq = s->omega[i] * s->q[i];
        const int in_building = i < s->n_building;
        energy[in_building ? ENERGY_KINETIC : ENERGY_CORE] += 0.5 * s->v[i] * s->v[i];
        energy[in_building ? ENERGY_STRAIN : ENERGY_CORE] += 0.5 * wq * wq;
        energy[in_building ? ENERGY_DAMPED_BUILDING : ENERGY_DAMPED_CORE] += s->damped_j[i];
    }
    energy[ENERGY_INPUT] = s->input_j;
    energy[ENERGY_CONTACTS] = s->contacts_j;
}

void sample_row(const SimWorker *worker, const SimSample *s, size_t n_floors, double row[])
{
    FloorMotion f;
    sim_worker_motion(worker, s, &f);
    *row++ = s->t;
    *row++ = s->ground / GRAVITY;
    for (size_t j = 0; j < n_floors; j++, row++) {
        const double part[SAMPLE_PARTS] = {
            f.u[j],    f.u_dot[j],    f.u[j] - (j > 0 ? f.u[j - 1] : 0), f.u_ddot[j] / GRAVITY,
            f.core[j], f.core_dot[j], s->force ? s->force[j] : NAN};
        for (size_t k = 0; k < SAMPLE_PARTS; k++)
            row[k * n_floors] = part[k];
    }
    sample_energies(s, row + (SAMPLE_PARTS - 1) * n_floors);
}

/* The next row; NULL: no memory. A run that is repeated begins anew at t = 0; it may have wider rows. */
static double *next_row(Track *t, double time)
{
    if (time == 0)
        t->n = t->room = 0;
    if (t->n == t->room) {
        const size_t room = 2 * t->room + 1024;
        t->rows = widened(t->rows, room * t->width, sizeof *t->rows, &t->lacks_memory);
        if (t->lacks_memory)
            return NULL;
        t->room = room;
    }
    return t->rows + t->n++ * t->width;
}

static void note(const SimSample *s, void *user)
{
    Track *t = user;
    double *row = next_row(t, s->t);
    if (row)
        sample_row(t->worker, s, t->n_floors, row);
}

static void note_modes(const SimSample *s, void *user)
{
    Track *t = user;
    t->width = 1 + 2 * (size_t)s->n_modes;
    double *row = next_row(t, s->t);
    if (!row)
        return;
    *row++ = s->t;
    for (int i = 0; i < s->n_modes; i++) {
        *row++ = s->omega[i] * s->q[i];
        *row++ = s->v[i];
    }
}

/* Runs the worker of the track, which ends with it. */
static Status follow(Track *t, SceneKind kind, const double x[], SimResult *result, Err *err)
{
    SimWorker *worker = t->worker;
    Status status = sim_run(worker, kind, x, result, err);
    sim_worker_free(worker);
    if (status == STATUS_OK && t->lacks_memory)
        status = fail_memory(err, t->n, "rows of a response");
    if (status == STATUS_OK)
        t->outcome = result->outcome;
    else
        track_free(t);
    return status;
}

Status track_run(const Scene *scene, SceneKind kind, const double x[], const LinearDevice *device, double every_s,
                 Track *out, Err *err)
{
    SimResult result;
    const size_t n_floors = (size_t)scene_n_floors(scene);
    *out = (Track){.n_floors = n_floors, .width = SAMPLE_FIXED + SAMPLE_PARTS * n_floors};
    TRY(sim_worker_create(&out->worker, scene, err));
    sim_worker_sample(out->worker, every_s, note, out);
    sim_worker_device(out->worker, device);
    return follow(out, kind, x, &result, err);
}

Status track_modes(const Scene *scene, const double x[], Track *out, Err *err)
{
    SimResult result;
    *out = (Track){0};
    TRY(sim_worker_create(&out->worker, scene, err));
    sim_worker_sample(out->worker, 0, note_modes, out);
    TRY(follow(out, SCENE_IMPACT, x, &result, err));
    if (result.outcome == RUN_OK)
        return STATUS_OK;
    track_free(out);
    return bad_data(err, "the design cannot be simulated: %s", result.reason);
}

void track_free(Track *t)
{
    free(t->rows);
    *t = (Track){0};
}
