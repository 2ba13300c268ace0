#include "cmd/args.h"

#include "cmd/outputs.h"
#include "store/folder.h"
#include "settings/settings.h"
#include "store/run_read.h"
#include "study/merged.h"

Status args_unknown(const char *what, const char *word, const char *const known[], int n, const char *where, Err *err)
{
    const char *near = nearest_word(word, known, n);
    return near ? misused(err, "unknown %s '%.60s'; did you mean %s?", what, word, near)
                : misused(err, "unknown %s '%.60s'; %s lists them", what, word, where);
}

/* What stands behind KEY= of an assignment; NULL: it is another one, or nothing does. */
static const char *value_of(const char *assignment, const char *key)
{
    const size_t n = strlen(key);
    return strncmp(assignment, key, n) == 0 && assignment[n] == '=' && assignment[n + 1] ? assignment + n + 1 : NULL;
}

Status args_moved(const Args *args, RecordPaths *moved, Err *err)
{
    const char *text;
    *moved = (RecordPaths){0};
    for (int i = 0; (text = args_next(args, "--set", &i));) {
        int k = 0;
        while (k < N_MOVED && !value_of(text, MOVED_KEY[k]))
            k++;
        if (k == N_MOVED)
            return misused(err,
                           "--set %.60s: for an existing run only motion.record=PATH, motion.records=PATH,... and "
                           "motion.forces=PATH can be set",
                           text);
        if (moved->path[k])
            return misused(err, "--set %s is given twice", MOVED_KEY[k]);
        moved->path[k] = value_of(text, MOVED_KEY[k]);
    }
    return STATUS_OK;
}

static Status take_option(Args *args, int argc, char *const argv[], int *i, Err *err)
{
    const Command *c = args->command;
    const ArgOption *o = c->options;
    const char *word = argv[*i], *behind = strchr(word, '='), *names[OPTIONS_MAX];
    char name[64], where[80];
    int n = 0;
    snprintf(name, sizeof name, "%.*s", (int)strcspn(word, "="), word);
    for (; o->name && strcmp(o->name, name) != 0; o++)
        names[n++] = o->name;
    if (!o->name) {
        names[n++] = "--help";
        snprintf(where, sizeof where, "`%s %s --help`", program_of(c), c->name);
        return args_unknown("option", name, names, n, where, err);
    }
    if (!o->value && behind)
        return misused(err, "%s takes no value", o->name);
    if (o->value && !behind && *i + 1 < argc && strncmp(argv[*i + 1], "--", 2) != 0)
        behind = argv[++*i];
    else if (behind)
        behind++;
    if (o->value && (!behind || !*behind))
        return misused(err, "%s needs a value: %s %s", o->name, o->name, o->value);
    if (!o->many && args_has(args, o->name))
        return misused(err, "%s is given twice", o->name);
    args->given[args->n_given++] = (Given){o, behind};
    return STATUS_OK;
}

/* A run is its folder; who names the database in it means that. */
static Status take_operand(Args *args, char *word, Err *err)
{
    const Command *c = args->command;
    if (!c->operand)
        return misused(err, "%s %s takes no operand, found '%.60s'", program_of(c), c->name, word);
    if (args->operand && !strstr(c->operand, "..."))
        return misused(err, "%s %s takes one %s, found '%.60s' after '%.60s'", program_of(c), c->name, c->operand, word,
                       args->operand);
    if (!word[0])
        return misused(err, "%s %s: the %s is an empty word", program_of(c), c->name, c->operand);
    if (strstr(c->operand, "RUN"))
        run_drop_name(word);
    args->operands[args->n_operands++] = word;
    args->operand = args->operands[0];
    return STATUS_OK;
}

int asks_for_help(const char *word)
{
    return strcmp(word, "--help") == 0 || strcmp(word, "-h") == 0;
}

Status args_parse(Args *args, const Command *command, int argc, char *const argv[], Err *err)
{
    memset(args, 0, sizeof *args);
    args->command = command;
    for (int i = 0; i < argc; i++)
        args->help = args->help || asks_for_help(argv[i]);
    if (args->help)
        return STATUS_OK;
    TRY_ROOM(args->given, argc + 1, "options", err);
    TRY_ROOM(args->operands, argc + 1, "options", err);
    for (int i = 0; i < argc; i++)
        TRY(argv[i][0] == '-' && argv[i][1] ? take_option(args, argc, argv, &i, err)
                                            : take_operand(args, argv[i], err));
    if (command->operand && command->operand[0] != '[' && !args->operand)
        return misused(err, "%s %s needs a %s; for example: %s", program_of(command), command->name, command->operand,
                       command->example);
    return outputs_check(args, err);
}

static int is_given(const void *args, const char *key)
{
    return args_gives(args, key);
}

void args_place(const Args *args, Err *err)
{
    if (args->operand)
        settings_place(args->operand, is_given, args, err);
}

Status command_run(const Args *args, Err *err)
{
    Run run;
    const Command *c = args->command;
    const Status own = c->run ? c->run(args, err) : STATUS_OK;
    if (own == STATUS_BAD_DATA || own == STATUS_MISSING)
        args_place(args, err);
    TRY(own);
    if (!c->run_of)
        return STATUS_OK;
    TRY(args->n_operands == 1 ? run_read(&run, args->operand, err)
                              : merged_read(&run, (size_t)args->n_operands, args->operands, err));
    for (int i = 1; i < args->n_operands; i++)
        fprintf(stderr, "note: the ids of %s have %ld added\n", args->operands[i], i * run.id_step);
    const Status status = c->run_of(args, &run, err);
    run_free(&run);
    return status;
}

/* The first from i on, which is then behind it; NULL: none. */
static const Given *next_given(const Args *args, const char *name, int *i)
{
    while (*i < args->n_given) {
        const Given *g = &args->given[(*i)++];
        if (strcmp(g->option->name, name) == 0)
            return g;
    }
    return NULL;
}

const char *args_next(const Args *args, const char *name, int *i)
{
    const Given *g = next_given(args, name, i);
    return g ? g->value : NULL;
}

const char *args_value(const Args *args, const char *name)
{
    return args_next(args, name, &(int){0});
}

int args_has(const Args *args, const char *name)
{
    return next_given(args, name, &(int){0}) != NULL;
}

Status args_number(const Args *args, const char *name, double least, double most, double otherwise, double *value,
                   Err *err)
{
    const char *text = args_value(args, name);
    char *end;
    *value = text ? strtod(text, &end) : otherwise;
    return !text || (end != text && !*end && *value >= least && *value <= most)
               ? STATUS_OK
               : misused(err, "%s: '%.40s' is not a number from %g to %g", name, text, least, most);
}

Status args_whole(const Args *args, const char *name, long least, long most, long otherwise, long *value, Err *err)
{
    double number;
    TRY(args_number(args, name, (double)least, (double)most, (double)otherwise, &number, err));
    *value = (long)number;
    return *value == number ? STATUS_OK : misused(err, "%s: %g is not a whole number", name, number);
}

Status args_alone(const Args *args, const char *name, const char *others, Err *err)
{
    char other[64];
    int n;
    for (; args_has(args, name) && sscanf(others, " %63s%n", other, &n) == 1; others += n)
        if (args_has(args, other))
            return misused(err, "%s and %s do not go together; leave one of them out", name, other);
    return STATUS_OK;
}

int args_gives(const Args *args, const char *key)
{
    const size_t length = strlen(key);
    for (int i = 0; i < args->n_given; i++) {
        const Given *g = &args->given[i];
        if (g->option->setting && strcmp(g->option->setting, key) == 0)
            return 1;
        if (strcmp(g->option->name, "--set") == 0 && strncmp(g->value, key, length) == 0 && g->value[length] == '=')
            return 1;
    }
    return 0;
}

void args_free(Args *args)
{
    free(args->given);
    free(args->operands);
    memset(args, 0, sizeof *args);
}

static void count_fault(FILE *faults, int *n_faults, const char *text)
{
    if (faults)
        fprintf(faults, "%s\n", text);
    if (n_faults)
        ++*n_faults;
}

Status args_apply(const Args *args, Settings *s, FILE *faults, int *n_faults, Err *err)
{
    Status first = STATUS_OK;
    for (int i = 0; i < args->n_given && (faults || first == STATUS_OK); i++) {
        const Given *g = &args->given[i];
        const char *key = g->option->setting;
        Err why = {0}, e = {0};
        Status status = STATUS_OK;
        if (strcmp(g->option->name, "--set") == 0)
            status = settings_set(s, g->value, &e);
        else if (key && (status = settings_put(s, key, g->value, &why)) != STATUS_OK)
            fail(&e, status, "%s: %s", g->option->name, why.text);
        if (status == STATUS_OK)
            continue;
        count_fault(faults, n_faults, e.text);
        if (first == STATUS_OK)
            first = fail(err, status, "%s", e.text);
    }
    /* with faults: a check, which looks at all and writes nothing */
    return first != STATUS_OK || faults ? first : outputs_spare(args, s, err);
}

Status args_settings(const Args *args, Settings *s, FILE *faults, int *n_faults, Err *err)
{
    int n_file = 0;
    Err e = {0};
    settings_defaults(s);
    const Status file = settings_read(s, args->operand, faults, &n_file, err);
    if (n_faults)
        *n_faults = n_file;
    if (file != STATUS_OK && (!faults || n_file == 0))
        return file;
    const Status options = args_apply(args, s, faults, n_faults, file == STATUS_OK ? err : &e);
    if (file != STATUS_OK || options != STATUS_OK)
        return file != STATUS_OK ? file : options;
    const Status rules = settings_check(s, err);
    if (rules != STATUS_OK)
        count_fault(faults, n_faults, err->text);
    return rules;
}
