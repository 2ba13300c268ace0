/* tests/scene_options.h -- the options of a scene: the defaults, and those of the paper's study (configs/kobe.ini). */
#ifndef IMTET_TESTS_SCENE_OPTIONS_H
#define IMTET_TESTS_SCENE_OPTIONS_H

#include "bench/paper.h"

static inline SceneOptions scene_defaults(void)
{
    Settings s;
    settings_defaults(&s);
    return settings_scene(&s);
}

static inline SceneOptions paper_scene(void)
{
    Settings s;
    paper_defaults(&s);
    return settings_scene(&s);
}

#endif
