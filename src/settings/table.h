/* settings/table.h -- the table of the settings, to those that fill it by its lines.
 *
 * Threads  no state */
#pragma once

#include "base/list.h"
#include "settings/options.h"

enum { TABLE_MAX = 256 }; /* lines at most */

/* The line of a key; errors: the nearest key. */
Status table_find(const char *key, int *i, Err *err);
int table_passes(const char *key, const char *value); /* no setting any more, but stored settings may have it */

/* A value as one would type it. */
Status table_assign(Settings *s, int i, const char *value, Err *err);

/* What a settings file means by the text behind a key's =, in `text`, which is changed, or in `plain`, which is empty:
 * without notes, blanks around it, and the quotes and brackets of TOML. */
const char *table_value(char *text, char plain[OPTION_TEXT_MAX]);

/* The files that line i reads, handed to `change` one by one. */
void table_change_files(Settings *s, int i, ListItemFn change, void *user);
