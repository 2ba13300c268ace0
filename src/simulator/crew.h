/* simulator/crew.h -- one simulator per thread, and the one parallel loop of the program.
 *
 * Life cycle  crew_create -> crew_run ... -> crew_free
 * Ownership   borrows the Scene, which must outlive it
 * Threads     call it from one thread; tasks are shared out one by one and stored by index, so the results do not
 *             depend on how many threads there are */
#ifndef IMTET_SIMULATOR_CREW_H
#define IMTET_SIMULATOR_CREW_H

#include "base/watch.h"
#include "sim/sim.h"

typedef struct Crew Crew;

typedef struct {
    SceneKind kind;
    const double *x; /* (n_floors + 2); NULL for SCENE_NO_CORE */
} SimTask;

/* threads 0: one per processor */
Status crew_create(Crew **out, const Scene *scene, long threads, Err *err);
Status crew_run(Crew *crew, size_t n, const SimTask tasks[], SimResult results[], Err *err);

/* The same with somebody looking on (NULL: nobody). Where the watch does not let it go on, what is under way is
 * finished and STATUS_STOPPED returned. */
Status crew_run_watched(Crew *crew, size_t n, const SimTask tasks[], SimResult results[], const Watch *watch, Err *err);

/* The same on worker 0 .. crew_size - 1 alone, in the caller's thread: every thread may have a worker of its own. */
int crew_size(const Crew *crew);
Status crew_run_alone(Crew *crew, int worker, size_t n, const SimTask tasks[], SimResult results[], const Watch *watch,
                      Err *err);
void crew_free(Crew *crew); /* NULL is fine */

#endif
