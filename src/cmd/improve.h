/* cmd/improve.h -- a design of a run that a command makes another of: the run held while it works, then the new one in
 * it.
 *
 * Life cycle  improve_open -> improve_store where there is something to be stored -> improve_close (a zeroed one is
 *             fine) */
#pragma once

#include "cmd/args.h"
#include "store/store.h"

typedef struct {
    RunStore *store;
    Run run;       /* as it was; its motions where they are now (OPTION_MOVED) */
    size_t row;    /* of the design */
    long id, knee; /* of the new design, of the run's knee beside it; 0: nothing is stored */
} Improve;

/* The operand is the run, word names the design. */
Status improve_open(Improve *m, const Args *args, const char *word, Err *err);

/* As a design of the kind polished; where the search is over it may be a named one, and gets better values. */
Status improve_store(Improve *m, const Evaluation *design, Err *err);

/* Prints the id of what was stored, and the knee where it has moved: other commands name a design by it. */
void improve_say(const Improve *m);

void improve_close(Improve *m);
