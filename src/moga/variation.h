/* moga/variation.h -- new designs from old ones, and from nothing.
 *
 *   simulated binary crossover   children spread around their parents as one-point crossover of binary strings would;
 *                                eta large: close to the parents
 *   polynomial mutation          one variable moved by a share of its box
 *   Latin hypercube              n samples in the unit cube, exactly one in each of the n slices of every variable
 *   choices                      one parent's or the other's; mutated, any other word with the same probability
 *
 * All stay within lower..upper; a variable whose bounds are equal stays there.
 * Threads  no state but the random stream handed in
 * Sources  Deb and Agrawal, Complex Systems 9 (1995) 115-148; the bounded forms as in Deb's NSGA-II code;
 *          McKay, Beckman and Conover, Technometrics 21 (1979) 239-245. */
#pragma once

#include "base/random.h"
#include "evaluate/problem.h"

/* Two children of two parents; each variable is recombined with probability 1/2. */
void crossover_sbx(Random *r, size_t n_var, const double lower[], const double upper[], double eta,
                   const double mother[], const double father[], double child1[], double child2[]);

/* Each variable of x is mutated with the given probability. */
void mutate_polynomial(Random *r, size_t n_var, const double lower[], const double upper[], double probability,
                       double eta, double x[]);

/* X (n, n_var); slices holds n numbers. Streams (seed, sampling, generation, variable). */
void latin_hypercube(uint32_t seed, uint32_t generation, size_t n, size_t n_var, double X[], size_t slices[]);

/* Children of crossover: of a choice each has that of one parent, whatever became of it. */
void cross_choices(Random *r, const Problem *p, const double mother[], const double father[], double child1[],
                   double child2[]);

/* After mutation: what is not real and no longer what it was before moves by 1 at least, to another word, to another
 * value that is sold. */
void mutate_discrete(Random *r, const Problem *p, const double before[], double x[]);

/* x is `from` but for variable d, which is not real: another word, the next whole number or value that is sold. */
void step_discrete(Random *r, const Problem *p, size_t d, const double from[], double x[]);
