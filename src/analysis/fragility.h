/* analysis/fragility.h -- the probability of exceeding a limit, by intensity, and how often that happens.
 *
 *   P(exceeded | x) = Phi(ln(x / median) / beta)
 *
 * of n_j simulations at intensity x_j of which z_j exceed the limit, by maximum likelihood of the binomial counts
 *
 *   sum_j z_j ln P(x_j) + (n_j - z_j) ln(1 - P(x_j))
 *
 * in a = -ln(median) / beta, b = 1 / beta, where it is concave: Fisher scoring. Standard errors of ln median and beta
 * are those of the inverse information (delta method). Where the levels part without overlap (none below, all above, at
 * most one that has both) they are too far apart: neither median nor beta nor a rate is known, but what the median lies
 * between.
 *
 *   rate = integral P(exceeded | x) |d lambda(x)|     [1/year], lambda: the hazard curve, yearly rate of more than x
 *
 * lambda is a power of x between its points. Below the first point nothing is counted, above the last the rate there
 * times P there. Likewise what is lost in a year,
 *
 *   annual loss = integral L(x) |d lambda(x)|        [of a new building, 1/year]
 *
 * L: the mean loss of one event, straight between 0 at x = 0 and the levels, constant above the last one.
 *
 * Sources  Baker, Efficient analytical fragility function fitting using dynamic structural analysis, Earthquake Spectra
 *          31 (2015) 579-599; the integral: Cornell, Jalayer, Hamburger and Foutch, J. Struct. Eng. 128 (2002) 526-533
 * Threads  pure functions */
#pragma once

#include <stddef.h>

typedef struct {
    double median, beta;          /* [unit of x], [-]; NAN: not known */
    double sd_ln_median, sd_beta; /* standard errors; NAN: not known */
    double between[2];            /* of levels that part, where the median lies; 0, INFINITY: no bound; else NAN */
} Fragility;

/* x, n_at, exceeded (n) of the intensities. */
Fragility fragility_fit(size_t n, const double x[], const size_t n_at[], const size_t exceeded[]);

double fragility_at(const Fragility *f, double x); /* NAN: not known */

/* hazard (n, 2): x rising, lambda falling, all above 0. */
double fragility_rate(const Fragility *f, size_t n, const double hazard[]);

typedef struct {
    double per_year;
    double below, above; /* of it by events below the first level; above the last one, or above the last point */
    double at_begin;     /* of it, were all events above the first point as small as that one */
    double error;        /* standard error over the records; NAN: one of them, or not asked for */
    size_t n_failed;     /* simulations */
} AnnualLoss;

/* x, loss (n) of the levels, x rising; hazard (n_hazard, 2). */
AnnualLoss annual_loss(size_t n, const double x[], const double loss[], size_t n_hazard, const double hazard[]);
