/* scene/building.h -- the building: stiffness and mass of its floors, its modes and their damping.
 *
 *   K phi_i = w_i^2 M phi_i,   phi_i' M phi_i = 1,   gamma_i = phi_i' M 1      (participation [sqrt(kg)])
 *
 * model "guyan"     the 106-DOF frame condensed by Guyan reduction to its 20 floors (0.264 Hz; nearest to the responses
 *                   printed in the paper), "appendix" the paper's Appendix A (0.273 Hz); both are compiled in
 * model FOLDER      one of three, told apart by its files; any number of floors up to FLOORS_MAX, bottom floor first
 *   K.csv, M.csv    square matrices in building.units
 *   storeys.csv     a row per storey from the bottom:  height_m, mass_kg (or mass_t) of the floor above it, and
 *                     stiffness_n_m (or _kn_m)   shear stiffness: the force that displaces the floor by 1 m
 *                     bending_n_m2 (or _kn_m2)   EI of the storey in the bending of the whole building
 *                   stiffness alone: a shear building; bending alone: a bending cantilever; both: a Timoshenko one,
 *                   rotations condensed
 *   nodes.csv ...   a plane frame, condensed to its floors (scene/frame.h)
 *
 * The model that is integrated has the floors alone (Guyan), of a frame with mass between the floors one shape more by
 * which the ground moves that too (scene/frame.h), or with building.modes = N of a frame also N fixed-interface modes
 * (Craig-Bampton, scene/reduction.h), and with as many as there are the full model. K, M, phi, omega, gamma and
 * zeta are always those of the floors alone; shares by mode are booked under the mode of these that a mode resembles.
 *
 * Storey heights: of the files where they have them; else building.heights_m.
 *
 * P-delta  with building.p_delta = on K loses the geometric stiffness of the weights above: storey j of height h_j
 *          carries W_j = g sum_{k >= j} m_k (m row sums of M), K_j,j-1 block -= W_j / h_j [1 -1; -1 1].
 * Yield    storeys with a yield drift d_y, of the building's options or a column yield_drift of storeys.csv, times the
 *          height. Storey stiffness from the first mode without P-delta: with f = K phi_1, V_j = sum_{i >= j} f_i,
 *          k_j = V_j / (phi_1j - phi_1,j-1). The part c k_j yields, c = 1 - hardening, the rest of K stays linear;
 *          what is left must carry the building, so that c <= 0.98 / lambda, lambda the largest eigenvalue of
 *          B' diag(k) B x = lambda K x, B u the drifts.
 * Damping  modal: building.damping mode by mode, the last ratio for the rest; rayleigh: zeta_i = (a / w_i + b w_i) / 2
 *          through its first ratio at the two modes of building.rayleigh_modes
 *
 * Checked: square, finite, symmetric to rounding (1e-6 of the largest entry), positive definite. K.csv and M.csv with
 * building.units = auto are read as N/m and kg; a first period beyond 0.01 to 1 s per storey is then
 * refused, and so are floors below 1e3 kg where other units would make them heavier.
 *
 * Ownership  building_load allocates, building_free releases (an empty Building is fine). Threads  read-only after. */
#pragma once

#include "base/carve.h"
#include "base/status.h"
#include "scene/core_beam.h"
#include "scene/options.h"

/* In mass-normalised modes: r the motion of the ground, gamma_i = phi_i' M r. */
typedef struct {
    int n;                        /* degrees of freedom and modes; the first are the floors */
    double *K, *M;                /* (n, n) */
    double *phi;                  /* (n, n) column i is mode i */
    double *omega, *gamma, *zeta; /* (n) [rad/s] ascending, [sqrt(kg)], [-] */
    int *like;                    /* (n) the mode of the floors alone that it resembles; -1: none (vertical) */
    int turns_at;                 /* the first rotation, of floors that turn (scene/torsion.h); 0: none does */
    double arm_contact, arm_edge; /* [-] of the contacts, of the edges, over the radius of gyration */
} BuildingModel;

/* Displacement of floor j in mode i, at an arm from its centre. */
static inline double building_shape(const BuildingModel *m, int j, double arm, int i)
{
    const double centre = m->phi[j * m->n + i];
    return m->turns_at ? centre + arm * m->phi[(m->turns_at + j) * m->n + i] : centre;
}

typedef struct {
    union {
        BuildingModel floors; /* alone, whose first fields are also those of the building: n is the number of floors */
        struct {
            int n;
            double *K, *M, *phi, *omega, *gamma, *zeta;
        };
    };
    double *storey_m;    /* (n) heights */
    double *yield_m;     /* (n) [m] drift at which a storey yields; 0: it stays elastic */
    double *yield_n_m;   /* (n) [N/m] the part of its stiffness that then yields */
    int yields;          /* any storey does */
    int heights_assumed; /* the files have none, and building.heights_m is left at those of the built-in tower */
    int hardening_raised;
    double hardening; /* [-] share that is left, as it was asked for or more (see above) */
    uint64_t hash;    /* FNV-1a of the numbers in the files */
    char note[400];   /* what of an OpenSees model was skipped; empty: nothing */

    BuildingModel model; /* what is integrated: the floors, or more */
    void *store, *model_store;
} Building;

Status building_load(Building *b, const BuildingOptions *o, Err *err);

/* [kg] that the ground moves, r' M r: the floors, of a frame also what is between them. */
double building_mass(const Building *b);

/* [kg] Row sum of M: what a floor's inertia force is under a uniform acceleration. floor: from 0. */
double building_floor_mass(const Building *b, int floor);

/* The damping ratios once more, by these options. */
Status building_damp(Building *b, const BuildingOptions *o, Err *err);
void building_free(Building *b);

/* By shape: like[k] is the mode i of the condensed model, shapes phi (n, n) and mass M (n, n), that mode k of a fuller
 * one, whose floors come first, resembles most: the largest (phi_i' M psi_k)^2, the share of mode k's kinetic energy in
 * that shape, of floors that turn in motion and rotation. -1: the floors have less than half of it (vertical modes). */
void building_alike(int n, const double phi[], const double M[], const BuildingModel *of, int like[]);

/* Room for a BuildingModel of model->n degrees of freedom (base/carve.h). */
void building_model_layout(void *model, Carve *c);

/* K and M (m, m) of the building's model with the core rigidly connected to its floors. */
void building_join_core(const CoreBeam *c, const BuildingModel *building, double K[], double M[]);

/* [Hz] of the lowest n modes of that. */
Status building_joined_hz(const CoreBeam *c, const Building *b, double hz[], Err *err);
