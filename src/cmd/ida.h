/* cmd/ida.h -- an incremental dynamic analysis (analysis/evaluations.h) as a table, JSON and a picture. */
#ifndef IMTET_CMD_IDA_H
#define IMTET_CMD_IDA_H

#include "analysis/evaluations.h"
#include "base/json.h"

enum { IDA_FRACTILES = 3, IDA_SHOWN = 3 };
extern const double IDA_FRACTILE[IDA_FRACTILES];           /* 0.16, 0.5, 0.84 */
extern const char *const IDA_FRACTILE_WORD[IDA_FRACTILES]; /* "16 %", "median", "84 %" */

/* The first IDA_SHOWN objectives: median, 16 % and 84 % at every intensity, case by case. */
void ida_print(const Evaluations *e, const MeasureOrder *order);
json_t *ida_json(const Evaluations *e);

/* The same objectives of every record, their fractiles and those of the other cases, drawn by gnuplot. */
Status ida_draw(const Evaluations *e, const MeasureOrder *order, const char *path, Err *err);

#endif
