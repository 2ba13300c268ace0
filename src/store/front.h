/* store/front.h -- the front of a run, read back from its folder, and the designs that stand out in it.
 *
 * It is taken from the run's database; from front.csv where there is none.
 *
 * Knee       the design nearest to the ideal point when every objective is scaled to 0..1 over the front (Euclid)
 * Ownership  front_read allocates, front_free releases (an empty Front is fine)
 * Values     natural signs, as in front.csv */
#ifndef IMTET_STORE_FRONT_H
#define IMTET_STORE_FRONT_H

#include "base/table.h"
#include "simulator/schema.h"

typedef struct Settings Settings;

typedef struct {
    Table table; /* id, variables, objectives */
    Schema schema;
    size_t n, n_obj;
    int n_var;
} Front;

Status front_read(Front *front, const char *folder, Err *err);
long front_id(const Front *front, size_t i);
const double *front_x(const Front *front, size_t i); /* (n_var) */
const double *front_f(const Front *front, size_t i); /* (n_obj) */

/* Each wants n > 0. Ties go to the first. */
size_t front_best(const Front *front, size_t objective);
size_t front_knee(const Front *front);

/* Best value and width of every objective (n_obj), minimised; a width of 0 counts as 1. */
void front_box(const Front *front, double ideal[], double span[]);

/* Row of that design, or n when it is not on the front. */
size_t front_find(const Front *front, long id);

/* Why a front is empty, and what to do; never STATUS_OK. STATUS_UNMET: nothing keeps search.limits. */
Status front_why_empty(const char *folder, Err *err);

/* `word`: an id of the front of `folder` or "knee". An empty front has neither: front_why_empty. */
Status front_pick(const Front *front, const char *folder, const char *word, size_t *row, Err *err);

/* What a run was made with: of its database, or of settings.ini where there is none (store/saved.c). */
Status run_settings(Settings *s, const char *folder, Err *err);
void front_free(Front *front);

#endif
