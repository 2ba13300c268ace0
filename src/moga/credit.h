/* moga/credit.h -- which of two infill criteria picks a group, but for one design: that whose designs were worth more.
 *
 * The gain of a result is what it adds to the front before it (infill_gain), measured by both criteria alike. Running
 * means of each criterion's share of the gain and of the designs are compared by their ratio. Adaptive pursuit:
 * Thierens, GECCO 2005, 1539-1546.
 *
 * Threads  pure functions of their arguments */
#pragma once

#include "moga/infill.h"

/* Shares of the first criterion. */
typedef struct {
    double gain, designs;
} Credit;

/* Of some results: by measure and criterion that picked them; how many each has picked. */
typedef struct {
    double gain[INFILL_KINDS][INFILL_KINDS], designs[INFILL_KINDS];
} CreditResults;

int credit_prefers_first(const Credit *c);
void credit_learn(Credit *c, const CreditResults *results);
