/* settings/options.h -- the options of all modules together: what a settings file says. How it is read, checked and written:
 * settings.h. A module takes its own options; who passes all of them on declares `typedef struct Settings Settings;`.
 *
 * Ownership  a plain value without pointers: copy it freely */
#ifndef IMTET_SETTINGS_OPTIONS_H
#define IMTET_SETTINGS_OPTIONS_H

#include "scene/options.h"
#include "sim/options.h"
#include "simulator/options.h"
#include "study/options.h"

typedef struct Settings {
    BuildingOptions building;
    CoreOptions core;
    ContactOptions contact;
    MotionOptions motion;
    SimOptions sim;
    UncertainOptions uncertain;
    DesignOptions design;
    ProblemOptions problem;
    SearchOptions search;
    RunOptions run;
    unsigned old_keys; /* bit i: the old key i of settings_renamed was read */
} Settings;

/* What a scene needs of them. */
static inline SceneOptions settings_scene(const Settings *s)
{
    return (SceneOptions){s->building, s->core, s->contact, s->sim, s->design};
}

#endif
