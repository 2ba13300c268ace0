/* store/export.h -- a run as CSV and as JSON; results/README.md explains the columns.
 *
 * The same bytes for the same evaluations: nothing here depends on the clock or on the number of threads. Failures of
 * the stream are seen by whoever closes it (store/output.h). */
#ifndef IMTET_STORE_EXPORT_H
#define IMTET_STORE_EXPORT_H

#include <stdio.h>

#include "store/run.h"

/* Of variables (n_var), objectives (n_obj, natural, means over repeats) and the further results that are limited (n_limited, of
 * its first simulation): the names, and a design's numbers; each behind a comma, without an end of the line. */
void export_names(FILE *f, const char *before, const Schema *schema);
void export_numbers(FILE *f, const Run *run, size_t row);

/* front.csv. A row: id and these; where the schema has them sd (n_obj) and replicates, empty where they are not known. */
void export_front_header(FILE *f, const Schema *schema);
void export_design(FILE *f, const Run *run, size_t row);
void export_design_as(FILE *f, const Schema *schema, const Evaluation *e, const double means[]); /* means (n_obj) */
void export_front(FILE *f, const Run *run);

/* evaluations.csv: rows of finished generations and polished designs, without the header. */
void export_evaluations_header(FILE *f, const Schema *schema);
void export_evaluations(FILE *f, const EvaluationTable *table);

/* The same of a run whose variables pass by; settings, columns, evaluations (unfinished ones too), front and generations as one
 * object of JSON. */
Status export_front_of(FILE *f, const char *folder, Err *err);
Status export_json_of(FILE *f, const char *folder, Err *err);

#endif
