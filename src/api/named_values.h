/* api/named_values.h -- what is behind an imtet_result: named tables of numbers, and texts.
 *
 * Ownership  all of it belongs to the result, the names too
 * Errors     STATUS_NO_MEMORY; the first fault is kept in the result and told by result_finish: filling one is a list
 *            of calls */
#pragma once

#include "api/failure.h"
#include "imtet_scene.h"

Status result_create(imtet_result **out, Err *err);

/* A table of that name, for its numbers to be written; NULL: there was no memory. */
double *result_table(imtet_result *r, const char *name, size_t rows, size_t columns);
void result_numbers(imtet_result *r, const char *name, size_t n, const double numbers[]);
void result_text(imtet_result *r, const char *name, const char *text);

/* Frees it where something did not fit, or where `status` is a fault, and then *out is NULL. */
Status result_finish(imtet_result **out, Status status, Err *err);
