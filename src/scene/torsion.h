/* scene/torsion.h -- floors that turn about the vertical, because they meet the core off their centre.
 *
 *   M u''   + C u'   + K u   - f     = -M 1 a(t)        u    [m] of the centres
 *   M psi'' + C psi' + K psi - f e/r = 0                psi  [m] rotation times the radius of gyration r
 *   w = u + psi e/r - v                                 at the contacts, off the centre by the arm e
 *   u +- psi b/(2 r)                                    at the edges
 *
 * A plan of the sides l along the motion and b across it has r^2 = (l^2 + b^2)/12. Chosen: mass and stiffness are
 * spread alike, so that rotation has the frequencies and the damping of the translation. The core does not turn.
 * A free floor that is hit has the effective mass 1/(1/m + e^2/(m r^2)).
 *
 * Threads  no state */
#pragma once

#include "scene/building.h"

/* Adds rotations to b->model, a degree of freedom to each that it has, where eccentricity, e/l and b/l, is not 0. */
Status torsion_add(Building *b, const NumberList *eccentricity, Err *err);
