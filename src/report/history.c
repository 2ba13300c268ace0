#include "report/history.h"

static const double QUIET = 0.02; /* of the peak displacement */

const char *const ENERGY_KEYS[N_ENERGIES] = {"kinetic",  "strain", "damped_building", "core", "damped_core",
                                             "contacts", "input"};

Status history_run(const Scenario *scenario, SceneKind kind, const double x[], Track *out, Err *err)
{
    Scene *scene;
    SceneOptions s = scenario->options;
    s.sim.engine = ENGINE_FAST; /* the others have no samples */
    TRY(scene_create(&scene, &s, &scenario->motion, err));
    const Status status = track_run(scene, kind, x, &(LinearDevice){0}, 0, out, err);
    scene_free(scene);
    out->n = out->outcome == RUN_OK ? out->n : 0;
    return status;
}

/* Records end long after the building has come to rest: both histories are cut where nothing is to be seen any more. */
Status histories_run(const Scenario *scenario, const double x[], int floor, Track out[2], Err *err)
{
    double most = 0;
    size_t n = 2;
    TRY(history_run(scenario, SCENE_IMPACT, x, out, err));
    TRY(history_run(scenario, SCENE_NO_CORE, x, &out[1], err));
    for (int i = 0; i < 2; i++)
        for (size_t k = 0; k < out[i].n; k++)
            most = fmax(most, fabs(track_at(&out[i], k, HISTORY_U + floor)));
    for (int i = 0; i < 2; i++)
        for (size_t k = n; k < out[i].n; k++)
            if (fabs(track_at(&out[i], k, HISTORY_U + floor)) > QUIET * most)
                n = k + 1;
    for (int i = 0; i < 2; i++)
        out[i].n = MIN_OF(out[i].n, n);
    return STATUS_OK;
}
