/* cmd/ida.h -- incremental dynamic analysis: response against intensity, record by record, and its fractiles.
 *
 *   fractile p of the n records at one intensity: straight lines between the order statistics, the i-th at
 *   p = (i - 1) / (n - 1); a simulation that failed counts as infinite, so that a fractile above it has no value
 *
 * Source   Vamvatsikos and Cornell, Earthquake Eng. Struct. Dyn. 31 (2002) 491-514; Hyndman and Fan, Am. Statistician 50
 *          (1996) 361-365, type 7
 * Threads  no state */
#ifndef IMTET_CMD_IDA_H
#define IMTET_CMD_IDA_H

#include "base/json.h"
#include "cmd/evaluations.h"
#include "evaluate/measures.h"

enum { IDA_LEVELS_MAX = 1000, IDA_FRACTILES = 3, IDA_SHOWN = 3 };
extern const double IDA_FRACTILE[IDA_FRACTILES];           /* 0.16, 0.5, 0.84 */
extern const char *const IDA_FRACTILE_WORD[IDA_FRACTILES]; /* "16 %", "median", "84 %" */

/* "0.05:0.05:0.6", from, step and to [g], as levels (IDA_LEVELS_MAX at most); a range ends at `to` or just below. */
Status ida_levels(const char *text, double levels[IDA_LEVELS_MAX], size_t *n, Err *err);

/* Of measure k over the records at intensity l; INFINITY: too many failed. */
double ida_fractile(const Evaluations *e, size_t l, EvaluatedCase which, int k, double p);

/* The first IDA_SHOWN objectives: median, 16 % and 84 % at every intensity, case by case. */
void ida_print(const Evaluations *e, const MeasureOrder *order);
json_t *ida_json(const Evaluations *e);

/* The same objectives of every record, their fractiles and those of the other cases, drawn by gnuplot. */
Status ida_draw(const Evaluations *e, const MeasureOrder *order, const char *path, Err *err);

#endif
