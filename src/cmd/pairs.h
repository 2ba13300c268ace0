/* cmd/pairs.h -- what the command line says of results, NAME=NUMBER, and lists of it that name objectives. */
#ifndef IMTET_CMD_PAIRS_H
#define IMTET_CMD_PAIRS_H

#include "evaluate/schema.h"

/* "NAME=NUMBER" of any result: *k counts on behind n_obj. */
Status pair_take(const Schema *schema, const char *option, const char *text, size_t *k, double *value, Err *err);

/* Into values (n_obj); those that are not named are left as they are. "NAME" alone is NAME=otherwise, and refused where
 * that is NAN. */
Status pairs_take(const Schema *schema, const char *option, const char *list, double otherwise, double values[],
                  Err *err);

/* None negative, and not all of them 0. */
Status weights_check(const Schema *schema, const char *option, const double weights[], Err *err);

#endif
