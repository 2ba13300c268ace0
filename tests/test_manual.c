/* What the program says about itself, and the exit codes that it promises. */
#include "program.h"

#include <ctype.h>

#include "cmd/manual.h"

/* A text as roff has it: every hyphen behind a backslash. */
static int has_entry(const char *page, const char *name)
{
    char entry[96] = "\n.TP\n\\fB", *to = entry + strlen(entry);
    for (; *name; name++)
        to += sprintf(to, *name == '-' ? "\\-" : "%c", *name);
    strcpy(to, "\\fR ");
    return strstr(page, entry) != NULL;
}

TEST(every_command_has_a_page_with_the_sections_of_man_and_all_its_options)
{
    for (int i = 0; command_at(i); i++) {
        const Command *c = command_at(i);
        char *page = output_of("--man %s", c->name), *at = page;
        assert_int_equal(strncmp(page, ".TH imtet\\-", 11), 0);
        assert_int_equal(strspn(strstr(page, " 1 \"") + 4, "0123456789-"), 10); /* a date */
        FOR_EACH (const char *, section, "NAME", "SYNOPSIS", "DESCRIPTION", "OPTIONS", "EXIT STATUS", "EXAMPLES") {
            at = strstr(at, brief("\n.SH %s\n", *section));
            if (!at)
                fail_msg("%s: no section %s", c->name, *section);
        }
        for (const ArgOption *o = c->options; o->name; o++)
            if (!has_entry(page, o->name))
                fail_msg("%s is not in the page of %s", o->name, c->name);
        for (Status s = 0; s < STATUS_COUNT; s++)
            assert_true(has_entry(page, brief("%d", status_exit_code(s))));
        free(page);
    }
    FREED char *all = output_of("--man");
    for (int i = 0; command_at(i); i++)
        assert_true(has_entry(all, command_at(i)->name));
    assert_non_null(strstr(all, "\n.SH COMMANDS\n"));
}

TEST(help_of_a_command_is_the_same_both_ways)
{
    FREED char *first = output_of("help simulate"), *second = output_of("simulate --help"), *all = output_of("help");
    assert_string_equal(first, second);
    assert_int_equal(strncmp(all, "example: imtet ", 15), 0);
    for (int i = 0; command_at(i); i++)
        assert_int_equal(strstr(all, command_at(i)->summary) != NULL, command_at(i)->group != GROUP_NONE);
    expect(2, "did you mean simulate?", "help simulat");
    expect(2, "did you mean optimize?", "--man optimise");
    expect(2, "one command at most", "help simulate building");
}

TEST(the_version_says_what_the_program_was_built_from)
{
    json_auto_t *o = as_json("--version --json");
    assert_text(output_of("--version"), brief("imtet %s (%s)\n", json_string_value(json_object_get(o, "version")),
                                              json_string_value(json_object_get(o, "revision"))));
    assert_non_null(json_string_value(json_object_get(json_object_get(o, "libraries"), "sundials")));
    assert_true(isalpha((unsigned char)json_string_value(json_object_get(o, "compiler"))[0]));
    expect(2, "nothing but --json", "--version --jsn");
    expect(2, "did you mean --version?", "--versoin");
    assert_same_output("--version --json", "--json --version");
}

static char *shell(const char *format, ...)
{
    char command[2048];
    va_list list;
    va_start(list, format);
    const size_t n = (size_t)snprintf(command, sizeof command, "exec >%s/offered; ", place.folder);
    spread(command + n, sizeof command - n, format, list);
    va_end(list);
    assert_int_equal(system(command), 0);
    return text_of(there("offered"));
}

/* Bash replaces what is behind the last = or :. */
static void expect_offer(const char *words, const char *wanted)
{
    FREED char *offer = shell("bash -c 'source scripts/completion.bash; COMP_LINE=\"%s %s\"; COMP_POINT=${#COMP_LINE}; "
                              "_imtet; echo \"${COMPREPLY[*]}\"'",
                              getenv("IMTET"), words);
    if (strncmp(offer, wanted, strlen(wanted)) != 0)
        fail_msg("imtet %s: offered '%s', wanted '%s'", words, offer, wanted);
}

TEST(bash_offers_commands_options_keys_and_words)
{
    expect_offer("opti", "optimize\n");
    expect_offer("help spec", "spectrum\n");
    expect_offer("simulate --des", "--design\n");
    expect_offer("simulate x.ini --set motion.pg", "motion.pga_g=\n");
    expect_offer("simulate x.ini --set sim.accuracy=f", "fine\n");
    expect_offer("simulate x.ini --set=sim.engine=cv", "cvode\n");
    expect_offer("simulate configs/qu", "configs/quick.ini\n");
    expect_offer("simulate x.ini --record LICEN", "LICENSE\n");
    expect_offer("simulate x.ini --set motion.record=LICEN", "LICENSE\n");
    expect_offer("simulate x.ini --pga 0", "\n");
    expect_offer("simulate x.ini --record built", "builtin:kobe-like builtin:elcentro-like builtin:sylmar-like\n");
    expect_offer("simulate x.ini --record builtin:", "kobe-like elcentro-like sylmar-like\n");
    expect_offer("simulate x.ini --set motion.record=builtin:k", "kobe-like\n");
    expect_offer("simulate x.ini --design non", "none\n");
    expect_offer("evaluate results/x --design k", "knee\n");
    expect_offer("spectrum LICEN", "LICENSE\n");
}

/* Skipped where the shell is not on this machine, and for a program that is not to be installed. */
static void install_for(const char *name)
{
    char *found = shell("which %s || true", name);
    const int is_there = found[0] != 0;
    free(found);
    if (!is_there || access("build/release/libimtet.so", F_OK) != 0 || strstr(getenv("IMTET"), "/build/"))
        skip();
    free(shell("make -s -o imtet install PREFIX=@/opt"));
}

static const char *const OFFERS[][2] = {{"opti", "optimize"},
                                        {"simulate --des", "--design"},
                                        {"simulate x.ini --set motion.pg", "motion.pga_g="},
                                        {"simulate x.ini --set=sim.accuracy=f", "--set=sim.accuracy=fine"},
                                        {"simulate x.ini --record LICEN", "LICENSE"},
                                        {"help spec", "spectrum"}};

TEST(fish_offers_what_bash_does)
{
    install_for("fish");
    for (size_t k = 0; k < N_OF(OFFERS); k++)
        free(shell("export PATH=@/opt/bin:$PATH; fish -c 'source @/opt/share/fish/vendor_completions.d/imtet.fish; "
                   "complete -C \"imtet %s\"' | cut -f1 | grep -xFe '%s'",
                   OFFERS[k][0], OFFERS[k][1]));
}

/* It is typed to in a terminal of its own. */
TEST(zsh_offers_what_bash_does)
{
    install_for("zsh");
    for (size_t k = 0; k < N_OF(OFFERS); k++)
        free(shell("export PATH=@/opt/bin:$PATH; timeout 60 zsh -f -c 'zmodload zsh/zpty; "
                   "zpty z zsh -f -i; zpty -w z \"fpath=(@/opt/share/zsh/site-functions \\$fpath); "
                   "autoload -U compinit; compinit -u -D; print REA''DY\"; zpty -r z out \"*READY*\"; "
                   "zpty -w -n z \"imtet %s\"$'\\''\\t'\\''; zpty -r z out \"*imtet* %s*\"'",
                   OFFERS[k][0], OFFERS[k][1]));
}

TEST(what_is_installed_is_gone_again)
{
    install_for("make");
    assert_text(shell("make -s uninstall PREFIX=@/opt; find @/opt -type f -o -type l"), "");
}

/* Every row of the table in the documentation is a status of the program and the other way round. */
TEST(the_exit_codes_are_those_of_the_documentation)
{
    FREED char *page = text_of("docs/exit-codes.md");
    int n_rows = 0;
    for (const char *at = page; (at = strstr(at, "\n| ")); at++)
        n_rows += isdigit((unsigned char)at[3]) != 0;
    for (int s = 0; s < STATUS_COUNT; s++)
        assert_words(page, brief("\n| %d | ", status_exit_code((Status)s)));
    assert_int_equal(n_rows, STATUS_COUNT);
}

SUITE(make_place, clear_place)
