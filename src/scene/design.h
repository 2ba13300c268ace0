/* scene/design.h -- designs read from a CSV file.
 *
 *   gap_01_m,...,gap_NN_m,t_base_m,t_top_m        one column per floor, bottom floor first, then the core's thickness
 *   0.05,...,0.05,0.012,0.0064                    any number of rows
 *
 * Every fault names file, line and column. A negative or non-finite gap and a thickness that is not positive are refused;
 * t_top_m > t_base_m is let pass; the caller judges.
 *
 * Ownership  design_read allocates, design_free releases (an empty Designs is fine). */
#ifndef IMTET_SCENE_DESIGN_H
#define IMTET_SCENE_DESIGN_H

#include <stddef.h>

#include "base/status.h"
#include "base/table.h"

typedef struct {
    size_t n;
    int n_floors;
    double *x; /* [m] (n, n_floors + 2) */
    int *line; /* (n) of the file */
    long *id;  /* (n) as the run that they are of numbers them; NULL: designs of a file */
} Designs;

/* Name of variable j = 0..n_floors+1. */
void design_variable_name(int n_floors, int j, char name[TABLE_NAME_MAX]);

Status design_read(Designs *d, const char *path, int n_floors, Err *err);

/* The same of a table that is read already; its numbers pass over to the designs. */
Status design_of_table(Designs *d, Table *t, const char *path, int n_floors, Err *err);
void design_free(Designs *d);

#endif
