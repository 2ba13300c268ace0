/* bench/textbook.h -- test problems whose front is known, for trying the search without a simulator.
 *
 *   DTLZ2  x in [0,1]^n; sum f^2 = (1 + g)^2 with g = sum over the last n - m + 1 variables of (x - 1/2)^2;
 *          the front is the positive part of the unit sphere
 *   WFG4   z_i in [0, 2 i]; 30 local optima per variable (shift s_multi(30, 10, 0.35)), weights equal, concave front:
 *          the positive part of the ellipsoid with half axes 2, 4, ..., 2 m; the first n_position variables say where
 *          on the front, the others how far from it
 *
 *   other kinds (evaluate/kinds.h): a whole number 0..10 stands for that many tenths of a variable's width; choice j of n
 *          words, counted from 0, for the share (j s mod n) / (n - 1) of it, s = 3 (4 where 3 divides n), so that
 *          neighbours among the words are none; log: 0.001 to 1, its logarithm evenly spread
 *
 * As a simulator  one part, the objectives f (n_obj), each times 1 + noise z, z standard normal from the stream (seed, id
 *                 of the request); one worker, since it takes no time
 * As a worker     build/release/textbook NAME VARIABLES OBJECTIVES [NOISE [SEED [KINDS]]] speaks JSON lines (docs/external.md)
 * Threads  pure functions
 * Sources  Deb, Thiele, Laumanns and Zitzler, CEC 2002, 825-830 (DTLZ2); Huband, Hingston, Barone and While, IEEE
 *          Trans. Evol. Comput. 10 (2006) 477-506 (WFG4). */
#pragma once

#include "evaluate/problem.h"

enum { TEXTBOOK_VAR_MAX = 256, TEXTBOOK_OBJ_MAX = 32 };

typedef struct {
    const char *name;
    int widening; /* variable j = 0.. goes to 2 (j + 1) instead of 1 */
    void (*evaluate)(size_t n_var, size_t n_obj, const double x[], double f[]);
} Textbook;

/* Problem i = 0, 1, ...; NULL behind the last. */
const Textbook *textbook(size_t i);

typedef struct {
    const char *name;
    long n_var, n_obj;
    double noise; /* [-] standard deviation of an objective, as a share of its value */
    uint32_t seed;
    const char *kinds; /* as problem.kinds */
} TextbookOptions;

/* Released by problem_close. */
Status textbook_open(Problem *p, const TextbookOptions *options, Err *err);

/* Of such a problem: the objectives without noise. */
void textbook_exact(const Problem *p, const double x[], double f[]);

/* n_obj <= n_var */
void textbook_dtlz2(size_t n_var, size_t n_obj, const double x[], double f[]);

/* n_position: a multiple of n_obj - 1 below n_var; n_var <= TEXTBOOK_VAR_MAX, n_obj <= TEXTBOOK_OBJ_MAX */
void textbook_wfg4(size_t n_var, size_t n_obj, size_t n_position, const double z[], double f[]);
