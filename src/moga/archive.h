/* moga/archive.h -- all evaluations in their order, and which designs are on the front.
 *
 *   row       one evaluation; of a design that is in the archive already it is a further replicate
 *   design    the row of its first evaluation, which has the mean of all its replicates (F, G, violation), the standard
 *             error of F (moga/noise.h; 0 without replicates)
 *   screened  a design of which only the cheap level is known (KIND_SCREENED): never on the front; F is what the whole
 *             evaluation is predicted to be (moga/screening.h). Evaluated in full, its new row is the design,
 *             and the row before is none any more (replicates 0)
 *   usable    a design all of whose evaluations succeeded with finite numbers
 *   on_front  usable, every constraint holds, no design of the archive dominates it surely (base/dominance.h)
 *
 * Up to date after each insertion without replicates; after one with replicates pareto_archive_update_noise is due.
 *
 * A new design is compared with few others (moga/nd_tree.h); with all of the front once there are replicates, whose
 * standard errors change what dominates what.
 *
 * Life cycle  pareto_archive_init -> pareto_archive_insert (pareto_archive_update_noise) ... -> pareto_archive_free
 * Memory      without replicates F and G are Y and H, and S, sd and error are NULL. Grows by doubling,
 *             of many rows by a quarter: pointers move
 * Threads     one writer */
#pragma once

#include "evaluate/evaluation.h"
#include "moga/nd_tree.h"
#include "moga/noise.h"

typedef struct {
    size_t n, n_max, n_var, n_obj, n_con, n_front, n_failed, n_usable;
    size_t n_replicates; /* rows that are further replicates */

    double *X, *Y, *H;        /* (n, n_var) (n, n_obj) (n, n_con) design, objectives and constraints of each row */
    unsigned char *ok, *kind; /* (n) it succeeded; EvaluationKind */
    size_t *generation;       /* (n) */

    size_t *replicates;      /* (n) of designs: how many; of further replicates 0. The rest is of designs: */
    unsigned char *usable;   /* (n) */
    unsigned char *on_front; /* (n) */
    double *F, *G;           /* (n, n_obj) (n, n_con) means */
    double *violation;       /* (n) sum of max(0, g) */
    int has_means;           /* there were replicates: the next three are not NULL */
    double *S;               /* (n, n_obj) sum of squared deviations from the mean */
    double *sd;              /* (n, n_obj) standard deviation of one replicate */
    double *error;           /* (n, n_obj) standard error of the mean */

    struct {
        size_t *row;
        double *value;
        unsigned char *mark;
    } scratch; /* (n_max) each, for one look at all rows: it is lost where the archive grows, as are the next two */
    size_t *expected;         /* rows of the front of results and predictions (moga/screening.h) */
    unsigned char *is_chosen; /* (n) screened designs that are finished in this generation */

    size_t *front;   /* (n_front) rows of the front, ascending, since pareto_archive_list_front */
    size_t n_listed; /* rows of `front` until then: those that have left are among them */
    NdTree *tree;    /* of the front, while there are no replicates */
    size_t n_slots;
    uint32_t *slot;    /* (n_slots) hash table of the designs */
    NoiseModel *noise; /* (n_obj) */
    int is_stale;      /* pareto_archive_update_noise is due */
    void *store;
} Archive;

Status pareto_archive_init(Archive *a, size_t n_max, size_t n_var, size_t n_obj, size_t n_con, Err *err);
void pareto_archive_free(Archive *a);

/* Adds a row; g is not read where n_con is 0. */
Status pareto_archive_insert(Archive *a, const double x[], const double f[], const double g[], int ok,
                             EvaluationKind kind, size_t generation, Err *err);

/* The design is not used any more. */
void pareto_archive_drop(Archive *a, size_t row);

/* After replicates: noise models, standard errors and the front. */
void pareto_archive_update_noise(Archive *a);

/* Rows that have left the front leave its list. */
void pareto_archive_list_front(Archive *a);

/* Row of exactly this design, or n where it has not been evaluated. */
size_t pareto_archive_find(const Archive *a, const double x[]);
