/* sim/options.h -- how a design is simulated: sections [contact] and [sim], and all that a scene is made of.
 *
 * Plain values, SI units. */
#pragma once

#include "scene/options.h"

#define CONTACT_LAW_LIST(X)                                                                                            \
    X(LAW_PAPER, "paper")                                                                                              \
    X(LAW_EXACT, "exact")                                                                                              \
    X(LAW_LANKARANI_NIKRAVESH, "lankarani-nikravesh")                                                                  \
    X(LAW_FLORES, "flores")                                                                                            \
    X(LAW_JANKOWSKI, "jankowski")
typedef enum { CONTACT_LAW_LIST(CHOICE_NAME) } ContactLaw;

typedef struct {
    ContactLaw law;
    double restitution, radius_m, youngs_modulus_pa;
    double bumper_stiffness_n_m; /* 0: none */
    double bumper_damping;       /* [-] damping ratio */
    double bumper_thickness_m, bumper_strain_max;
    NumberList eccentricity; /* [-] e/l and b/l (scene/torsion.h) */
} ContactOptions;

/* The integrators of the model, by the name of the setting; sim/engine.c has a line for each. */
#define ENGINE_LIST(X) X(ENGINE_FAST, "fast") X(ENGINE_CVODE, "cvode")
typedef enum { ENGINE_LIST(CHOICE_NAME) ENGINE_COUNT } Engine;

#define ACCURACY_LIST(X) X(ACCURACY_COARSE, "coarse") X(ACCURACY_STANDARD, "standard") X(ACCURACY_FINE, "fine")
typedef enum { ACCURACY_LIST(CHOICE_NAME) } Accuracy;

#define ROBUST_LIST(X)                                                                                                 \
    X(ROBUST_WORST, "worst")                                                                                           \
    X(ROBUST_MEAN, "mean")                                                                                             \
    X(ROBUST_MEAN_PLUS_SD, "mean_plus_sd")                                                                             \
    X(ROBUST_CVAR, "cvar")
typedef enum { ROBUST_LIST(CHOICE_NAME) ROBUST_QUANTILE /* no word: SimOptions.quantile */ } Robust;

/* Which effects a study has: those that the settings say, or of those that they leave open what the scene needs
 * (analysis/model_choice.h). */
#define MODEL_USE_LIST(X) X(MODEL_AUTO, "auto") X(MODEL_GIVEN, "given")
typedef enum { MODEL_USE_LIST(CHOICE_NAME) } ModelUse;

#define FORCES_LIST(X) X(FORCES_AUTO, "auto") X(FORCES_YES, "yes")
typedef enum { FORCES_LIST(CHOICE_NAME) } Forces;

/* Standard deviations of what is built about what was designed, setting sim.uncertain: of the coefficient of
 * restitution [-], and as shares of the stiffnesses, the damping ratios and the storeys' strength. 0: as designed. */
typedef struct {
    double restitution, contact_stiffness, core_stiffness, building_stiffness, damping, ground_stiffness, strength;
} UncertainOptions;

/* Cost of the destroyed parts of every storey, as shares of the building (evaluate/consequences.h). */
typedef struct {
    double structure, drift_sensitive, acceleration_sensitive;
} RepairOptions;

typedef struct {
    ModelUse model;
    Engine engine;
    Accuracy accuracy;
    double tolerance;         /* a number as sim.accuracy (sim_steps_per_contact); 0: accuracy is one of the presets */
    double steps_per_contact; /* no setting: of a second, finer run; 0: as accuracy and tolerance say */
    double duration_s;        /* 0: the whole motion */
    long replicates;          /* simulations of a design under each record */
    Robust robust;            /* how a design's results under several records become one */
    double tail;              /* of ROBUST_CVAR: share of the simulations */
    RepairOptions repair;     /* of the measure loss */
    double quantile;          /* a number as sim.robust: on the bad side; 0: robust is one of the words */
    UncertainOptions uncertain;
    double gap_tolerance_m; /* standard deviation of a gap as built */
    double filter_hz;       /* cutoff frequency of SimResult.j3_filtered_g */
    int filtered;           /* no setting: who wants it says so */
    int measures_only;      /* no setting: of SimForces what measures are made of, no storeys of the building */
    Forces forces;          /* auto: only where an objective or a limit needs SimResult.forces */
} SimOptions;

/* One structure as built: restitution is added (and stays within 0.05 to 1), the others are factors. */
typedef struct {
    double restitution, contact_stiffness, core_stiffness, building_stiffness, core_damping, building_damping,
        ground_stiffness, strength;
} AsBuilt;

/* Devices in the place of impacts. */
typedef struct {
    double tmd_hz, tmd_damping; /* SCENE_TMD: of the tuned mass, whose mass is the core's */
    double link_ns_m;           /* SCENE_LINKS: [N s/m] of every dashpot between a floor and the core */
} LinearDevice;

/* The parts of a scene, without the ground motion. */
typedef struct {
    BuildingOptions building;
    CoreOptions core;
    ContactOptions contact;
    SimOptions sim;
    DesignOptions design; /* which variables a design x has (scene/design.h) */
} SceneOptions;
