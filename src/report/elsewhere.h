/* report/elsewhere.h -- the other earthquakes of a design: the further records of its study first, then what was given,
 * and where there is neither the built-in motions that the study does not use; each once, by its content.
 *
 * Ownership  the sources are copied into the list, which stays where it is while they are used
 * Errors     a folder or list that cannot be read; more than ELSEWHERE_MAX: STATUS_USAGE */
#pragma once

#include "settings/options.h"

enum { ELSEWHERE_MAX = 127 }; /* those of the largest study and as many again */

typedef struct {
    size_t n, n_seen; /* n_seen: with the first record of the study, which the design is simulated under anyway */
    char own[OPTION_TEXT_MAX]; /* that one */
    const char *source[ELSEWHERE_MAX];
    uint64_t content[ELSEWHERE_MAX + 1]; /* hashes: of own, then of every source */
    FILE *notes; /* the caller's, for a line on each record that is left out as a copy; NULL: none is wanted */
    char text[ELSEWHERE_MAX][OPTION_TEXT_MAX];
} OtherRecords;

/* Zeroed before; then what is given, and the rest at the end. */
Status elsewhere_of_study(OtherRecords *r, const MotionOptions *study, Err *err);
Status elsewhere_add(OtherRecords *r, const char *source, Err *err);
Status elsewhere_otherwise(OtherRecords *r, const MotionOptions *study, Err *err);
