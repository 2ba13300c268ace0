/* moga/feed.h -- designs between the loop of an asynchronous search and the threads that simulate.
 *
 *   loop      feed_ask(x) ...   feed_next(): the next result, in the order of arrival
 *   threads   feed_take(x) -> simulate -> feed_give(f)   (moga/problem.h)
 *
 * A design is pending from feed_ask until feed_next has given its result: it waits, is simulated, or has arrived.
 * A search that goes on is given the results that arrived after its state was saved: they are the first that feed_next
 * gives, in their order, and a design among them is not simulated again when it is asked for.
 *
 * Life cycle  feed_create -> (threads work on it) -> feed_close, threads end -> feed_free
 * Threads     take, give and close from any thread, the rest from the loop's own
 * Memory      grows with what is pending */
#ifndef IMTET_MOGA_FEED_H
#define IMTET_MOGA_FEED_H

#include "base/pack.h"
#include "moga/problem.h"

/* What was known of a design when it was asked for. */
typedef struct {
    size_t draws; /* answers that there were of it */
    unsigned char kind, foretold;
    unsigned char way;      /* InfillKind by which the surface chose it */
    const double *foreseen; /* (n_obj) predicted objectives; read where foretold */
} Asked;

/* A result; its pointers hold until the next call of feed_ask or feed_next. */
typedef struct {
    Asked asked;
    const double *x, *f, *g;
    unsigned char ok;
} Arrived;

Status feed_create(Feed **out, size_t n_var, size_t n_obj, size_t n_con, Err *err);
void feed_free(Feed *feed); /* NULL is fine */

Status feed_ask(Feed *feed, const double x[], const Asked *asked, Err *err);
size_t feed_pending(const Feed *feed);
int feed_has(Feed *feed, const double x[]);

/* Pending design i in the order of asking: its x and, where foretold, its foreseen objectives. */
const double *feed_design(Feed *feed, size_t i, Asked *asked);

/* Waits for the next result; 0: nobody simulates any more. */
int feed_next(Feed *feed, Arrived *out);

/* Designs that nobody has taken are no longer asked for. */
void feed_withdraw(Feed *feed);

/* Results from before, borrowed: they arrive first. kind: of those that nobody has asked for. */
void feed_replay(Feed *feed, size_t n, const double X[], const double F[], const double G[], const unsigned char ok[],
                 const unsigned char kind[]);

/* What is pending. */
void feed_pack(Feed *feed, Pack *p);

/* Thread-seconds between take and give, and in how many designs. */
double feed_busy(Feed *feed, size_t *n);

#endif
