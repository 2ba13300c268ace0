/* evaluate/adapter.h -- the problem that the settings pose: which simulator, which columns, which limits.
 *
 *   problem.kind = tower      gaps and thicknesses (evaluate/tower.h)
 *                  external   processes that speak JSON lines (evaluate/external.h)
 *
 * Life cycle  adapter_open -> search on adapter_problem -> adapter_close
 * Threads     as evaluate/problem.h */
#pragma once

#include "evaluate/limits.h"
#include "evaluate/tower.h"

typedef struct Adapter Adapter;

Status adapter_open(Adapter **out, const Settings *s, Err *err);

/* The simulator alone of a Recipe (evaluate/recipe.h), as another process opens it: a ReopenFn (evaluate/cluster.h). */
Status simulator_open(Problem *p, const void *recipe, size_t size, Err *err);
void adapter_close(Adapter *a); /* NULL is fine */

const Problem *adapter_problem(const Adapter *a);
const Schema *adapter_schema(const Adapter *a);
const Tower *adapter_tower(const Adapter *a); /* NULL: it is another problem */

/* For what this process computes beside simulations: those of the settings; on rank 0 of a cluster, which simulates
 * nothing, at least all that it may use. */
int adapter_threads(const Adapter *a);

/* From now on the answers of an external problem have n constraint values: columns g_1 to g_n, each <= 0 where it is
 * kept. Of other problems nothing changes. */
Status adapter_constrain(Adapter *a, long n, Err *err);

/* order (n_parts), copied: parts are taken in it, the first n_cheap as the cheap level. */
Status adapter_order(Adapter *a, size_t n_cheap, const size_t order[], Err *err);

/* Copied; at first there is none. */
void adapter_observe(Adapter *a, const Observer *observer);
