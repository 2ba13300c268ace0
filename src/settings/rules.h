/* settings/rules.h -- what several settings together must keep: a scaling of its own kind, bounds in order, walls that
 * fit into the box.
 *
 * Each rule that is broken is handed to `broken`: the fields that it ties (offsets in Settings; the one to change
 * first) and one sentence, "key: what is wrong".   Threads  no state. */
#ifndef IMTET_SETTINGS_RULES_H
#define IMTET_SETTINGS_RULES_H

#include "settings/options.h"

#include <stddef.h>

enum { RULE_FIELDS = 3 };

typedef void (*BrokenRuleFn)(const size_t fields[RULE_FIELDS], const char *text, void *user);

void rules_check(const Settings *s, BrokenRuleFn broken, void *user);

#endif
