/* bench/search/course.h -- all evaluations of one search in their order.
 *
 * Life cycle  course_create -> course_add ... -> course_free
 * Shapes      row-major F (n, n_obj), minimised
 * Threads     one Course per thread */
#pragma once

#include "evaluate/problem.h"

typedef struct {
    size_t n, n_max, n_obj;
    double *F;
    double *cpu_s;         /* (n) [s] processor time of the search until then, simulations of no cost among it */
    unsigned char *counts; /* (n) it succeeded and keeps every limit */
    double start_s;
} Course;

Status course_create(Course *c, size_t n_max, size_t n_obj, Err *err);
void course_free(Course *c); /* a Course of zeros is fine */
void course_add(Course *c, const double f[], int counts);
