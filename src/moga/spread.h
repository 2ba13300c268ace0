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
 * Threads  pure functions on the caller's memory
 * Source   Smyth, Stat. Appl. Genet. Mol. Biol. 3 (2004) 3 (variances moderated by a common one). */
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

#endif
