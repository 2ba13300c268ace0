/* sim/joined.h -- floors and core rigidly connected (zero gap): M + Mc, K + Kc, as a building without a core.
 *
 *   (K + Kc) psi_k = w_k^2 (M + Mc) psi_k,   zeta_k = that of the building's mode which it resembles + the base's
 *
 * The sum of both damping matrices would leave the modes less than either part has alone, 1.9 % of 3 % in the first
 * mode of the tower under docs/study.md. The core's foundation adds its own (core_beam_base_loss).
 *
 * What mode k damps is booked under the modes i of building and core by their shares of its kinetic energy,
 *
 *   P_ik^2,   P_ik = phi_i' M psi_k,   sum_i P_ik^2 = 1
 *
 * Life  joined_make -> runs of `building` without a core, each then booked -> joined_free.
 * Threads  read-only between */
#pragma once

#include "scene/building.h"
#include "sim/result.h"

typedef struct {
    Building building; /* as it is, but for its model: that of both */
    const int *like;   /* (m) of the building alone */
    int n, m;          /* modes of the core, of the building and of both */
    int shares;        /* modes of both whose shares are known */
    double *P;         /* (m + n, m) the building's rows first */
    void *store;
} Joined;

Status joined_make(Joined *j, const Building *b, const CoreBeam *core, Err *err);
void joined_free(Joined *j); /* a zeroed one is fine */

/* Books the energy shares of a run of the joined building under the first modes of both. */
void joined_book(const Joined *j, SimResult *r);
