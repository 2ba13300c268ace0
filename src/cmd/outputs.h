/* cmd/outputs.h -- the files that a command writes: none is one that a run keeps (folder_keeps), nor one that the command
 * reads (output_close).
 *
 * Errors  STATUS_USAGE, with the option and the file */
#ifndef IMTET_CMD_OUTPUTS_H
#define IMTET_CMD_OUTPUTS_H

#include "cmd/command.h"

/* Option i, from 0, that asked for standard output; NULL: no more. */
const char *outputs_standard(const Args *args, int i);

/* Before anything is read. */
Status outputs_check(const Args *args, Err *err);

#endif
