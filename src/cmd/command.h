/* cmd/command.h -- a command, its options, and what of them was given. */
#pragma once

#include "base/status.h"

typedef struct Settings Settings;
struct Run;

typedef struct {
    const char *name;    /* "--record" */
    const char *value;   /* what follows it ("FILE"), NULL for a switch */
    const char *setting; /* the setting that it writes, NULL: the command reads it */
    int many;            /* may be given more than once */
    const char *help;
} ArgOption;

typedef struct Args Args;

enum { OPTIONS_MAX = 32 };

/* Groups of the help; a command without a group is not shown. */
typedef enum { GROUP_NONE, GROUP_PREPARE, GROUP_STUDY, GROUP_DECIDE, N_GROUPS } CommandGroup;

typedef struct {
    CommandGroup group;
    const char *name, *operand; /* operand NULL: takes none, "[NAME]": may be left out, "NAME...": one or more */
    const char *summary, *example, *details;
    Status (*run)(const Args *args, Err *err);
    Status (*run_of)(const Args *args, const struct Run *run,
                     Err *err);     /* run NULL: of the operands, which are read: several as one (study/merged.h) */
    const char *program;            /* of which it is a command; NULL: imtet */
    int only_reads;                 /* runs and files: no linear algebra, nothing to evaluate */
    int is_alone;                   /* nothing to evaluate: all ranks of imtet_mpi but the first end */
    ArgOption options[OPTIONS_MAX]; /* up to the first without a name, which there is */
} Command;

typedef struct {
    const ArgOption *option;
    const char *value; /* NULL for a switch */
} Given;

static inline const char *program_of(const Command *c)
{
    return c->program ? c->program : "imtet";
}

struct Args {
    const Command *command;
    const char *operand;   /* the first */
    int n_operands;        /* one at most, unless the command's operand ends with "..." */
    const char **operands; /* (n_operands) in the order of the command line; of a RUN its folder, also where run.sqlite
                              in it was named, which is taken off that word of argv */
    int help;              /* --help was asked for: nothing else was checked */
    int n_given;
    Given *given; /* (n_given) in the order of the command line */
};
