/* tests/scene_options.h -- the default options of a scene. */
#ifndef IMTET_TESTS_SCENE_OPTIONS_H
#define IMTET_TESTS_SCENE_OPTIONS_H

#include "settings/settings.h"

static inline SceneOptions scene_defaults(void)
{
    Settings s;
    settings_defaults(&s);
    return settings_scene(&s);
}

#endif
