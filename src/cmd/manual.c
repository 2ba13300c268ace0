#include "cmd/manual.h"

#include <ctype.h>
#include <string.h>

#include "cmd/commands.h"
#include "store/provenance.h"
#include "settings/settings.h"

#define X(name) &CMD_##name,
static const Command *const COMMANDS[] = {COMMAND_LIST(X)};
#undef X
enum { N_COMMANDS = sizeof COMMANDS / sizeof COMMANDS[0], FIRST_EXAMPLES = 4 };

const Command *command_at(int i)
{
    return i >= 0 && i < N_COMMANDS ? COMMANDS[i] : NULL;
}

Status command_find(const char *word, const Command **found, Err *err)
{
    const char *names[N_COMMANDS];
    for (int i = 0; i < N_COMMANDS; i++) {
        names[i] = COMMANDS[i]->name;
        *found = COMMANDS[i];
        if (strcmp(word, names[i]) == 0)
            return STATUS_OK;
    }
    if (strcmp(word, "bench") == 0)
        return fail(err, STATUS_USAGE, "unknown command 'bench'; engines are compared by the program imtet-bench");
    static const char *const OPTIONS[] = {"--help", "--version"};
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
    for (int i = 0; i < N_COMMANDS; i++)
        fprintf(out, "  %-9s %-10s %s\n", COMMANDS[i]->name, operand_of(COMMANDS[i]), COMMANDS[i]->summary);
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

/* ---- for bash -------------------------------------------------------------------------------------------------- */

static void print_words(FILE *out, const char *words)
{
    for (; *words; words++)
        fputc(*words == '|' ? ' ' : *words, out);
}

static const char *words_of(const char *key)
{
    for (int i = 0; key && settings_key(i); i++)
        if (strcmp(settings_key(i), key) == 0)
            return settings_words(i);
    return NULL;
}

static int is_path(const char *value)
{
    return strcmp(value, "FILE") == 0 || strcmp(value, "DIR") == 0 || strcmp(value, "FOLDER") == 0;
}

/* Words beside those of a setting and besides files. */
static const char *special_words(const ArgOption *o)
{
    if (strcmp(o->name, "--record") == 0)
        return words_of("motion.record");
    if (strcmp(o->name, "--design") == 0)
        return is_path(o->value) ? "none" : "knee";
    return words_of(o->setting);
}

/* One branch for what may stand behind that word. */
static void complete_case(FILE *out, const char *command, const char *word, const char *words, int files)
{
    fprintf(out, "    %s\" %s\") files=%s words=\"", command, word, files ? "f" : "");
    print_words(out, words ? words : "");
    fputs("\" ;;\n", out);
}

static void complete_settings(FILE *out)
{
    for (int i = 0; settings_key(i); i++)
        if (settings_words(i) || settings_names_file(i))
            complete_case(out, "*", settings_key(i), settings_words(i), settings_names_file(i));
    fputs("    *\" --set\") keys=1 words=\"", out);
    for (int i = 0; settings_key(i); i++)
        fprintf(out, "%s%s=", i ? " " : "", settings_key(i));
    fputs("\" ;;\n", out);
}

static void complete_values(FILE *out)
{
    fputs("    case \"${COMP_WORDS[1]} $asked\" in\n", out);
    complete_settings(out);
    for (int i = 0; i < N_COMMANDS; i++)
        for (const ArgOption *o = COMMANDS[i]->options; o->name; o++)
            if (o->value && strcmp(o->name, "--set") != 0)
                complete_case(out, COMMANDS[i]->name, o->name, special_words(o), is_path(o->value));
    fputs("    *) asked= ;;\n    esac\n", out);
}

static void complete_options(FILE *out)
{
    fputs("    case ${COMP_WORDS[1]} in\n", out);
    for (int i = 0; i < N_COMMANDS; i++) {
        fprintf(out, "    %s) words=\"--help", COMMANDS[i]->name);
        for (const ArgOption *o = COMMANDS[i]->options; o->name; o++)
            fprintf(out, " %s", o->name);
        fprintf(out, "\" files=%s ;;\n", COMMANDS[i]->operand ? "f" : "");
    }
    fputs("    help) words=\"$commands\" ;;\n    esac\n", out);
}

void completion_write(FILE *out)
{
    fputs("# bash completion of imtet; written by `imtet --completion`\n_imtet()\n{\n"
          "    local cur=${COMP_WORDS[COMP_CWORD]} asked=${COMP_WORDS[COMP_CWORD-1]} words= files= keys= commands=\"",
          out);
    for (int i = 0; i < N_COMMANDS; i++)
        fprintf(out, "%s ", COMMANDS[i]->name);
    fputs("help\"\n    COMPREPLY=()\n"
          "    if ((COMP_CWORD == 1)); then\n"
          "        COMPREPLY=($(compgen -W \"$commands --help --version\" -- \"$cur\"))\n        return\n    fi\n"
          "    # name=value comes as three words\n"
          "    if [[ $cur == = ]]; then cur=\n"
          "    elif [[ $asked == = ]]; then asked=${COMP_WORDS[COMP_CWORD-2]}\n    fi\n"
          "    # and so does builtin:NAME\n"
          "    local first=${COMP_WORDS[COMP_CWORD-2]}:$asked names=\"kobe-like elcentro-like sylmar-like\"\n"
          "    if [[ $asked$cur == builtin: ]]; then COMPREPLY=($names); return\n"
          "    elif [[ $first == builtin:: ]]; then COMPREPLY=($(compgen -W \"$names\" -- \"$cur\")); return\n    fi\n",
          out);
    complete_values(out);
    fputs("    if [[ -z $asked ]]; then\n", out);
    complete_options(out);
    fputs("        [[ $cur == -* ]] && files=\n    fi\n"
          "    [[ $keys ]] && compopt -o nospace 2>/dev/null\n"
          "    [[ $files ]] && compopt -o filenames 2>/dev/null\n"
          "    [[ $files ]] && COMPREPLY=($(compgen -f -- \"$cur\"))\n"
          "    [[ $files && $cur != -* && -z $asked ]] || COMPREPLY+=($(compgen -W \"$words\" -- \"$cur\"))\n"
          "}\ncomplete -F _imtet imtet\n",
          out);
}
