/* report/thin.h -- which designs of a very large front a page shows.
 *
 * All of a front that has no more than `most`. Else those with the lowest and the highest value of every objective and
 * variable, the designs that are to be kept, polished ones, and the others evenly in the order of their evaluation:
 * ranges stay as they are, and where the front is dense there is more of it.
 *
 * Threads  no state */
#ifndef IMTET_REPORT_THIN_H
#define IMTET_REPORT_THIN_H

#include "store/run.h"

/* Rows of the run, ascending, into rows (n_front); returns how many: `most`, and what has to be kept beyond that.
 * kept: rows of the run, on its front or not. */
size_t thin_front(const Run *run, size_t most, size_t n_kept, const size_t kept[], size_t rows[]);

#endif
