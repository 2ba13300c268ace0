/* study/summary.h -- what a session of a study comes to. */
#pragma once

#include <limits.h>

#include "moga/search.h"
#include "analysis/baselines.h"
#include "study/final_polish.h"
#include "study/front_review.h"

typedef struct {
    char folder[PATH_MAX];
    StopReason stopped;
    size_t n_simulated, n_failed, n_front, n_repeats;
    FinalPolished polish; /* at the end */
    size_t n_before;      /* simulations that the run had when this session began */
    long max_evals;
    double seconds;       /* of all sessions */
    double busy_s;        /* of this session in simulations, all threads added */
    size_t n_screened;    /* as in SearchView, of this session's last generation; 0: none, or not known */
    size_t n_evaluations; /* with n_screened: of max_evals */
    double level_agreement;
    int has_left_screening;
    int has_baselines; /* of a tower whose front has a knee; of its core */
    Baseline baseline[N_SCENES];
    FrontReview review; /* of the same */
} StudySummary;
