/* api/failure.h -- from the library's own errors to those of include/imtet.h.
 *
 * Threads  no state */
#pragma once

#include "base/status.h"
#include "imtet.h"

/* The status of err, which is copied to `error`; NULL is fine. */
imtet_status api_status(Status status, const Err *err, imtet_error *error);

/* Numbers must be finite: "WHAT: number 3 is nan; WHAT TO DO". */
Status api_check_finite(const char *what, size_t n, const double x[], const char *cure, Err *err);

/* "section.key=value" each, NULL behind the last; list NULL: none. */
typedef struct Settings Settings;
Status api_settings(Settings *s, const char *const list[], Err *err);
