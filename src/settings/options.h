/* settings/options.h -- the options of all modules together: what a settings file says. How it is read, checked and
 * written: settings.h. A module takes its own options; who passes all of them on declares `typedef struct Settings
 * Settings;`.
 *
 * Ownership  a plain value without pointers: copy it freely */
#pragma once

#include "base/linalg.h"
#include "settings/search_options.h"
#include "motion/options.h"
#include "scene/options.h"
#include "sim/options.h"

/* -- [problem]: all but the kind only where it is not the tower -- */

#define PROBLEM_KIND_LIST(X) X(PROBLEM_TOWER, "tower") X(PROBLEM_EXTERNAL, "external")
typedef enum { PROBLEM_KIND_LIST(CHOICE_NAME) } ProblemKind;

#define NOISY_LIST(X) X(NOISY_AUTO, "auto") X(NOISY_NO, "no") X(NOISY_YES, "yes")
typedef enum { NOISY_LIST(CHOICE_NAME) } Noisy;

typedef struct {
    ProblemKind kind;
    char command[OPTION_TEXT_MAX];
    double timeout_s;
    long variables, objectives;
    char lower[OPTION_TEXT_MAX], upper[OPTION_TEXT_MAX]; /* one number or a comma list */
    char kinds[OPTION_TEXT_MAX];                         /* of the variables (evaluate/kinds.h) */
    char senses[OPTION_TEXT_MAX];                        /* min or max, one word or a list */
    char variable_names[OPTION_TEXT_MAX], objective_names[OPTION_TEXT_MAX];
    Noisy noisy;
    long constraints; /* values g of every answer; below 0: the first one tells. No setting: of each run */
} ProblemOptions;

/* -- [search], [run] -- */

typedef struct {
    long seed, threads, population, initial, max_evals;
    double max_hours; /* OPTION_WORD: by the Slurm job */
    SurrogateUse surrogate;
    long ahead; /* OPTION_WORD: by the number of designs */
    Fidelity fidelity;
    double replicate_share; /* share of max_evals */
    long replicates_max;    /* of a design */
    long stop_after;        /* evaluations without gain; 0: any number */
    long failures_max;      /* evaluations in a row that fail; 0: any number */
    long polish;            /* designs at the end */
    char objectives[OPTION_TEXT_MAX], limits[OPTION_TEXT_MAX], aspire[OPTION_TEXT_MAX];
    char start[OPTION_TEXT_MAX]; /* a CSV of designs or a run's folder, or none */
} SearchOptions;

typedef struct {
    Switch isolate;
    char out[OPTION_TEXT_MAX]; /* the run's folder */
} RunOptions;

typedef struct Settings {
    BuildingOptions building;
    CoreOptions core;
    ContactOptions contact;
    MotionOptions motion;
    SimOptions sim;
    DesignOptions design;
    ProblemOptions problem;
    SearchOptions search;
    RunOptions run;
    unsigned char given[32]; /* a bit for each line of the table: something has said it (settings_gives) */
} Settings;

/* The settings that a scene needs. */
static inline SceneOptions settings_scene(const Settings *s)
{
    return (SceneOptions){s->building, s->core, s->contact, s->sim, s->design};
}
