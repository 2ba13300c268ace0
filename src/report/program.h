/* report/program.h -- another program, started without a shell, that draws or converts.
 *
 * Threads  no state */
#pragma once

#include "base/status.h"

/* words: as found on PATH, NULL behind the last. Standard input, output and error; out NULL: with the errors. Its exit
 * status; 128: ended by a signal; -1 with errno, or 127: it could not be started. */
int program_run(char *const words[], FILE *in, FILE *out, FILE *faults);
