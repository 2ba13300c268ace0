#include "sim/sample_energy.h"

#include "base/units.h"
#include "sim/sim.h"

static void add_mode(const SimSample *s, int i, double energy[N_ENERGIES])
{
    const double wq = s->omega[i] * s->q[i], kinetic = 0.5 * s->v[i] * s->v[i], strain = 0.5 * wq * wq;
    const double damped = s->damped_j[i];
    const int in_building = i < s->n_building;
    energy[in_building ? ENERGY_KINETIC : ENERGY_CORE] += kinetic;
    energy[in_building ? ENERGY_STRAIN : ENERGY_CORE] += strain;
    energy[in_building ? ENERGY_DAMPED_BUILDING : ENERGY_DAMPED_CORE] += damped;
}

void sample_energies(const SimSample *s, double energy[N_ENERGIES])
{
    for (int k = 0; k < N_ENERGIES; k++)
        energy[k] = s->damped_j ? 0 : NAN;
    for (int i = 0; s->damped_j && i < s->n_modes; i++)
        add_mode(s, i, energy);
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
