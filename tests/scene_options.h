/* tests/scene_options.h -- the options of a scene: the defaults, and those of the paper's study (configs/kobe.ini). */
#ifndef IMTET_TESTS_SCENE_OPTIONS_H
#define IMTET_TESTS_SCENE_OPTIONS_H

#include "settings/settings.h"

static inline SceneOptions scene_defaults(void)
{
    Settings s;
    settings_defaults(&s);
    return settings_scene(&s);
}

static inline void paper_defaults(Settings *s)
{
    settings_defaults(s);
    s->core.theory = CORE_EULER_BERNOULLI;
    s->motion.pga_g = 0.3;
    s->motion.stretch = 3.1;
}

static inline SceneOptions paper_scene(void)
{
    Settings s;
    paper_defaults(&s);
    return settings_scene(&s);
}

#endif
