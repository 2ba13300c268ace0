/* cmd/full_model.h -- evaluate --full-model: designs on all degrees of freedom of the building, beside the reduced
 * model. */
#pragma once

#include "cmd/args.h"

/* s: of the command; run: that they are of, NULL: of none. */
Status show_full_model(const Args *args, Settings *s, const Run *run, Err *err);
