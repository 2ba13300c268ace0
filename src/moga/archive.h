/* moga/archive.h -- everything simulated, in order, and which of it is on the front.
 *
 *   on_front   the simulation finished, every constraint holds, nobody in the archive dominates it
 *
 * The flags are right after every insertion. A row whose numbers are not finite counts as failed.
 *
 * Life cycle  archive_init -> archive_insert ... -> archive_free; grows by doubling, so pointers move
 * Threads     one writer. */
#ifndef IMTET_MOGA_ARCHIVE_H
#define IMTET_MOGA_ARCHIVE_H

#include <stddef.h>

#include "base/status.h"

typedef struct {
    size_t n, n_max, n_var, n_obj, n_con, n_front, n_failed;
    double *X, *F, *G;       /* (n, n_var) (n, n_obj) (n, n_con) */
    double *violation;       /* (n) sum of max(0, g) */
    unsigned char *ok;       /* (n) */
    unsigned char *kind;     /* (n) */
    unsigned char *on_front; /* (n) */
    size_t *generation;      /* (n) */
    size_t *front;           /* (n_front) their rows */
    size_t n_slots, *slot;   /* hash table of the designs */
    void *store;
} Archive;

Status archive_init(Archive *a, size_t n_max, size_t n_var, size_t n_obj, size_t n_con, Err *err);
void archive_free(Archive *a);

/* Adds n rows; G may be NULL when n_con is 0. */
Status archive_insert(Archive *a, size_t n, const double X[], const double F[], const double G[],
                      const unsigned char ok[], unsigned char kind, size_t generation, Err *err);

/* Row of exactly this design, or n if it was never simulated. */
size_t archive_find(const Archive *a, const double x[]);

#endif
