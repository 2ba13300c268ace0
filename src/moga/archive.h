/* moga/archive.h -- everything simulated, in order, and which of it is on the front.
 *
 *   row        one simulation; a design that is there already is answered once more, and that row is a repeat
 *   design     the row of its first simulation, which has the mean of all its answers (F, G, violation), the standard
 *              error of F (moga/spread.h; 0 until repeats tell of a spread), and an estimate: F, until a surface tells
 *              of something likelier (moga/surface.h)
 *   usable     a design all of whose simulations finished with finite numbers
 *   on_front   usable, every constraint holds, no design of the archive dominates it surely (moga/dominance.h)
 *
 * After an insertion without repeats everything is right; after one with repeats archive_settle makes it so.
 *
 * Life cycle  archive_init -> archive_insert (archive_settle) ... -> archive_free; grows by doubling, so pointers move
 * Threads     one writer. */
#ifndef IMTET_MOGA_ARCHIVE_H
#define IMTET_MOGA_ARCHIVE_H

#include <stddef.h>

#include "base/status.h"
#include "moga/spread.h"

typedef struct {
    size_t n, n_max, n_var, n_obj, n_con, n_front, n_failed, n_usable, n_repeats;
    double *X, *Y, *H;     /* (n, n_var) (n, n_obj) (n, n_con) design, objectives and constraints of each simulation */
    double *F, *G;         /* (n, n_obj) (n, n_con) of designs: means */
    double *estimate;      /* (n, n_obj) of designs: what the search takes them for */
    double *S;             /* (n, n_obj) of designs: sum of squared deviations from the mean */
    double *deviation;     /* (n, n_obj) of designs: standard deviation of a single answer, as far as repeats tell */
    double *error;         /* (n, n_obj) of designs: standard error of the mean */
    double *violation;     /* (n) of designs: sum of max(0, g) */
    size_t *answers;       /* (n) of designs: how many simulations; of repeats 0 */
    unsigned char *ok;     /* (n) the simulation finished */
    unsigned char *usable; /* (n) */
    unsigned char *kind;   /* (n) */
    unsigned char *on_front; /* (n) */
    size_t *generation;      /* (n) */
    size_t *front;           /* (n_front) their rows, ascending */
    size_t n_slots, *slot;   /* hash table of the designs */
    Spread *spread;          /* (n_obj) */
    int is_stale;
    void *store;
} Archive;

Status archive_init(Archive *a, size_t n_max, size_t n_var, size_t n_obj, size_t n_con, Err *err);
void archive_free(Archive *a);

/* Adds n rows; G may be NULL when n_con is 0. */
Status archive_insert(Archive *a, size_t n, const double X[], const double F[], const double G[],
                      const unsigned char ok[], unsigned char kind, size_t generation, Err *err);

/* After repeats: spread and errors from all of them, and the front anew. */
void archive_settle(Archive *a);

void archive_forget_estimates(Archive *a); /* they are the means again */

/* Row of exactly this design, or n if it was never simulated. */
size_t archive_find(const Archive *a, const double x[]);

#endif
