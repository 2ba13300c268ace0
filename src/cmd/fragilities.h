/* cmd/fragilities.h -- `imtet evaluate --fragility`: how probable it is, by intensity, that limits are exceeded, and
 * with a hazard curve how often, and what is lost in a year (analysis/fragility.h), of a design and of what stands
 * beside it.
 *
 * Life cycle  fragilities_read or counts_read -> document_fragilities -> fragilities_free (an empty one is fine) */
#pragma once

#include "analysis/evaluations.h"
#include "cmd/document.h"

typedef struct Settings Settings;

typedef struct {
    Limits limits;
    const Schema *schema;
    size_t n_hazard;
    double *hazard;      /* (n_hazard, 2) intensity [g], yearly rate of more; NULL: none */
    const char *counted; /* the file that counts come from; NULL: none do */
    char intensity[TABLE_NAME_MAX];
    size_t n_levels, n_at[IDA_LEVELS_MAX], exceeded[IDA_LEVELS_MAX];
    double *level; /* (n_levels) */
} Fragilities;

/* list: limits as in search.limits, or NAME=NUMBER; "limits": the run's own. They become those of s, so that what they
 * need is simulated. hazard: a CSV file with columns `intensity` and rate_per_year, or NULL. Errors: STATUS_USAGE of
 * the list, STATUS_BAD_DATA of the file. */
Status fragilities_read(Fragilities *f, const Schema *schema, const char *list, const char *hazard,
                        const char *intensity, Settings *s, Err *err);

/* Counts of others: a CSV file with columns exceeded, of, and an intensity. STATUS_BAD_DATA of it and of hazard. */
Status counts_read(Fragilities *f, const char *path, const char *hazard, Err *err);

/* Their tables, and fragility and annual_loss of the data; with a hazard curve also what is lost in a year. */
void document_fragilities(Document *d, const Fragilities *f, const Evaluations *e);

void fragilities_free(Fragilities *f);
