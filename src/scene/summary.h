/* scene/summary.h -- the scene in a few figures that an engineer can judge, and what is implausible about them.
 *
 *   base shear   V_i = gamma_i^2 PSa(T_i, zeta) of each mode of the building alone, V = root(sum V_i^2) over its weight
 *   floor mass   row sum of M: what a floor's inertia force is under a uniform acceleration
 *   content      half the sampling rate of the motion: above it the samples hold nothing
 *
 * Threads  no state */
#pragma once

#include "scene/building.h"
#include "motion/motion.h"

typedef struct {
    int n_floors;
    double mass_kg, height_m;
    double floor_mass_min_kg, floor_mass_max_kg;
    int lightest, heaviest;     /* floors, from 1 */
    double period_s[3];         /* the first; 0 where there are fewer */
    double damping[3];          /* [-] of these modes */
    double first_mode_mass;     /* [-] share of the mass */
    const char *note;           /* what of an OpenSees model was skipped; empty: nothing */
    double hardening_raised;    /* [-] of storeys that yield, where building.hardening was too little; 0: it was not */
    double lowest_m, highest_m; /* storeys */
    int heights_assumed;        /* of the built-in tower (scene/building.h) */
    int top_first;              /* its floors look like being given from the top down */
    double base_shear;          /* [-] share of the weight */
    double core_mass_kg;
    double core_hz, timoshenko_hz, euler_bernoulli_hz; /* the core's first mode by core.theory and by either */
    double clamped_hz;                                 /* the same on ground that does not give way */
    int core_modes_within;                             /* whose frequency is within the motion's content */
    double content_hz;
} SceneSummary;

/* motion: prepared. The core with these thicknesses. */
Status scene_summarise(SceneSummary *out, const Building *b, const CoreOptions *core, const BuildingOptions *of,
                       const Motion *motion, double t_base_m, double t_top_m, Err *err);

/* Ranges outside which a warning is given. */
static const double PERIOD_PER_STOREY_MIN_S = 0.03, PERIOD_PER_STOREY_MAX_S = 0.3;
static const double FLOOR_MASS_MIN_KG = 1e3, FLOOR_MASS_MAX_KG = 1e7;
static const double STOREY_MIN_M = 1, STOREY_MAX_M = 30;
static const double DAMPING_MAX = 0.2, PEAK_MAX_G = 3, GAP_MAX_M = 1;

typedef void (*WarnFn)(const char *key, const char *text, void *user);

/* Warnings about the building alone. */
void building_warnings(const Building *b, WarnFn warn, void *user);

/* Which of the first periods of a frame whose floors stretch (building.rigid_floors = off) its full model has
 * otherwise: one node of a floor stands for all of it then. */
static const double PERIOD_ERROR_MAX = 0.01;
Status condensation_warnings(const Building *b, const BuildingOptions *o, WarnFn warn, void *user, Err *err);
void scene_warnings(const SceneSummary *s, const CoreOptions *core, const DesignOptions *design, const Motion *motion,
                    WarnFn warn, void *user);
