/* evaluate/recipe.h -- of what another process opens the same problem: Problem.recipe begins with its kind.
 *
 * Plain bytes without pointers; files are named by their paths, which must lead to the same files there (Problem.inputs).
 * Ownership  belongs to the simulator, or to its adapter */
#ifndef IMTET_EVALUATE_RECIPE_H
#define IMTET_EVALUATE_RECIPE_H

#include "settings/options.h"

typedef enum { RECIPE_SIMULATOR, RECIPE_EVALUATIONS /* cmd/evaluations.h */ } RecipeKind;

typedef struct {
    RecipeKind kind;   /* RECIPE_SIMULATOR */
    Settings settings; /* problem.kind says which simulator */
    int use;           /* of the tower: TowerUse */
} Recipe;

#endif
