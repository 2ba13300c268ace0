/* evaluate/recipe.h -- of what another process opens the same problem: plain bytes without pointers.
 *
 * Files are named by their paths, which must lead to the same files there (Problem.inputs).
 * Ownership  belongs to the simulator, or to its adapter */
#pragma once

#include "settings/options.h"

/* A scene of a tower: which record, and what it has otherwise than the settings say. */
typedef struct {
    size_t record;
    char setting[120]; /* KEY=VALUE; empty: nothing */
} SceneChange;

typedef struct {
    Settings settings; /* problem.kind says which simulator; of the others the rest is 0 */
    int is_sweep;      /* tower_open_scenes */
    size_t n_records, n_scenes;
    SceneChange scene[]; /* (n_scenes), then paths of the records (n_records, OPTION_TEXT_MAX) */
} Recipe;

static inline size_t recipe_size(size_t n_records, size_t n_scenes)
{
    return sizeof(Recipe) + n_scenes * sizeof(SceneChange) + n_records * OPTION_TEXT_MAX;
}

static inline char *recipe_record(const Recipe *r, size_t i)
{
    return (char *)(r->scene + r->n_scenes) + i * OPTION_TEXT_MAX;
}
