/* sim/energy_balance.h -- the energy balance of a run, and the shares of the input that are read from it.
 *
 *   input = kinetic + strain + damped + contacts (stored + lost + removed by the no-tension condition) + hysteresis
 *           + devices
 *
 * Threads  no state */
#pragma once

#include "sim/result.h"

/* [J] The error's denominator: the input, or what came out where the ground has taken back all that it gave. */
static inline double energy_balance_scale(double input, double out)
{
    const double scale = input > 0 ? input : fmax(-input, out);
    return scale > 0 ? scale : 1;
}

/* [%] Of the input: not a number where the ground has put in no net energy. */
static inline double energy_share(double part, double input)
{
    return input > 0 ? 100 * part / input : NAN;
}

/* From the shares of the n_modes modes those of groups of them. */
static inline void energy_balance_sum_shares(SimResult *result)
{
    result->ed1_pct = result->mode_share_pct[0];
    for (int i = 4; i < 10 && i < result->n_modes; i++)
        result->ed5_10_pct += result->mode_share_pct[i];
}

/* All shares, from the joules in result and damped[nb] of the building's modes, booked as like[nb] says. */
static inline void energy_balance_shares(SimResult *result, int nb, const int like[], const double damped[])
{
    const double input = result->input_energy_j;
    for (int i = 0; i < nb; i++)
        if (like[i] >= 0)
            result->mode_share_pct[like[i]] += energy_share(damped[i], input);
    energy_balance_sum_shares(result);
    result->edcs_pct = energy_share(result->damped_core_j, input);
    result->ed_hysteresis_pct = energy_share(result->hysteresis_j, input);
    result->ed_devices_pct = energy_share(result->device_loss_j, input);
}

/* From the joules already in result (input, kinetic_strain, contacts) and damped[nb + nc], building modes first.
 * by_ground: of a mat that lifts, beside them. */
static inline void energy_balance_close(SimResult *result, int nb, const int like[], int nc, const double damped[],
                                        double by_ground)
{
    double building = nc > 0 ? 0 : by_ground, core = nc > 0 ? by_ground : 0;
    const double input = result->input_energy_j;
    for (int i = 0; i < nb; i++)
        building += damped[i];
    for (int i = nb; i < nb + nc; i++)
        core += damped[i];
    result->damped_building_j = building;
    result->damped_core_j = core;
    energy_balance_shares(result, nb, like, damped);
    const double out = result->kinetic_strain_j + building + core + result->contact_stored_j + result->contact_loss_j +
                       result->clamp_j + result->hysteresis_j + result->device_loss_j;
    result->energy_balance_error = fabs(input - out) / energy_balance_scale(input, out);
    if (!isfinite(input - out)) {
        result->outcome = RUN_NOT_FINITE;
        snprintf(result->reason, sizeof result->reason, "the energies are not finite at the end of the run");
    }
}
