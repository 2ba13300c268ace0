/* moga/infill.h -- infill criteria: which predicted designs are worth an evaluation.
 *
 *   gain(c) = sum_w max(0, best_w - value(f_c, w))          over the reference vectors w
 *   value     INFILL_PBI          d1 + 5 d2: d1 along w from the ideal, d2 off it, in normalised objectives
 *             INFILL_HYPERVOLUME  minus the length that f dominates of the ray from behind the worst of the front along
 *                                 -w: the lengths of many rays add up to the hypervolume, whatever the front's shape
 *             with aspiration levels, in the place of both: max_k (f_k - level_k) / width_k / u_k, where every
 *             vector has a u of its own between 0.5 and 2
 *   best_w    smallest value of the front
 *   chance    where there is a front: a gain counts with the probability that the design succeeds and keeps every
 *             limit, as in Schonlau, Welch and Jones, IMS Lecture Notes 34 (1998) 11-25
 *
 * Designs are picked one after the other, the greatest gain first; what is picked lowers best_w, so that a batch
 * spreads over the vectors. Where no candidate has a gain the least certain one is picked, where none is feasible the
 * least violating.
 *
 * Life cycle  infill_create -> (infill_measure -> infill_offer -> infill_pick ...) ... -> free
 * Memory      all of it in infill_create
 * Threads     one Infill per thread
 * Sources     Zhang and Li, IEEE Trans. Evol. Comput. 11 (2007) 712-731 (PBI)
 *             Zhang and Golovin, Random hypervolume scalarizations for provable multi-objective black box optimization,
 *             ICML 2020 (rays)
 *             Wierzbicki, The use of reference objectives in multiobjective optimization, 1980 (levels) */
#pragma once

#include "moga/directions.h"

typedef struct Infill Infill;

typedef enum { INFILL_PBI, INFILL_HYPERVOLUME, INFILL_KINDS } InfillKind;

/* aspire (n_obj): levels, NAN where there is none, borrowed; NULL: of no objective. */
Status infill_create(Infill **out, InfillKind kind, size_t candidates_max, const Directions *vectors,
                     const double aspire[], Err *err);

/* Normalises by the rows front[0..n) of F and takes their values as best_w. */
void infill_measure(Infill *q, size_t n, const size_t front[], const double F[]);

/* Distance of f from the ideal, in widths of the front. */
double infill_length(const Infill *q, const double f[]);

/* min_w value(f, w) - best_w: 0 on the front, small near it. */
double infill_distance(Infill *q, const double f[]);

/* sum_w max(0, best_w - value(f, w)). */
double infill_gain(Infill *q, const double f[]);

/* Row of the front that is best for a vector; value of f for it, with its derivatives by f (n_obj). */
size_t infill_best(const Infill *q, size_t vector);
double infill_slope(const Infill *q, size_t vector, const double f[], double slope[]);

/* n predicted designs: F (n, n_obj), violation (n), predicted error (n), chance (n) or NULL: feasible designs come
 * first; borrowed until the last pick. */
void infill_offer(Infill *q, size_t n, const double F[], const double violation[], const double uncertainty[],
                  const double chance[]);

/* Best candidate c with allowed[c] set, which is then cleared; SIZE_MAX: there is none. */
size_t infill_pick(Infill *q, unsigned char allowed[]);

/* A candidate that another criterion picked, or that is pending: lowers best_w. */
void infill_take(Infill *q, size_t candidate);
