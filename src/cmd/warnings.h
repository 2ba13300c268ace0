/* cmd/warnings.h -- what is implausible but no fault: one line each on standard error, or what `warn` does with it.
 *
 * Threads  no state */
#ifndef IMTET_CMD_WARNINGS_H
#define IMTET_CMD_WARNINGS_H

#include "scene/design.h"
#include "scene/summary.h"

typedef struct Settings Settings;

/* "warning: KEY: TEXT"; user is not read. */
void warn_on_stderr(const char *key, const char *text, void *user);

/* Of a tower: a record that counts twice. */
void warn_of_settings(const Settings *s, WarnFn warn, void *user);

/* Designs of --design: the first gap that does not close. */
void warn_of_designs(const Designs *d, const char *word, WarnFn warn, void *user);

#endif
