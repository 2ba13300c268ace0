/* cmd/show.h -- results as parts of documents (cmd/document.h): their rows, their paragraphs and their JSON. */
#pragma once

#include "analysis/baselines.h"
#include "analysis/evaluations.h"
#include "analysis/sensitivity.h"
#include "cmd/document.h"
#include "evaluate/schema.h"
#include "scene/summary.h"
#include "study/front_review.h"

/* ---- results ----------------------------------------------------------------------------------------------------- */

json_t *json_result(const MeasureOrder *order, SceneKind kind, const SimResult *r);

/* The numbers of the device that was found for the case; returns o. */
json_t *put_device(json_t *o, SceneKind kind, const LinearDevice *device);

/* A cell for every measure, and for the chances of `order` unless that is NULL, its name before `end`, and behind each
 * the one of `others` before `other`, unless that is NULL. Values NULL: empty ones. */
void put_measures(json_t *o, const MeasureOrder *order, const char *end, const double values[], const char *other,
                  const double others[]);

/* error: likely and bound of every measure that has one (analysis/estimate.h), likely (N_MEASURES) given;
 * estimated_error: the bound. */
void put_errors(json_t *o, const double likely[], const double sd[]);

/* replicates, failed, mean {}, sd {} */
json_t *json_replicates(const MeasureOrder *order, const ReplicateSummary *r);

/* Cells of a row: records, replicates of each, rule, spread, then mean and standard deviation of every measure. NULL:
 * all empty. */
void put_replicates(json_t *row, const MeasureOrder *order, const ReplicateSummary *r);

/* Incremental dynamic analysis: of every case without a device a table of its first objectives by intensity. */
enum { IDA_SHOWN = 3 };
void document_ida(Document *d, const Evaluations *e, const MeasureOrder *order);

/* Change of results for one step of each parameter; of gaps that never close, which change nothing, none. */
void document_slopes(Document *d, size_t n, const Sensitivity list[]);

/* The ground motion: name, length (and how much of it was simulated; duration_s 0: all), peak, scaling; lines of what
 * was done to the samples and of what does not fit, where there is any. */
void document_motion(Document *d, const Motion *m, double duration_s);

/* A simulation: label, objectives with their likely errors and standard deviations, of gaps 1 um off (N_MEASURES;
 * analysis/estimate.h), or NULL, impacts, and a note where it failed or left the contact law. Returns its row. */
json_t *figures_result(json_t *table, const char *label, const MeasureOrder *order, const SimResult *r,
                       const double error[], const double sd[]);

enum { NOTE_MAX = 200 };

/* A row of means and standard deviations of the objectives (standard errors, where every one of several records has one
 * replicate); without them where a replicate failed. error: likely ones of the integration (N_MEASURES), which every
 * replicate has; NULL: not known. */
void figures_replicates(json_t *table, const MeasureOrder *order, const ReplicateSummary *r, const double error[]);

/* A design: label, number (0: none), objectives with their likely errors and standard deviations (n_obj) or NULL, and
 * what is limited of the further results (n_extra) or NULL. Returns its row. */
json_t *figures_design(json_t *table, const char *label, long id, const Schema *schema, const double natural[],
                       const double error[], const double sd[], const double extra[]);

/* A row of every case that designs are compared with. */
void figures_baselines(json_t *table, const Schema *schema, const Baseline baseline[N_SCENES]);

/* Review of a front: designs beyond the contact law; by floor the designs whose gap is on a bound of the search; floors
 * whose gap closes in none of the designs that were simulated again, if there are any. */
json_t *json_review(const FrontReview *r);

/* Verdict on a design of a run of the tower (report/verdict.h), to be freed; NULL: why tells. used: the settings of the
 * run, its records where they are now; NULL: those of the run. */
char *stored_verdict(const Run *run, size_t row, const Settings *used, Err *why);
void document_verdict(Document *d, const Run *run, size_t row, const Settings *used); /* nothing without a tower */

/* ---- what is implausible but no fault ---------------------------------------------------------------------------- */

/* "warning: KEY: TEXT" on standard error; user is not read. */
void warn_on_stderr(const char *key, const char *text, void *user);

/* Warns of a record that counts twice. */
void warn_of_settings(const Settings *s, WarnFn warn, void *user);

/* Designs of --design: the first gap that does not close. */
void warn_of_designs(const Designs *d, const char *word, WarnFn warn, void *user);
