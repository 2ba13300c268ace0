/* cmd/sensitivities.h -- simulate --sensitivity: a table of slopes with their errors. */
#ifndef IMTET_CMD_SENSITIVITIES_H
#define IMTET_CMD_SENSITIVITIES_H

#include "cmd/args.h"

/* Of the first design of --design; as a table, as --json, as --csv. */
Status show_sensitivities(const Args *args, const Settings *s, size_t n_replicates, Err *err);

#endif
