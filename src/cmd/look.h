/* cmd/look.h -- what commands that look at a run have in common: which run, which design, which other earthquakes. */
#ifndef IMTET_CMD_LOOK_H
#define IMTET_CMD_LOOK_H

#include "cmd/args.h"
#include "report/report.h"

/* The run of the operand, ready to be shown; report_close releases it. */
Status look_open(const Args *args, Report *r, Err *err);

/* The front of the operand's run, and the row that --design names; front_free releases the front, also after a fault.
 */
Status look_design(const Args *args, Front *front, size_t *row, Err *err);

/* --out, or RUN/name. */
Status look_target(const Args *args, const char *name, char path[PATH_MAX], Err *err);

#define OPTIONS_LOOK                                                                                                   \
    {"--design", "ID", NULL, 0, "the design shown in detail: column id of RUN/front.csv, or knee (default)"},          \
        {"--record", "FILE", NULL, 1,                                                                                  \
         "another earthquake for it; may be repeated (default: motion.records, else the built-in ones)"},              \
        {"--floor", "N", NULL, 0, "whose sway is shown over time (default: the middle one)"}, OPTION_MOVED,            \
        OPTION_CHANNEL, OPTION_PGA, OPTION_STRETCH, OPTION_UNIT

#endif
