/* study/simplify.h -- a design of a tower that can be built: fewer stops, gaps and plates as they are sold; a method of
 * study/improver.h, whose value is the loss.
 *
 *   1 start    the design as it is
 *   2 closing  stops that close under no record and in no replicate go: without them the results are the same
 *   3 zones    what is left of a zone of floors gets the mean of its numbers, and the word that most of them have
 *   4 steps    gaps to the nearest multiple of gap_step, walls to the nearest plate
 *   5 moved    while that loses too much, a descent on those numbers: of all designs with the gap of a floor or zone a
 *              step wider or narrower, or one wall a plate thicker or thinner, the one with the least loss
 *   6 fewer    the devices of one floor or zone after another go, those with the least loss, while that is at most 1
 *
 * Where design.devices has the word none, devices go by it, links and the tuned mass too; else stops go, by a gap of
 * DESIGN_OPEN_M.
 *
 * Every design is simulated as the run's were: under all records, with all replicates; those of a round side by side.
 * What twice the steps change in a design of the path is its error. Where step 5 cannot keep what is to be kept the
 * path ends there, with the design on steps that loses least. */
#pragma once

#include "study/improver.h"

/* Designs of the path. */
typedef enum {
    SIMPLIFY_START,
    SIMPLIFY_CLOSING,
    SIMPLIFY_ZONES,
    SIMPLIFY_STEPS,
    SIMPLIFY_MOVED,
    SIMPLIFY_FEWER,
    SIMPLIFY_PATH
} Simplification;

/* An ImproveMethod. */
Status simplify_design(Improver *m, Err *err);
