/* moga/credit.h -- how two infill criteria share a group: by what the designs that each has picked were worth.
 *
 *   part of i = (g_i / n_i)^p / sum_j (g_j / n_j)^p          p = CREDIT_POWER
 *
 * g_i and n_i are running means of its share of the gain and of the designs. The gain of a result is what it adds to
 * the front before it (infill_gain), measured by both criteria alike. Probability matching with a power: Thierens,
 * GECCO 2005, 1539-1546.
 *
 * Threads  pure functions of their arguments */
#pragma once

#include "base/pack.h"
#include "moga/infill.h"

/* Shares of the first criterion. */
typedef struct {
    double gain, designs;
} Credit;

/* Of some results: by measure and criterion that picked them; how many each has picked. */
typedef struct {
    double gain[INFILL_KINDS][INFILL_KINDS], designs[INFILL_KINDS];
} CreditResults;

double credit_part(const Credit *c); /* of a group, for the first criterion */
void credit_learn(Credit *c, const CreditResults *results);
void credit_pack(Credit *c, Pack *p);
