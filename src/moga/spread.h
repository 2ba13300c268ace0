/* moga/spread.h -- how far answers scatter, learnt from the designs that were simulated more than once.
 *
 *   S_jk = sum over the answers of design j of (f - mean)^2,   nu_j = answers - 1
 *   model of objective k   the same deviation everywhere, v = c^2, or a share of the value, v(f) = (c f)^2: the one
 *                          under which the repeats are likelier (normal, c by maximum likelihood)
 *   of one design          s^2 = (v(mean) + S) / (1 + nu): the model counts as one repeat, so that two answers that
 *                          happen to agree do not make a design certain
 *   of its mean            error^2 = s^2 / answers
 *
 * Without repeats, or where they all agree, every deviation is 0.
 *
 *   estimate of a design   f - t,  t = e error^2 / (error^2 + tau^2),  |t| <= error
 *                          e: f less what a surface that does not know this design foretells of it; tau: how far off
 *                          the surface is, tau^2 = mean over the designs of e^2 - error^2, 0 at least. An answer that
 *                          was lucky is taken for what its neighbours make likely, but never for more than a standard
 *                          error off: where the surface is wrong about a design it does little harm
 *
 * Threads  pure functions on the caller's memory
 * Sources  Smyth, Stat. Appl. Genet. Mol. Biol. 3 (2004) 3 (variances moderated by a common one); Efron and Morris,
 *          J. Am. Stat. Assoc. 67 (1972) 130-139 (estimates that are moved so far at most). */
#ifndef IMTET_MOGA_SPREAD_H
#define IMTET_MOGA_SPREAD_H

#include <stddef.h>

typedef struct {
    double deviation; /* unit of the objective, or a share */
    int is_share;
} Spread;

/* Objective k of designs rows[0..n), each with answers[row] > 1: mean and S are column k of (., n_obj). */
Spread spread_fit(size_t n, const size_t rows[], const size_t answers[], size_t n_obj, size_t k, const double mean[],
                  const double S[]);

/* Variance of a single answer about the mean of one design. */
double spread_variance(const Spread *s, double mean, double S, size_t answers);

/* Objective k of designs rows[0..n), e (n): column k of mean, error and estimate (., n_obj). */
void spread_estimate(size_t n, const size_t rows[], const double e[], size_t n_obj, size_t k, const double mean[],
                     const double error[], double estimate[]);

#endif
