/* base/hypervolume.h -- Monte Carlo hypervolume of a growing set, kept up to date.
 *
 *   share = samples of the box lower..reference that some member dominates / all samples
 *
 * The samples are drawn once, so that the share never falls while members are added, and a sample that is dominated is
 * dropped: adding costs a microsecond or two. Standard error sqrt(share (1 - share) / samples).
 *
 * Life cycle  hypervolume_create -> hypervolume_add ... -> hypervolume_free
 * Threads     one Hypervolume per thread */
#pragma once

#include "base/status.h"

enum { HYPERVOLUME_SAMPLES = 20000 };

typedef struct Hypervolume Hypervolume;

/* The least and the largest values of some designs become a box about them: from a fifth of their range below. */
void hypervolume_box(size_t n_obj, double lower[], double reference[]);

Status hypervolume_create(Hypervolume **out, size_t n_obj, const double lower[], const double reference[],
                          uint32_t seed, Err *err);
void hypervolume_add(Hypervolume *h, const double f[]);          /* (n_obj) minimised */
double hypervolume_gain(const Hypervolume *h, const double f[]); /* by which it would add to the share */
double hypervolume_share(const Hypervolume *h);                  /* of the box */
double hypervolume_error(double share);                          /* standard error of a share */
void hypervolume_free(Hypervolume *h);                           /* NULL is fine */
