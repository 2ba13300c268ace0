/* study/simplify.h -- a design of a tower that can be built: fewer stops, gaps and plates as they are sold.
 *
 *   loss = max_k (f_k - f_k at the start) / (slack_k |f_k at the start|)     over the kept objectives, minimised; 1 is
 *                                                                           what may be lost
 *
 * A design that violates the run's limits by more than the start has a loss above 1.
 *
 *   1 start    the design as it is
 *   2 closing  stops that close under no record and in no replicate go: without them the results are the same
 *   3 zones    what is left of a zone of floors gets the mean of its numbers, and the word that most of them have
 *   4 steps    gaps to the nearest multiple of gap_step, walls to the nearest plate
 *   5 moved    while that loses too much, a descent on those numbers: of all designs with the gap of a floor or zone a
 *              step wider or narrower, or one wall a plate thicker or thinner, the one with the least loss; ROUNDS at
 *              most
 *   6 fewer    the devices of one floor or zone after another go, those with the least loss, while that is at most 1
 *
 * Where design.devices has the word none, devices go by it, links and the tuned mass too; else stops go, by a gap of
 * DESIGN_OPEN_M.
 *
 * Every design is simulated as the run's were: under all records, with all replicates. Where step 5 cannot keep what is
 * to be kept the path ends there, and the design with it.
 *
 * Ownership  simplify_design fills the caller's Simplified; simplified_free releases what it allocated
 * Threads    call it from one thread; the designs of a round share the simulator's workers */
#pragma once

#include "store/run.h"

enum { PLATES_MAX = 64 };

typedef struct {
    double slack[OBJECTIVES_MAX]; /* share of its value that an objective may lose; INFINITY: all */
    int zones;                    /* of floors that become alike; 0: none do */
    double gap_step;              /* [m] 0: gaps stay */
    size_t n_plates;              /* 0: walls stay */
    double plate[PLATES_MAX];     /* [m] ascending */
    int (*go_on)(void *user);     /* asked before each simulation, NULL: yes; 0: STATUS_STOPPED */
    void *user;
} SimplifyConfig;

typedef enum {
    SIMPLIFY_START,
    SIMPLIFY_CLOSING,
    SIMPLIFY_ZONES,
    SIMPLIFY_STEPS,
    SIMPLIFY_MOVED,
    SIMPLIFY_FEWER,
    SIMPLIFY_PATH
} Simplification;

typedef struct {
    EvaluationTable designs; /* the design after every simplification, in their order */
    size_t n;                /* of them */
    double loss[SIMPLIFY_PATH];
    size_t n_left[SIMPLIFY_PATH];                /* variables that stand for a device that may go */
    double error[SIMPLIFY_PATH][OBJECTIVES_MAX]; /* likely: what twice the steps change; NAN: not known */
    size_t n_evaluated;
    double seconds;
} Simplified;

/* The design in row `row` of a tower's run, with the settings that it was made with. */
Status simplify_design(const Run *run, size_t row, const SimplifyConfig *config, Simplified *out, Err *err);
void simplified_free(Simplified *s);
