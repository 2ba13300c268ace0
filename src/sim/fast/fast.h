/* sim/fast/fast.h -- the engine `fast`: exact modal flow, resolved contacts, certified free flights.
 *
 * Time      every sampling interval of the motion is halved as often as needed: steps of 2^-L intervals, aligned, so
 *           that no step straddles a kink of the ground motion and all propagators are tabled per level L.
 * Flight    without contact the modes flow exactly. A step is accepted where it is certain that no gap closes in it and
 *           that every peak is known: slow modes (w h below FAST_MODE) by the Bezier hull of the Hermite cubic plus its
 *           error bound (w h)^4/384 A, fast ones by their amplitude A around the quasi-static answer.
 * Free      several intervals at once where bounds of the modes reach no gap and no peak.
 * Contact   steps whose energy balances: of a fixed share of a Hertz contact's duration or shorter where a gap closes
 *           or the other side of the core may be reached, else longer; shorter where several floors meet the core at
 *           once, and less exact where little energy is left (kernel.c). Over a step the force of floor j is
 *               f(x) = F0 (1-x) + F1 x + 6 (mean - (F0+F1)/2) x (1-x),
 *           which the modes answer exactly; F1 and the mean come from the force law along the Hermite cubic of the
 *           indentation, implicitly: Newton's method over all floors in contact, on the n x n compliances of w to those
 *           forces. Onsets and ends of contact inside a step are located on the cubic. Order 4 between events, 3.5
 *           across them.
 * Energy    the work of every load on every mode is integrated exactly; what a mode damps is work minus energy. The
 *           energy-balance error adds two: the work that the modes took from contacts against the energies that the
 *           force law stored and lost, over the input; and what the equations of motion, integrated over the run, are
 *           missed by, sqrt(sum d_i^2 / 2 E_in), which would show an error in the linear flow.
 * Maxima    flights: extremum of the Hermite cubic; contacts: parabola through start, middle and end of each step,
 *           refused where the peak is uncertain.
 * Core      modes whose static flexibility hardly softens a contact follow the forces without delay, w += S f with
 *           S_ij = sum R_i R_j / w^2, w' += S f'; they damp nothing and do not follow the ground.
 *
 * Files     kernel.c: step control, results, and the *.inc files in order: design, step_tables, contact_quadrature,
 *           peaks, free_flight, free_interval, contact_forces (with storey_step, device_step), contact_step.
 * Life      fast_create -> fast_run ... -> fast_free. Threads  one FastWork per thread. No allocation in fast_run. */
#pragma once

#include "sim/engine.h"
#include "sim/fast/tolerances.h"

typedef struct FastWork FastWork;

/* For up to n_floors, nb building modes and so many devices; yields: storeys of a model may. */
Status fast_create(FastWork **out, int n_floors, int nb, int yields, int devices, Err *err);
void fast_free(FastWork *work); /* NULL is fine */

/* "avx512", "avx2" or "base": the kernel that this processor gets. */
const char *fast_kernel_name(void);

FastTolerances fast_tolerances(Accuracy accuracy);

/* Runs the engine; of the options it reads duration, onsets and sample. */
void fast_run(FastWork *work, const SimModel *model, const Motion *motion, const EngineOptions *options,
              const FastTolerances *tolerances, SimResult *result);
