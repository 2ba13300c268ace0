/* moga/cover.h -- how much a growing set dominates, kept up to date: the hypervolume as a share of a box.
 *
 *   share = samples of the box lower..reference that some member dominates / all samples
 *
 * The samples are drawn once, so that the share never falls while members are added, and each one that is dominated is
 * never looked at again: adding costs (samples that are left) x (new members). Standard error sqrt(s (1 - s) /
 * samples).
 *
 * Life cycle  cover_create -> cover_add ... -> cover_free
 * Threads     one Cover per thread. */
#ifndef IMTET_MOGA_COVER_H
#define IMTET_MOGA_COVER_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"

enum { COVER_SAMPLES = 20000 };

typedef struct Cover Cover;

Status cover_create(Cover **out, size_t n_obj, const double lower[], const double reference[], uint32_t seed, Err *err);
void cover_add(Cover *c, const double f[]); /* (n_obj) minimised */
double cover_share(const Cover *c);
double cover_error(double share); /* its standard error */
void cover_free(Cover *c);        /* NULL is fine */

#endif
