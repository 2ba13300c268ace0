#include "analysis/baselines.h"

Status baselines_find(const Problem *p, const double x[], int with_devices, Baseline out[N_SCENES], Err *err)
{
    DeviceSearch found[N_SCENES];
    SimTask task[N_SCENES];
    ReplicateSummary sum[N_SCENES];
    size_t n = 0, n_found = 0;
    for (SceneKind k = 0; k < N_SCENES; k++) {
        out[k] = (Baseline){.outcome = OUTCOME_ERROR,
                            .first = {.outcome = RUN_ENGINE_FAILED, .reason = "it was not asked for"}};
        if (case_has_device(k) && with_devices)
            found[n_found++] = (DeviceSearch){.kind = k, .x = x};
    }
    TRY(n_found > 0 ? devices_find(p, n_found, found, err) : STATUS_OK);
    for (size_t i = 0; i < n_found; i++)
        out[found[i].kind].device = found[i].device;
    for (SceneKind k = SCENE_IMPACT + 1; k < N_SCENES; k++)
        if (with_devices || !case_has_device(k))
            task[n++] = (SimTask){.kind = k,
                                  .x = x,
                                  .device = out[k].device,
                                  .n_parts = tower_n_records(tower_of(p)),
                                  .result = &out[k].first,
                                  .summary = &sum[k]};
    TRY(tower_run(p, n, task, NULL, NULL, err));
    for (size_t i = 0; i < n; i++) { /* the simulations under each record, by the rule of the study */
        const SceneKind kind = task[i].kind;
        out[kind].outcome = sum[kind].outcome;
        for (int k = 0; k < N_MEASURES; k++)
            out[kind].value[k] = sum[kind].outcome == OUTCOME_OK ? sum[kind].mean[k] : NAN;
    }
    return STATUS_OK;
}
