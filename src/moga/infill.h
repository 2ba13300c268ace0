/* moga/infill.h -- which predicted designs are worth a simulation.
 *
 *   gain(c) = sum_w max(0, least_w - value(f_c, w))
 *   value   INFILL_PBI    d1 + 5 d2: d1 along direction w from the ideal, d2 off it, in normalised objectives
 *           INFILL_RAYS   minus the length that f dominates of the ray from behind the worst of the front along -w:
 *                         the lengths of many rays add up to the hypervolume, whatever the front's shape
 *
 * least_w is the least value of the archive. Designs are picked one after the other, the greatest gain first; what is
 * picked lowers least_w, so that a batch spreads over the directions instead of crowding at one promising place. Where
 * nobody promises a gain, the least certain prediction is picked; where nobody is feasible, the least violating.
 *
 * Life cycle  infill_create -> (infill_measure -> infill_offer -> infill_pick ...) ... -> infill_free
 * Memory      all of it in infill_create
 * Threads     one Infill per thread
 * Sources     Zhang and Li, IEEE Trans. Evol. Comput. 11 (2007) 712-731 (PBI); Zhang and Golovin, Random hypervolume
 *             scalarizations for provable multi-objective black box optimization, ICML 2020 (rays). */
#ifndef IMTET_MOGA_INFILL_H
#define IMTET_MOGA_INFILL_H

#include "moga/directions.h"

typedef struct Infill Infill;

typedef enum { INFILL_PBI, INFILL_RAYS, INFILL_KINDS } InfillKind;

Status infill_create(Infill **out, InfillKind kind, size_t candidates_max, const Directions *directions, Err *err);
void infill_free(Infill *q); /* NULL is fine */

/* Normalises by the rows front[0..n) of F and takes their values as the ones to beat. */
void infill_measure(Infill *q, size_t n, const size_t front[], const double F[]);

/* Length of f, seen from the ideal, in widths of the front. */
double infill_length(const Infill *q, const double f[]);

/* How far f is from being the best of any direction, 0 for those that are: small is near the front. */
double infill_distance(Infill *q, const double f[]);

/* The direction's best row among those measured, its value to beat, and f's value with its derivatives by f (n_obj). */
size_t infill_best(const Infill *q, size_t direction);
double infill_slope(const Infill *q, size_t direction, const double f[], double slope[]);

/* By how much f lowers the values to beat, in the sum over the directions. */
double infill_gain(Infill *q, const double f[]);

/* n predicted designs: F (n, n_obj), violation (n), how uncertain each is (n); borrowed until the last pick. */
void infill_offer(Infill *q, size_t n, const double F[], const double violation[], const double uncertainty[]);

/* Best candidate c with allowed[c] set, which is then cleared; SIZE_MAX when there is none. */
size_t infill_pick(Infill *q, unsigned char allowed[]);

/* The candidate was picked by another Infill. */
void infill_take(Infill *q, size_t candidate);

#endif
