/* evaluate/tower.h -- the simulator of the building with its core: settings made a problem of gaps and thicknesses.
 *
 *   design     by design.variables (scene/design.h); t_top > t_base is repaired by swapping the two
 *   objectives those of search.objectives, extra the other measures (evaluate/measures.h)
 *   parts      n_replicates x n_records (evaluate/replicates.h), each a SimResult; replicate k of repeat r is the
 *              replicate r n_replicates + k of the design
 *   cheap      where there are several replicates: the first one of every record
 *   variant    SceneKind: SCENE_IMPACT is the design, the others are baselines of which only the first part counts
 *
 * Life cycle tower_open -> tower_simulate, or a search on the problem ... -> problem_close
 * Threads    every worker has an integrator of its own for every record */
#ifndef IMTET_EVALUATE_TOWER_H
#define IMTET_EVALUATE_TOWER_H

#include "evaluate/queue.h"
#include "evaluate/replicates.h"
#include "evaluate/scenario.h"

typedef struct Settings Settings;
typedef struct Tower Tower;

enum { TOWER_RECORDS_MAX = 16 };

typedef enum {
    TOWER_AS_SET, /* motion.record and motion.records, sim.replicates, sim.gap_tolerance_m, sim.robust */
    TOWER_SINGLE  /* motion.record alone, one replicate */
} TowerUse;

/* Workers as search.threads has them, but no more than n_tasks. */
Status tower_open(Problem *p, const Settings *s, TowerUse use, size_t n_tasks, Err *err);

/* On a scene that is there already (borrowed), without bounds: n_replicates, gaps changed by REPLICATE_CHANGE alone. */
Status tower_open_scene(Problem *p, const Scene *scene, size_t n_replicates, uint32_t seed, size_t n_workers, Err *err);

/* The tower of such a problem; NULL: it has another simulator. */
const Tower *tower_of(const Problem *p);

int tower_n_floors(const Tower *t);
const DesignSpace *tower_design(const Tower *t);
size_t tower_n_records(const Tower *t);
const MeasureOrder *tower_measures(const Tower *t);
const Scenario *tower_record(const Tower *t, size_t i); /* 0: motion.record */
size_t tower_n_workers(const Tower *t);
SimWorker *tower_worker(const Tower *t, size_t record, size_t worker); /* while no queue uses it */
ReplicatePlan tower_plan(const Tower *t);

typedef struct {
    SceneKind kind;
    const double *x; /* (n_var); NULL for SCENE_NO_CORE */
} SimTask;

/* n simulations of the first record, without replicates, shared out over the workers. */
Status tower_simulate(const Problem *p, size_t n, const SimTask tasks[], SimResult results[], Err *err);

/* Every simulation of X (n, n_var): results (n, n_replicates, n_records). */
Status tower_parts(const Problem *p, size_t n, const double X[], SimResult results[], Err *err);

/* X (n, n_var) with all replicates and records of the tower; out[i].shown = &shown[i]. */
Status tower_replicate(const Problem *p, size_t n, const double X[], SimResult shown[], ReplicateSummary out[],
                       Err *err);

#endif
