#include "analysis/horizon.h"

#include "sim/samples.h"

Status horizon_find(const Scenario *scenario, const double x[], double change, Horizon *out, Err *err)
{
    const DesignSpace *design = scene_design(scenario->scene);
    double changed[DESIGN_VARIABLES_MAX], largest = 0;
    Track one = {0}, other = {0};
    for (int j = 0; j < design->n_var; j++)
        changed[j] = x[j] * (j < design->n_gaps ? 1 + change : 1);
    Status status = track_modes(scenario->scene, x, &one, err);
    THEN(status, track_modes(scenario->scene, changed, &other, err));
    *out = (Horizon){.reached_s = {NAN, NAN, NAN, NAN}};
    for (size_t k = 0; k < one.n && k < other.n && status == STATUS_OK; k++) {
        double apart = 0, whole = 0;
        for (size_t i = 1; i < one.width && i < other.width; i++) {
            const double a = track_at(&one, k, i), b = track_at(&other, k, i);
            apart += (a - b) * (a - b);
            whole += a * a;
        }
        largest = fmax(largest, whole);
        out->end_s = track_at(&one, k, 0);
        out->distance_at_end = largest > 0 ? sqrt(apart / largest) : 0;
        for (int level = 0; level < HORIZON_LEVELS; level++)
            if (isnan(out->reached_s[level]) && out->distance_at_end > HORIZON_LEVEL[level])
                out->reached_s[level] = out->end_s;
    }
    track_free(&one);
    track_free(&other);
    return status;
}
