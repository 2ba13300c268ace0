/* analysis/evaluations.h -- one design under many ground motions, at one or several intensities each.
 *
 *   record r, intensity l: every case (sim/cases.h) that evaluated_has, in run[r n_levels + l].result
 *
 * Life cycle  evaluations_add, evaluations_add_suite ... -> evaluations_read -> evaluations_run -> evaluations_free
 * Threads     tasks of a queue (evaluate/queue.h), threads as search.threads says or ranks of a cluster; the results
 *             do not depend on their number
 * Errors      a record that cannot be read: status and why of it, where it came from a folder; else that of
 *             evaluations_read
 * Fractiles   fractile p of the n records at one intensity: straight lines between the order statistics, the i-th at
 *             p = (i - 1) / (n - 1); a simulation that failed counts as infinite, so that a fractile above it has no
 *             value
 * Source      Vamvatsikos and Cornell, Earthquake Eng. Struct. Dyn. 31 (2002) 491-514; Hyndman and Fan, Am.
 *             Statistician 50 (1996) 361-365, type 7 */
#pragma once

#include "analysis/fragility.h"
#include "evaluate/limits.h"
#include "evaluate/tower.h"

typedef struct {
    char *path;
    int from_folder; /* where it cannot be read it is left out with the reason */
    Status readable;
    Err why;
} EvaluatedRecord;

typedef struct {
    const EvaluatedRecord *record;
    double pga_g, scale, stretch;
    SimResult result[N_SCENES];
    LinearDevice device[N_SCENES];            /* found under this record (evaluate/device.h) */
    ReplicateSummary replicates;              /* of the design, where there are some */
    Measured finer;                           /* the design with twice the steps, of records of a folder */
    double error[N_MEASURES], sd[N_MEASURES]; /* of the design (analysis/estimate.h), where error_known */
    int error_known;                          /* at one intensity, by the engine fast; sd of records that were named */
} EvaluatedRun;

typedef struct {
    size_t n_records, n_levels;
    EvaluatedRecord *record; /* (n_records) */
    const double *level;     /* [g] (n_levels) that the records are scaled to; NULL: as the settings say, once */
    const char *intensity;   /* what the levels are: pga_g or sa_g, of [motion] */
    int has_links;           /* viscous links at every level too: the median over the records of those that are found
                                at the middle level */
    EvaluatedRun *run;       /* (n_records, n_levels) of those that can be read, zeroed for the others */
    size_t n_read;
    long replicates; /* of the design under each record; 0: itself alone */
    int is_estimated;
    double duration_s; /* that is simulated of each, 0: all */
    Problem tower;     /* a scene for every run */
} Evaluations;

/* Cases without a device have been simulated everywhere, others under records that were named, at one intensity. */
int evaluated_has(const Evaluations *e, const EvaluatedRun *run, SceneKind which);

Status evaluations_add(Evaluations *e, const char *path, int from_folder, Err *err);

/* Every record of it (motion/suite.h). */
Status evaluations_add_suite(Evaluations *e, const char *suite, Err *err);

/* Reads every record before anything is simulated. */
Status evaluations_read(Evaluations *e, const Settings *s, Err *err);

/* x (n_var) of the design. tell: as in tower_run, of n_all tasks. */
typedef struct {
    SimTell *tell;
    void *user;
    size_t n_all;
} EvaluationsTold;
Status evaluations_run(Evaluations *e, size_t n_var, const double x[], EvaluationsTold *told, Err *err);
void evaluations_free(Evaluations *e);

const char *evaluated_name(const EvaluatedRecord *r); /* the last part of its path */

/* -- incremental dynamic analysis ---------------------------------------------------------------------------------- */

enum { IDA_LEVELS_MAX = 1000 };

/* "0.05:0.05:0.6", from, step and to [g], as levels (IDA_LEVELS_MAX at most); a range ends at `to` or just below.
 * option: who gave it. */
Status ida_levels(const char *option, const char *text, double levels[IDA_LEVELS_MAX], size_t *n, Err *err);

/* Measure k of a run; INFINITY: it failed. */
double ida_value(const EvaluatedRun *run, SceneKind which, int k);

enum { IDA_FRACTILES = 3 }; /* that are shown */
static const double IDA_FRACTILE[IDA_FRACTILES] = {0.16, 0.5, 0.84};

/* Of measure k over the records at intensity l; INFINITY: too many failed. */
double ida_fractile(const Evaluations *e, size_t l, SceneKind which, int k, double p);

/* Of measure k beyond the limit: the curve, and n_at and exceeded (n_levels) of which it is. A simulation that failed
 * has exceeded it, one that does not have k is left out. */
Fragility ida_fragility(const Evaluations *e, SceneKind which, int k, const Limit *limit, size_t n_at[],
                        size_t exceeded[]);

/* Mean over the records, in which it is linear; a simulation that failed has lost the whole building. */
AnnualLoss ida_annual_loss(const Evaluations *e, SceneKind which, size_t n_hazard, const double hazard[]);
