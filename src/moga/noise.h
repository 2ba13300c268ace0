/* moga/noise.h -- noise of the objectives, learnt from designs with more than one replicate.
 *
 *   S_jk   sum over the replicates of design j of (f - mean)^2,   nu_j = replicates - 1
 *   model  of objective k: the same standard deviation everywhere, v = c^2, or relative to the value, v(f) = (c f)^2,
 *          whichever has the greater likelihood (normal, c by maximum likelihood)
 *   s^2    of one design: (v(mean) + S) / (1 + nu). The model counts as one replicate, so that two replicates that
 *          happen to agree do not make a design certain
 *   error  standard error of the mean: s / root(replicates)
 *
 * Without replicates, or where all agree, every standard deviation is 0.
 *
 * Threads  pure functions on the caller's memory
 * Source   Smyth, Stat. Appl. Genet. Mol. Biol. 3 (2004) 3 (variances moderated by a common one) */
#pragma once

#include "base/status.h"

typedef struct {
    double sd; /* unit of the objective, or relative */
    int is_relative;
} NoiseModel;

/* Objective k of designs rows[0..n), each with replicates[row] > 1: mean and S are column k of (., n_obj). */
NoiseModel noise_fit(size_t n, const size_t rows[], const size_t replicates[], size_t n_obj, size_t k,
                     const double mean[], const double S[]);

/* s^2 of one design. */
double noise_variance(const NoiseModel *model, double mean, double S, size_t replicates);
