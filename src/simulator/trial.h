/* simulator/trial.h -- a design is several simulations: members of an ensemble, each under every record.
 *
 *   member 0 is the design, member k has every gap changed: gap (1 + ENSEMBLE_CHANGE z) + tolerance z', z and z'
 * standard normal from the streams (seed, k): the same errors for every design, so that differences between designs are
 * theirs
 *
 *   of one record   mean and standard deviation (n - 1) over the members
 *   of several      sim.robust = worst: the mean of the record that is worst in that objective, with its deviation;
 *                   mean: mean over the records, with the root mean square of their deviations
 *
 * A design with a member that failed has failed: nobody would build it.
 *
 * Life cycle  trials_open -> trials_run ... -> trials_close
 * Threads     call it from one thread; the simulations are shared out over the crews' threads, the numbers do not
 * depend on how many there are */
#ifndef IMTET_SIMULATOR_TRIAL_H
#define IMTET_SIMULATOR_TRIAL_H

#include "simulator/crew.h"
#include "simulator/measures.h"
#include "simulator/scenario.h"

typedef struct Settings Settings;

typedef struct Trials Trials;

/* motion.record and motion.records, sim.replicates, sim.gap_tolerance_m, sim.robust of the settings. */
Status trials_open(Trials **out, const Settings *s, int threads, Err *err);
void trials_close(Trials *t); /* NULL is fine */

const World *trials_world(const Trials *t); /* of motion.record */
size_t trials_n_records(const Trials *t);
const World *trials_record(const Trials *t, size_t i); /* 0: that of motion.record */
Crew *trials_crew(const Trials *t);
size_t trials_per_design(const Trials *t);

typedef struct {
    SimResult result;          /* of one simulation: the first that failed, else the design itself */
    double value[N_MEASURES];  /* natural; not finite where a simulation failed */
    double spread[N_MEASURES]; /* standard deviation of a single simulation; NAN: one member */
    double seconds;            /* of all simulations */
} Trial;

/* n designs X (n, n_floors + 2), of which draws[i] trials were made before (NULL: none): the members of a further trial
 * go on where those ended. The watch hears of each design when its last simulation is done. */
Status trials_run(Trials *t, size_t n, const double X[], const size_t draws[], Trial out[], const Watch *watch,
                  Err *err);

/* One design by that worker of the crews (0 .. threads - 1) alone, in the caller's thread. */
Status trials_run_alone(Trials *t, int worker, const double x[], size_t draws, Trial *out, const Watch *watch,
                        Err *err);

#endif
