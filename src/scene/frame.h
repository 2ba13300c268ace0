/* scene/frame.h -- a plane frame as engineers write it down, and its stiffness and mass condensed to the floors.
 *
 *   nodes.csv     node, x_m, z_m [, fix_x, fix_z, fix_rot (0 or 1)] [, floor (from 1 at the bottom; 0: none)]
 *                 [, keep_x, keep_z, keep_rot (0 or 1)]
 *   sections.csv  section, A_m2, I_m4, E_pa [, shear_area_m2, poisson, mass_kg_per_m]
 *   elements.csv  element, node_i, node_j, section [, pin_i, pin_j (0 or 1)] [, added_mass_kg]
 *   masses.csv    node, mass_kg [, mass_z_kg, rotary_kg_m2]                       (may be missing)
 *   ties.csv      node, same_as [, x, z, rot (0 or 1)]: equal displacements       (may be missing)
 *
 * Elements are beam-columns: axial stiffness EA/l, bending by scene/core_beam.h (shear where shear_area_m2 is given),
 * pinned ends without moment; OpenSees models have springs, rigid arms and links besides. Their own mass and the added
 * one lie evenly along them (consistent mass, no rotary inertia of sections); masses.csv adds masses (along z the same
 * as along x unless mass_z_kg says otherwise) and rotary inertia at nodes.
 *
 * Floors are the heights given in column floor; without it the heights at which a level element ends in nodes that may
 * move sideways, or, of a stick without level elements, those of masses that may. With rigid floors all nodes of a
 * floor have one displacement x; else the floor is represented by its node nearest the middle. Everything else is
 * removed by Guyan reduction:
 *
 *   T = [1; -Kss^-1 Ksm],  K = T' K T,  M = T' M T         s the removed unknowns, m the floors
 *
 * summed element by element, Kss factored as a band. A mechanism is refused with the node that moves.
 *
 * Ground: the load is -M r a, r the motion with the ground, of which T 1 misses r - T 1 where columns bend at their
 * feet. Mass that moves in this shape (heavy columns, splices) is not moved by the ground as M 1 of the condensed M,
 * so that the shape is one more degree of freedom, K-orthogonal to T, unless T' M (r - T 1) is below 0.1 % of the load.
 *
 * Full model: the floors, then every other displacement that has mass; where nodes.csv names some (keep_x..), these
 * alone. What is removed is condensed as above, which is exact where it has no mass.
 *
 * Model "guyan" is the frame of configs/sac20/frame, which is compiled in.
 *
 * A frame is built up by calls, from sheets (scene/frame_read.c) or the commands of an OpenSees model
 * (scene/opensees.h), which say what is wrong with a part; the readers add file and line.
 *
 * Ownership  frame_read and the frame_add functions allocate, frame_free releases (an empty Frame is fine).
 * Threads  no state */
#pragma once

#include "base/csv.h"
#include "base/status.h"
#include "scene/options.h"

enum { FRAME_X, FRAME_Z, FRAME_ROT, FRAME_DOFS };

typedef struct {
    char name[TABLE_NAME_MAX];
    double x, z;             /* [m] */
    int fixed[FRAME_DOFS];   /* held by the ground */
    double mass[FRAME_DOFS]; /* [kg] along x, along z, [kg m2] */
    int floor;               /* from 1; 0: none */
    int keep[FRAME_DOFS];    /* named as one of the full model */
    int follows[FRAME_DOFS]; /* the node whose displacement this one equals; itself where it is tied to none */
} FrameNode;

typedef struct {
    char name[TABLE_NAME_MAX];
    double area, inertia, E; /* [m2], [m4], [Pa] */
    double shear_area;       /* [m2] 0: no shear deformation */
    double poisson;
    double mass_per_m; /* [kg/m] */
} FrameSection;

typedef struct {
    char name[TABLE_NAME_MAX];
    int node[2], section;
    int pinned[2];
    double added_mass;   /* [kg] */
    double offset[2][2]; /* [m] along x and z, from the nodes to its ends, which are rigidly connected to them */
    int is_spring;       /* no beam, but springs between ends at one place, where its added_mass is */
    double spring[FRAME_DOFS], axis[2]; /* [N/m] along the axis, across it, [N m/rad] */
} FrameElement;

typedef enum { FRAME_NODES, FRAME_SECTIONS, FRAME_ELEMENTS, FRAME_KINDS } FrameKind;

typedef struct {
    int n[FRAME_KINDS], n_ties, n_floors;
    FrameNode *node;
    FrameSection *section;
    FrameElement *element;
    void *names;        /* of all of these: a tree of <search.h> */
    char note[400];     /* what of an OpenSees model was skipped; empty: nothing */
    int has_no_heights; /* of a shear model: its nodes stand above one another in no known distance */
    double *storey_m;   /* (n_floors) heights; the first above the highest node that is held sideways below floor 1 */
} Frame;

/* A part is copied; a node is tied to none. */
Status frame_add_node(Frame *f, const FrameNode *node, Err *err);
Status frame_add_section(Frame *f, const FrameSection *section, Err *err);
Status frame_add_element(Frame *f, const FrameElement *element, Err *err);
Status frame_tie(Frame *f, int node, int same_as, const int dof[FRAME_DOFS], Err *err);

/* [m] From the first end of an element to the second, along x and along z. */
static inline void frame_span(const Frame *f, const FrameElement *e, double span[2])
{
    const FrameNode *a = &f->node[e->node[0]], *b = &f->node[e->node[1]];
    span[0] = b->x + e->offset[1][0] - a->x - e->offset[0][0];
    span[1] = b->z + e->offset[1][1] - a->z - e->offset[0][1];
}

/* Index of what has that name; -1: nothing has. */
int frame_find(const Frame *f, FrameKind kind, const char *name);

/* After the last part: floors, their heights, and where they are rigid one displacement along x for each. model: its
 * name for messages. */
Status frame_find_floors(Frame *f, const char *model, int rigid, Err *err);

/* The node that stands for a floor: the nearest to the middle of its nodes. */
int frame_floor_node(const Frame *f, int floor);

/* The node whose displacement is that of a node. */
int frame_followed(const Frame *f, int node, int dof);
void frame_free(Frame *f);

/* Is the model a frame: a folder that holds nodes.csv, guyan, or an OpenSees model, a .tcl or .ops file? */
int frame_is(const char *model);
int frame_reads(const char *name); /* from its folder */
Status frame_read(Frame *f, const BuildingOptions *o, Err *err);

typedef struct {
    int n;             /* degrees of freedom; the first are the floors */
    double *K, *M;     /* (n, n) row-major [N/m], [kg]; rotations in rad */
    double *influence; /* (n) of the ground's motion: 1 along x and of the missed shape, else 0 */
} FrameFull;

/* The floors and, where it matters, what they miss of the ground's motion; or the full model. */
typedef enum { FRAME_FLOORS, FRAME_FULL } FrameKept;

/* Room for n degrees of freedom, zeroed. */
Status frame_full_make(FrameFull *full, int n, Err *err);

/* Allocates; frame_full_free releases (an empty one is fine). */
Status frame_reduce(const Frame *f, FrameKept kept, FrameFull *out, Err *err);
void frame_full_free(FrameFull *full);
