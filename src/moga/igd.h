/* moga/igd.h -- how far a growing set is from a reference set, kept up to date: IGD+.
 *
 *   igd+ = mean over r in the reference of  min over a in the set of  |max(a - r, 0)|      normalised, minimised
 *
 * Every objective is divided by its range in the reference. Only what is worse than r counts: a set that dominates the
 * reference has 0, and a dominated member of the set changes nothing. Of a reference with more than IGD_REFERENCE_MAX
 * members so many are taken, evenly by their order.
 *
 * Life cycle  igd_create -> igd_add ... igd_value ... -> igd_free
 * Threads     one Igd per thread
 * Source      Ishibuchi, Masuda, Tanigaki and Nojima, Modified distance calculation in generational distance and
 *             inverted generational distance, EMO 2015 */
#ifndef IMTET_MOGA_IGD_H
#define IMTET_MOGA_IGD_H

#include <stddef.h>

#include "base/status.h"

enum { IGD_REFERENCE_MAX = 200 };

typedef struct Igd Igd;

/* Reference: rows[0..n) of F (., n_obj), copied; n > 0. */
Status igd_create(Igd **out, size_t n_obj, size_t n, const size_t rows[], const double F[], Err *err);
void igd_add(Igd *q, const double f[]);
double igd_value(const Igd *q); /* INFINITY: nothing was added */
void igd_free(Igd *q);          /* NULL is fine */

#endif
