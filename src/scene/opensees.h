/* scene/opensees.h -- the linear part of an OpenSees model (Tcl, 2 dimensions) as a plane frame.
 *
 * A model is a program: it is read by a program of our own, imtet-opensees (src/opensees), which is executed and has 1
 * GB, 10 s and a million commands. It is looked for beside this program or library and in the folders above, there and
 * in bin. docs/building.md lists the commands that are read, as the OpenSees command manual (opensees.berkeley.edu)
 * has them; a later mass of a node replaces an earlier one, and an element's mass is lumped at its ends unless -cMass
 * is given, as there. Loads, analysis and output are skipped and named in Frame.note, puts does nothing, files are
 * read below the model's folder. Whatever else is refused with its file and line, whether the script catches it or not.
 *
 * Units      an OpenSees model says none: the caller does
 * Ownership  opensees_read allocates the Frame, frame_free releases it, after a failure too
 * Threads    any */
#pragma once

#include "scene/frame.h"

/* One unit of length in m, of force in N; that of mass is force s2 / length. takes_initial: the initial stiffness of
 * what yields, which is refused else. */
Status opensees_read(Frame *f, const char *path, double length_m, double force_n, int takes_initial, Err *err);

/* The program writes to its standard output, a file, "FILE:LINE" of the command under way; behind UNDER_WAY_MAX bytes
 * "refused TEXT", or "note TEXT" and a line for each node, tie and element (src/opensees/model.tcl: print_frame). */
enum { OPENSEES_SECONDS = 10, UNDER_WAY_MAX = 512 };
