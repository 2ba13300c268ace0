/* moga/replication.h -- which noisy designs are evaluated again (docs/noise.md).
 *
 * Threads  one */
#pragma once

#include "moga/batch.h"

/* Replicates of designs that the search builds on, beside the batch. The criteria have measured the front. */
void replication_add(const Common *c, const Criteria *q, Batch *b);
