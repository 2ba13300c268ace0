/* bench/paper.h -- the settings of the paper's study (configs/kobe.ini), on which engines are compared. */
#pragma once

#include "settings/settings.h"

static inline void paper_defaults(Settings *s)
{
    settings_defaults(s);
    s->core.theory = CORE_EULER_BERNOULLI;
    s->motion.pga_g = 0.3;
    s->motion.stretch = 3.1;
}
