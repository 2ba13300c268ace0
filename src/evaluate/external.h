/* evaluate/external.h -- any simulator, as worker processes that speak JSON lines (docs/external.md).
 *
 *   to its standard input      {"id":17,"x":[0.1,0.2]}
 *   from its standard output   {"id":17,"f":[1.5,2.5]}   or   {"id":17,"error":"why"}; with f also "g":[-0.1]
 *
 * One process per worker, started by the first design it gets and kept alive; one request at a time each. A
 * worker that ends, says nothing for timeout_s, or writes what is no answer to its request is killed: the design has
 * failed, and the next design gets a fresh worker. An answer with the wrong number of objectives or constraint values,
 * or one that is not finite, fails the design alone.
 *
 * Constraints     g <= 0 where they are kept, the further results (extra) of an evaluation. While
 *                 ProblemOptions.constraints is below 0 any number up to CONSTRAINTS_MAX is taken; the others are NAN
 *
 * As a simulator  one part for each design, an ExternalAnswer. Worker i of the queue has a process of its own
 * Life cycle      external_open -> search ... -> problem_close
 * Processes       started without a shell, each in its own process group; standard error is shared with ours; one
 *                 more beside each kills it when we are killed (evaluate/helper.h)
 * Stops           a process at work gets some seconds more to answer, then it is killed and its design counts as never
 *                 asked for
 * Errors          a command that cannot be started at all is STATUS_BAD_DATA; whatever a worker does is not an error */
#pragma once

#include "evaluate/problem.h"
#include "settings/options.h"

typedef struct {
    Outcome outcome;
    char reason[160];
    double seconds; /* from the request on */
    size_t n_con;
    double f[]; /* (n_obj), then g (n_con), room for CONSTRAINTS_MAX, as the worker gave them */
} ExternalAnswer;

/* command: words apart by blanks; '...' and "..." keep blanks, a backslash outside '...' keeps the next character.
 * lower and upper: one number for all variables, or a list. */
Status external_open(Problem *p, const ProblemOptions *options, size_t n_workers, Err *err);

/* From now on answers have n constraint values. */
void external_constrain(Problem *p, long n);
