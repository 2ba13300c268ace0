/* evaluate/consequences.h -- what peak drifts and accelerations mean for a building of offices: damage states and cost.
 *
 *   P(state s or worse | demand) = Phi(ln(demand / median_s) / beta)       s: slight, moderate, extensive, complete
 *   cost of a part = sum_s P(state s) cost_s                               [share of replacing the whole building]
 *   loss = sum over parts of the mean over storeys or floors of their cost, those of a part in proportion to what
 *          SimOptions.repair says of it, destroyed
 *
 * A steel frame by its drift ratio in every storey, parts that break by drift (partitions, facades) likewise, parts
 * that break by acceleration (ceilings, machines, pipes) by the peak of the floor above it: unfiltered, so that spikes
 * of impacts count in full. Every storey is worth the same; neither collapse nor a building that leans too much to be
 * repaired counts, so that the loss is a measure to compare designs by, not an estimate.
 *
 * Source   FEMA, Hazus Earthquake Model Technical Manual 5.1 (2022): limits of drift of S1L at high code, which are
 *          those of single storeys (those of S1M and S1H are of whole buildings); of parts sensitive to drift; of parts
 *          sensitive to acceleration at high code; repair cost ratios of COM4 (offices). As single storeys, with one
 *          beta per part: NHERI-SimCenter DamageAndLossModelLibrary, Hazus v5.1 subassembly and portfolio
 * Threads  pure functions */
#pragma once

#include "sim/result.h"

typedef enum { PART_STRUCTURE, PART_DRIFT, PART_ACCELERATION, N_PARTS } DamagedPart;

enum { DAMAGE_STATES = 4, DAMAGE_WORDS_MAX = 400 };

extern const struct DamagePart {
    const char *key, *words;
    double median[DAMAGE_STATES]; /* drift ratio [-], or acceleration [g] */
    double beta;
    double cost[DAMAGE_STATES]; /* share of replacing the building, were all of it in that state */
} DAMAGE_PARTS[N_PARTS];

/* 0: none, 1: slight ... 4: complete, the last whose median is reached. */
int damage_state(DamagedPart part, double demand);
const char *damage_word(int state);

/* Expected, of one storey or floor. */
double damage_cost(DamagedPart part, double demand);

double damage_loss(const SimResult *r);
double damage_loss_of_neighbour(const SimResult *r);

/* In which state the worst storey or floor of every part is, and the loss, in text; empty: the simulation failed.
 * Returns text. */
const char *damage_words(const SimResult *r, char text[DAMAGE_WORDS_MAX]);
