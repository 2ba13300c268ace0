/* scene/options.h -- what is built and how the ground moves: sections [building], [core], [motion], [design].
 *
 * Plain values, SI units. */
#ifndef IMTET_SCENE_OPTIONS_H
#define IMTET_SCENE_OPTIONS_H

#include "base/option.h"

enum { FLOORS_MAX = 128 }; /* of a building */

/* What the entries of K.csv and M.csv are in; kip_in: kip/in and kip s2/in. */
#define BUILDING_UNITS_LIST(X)                                                                                         \
    X(BUILDING_AUTO, "auto")                                                                                           \
    X(BUILDING_N_M_KG, "N_m_kg")                                                                                       \
    X(BUILDING_KN_M_T, "kN_m_t")                                                                                       \
    X(BUILDING_KN_M_KG, "kN_m_kg")                                                                                     \
    X(BUILDING_N_M_T, "N_m_t")                                                                                         \
    X(BUILDING_MN_M_T, "MN_m_t")                                                                                       \
    X(BUILDING_KIP_IN, "kip_in")
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

#define MOTION_UNIT_LIST(X)                                                                                            \
    X(UNIT_FROM_FILE, "from_file")                                                                                     \
    X(UNIT_M_S2, "m_s2")                                                                                               \
    X(UNIT_CM_S2, "cm_s2")                                                                                             \
    X(UNIT_G, "g")
typedef enum { MOTION_UNIT_LIST(CHOICE_NAME) } MotionUnit;

#define MOTION_BASELINE_LIST(X)                                                                                        \
    X(BASELINE_NONE, "none")                                                                                           \
    X(BASELINE_MEAN, "mean")                                                                                           \
    X(BASELINE_LINEAR, "linear")                                                                                       \
    X(BASELINE_QUADRATIC, "quadratic")
typedef enum { MOTION_BASELINE_LIST(CHOICE_NAME) } MotionBaseline;

#define MOTION_TARGET_LIST(X) X(TARGET_NONE, "none") X(TARGET_EUROCODE8, "eurocode8") X(TARGET_ASCE7, "asce7")
typedef enum { MOTION_TARGET_LIST(CHOICE_NAME) } MotionTarget;

typedef struct {
    char record[OPTION_TEXT_MAX];  /* a file or builtin:NAME */
    char records[OPTION_TEXT_MAX]; /* further ones, a comma list, or none */
    MotionBaseline baseline;
    double highpass_hz, lowpass_hz; /* 0: none */
    double stretch;                 /* t -> stretch t */
    double pga_g, factor;           /* scalings, of which at most one is not at its default (scene/motion_scale.h) */
    double sa_g, sa_period_s;
    MotionTarget target;
    double target_from_s, target_to_s;
    double ec8_ag_g, ec8_s, ec8_tb_s, ec8_tc_s, ec8_td_s;
    double asce7_sds_g, asce7_sd1_g, asce7_tl_s;
    MotionUnit unit;
    char channel[OPTION_TEXT_MAX]; /* name, number or auto */
    double dt_s, resample_dt_s;    /* 0: from the file; 0: never */
    double counts_per_m_s2;        /* gain of a record in counts; 0: not known */
    double peak_error_max;         /* [-] by which the samples may miss the peak that their header states */
} MotionOptions;

typedef struct {
    char variables[OPTION_TEXT_MAX]; /* words (scene/design.h); empty: gaps, thickness */
    long gap_zones, bumper_zones;    /* 0: one per floor */
    double gap_min_m, gap_max_m, thickness_min_m, thickness_max_m;
    double bumper_min_n_m, bumper_max_n_m, side_min_m, side_max_m;
} DesignOptions; /* the design variables and their bounds */

#endif
