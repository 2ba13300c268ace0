/* scene/beam.h -- stiffness and consistent mass of a straight beam element of constant section, bending in a plane.
 *
 *   unknowns  deflection w, rotation (dw/dx where nothing shears) at each end: w0, r0, w1, r1
 *   phi       12 EI / (kGA l^2), what shear adds to bending; 0: Euler-Bernoulli
 *
 * The stiffness is exact for loads at the ends (Przemieniecki, Theory of Matrix Structural Analysis, 1968, section
 * 5.6). The mass is consistent with the same shapes, rotary inertia included: Friedman and Kosmatka, Computers and
 * Structures 47 (1993) 473-481. Threads  no state */
#ifndef IMTET_SCENE_BEAM_H
#define IMTET_SCENE_BEAM_H

#include "base/status.h"

typedef struct {
    double EI;          /* [N m2] */
    double kGA;         /* [N] of the shear area; 0: shear does not deform it */
    double mass_per_m;  /* [kg/m] */
    double rotary_kg_m; /* [kg m] density times inertia; 0: sections turn without inertia */
    double length;      /* [m] */
} Beam;

void beam_element(const Beam *b, double k[4][4], double m[4][4]);

/* A cantilever of n beams, clamped where the first begins, condensed to the deflections of their ends by Guyan
 * reduction: T = [1; -Krr^-1 Kru],  K = T' K T,  M = T' M T   (n, n). */
Status beam_cantilever(int n, const Beam beam[], double K[], double M[], Err *err);

#endif
