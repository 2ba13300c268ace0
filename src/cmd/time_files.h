/* cmd/time_files.h -- what `imtet simulate` writes of a response over time: histories, contacts one by one, floor
 * spectra.
 *
 * Every design is simulated again, on its own: the same simulation, to the last bit; for histories and contacts twice,
 * since it may begin anew. results/README.md explains the columns. Files are written whole or not at all, - is stdout.
 *
 * Threads  one */
#pragma once

#include "evaluate/tower.h"

/* The designs, with their numbers and the results that they had. */
typedef struct {
    const Scene *scene;
    const Motion *motion;
    size_t n;
    const SimTask *tasks;     /* (n) */
    const SimResult *results; /* (n) */
    const Designs *designs;   /* whose numbers they have */
    double every_s;           /* --history: [s] at most from row to row; 0: the motion's samples */
} TimeJob;

typedef enum { TIME_CONTACTS, TIME_HISTORY, TIME_SPECTRA, N_TIME_FILES } TimeFile;
Status time_file_write(const TimeJob *job, TimeFile which, const char *path, Err *err);
