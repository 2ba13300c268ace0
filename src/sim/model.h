/* sim/model.h -- one design, ready to be integrated: both structures as modes, and the contacts between them.
 *
 *   q_i'' + 2 zeta_i w_i q_i' + w_i^2 q_i = -gamma_i a(t) + sum_j R_ij f_j(t)      i = 0..m-1
 *   w_j  = u_j - v_j = sum_i R_ij q_i                                              j = 0..n-1
 *   f_j  = -s F(p_j, p_j', v0_j),  s = sign(w_j - middle_j),  p_j = |w_j - middle_j| - gap_j
 *
 * A storey that yields adds k_j p_j to the force between its floors, p_j its plastic drift (sim/storey.h), so that mode
 * i gets sum_j (R_ij - R_i,j-1) k_j p_j on the right-hand side.
 *
 * Modes 0..nb-1 are the building's (R_ij = phi_ji; nb may exceed n, scene/building.h), nb..m-1 the core's (R_ij =
 * -phi_ji); u_j = sum_{i<nb} R_ij q_i.
 * The absolute acceleration of floor j is sum_{i<nb} R_ij (-2 zeta_i w_i q_i' - w_i^2 q_i + contact part of mode i),
 * since sum_{i<nb} R_ij gamma_i = 1: the motion of the ground is in the span of the building's modes.
 *
 * A device e (sim/device.h) adds -B_ei F_e to mode i; the mat of a core that lifts is the last one. The tuned mass is
 * the last mode, of frequency 0, which moves no floor: x = q / sqrt(mass) from the ground.
 *
 * A floor that may go right (u > v) by g_R and left by g_L has gap = (g_R + g_L) / 2 around middle = (g_R - g_L) / 2.
 *
 * Floors that turn (scene/torsion.h) have modes of rotation among those of the building: R is where they touch, u_j
 * is at the centre, and peaks are those of the edges as well. A neighbour's floors have peaks too. Then what is
 * watched are sets of n points with a row of zeros between two of them: y_p = sum_i U_ip q_i.
 *
 * Layout   rows padded with zeros to a multiple of 8, 64-byte aligned: floors to n_pad, modes to m_pad.
 * Padding  a padded floor has an unreachable gap, a padded mode has omega = 1 and no coupling.
 * Life     model_create for the largest case, model_set per design, model_free. Threads  one owner at a time. */
#pragma once

#include "scene/building.h"
#include "scene/core_beam.h"
#include "sim/contact.h"
#include "sim/device.h"
#include "sim/result.h"
#include "sim/storey.h"

/* At most, of n floors. */
#define POINTS_OF(n) (4 * (n) + 3)
enum { POINTS_MAX = POINTS_OF(FLOORS_MAX) + 5 };

typedef struct {
    int n, nb, nc, m; /* floors, building modes, core modes, nb + nc */
    int n_pad, m_pad;
    double *R;        /* (m_pad, n_pad) [1/sqrt(kg)] a row per mode */
    double *RT;       /* (n_pad, m_pad) the same, a row per floor */
    double *omega;    /* (m_pad) [rad/s] */
    double *zeta;     /* (m_pad) [-] */
    double *gamma;    /* (m_pad) [sqrt(kg)] */
    int *like;        /* (nb) under which of n modes the share of a building mode is booked, -1: none */
    double *gap;      /* (n_pad) [m] half of the way from one side to the other */
    double *middle;   /* (n_pad) [m] of that way, in w; 0: the sides are alike */
    double *mass_eff; /* (n_pad) [kg] 1/sum_i R_ij^2: what a short contact at floor j has to turn round */
    double core_mass_kg;
    Contact contact[FLOORS_MAX]; /* (n) */
    int yields;                  /* any storey does: */
    StoreyLaw storey_law;
    double yield_m[FLOORS_MAX], yield_n_m[FLOORS_MAX]; /* (n) [m], [N/m]; of a storey that stays elastic 1e300, 0 */
    int n_devices, has_mass, may_lift;
    Device device[FLOORS_MAX + 2]; /* (n_devices) */
    double *B;                     /* (n + 2, m_pad) [1/sqrt(kg)] a row per device */
    int points, p_pad;             /* with the rows between the sets */
    int neighbour_at;              /* the first point of a neighbour's floors, so many; 0: it has none */
    int neighbour_floors;
    double *U;      /* (m_pad, p_pad) [1/sqrt(kg)] centres first; R where these are all */
    double *U_room; /* of that */
    void *store;
} SimModel;

/* Room for n floors with up to nb_max building modes, n core modes. like: mode by mode. */
Status model_create(SimModel *model, int n, int nb_max, Err *err);

/* Points of a scene of this building. */
int model_points(const SceneOptions *o, const Building *b);

/* gaps (n) [m] of both sides; core NULL: the building alone (nc = 0, no gap can close). */
Status model_set(SimModel *model, const SceneOptions *o, const Building *b, const CoreBeam *core, const double gaps[],
                 Err *err);
void model_free(SimModel *model);

/* Gaps (n) [m] side by side (SIDES); INFINITY: there is nothing on that side. A negative gap and NAN are refused. */
Status model_set_gaps(SimModel *model, const double right[], const double left[], Err *err);

/* A tuned mass [kg] on a model without devices: one mode more. */
void model_add_mass(SimModel *model, double mass);

/* A device between its floor and the core beside it, or the tuned mass. */
void model_add_device(SimModel *model, const Device *device, int on_mass);

/* The mat of a core that may lift, else nothing; the core of the model, or joined to its building (sim/joined.h). */
void model_add_uplift(SimModel *model, const CoreBeam *core);

/* Reports the peaks of the devices, peak (n_devices). */
void model_report_devices(const SimModel *model, const DevicePeak peak[], SimResult *result);

/* Penetration of floor j on side s = 1, -1 where u_j - v_j is w [m]. */
static inline double penetration(const SimModel *model, int j, int s, double w)
{
    return s * (w - model->middle[j]) - model->gap[j];
}

/* f_j (n) [N] on floor j by plastic drifts p (n) [m] of the storeys: B' [k p], k p of its own storey less that of the
 * storey above. */
void model_plastic_forces(const SimModel *model, const double p[], double f[]);

/* Fills what SimResult has of storeys that yielded and ended with plastic drifts p (n); energies are the engine's. */
void model_report_plastic(const SimModel *model, const double p[], SimResult *result);

/* Peaks of all points, displacement [m], drift [m], acceleration and that behind the filter [m/s2], or NULL, to the
 * floors that have them. */
enum { POINT_PEAKS = 4 };
void model_report_peaks(const SimModel *model, const double *const of[POINT_PEAKS], SimResult *result);

/* out_j = sum_{first <= i < end} rows_ij x_i, (end, width); a padded width. */
void rows_from_modes(const double rows[], int width, int first, int end, const double x[], double out[]);

/* For every floor at the contacts; out (n_pad). */
static inline void floors_from_modes(const SimModel *model, int first, int end, const double x[], double out[])
{
    rows_from_modes(model->R, model->n_pad, first, end, x, out);
}

/* Row of mode i: the floors' centres first. */
static inline const double *centre_row(const SimModel *model, int i)
{
    return model->U + (size_t)i * (size_t)model->p_pad;
}

/* How many modes move the points. */
static inline int point_modes(const SimModel *model)
{
    return model->neighbour_at ? model->m : model->nb;
}

/* All points, of a state of the modes. */
static inline void points_from_modes(const SimModel *model, const double x[], double out[])
{
    rows_from_modes(model->U, model->p_pad, 0, point_modes(model), x, out);
}
