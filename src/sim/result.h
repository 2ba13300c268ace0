/* sim/result.h -- result of a simulation: the response to one ground motion, and the state sample by sample.
 *
 * Energies in joules. Threads  no state */
#pragma once

#include "scene/building.h"
#include "sim/options.h"

#define RUN_OUTCOME_LIST(X)                                                                                            \
    X(OK, "ok")                                                                                                        \
    X(NOT_FINITE, "the response is not finite")                                                                        \
    X(OUT_OF_STEPS, "the integrator ran out of steps")                                                                 \
    X(ENERGY_BALANCE, "the energy balance does not close")                                                             \
    X(ENGINE_FAILED, "the integrator failed")
typedef enum {
#define X(name, words) RUN_##name,
    RUN_OUTCOME_LIST(X)
#undef X
} RunOutcome;
const char *run_outcome_words(RunOutcome outcome);

/* One contact of a floor with one side of the core. */
typedef struct {
    int floor, side;           /* from 0; sign(u - v) */
    int open;                  /* still open where the run ended: no rebound */
    double t, duration;        /* [s] */
    double approach, rebound;  /* [m/s] relative speeds at onset and end */
    double force, indentation; /* [N], [m] largest */
    double impulse, lost;      /* [N s], [J] energy that the law dissipated */
} SimContact;
typedef void (*SimContactFn)(const SimContact *contact, void *user);

/* Forces, where they are asked for (sim/force_monitor.h has the formulas); peaks are magnitudes, NAN where the scene
 * has no such part. Storeys and floors from 0. */
typedef struct {
    double contact_force_n[SIDES][FLOORS_MAX], contact_impulse_ns[SIDES][FLOORS_MAX];
    double indentation_m[SIDES][FLOORS_MAX];
    long contacts[SIDES][FLOORS_MAX];
    double contact_force_max_n;

    double core_shear_n[FLOORS_MAX], core_moment_nm[FLOORS_MAX]; /* per storey; the moment at its foot */
    double core_base_shear_n, core_overturning_nm, core_top_m;
    double base_rotation_rad, base_translation_m; /* of the core's foundation; NAN: fixed */
    double uplift_ratio; /* overturning moment over that at which the foundation begins to lift; NAN: no radius known */
    double anchor_force_n; /* by which anchors hold the foundation down; where it never lifts, what that takes */
    int stress_known;      /* the section has a shape: box or plate */
    double core_storey_stress_pa[FLOORS_MAX], core_stress_pa, core_shear_stress_pa;
    int core_stress_storey;
    int buckling_known;                                                /* the section has walls: box */
    double core_buckling_pa[FLOORS_MAX], core_slenderness[FLOORS_MAX]; /* critical stress; clear width / thickness */
    double core_buckling_ratio;         /* largest stress / critical stress of a storey */
    double core_wall_share[FLOORS_MAX]; /* share of the stiffness of its walls that the stress leaves */
    double core_wall_share_off;         /* largest difference of these shares to those of the simulation, over these */

    /* with SimOptions.measures_only of the building the base alone, no velocities: NAN */
    double building_shear_n[FLOORS_MAX], building_base_shear_n, building_overturning_nm;
    double base_shear_n, base_shear_ratio, overturning_nm; /* of building and core; over the weight of the floors */
    double peak_velocity_m_s[FLOORS_MAX];                  /* of the floors relative to the ground */
} SimForces;

enum { CHANCES_MAX = 4 };

/* Peaks of a link or the tuned mass: largest distance across it [m], largest force [N]. */
typedef struct {
    double stroke, force;
} DevicePeak;

/* Largest of every floor or storey of a neighbour, and of them all; named as in SimResult. */
typedef struct {
    int n; /* floors; 0: there is no neighbour */
    double displacement_m[FLOORS_MAX], drift_m[FLOORS_MAX], acceleration_g[FLOORS_MAX], peak_drift_ratio[FLOORS_MAX],
        filtered_g[FLOORS_MAX];
    double j1_m, j2_m, j3_g, j3_filtered_g, drift_ratio_max;
} FloorPeaks;

typedef struct {
    RunOutcome outcome;
    char reason[160]; /* empty when outcome is RUN_OK */

    double j1_m, j2_m, j3_g;              /* max |u|, max interstorey drift, max absolute acceleration / 9.81 */
    double ed1_pct, ed5_10_pct, edcs_pct; /* shares of input_energy_j dissipated by modes 1, 5..10, the core;
                                             not numbers where it is not positive */
    double mcore_kg;
    double input_energy_j;       /* - int a (1'M u' + 1'Mc v') dt */
    double energy_balance_error; /* |input - kinetic - strain - damped - contacts| / input */
    double settled_s;            /* from here on no contact was followed: too little energy was left */
    long closings[FLOORS_MAX];   /* of the gap of every floor, on either side */
    long impacts, v0_limited;    /* contact onsets on all floors; those slower than the lower limit of v0 */

    int n_floors, n_modes;
    double peak_displacement_m[FLOORS_MAX], peak_drift_m[FLOORS_MAX], peak_acceleration_g[FLOORS_MAX];
    double drift_ratio[FLOORS_MAX], drift_ratio_max;  /* [-] peak interstorey drift over the storey's height */
    int drift_ratio_storey;                           /* of the largest, from 0 */
    int yields;                                       /* storeys of the building may: */
    double hysteresis_j, ed_hysteresis_pct;           /* dissipated by them; of input_energy_j */
    double ductility;                                 /* [-] largest drift over yield drift */
    double plastic_drift_m[FLOORS_MAX];               /* of every storey at the end */
    double residual_drift_m[FLOORS_MAX];              /* of the state of rest that follows */
    double plastic_drift_ratio, residual_drift_ratio; /* [-] the largest magnitudes over the storey's height */
    double mode_share_pct[FLOORS_MAX];                /* of input_energy_j, dissipated by each building mode */
    double contact_loss_j, contact_stored_j, clamp_j; /* lost in contacts, still stored, removed by the no-tension
                                                         condition */
    double damped_building_j, damped_core_j, kinetic_strain_j; /* the last at the end of the run */
    double indentation_max_m, indentation_ratio;               /* of the steel; [-] over the contact's radius */
    double bumper_compression_m, bumper_strain; /* largest; [-] over the bumper's thickness; 0: no bumper */
    int bumper_bottoms_out;                     /* the strain exceeds ContactOptions.bumper_strain_max */
    double contact_pressure_pa;                 /* largest in the middle of a contact */
    int contact_yields;                         /* it begins to yield below the surface */
    double stroke_m, dashpot_n;                 /* largest distance across a device, largest force of one */
    double mat_rotation_rad;                    /* largest, of the mat of a core that lifted; 0: it did not */
    DevicePeak device[FLOORS_MAX + 1];          /* of every floor's link; the last: of the tuned mass */
    int n_devices;                              /* stops, links of both kinds, tuned masses */
    double cost;                                /* of these and of the core, by DesignOptions.prices */
    double device_loss_j, ed_devices_pct;       /* dissipated by devices; of input_energy_j */
    long steps, force_evaluations;              /* what the run cost */
    int repeated;   /* times the run was repeated with shorter steps, its energy balance open */
    double seconds; /* wall time */

    int filtered_known; /* it was asked for: SimOptions.filtered */
    double peak_filtered_g[FLOORS_MAX],
        j3_filtered_g;          /* as peak_acceleration_g behind a low-pass (sim/floor_filter.h) */
    RepairOptions repair;       /* SimOptions.repair */
    double rate_per_year;       /* of such events, times the records of which a mean is taken, set by who asks; 0: not
                                   known */
    double chance[CHANCES_MAX]; /* 1 where a limit of the search is exceeded, set by who asks (evaluate/measures.h) */
    int forces_known;           /* they were asked for: SimOptions.forces */
    SimForces forces;
    FloorPeaks neighbour;
} SimResult;

/* Parts of a result beside its measures (evaluate/measures.h), by name: of the scene, of every floor or
 * storey, of every mode, or of every floor on both sides of the core, u > v first. A storey counts from 1. */
typedef enum {
    PART_NUMBER,
    PART_LONG,
    PART_INT,
    PART_STOREY,
    PART_FLAG,
    PART_FLOORS,
    PART_MODES,
    PART_SIDES,
    PART_COUNTS,   /* as PART_SIDES, of long */
    PART_NEIGHBOUR /* of the neighbour's floors */
} PartShape;

typedef struct {
    const char *name; /* key in JSON, name in the library */
    PartShape shape;
    unsigned needs;
    size_t at;
} ResultPart;
extern const ResultPart RESULT_PARTS[]; /* ends with one that has no name */

/* Its values (rows, n), for which there is room for SIDES * FLOORS_MAX; returns n, 0: the scene has no such part.
 * scene: what there is of it (SceneCase.has, sim/cases.h). */
size_t result_part(const SimResult *r, unsigned scene, const ResultPart *part, double values[], size_t *rows);

/* Hertz's theory requires an indentation that is small against the radius. Beyond it the figures are those of the
 * model, but the model is no longer that of two bodies of steel. */
#define INDENTATION_RATIO_MAX 0.1
static inline int beyond_contact_law(const SimResult *r)
{
    return r->indentation_ratio > INDENTATION_RATIO_MAX;
}

/* The foundation of the core lifts, or anchors keep it from that. */
static inline int foundation_lifts(const SimResult *r)
{
    return r->forces_known && r->forces.uplift_ratio > 1;
}

/* That in words: how far it turns, or what holds it. Returns text. */
enum { UPLIFT_WORDS_MAX = 160 };
const char *uplift_words(const SimResult *r, char text[UPLIFT_WORDS_MAX]);

/* The state at one instant: modes 0..n_building-1 are the building's, the others the core's, each group padded with
 * idle ones. Energies since the start, as in SimResult; what the mode q has is (q'^2 + omega^2 q^2) / 2. */
typedef struct {
    double t, spacing; /* [s]; from one sample to the next */
    double ground;     /* [m/s2] */
    int n_modes, n_building;
    const double *omega, *q, *v; /* (n_modes) [rad/s], [m sqrt(kg)], [m sqrt(kg)/s] */
    const double *force;         /* (n_floors) [N] of the contacts on the floors; NULL: not known */
    const double *plastic;       /* (n_floors) [m] plastic drifts of the storeys; NULL: none yields */
    double mat_nm;               /* [N m] F of the mat of a core that lifts (scene/uplift.h) */
    const double *u; /* (n_floors) displacements, of a sample for peaks, which has no q, v and force; else NULL */
    const double *damped_j;     /* (n_modes) */
    double input_j, contacts_j; /* by the ground; taken by the contacts: lost, stored, clamped; and by storeys
                                    that yield, less what K u has of them too much */
} SimSample;

/* Called at t = 0 and then every `spacing`, again from t = 0 when the run is repeated with shorter steps. */
typedef void (*SimSampleFn)(const SimSample *sample, void *user);

/* Is a stretch of no interest in which the floors accelerate by no more than this (n_floors) [m/s2], absolute? Then its
 * samples may be left out. */
typedef int (*SimSkipFn)(const double acceleration[], void *user);
