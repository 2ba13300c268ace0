/* scene/foundation.h -- the ground under the core: springs and dashpots of a rigid disc, setting core.foundation.
 *
 *   fixed                                             the core is clamped
 *   soil=A..D | g=PA  radius=M [nu=0.3] [density=2000]   a rigid disc on an elastic half-space of shear modulus G
 *   rotation=N m/rad translation=N/m                  springs as they are, 0: fixed; also in the place of the disc's
 *   rotation_dashpot=N m s/rad translation_dashpot=N s/m   likewise
 *   weight=N                                          that rests on the disc beside the core's, for the uplift
 *   anchors=FACTOR                                    the disc lifts from so many times M_up on (scene/uplift.h): 1,
 *                                                     where weight alone holds it; inf or left out, it never lifts
 *
 *   K_theta = 8 G r^3 / (3 (1 - nu)),   K_x = 8 G r / (2 - nu)                            statics of the disc
 *   C_x = rho v_s pi r^2,   C_theta = rho c I b^2 / (1 + b^2),  I = pi r^4 / 4,  b = w z / c        radiation (cones)
 *   v_s = sqrt(G / rho),  c = v_s sqrt(2 (1 - nu) / (1 - 2 nu)), from nu = 1/3 on 2 v_s,
 *   z = 9 pi / 32 (1 - nu) (c / v_s)^2 r                    apex of the cone that turns: K_theta = 3 rho c^2 I / z
 *   M_up = W r / 3        moment at which the pressure below the disc's edge is zero and it begins to lift
 *
 * soil: the site classes of ASCE 7 (not the ground types of motion.target), G = rho v_s^2 G/G0 with the geometric mean
 * of the class's bounds of v_s (A: the lower one) and G/G0 of strong shaking, S_XS / 2.5 = 0.4 g. Class E wants an
 * investigation of the site: give g=. The mass of soil that moves along above nu = 1/3 and the hysteresis of the soil
 * are left out, and so is the mass of the disc.
 *
 * Threads  no state
 * Source   J. P. Wolf, Foundation Vibration Analysis Using Simple Physical Models (1994), ch. 2; uplift: J. P. Wolf,
 *          Nucl. Eng. Des. 38 (1976) 357-384; ASCE 7-16, table 20.3-1; ASCE 41-17, table 8-2 */
#pragma once

#include "base/option.h"

typedef struct {
    double rotation, translation;                 /* [N m/rad], [N/m]; 0: fixed */
    double rotation_dashpot, translation_dashpot; /* [N m s/rad] at high frequencies, [N s/m] */
    double cone_s;                                /* [s] z / c; 0: rotation_dashpot acts at every frequency */
    double radius_m, weight_n;                    /* [m] 0: not known; [N] beside the core's */
    double anchors;                               /* [-] 0: it never lifts */
} Foundation;

/* factor: of the ground's stiffness; dashpots go with its root. */
Status foundation_parse(const char *text, double factor, Foundation *out, Err *err);

/* Writes out what a user means who says nothing of anchors where the radius is known: weight alone. The settings of a
 * stored run keep what they say. Returns the anchors that it had. */
double foundation_complete(char text[OPTION_TEXT_MAX], int is_stored);

/* M_up [N m] under a weight [N]. */
double foundation_uplift_nm(const Foundation *f, double weight_n);

/* Power of dashpot C beside spring K, per squared velocity of the spring alone under the same force: C / (1 + (w C /
 * K)^2), for K theta' + C theta'' = M'. K 0: C is 0 too. */
double foundation_loss(double K, double C, double omega);

/* C_theta at frequency omega [rad/s]. */
double foundation_rotation_dashpot(const Foundation *f, double omega);
