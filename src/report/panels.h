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

/* A frame, or storeys as a stick (frame NULL), with its first mode shapes; an error leaves no *out. */
Status building_drawing(const Building *b, const Frame *frame, int modes, json_t **out, Err *err);
