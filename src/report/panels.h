/* report/panels.h -- drawings as the page's charts take them (panels of web/app/8-paper.js), as JSON.
 *
 *   drawing   {"title", "names": [[words, colour, mark] of the legend], "height" [px], "columns": [[panel]]}
 *   panel     {"title", "x": axis, "y": axis, "marks": [mark]}
 *   mark      {"mark": "line", "dot" or "text", "x": [], "y": [], ...}, the rest by the names of Observable Plot
 *
 * Ownership  the caller's reference; json_t that are given are taken over
 * Threads    no state */
#pragma once

#include <jansson.h>

#include "report/report.h"
#include "scene/building.h"
#include "scene/frame.h"

/* How a case is drawn everywhere (SCENES of web/app/1-run.js). */
typedef struct {
    const char *colour, *mark, *symbol;
} CaseLook;
extern const CaseLook CASE_LOOK[N_SCENES];

json_t *name_of(const char *words, const char *colour, const char *mark); /* of the legend */
json_t *drawing(const char *title, json_t *names, int height, json_t *columns);
json_t *panel(const char *title, json_t *x, json_t *y, json_t *marks);

/* A line, y (n) over x (n), width in px. */
json_t *curve(size_t n, const double x[], const double y[], const char *colour, double width);
json_t *dashed(json_t *curve);

/* A frame, or storeys as a stick (frame NULL), with its first mode shapes; an error leaves no *out. */
Status building_drawing(const Building *b, const Frame *frame, int modes, json_t **out, Err *err);
