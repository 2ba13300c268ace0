#include "analysis/baselines.h"

/* From the simulations under each record, by the rule of the study. */
static void summarise(const ReplicateSummary *sum, const LinearDevice *device, Baseline *out)
{
    out->device = *device;
    out->outcome = sum->outcome;
    for (int k = 0; k < N_MEASURES; k++)
        out->value[k] = sum->outcome == OUTCOME_OK ? sum->mean[k] : NAN;
}

Status baselines_find(const Problem *p, const double x[], int with_devices, Baseline out[N_SCENES], Err *err)
{
    DeviceSearch found[N_SCENES];
    SimTask task[N_SCENES];
    ReplicateSummary sum[N_SCENES];
    LinearDevice device[N_SCENES] = {0};
    size_t n = 0, n_found = 0;
    for (SceneKind k = 0; k < N_SCENES; k++) {
        out[k] = (Baseline){.outcome = OUTCOME_ERROR,
                            .first = {.outcome = RUN_ENGINE_FAILED, .reason = "it was not asked for"}};
        if (case_has_device(k) && with_devices)
            found[n_found++] = (DeviceSearch){.kind = k, .x = x};
    }
    TRY(n_found > 0 ? devices_find(p, n_found, found, err) : STATUS_OK);
    for (size_t i = 0; i < n_found; i++)
        device[found[i].kind] = found[i].device;
    for (SceneKind k = SCENE_IMPACT + 1; k < N_SCENES; k++)
        if (with_devices || !case_has_device(k))
            task[n++] = (SimTask){.kind = k,
                                  .x = x,
                                  .device = device[k],
                                  .n_parts = tower_n_records(tower_of(p)),
                                  .result = &out[k].first,
                                  .summary = &sum[k]};
    TRY(tower_run(p, n, task, NULL, NULL, err));
    for (size_t i = 0; i < n; i++)
        summarise(&sum[task[i].kind], &device[task[i].kind], &out[task[i].kind]);
    return STATUS_OK;
}
