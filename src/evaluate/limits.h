/* evaluate/limits.h -- the user's limits (search.limits = j3_g<=5,drift_ratio<=0.02) as constraints on any result.
 *
 *   g = (value - limit) / |limit| for <=, the negative of it for >=; limit 0 counts as 1
 *
 * And the aspiration levels (search.aspire = j1_m 0.5,j3_g 3).
 *
 * Threads  limits_apply reads only
 * Errors   STATUS_BAD_DATA with the words that are wrong, or with two limits of which no number keeps both, or one
 *          that is given twice, or one that excludes what is better and has none on the other side */
#pragma once

#include "evaluate/schema.h"

enum { LIMITS_MAX = 32 };

typedef struct {
    size_t result;      /* an objective, or n_obj + a further measure */
    double sign, bound; /* sign (value - bound) <= 0 */
} Limit;

typedef struct {
    size_t n;
    Limit limit[LIMITS_MAX];
} Limits;

/* list: as in the settings, "none" for none. */
Status limits_read(Limits *l, const Schema *schema, const char *list, Err *err);

/* g (n) of an evaluation with so many objectives. */
void limits_apply(const Limits *l, size_t n_obj, const Evaluation *e, double g[]);

/* level (n_obj): of the minimised objectives; NAN: none of that one. *aspire: level, or NULL where the list is none. */
Status aspirations_read(const double **aspire, double level[], const Schema *schema, const char *list, Err *err);
