/* bench/search/methods.h -- the search of this program beside others, on the problems of families.h.
 *
 *   imtet    with its surrogate
 *   plain    without: NSGA-III (Deb and Jain 2014, moga/selection.h); simulated binary crossover, polynomial mutation
 *   rvea     the same with RVEA (Cheng, Jin, Olhofer and Sendhoff 2016)
 *   moead    MOEA/D with Tchebycheff values: moead.c
 *   krvea    RVEA on one interpolant per objective, five designs at a time: krvea.c
 *   parego   one interpolant of a scalarisation with random weights, expected improvement: parego.c
 *
 * Population, crossover and mutation are those of the settings for all. Infeasible and failed designs are worse than any
 * feasible one for each of them. */
#ifndef IMTET_BENCH_SEARCH_METHODS_H
#define IMTET_BENCH_SEARCH_METHODS_H

#include "bench/search/course.h"
#include "settings/options.h"

typedef struct {
    const char *name;
    /* Adds n evaluations of the problem to c. */
    Status (*run)(const Settings *s, const Problem *p, Course *c, Err *err);
} Method;

enum { METHOD_IMTET, METHOD_PLAIN, METHODS_BUILT_IN }; /* the others follow */

size_t method_count(void);
const Method *method(size_t i);

Status run_moead(const Settings *s, const Problem *p, Course *c, Err *err);
Status run_parego(const Settings *s, const Problem *p, Course *c, Err *err);
Status run_krvea(const Settings *s, const Problem *p, Course *c, Err *err);

#endif
