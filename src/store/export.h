/* store/export.h -- designs of a run as CSV and as JSON; results/README.md explains the columns.
 *
 * One writer: a table is a list of parts, of which each knows its column heads and its cells. The same bytes for the
 * same evaluations: nothing here depends on the clock or on the number of threads, which share many rows. Failures of
 * the stream are seen by whoever closes it (store/output.h).
 *
 * Errors  STATUS_NO_MEMORY */
#pragma once

#include "store/run.h"

/* FRONT    id, variables, objectives (natural, means over repeats), further results that are limited; where designs are
 *          several simulations sd of the objectives and replicates
 * ALL      id, generation, kind, outcome, reason, variables, objectives of this very evaluation, all further results
 * NEAREST  id, violation, variables, objectives, limited results
 * PAGE     id, variables, objectives, limited results, without column heads */
typedef enum { EXPORT_FRONT, EXPORT_ALL, EXPORT_NEAREST, EXPORT_PAGE } ExportTable;

/* Those rows of the run, NULL: its first n. */
Status export_designs(FILE *f, const Run *run, ExportTable table, size_t n, const size_t rows[], Err *err);

/* Settings, columns, evaluations, unfinished ones too, and generations as one object. */
Status export_json(FILE *f, const Run *run, Err *err);

/* front.csv or nearest.csv in the run's folder; with n = 0 the latter is removed: a run that was resumed may have a
 * front now. */
Status export_inside(const Run *run, ExportTable table, size_t n, const size_t rows[], Err *err);
