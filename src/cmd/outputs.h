/* cmd/outputs.h -- the files that a command writes. None of them is one that it reads, by the command line or by the
 * settings, nor one that a run keeps (folder_keeps).
 *
 * Errors  STATUS_USAGE, with the option and the file */
#pragma once

#include "cmd/command.h"

/* Option i, from 0, that asked for standard output; NULL: no more. */
const char *outputs_standard(const Args *args, int i);

/* By the words of the command line: before anything is read. */
Status outputs_check(const Args *args, Err *err);

/* By the files that the settings name: before anything is simulated. */
Status outputs_spare(const Args *args, const Settings *s, Err *err);
