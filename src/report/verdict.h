/* report/verdict.h -- what a design comes to, in five sentences that are the same wherever it is shown.
 *
 *   1  J1, drift ratio and J3 over those of no core, rigidly connected and viscous links: the median of the ratio over
 *      the records, and in how many the design is the better one; links where they were evaluated
 *   2  under the first record, with the effects that are needed (analysis/ladder.h) beside those of the study, and by
 *      which scene: an effect stands at the first of design, rigid connection and building alone that needs it
 *   3  as built: mean and standard deviation of VERDICT_REPLICATES structures under the first record, whose gaps are
 *      off by sim.gap_tolerance_m, or by VERDICT_GAP_M where that is 0
 *   4  largest demand over the records / its limit, in descending order: of the core the yield stress of S235 (EN
 *      10025-2), its bare wall's buckling, uplift of its foundation, or where that is clamped G b / 2, the moment that
 *      its own weight holds; of the contact law the indentation; of the building extensive damage
 *      (evaluate/consequences.h)
 *   5  what to do next, as a command: a search with the effects of 2 and, for each limit of 4 that is exceeded, with
 *      stiffeners (buckling), anchors (uplift), else that limit. Where none of these is wanted, one that sees gaps that
 *      are off, one with links where these are better, or the design made easier to build
 *
 * Stored   RUN/verdicts.json, {"ID": "sentence\nsentence ..."}: a design of a run is judged once. Without the file it
 *          is judged anew; a folder that cannot be written stores none
 * Errors   of the simulation that failed; another engine than fast */
#pragma once

#include "analysis/evaluations.h"
#include "analysis/ladder.h"
#include "store/run.h"

enum { VERDICT_REPLICATES = 16 };
static const double VERDICT_GAP_M = 5e-3;

/* 1: value is better than other by more than a thousandth of it and the error; -1: worse; 0: neither, or not known.
 * sense: +1, less is better. */
int verdict_compare(double sense, double value, double error, double other);

typedef struct {
    const char *operand;  /* what commands are given, as a shell takes it: a run or a settings file, with options */
    const char *design;   /* of that run, without options; NULL: another */
    const Ladder *ladder; /* of the design under the first record; NULL: it is found */
} VerdictOf;

/* e: evaluated at one intensity with sim.forces = yes, by the settings s; x (n_var). out: a line for every sentence,
 * to be freed. */
Status verdict_find(const Settings *s, const Evaluations *e, const double x[], const VerdictOf *of, char **out,
                    Err *err);

/* Finds the verdict on a design of a run of the tower; s: its settings, with the records where they are now. ladder: as
 * above. */
Status verdict_of_run(const Run *run, size_t row, const Settings *s, const Ladder *ladder, char **out, Err *err);
