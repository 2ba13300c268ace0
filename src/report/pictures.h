/* report/pictures.h -- what a browser makes of a page: its charts as SVG and PNG, or all of it as a PDF.
 *
 * Chromium, found on PATH and started without a shell, opens a page like that of the report, which stands beside what
 * is made of it until then. A picture replaces a file only when it is whole (store/output.h).
 *
 * Errors     no Chromium: STATUS_MISSING, and nothing is written; it may be asked before (browser_check)
 * Ownership  json_t are taken over */
#pragma once

#include <jansson.h>

#include "report/report.h"

Status browser_check(const char *path, Err *err);

/* The page of body (see page_write) as a PDF on A4. */
Status page_print(json_t *run, const char *body, const char *path, Err *err);

/* Saves the drawing of that name (DRAWINGS of web/app/8-paper.js) of `data` as an SVG of that width [px]. */
Status drawing_save(const char *name, json_t *data, int width, const char *path, Err *err);

/* Every picture of the report in a folder, which is made where it is not there. */
Status pictures_of(const Report *r, const char *folder, Err *err);

/* The page of `run` and of the designs that a report shows (NULL: none); body stands in place of the parts of a report
 * (NULL: those). */
Status page_write(FILE *out, json_t *run, const Report *rows, const char *body, Err *err);
