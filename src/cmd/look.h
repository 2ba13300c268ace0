/* cmd/look.h -- what commands that look at a run have in common: which run, which design, which other earthquakes. */
#ifndef IMTET_CMD_LOOK_H
#define IMTET_CMD_LOOK_H

#include "cmd/args.h"
#include "report/report.h"

/* The run of the operand, ready to be shown: `show` gets the report and where --out, else RUN/name, puts it. */
typedef Status (*LookFn)(const Report *r, const char *path, Err *err);
Status look_at_run(const Args *args, const char *name, LookFn show, Err *err);

#define OPTIONS_LOOK                                                                                                   \
    {"--design", "ID", NULL, 0, "the design shown in detail: an id of the run, knee (default) or best_NAME"},          \
        {"--record", "FILE", NULL, 1,                                                                                  \
         "another earthquake for it; may be repeated (default: motion.records, else the built-in ones)"},              \
        {"--floor", "N", NULL, 0, "whose displacement is shown over time (default: the middle one)"}, OPTION_MOVED,    \
        OPTION_CHANNEL, OPTION_PGA, OPTION_STRETCH, OPTION_UNIT

#endif
