/* simulator/external.h -- any simulator, as worker processes that speak JSON lines (docs/external.md).
 *
 *   to its standard input      {"id":17,"x":[0.1,0.2]}
 *   from its standard output   {"id":17,"f":[1.5,2.5]}   or   {"id":17,"error":"why"}
 *
 * One process per thread asked for, started by the first design it gets and kept alive; one request at a time each. A
 * worker that ends, says nothing for timeout_s, or writes what is no answer to its request is killed: the design has
 * failed, and the next design gets a fresh worker. An answer with the wrong number of objectives, or one that is not
 * finite, fails the design alone.
 *
 * Life cycle  external_open -> external_run ... -> external_close
 * Processes   started without a shell, each in its own process group; standard error is shared with ours; one more
 * kills them when we are killed (simulator/guard.h)
 * Threads     call it from one thread, but for external_ask; which worker gets which design is a matter of time,
 * answers are stored by index Errors      a command that cannot be started at all is STATUS_BAD_DATA; whatever a worker
 * does is not an error */
#ifndef IMTET_SIMULATOR_EXTERNAL_H
#define IMTET_SIMULATOR_EXTERNAL_H

#include <stddef.h>

#include "base/watch.h"

typedef struct External External;

typedef enum { ANSWER_OK, ANSWER_ERROR, ANSWER_NOT_FINITE, ANSWER_DEAD, ANSWER_TIMEOUT, ANSWER_GARBLED } AnswerOutcome;
typedef struct {
    AnswerOutcome outcome;
    char reason[160];
    double seconds; /* from the request on */
} Answer;

/* One word for files: ok, error, ... */
const char *answer_word(AnswerOutcome outcome);

/* command: words apart by blanks; '...' and "..." keep blanks, a backslash outside '...' keeps the next character. */
Status external_open(External **out, const char *command, size_t workers, double timeout_s, size_t n_var, size_t n_obj,
                     Err *err);

/* X (n, n_var), F (n, n_obj) as the worker gave them, answers (n); ids (n) of the requests, NULL: counted on. Where the
 * watch (NULL: nobody) does not let it go on, what is under way gets some seconds to answer, the rest is dropped and
 * STATUS_STOPPED returned. */
Status external_run(External *e, size_t n, const double X[], const long ids[], double F[], Answer answers[],
                    const Watch *watch, Err *err);

/* One design by that worker (0 .. workers-1) alone; each worker may be asked by a thread of its own. */
Status external_ask(External *e, size_t worker, const double x[], long id, double f[], Answer *answer,
                    const Watch *watch, Err *err);

/* Closes every worker's input, waits a moment, kills who is left. NULL is fine. */
void external_close(External *e);

#endif
