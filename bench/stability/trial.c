#include "bench/stability/trial.h"

#include <stdarg.h>
#include <stdio.h>

#include "sim/fast/fast.h"

static const double RESIDUAL_MAX = 1e-3; /* of sim.energy_balance_max by default */

const EngineEntry *trial_engine(const Trial *t)
{
    return bench_engine(t->engine);
}

double trial_steps(const Trial *t)
{
    return t->accuracy == ACCURACY_FINE ? 400 : 40;
}

double trial_slack(const Trial *t)
{
    return t->engine == ENGINE_FAST || t->engine == ENGINE_CVODE ? 1 : 10;
}

double trial_allowed(const Trial *t, double fine, double standard)
{
    return t->accuracy == ACCURACY_FINE && trial_slack(t) == 1 ? fine : standard;
}

double trial_tolerance(const Trial *t, double contact_duration, double steps)
{
    return trial_engine(t)->tolerance == TOLERANCE_STEP ? contact_duration / steps : 0;
}

static SimResult run_once(Trial *t, const SimModel *model, const Motion *motion, double duration, double tolerance)
{
    SimResult r = {0};
    Err err = {0};
    const EngineOptions options = {.duration = duration, .accuracy = t->accuracy, .tolerance = tolerance};
    if (trial_engine(t)->run(model, motion, &options, &r, &err) != STATUS_OK) {
        r.outcome = RUN_ENGINE_FAILED;
        snprintf(r.reason, sizeof r.reason, "%.*s", (int)sizeof r.reason - 1, err.text);
    }
    return r;
}

SimResult trial_run(Trial *t, const SimModel *model, const Motion *motion, double duration, double tolerance)
{
    SimResult r = run_once(t, model, motion, duration, tolerance);
    /* what sim_run does for the engine `fast` when its energy balance does not close */
    for (double finer = 4;
         t->engine == ENGINE_FAST && tolerance == 0 && finer < 17 && r.energy_balance_error > RESIDUAL_MAX; finer *= 4)
        r = run_once(t, model, motion, duration, finer * fast_tolerances(t->accuracy).steps_per_contact);
    return r;
}

static void settle(Trial *t, Verdict verdict, double figure, double closeness, const char *how)
{
    if (t->any && (verdict < t->verdict || (verdict == t->verdict && !(closeness > t->closeness))))
        return;
    t->any = 1;
    t->verdict = verdict;
    t->figure = figure;
    t->closeness = isnan(closeness) ? HUGE_VAL : closeness;
    snprintf(t->how, sizeof t->how, "%s", how);
}

static void note(Trial *t, const SimResult *r, double error, double allowed, const char *what)
{
    static const char *const ACCURACIES[] = {
        [ACCURACY_COARSE] = "coarse", [ACCURACY_STANDARD] = "standard", [ACCURACY_FINE] = "fine"};
    char how[240];
    Verdict verdict = HOLDS;
    if (r && r->outcome != RUN_OK) {
        verdict = REFUSED;
        snprintf(how, sizeof how, "%s, %s: %s: %s", what, ACCURACIES[t->accuracy], run_outcome_words(r->outcome),
                 r->reason);
        error = NAN;
    } else {
        if (!(error <= allowed))
            verdict = r && (r->energy_balance_error > RESIDUAL_MAX || beyond_contact_law(r)) ? FLAGGED : FAILED;
        if (verdict == HOLDS)
            snprintf(how, sizeof how, "%s, %s; allowed %.2g", what, ACCURACIES[t->accuracy], allowed);
        else
            snprintf(how, sizeof how, "%s, %s; allowed %.2g; energy-balance error %.2g", what, ACCURACIES[t->accuracy],
                     allowed, r ? r->energy_balance_error : 0);
    }
    settle(t, verdict, error, allowed > 0 ? error / allowed : error, how);
}

void trial_note(Trial *t, const SimResult *r, double error, double allowed, const char *what, ...)
{
    char text[160];
    va_list list;
    va_start(list, what);
    vsnprintf(text, sizeof text, what, list);
    va_end(list);
    note(t, r, error, allowed, text);
}

void trial_compare(Trial *t, const SimResult *r, double actual, double wanted, double scale, double allowed,
                   const char *what, ...)
{
    char text[160];
    va_list list;
    va_start(list, what);
    vsnprintf(text, sizeof text, what, list);
    va_end(list);
    note(t, r, fabs(actual - wanted) / scale, allowed, text);
}

void trial_remark(Trial *t, const char *text, ...)
{
    const size_t used = strlen(t->remark);
    va_list list;
    va_start(list, text);
    vsnprintf(t->remark + used, sizeof t->remark - used, text, list);
    va_end(list);
}
