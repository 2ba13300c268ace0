/* cmd/commands.h -- every subcommand, one file each. */
#ifndef IMTET_CMD_COMMANDS_H
#define IMTET_CMD_COMMANDS_H

#include "cmd/args.h"

extern const Command CMD_OPTIMIZE, CMD_SIMULATE, CMD_EVALUATE, CMD_EXPORT, CMD_MODES, CMD_SPECTRUM, CMD_CHECK,
    CMD_SETTINGS, CMD_PROBLEM;

#endif
