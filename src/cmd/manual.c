#include "cmd/manual.h"

#include <ctype.h>
#include <string.h>

#include "cmd/commands.h"
#include "store/provenance.h"
#include "settings/settings.h"

#define X(name) &CMD_##name,
static const Command *const COMMANDS[] = {COMMAND_LIST(X)};
#undef X
static const char *const GROUPS[N_GROUPS] = {
    [GROUP_PREPARE] = "prepare", [GROUP_STUDY] = "study", [GROUP_DECIDE] = "decide"};
enum { N_COMMANDS = sizeof COMMANDS / sizeof COMMANDS[0], FIRST_EXAMPLES = 4 };

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
    for (size_t i = 0; i < sizeof OLD_NAMES / sizeof OLD_NAMES[0]; i++)
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

static const char *operand_of(const Command *c)
{
    return c->operand ? c->operand : "";
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
                fprintf(out, "  %-9s %-10s %s\n", COMMANDS[i]->name, operand_of(COMMANDS[i]), COMMANDS[i]->summary);
    }
    fprintf(out,
            "\n`imtet help COMMAND` shows an example and every option, `imtet --version --json` what this program\n"
            "was built from.\n\nexit status\n");
    for (int s = 0; s < STATUS_COUNT; s++)
        fprintf(out, "  %3d  %s\n", status_exit_code((Status)s), status_words((Status)s));
}

/* ---- for man --------------------------------------------------------------------------------------------------- */

/* Text in which roff finds nothing of its own; a line's first character is the text's. */
static void roff(FILE *out, const char *text)
{
    int first = 1;
    for (; *text; text++) {
        if (first && (*text == '.' || *text == '\''))
            fputs("\\&", out);
        if (*text == '-' || *text == '\\')
            fputs(*text == '-' ? "\\-" : "\\e", out);
        else
            fputc(*text, out);
        first = *text == '\n';
    }
}

static void roff_example(FILE *out, const char *example)
{
    fputs(".PP\n.nf\n", out);
    roff(out, example);
    fputs("\n.fi\n", out);
}

static void roff_title(FILE *out, const Command *c)
{
    char name[40];
    snprintf(name, sizeof name, "imtet%s%s", c ? "-" : "", c ? c->name : "");
    fputs(".TH ", out);
    for (const char *p = name; *p; p++)
        fputc(toupper((unsigned char)*p), out);
    fprintf(out, " 1 \"\" \"imtet %s\" \"User commands\"\n.SH NAME\n", program_version());
    roff(out, name);
    fputs(" \\- ", out);
    roff(out, c ? c->summary : "earthquake protection by impacts between a tower and an inner core");
    fputc('\n', out);
}

static void roff_options(FILE *out, const Command *c)
{
    fputs(".SH OPTIONS\n", out);
    for (const ArgOption *o = c->options; o->name; o++) {
        fputs(".TP\n.B ", out);
        roff(out, o->name);
        if (o->value) {
            fputs(" \\fI", out);
            roff(out, o->value);
            fputs("\\fR", out);
        }
        fputc('\n', out);
        roff(out, o->help);
        if (o->setting) {
            fputs("; the setting ", out);
            roff(out, o->setting);
        }
        fputs(".\n", out);
    }
    fputs(".TP\n.B \\-\\-help\nThe same on the terminal.\n", out);
}

static void roff_settings(FILE *out)
{
    char line[2048];
    Settings s;
    FILE *f = tmpfile();
    settings_defaults(&s);
    fputs(".SH SETTINGS\n.nf\n", out);
    if (f) {
        settings_write(&s, f, 1);
        rewind(f);
    }
    while (f && fgets(line, sizeof line, f))
        roff(out, line);
    if (f)
        fclose(f);
    fputs(".fi\n", out);
}

static void roff_ending(FILE *out)
{
    fputs(".SH EXIT STATUS\n", out);
    for (int s = 0; s < STATUS_COUNT; s++) {
        fprintf(out, ".TP\n.B %d\n", status_exit_code((Status)s));
        roff(out, status_words((Status)s));
        fputs("\n", out);
    }
    fputs(".SH SEE ALSO\n.BR imtet (1)", out);
    for (int i = 0; i < N_COMMANDS; i++)
        fprintf(out, ",\n.BR imtet\\-%s (1)", COMMANDS[i]->name);
    fputc('\n', out);
}

static void manual_of_all(FILE *out)
{
    fputs(".SH SYNOPSIS\n.B imtet\n.I COMMAND\n[\\fIoperand\\fR] [\\fIoptions\\fR]\n.SH EXAMPLES\n", out);
    for (int i = 0; i < FIRST_EXAMPLES; i++)
        roff_example(out, COMMANDS[i]->example);
    fputs(".SH COMMANDS\n", out);
    for (int i = 0; i < N_COMMANDS; i++) {
        fprintf(out, ".TP\n.B %s \\fI%s\\fR\n", COMMANDS[i]->name, operand_of(COMMANDS[i]));
        roff(out, COMMANDS[i]->summary);
        fputs("\n", out);
    }
    fputs(".TP\n.B help \\fICOMMAND\\fR\nits example and options\n.TP\n.B \\-\\-version \\fR[\\fB\\-\\-json\\fR]\n"
          "what this program was built from\n",
          out);
}

void manual_write(const Command *c, FILE *out)
{
    roff_title(out, c);
    if (!c) {
        manual_of_all(out);
        roff_ending(out);
        return;
    }
    fprintf(out, ".SH SYNOPSIS\n.B imtet %s\n", c->name);
    if (c->operand)
        fprintf(out, ".I %s\n", c->operand);
    fputs("[\\fIoptions\\fR]\n.SH EXAMPLE\n", out);
    roff_example(out, c->example);
    fputs(".SH DESCRIPTION\n", out);
    roff(out, c->details);
    fputc('\n', out);
    roff_options(out, c);
    if (c == &CMD_SETTINGS)
        roff_settings(out);
    roff_ending(out);
}
