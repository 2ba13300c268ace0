/* evaluate/isolated.h -- simulations in processes of their own (run.isolate), as workers of a pool: one that crashes
 * ends its design alone.
 *
 * They are forked at the opening, with the problem open and nothing else of ours: no lock, no store. One that has ended
 * is replaced by a fork with the next task. An answer comes whole or not at all. */
#pragma once

#include "evaluate/order.h"

typedef struct {
    Pool pool;
    Doer doer;
    void (*lost)(const Task *task, const char *reason); /* writes the part of a task whose process has ended */
} Isolated;

Status isolated_open(Isolated *q, size_t n_workers, Err *err);
