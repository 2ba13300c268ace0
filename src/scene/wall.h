/* scene/wall.h -- walls of a box beyond their buckling stress: what of the section still bends, what stiffeners add.
 *
 * Effective width of EN 1993-1-5, 4.4 (Winter's formula), at the stress s of the compressed flange in the place of the
 * yield stress, 4.4(4):
 *
 *   l = sqrt(s / s_cr),  rho = (l - 0.055 (3 + psi)) / l^2 above l = 0.5 + sqrt(0.085 - 0.055 psi), else 1;
 *   psi 1: flange;  web: its edge stresses' ratio psi,
 *   s_cr times k / 4, k = 7.81 - 6.29 psi + 9.78 psi^2, of what it has under compression 0.4 rho at the flange and 0.6
 *   rho at the axis
 *
 * The wall opposite is under tension and whole, so that the axis moves there; under motion to and fro the two take
 * turns. Shear keeps the same share of its stiffness as bending.
 *
 * Stiffeners are n flat bars along each wall, of all its width, ten times as high as thick (torsion, 9.2.1(8), up to
 * 355 MPa), held at the floors by rings or diaphragms, so many that the lesser of two stresses is largest (4.5.3(3)):
 *
 *   of the panels between them   4 pi^2 E / (12 (1 - nu^2)) (t (n + 1) / b)^2
 *   of each with its panel       pi^2 E I / (A h^2),   h the storey's height
 *
 * They bear no bending of the core. Threads  pure functions */
#pragma once

#include "scene/options.h"

/* [Pa] Buckling stress of a wall of that thickness between floors so far apart. */
double wall_buckling_pa(const CoreOptions *o, double thickness, double storey_m);

typedef struct {
    double stress; /* [Pa] largest */
    double share;  /* of the stiffness */
} WallState;

/* Under a moment that stresses the whole section by gross [Pa]. */
WallState wall_effective(double gross, double buckling_pa);
