/* cmd/show.h -- what commands print: tables of figures, results as their rows, and JSON.
 *
 *   table   a JSON array of rows; a row is an object, a column a key of it, in the order in which the rows bring them
 *   cell    text, a whole number, a number, or none (null, or left out)
 *   shown   aligned under the names on standard output or in HTML, numbers with four digits; as CSV and JSON with all
 *
 * Ownership  figures_print, _csv, _html and show_json take the reference; rows are borrowed from their table */
#pragma once

#include "analysis/baselines.h"
#include "analysis/evaluations.h"
#include "base/json.h"
#include "evaluate/schema.h"
#include "scene/design.h"
#include "scene/summary.h"
#include "study/front_review.h"

typedef struct Settings Settings;

json_t *figures_row(json_t *table); /* a further one */

/* As text with the digits that are known (base/figure.h). error: the likely one; sd: standard deviation; NAN: not
 * known. */
void figures_put(json_t *row, const char *column, double value, double error, double sd);

void figures_print(json_t *table);

/* An object on standard output, a line for every member that is neither empty nor rows; borrowed. */
void figures_list(int indent, json_t *o);
Status figures_csv(json_t *table, const char *path, Err *err);
void figures_html(FILE *out, json_t *table);
Status show_json(json_t *all, Err *err);

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

/* "median (16 % to 84 %)" of measure k at an intensity, times factor; of one record its value. */
void put_fractiles(json_t *row, const char *column, const Evaluations *e, size_t level, SceneKind c, int k,
                   double factor);

/* The ground motion: name, length (and how much of it was simulated; duration_s 0: all), peak, scaling; lines of what
 * was done to the samples and of what does not fit, where there is any. */
void show_motion(FILE *out, const Motion *m, double duration_s);

/* A simulation: label, objectives with their likely errors and standard deviations, of gaps 1 um off (N_MEASURES;
 * analysis/estimate.h), or NULL, impacts, and a note where it failed or left the contact law. Returns its row. */
json_t *figures_result(json_t *table, const char *label, const MeasureOrder *order, const SimResult *r,
                       const double error[], const double sd[]);

enum { NOTE_MAX = 200 };

/* Of a foundation that lifts (sim/result.h), in text; returns it. */
const char *uplift_words(const SimResult *r, char text[NOTE_MAX]);

/* A row of means and standard deviations of the objectives (standard errors, where every one of several records has one
 * replicate); without them where a replicate failed. error: likely ones of the integration (N_MEASURES), which every
 * replicate has; NULL: not known. */
void figures_replicates(json_t *table, const MeasureOrder *order, const ReplicateSummary *r, const double error[]);

/* A design: label, number (0: none), objectives with their likely errors and standard deviations (n_obj) or NULL, and
 * what is limited of the further results (n_extra) or NULL. Returns its row. */
json_t *figures_design(json_t *table, const char *label, long id, const Schema *schema, const double natural[],
                       const double error[], const double sd[], const double extra[]);

/* Of a front: designs beyond the contact law; by floor those whose gap is on a bound of the search; floors whose gap
 * closes in none of the designs that were simulated again, where some were. */
json_t *json_review(const FrontReview *r);

/* "against viscous links (...): with impacts better in ...; worse in ..." by more than a thousandth and than the likely
 * errors; of the design in that row. */
void show_verdicts(FILE *out, const Run *run, size_t row, const Baseline baseline[N_SCENES]);

/* One line: the hypervolume that as many simulations again are expected to gain (study/improvement.h); NAN: nothing. */
void show_expected_gain(double gain);

/* ---- what is implausible but no fault ---------------------------------------------------------------------------- */

/* "warning: KEY: TEXT" on standard error; user is not read. */
void warn_on_stderr(const char *key, const char *text, void *user);

/* Of a tower: a record that counts twice. */
void warn_of_settings(const Settings *s, WarnFn warn, void *user);

/* Designs of --design: the first gap that does not close. */
void warn_of_designs(const Designs *d, const char *word, WarnFn warn, void *user);
