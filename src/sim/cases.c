#include "sim/cases.h"

#include <math.h>
#include <stdio.h>

const SceneCase SCENES[N_SCENES] = {
#define X(id, key, words, has) {key, words, has},
    SCENE_LIST(X)
#undef X
};

void case_design(SceneKind kind, const LinearDevice *device, double core_kg, int n, Design *d)
{
    d->mass_kg = kind == SCENE_TMD ? core_kg : 0;
    d->mass_hz = device->tmd_hz;
    d->mass_damping = device->tmd_damping;
    for (int j = 0; j < n; j++) {
        d->gap[0][j] = d->gap[1][j] = INFINITY;
        d->link[j] = kind == SCENE_LINKS ? device->link_ns_m : 0;
        d->friction[j] = 0;
    }
}

const char *case_device_number(SceneKind kind, const LinearDevice *device, int i, double *value)
{
    const struct {
        SceneKind kind;
        const char *name;
        double value;
    } all[] = {{SCENE_TMD, "tmd_hz", device->tmd_hz},
               {SCENE_TMD, "tmd_damping", device->tmd_damping},
               {SCENE_LINKS, "link_ns_m", device->link_ns_m}};
    for (size_t k = 0; k < N_OF(all); k++)
        if (all[k].kind == kind && i-- == 0) {
            *value = all[k].value;
            return all[k].name;
        }
    return NULL;
}

const char *case_device_text(SceneKind kind, const LinearDevice *d, char text[DEVICE_TEXT_MAX])
{
    text[0] = 0;
    if (kind == SCENE_TMD)
        snprintf(text, DEVICE_TEXT_MAX, "%.3g Hz, damping %.2g", d->tmd_hz, d->tmd_damping);
    if (kind == SCENE_LINKS)
        snprintf(text, DEVICE_TEXT_MAX, "%.3g MN s/m per floor", 1e-6 * d->link_ns_m);
    return text;
}

const char *case_text(SceneKind kind, const LinearDevice *device, char text[CASE_TEXT_MAX])
{
    char has[DEVICE_TEXT_MAX];
    case_device_text(kind, device, has);
    snprintf(text, CASE_TEXT_MAX, *has ? "%s (%s)" : "%s", SCENES[kind].words, has);
    return text;
}
