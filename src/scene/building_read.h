/* scene/building_read.h -- stiffness, mass and storey heights of a building from its files (scene/building.h has their
 * forms).
 *
 * Ownership  building_read allocates, building_files_free releases, after a failure too. Threads  no state */
#pragma once

#include "base/status.h"
#include "scene/frame.h"
#include "scene/options.h"

typedef struct {
    char note[400];      /* Frame.note */
    FrameFull floors;    /* symmetric and positive definite */
    FrameFull full;      /* of a frame: with building.modes the full model, else the floors with what they miss of the
                       * ground's motion (scene/frame.h); n = 0: the floors are all */
    double *storey_m;    /* (floors.n); NULL: the files have no heights */
    double *yield_drift; /* (floors.n) [-] 0: the file has none; NULL: of none */
} BuildingFiles;

typedef struct {
    double stiffness, mass, length; /* what a unit of K.csv is in N/m, one of M.csv in kg, one of length in m */
} BuildingUnit;

BuildingUnit building_unit(BuildingUnits units);

/* Adds a spring [N/m] between floor j = 0..n-1 and the one below it, or the ground, to K (n, n). */
void storey_spring(int n, int j, double spring, double K[]);

Status building_read(BuildingFiles *b, const BuildingOptions *o, Err *err);
void building_files_free(BuildingFiles *b);

/* Is a file of this name read from the folder of a building? */
int building_reads(const char *name);
