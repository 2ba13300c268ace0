#include "simulator/measures.h"

#include <math.h>

static const Measure MEASURES[N_MEASURES] = {
    {"j1_m", 1, "largest floor displacement"},
    {"j2_m", 1, "largest interstorey drift"},
    {"j3_g", 1, "largest floor acceleration"},
    {"ed1_pct", 1, "share of the input dissipated by the first building mode"},
    {"ed5_10_pct", -1, "share dissipated by building modes 5 to 10"},
    {"edcs_pct", -1, "share dissipated by the core"},
    {"mcore_kg", 1, "mass of the core"},
    {"input_energy_j", 0, "energy that the ground put in"},
    {"energy_balance_error", 0, "of the energy balance, as a share of the input"},
    {"impacts", 0, "closings of any gap"},
};

const Measure *measure(int k)
{
    return &MEASURES[k];
}

double measure_value(const SimResult *r, int k)
{
    const double values[N_MEASURES] = {r->j1_m,           r->j2_m,           r->j3_g,
                                       r->ed1_pct,        r->ed5_10_pct,     r->edcs_pct,
                                       r->mcore_kg,       r->input_energy_j, r->energy_balance_error,
                                       (double)r->impacts};
    return values[k];
}

int measure_objectives(const SimResult *r, double f[N_OBJECTIVES])
{
    int ok = r->outcome == RUN_OK;
    for (int k = 0; k < N_OBJECTIVES; k++) {
        f[k] = MEASURES[k].sense * measure_value(r, k);
        ok = ok && isfinite(f[k]);
    }
    return ok;
}

Outcome measure_outcome(RunOutcome outcome)
{
    static const Outcome OUTCOMES[] = {
        [RUN_OK] = OUTCOME_OK,
        [RUN_NOT_FINITE] = OUTCOME_NOT_FINITE,
        [RUN_OUT_OF_STEPS] = OUTCOME_OUT_OF_STEPS,
        [RUN_ENERGY_BALANCE] = OUTCOME_ENERGY_BALANCE,
        [RUN_ENGINE_FAILED] = OUTCOME_ENGINE_FAILED,
    };
    return OUTCOMES[outcome];
}
