/* settings/idle.h -- settings that have no effect beside the others: core.width_m of a box, sim.quantile of a mean.
 *
 *   for (i = 0; (key = settings_key(i)); i++)
 *       if ((waits_for = settings_idle(&s, key)))
 *           "KEY has no effect; it is read where WAITS_FOR"
 *
 * What a file holds is not looked at, but whether a building is matrices, storeys or a frame.
 * Threads  no state. */
#ifndef IMTET_SETTINGS_IDLE_H
#define IMTET_SETTINGS_IDLE_H

#include "settings/settings.h"

/* Where the setting would be read; NULL: it is read. */
const char *settings_idle(const Settings *s, const char *key);

/* Does a blank-separated list of patterns hold the key? A pattern is a key, a section ("core") or a beginning
 * ("core.area_*"). */
int settings_match(const char *patterns, const char *key);

/* Calls `idle` for every setting that is not at its default and has no effect. */
typedef void (*IdleSettingFn)(const char *key, const char *waits_for, void *user);
void settings_idle_each(const Settings *s, IdleSettingFn idle, void *user);

#endif
