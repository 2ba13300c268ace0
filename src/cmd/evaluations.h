/* cmd/evaluations.h -- one design under many ground motions, at one or several intensities each.
 *
 *   record r, intensity l: every case of EVALUATION_CASES, in run[r n_levels + l].result
 *
 * Life cycle  evaluations_add, evaluations_add_folder ... -> evaluations_read -> evaluations_run -> evaluations_free
 * Threads     evaluations_run has the workers of a queue (evaluate/queue.h), threads as search.threads says or ranks of a
 *             cluster; the results do not depend on their number
 * Errors      a record that cannot be read: status and why of it, where it came from a folder; else that of
 *             evaluations_read */
#ifndef IMTET_CMD_EVALUATIONS_H
#define IMTET_CMD_EVALUATIONS_H

#include <stdio.h>

#include "evaluate/problem.h"
#include "evaluate/replicates.h"

typedef struct Settings Settings;

typedef enum {
    EVALUATED_DESIGN,
    EVALUATED_RIGID,
    EVALUATED_NO_CORE,
    N_EVALUATED, /* everywhere */
    EVALUATED_TMD = N_EVALUATED,
    EVALUATED_LINKS,
    N_WITH_DEVICES /* of records that were named, at one intensity */
} EvaluatedCase;

extern const struct EvaluationCase {
    SceneKind kind;
    const char *word, *key; /* for people; in JSON and CSV */
} EVALUATION_CASES[N_WITH_DEVICES];

typedef struct {
    char *path;
    int from_folder; /* where it cannot be read it is left out with the reason */
    Status readable;
    Err why;
} EvaluatedRecord;

enum { MOTION_TEXT_MAX = 1024 };

typedef struct {
    const EvaluatedRecord *record;
    char motion[MOTION_TEXT_MAX]; /* for people: name, length, peak, scaling */
    double pga_g, scale, stretch;
    SimResult result[N_WITH_DEVICES];
    LinearDevice device[N_WITH_DEVICES]; /* optimized under this record (analysis/baselines.h) */
    ReplicateSummary replicates;         /* of the design, where there are some; its words stand in the next line */
    char words[2][40];
    double error[N_MEASURES]; /* of the design, estimated (analysis/estimate.h), where error_known */
    int error_known;          /* of records that were named, at one intensity, by the engine fast */
} EvaluatedRun;

typedef struct {
    size_t n_records, n_levels;
    EvaluatedRecord *record; /* (n_records) */
    const double *level;     /* [g] (n_levels) peaks that the records are scaled to; NULL: as the settings say, once */
    EvaluatedRun *run;       /* (n_records, n_levels) of those that can be read, zeroed for the others */
    size_t n_read;
    long replicates; /* of the design under each record; 0: itself alone */
} Evaluations;

/* Cases of a run: N_EVALUATED, or N_WITH_DEVICES. */
int evaluated_cases(const Evaluations *e, const EvaluatedRun *run);

Status evaluations_add(Evaluations *e, const char *path, int from_folder, Err *err);

/* Every file of it, sorted by name; folders inside and hidden files are left out. */
Status evaluations_add_folder(Evaluations *e, const char *folder, Err *err);

/* Tries every record before anything is simulated. */
Status evaluations_read(Evaluations *e, const Settings *s, Err *err);

/* x (n_var) of the design; a line of progress on `progress`, NULL: none. */
Status evaluations_run(Evaluations *e, const Settings *s, size_t n_var, const double x[], FILE *progress, Err *err);
void evaluations_free(Evaluations *e);

/* The problem whose tasks are those runs, by its recipe, on another rank (evaluate/cluster.h). */
Status evaluations_open(Problem *p, const void *recipe, size_t size, Err *err);

const char *evaluated_name(const EvaluatedRecord *r); /* the last part of its path */

#endif
