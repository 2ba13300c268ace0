/* cmd/improve.h -- what commands share that make a better or simpler design of one of a run (study/improver.h): the run
 * held while they work, the report of what was gained at what cost, and the new design in the run. */
#pragma once

#include "cmd/args.h"
#include "cmd/show.h"
#include "store/store.h"
#include "study/improver.h"

typedef struct {
    RunStore *store;
    Run run;       /* as it was; its motions where they are now (OPTION_MOVED) */
    size_t row;    /* of the design */
    long id, knee; /* of the design at the end; of the knee where that was stored, -1 without a front; 0: none */
    ImproveConfig config;
    Improved result;
} Improve;

/* The operand is the run, --design the design, the knee if it is not given; `work` fills config, calls improve_design
 * and reports. Whatever comes of it, all is released. */
Status improve_run(const Args *args, Status (*work)(const Args *args, Improve *m, Err *err), Err *err);

/* As a design of the kind polished; where the search is over it may be a named one, and gets better values. */
Status improve_store(Improve *m, const Evaluation *design, Err *err);

/* A row of the report: design i of the path, 0 or its id. */
void improve_row(const Improve *m, json_t *table, const char *label, size_t i, long id);

/* Says the cost in a line. */
void improve_cost(Document *d, const char *before, const ImproveCost *c);

/* Says what the deviations are of, the cost, the id of the stored design, and the new knee, by which other commands
 * name a design. */
void improve_say(Document *d, const Improve *m);
