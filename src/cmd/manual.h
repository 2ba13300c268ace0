/* cmd/manual.h -- what the program says about itself, all of it from the tables of commands, options, settings and exit
 * codes: nothing here is to be kept in step by hand.
 *
 * Threads  no state */
#pragma once

#include "cmd/args.h"

const Command *command_at(int i); /* NULL behind the last */
void usage_write(FILE *out);      /* `imtet --help` */

/* A page for man; NULL: imtet(1). */
void manual_write(const Command *command, FILE *out);

/* Finds the command of that name; else the message suggests the nearest. An old name is noted on standard error, and
 * `option` is the option that it stands for, or NULL. */
Status command_find(const char *word, const Command **found, const char **option, Err *err);
