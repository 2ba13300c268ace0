/* cmd/show.h -- results as JSON, CSV and tables for people. */
#ifndef IMTET_CMD_SHOW_H
#define IMTET_CMD_SHOW_H

#include "base/json.h"
#include "analysis/baselines.h"
#include "evaluate/schema.h"

json_t *json_result(SceneKind kind, const SimResult *r);

/* Of every measure that has one. */
json_t *json_errors(const double error[]);

/* replicates, failed, mean {}, sd {} */
json_t *json_replicates(const ReplicateSummary *r);

/* On standard output, 17 digits; takes the reference. */
Status show_json(json_t *all, Err *err);

/* The ground motion: name, length (and how much of it was simulated; duration_s 0: all), peak, scaling; lines of what
 * was done to the samples and of what does not fit, where there is any. */
void show_motion(FILE *out, const Motion *m, double duration_s);

/* One line per simulation: label, objectives, impacts, outcome where it is not ok. error (N_MEASURES) or NULL: of a
 * value no digit is shown that it leaves open; a line of its own has those of the objectives. */
void show_result_names(const char *label, const MeasureOrder *order);
void show_result(const char *label, const MeasureOrder *order, const SimResult *r, const double error[]);
void show_result_errors(const MeasureOrder *order, const double error[]);

/* Lines of mean and standard deviation of the objectives; one line where a replicate failed. indent: blanks before. */
void show_replicates(int indent, const MeasureOrder *order, const ReplicateSummary *r);

/* Cells of a CSV row, each with a comma before it: records, replicates of each, rule, spread, then mean and standard
 * deviation of every measure. NULL: all empty. */
void write_replicates_names(FILE *out);
void write_replicates(FILE *out, const ReplicateSummary *r);

/* "against viscous links (...): impacts win in ...; lose in ..." by more than a thousandth. */
void show_verdict(BaselineKind kind, const Schema *schema, const double natural[], const Baseline *baseline);

/* A line of objectives for each; then in which objectives the natural values of a design with impacts win
 * against it, and in which they lose. */
void show_baselines(const Schema *schema, const double natural[], const Baseline baseline[N_BASELINES]);

/* One line: the hypervolume that as many simulations again are expected to gain (study/improvement.h); NAN: nothing. */
void show_expected_gain(double gain);

/* One line of objectives: label, a design's number (0: none), a dash for what is not known. error (n_obj) or NULL: of a
 * value no digit is shown that it leaves open. */
void show_objective_names(const Schema *schema);
void show_objectives(const char *label, long id, const Schema *schema, const double natural[], const double error[]);

/* The same of the further results (n_extra) that are limited. */
void show_limited_names(const Schema *schema);
void show_limited(const char *label, long id, const Schema *schema, const double extra[]);

/* error (n_obj), below the line of the objectives. */
void show_objective_errors(const Schema *schema, const double error[]);

#endif
