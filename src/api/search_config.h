/* api/search_config.h -- what the search reads from the settings.
 *
 * Threads  no state */
#pragma once

#include "moga/config.h"

typedef struct Settings Settings;

SearchConfig search_config_of(const Settings *s);
