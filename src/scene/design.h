/* scene/design.h -- the design variables: which there are, what a design x of them is, and designs read from a CSV
 * file.
 *
 *   design.variables = gaps, thickness                gap_01_m..gap_NN_m, t_base_m, t_top_m        the paper's
 *   design.gap_zones = 5                              gap_zone_1_m..gap_zone_5_m in place of a gap per floor
 *   design.gap_sides = both                           a gap is the same on both sides
 *                      left | right                   gap_left_01_m.. alone: there is nothing on the other side
 *                      each                           gap_left_01_m..gap_left_NN_m, gap_right_01_m..
 *   ..., bumper    design.bumper_zones = 1 | 0 | 3    bumper_log10_n_m | bumper_01_log10_n_m.. |
 *                  bumper_zone_1_log10_n_m..
 *   ..., side                                         side_m of the core's box
 *   ..., anchors                                      anchors of its mat, times what weight holds (scene/foundation.h)
 *   ..., links     design.link_zones = 0              link_01_n_s_m.. of dashpots between floors and core
 *   ..., friction  design.link_zones = 0              friction_01_n.. of friction links between floors and core
 *   ..., tuned_mass                                   tuned_mass_kg, tuned_mass_hz, tuned_mass_damping, at the roof
 *   design.devices = gap, link, none                  device_01.. : one of these words for every floor, or, with
 *                                                     design.device_zones = 4, device_zone_1..; with tuned_mass among
 *                                                     the variables device_roof too: tuned_mass or none
 *   core.section = effective                          no t_base_m, t_top_m: its areas are given, thickness does nothing
 *
 * Of a floor, gap is a stop, bumper one with a bumper, link a dashpot and friction a friction link without a stop, none
 * nothing at all; variables of what a floor or the roof does not have do nothing there. x has the place of the word,
 * from 0. Without design.devices every floor has all that design.variables name.
 *
 * x is in the order of these columns. A stiffness is its decimal logarithm in N/m: x is what the search scales
 * linearly. Zone z of Z has the floors from z n/Z to (z + 1) n/Z. The right gap is how far a floor may go to the right,
 * u - v > 0, before it meets the core (or the neighbour that stands there), the left one how far to the left.
 *
 *   gap_01_m,...,gap_NN_m,t_base_m,t_top_m            a file: one column per variable in this order
 *   0.05,...,0.05,0.012,0.0064                        any number of rows
 *
 * Every fault names file, line and column. A negative or non-finite gap, a thickness or side that is not positive are
 * refused; t_top_m > t_base_m is let pass; the caller judges.
 *
 * Ownership  design_read allocates, design_free releases (an empty Designs is fine). Threads  no state */
#pragma once

#include "base/status.h"
#include "base/csv.h"
#include "scene/options.h"

static const double DESIGN_OPEN_M = 10.0; /* [m] a gap as wide stands for no stop: wider than any building sways */

enum { DESIGN_VARIABLES_MAX = (SIDES + 4) * FLOORS_MAX + 7 };

typedef enum { FLOOR_GAP, FLOOR_BUMPER, FLOOR_LINK, FLOOR_FRICTION, FLOOR_NONE, N_FLOOR_DEVICES } FloorDevice;

/* x: gaps of all sides, t_base and t_top (n_walls = 2) or neither (0), bumpers, side, anchors, links, friction links,
 * the tuned mass (n_mass = 3), choices of n_words devices, choice of a tuned mass or none at the roof. */
enum { DESIGN_GROUPS = 10 };

typedef struct {
    int n_floors, n_var, n_words;
    union {
        struct {
            int n_gaps, n_walls, n_bumpers, has_side, has_anchors, n_links, n_slips, n_mass, n_choices, has_roof;
        };
        int count[DESIGN_GROUPS]; /* the same as numbers of variables in the groups of x */
    };
    int first[DESIGN_GROUPS];          /* the first variable of each group */
    int zones[DESIGN_GROUPS];          /* 0: a variable per floor, or a group that has nothing to do with floors */
    FloorDevice word[N_FLOOR_DEVICES]; /* (n_words) */
    GapSides gap_sides;
} DesignSpace;

/* n_floors 0: not known; then gaps and bumpers that are one per floor are none. */
Status design_space_make(DesignSpace *space, const DesignOptions *o, CoreSection section, int n_floors, Err *err);

/* Floors of designs of n_var variables; 0: any number of floors has so many, or none. */
int design_space_floors(const DesignOptions *o, CoreSection section, int n_var);

/* Name of variable j = 0..n_var-1. */
void design_variable_name(const DesignSpace *space, int j, char name[TABLE_NAME_MAX]);

/* May variable j have that value? STATUS_BAD_DATA: "WHERE: NAME is -1; a gap is not negative". */
Status design_check(const DesignSpace *space, int j, double value, const char *where, Err *err);

/* The word that stands for x where variable j is a choice; NULL: it is none, or has none such. */
const char *design_word(const DesignSpace *space, int j, double x);

/* Are variables a and b of the same sort, of floors in the same one of so many zones? */
int design_share_zone(const DesignSpace *space, int a, int b, int zones);

int design_is_wall(const DesignSpace *space, int j); /* a thickness of the core */

/* Is it searched on a logarithmic scale? */
int design_is_log(const DesignSpace *space, int j);

/* The box of the search (n_var). */
void design_bounds(const DesignSpace *space, const DesignOptions *o, double lower[], double upper[]);

/* Design k of n that are spread over that box; gaps up to where the floors sway, the roof by sway_m, as many cores,
 * and the first with the first word everywhere. sway_m INFINITY: all gaps of the box, and the core in its middle. */
void design_spread(const DesignSpace *space, const DesignOptions *o, size_t k, size_t n, double sway_m, double x[]);

/* A design as it is built. */
typedef struct {
    double gap[SIDES][FLOORS_MAX];         /* [m]; INFINITY: there is nothing on that side */
    double bumper[FLOORS_MAX];             /* [N/m]; < 0: as contact.bumper_stiffness_n_m says */
    double t_base, t_top;                  /* [m]; 0: there are none */
    double side;                           /* [m]; 0: as core.width_m says */
    double anchors;                        /* [-]; 0: as core.foundation says */
    double link[FLOORS_MAX];               /* [N (s/m)^exponent]; 0: none */
    double friction[FLOORS_MAX];           /* [N]; 0: none */
    double mass_kg, mass_hz, mass_damping; /* of the tuned mass; 0: none */
} Design;
void design_of(const DesignSpace *space, const double x[], Design *d);

/* x becomes a design of links of that constant on every floor alone, or of a tuned mass alone; what else it has stays.
 * 0: there is none such among the choices of the space. */
int design_put_links(const DesignSpace *space, double n_s_m, double x[]);
int design_put_mass(const DesignSpace *space, double kg, double hz, double damping, double x[]);

/* Names what is between tower and core, "impacts and links and a tuned mass". */
enum { PROTECTION_MAX = 40 };
const char *design_protection(const DesignSpace *space, const Design *d, char text[PROTECTION_MAX]);

/* The smaller gap of floor j = 0..n_floors-1 [m]. */
double design_gap(const Design *d, int j);
int design_has_link(const Design *d, int j); /* a link or a friction link stands there */

/* Thickness of the core in storey j = 0..n_floors-1 [m]. */
double design_thickness(const DesignSpace *space, const Design *d, int j);

typedef struct {
    size_t n;
    DesignSpace space;
    double *x; /* (n, space.n_var) */
    int *line; /* (n) of the file */
    long *id;  /* (n) as the run that they are of numbers them; NULL: designs of a file */
} Designs;

Status design_read(Designs *d, const char *path, const DesignSpace *space, Err *err);

/* Variable j of a row of words: a word of its choice or the place of one, else a number. */
Status design_cell(const DesignSpace *space, int j, const Table *t, size_t row, double *x, Err *err);

/* A table of designs, further columns among them, with numbers in the place of words. */
Status design_table_read(Table *t, const char *path, const DesignSpace *space, Err *err);

/* As design_read, from a table that is read already; the designs take over its numbers. */
Status design_of_table(Designs *d, Table *t, const char *path, const DesignSpace *space, Err *err);
void design_free(Designs *d);
