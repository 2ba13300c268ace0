/* scene/building_svg.h -- a building as a drawing: its frame or its storeys, true to scale, and its first mode shapes.
 *
 * Threads  no state */
#pragma once

#include "scene/building.h"
#include "scene/frame.h"

/* frame NULL: storeys as a stick. */
Status building_svg(FILE *out, const Building *b, const Frame *frame, Err *err);
