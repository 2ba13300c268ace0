/* scene/opensees.h -- the linear part of an OpenSees model (Tcl, 2 dimensions, 3 unknowns per node) as a plane frame.
 *
 *   model BasicBuilder -ndm 2 [-ndf 3]      node TAG x y [-mass mx my mr]       fix TAG x y rot
 *   mass TAG mx my mr                       equalDOF MASTER SLAVE 1 2 3         geomTransf Linear|PDelta TAG
 *   section Elastic TAG E A I               uniaxialMaterial Elastic TAG E
 *   element elasticBeamColumn TAG i j A E I TRANSF, or SECTION TRANSF; forceBeamColumn, dispBeamColumn TAG i j POINTS
 *           SECTION TRANSF; truss TAG i j A MATERIAL; each [-mass m] [-cMass] [-release 0|1|2|3]
 *
 * as in the OpenSees command manual (opensees.berkeley.edu), run by a safe interpreter of Tcl with limits of time and
 * commands, so that loops, procedures and expressions are Tcl's own. A later mass of a node replaces an earlier one,
 * and an element's mass is lumped at its ends unless -cMass is given, as there. Loads, analysis and output are
 * skipped and named in Frame.note, puts does nothing, source reads below the model's folder. Whatever else is refused
 * with its file and line, whether the script catches it or not.
 *
 * Units      an OpenSees model says none: the caller does
 * Ownership  opensees_read allocates the Frame, frame_free releases it, after a failure too
 * Threads    an interpreter of its own per call */
#pragma once

#include "scene/frame.h"

/* One unit of length in m, of force in N; that of mass is force s2 / length. */
Status opensees_read(Frame *f, const char *path, double length_m, double force_n, Err *err);
