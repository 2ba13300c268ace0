/* evaluate/tower.h -- the simulator of the building with its core: settings made a problem of gaps and thicknesses.
 *
 *   design     by design.variables (scene/design.h); t_top > t_base is repaired by swapping the two
 *   objectives those of search.objectives, extra the other measures (evaluate/measures.h)
 *   parts      n_replicates x n_records (evaluate/replicates.h), each its Measured numbers; replicate k of repeat r
 *              is the replicate r n_replicates + k of the design
 *   cheap      where there are several replicates: the first one of every record
 *   variant    any other simulation that is asked for: SimTask
 *   scenes     a search has one for each record, all of them open. A sweep (tower_open_scenes) may have thousands,
 *              and a design is judged under one of them: a worker has the one at hand open. Every record is read once
 *
 * Life cycle tower_open -> tower_simulate, or a search on the problem ... -> problem_close
 * Threads    every worker has an integrator of its own for every scene that it has open */
#pragma once

#include "evaluate/queue.h"
#include "evaluate/recipe.h"
#include "evaluate/replicates.h"
#include "evaluate/scenario.h"

typedef struct Tower Tower;

enum { TOWER_LEVELS = 4 };

typedef enum {
    TOWER_AS_SET, /* motion.record and motion.records, sim.replicates, sim.gap_tolerance_m, sim.robust */
    TOWER_SINGLE  /* motion.record alone, one replicate */
} TowerUse;

/* Workers as search.threads has them, but no more than n_tasks. */
Status tower_open(Problem *p, const Settings *s, TowerUse use, size_t n_tasks, Err *err);

/* A sweep over scenes of n_records records; nothing is read yet. */
Status tower_open_scenes(Problem *p, const Settings *s, size_t n_records, const char *const records[], size_t n_scenes,
                         const SceneChange scenes[], Err *err);

/* Opens the problem again in another process. */
Status tower_reopen(Problem *p, const Recipe *recipe, Err *err);

/* The design variables of the settings, whose building is read for it. */
Status tower_space(const Settings *s, DesignSpace *out, Err *err);

/* The tower of such a problem; NULL: it has another simulator. */
const Tower *tower_of(const Problem *p);

const DesignSpace *tower_design(const Tower *t);
size_t tower_n_records(const Tower *t);

/* How a design is judged that has n parts: all, the first replicate of every record, of the first n records, or one. */
ReplicatePlan tower_plan(const Tower *t, size_t n);

/* Standard errors (evaluate/replicates.h) of a design simulated once under each of the n_records. */
void tower_standard_errors(const Tower *t, const SimResult by_record[], double error[N_MEASURES]);

const MeasureOrder *tower_measures(const Tower *t);
const Scenario *tower_record(const Tower *t, size_t i); /* of a search; 0: motion.record */

/* A scene, open until it is released. */
Status tower_acquire(Tower *t, size_t scene, const Scenario **out, Err *err);
void tower_release(Tower *t, size_t scene);

/* The ground motion of a scene, for motion_free. */
Status tower_motion(const Problem *p, size_t scene, Motion *out, Err *err);

/* -- simulations outside a search: tasks of the queue, which no observer hears of -- */

typedef struct {
    SceneKind kind;
    const double *x;     /* (n_var); NULL for SCENE_NO_CORE */
    size_t scene;        /* of the tower, 0: the first */
    size_t level;        /* times that the steps are doubled (estimate_options), TOWER_LEVELS at most */
    int is_brief;        /* to the end of the strong part of its motion (motion/motion.h) */
    LinearDevice device; /* of SCENE_TMD or SCENE_LINKS */
    size_t
        n_parts; /* tower_n_records: under each of them; as the problem has them: with replicates. 0: one simulation */
    Measured *parts;           /* (n_parts) to be filled; NULL: not wanted */
    SimResult *result;         /* of the part that failed first, else of the first; NULL: not wanted */
    ReplicateSummary *summary; /* NULL: not wanted */
} SimTask;

/* The variant that the queue is asked for. */
Variant tower_variant(const Tower *t, const SimTask *task);

/* All n tasks, shared out over the workers. tell: how many are done, NULL: nobody asks. */
typedef void SimTell(size_t n_done, void *user);
Status tower_run(const Problem *p, size_t n, const SimTask tasks[], SimTell *tell, void *user, Err *err);

/* results (n) of n single simulations. */
Status tower_simulate(const Problem *p, size_t n, const SimTask tasks[], SimResult results[], Err *err);

/* X (n, n_var) with all replicates and records of the tower. */
Status tower_replicate(const Problem *p, size_t n, const double X[], SimResult shown[], ReplicateSummary out[],
                       Err *err);
