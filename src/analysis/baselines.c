#include "analysis/baselines.h"

static const struct {
    const char *words, *key;
    SceneKind scene;
} BASELINES[N_BASELINES] = {
    [BASELINE_NO_CORE] = {"no core", "no_core", SCENE_NO_CORE},
    [BASELINE_RIGID] = {"rigidly connected", "rigid", SCENE_RIGID},
    [BASELINE_TMD] = {"tuned mass damper", "tmd", SCENE_TMD},
    [BASELINE_LINKS] = {"viscous links", "links", SCENE_LINKS},
};

const char *baseline_words(BaselineKind kind)
{
    return BASELINES[kind].words;
}

const char *baseline_key(BaselineKind kind)
{
    return BASELINES[kind].key;
}

void baseline_device_text(BaselineKind kind, const LinearDevice *d, char text[DEVICE_TEXT_MAX])
{
    text[0] = 0;
    if (kind == BASELINE_TMD)
        snprintf(text, DEVICE_TEXT_MAX, "%.3g Hz, damping %.2g", d->tmd_hz, d->tmd_damping);
    if (kind == BASELINE_LINKS)
        snprintf(text, DEVICE_TEXT_MAX, "%.3g MN s/m per floor", 1e-6 * d->link_ns_m);
}

/* From the simulations under each record, by the rule of the study. */
static void summarise(const ReplicateSummary *sum, const LinearDevice *device, Baseline *out)
{
    out->device = *device;
    out->outcome = sum->outcome;
    for (int k = 0; k < N_MEASURES; k++)
        out->value[k] = sum->outcome == OUTCOME_OK ? sum->mean[k] : NAN;
}

Status baselines_find(const Problem *p, const double x[], BaselineKind last, Baseline out[N_BASELINES], Err *err)
{
    const size_t n = last >= BASELINE_TMD ? N_BASELINES : (size_t)last + 1;
    DeviceSearch found[N_BASELINES] = {0};
    SimTask task[N_BASELINES];
    ReplicateSummary sum[N_BASELINES];
    for (size_t k = 0; k < N_BASELINES; k++) {
        out[k] = (Baseline){.outcome = OUTCOME_ERROR,
                            .first = {.outcome = RUN_ENGINE_FAILED, .reason = "it was not asked for"}};
        found[k] = (DeviceSearch){.kind = BASELINES[k].scene, .x = x};
    }
    if (n > BASELINE_TMD)
        TRY(devices_find(p, n - BASELINE_TMD, found + BASELINE_TMD, err));
    for (size_t k = 0; k < n; k++)
        task[k] = (SimTask){.kind = BASELINES[k].scene,
                            .x = x,
                            .device = found[k].device,
                            .n_parts = tower_n_records(tower_of(p)),
                            .result = &out[k].first,
                            .summary = &sum[k]};
    TRY(tower_run(p, n, task, NULL, NULL, err));
    for (size_t k = 0; k < n; k++)
        summarise(&sum[k], &found[k].device, &out[k]);
    return STATUS_OK;
}
