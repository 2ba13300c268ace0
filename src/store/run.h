/* store/run.h -- a run as its database has it: settings, every evaluation, the front, how it came about.
 *
 * Read once by a command (store/run_read.h) and handed on as const Run *. Rows: first those of the search, in the order
 * of their ids, as they were asked for; then the polished ones and those that are kept (kind_is_outside). An id is the
 * next one when its row is stored: those of the search are 1, 2, ... but for others between sessions. A simulation of a
 * generation that is under way, or was cut short, has kind KIND_UNFINISHED; it is on no front yet.
 *
 * Replicates  a design that was simulated again has in F the mean of its simulations, and sd is estimated from all
 *             repeats of the run (moga/noise.h); one with a simulation that failed keeps its first
 * Values      natural signs and units, as in front.csv; NAN where there is none (failed, or deviation not known)
 * Front       feasible, ok and nondominated, polished designs included; entered <= g < left are the generations of the
 *             search in which a design was on the search's own front. Where designs were simulated finer at the end
 *             of a study the front is formed again, of all that were ever on it
 * Scaled      an objective between its best (0) and its worst value (1) on the front, minimised
 * Knee        the design of the front nearest to the ideal point, all objectives scaled (Euclid)
 * Ownership   run_free releases all of it (an empty Run is fine)
 * Threads     no state: any number may read one Run */
#pragma once

#include <limits.h>

#include "evaluate/evaluation.h"
#include "evaluate/schema.h"

typedef struct Settings Settings;

enum { NEVER = -1 };

/* What is read of a run. HEAD: no rows: no table and no front, but the marks of it. FRONT: the rows that may be on the
 * front (with finer values all that ever were), that failed, and that are from outside the search; all of a run that is
 * noisy or has no front. Whatever is read, each row is checked and counted. */
typedef enum { RUN_HEAD, RUN_FRONT, RUN_WHOLE } RunParts;

/* Place of an evaluation on the front. */
typedef struct {
    int entered, left; /* NEVER */
    int ok, on_front;
} RunPlace;

typedef struct {
    long number, simulated, failed, front;
    double surrogate_error; /* NAN: no surrogate */
    double hypervolume;     /* share of a box about the first sample that the front dominates; results/README.md */
    double seconds;         /* of work on the run until then, all sessions together */
    char finished[24];      /* UTC */
    long members;           /* digest of the designs on the search's front (store/tables.h) */
} RunGeneration;

/* When a design was on the search's front. */
typedef struct {
    long id;
    int entered, left; /* NEVER: it still is */
} RunMark;

/* One start of `imtet optimize`. */
typedef struct {
    long number;
    char started[24], ended[24], host[72], stopped[128]; /* ended, stopped: empty while it runs or when it was killed */
    char program[128];
    long pid, threads, simulated_before;
    double seconds;                         /* that it lasted, as far as is stored */
    double search_s, waited_s, surrogate_s; /* of the search; of it waiting for simulations, at the surrogate; NAN */
    int is_final;                           /* there was nothing more to do */
} RunSession;

typedef struct Run {
    char folder[PATH_MAX];
    long id_step;     /* of several runs as one (study/merged.h), else 0 */
    char *provenance; /* JSON */
    Settings *settings;
    Schema schema;
    size_t n_front, n_failed, n_repeats, n_generations, n_sessions; /* also of rows that are not kept */
    double extra_min[EXTRA_MAX], extra_max[EXTRA_MAX]; /* of the further measures of all that succeeded, and 0 */
    size_t n_finished;     /* evaluations of the search whose generation is finished: the first rows of a whole run */
    EvaluationTable table; /* f: of this very evaluation; sd, replicates: of the design */
    EvaluationTable finer; /* designs as they are with more steps: the rows of `table` have these numbers, and err */
    double *F;             /* (table.n, n_obj) joined; without repeats table.f */
    RunPlace *place;       /* (table.n) */
    size_t *front;         /* (n_front) rows, ascending */
    size_t n_marks;
    RunMark *mark;             /* (n_marks) in the order of the ids; of a run whose rows are not read */
    RunGeneration *generation; /* (n_generations) */
    RunSession *session;       /* (n_sessions) */
    long planned_evals;
    long tried_to_polish; /* spread-out designs, at the end of a search of polished_at simulations */
    long polished_at;
    void *state; /* (n_state bytes) of the search at the end of the last generation; NULL: none is finished yet */
    size_t n_state;
    int state_is_damaged; /* neither copy of it is what was written */
} Run;

void run_free(Run *run);

const double *run_x(const Run *run, size_t row);           /* (n_var) */
const double *run_f(const Run *run, size_t row);           /* (n_obj) */
double run_result(const Run *run, size_t row, size_t k);   /* objective k, from n_obj on a further measure; NAN: none */
void run_minimise(const Run *run, size_t row, double f[]); /* the same, minimised */

/* Likely errors (n_obj) of the integration that are stored with the design; NAN where there is none. Returns whether
 * any is there. */
int run_likely(const Run *run, size_t row, double error[]);

/* Whether that is a standard deviation under gaps that are 1 um off: the design cannot be predicted. */
int run_is_unpredictable(const Run *run, size_t row);

/* The steps by which the run knows that design, where sim has the accuracy of its settings. */
void run_steps(const Run *run, size_t row, SimOptions *sim);

/* Row of that design, or run->table.n. */
size_t run_find(const Run *run, long id);

/* The front of the search joined by the polished designs, and `front`; the table, F and place are all that has to be
 * there. */
Status run_settle_front(Run *run, Err *err);

/* The front of the designs whose place is marked as on it: ok, feasible, and dominated by no other of them. */
Status run_form_front(Run *run, Err *err);

/* Evaluations, as search.max_evals counts them, of the rows from `first` on. A screened design counts its share of an
 * evaluation (one of sim.replicates, or records of race_first), a finished one the rest. In a generation that is not
 * finished, rows without spreads count as screened. */
size_t run_evaluations(const Run *run, size_t first);

size_t run_first_polished(const Run *run); /* its row: behind those of the search; none: run->table.n */

/* Beginning of the reason of a design that `imtet simplify` made; the id of its origin follows. */
static const char SIMPLIFIED_FROM[] = "simplified from ";
/* Rows: a design as the search found it, and the last that was made of it, one of which is `row`; 0: there are none. */
int run_simplified(const Run *run, size_t row, size_t pair[2]);

/* As if nothing had been polished: the front is that of the search. */
void run_drop_polished(Run *run);

/* -- the front: each wants n_front > 0; ties go to the first; results are rows of the run -------------------------- */

size_t run_best(const Run *run, size_t objective);

/* Best value and width of every objective (n_obj), minimised; a width of 0 counts as 1. */
typedef struct {
    double ideal[OBJECTIVES_MAX], span[OBJECTIVES_MAX];
} FrontBox;
FrontBox run_box(const Run *run);
double run_scaled(const Run *run, const FrontBox *box, size_t row, size_t objective);

/* Square of the scaled distance to another design; run->table.n: to the ideal point. */
double run_distance2(const Run *run, const FrontBox *box, size_t row, size_t other);
size_t run_knee(const Run *run);

/* At most n designs that are spread over the front, the knee first, then again and again the one farthest from those
 * chosen; polished ones are left out unless they are wanted. Returns how many. */
size_t run_spread_out(const Run *run, size_t n, int with_polished, size_t rows[]);

/* `word`: the id of any design that the run has, on its front or not, failed or not; "knee"; "best_NAME" of an
 * objective. An empty front has neither of the last two: run_why_empty. */
Status run_pick(const Run *run, const char *word, size_t *row, Err *err);

/* Rows with the least violation of search.limits, the least first, ties by number; none that is screened only. Returns
 * how many; 0: all of those failed. */
enum { NEAREST_MAX = 10 };
size_t run_nearest(const Run *run, size_t rows[NEAREST_MAX]);

int run_has_limits(const Run *run); /* search.limits, or constraint values of external workers */

/* Why a front is empty, and what to do; never STATUS_OK. STATUS_UNMET: nothing keeps search.limits. */
Status run_why_empty(const Run *run, Err *err);
