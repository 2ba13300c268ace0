/* moga/replication.h -- which noisy designs are evaluated again (docs/noise.md).
 *
 * Threads  one */
#pragma once

#include "moga/batch.h"

/* Replicates of designs that the search builds on, after n designs of a batch; returns the new n. The criteria have
 * measured the front. */
size_t replication_add(const Common *c, const Criteria *q, Batch *b, size_t n);
