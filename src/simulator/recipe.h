/* simulator/recipe.h -- of what another process opens the same simulator: Problem.recipe is one of these.
 *
 * Plain bytes without pointers; files are named by their paths, which must lead to the same files there (Problem.inputs).
 * Ownership  belongs to the simulator, or to its adapter */
#ifndef IMTET_SIMULATOR_RECIPE_H
#define IMTET_SIMULATOR_RECIPE_H

#include "settings/settings.h"
#include "simulator/tower.h"

typedef struct {
    Settings settings; /* problem.kind says which simulator */
    TowerUse use;      /* of the tower */
} Recipe;

#endif
