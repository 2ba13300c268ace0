/* scene/core_beam.h -- the light, stiff core as a cantilever with one node per floor.
 *
 * One beam element per storey, constant section inside it, consistent mass, clamped at the ground or on the springs
 * of a foundation, the rotations (and the foundation's motion) condensed. Thickness, and with `effective` areas and
 * inertia, vary linearly with the storey number j = 1..n: t_j = t_base + (t_top - t_base) (j-1)/(n-1).
 *
 *   box        A = B^2 - (B-2t)^2,  I = (B^4 - (B-2t)^4)/12,  shear area 20 (1+nu) / (48 + 39 nu) A   (Cowper 1966)
 *   plate      A = b t,             I = b t^3/12,             shear area 5/6 A
 *   effective  A, I and shear area given at the first and last storey (shear area 0: no shear deformation), or A, I and
 *              mass storey by storey; the thicknesses are ignored
 *
 *   timoshenko       shear deformation and rotary inertia of the sections; the condensation then raises the frequencies
 *                    of a fine beam: the first four of 80 m x 11.3 m by 1e-5, 6e-4, 3e-3, 7e-3 (tests/test_scene.c)
 *   euler_bernoulli  neither
 *
 * A beam element is straight, of constant section and bends in a plane:
 *
 *   unknowns  deflection w, rotation (dw/dx where nothing shears) at each end: w0, r0, w1, r1
 *   phi       12 EI / (kGA l^2), what shear adds to bending; 0: Euler-Bernoulli
 *
 * The stiffness is exact for loads at the ends (Przemieniecki, Theory of Matrix Structural Analysis, 1968, section
 * 5.6). The mass is consistent with the same shapes, rotary inertia included: Friedman and Kosmatka, Computers and
 * Structures 47 (1993) 473-481.
 *
 * On a foundation the motion of the base follows by statics from the forces Kc v of the nodes, at heights z:
 *
 *   theta = z' Kc v / K_theta,   x = 1' Kc v / K_x
 *
 * Its dashpots damp each mode by what they take of its energy, 2 zeta_i w_i = 2 zeta w_i + C_theta(w_i) theta_i^2 +
 * C_x x_i^2 of the mass-normalised mode; that they couple the modes is left out (tests/test_foundation.c measures it
 * against complex modes).
 *
 * Mode shapes are mass-normalised as in scene/building.h. Threads  no state. */
#pragma once

#include "base/status.h"
#include "scene/foundation.h"
#include "scene/options.h"
#include "scene/uplift.h"

typedef struct {
    double EI;          /* [N m2] */
    double kGA;         /* [N] of the shear area; 0: shear does not deform it */
    double mass_per_m;  /* [kg/m] */
    double rotary_kg_m; /* [kg m] density times inertia; 0: sections turn without inertia */
    double length;      /* [m] */
} Beam;

void beam_element(const Beam *b, double k[4][4], double m[4][4]);

/* A cantilever of n beams, clamped where the first begins or on the springs of `base` (NULL: clamped), condensed to the
 * deflections of their ends by Guyan reduction: T = [1; -Krr^-1 Kru],  K = T' K T,  M = T' M T   (n, n). */
Status beam_cantilever(int n, const Beam beam[], const Foundation *base, double K[], double M[], Err *err);

typedef struct {
    int n, top; /* nodes; the lowest of them that there are: fewer of a neighbour (scene/neighbour.h) */
    double storey_m[FLOORS_MAX];                                   /* (top) heights of a neighbour's storeys */
    double mass_kg;                                                /* of the whole core, ground node's share included */
    double K[FLOORS_MAX * FLOORS_MAX], M[FLOORS_MAX * FLOORS_MAX]; /* (n, n) */
    double phi[FLOORS_MAX * FLOORS_MAX];                           /* (n, n) column i is mode i */
    double omega[FLOORS_MAX], gamma[FLOORS_MAX], zeta[FLOORS_MAX];
    Foundation base;
    double base_rotation[FLOORS_MAX], base_translation[FLOORS_MAX]; /* (n) [rad/m], [-] of the base by a unit deflection
                                                                     * of a node; 0 where it is fixed */
    Uplift uplift;
} CoreBeam;

/* storey_m (n): heights. */
Status core_beam_make(CoreBeam *c, const CoreOptions *o, int n, const double storey_m[], double t_base_m,
                      double t_top_m, Err *err);

/* Damping 2 zeta w that the foundation's dashpots add to a mass-normalised mode of frequency omega, whose entries at
 * the core's nodes are v, `stride` apart. */
double core_beam_base_loss(const CoreBeam *c, double omega, const double v[], int stride);

/* omega C / K at the first mode of the larger of the foundation's dashpots. */
double core_beam_dashpot_share(const CoreBeam *c);

/* [N] On its foundation; by which anchors of that factor hold it down beside that, 0: none, or it never lifts. */
double core_beam_weight(const CoreBeam *c);
double core_beam_anchor(const CoreBeam *c);

/* The section in storey 0..n-1. */
typedef struct {
    double thickness, depth;   /* [m] of the wall; outer, in the direction of bending */
    double area, inertia;      /* [m2], [m4] */
    double shear_area;         /* [m2] 0: no shear deformation */
    double mass_kg;            /* of the storey; 0: density times area */
    double shear_stress_per_n; /* [1/m2] largest shear stress per unit of shear force */
} CoreStorey;
CoreStorey core_beam_storey(const CoreOptions *o, int n, int storey, double t_base_m, double t_top_m);

/* Share of the stiffness of the walls that a user gives; 1: all. */
double core_wall_factor(const CoreOptions *o);

/* Frequency of the first mode [Hz] by a theory that may be another than the options'. */
Status core_beam_first_hz(const CoreOptions *o, CoreTheory theory, int n, const double storey_m[], double t_base_m,
                          double t_top_m, double *hz, Err *err);
const char *core_theory_word(CoreTheory theory);
