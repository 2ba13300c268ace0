#include "sim/samples.h"

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

/* A run that is repeated begins anew at t = 0. */
static void note(const SimSample *s, void *user)
{
    Track *t = user;
    if (s->t == 0)
        t->n = 0;
    if (t->n == t->room) {
        const size_t room = 2 * t->room + 1024;
        double *wider = realloc(t->rows, room * t->width * sizeof *wider);
        t->lacks_memory |= !wider;
        if (!wider)
            return;
        t->rows = wider;
        t->room = room;
    }
    sample_row(t->worker, s, t->n_floors, t->rows + t->n++ * t->width);
}

Status track_run(const Scene *scene, SceneKind kind, const double x[], const LinearDevice *device, double every_s,
                 Track *out, Err *err)
{
    SimWorker *worker;
    SimResult result;
    const size_t n_floors = (size_t)scene_n_floors(scene);
    *out = (Track){.n_floors = n_floors, .width = SAMPLE_FIXED + SAMPLE_PARTS * n_floors};
    TRY(sim_worker_create(&worker, scene, err));
    out->worker = worker;
    sim_worker_sample(worker, every_s, note, out);
    sim_worker_device(worker, device);
    Status status = sim_run(worker, kind, x, &result, err);
    sim_worker_free(worker);
    if (status == STATUS_OK && out->lacks_memory)
        status = fail_memory(err, out->n, "rows of a response");
    if (status == STATUS_OK)
        out->outcome = result.outcome;
    else
        track_free(out);
    return status;
}

void track_free(Track *t)
{
    free(t->rows);
    *t = (Track){0};
}
