/* scene/reduction.h -- fewer degrees of freedom for the full model of a building, and which of its modes is which.
 *
 * Craig-Bampton (AIAA J. 6 (1968) 1313): floors f, the others i, ground motion r
 *
 *   T = [1 0; Psi Phi],   Psi = -Kii^-1 Kif,   Kii phi_k = mu_k^2 Mii phi_k  the lowest of them,   K' = T' K T,  M' =
 *   T' M T
 *
 * With no phi it is Guyan reduction, with all of them the full model. One more shape is what span T misses of r, so
 * that a ground at rest relative to the building accelerates every floor by a, as in the full model, whatever is left
 * out.
 *
 * Threads  no state */
#pragma once

#include "scene/frame.h"

/* Allocates out; frame_full_free releases it. modes: fixed-interface modes that are kept, where there are so many. */
Status reduction_craig_bampton(const FrameFull *full, int n_floors, long modes, FrameFull *out, Err *err);
