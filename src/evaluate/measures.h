/* evaluate/measures.h -- the numbers by which a design is judged: names, units, senses and where they come from, in one
 * table. Any of them may be an objective (search.objectives) or be limited (search.limits).
 *
 * Internally every objective is minimised, f = sense * value, while every file and every table shows the natural value.
 * Measures of yielding are NAN for an elastic building.
 * Measures that need forces or the filter are computed only on request (sim.forces, or as an objective or a limit).
 * Where a measure is not computed, or the scene does not have it, its value is NAN: an empty cell, never 0. Formulas:
 * docs/theory.md.
 *
 * A new one goes to the end: a row here, and its value in SimResult (sim/result.h). Each is a column of a run by its
 * name; runs from before it lack it.
 *
 * Threads  pure functions */
#pragma once

#include "evaluate/consequences.h"
#include "evaluate/evaluation.h"

/* What a measure needs beside a simulation; a set of bits. */
enum {
    NEEDS_NOTHING = 0,
    NEEDS_FORCES = 1, /* any of SimForces */
    NEEDS_FILTER = 2,
    NEEDS_YIELDING = 4,     /* a storey that may */
    NEEDS_TURNING = 8,      /* a core on ground that turns */
    NEEDS_RADIUS = 16,      /* of its foundation */
    NEEDS_SHAPE = 32,       /* of the core's section */
    NEEDS_WALLS = 64,       /* of a box */
    NEEDS_FEW_FORCES = 128, /* no shears of storeys of the building above the first, no velocities: 6 % less time */
    NEEDS_NEIGHBOUR = 512,  /* another building in the place of the core */
    IS_BORNE = 256          /* needs nothing; the building or the core has to bear it: report and dossier list it */
};

/* id, name, unit, sense (+1: less is better, -1: more is better), needs, value of a SimResult *r; title, unit ("": a
 * number) and factor to that unit for people; what it is. The first PAPER_OBJECTIVES are those of the paper. */
#define MEASURE_LIST(X)                                                                                                \
    X(J1, "j1_m", "m", 1, NEEDS_NOTHING, r->j1_m, "J1 displacement", "m", 1, "largest floor displacement")             \
    X(J2, "j2_m", "m", 1, NEEDS_NOTHING, r->j2_m, "J2 interstorey drift", "m", 1, "largest interstorey drift")         \
    X(J3, "j3_g", "g", 1, NEEDS_NOTHING, r->j3_g, "J3 acceleration", "g", 1, "largest floor acceleration")             \
    X(ED1, "ed1_pct", "%", 1, NEEDS_NOTHING, r->ed1_pct, "mode 1 share", "%", 1,                                       \
      "share of the input dissipated by the first building mode")                                                      \
    X(ED5_10, "ed5_10_pct", "%", -1, NEEDS_NOTHING, r->ed5_10_pct, "modes 5–10 share", "%", 1,                         \
      "share dissipated by building modes 5 to 10")                                                                    \
    X(EDCS, "edcs_pct", "%", -1, NEEDS_NOTHING, r->edcs_pct, "core share", "%", 1, "share dissipated by the core")     \
    X(MCORE, "mcore_kg", "kg", 1, NEEDS_NOTHING, r->mcore_kg, "core mass", "t", 1e-3, "mass of the core")              \
    X(INPUT, "input_energy_j", "J", 1, NEEDS_NOTHING, r->input_energy_j, "input energy", "MJ", 1e-6,                   \
      "energy that the ground put in")                                                                                 \
    X(BALANCE, "energy_balance_error", "-", 1, NEEDS_NOTHING, r->energy_balance_error, "energy balance error", "", 1,  \
      "of the energy balance, as a share of the input")                                                                \
    X(IMPACTS, "impacts", "-", 1, NEEDS_NOTHING, (double)r->impacts, "impacts", "", 1, "closings of any gap")          \
    X(DRIFT_RATIO, "drift_ratio", "-", 1, IS_BORNE, r->drift_ratio_max, "drift ratio", "%", 100,                       \
      "largest interstorey drift over the height of its storey")                                                       \
    X(INDENTATION, "indentation_ratio", "-", 1, IS_BORNE, r->indentation_ratio, "indentation / radius", "", 1,         \
      "largest indentation over contact.radius_m")                                                                     \
    X(BEYOND_LAW, "beyond_contact_law", "-", 1, NEEDS_NOTHING, (double)beyond_contact_law(r), "beyond contact law",    \
      "", 1, "1: it is above 0.1, where Hertz's law no longer holds")                                                  \
    X(PRESSURE, "contact_pressure_pa", "Pa", 1, IS_BORNE, r->contact_pressure_pa, "contact pressure", "GPa", 1e-9,     \
      "largest pressure in the middle of a contact, by Hertz")                                                         \
    X(BUMPER_STRAIN, "bumper_strain", "-", 1, IS_BORNE, r->bumper_strain, "bumper strain", "%", 100,                   \
      "largest compression of a bumper over its thickness; 0: steel on steel")                                         \
    X(CONTACT_FORCE, "contact_force_max_n", "N", 1, NEEDS_FEW_FORCES | IS_BORNE, r->forces.contact_force_max_n,        \
      "contact force", "MN", 1e-6, "largest contact force of a floor")                                                 \
    X(CORE_SHEAR, "core_base_shear_n", "N", 1, NEEDS_FEW_FORCES | IS_BORNE, r->forces.core_base_shear_n,               \
      "core base shear", "MN", 1e-6, "base shear of the core")                                                         \
    X(CORE_OVERTURNING, "core_overturning_nm", "N m", 1, NEEDS_FEW_FORCES | IS_BORNE, r->forces.core_overturning_nm,   \
      "core overturning", "MN m", 1e-6, "overturning moment of the core about its base")                               \
    X(CORE_STRESS, "core_stress_pa", "Pa", 1, NEEDS_FEW_FORCES | NEEDS_SHAPE | IS_BORNE, r->forces.core_stress_pa,     \
      "core stress", "MPa", 1e-6, "largest bending stress of the core")                                                \
    X(CORE_BUCKLING, "core_buckling_ratio", "-", 1, NEEDS_FEW_FORCES | NEEDS_WALLS | IS_BORNE,                         \
      r->forces.core_buckling_ratio, "stress / buckling", "", 1,                                                       \
      "largest bending stress over the buckling stress of the bare wall")                                              \
    X(BUILDING_SHEAR, "building_base_shear_n", "N", 1, NEEDS_FEW_FORCES | IS_BORNE, r->forces.building_base_shear_n,   \
      "building base shear", "MN", 1e-6, "base shear of the building")                                                 \
    X(BASE_SHEAR, "base_shear_n", "N", 1, NEEDS_FEW_FORCES | IS_BORNE, r->forces.base_shear_n, "base shear", "MN",     \
      1e-6, "base shear of building and core")                                                                         \
    X(J3_FILTERED, "j3_filtered_g", "g", 1, NEEDS_FILTER | IS_BORNE, r->j3_filtered_g, "J3 filtered", "g", 1,          \
      "largest floor acceleration behind a low-pass of sim.filter_hz")                                                 \
    X(BASE_ROTATION, "base_rotation_rad", "rad", 1, NEEDS_FEW_FORCES | NEEDS_TURNING | IS_BORNE,                       \
      r->forces.base_rotation_rad, "base rotation", "mrad", 1e3, "rotation of the core's foundation")                  \
    X(UPLIFT, "uplift_ratio", "-", 1, NEEDS_FEW_FORCES | NEEDS_RADIUS | IS_BORNE, r->forces.uplift_ratio,              \
      "moment / uplift", "", 1,                                                                                        \
      "overturning moment of the core over the moment at which its foundation begins to lift")                         \
    X(DUCTILITY, "ductility", "-", 1, NEEDS_YIELDING | IS_BORNE, r->ductility, "ductility", "", 1,                     \
      "largest drift of a storey over its yield drift")                                                                \
    X(PLASTIC_DRIFT, "plastic_drift_ratio", "-", 1, NEEDS_YIELDING | IS_BORNE, r->plastic_drift_ratio,                 \
      "plastic drift", "%", 100, "largest plastic drift at the end over the height of its storey")                     \
    X(RESIDUAL_DRIFT, "residual_drift_ratio", "-", 1, NEEDS_YIELDING | IS_BORNE, r->residual_drift_ratio,              \
      "residual drift", "%", 100, "largest drift of the state of rest over the height of its storey")                  \
    X(HYSTERESIS, "ed_hysteresis_pct", "%", 1, NEEDS_YIELDING | IS_BORNE, r->ed_hysteresis_pct, "hysteresis share",    \
      "%", 1, "share of the input dissipated by storeys that yield")                                                   \
    X(DEVICES, "devices", "-", 1, NEEDS_NOTHING, (double)r->n_devices, "devices", "", 1,                               \
      "stops, links and tuned masses that a design has")                                                               \
    X(DEVICE_FORCE, "device_force_max_n", "N", 1, IS_BORNE, r->dashpot_n, "force of a link or tuned mass", "MN", 1e-6, \
      "largest force of a link or tuned mass")                                                                         \
    X(DEVICE_STROKE, "device_stroke_max_m", "m", 1, IS_BORNE, r->stroke_m, "stroke of a link or tuned mass", "m", 1,   \
      "largest stroke of a link or tuned mass")                                                                        \
    X(DEVICE_SHARE, "ed_devices_pct", "%", -1, IS_BORNE, r->ed_devices_pct, "share of links and tuned mass", "%", 1,   \
      "share of the input dissipated by links and the tuned mass")                                                     \
    X(COST, "cost", "-", 1, NEEDS_NOTHING, r->cost, "cost", "", 1, "of devices, core and anchors by design.prices")    \
    X(LOSS, "loss", "-", 1, NEEDS_NOTHING, damage_loss(r), "repair cost", "%", 100,                                    \
      "expected cost of repair over that of replacing the building (evaluate/consequences.h)")                         \
    X(ANNUAL_LOSS, "annual_loss", "1/year", 1, NEEDS_NOTHING,                                                          \
      r->rate_per_year > 0 ? r->rate_per_year * damage_loss(r) : NAN, "repair cost of a year", "%", 100,               \
      "loss of a year: sum over the records of loss times rate=NUMBER of each (docs/risk.md)")                         \
    X(NEIGHBOUR_J1, "neighbour_j1_m", "m", 1, NEEDS_NEIGHBOUR | IS_BORNE, r->neighbour.j1_m, "neighbour's J1", "m", 1, \
      "largest floor displacement of the building of core.model")                                                      \
    X(NEIGHBOUR_DRIFT, "neighbour_drift_ratio", "-", 1, NEEDS_NEIGHBOUR | IS_BORNE, r->neighbour.drift_ratio_max,      \
      "neighbour's drift ratio", "%", 100, "largest drift ratio of the building of core.model")                        \
    X(NEIGHBOUR_J3, "neighbour_j3_g", "g", 1, NEEDS_NEIGHBOUR | IS_BORNE, r->neighbour.j3_g, "neighbour's J3", "g", 1, \
      "largest floor acceleration of the building of core.model")                                                      \
    X(NEIGHBOUR_FILTERED, "neighbour_j3_filtered_g", "g", 1, NEEDS_NEIGHBOUR | NEEDS_FILTER | IS_BORNE,                \
      r->neighbour.j3_filtered_g, "neighbour's J3 filtered", "g", 1,                                                   \
      "its largest floor acceleration behind a low-pass of sim.filter_hz")                                             \
    X(NEIGHBOUR_LOSS, "neighbour_loss", "-", 1, NEEDS_NEIGHBOUR | IS_BORNE, damage_loss_of_neighbour(r),               \
      "neighbour's repair cost", "%", 100, "loss of the building of core.model")                                       \
    X(ANCHOR_FORCE, "anchor_force_n", "N", 1, NEEDS_FEW_FORCES | NEEDS_RADIUS | IS_BORNE, r->forces.anchor_force_n,    \
      "anchors", "MN", 1e-6,                                                                                           \
      "force by which anchors hold the core's foundation down beside its weight; anchors=inf: what that takes")

typedef enum {
#define X(id, ...) MEASURE_##id,
    MEASURE_LIST(X)
#undef X
        MEASURES_LISTED
} MeasureId;

/* Chances follow the list where search.objectives or search.limits name them: p(NAME>NUMBER), or p(NAME<NUMBER) of a
 * measure that is better when larger. One simulation gives 1 or 0, so that the mean over all records and replicates is
 * a probability, whatever sim.robust says. */
enum { N_MEASURES = MEASURES_LISTED + CHANCES_MAX };

typedef struct {
    char name[48];      /* as it was written, without blanks; empty: there is none */
    int of;             /* measure */
    double sign, bound; /* sign (value - bound) > 0 */
} Chance;

enum { PAPER_OBJECTIVES = MEASURE_MCORE + 1 };

/* How pages and texts call a number: shown = factor * natural value. Files keep their own names and units. */
typedef struct {
    const char *title, *unit; /* unit "": a number */
    double factor;
} Words;

typedef struct {
    const char *name; /* column and key */
    const char *unit;
    double sense;
    unsigned needs;
    Words words;
    const char *what;
} Measure;

const Measure *measure(int k);                   /* k = 0..N_MEASURES-1 */
int measures_borne(int id[MEASURES_LISTED]);     /* what has to be borne; returns their number */
int measure_is_share(int k);                     /* of 1, where a number above it is meant as per cent */
double measure_value(const SimResult *r, int k); /* natural sign and unit; NAN: not known */

/* The part of a simulation that is kept: a part of a design in the queue, also between machines. */
typedef struct {
    double value[N_MEASURES]; /* natural; NAN: not known */
    double seconds;
    RunOutcome outcome;
    char reason[REASON_MAX];
} Measured;
_Static_assert(sizeof(Measured) <= 640, "a part stays small: searches of thousands of replicates hold many");

Measured measured(const SimResult *r);

/* Sets of measures: bit k is measure k. */
typedef uint64_t MeasureSet;
_Static_assert(N_MEASURES <= 64, "a set of measures has 64 bits");

/* Options that compute what the set needs and no more; all where they ask for forces. */
void measures_ask(MeasureSet set, SimOptions *o);

/* Does a scene have what every measure of the set needs? STATUS_BAD_DATA: which lacks what, and what to set. */
Status measures_check(MeasureSet set, const CoreOptions *core, const Building *b, Err *err);

/* The objectives in the order in which they are searched for, then all the others in the order of the table, then
 * chances that are limited alone. */
typedef struct {
    int n, n_obj, of[N_MEASURES];
    MeasureSet objectives, limited;
    MeasureSet judged; /* both, with what their chances are of; loss in the place of annual_loss */
    Chance chance[CHANCES_MAX];
} MeasureOrder;

const char *measures_name(const MeasureOrder *order, int k); /* of measure k, a chance too: its column */

/* chance of r by the other numbers of it. */
void measures_chances(const MeasureOrder *order, SimResult *r);

/* objectives, of search.objectives: a comma list of names; auto: those of the paper that a building of n_floors has
 * (n_floors 0: any); paper: all seven. limits, of search.limits: words that are no measures are passed over. Errors:
 * STATUS_BAD_DATA, a name that is none or stands there twice, more than CHANCES_MAX chances. */
Status measures_order(MeasureOrder *out, const char *objectives, const char *limits, int n_floors, Err *err);

/* Objectives that a building of n_floors does not have, in words, whether `auto` leaves them out or they are asked for;
 * NULL: it has all. */
const char *measures_missing(const MeasureOrder *order, const char *objectives, int n_floors);

/* The one rule of whether a simulation succeeded: it finished, and every measure of the set is finite; one that has
 * none fails with its reason. */
void measures_settle(SimResult *r, MeasureSet set);
