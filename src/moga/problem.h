/* moga/problem.h -- what the search knows of the world: boxes, counts and one callback.
 *
 *   minimise f(x),  g(x) <= 0,  lower <= x <= upper
 *
 * The true simulator, a response surface and a textbook problem stand behind the same callback. Sets of points travel
 * together: row-major X (n, n_var), F (n, n_obj), G (n, n_con).
 *
 * Threads  evaluate shares a batch out over threads itself and stores by index: the answer does not depend on how many.
 *          stream, where there is one, simulates without batches: n_workers threads of its own take one design after
 * the other and give its result, until there are no more Errors   a design whose evaluation fails is ok[i] = 0 (F and G
 * of that row are then meaningless); Status is for what ends the whole search. */
#ifndef IMTET_MOGA_PROBLEM_H
#define IMTET_MOGA_PROBLEM_H

#include <stddef.h>

#include "base/status.h"

/* draws (n): how many answers there are of each design already; where the problem is noisy the next one is a fresh
 * draw. NULL: none of any. */
typedef Status (*EvaluateFn)(size_t n, const double X[], const size_t draws[], double F[], double G[],
                             unsigned char ok[], void *user, Err *err);

/* Moves x into the set of designs that can be built at all (t_top <= t_base, say); NULL where the box is all. */
typedef void (*RepairFn)(double x[], void *user);

/* Designs to be simulated one by one (moga/feed.h). take waits for a design x (n_var), tells of its draws and returns
 * its name, SIZE_MAX: no more are wanted. give hands in f (n_obj) and g (n_con). close: this side ends, nobody waits
 * longer. */
typedef struct Feed Feed;
size_t feed_take(Feed *feed, double x[], size_t *draws);
void feed_give(Feed *feed, size_t name, const double f[], const double g[], int ok);
void feed_close(Feed *feed);

/* Works until feed_take says that no more are wanted, or a Status ends the search. */
typedef Status (*StreamFn)(Feed *feed, void *user, Err *err);

typedef struct {
    size_t n_var, n_obj, n_con;
    const double *lower, *upper; /* (n_var) */
    EvaluateFn evaluate;
    RepairFn repair;
    void *user;
    int is_noisy;     /* the same design simulated again gives another answer */
    StreamFn stream;  /* NULL: batches only */
    size_t n_workers; /* designs that stream has under way at a time */
} Problem;

#endif
