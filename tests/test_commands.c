/* The command line and its messages: runs tests/commands.txt, whose head says what a row is. */
#include "program.h"

enum { LINES_MAX = 2000, LETS_MAX = 64 };

static char *line[LINES_MAX]; /* [0] is line 1 */
static int n_lines;

/* `let NAME = TEXT`, wherever it stands; the first is ours. */
static struct {
    const char *name, *text;
} lets[LETS_MAX] = {{"TEXTBOOK_WORKER", TEXTBOOK_WORKER}};
static int n_lets = 1;

/* Numbers of lines: of the heading of a test, and of that of its group. */
typedef struct {
    int at, group;
} Section;
static Section sections[TESTS_MAX];

/* The text with its names replaced; @ is the folder. */
static void spell(FILE *to, const char *text)
{
    for (; *text; text++) {
        const size_t n = *text == '$' ? strspn(text + 1, "ABCDEFGHIJKLMNOPQRSTUVWXYZ_") : 0;
        int i = 0;
        while (n > 0 && i < n_lets && (strncmp(lets[i].name, text + 1, n) != 0 || lets[i].name[n]))
            i++;
        if (n > 0 && i < n_lets) {
            spell(to, lets[i].text);
            text += n;
        } else if (*text == '@') {
            fputs(place.folder, to);
        } else {
            fputc(*text, to);
        }
    }
}

/* \n, \s (a space), \t and \\ become what they stand for, in place. */
static char *unescape(char *text)
{
    char *to = text;
    for (const char *p = text; *p; p++)
        *to++ = *p != '\\' || !p[1] ? *p : *++p == 'n' ? '\n' : *p == 't' ? '\t' : *p == 's' ? ' ' : *p;
    *to = 0;
    return text;
}

/* What stands before `| `, behind which *rest begins then. */
static char *part(char **rest)
{
    char *begin = *rest, *bar = begin;
    while (*bar && !(*bar == '|' && (bar == begin || bar[-1] == ' ') && (bar[1] == ' ' || !bar[1])))
        bar++;
    *rest = bar + (*bar != 0) + (*bar && bar[1]);
    if (*bar)
        bar[bar > begin ? -1 : 0] = 0;
    return begin;
}

/* Every one of `words ... words` is in the text; none of those behind a ! is. */
static int says(const char *text, char *words)
{
    for (char *next; words; words = next) {
        if ((next = strstr(words, " ... ")))
            *next = 0, next += 5;
        const char *at = strstr(text, unescape(words + (*words == '!' || *words == '^')));
        if (*words == '!' ? at != NULL : *words == '^' ? at != text : !at)
            return 0;
    }
    return 1;
}

/* Whether the command, or the program with arguments, ends with the code and says the words. */
static int ran(int at, const char *words_of, long code, char *words, const char *arguments)
{
    OWNED(forget) Said s = {.code = -1};
    if (words_of)
        run(&s, "%s", arguments);
    const int right =
        words_of ? s.code == code && says(*words_of == '>' ? s.out : s.err, words) : system(arguments) == 0;
    if (!right)
        print_error("tests/commands.txt:%d: %s\n  exit %d (wanted %ld), said: %s%s\n", at + 1, arguments, s.code, code,
                    s.err ? s.err : "", s.out ? s.out : "");
    return right;
}

/* Whether the row is as it says; is_over: the rest of its test is left out. */
static int holds(int at, int *is_over)
{
    char *text = NULL, *rest, *name;
    size_t length;
    FILE *f = open_memstream(&text, &length);
    spell(f, line[at]);
    fclose(f);
    const long code = strtol(text, &rest, 10);
    int right = 1;
    if (strncmp(text, "file ", 5) == 0) {
        rest = text + 5;
        name = part(&rest);
        right = ran(at, NULL, 0, NULL, brief("mkdir -p \"$(dirname '%s/%s')\"", place.folder, name));
        write_in_place(name, unescape(rest));
    } else if (strncmp(text, "run ", 4) == 0) {
        right = ran(at, "|", 0, NULL, text + 4);
    } else if (strncmp(text, "sh ", 3) == 0) {
        right = ran(at, NULL, 0, NULL, text + 3);
    } else if (strncmp(text, "if ", 3) == 0) {
        *is_over = system(text + 3) != 0;
    } else if (strncmp(text, "with", 4) == 0) {
        snprintf(place.under, sizeof place.under, "%s", text + 4);
    } else if (strncmp(rest, " | ", 3) == 0 || strncmp(rest, " > ", 3) == 0) {
        const char *words_of = rest + 1;
        rest += 3;
        name = part(&rest);
        right = ran(at, words_of, code, name, rest);
    } else if (*text && *text != '#' && strncmp(text, "let ", 4) != 0) {
        print_error("tests/commands.txt:%d: no row: %s\n", at + 1, text);
        right = 0;
    }
    free(text);
    return right;
}

/* The rows below a heading; how many of them fail. */
static int failures_below(int heading, int *is_over)
{
    int n = 0;
    place.under[0] = 0;
    for (int i = heading + 1; i < n_lines && line[i][0] != '=' && !*is_over; i++)
        n += !holds(i, is_over);
    return n;
}

/* The folder is that of a group, made anew where another group begins. */
static void test_section(void **state)
{
    static int group = -1;
    const Section *s = *state;
    int n = 0, is_over = 0;
    if (s->group != group) {
        assert_int_equal(clear_place(NULL) || make_place(NULL), 0);
        group = s->group;
        n = failures_below(group, &(int){0});
    }
    n += failures_below(s->at, &is_over);
    if (n > 0)
        fail_msg("%d rows failed", n);
    if (is_over)
        skip();
}

__attribute__((constructor(200))) static void read_table(void)
{
    char *text;
    size_t length;
    int group = 0;
    if (file_read("tests/commands.txt", FILE_LARGEST, &text, &length, &err) != STATUS_OK)
        return;
    for (char *begin; (begin = strsep(&text, "\n")); n_lines++) {
        if (n_lines == LINES_MAX || n_lets == LETS_MAX || n_tests == TESTS_MAX)
            abort();
        line[n_lines] = begin;
        char *equals = strstr(begin, " = ");
        if (strncmp(begin, "let ", 4) == 0 && equals) {
            *equals = 0;
            lets[n_lets].name = begin + 4;
            lets[n_lets++].text = equals + 3;
        } else if (strncmp(begin, "== ", 3) == 0) {
            sections[n_tests] = (Section){n_lines, group};
            all_tests[n_tests] = (struct CMUnitTest){begin + 3, test_section, NULL, NULL, &sections[n_tests]};
            n_tests++;
        } else if (strncmp(begin, "= ", 2) == 0) {
            group = n_lines;
        }
    }
}

SUITE(make_place, clear_place)
