/* bench/search/reference.h -- designs on the true front of a problem of families.h, for IGD+.
 *
 * For each of REFERENCES directions: variables that say where on the front stay, the others go from the distance's zero
 * to the least weighted sum of the objectives among the designs that count, by an evolution strategy (1+1) with the
 * rule of one fifth (Rechenberg 1973), from several random designs: no step where the zero itself counts. Of the
 * quadratics all variables move, and the weights are the direction: the convex part of the front. A place on the front that
 * another one dominates moves there; what is dominated is left out.
 *
 * Threads  no state */
#pragma once

#include "bench/search/course.h"

enum { REFERENCES = 200 };

/* c holds them, those that count. */
Status reference_make(const Problem *p, Course *c, Err *err);
