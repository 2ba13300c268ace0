/* scene/options.h -- what is built: sections [building], [core], [design].
 *
 * Plain values, SI units. */
#pragma once

#include "base/option.h"

enum { FLOORS_MAX = 128 }; /* of a building */
enum { SIDES = 2 };        /* of a floor: [0] right, which it reaches by u > v, [1] left, by u < v */

/* Units of K.csv and M.csv (kip_in: kip/in and kip s2/in), or of an OpenSees model. */
#define BUILDING_UNITS_LIST(X)                                                                                         \
    X(BUILDING_AUTO, "auto")                                                                                           \
    X(BUILDING_N_M_KG, "N_m_kg")                                                                                       \
    X(BUILDING_KN_M_T, "kN_m_t")                                                                                       \
    X(BUILDING_KN_M_KG, "kN_m_kg")                                                                                     \
    X(BUILDING_N_M_T, "N_m_t")                                                                                         \
    X(BUILDING_MN_M_T, "MN_m_t")                                                                                       \
    X(BUILDING_KIP_IN, "kip_in")                                                                                       \
    X(BUILDING_N_MM_T, "N_mm_t")                                                                                       \
    X(BUILDING_KIP_FT, "kip_ft")
typedef enum { BUILDING_UNITS_LIST(CHOICE_NAME) } BuildingUnits;

#define ELASTIC_LIST(X) X(ELASTIC_ONLY, "only") X(ELASTIC_INITIAL, "initial")
typedef enum { ELASTIC_LIST(CHOICE_NAME) } Elastic;

#define DAMPING_MODEL_LIST(X) X(DAMPING_MODAL, "modal") X(DAMPING_RAYLEIGH, "rayleigh")
typedef enum { DAMPING_MODEL_LIST(CHOICE_NAME) } DampingModel;

#define HYSTERESIS_LIST(X) X(HYSTERESIS_BILINEAR, "bilinear") X(HYSTERESIS_BOUC_WEN, "bouc_wen")
typedef enum { HYSTERESIS_LIST(CHOICE_NAME) } Hysteresis;

typedef struct {
    double strength, stiffness; /* [-] per energy, s_s and s_k of sim/storey.h */
} DegradationOptions;

typedef struct {
    char model[OPTION_TEXT_MAX]; /* guyan | appendix | a folder (scene/building.h has its forms) */
    BuildingUnits units;
    DampingModel damping_model;
    NumberList damping;        /* [-] mode by mode, the last for the rest; rayleigh: of two modes */
    NumberList rayleigh_modes; /* two of them, from 1, ascending */
    NumberList heights_m;      /* storey by storey, the last for the rest; of matrices */
    Switch rigid_floors;       /* of a frame */
    Elastic elastic;           /* what yields in an OpenSees model */
    long modes;                /* fixed-interface modes beside the floors; 0: condensed */
    Switch p_delta;
    double yield_drift; /* [-] of the storey's height; 0: a storey yields only where the files say so */
    double hardening;   /* [-] share of a storey's stiffness that is left where it has yielded */
    Hysteresis hysteresis;
    double bouc_wen_exponent; /* [-] */
    DegradationOptions degradation;
} BuildingOptions;

#define CORE_SECTION_LIST(X) X(CORE_BOX, "box") X(CORE_PLATE, "plate") X(CORE_EFFECTIVE, "effective")
typedef enum { CORE_SECTION_LIST(CHOICE_NAME) } CoreSection;

#define CORE_THEORY_LIST(X) X(CORE_TIMOSHENKO, "timoshenko") X(CORE_EULER_BERNOULLI, "euler_bernoulli")
typedef enum { CORE_THEORY_LIST(CHOICE_NAME) } CoreTheory;

#define CORE_WALL_LIST(X) X(WALL_FULL, "full") X(WALL_EFFECTIVE, "effective")
typedef enum { CORE_WALL_LIST(CHOICE_NAME) } CoreWall;

typedef struct {
    CoreSection section;
    CoreTheory theory;
    CoreWall wall;
    double wall_factor; /* a number as core.wall: share of the stiffness; 0: wall is one of the words */
    double stiffeners;  /* [-] mass of them over that of the walls */
    double width_m, damping, youngs_modulus_pa, poisson, density_kg_m3;
    char model[OPTION_TEXT_MAX];      /* another building in its place (scene/neighbour.h), or none */
    char foundation[OPTION_TEXT_MAX]; /* fixed, or words of scene/foundation.h */
    double foundation_factor;         /* of the ground's stiffness */
    double anchors;                   /* of a design, in the place of those of `foundation`; 0: these */
    double wall_share[FLOORS_MAX];    /* of its stiffness that a storey has as it is simulated; 0: all */
    NumberList areas_m2, inertias_m4, shear_areas_m2, masses_kg; /* at base and top, or by storey; 0, none: no shear
                                                                  * deformation, density times area */
} CoreOptions;

#define GAP_SIDES_LIST(X)                                                                                              \
    X(GAPS_BOTH, "both")                                                                                               \
    X(GAPS_LEFT, "left")                                                                                               \
    X(GAPS_RIGHT, "right")                                                                                             \
    X(GAPS_EACH, "each")
typedef enum { GAP_SIDES_LIST(CHOICE_NAME) } GapSides;

/* Prices of a stop, the bumper in it, a link, tonnes, and a MN of anchors; any currency. */
typedef struct {
    double gap, bumper, link, tuned_mass_t, core_t, anchor_mn;
} PriceOptions;

typedef struct {
    char variables[OPTION_TEXT_MAX]; /* words (scene/design.h); empty: gaps, thickness */
    char devices[OPTION_TEXT_MAX];   /* words, of which each zone has one; empty, all: whatever variables name */
    GapSides gap_sides;
    long gap_zones, bumper_zones, link_zones, device_zones; /* 0: one per floor */
    NumberList gap_m, thickness_m, bumper_n_m, width_m;     /* each from, to */
    double step_gap_m;                                      /* gaps are multiples of it; 0: any */
    NumberList step_thickness_m;                            /* plates that are sold; none: any */
    NumberList link_n_s_m, mass_kg, mass_hz, mass_damping;
    double link_exponent; /* [-] */
    double anchors_max;   /* of core.foundation, no setting of its own */
    PriceOptions prices;
} DesignOptions; /* the design variables and their bounds */
