/* study/run_simulator.h -- the simulator of a run, opened again for designs that are no part of its search.
 *
 * Life cycle  run_simulator_open -> queue_ask, queue_evaluate ... -> run_simulator_close; opened again it closes what
 *             was open. A zeroed one is closed
 * Threads     one; the simulations are shared out over its workers */
#pragma once

#include "evaluate/adapter.h"

typedef struct {
    Adapter *adapter;
    Queue *queue;
} RunSimulator;

/* As the settings say, but for the options of simulation. go_on: as of an Observer. */
Status run_simulator_open(RunSimulator *r, const Settings *s, const SimOptions *sim, int (*go_on)(void *user),
                          void *user, Err *err);
void run_simulator_close(RunSimulator *r);
