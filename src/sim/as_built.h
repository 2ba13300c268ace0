/* sim/as_built.h -- a scene as it was built: options and building with what differs from the design.
 *
 *   restitution r + dr within 0.05 to 1; Young's modulus of the contact, and the bumper's stiffness, times a factor;
 *   Young's modulus of the core times one; K of the building times one, its frequencies with the root of it, mode
 *   shapes and damping ratios kept; damping ratios of building and core times one each; stiffness of the ground under
 *   the core times one; drifts at which storeys yield times one, their strength at the same stiffness
 *
 * Ownership  store: memory of the building's copy, allocated at the first call and used again; the caller frees it.
 *            What is not changed is borrowed from the building
 * Threads    no state */
#pragma once

#include "scene/building.h"
#include "sim/options.h"

static const AsBuilt AS_DESIGNED = {0, 1, 1, 1, 1, 1, 1, 1};

/* Is anything? */
int is_uncertain(const UncertainOptions *u);

void as_built_options(const AsBuilt *built, const SceneOptions *o, SceneOptions *out);
Status as_built_building(const AsBuilt *built, const Building *b, Building *out, double **store, Err *err);
