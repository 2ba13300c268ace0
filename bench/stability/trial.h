/* bench/stability/trial.h -- one property put to one engine, and what came of it.
 *
 *   holds    every figure within what is allowed
 *   flagged  a figure is off, and the result says so: energy_balance_error above the default of sim.energy_balance_max,
 *            or penetration beyond the contact law
 *   refused  the engine said that it cannot (outcome or status), or did not answer within the time given
 *   FAILED   a wrong answer in silence, or a crash
 *
 * A case calls trial_compare (and its kin) once per figure; the worst verdict stays, and of equal verdicts the figure
 * nearest to its bound. */
#pragma once

#include "bench/stability/oracle.h"

#include "bench/engines/engines.h"

typedef enum { HOLDS, FLAGGED, REFUSED, FAILED, VERDICTS } Verdict;
typedef enum { SIZE_QUICK, SIZE_FULL, SIZE_LONG } TrialSize;

typedef struct {
    int engine;
    TrialSize size;
    Accuracy accuracy;
    Verdict verdict;
    int any;                  /* a figure was noted */
    double figure, closeness; /* measured; over what is allowed */
    char how[240];            /* what the figure is, or why it was refused */
    char remark[400];         /* more measured figures */
} Trial;

typedef struct {
    const char *name, *sentence;
    void (*run)(Trial *t);
} Case;

typedef struct {
    const Case *cases;
    int n;
} CaseGroup;

extern const CaseGroup BOB_CASES, TOWER_CASES;

const EngineEntry *trial_engine(const Trial *t);

/* The engine's own tolerance for a contact of this duration: fixed-step engines take so many steps per contact, the
 * others follow their accuracy. */
double trial_tolerance(const Trial *t, double contact_duration, double steps);

/* Fine: what closed forms are compared at; standard: what a user gets. The engines that are there to be compared with
 * are held to the bounds of standard at fine, and to ten times what standard promises of the tower; `fast` and `cvode`
 * are given no slack. */
double trial_steps(const Trial *t);
double trial_slack(const Trial *t);
double trial_allowed(const Trial *t, double fine, double standard);

/* Runs a model built by hand; a Status that is not OK is an outcome with a reason. */
SimResult trial_run(Trial *t, const SimModel *model, const Motion *motion, double duration, double tolerance);

/* error <= allowed holds, else what r says of itself decides. NaN never holds. */
__attribute__((format(printf, 5, 6))) void trial_note(Trial *t, const SimResult *r, double error, double allowed,
                                                      const char *what, ...);

/* |actual - wanted| / scale */
__attribute__((format(printf, 7, 8))) void trial_compare(Trial *t, const SimResult *r, double actual, double wanted,
                                                         double scale, double allowed, const char *what, ...);

/* The same with what is wanted as the scale. */
#define trial_close(t, r, actual, wanted, allowed, ...)                                                                \
    trial_compare(t, r, actual, wanted, wanted, allowed, __VA_ARGS__)

__attribute__((format(printf, 2, 3))) void trial_remark(Trial *t, const char *text, ...);

/* Both accuracies, one after the other. */
#define TRIAL_EACH_ACCURACY(t)                                                                                         \
    for (int each_ = 0; each_ < 2 && ((t)->accuracy = each_ ? ACCURACY_STANDARD : ACCURACY_FINE, 1); each_++)
