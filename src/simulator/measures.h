/* simulator/measures.h -- the numbers by which a design is judged: names, signs and places, in one table.
 *
 * The first N_OBJECTIVES are searched for; internally all are minimised, f = sense * value, while every file and every
 * table shows the natural value. The rest describe the run itself. */
#ifndef IMTET_SIMULATOR_MEASURES_H
#define IMTET_SIMULATOR_MEASURES_H

#include "evaluate/evaluation.h"
#include "sim/sim.h"

enum { N_OBJECTIVES = 7, N_MEASURES = 10 };

typedef struct {
    const char *name; /* column and key */
    double sense;     /* +1: less is better, -1: more is better, 0: not an objective */
    const char *what;
} Measure;

const Measure *measure(int k);                   /* k = 0..N_MEASURES-1 */
double measure_value(const SimResult *r, int k); /* natural sign and unit */

/* 1 and f (N_OBJECTIVES, minimised) filled where the run finished with finite numbers, else 0. */
int measure_objectives(const SimResult *r, double f[N_OBJECTIVES]);

/* What a run comes to as an evaluation. */
Outcome measure_outcome(RunOutcome outcome);

#endif
