/* settings/settings.h -- every setting of a study in one struct, described by one table (settings.c).
 *
 *   [section]            an INI file; a key is "section.key"
 *   key = value          a setting that is not written keeps its default
 *
 * The reader, the range check, `--set section.key=value`, `imtet settings` and the copy saved with a run are loops
 * over the table: a new setting is one line there and one field here. Rules that tie settings together stand below
 * the table (settings_check).
 *
 * Ownership  Settings is a plain value: copy it freely.   Threads  no state. */
#ifndef IMTET_SETTINGS_SETTINGS_H
#define IMTET_SETTINGS_SETTINGS_H

#include <stddef.h>
#include <stdio.h>

#include "base/status.h"

enum { SETTINGS_TEXT_MAX = 512 };

typedef enum { CORE_BOX, CORE_PLATE, CORE_EFFECTIVE } CoreSection;
typedef enum { LAW_PAPER, LAW_EXACT, LAW_LANKARANI_NIKRAVESH, LAW_FLORES, LAW_JANKOWSKI } ContactLaw;
typedef enum { ACCURACY_COARSE, ACCURACY_STANDARD, ACCURACY_FINE } Accuracy;
/* Every integrator of the model, by the name of the setting; sim/engine.c has a line for each. */
#define ENGINE_LIST(X)                                                                                                 \
    X(FAST, fast)                                                                                                      \
    X(CVODE, cvode)                                                                                                    \
    X(CVODE_BDF, cvode_bdf)                                                                                            \
    X(CVODE_BDF_TUNED, cvode_bdf_tuned)                                                                                \
    X(ARKODE_ERK, arkode_erk)                                                                                          \
    X(ARKODE_ERK_NOEVENTS, arkode_erk_noevents)                                                                        \
    X(ARKODE_DIRK, arkode_dirk)                                                                                        \
    X(ARKODE_IMEX, arkode_imex)                                                                                        \
    X(ETDRK4, etdrk4)                                                                                                  \
    X(LAGGED, lagged)                                                                                                  \
    X(NEWMARK, newmark)                                                                                                \
    X(HHT, hht)                                                                                                        \
    X(CENTRAL, central)                                                                                                \
    X(RADAU, radau)
typedef enum {
#define X(upper, lower) ENGINE_##upper,
    ENGINE_LIST(X)
#undef X
        ENGINE_COUNT
} Engine;
/* PROBLEM_TEXTBOOK and what follows it: simulator/textbook.h, in its order. */
typedef enum { PROBLEM_TOWER, PROBLEM_EXTERNAL, PROBLEM_TEXTBOOK } ProblemKind;
typedef enum { ROBUST_WORST, ROBUST_MEAN } Robust;
typedef enum { UNIT_FROM_FILE, UNIT_M_S2, UNIT_CM_S2, UNIT_G } MotionUnit;

typedef enum { NOISY_AUTO, NOISY_NO, NOISY_YES } Noisy;

typedef struct {
    struct {
        char model[SETTINGS_TEXT_MAX]; /* guyan | appendix | a folder with K.csv and M.csv */
        double damping;                /* [-] of every mode */
        double first_storey_m, storey_m;
    } building;
    struct {
        long section; /* CoreSection */
        double side_m, width_m, damping, youngs_modulus_pa, density_kg_m3;
        double area_base_m2, area_top_m2, inertia_base_m4, inertia_top_m4;
    } core;
    struct {
        long law; /* ContactLaw */
        double restitution, v0_floor_m_s, radius_m, youngs_modulus_pa, poisson;
    } contact;
    struct {
        char record[SETTINGS_TEXT_MAX];  /* a file or builtin:NAME */
        char records[SETTINGS_TEXT_MAX]; /* more of them, a comma list, or none */
        double pga_g;                    /* 0: as recorded */
        double stretch;                  /* t -> stretch t */
        long unit;                       /* MotionUnit */
        char channel[SETTINGS_TEXT_MAX]; /* name, number or auto */
        double dt_s, resample_dt_s;      /* 0: from the file; 0: never */
    } motion;
    struct {
        long engine, accuracy;
        double steps_per_contact;
        double duration_s; /* 0: the whole motion */
        double residual_max;
        long ensemble, robust;  /* members of a design; Robust */
        double gap_tolerance_m; /* standard deviation of a gap as built */
    } sim;
    struct { /* the search box */
        double gap_min_m, gap_max_m, thickness_min_m, thickness_max_m;
    } design;
    struct {       /* what is searched; all but kind only where it is not the tower */
        long kind; /* ProblemKind */
        char command[SETTINGS_TEXT_MAX];
        double timeout_s;
        long variables, objectives;
        char lower[SETTINGS_TEXT_MAX], upper[SETTINGS_TEXT_MAX]; /* one number or a comma list */
        char senses[SETTINGS_TEXT_MAX];                          /* min or max, one word or a list */
        char variable_names[SETTINGS_TEXT_MAX], objective_names[SETTINGS_TEXT_MAX];
        long noisy;   /* Noisy */
        double noise; /* [-] of a textbook problem's answers */
    } problem;
    struct {
        long seed, threads, population, initial, generations, max_evals;
        double max_hours, nondominated_share, trust_error;
        double crossover_probability, crossover_eta, mutation_eta, mutation_rate;
        long surrogate_max;            /* most designs that the response surface is built on */
        long surrogate;                /* SurrogateUse */
        long asynchronous;             /* 0 or 1 */
        long survival;                 /* SurvivalKind */
        double repeats;                /* share of max_evals */
        long members_min, members_max; /* answers of a design */
        long polish;                   /* designs at the end */
        char limits[SETTINGS_TEXT_MAX];
        char start[SETTINGS_TEXT_MAX]; /* a CSV of designs or a run's folder, or none */
    } search;
    struct {
        char out[SETTINGS_TEXT_MAX]; /* the run's folder */
    } run;
} Settings;

void settings_defaults(Settings *s);

/* Reads an INI file over what s holds. All faults are reported, not only the first: one line each into `faults`
 * ("FILE:LINE: key: what is wrong and what to do"), whose number is returned through n_faults; err has the first.
 * Relative paths of building.model and motion.record are taken from the folder of the INI file if such a file is
 * there, else from the working directory. faults may be NULL. */
Status settings_read(Settings *s, const char *path, FILE *faults, int *n_faults, Err *err);

/* The same from text in memory; `path` names it in messages and is where relative paths begin. */
Status settings_parse(Settings *s, const char *path, const char *text, Err *err);

/* Calls `differs` for every setting that is not the same in both, in the order of the table, values as text. */
typedef void (*SettingsDiffFn)(const char *key, const char *was, const char *is, void *user);
void settings_compare(const Settings *was, const Settings *is, SettingsDiffFn differs, void *user);

/* Calls `take` for every setting, in the order of the table. */
typedef void (*SettingFn)(const char *key, const char *value, void *user);
void settings_each(const Settings *s, SettingFn take, void *user);

/* "section.key=value" as given to --set. */
Status settings_set(Settings *s, const char *assignment, Err *err);

/* Does the value of a path name a file? builtin:NAME and none do not. */
int setting_is_path(const char *value);

/* The rules that tie settings together. */
Status settings_check(const Settings *s, Err *err);

/* The table itself: key i ("section.key", NULL behind the last), and its words as "a|b|c", NULL where it is no choice.
 */
const char *settings_key(int i);
const char *settings_words(int i);

/* A valid INI file: with `described`, preceded key by key by its meaning, unit and range. */
void settings_write(const Settings *s, FILE *out, int described);

#endif
