/* cmd/fragilities.h -- `imtet evaluate --fragility`: how probable it is, by intensity, that limits are exceeded, and
 * with a hazard curve how often, and what is lost in a year (analysis/fragility.h), of a design and of what stands
 * beside it.
 *
 * Life cycle  fragilities_read -> fragilities_table, _json, _draw ... -> fragilities_free (an empty one is fine) */
#pragma once

#include <jansson.h>

#include "analysis/evaluations.h"
#include "report/panels.h"

typedef struct Settings Settings;

typedef struct {
    Limits limits;
    const Schema *schema;
    size_t n_hazard;
    double *hazard; /* (n_hazard, 2) intensity [g], yearly rate of more; NULL: none */
} Fragilities;

/* list: limits as in search.limits, or NAME=NUMBER; "limits": the run's own. They become those of s, so that what they
 * need is simulated. hazard: a CSV file with columns `intensity` and rate_per_year, or NULL. Errors: STATUS_USAGE of
 * the list, STATUS_BAD_DATA of the file. */
Status fragilities_read(Fragilities *f, const Schema *schema, const char *list, const char *hazard,
                        const char *intensity, Settings *s, Err *err);

json_t *fragilities_table(const Fragilities *f, const Evaluations *e); /* rows for people */
json_t *fragilities_json(const Fragilities *f, const Evaluations *e);

/* Of every scene, where there is a hazard curve: rows, for people or for JSON. */
json_t *annual_losses(const Fragilities *f, const Evaluations *e, int for_people);

json_t *intensity_axis(const Evaluations *e);
Status fragilities_draw(const Fragilities *f, const Evaluations *e, const char *path, Err *err);
void fragilities_free(Fragilities *f);
