/* scene/options.h -- what is built: sections [building], [core], [design].
 *
 * Plain values, SI units. */
#ifndef IMTET_SCENE_OPTIONS_H
#define IMTET_SCENE_OPTIONS_H

#include "base/option.h"

enum { FLOORS_MAX = 128 }; /* of a building */

/* What the entries of K.csv and M.csv are in, kip_in: kip/in and kip s2/in; or an OpenSees model. */
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

#define DAMPING_MODEL_LIST(X) X(DAMPING_MODAL, "modal") X(DAMPING_RAYLEIGH, "rayleigh") X(DAMPING_TABLE, "table")
typedef enum { DAMPING_MODEL_LIST(CHOICE_NAME) } DampingModel;

typedef struct {
    char model[OPTION_TEXT_MAX]; /* guyan | appendix | a folder (scene/building.h has its forms) */
    BuildingUnits units;
    DampingModel damping_model;
    double damping;                       /* [-] of every mode, or of two (rayleigh) */
    char rayleigh_modes[OPTION_TEXT_MAX]; /* two of them, from 1 */
    char damping_table[OPTION_TEXT_MAX];  /* [-] mode by mode, or none */
    double first_storey_m, storey_m;
    char heights_m[OPTION_TEXT_MAX]; /* storey by storey, or none */
    Switch rigid_floors;             /* of a frame */
    long modes;                      /* fixed-interface modes beside the floors; 0: condensed */
    Switch p_delta;
} BuildingOptions;

#define CORE_SECTION_LIST(X) X(CORE_BOX, "box") X(CORE_PLATE, "plate") X(CORE_EFFECTIVE, "effective")
typedef enum { CORE_SECTION_LIST(CHOICE_NAME) } CoreSection;

#define CORE_THEORY_LIST(X) X(CORE_TIMOSHENKO, "timoshenko") X(CORE_EULER_BERNOULLI, "euler_bernoulli")
typedef enum { CORE_THEORY_LIST(CHOICE_NAME) } CoreTheory;

typedef struct {
    CoreSection section;
    CoreTheory theory;
    double side_m, width_m, damping, youngs_modulus_pa, poisson, density_kg_m3;
    double area_base_m2, area_top_m2, inertia_base_m4, inertia_top_m4;
    double shear_area_base_m2, shear_area_top_m2; /* 0: no shear deformation */
    char areas_m2[OPTION_TEXT_MAX], inertias_m4[OPTION_TEXT_MAX], masses_kg[OPTION_TEXT_MAX]; /* by storey, or none */
} CoreOptions;

typedef struct {
    char variables[OPTION_TEXT_MAX]; /* words (scene/design.h); empty: gaps, thickness */
    long gap_zones, bumper_zones;    /* 0: one per floor */
    double gap_min_m, gap_max_m, thickness_min_m, thickness_max_m;
    double bumper_min_n_m, bumper_max_n_m, side_min_m, side_max_m;
} DesignOptions; /* the design variables and their bounds */

#endif
