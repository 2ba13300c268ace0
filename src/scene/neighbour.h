/* scene/neighbour.h -- another building in the place of the cantilever: neighbours that pound.
 *
 * core.model names a building of any form that building.model has, read with the same options (units, heights,
 * P-delta), condensed to its floors, elastic, with core.damping in every mode. Floors meet by number. It has as many
 * floors as the building or fewer: those of the building above it meet nothing. Floors that meet lie at one height,
 * within LEVELS_M: beyond that slabs would hit columns, which is no contact of this program.
 *
 * In the CoreBeam the nodes above `top` have no mass and no stiffness, and as many modes stand still.
 *
 * Errors  STATUS_BAD_DATA in words. Threads  no state */
#pragma once

#include "scene/building.h"

static const double LEVELS_M = 0.3; /* about the thickness of a slab */

/* Is there one? */
int neighbour_is_given(const CoreOptions *o);

/* Section that thickness and stresses follow: core.section; of a neighbour CORE_EFFECTIVE, which has neither. */
CoreSection core_section(const CoreOptions *o);

/* In words what the core is: the theory of its beam, or core.model. */
const char *core_word(const CoreOptions *o);

/* The core beside or inside building b, of whose options the neighbour is read; thicknesses are those of a beam. */
Status core_make(CoreBeam *c, const CoreOptions *o, const BuildingOptions *of, const Building *b, double t_base_m,
                 double t_top_m, Err *err);
