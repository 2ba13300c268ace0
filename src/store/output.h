/* store/output.h -- numbers in files: the fewest digits that read back as the same; beside base/whole_file.h. */
#pragma once

#include "base/whole_file.h"

/* The fewest digits that read back as the same number; nothing for one that is not finite. */
void print_number(FILE *stream, double value);
void print_cells(FILE *stream, size_t n, const double values[]); /* each behind a comma */
void print_list(FILE *stream, size_t n, const double values[]);  /* JSON: [1,2.5,null] */
