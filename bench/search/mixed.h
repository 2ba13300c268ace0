/* bench/search/mixed.h -- engineering problems of the literature with whole numbers and choices, of two objectives.
 *
 *   beam2      welded beam: weld on two or four sides, of four materials, thicknesses in sixteenths of an inch; cost and
 *              deflection (Deb and Goyal 1996; here the polar moment is that of four line welds)
 *   reducer2   speed reducer with whole teeth: volume and stress of a shaft (Golinski 1970)
 *   vessel2    pressure vessel of plates in sixteenths of an inch: cost and volume (Kannan and Kramer 1994)
 *
 * Units    inch, pound, as published
 * Threads  pure functions */
#ifndef IMTET_BENCH_SEARCH_MIXED_H
#define IMTET_BENCH_SEARCH_MIXED_H

#include "evaluate/problem.h"

enum { MIXED_VAR_MAX = 7, MIXED_CON_MAX = 11 };

typedef struct {
    void (*evaluate)(const double x[], double f[2], double g[]);
    VariableKind kind[MIXED_VAR_MAX];
    double lower[MIXED_VAR_MAX], upper[MIXED_VAR_MAX];
} Mixed;

extern const Mixed MIXED_BEAM, MIXED_REDUCER, MIXED_VESSEL;

#endif
