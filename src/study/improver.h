/* study/improver.h -- one design of a run made better or simpler by simulating others near it: what polishing
 * (study/polish.h) and simplifying (study/simplify.h) share.
 *
 *   loss(x)  = max_k (f_k(x) - f_k(start)) / slack_k    over the objectives that are kept, minimised; 1 is what may be
 *              lost; above 1 also where the run's limits are violated by more than may be
 *   value(x) = sum_k weight_k f_k(x) / scale_k          where loss(x) <= 1, else INFINITY; without any weight: loss(x)
 *
 * Start    the design is simulated again, with all its numbers: the first of the path. What it loses is counted from
 *          there
 * Asking   any number of designs at once, through the queue of the run's own simulator; the best is the one of least
 *          value that was seen, at first the start. A failed simulation never is
 * Stopping a step that gains no more than gain_min is idle, and the next one has half the size. A descent ends after
 *          idle_max idle steps in a row, when the steps are small, when `enough` is reached, or with its budget
 * Report   the path, errors of its designs by steps that are finer, and what all of it cost
 *
 * Units      objectives in those of the run's files: natural signs in the path, minimised in f; loss, value: none
 * Ownership  improve_design fills the caller's Improved; improved_free releases what it allocated, after a fault too
 * Threads    call it from one thread; simulations share the workers of the simulator, and no number depends on how many
 *            there are
 * Errors     STATUS_BAD_DATA: the design fails when it is simulated again; STATUS_STOPPED: go_on said so; a fault of
 *            the simulator */
#pragma once

#include "evaluate/adapter.h"
#include "store/run.h"

enum { PATH_MAX_DESIGNS = 6, PLATES_MAX = 64 };

typedef struct {
    double slack[OBJECTIVES_MAX]; /* share of its value that an objective may lose; < 0: one deviation; INFINITY: all */
    long replicates;              /* of a tower, other problems have 1; 0: those of the run */
    int (*go_on)(void *user);     /* asked before each simulation; NULL: yes */
    void *user;
    /* of polish */
    double weight[OBJECTIVES_MAX]; /* >= 0; 0: not to be improved */
    size_t max_evals;              /* simulations, those of all steps together */
    /* of simplify */
    int zones;                /* of floors that become alike; 0: none do */
    double gap_step;          /* [m] 0: gaps stay */
    size_t n_plates;          /* 0: walls stay */
    double plate[PLATES_MAX]; /* [m] ascending */
} ImproveConfig;

typedef struct {
    size_t n_evaluated, n_failed, n_simulated; /* designs, of them failed; simulations */
    double seconds;
} ImproveCost;

typedef struct {
    EvaluationTable designs;                        /* the path, the start first */
    double error[PATH_MAX_DESIGNS][OBJECTIVES_MAX]; /* of it: likely integration errors; NAN: not known */
    ImproveCost cost;
    /* of polish */
    double gain, gain_error; /* of the value, > 0 is better; error NAN: not known */
    double gain_finer;       /* at finer steps; NAN: there are none */
    int has_changed;         /* 0: nothing better was found, the end is the design itself */
    int keeps;               /* what was to be kept is */
    /* of simplify, for each design of the path */
    double loss[PATH_MAX_DESIGNS];
    size_t n_left[PATH_MAX_DESIGNS]; /* variables that stand for a device that may go */
} Improved;

/* What a method works on. */
typedef struct {
    const Run *run;
    size_t row;          /* of the run: the design itself */
    const double *start; /* (n_var) of it */
    const ImproveConfig *config;
    Improved *out;
    Adapter *adapter; /* the simulator that is open */
    Queue *queue;
    const Problem *problem;
    long replicates;                                     /* of it */
    double first[OBJECTIVES_MAX], slack[OBJECTIVES_MAX]; /* minimised; what each may lose, INFINITY: all */
    double violation;                                    /* ... of the limits, that is allowed */
    double weight[OBJECTIVES_MAX], scale[OBJECTIVES_MAX];
    double *x, value, enough; /* (n_var) the best so far */
    double gain_min;
    int idle_max;
    size_t budget;     /* designs that a descent may still ask for */
    double *X, *F, *G; /* (n, n_var) (n, n_obj) (n, n_con) of a round; room for 2 n_var, PATH_MAX_DESIGNS at least */
    unsigned char *ok; /* (n) */
    size_t n;
    double *u, *at; /* (n_var) the method's own */
    void *store;
} Improver;

typedef Status (*ImproveMethod)(Improver *m, Err *err);
typedef Status (*ImproveStep)(Improver *m, double size, Err *err);

/* The design in row `row` of the run, with the settings that it was made with. */
Status improve_design(const Run *run, size_t row, const ImproveConfig *config, ImproveMethod method, Improved *out,
                      Err *err);
void improved_free(Improved *r);

/* -- for methods --------------------------------------------------------------------------------------------------- */

/* The simulator of the run with other options; an open one is closed. */
Status improver_open(Improver *m, const SimOptions *sim, Err *err);
Status improver_reserve(Improver *m, Err *err); /* the arrays, for free(m->store) */

/* Designs with all their numbers, side by side, as the next ones of the path. repeat: as in Asked. */
Status improver_note(Improver *m, size_t n, const double *const x[], size_t repeat, Err *err);
Status improver_check(const Improver *m, Err *err);          /* STATUS_BAD_DATA: the last one failed */
double improver_path(const Improver *m, size_t i, size_t k); /* objective k of design i of it, minimised */

/* Whether that engine of a tower has finer steps: twice as many for a contact. */
int improver_finer(const Settings *s, SimOptions *finer);

/* The path from design `from` on once more, by those options; what changes is the error. F has the objectives, ok. */
Status improver_errors(Improver *m, size_t from, const SimOptions *finer, size_t repeat, Err *err);

double improver_loss(const Improver *m, const double f[], double violation);
double improver_sum(const Improver *m, const double f[]); /* the weighted one */

/* The n designs of X side by side; the one of least value becomes the best, where it is better. */
Status improver_try(Improver *m, Err *err);
Status improver_descend(Improver *m, ImproveStep step, Err *err);
