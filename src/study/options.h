/* study/options.h -- how long and by what means a study searches, and where it is stored: sections [search], [run]. */
#ifndef IMTET_STUDY_OPTIONS_H
#define IMTET_STUDY_OPTIONS_H

#include "moga/options.h"

typedef struct {
    long seed, threads, population, initial, generations, max_evals;
    double max_hours; /* OPTION_WORD: by the Slurm job */
    double nondominated_share, trust_error;
    double crossover_probability, crossover_eta, mutation_eta, mutation_rate;
    long surrogate_max; /* largest number of centres of the surrogate */
    SurrogateUse surrogate;
    Switch asynchronous;
    Fidelity fidelity;
    SelectionKind survival;
    double replicate_share;              /* share of max_evals */
    long replicates_min, replicates_max; /* of a design */
    long stop_after;                     /* evaluations without gain; 0: any number */
    long failures_max;                   /* evaluations in a row that fail; 0: any number */
    long polish;                         /* designs at the end */
    double polish_gain_min;              /* [-] of the range of an objective on the front */
    char objectives[OPTION_TEXT_MAX], limits[OPTION_TEXT_MAX];
    char start[OPTION_TEXT_MAX]; /* a CSV of designs or a run's folder, or none */
} SearchOptions;

typedef struct {
    char out[OPTION_TEXT_MAX]; /* the run's folder */
} RunOptions;

#endif
