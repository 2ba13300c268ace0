/* cmd/commands.h -- every subcommand, one file each, in the order of `imtet --help`. */
#pragma once

#include "cmd/args.h"

#define COMMAND_LIST(X)                                                                                                \
    X(OPTIMIZE)                                                                                                        \
    X(SIMULATE)                                                                                                        \
    X(EVALUATE)                                                                                                        \
    X(EXPORT)                                                                                                          \
    X(STATUS)                                                                                                          \
    X(CHOOSE)                                                                                                          \
    X(POLISH)                                                                                                          \
    X(SIMPLIFY)                                                                                                        \
    X(REPORT)                                                                                                          \
    X(SERVE)                                                                                                           \
    X(BUILDING)                                                                                                        \
    X(SPECTRUM)                                                                                                        \
    X(CHECK)                                                                                                           \
    X(NEW)                                                                                                             \
    X(SETTINGS)

#define X(name) extern const Command CMD_##name;
COMMAND_LIST(X)
#undef X
