/* scene/opensees.h -- the elastic part of an OpenSees model (Tcl, 2 dimensions, 3 unknowns per node) as a plane frame.
 *
 *   model BasicBuilder -ndm 2 -ndf 3                        node TAG x y [-mass mx my mr]
 *   fix TAG x y rot         mass TAG mx my mr               equalDOF MASTER SLAVE 1 2 3
 *   geomTransf Linear TAG                                   set NAME VALUE, $NAME, [expr ...] with + - * / ( )
 *   element elasticBeamColumn TAG i j A E I TRANSF [-mass m] [-cMass] [-release 0|1|2|3]
 *
 * as in the OpenSees command manual (opensees.berkeley.edu). As there integers divide as
 * integers, a later mass of a node replaces an earlier one, and an element's mass is lumped at its ends unless -cMass is
 * given. wipe may stand above the nodes. Whatever else stands in the file is refused, line by line.
 *
 * Units  an OpenSees model says none: the caller does
 * Ownership  opensees_read allocates the Frame, frame_free releases it. Threads  no state */
#ifndef IMTET_SCENE_OPENSEES_H
#define IMTET_SCENE_OPENSEES_H

#include <stdio.h>

#include "scene/frame.h"

typedef struct {
    const char *word;         /* N_m, kN_m, N_mm, kip_in, kip_ft */
    double length_m, force_n; /* one unit in m, in N; the unit of mass is force s2 / length */
} ModelUnits;

/* The units of that word; NULL: there are none. */
const ModelUnits *model_units(const char *word);
extern const char MODEL_UNITS_WORDS[];

/* refused: each command outside the subset as a line "FILE:LINE: ..."; they are counted and make the call fail. */
Status opensees_read(Frame *f, const char *path, const ModelUnits *units, FILE *refused, Err *err);

#endif
