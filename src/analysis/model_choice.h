/* analysis/model_choice.h -- the model that a study takes where sim.model = auto: of the effects of analysis/ladder.h
 * that its settings leave open, those that some designs need under its records.
 *
 *   open       the settings do not give the effect's key (settings_gives). All others stay as they are. The weak end of
 *              the records is open where one end fits all of them and only peaks are searched for
 *   case       a design under a record: three designs, whose gaps are spread up to where the bare building sways, under
 *              every record of the study. The first cases have all designs and all records once
 *   choosing   in every case each effect that no case before has needed is left out of the model with all; then the
 *              set is tried in every case, and what is left out and changes most is put back until it is within the
 *              tolerance. As the ladder, which is one case in which everything is asked, but for the scatter as built:
 *              that of COPIES structures of each case
 *   confirming the set is tried in the same way in cases of given designs
 *   cost       60 simulations or 3 % of those of the study, the larger: cases beyond are not looked at, and a set that
 *              cannot be tried any more has one more effect than the last one that was
 *
 * Deterministic  at any number of threads; only the seconds differ
 * Errors         STATUS_BAD_DATA: the model with all effects fails in every case; STATUS_STOPPED: go_on said so */
#pragma once

#include "analysis/ladder.h"

typedef struct {
    Ladder ladder; /* value, set: of the first case; off: of the worst; effect: the largest changes; is_set: not open */
    size_t n_designs, n_records, n_cases, n_simulations;
} ModelChoice;

/* Cases of given designs, which are confirmed. */
typedef struct {
    const double *x;
    size_t record;
    Measured by_set, by_more; /* by the set that was chosen, by that with what was put back */
} ModelCase;

/* The open effects of s become those that the scene needs. */
Status model_choose(Settings *s, const Observer *stop, ModelChoice *out, Err *err);

/* l: what was chosen, which s has; X (n, n_var). What the designs need beside it joins the set. cases: for free. */
Status model_confirm(const Settings *s, size_t n, size_t n_var, const double X[], const Observer *stop, Ladder *l,
                     ModelCase **cases, size_t *n_cases, Err *err);
