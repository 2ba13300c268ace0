/* settings/rules.h -- what several settings together must keep: a scaling of its own kind, bounds in order, walls that
 * fit into the box.
 *
 * Each rule that is broken is handed to `broken` as one sentence, "key: what is wrong", which names the keys that it
 * ties, the one to change first.   Threads  no state. */
#pragma once

#include "settings/options.h"

typedef void (*BrokenRuleFn)(const char *text, void *user);

void rules_check(const Settings *s, BrokenRuleFn broken, void *user);
