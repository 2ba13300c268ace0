/* store/front_lines.h -- front.csv, generation by generation: numbers cost more to print than to find, so that the line
 * of a design is made once, when it comes onto the front, and kept until it leaves.
 *
 * Life cycle  {0} -> front_lines_follow -> front_lines_put ... -> front_lines_free
 * Threads     one at a time */
#ifndef IMTET_STORE_FRONT_LINES_H
#define IMTET_STORE_FRONT_LINES_H

#include <stdio.h>

#include "moga/search.h"
#include "simulator/schema.h"

typedef struct {
    const Schema *schema; /* borrowed */
    char **line;          /* (n) by design; NULL: not on the front */
    size_t n;
} FrontLines;

/* The front as the search has it now. */
Status front_lines_follow(FrontLines *lines, const Schema *schema, const SearchView *view, Err *err);

/* The whole file. */
void front_lines_put(FILE *f, const void *lines);
void front_lines_free(FrontLines *lines);

#endif
