#include "cmd/manual.h"

#include <stdarg.h>

#include "cmd/commands.h"
#include "store/provenance.h"

#define X(name) &CMD_##name,
static const Command *const COMMANDS[] = {COMMAND_LIST(X)};
#undef X
static const char *const GROUPS[N_GROUPS] = {
    [GROUP_PREPARE] = "prepare", [GROUP_STUDY] = "study", [GROUP_DECIDE] = "decide"};
enum { N_COMMANDS = N_OF(COMMANDS), FIRST_EXAMPLES = 4 };

const Command *command_at(int i)
{
    return i >= 0 && i < N_COMMANDS ? COMMANDS[i] : NULL;
}

/* Names of the release before this one: each is a command of now, with an option where there is one. A command of that
 * name, where there is one still, goes before. */
static const struct {
    const char *old, *now, *option;
} OLD_NAMES[] = {
    {"modes", "building", NULL},
    {"import", "building", NULL},
    {"list", "status", NULL},
    {"horizon", "simulate", "--horizon"},
    {"verify", "evaluate", "--full-model"},
    {"plot", "report", "--pictures=pictures"},
    {"selftest", "check", "--self"},
};

static const Command *command_of(const char *name)
{
    for (int i = 0; i < N_COMMANDS; i++)
        if (strcmp(name, COMMANDS[i]->name) == 0)
            return COMMANDS[i];
    return NULL;
}

Status command_find(const char *word, const Command **found, const char **option, Err *err)
{
    static const char *const OPTIONS[] = {"--help", "--version"};
    const char *names[N_COMMANDS];
    *option = NULL;
    if ((*found = command_of(word)))
        return STATUS_OK;
    for (size_t i = 0; i < N_OF(OLD_NAMES); i++)
        if (strcmp(word, OLD_NAMES[i].old) == 0) {
            *option = OLD_NAMES[i].option;
            fprintf(stderr, "note: imtet %s is now: imtet %s%s%s\n", word, OLD_NAMES[i].now, *option ? " " : "",
                    *option ? *option : "");
            *found = command_of(OLD_NAMES[i].now);
            return STATUS_OK;
        }
    for (int i = 0; i < N_COMMANDS; i++)
        names[i] = COMMANDS[i]->name;
    return word[0] == '-' ? args_unknown("option", word, OPTIONS, 2, "`imtet --help`", err)
                          : args_unknown("command", word, names, N_COMMANDS, "`imtet --help`", err);
}

/* ---- on the terminal ------------------------------------------------------------------------------------------- */

void usage_write(FILE *out)
{
    for (int i = 0; i < FIRST_EXAMPLES; i++)
        fprintf(out, "%s%s\n", i == 0 ? "example: " : "         ", COMMANDS[i]->example);
    fprintf(out,
            "\nEarthquake protection by impacts between a tower and an inner core.\n\nusage: imtet COMMAND ...\n\n");
    for (int group = 1; group < N_GROUPS; group++) {
        fprintf(out, "%s%s\n", group > 1 ? "\n" : "", GROUPS[group]);
        for (int i = 0; i < N_COMMANDS; i++)
            if ((int)COMMANDS[i]->group == group)
                fprintf(out, "  %-9s %-10s %s\n", COMMANDS[i]->name, COMMANDS[i]->operand, COMMANDS[i]->summary);
    }
    fprintf(out,
            "\n`imtet help COMMAND` shows an example and every option, `imtet --version --json` what this program\n"
            "was built from.\n\nexit status\n");
    for (int s = 0; s < STATUS_COUNT; s++)
        fprintf(out, "  %3d  %s\n", status_exit_code(s), status_words(s));
}

/* ---- for man --------------------------------------------------------------------------------------------------- */

/* The format with a text in the place of every %, in which roff finds nothing of its own. */
static void roff(FILE *out, const char *format, ...)
{
    va_list texts;
    va_start(texts, format);
    for (const char *f = format; *f; f++) {
        if (*f != '%')
            fputc(*f, out);
        for (const char *text = *f == '%' ? va_arg(texts, const char *) : "", *at = text; *at; at++) {
            if ((at == text || at[-1] == '\n') && strchr(".'", *at))
                fputs("\\&", out);
            if (strchr("-\\", *at))
                fputc('\\', out);
            fputc(*at == '\\' ? 'e' : *at, out);
        }
    }
    va_end(texts);
}

void manual_write(const Command *c, FILE *out)
{
    static const char ENTRY[] = ".TP\n\\fB%\\fR \\fI%\\fR\n%\n";
    const char *dash = c ? "-" : "", *name = c ? c->name : "";
    roff(out, ".TH imtet%% 1 \"" IMTET_DATE "\" \"imtet %\" \"User commands\"\n", dash, name, program_version());
    roff(out, ".SH NAME\nimtet%% \\- %\n.SH SYNOPSIS\n\\fBimtet %\\fR % [options]\n.SH DESCRIPTION\n%\n.SH %\n", dash,
         name, c ? c->summary : "earthquake protection by impacts between a tower and an inner core", name,
         c ? c->operand : "COMMAND",
         c ? c->details : "Simulates and optimizes a tower that collides with its core. Each command has its own page.",
         c ? "OPTIONS" : "COMMANDS");
    for (const ArgOption *o = c ? c->options : &(ArgOption){0}; o->name; o++)
        roff(out, ENTRY, o->name, o->value ? o->value : "", o->help);
    for (int i = 0; !c && i < N_COMMANDS; i++)
        roff(out, ENTRY, COMMANDS[i]->name, COMMANDS[i]->operand, COMMANDS[i]->summary);
    fputs(".SH EXIT STATUS\n", out);
    for (int s = 0; s < STATUS_COUNT; s++)
        fprintf(out, ".TP\n\\fB%d\\fR \n%s\n", status_exit_code(s), status_words(s));
    fputs(".SH EXAMPLES\n.nf\n", out);
    for (int i = 0; i < (c ? 1 : FIRST_EXAMPLES); i++)
        roff(out, "%\n", c ? c->example : COMMANDS[i]->example);
    roff(out, ".fi\n.SH SEE ALSO\n.BR imtet% (1)\n", c ? "" : "-optimize");
}
