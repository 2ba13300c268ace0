/* simulator/options.h -- what is searched: section [problem]; all but the kind only where it is not the tower. */
#ifndef IMTET_SIMULATOR_OPTIONS_H
#define IMTET_SIMULATOR_OPTIONS_H

#include "base/option.h"

/* In the order of simulator/textbook.h. */
#define TEXTBOOK_LIST(X)                                                                                               \
    X(PROBLEM_DTLZ2, "dtlz2")                                                                                          \
    X(PROBLEM_WFG4, "wfg4")                                                                                            \
    X(PROBLEM_DTLZ1_INVERTED, "dtlz1_inverted")                                                                        \
    X(PROBLEM_DTLZ5, "dtlz5")                                                                                          \
    X(PROBLEM_DTLZ7, "dtlz7")                                                                                          \
    X(PROBLEM_WFG5, "wfg5")
#define PROBLEM_KIND_LIST(X) X(PROBLEM_TOWER, "tower") X(PROBLEM_EXTERNAL, "external") TEXTBOOK_LIST(X)
typedef enum {
    PROBLEM_KIND_LIST(CHOICE_NAME) PROBLEM_KIND_COUNT,
    PROBLEM_TEXTBOOK = PROBLEM_EXTERNAL + 1 /* and whatever follows it */
} ProblemKind;

#define NOISY_LIST(X) X(NOISY_AUTO, "auto") X(NOISY_NO, "no") X(NOISY_YES, "yes")
typedef enum { NOISY_LIST(CHOICE_NAME) } Noisy;

typedef struct {
    ProblemKind kind;
    char command[OPTION_TEXT_MAX];
    double timeout_s;
    long variables, objectives;
    char lower[OPTION_TEXT_MAX], upper[OPTION_TEXT_MAX]; /* one number or a comma list */
    char senses[OPTION_TEXT_MAX];                        /* min or max, one word or a list */
    char variable_names[OPTION_TEXT_MAX], objective_names[OPTION_TEXT_MAX];
    char costs[OPTION_TEXT_MAX]; /* of the levels that the program answers at, or none */
    Noisy noisy;
    double noise; /* [-] of a textbook problem's answers */
} ProblemOptions;

#endif
