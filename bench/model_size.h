/* bench/model_size.h -- error and time of `fast` at `standard` over the size of its model.
 *
 *   core modes + springs  so many modes of the core are followed, the others act as springs in every contact
 *   core modes cut        the others are left out
 *   building modes cut    so many modes of the building; the core as `standard` has it
 *
 * Over designs of irregular gaps on the window of a benchmark case; errors against `fine` with all modes.
 *
 * Threads  none: timings want the machine to themselves */
#ifndef IMTET_BENCH_MODEL_SIZE_H
#define IMTET_BENCH_MODEL_SIZE_H

#include <stdio.h>

#include "bench/timed_run.h"

enum { MODEL_SIZES_MAX = 40 };

typedef struct {
    const char *series;
    int modes;
    double seconds;                /* mean of the designs */
    double error;                  /* exceeded by one design in ten: the largest of a design's errors */
    double each[BENCH_OBJECTIVES]; /* the same of each objective */
} ModelSizeRow;

typedef struct {
    int n, designs;
    double duration;
    ModelSizeRow row[MODEL_SIZES_MAX];
} ModelSize;

/* Leaves the model of bench_case at another design. */
Status model_size_run(ModelSize *m, BenchCase *bench_case, const SceneOptions *s, Err *err);

void model_size_write_markdown(const ModelSize *m, FILE *out);
void model_size_write_csv(const ModelSize *m, FILE *out); /* rows of the table of sweep_write_csv */

#endif
