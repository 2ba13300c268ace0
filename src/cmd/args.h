/* cmd/args.h -- the command line, described by tables.
 *
 *   imtet COMMAND [OPERAND] [--option [VALUE]] ...      options and operand in any order; --option=VALUE as well
 *
 * Life cycle  args_parse -> args_value ... -> args_free
 * Ownership   names and values point into argv and the tables */
#pragma once

#include "cmd/command.h"
#include "study/record_paths.h"

int asks_for_help(const char *word); /* --help or -h */

/* argv: what follows the command's name. */
Status args_parse(Args *args, const Command *command, int argc, char *const argv[], Err *err);
const char *args_value(const Args *args, const char *name); /* NULL when it was not given */
int args_has(const Args *args, const char *name);

/* Executes the command: its run, then run_of with the run of its operand, which is read first. */
Status command_run(const Args *args, Err *err);

/* The values of an option that may be repeated, one call after the other; i begins at 0, NULL: no more. */
const char *args_next(const Args *args, const char *name, int *i);

/* The number behind an option, `otherwise` where it was not given: "NAME: 'TEXT' is no ... from LEAST to MOST". */
Status args_number(const Args *args, const char *name, double least, double most, double otherwise, double *value,
                   Err *err);
Status args_whole(const Args *args, const char *name, long least, long most, long otherwise, long *value, Err *err);

/* Refused where one of `others`, parted by blanks, was given beside `name`. */
Status args_alone(const Args *args, const char *name, const char *others, Err *err);
int args_gives(const Args *args, const char *key); /* a setting, by an option of its own or by --set */
void args_free(Args *args);

/* Reads --set motion.record=PATH, motion.records=PATHS and motion.forces=PATH; nothing else may be set. */
Status args_moved(const Args *args, RecordPaths *moved, Err *err);

/* "unknown WHAT WORD; did you mean ...?" */
Status args_unknown(const char *what, const char *word, const char *const known[], int n, const char *where, Err *err);

/* Defaults, then the operand's file, then the options in their order, then the rules between settings. With `faults`
 * every fault is written there and counted, else the first one ends it. */
Status args_settings(const Args *args, Settings *s, FILE *faults, int *n_faults, Err *err);

/* settings_place by the operand, but for what options have set. */
void args_place(const Args *args, Err *err);

/* Only the options, over what s holds. */
Status args_apply(const Args *args, Settings *s, FILE *faults, int *n_faults, Err *err);

/* Rows of a command's options: without a value, with one, with one each time, with one that is a setting. */
/* clang-format off */
#define SWITCH(name_, help_) {.name = name_, .help = help_}
#define VALUE(name_, value_, help_) {.name = name_, .value = value_, .help = help_}
#define VALUES(name_, value_, help_) {.name = name_, .value = value_, .many = 1, .help = help_}
#define SETTING(name_, value_, setting_, help_) {.name = name_, .value = value_, .setting = setting_, .help = help_}

/* Options of several commands. */
#define OPTION_MOVED VALUES("--set", "motion.record=PATH", "where the run's record is, if moved; .records, .forces")
#define OPTION_SET VALUES("--set", "SECTION.KEY=VALUE", "any setting; may be repeated (`imtet settings` lists them)")
#define OPTION_RECORD SETTING("--record", "FILE", "motion.record", "ground motion file or builtin:NAME")
#define OPTION_PGA SETTING("--pga", "G", "motion.pga_g", "scale the motion to this peak [g]; 0: as recorded")
#define OPTION_UNIT \
    SETTING("--unit", "UNIT", "motion.unit", "m_s2 | cm_s2 | g | counts=VALUE, if the file does not say")
#define OPTION_TEXT \
    SETTING("--text", "FORM", "motion.text", "plain text: skip=5,columns=time:1,value:3,per_line=8,pairs=yes,factor=2")
#define OPTIONS_MOTION OPTION_RECORD, OPTION_PGA, OPTION_UNIT, OPTION_TEXT
#define OPTION_JSON SWITCH("--json", "everything, as JSON, on standard output")
#define OPTION_CSV VALUE("--csv", "FILE", "the table as CSV into FILE; -: standard output")
/* clang-format on */
