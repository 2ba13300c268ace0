#include "settings/settings.h"

#include <glob.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/csv.h"
#include "base/text.h"
#include "scene/foundation.h"
#include "settings/rules.h"
#include "settings/table.h"

enum { LARGEST = 1 << 20 }; /* [bytes] a hundred times the file with every setting and its description */

typedef struct {
    int line, column; /* from 1 */
} Place;

typedef struct {
    Settings *s;
    const char *path;
    FILE *faults;
    const char *text; /* the line at hand, without what marks a file as UTF-8 */
    char section[64];
    int n_faults, line;
    Place seen[TABLE_MAX]; /* where it was set; line 0: nowhere */
    int is_stored;         /* settings of a run: keys that are none any more are passed over */
    Err *first;
} Reading;

/* One line per fault; the first is the error of the whole reading. */
static void report_fault(Reading *r, Place at, const char *text)
{
    char where[32] = "";
    if (at.line > 0)
        snprintf(where, sizeof where, ":%d:%d", at.line, at.column);
    if (r->n_faults++ == 0)
        fail(r->first, STATUS_BAD_DATA, "%s%s: %s", r->path, where, text);
    if (r->faults)
        fprintf(r->faults, "%s%s: %s\n", r->path, where, text);
}

/* The place of a character of the line at hand: characters count, not bytes. */
static Place place_of(const Reading *r, const char *at)
{
    Place place = {r->line, 1};
    for (const char *c = r->text; c < at; c++)
        place.column += (*c & 0xC0) != 0x80;
    return place;
}

static char *skip_blanks(char *text)
{
    return text + strspn(text, " \t");
}

static void trim_end(char *text)
{
    for (size_t n = strlen(text); n > 0 && is_blank(text[n - 1]); n--)
        text[n - 1] = 0;
}

/* A path that was written in a settings file is meant from that file's folder. */
static void anchor_path(char path[OPTION_TEXT_MAX], void *user)
{
    const Reading *r = user;
    const char *slash = strrchr(r->path, '/');
    if (!slash || path[0] == '/')
        return;
    char anchored[2 * OPTION_TEXT_MAX];
    snprintf(anchored, sizeof anchored, "%.*s/%s", (int)(slash - r->path), r->path, path);
    if (strlen(anchored) < OPTION_TEXT_MAX && access(anchored, F_OK) == 0)
        memcpy(path, anchored, strlen(anchored) + 1);
}

/* The same of a command's program, where that is a path, and of its script: the first word behind it that is no option.
 * What else stands there is the program's own; so is all from the first quote on. */
static void anchor_command(char command[OPTION_TEXT_MAX], Reading *r)
{
    char word[OPTION_TEXT_MAX], rest[OPTION_TEXT_MAX];
    struct stat st;
    int is_program = 1, is_script = 0;
    for (char *at = skip_blanks(command); *at && !is_script; is_program = 0) {
        size_t n = strcspn(at, " \t");
        snprintf(word, sizeof word, "%.*s", (int)n, at);
        text_copy(rest, at + n);
        is_script = !is_program && *word != '-';
        if (strpbrk(word, "'\"\\"))
            return;
        if (is_script ? strpbrk(word, "./") != NULL : is_program && strchr(word, '/'))
            anchor_path(word, r);
        const char *quote = strpbrk(word, " \t\"\\") ? "'" : "";
        if (strlen(word) > n && stat(word, &st) == 0 && S_ISREG(st.st_mode) && !strchr(word, '\'') &&
            strlen(word) + strlen(rest) + 2 < (size_t)(command + OPTION_TEXT_MAX - at))
            n = sprintf(at, "%s%s%s%s", quote, word, quote, rest) - strlen(rest);
        at = skip_blanks(at + n);
    }
}

/* Without the quotes around it, as TOML writes a text; one with quotes or escapes inside stays what it is. */
static void strip_quotes(const char *value, char plain[OPTION_TEXT_MAX])
{
    const size_t n = strlen(value);
    const int is_quoted = n > 1 && strchr("\"'", value[0]) && value[n - 1] == value[0];
    const int strips = is_quoted && strcspn(value + 1, (char[]){value[0], '\\', 0}) == n - 2;
    snprintf(plain, OPTION_TEXT_MAX, "%.*s", (int)n - 2 * strips, value + strips);
}

/* A text or an array of TOML as this program writes it: "a" is a, ["a", "b"] is a, b. */
static const char *plain_value(const char *value, char plain[OPTION_TEXT_MAX])
{
    char inner[OPTION_TEXT_MAX], item[OPTION_TEXT_MAX], text[OPTION_TEXT_MAX];
    const size_t n = strlen(value);
    if (n < 2 || n >= sizeof inner || !strchr("\"'[", value[0]))
        return value;
    if (value[0] != '[' || value[n - 1] != ']') {
        strip_quotes(value, plain);
        return plain;
    }
    snprintf(inner, sizeof inner, "%.*s", (int)n - 2, value + 1);
    const size_t count = list_count(inner);
    for (size_t i = 0; i < count; i++) {
        const int is_there = list_item(inner, i, item, sizeof item);
        if (!is_there && i > 0 && i + 1 == count) /* a comma behind the last item */
            break;
        if (!is_there)
            return value;
        strip_quotes(item, text);
        text_join(plain, OPTION_TEXT_MAX, ", ", "%s", text);
        if (strlen(plain) + 1 == OPTION_TEXT_MAX)
            return value;
    }
    return plain;
}

/* Where a value of TOML, which begins with a quote or a bracket, is over: at its closing one, behind which only a note
 * may stand. Beyond the line only an array goes on; notes and ends of lines inside it become blanks where `joins`.
 * NULL: it does not close. */
static char *toml_end(char *value, const char *end, int joins)
{
    char quote = 0;
    const int is_array = *value == '[';
    for (char *c = value + is_array; c < end; c++) {
        if (*c == '\n' && (quote || !is_array))
            return NULL;
        if (!quote && *c == '#')
            for (; c < end && *c != '\n'; c++)
                *c = joins ? ' ' : *c;
        if (c < end && *c == '\n' && joins)
            *c = ' ';
        if (quote ? *c == quote : *c == ']')
            quote = 0;
        else if (!quote && strchr("\"'", *c))
            quote = *c;
        else
            continue;
        if (is_array ? !quote && *c == ']' : !quote)
            return c + 1;
    }
    return NULL;
}

/* A value ends where a note follows it: at the first ; or # behind a blank, or what of TOML is over. */
const char *table_value(char *text, char plain[OPTION_TEXT_MAX])
{
    char *first = skip_blanks(text), *end = first + strlen(first);
    char *close = *first && strchr("\"'[", *first) ? toml_end(first, end, 0) : NULL;
    if (close && strchr(";#", *skip_blanks(close)))
        *close = 0;
    for (char *c = text; (c = strpbrk(c, ";#")); c++)
        if (c > text && (!close || c > close) && is_blank(c[-1]))
            *c-- = 0;
    trim_end(text);
    return plain_value(skip_blanks(text), plain);
}

/* [section], or name = value, as INI and TOML have them. */
static void take_line(Reading *r, char *line)
{
    char *begin = skip_blanks(line), *end = begin[0] == '[' ? strchr(begin, ']') : NULL, *value = strpbrk(begin, "=:");
    char key[128], name[64], plain[OPTION_TEXT_MAX] = "";
    Err err = {0};
    int i = 0;
    trim_end(begin);
    if (strchr(";#", *begin)) /* or it is empty */
        return;
    if (end) {
        snprintf(r->section, sizeof r->section, "%.*s", (int)(end - begin) - 1, begin + 1);
        return;
    }
    if (!strchr(begin, '=')) {
        report_fault(r, place_of(r, begin), "neither [section] nor key = value");
        return;
    }
    snprintf(name, sizeof name, "%.*s", (int)(value - begin), begin);
    trim_end(name);
    const Place at = place_of(r, skip_blanks(++value));
    const char *meant = table_value(value, plain);

    /* The setting, once. */
    snprintf(key, sizeof key, "%s%s%s", r->section, r->section[0] ? "." : "", name);
    if (table_find(key, &i, &err) != STATUS_OK) {
        if (!r->is_stored || !table_passes(key, meant))
            report_fault(r, place_of(r, begin), err.text);
        return;
    }
    if (table_assign(r->s, i, meant, &err) != STATUS_OK) {
        report_fault(r, at, err.text);
        return;
    }
    if (r->seen[i].line) {
        fail(&err, STATUS_BAD_DATA, "%s: was set in line %d already; remove one of the two", settings_key(i),
             r->seen[i].line);
        report_fault(r, place_of(r, begin), err.text);
    }
    r->seen[i] = at;
    table_change_files(r->s, i, anchor_path, r);
    if (strcmp(settings_key(i), "problem.command") == 0)
        anchor_command(r->s->problem.command, r);
}

/* At the first key that the sentence names and the file sets. */
static void report_broken(const char *text, void *user)
{
    Reading *r = user;
    Place at = {0, 0};
    const char *first = NULL;
    for (int i = 0; settings_key(i); i++) {
        const char *named = r->seen[i].line ? strstr(text, settings_key(i)) : NULL;
        const char end = named ? named[strlen(settings_key(i))] : 0;
        if (named && (!first || named < first) && !(end == '_' || end == 's')) {
            first = named;
            at = r->seen[i];
        }
    }
    report_fault(r, at, text);
}

/* text (length, and a zero behind it): its lines are closed by zeros. */
static Status read_text(Reading *r, char *text, size_t length, int *n_faults)
{
    for (char *next = text, *line = text, *end = text + length; next < end; line = next) {
        char *stop = memchr(line, '\n', end - line);
        int n_more = 0;
        stop = stop ? stop : end;

        /* An array of TOML goes on over the lines behind it, to the end of that on which it closes. */
        char *equals = strchr("[;#", *skip_blanks(line)) ? NULL : memchr(line, '=', stop - line);
        char *value = equals ? skip_blanks(equals + 1) : stop;
        char *close = *value == '[' ? toml_end(value, end, 0) : NULL;
        for (const char *c = value; close && c < close; c++)
            n_more += *c == '\n';
        if (close) {
            stop = memchr(toml_end(value, end, 1), '\n', end - close);
            stop = stop ? stop : end;
        }
        next = stop + 1;
        *stop = 0;
        if (r->line++ == 0 && strncmp(line, "\xEF\xBB\xBF", 3) == 0)
            line += 3;
        r->text = line;
        if (strlen(line) == (size_t)(stop - line))
            take_line(r, line);
        else
            report_fault(r, place_of(r, skip_blanks(line)), "holds a NUL byte; this is not a settings file");
        r->line += n_more;
    }
    r->s->design.anchors_max = foundation_complete(r->s->core.foundation, r->is_stored);
    rules_check(r->s, report_broken, r);
    if (n_faults)
        *n_faults = r->n_faults;
    return r->n_faults ? STATUS_BAD_DATA : STATUS_OK;
}

Status settings_read(Settings *s, const char *path, FILE *faults, int *n_faults, Err *err)
{
    char *text, pattern[OPTION_TEXT_MAX];
    size_t length;
    struct stat st;
    if (stat(path, &st) == 0 && S_ISDIR(st.st_mode)) { /* the first two that lie in it are named */
        glob_t g = {0};
        snprintf(pattern, sizeof pattern, "%s/*.ini", path);
        const size_t n = glob(pattern, 0, NULL, &g) == 0 ? g.gl_pathc : 0;
        if (n == 0)
            fail(err, STATUS_MISSING, "%s: is a folder without a run (run.sqlite) or a settings file (*.ini)", path);
        else
            fail(err, STATUS_MISSING, "%s: is a folder; did you mean %s%s%s?", path, g.gl_pathv[0], n > 1 ? " or " : "",
                 n > 1 ? g.gl_pathv[1] : "");
        globfree(&g);
        return STATUS_MISSING;
    }
    TRY(file_read(path, LARGEST, &text, &length, err));
    Reading r = {.s = s, .path = path, .faults = faults, .first = err};
    const Status status = read_text(&r, text, length, n_faults);
    free(text);
    return status;
}

Status settings_parse(Settings *s, const char *path, const char *text, Err *err)
{
    char *copy = strdup(text);
    Reading r = {.s = s, .path = path, .is_stored = 1, .first = err};
    if (!copy)
        return fail(err, STATUS_NO_MEMORY, "%s: no memory for its settings", path);
    const Status status = read_text(&r, copy, strlen(copy), NULL);
    free(copy);
    return status;
}

/* ---- where a message belongs ------------------------------------------------------------------------------------ */

typedef struct {
    const char *message;
    char key[64]; /* empty: not found */
} Named;

static int begins(const char *message, const char *with, const char *ends)
{
    const size_t n = strlen(with);
    return n > 0 && strncmp(message, with, n) == 0 && message[n] && strchr(ends, message[n]);
}

static void find_path(const char *key, const char *path, void *user)
{
    Named *n = user;
    if (!n->key[0] && begins(n->message, path, ":/"))
        text_copy(n->key, key);
}

void settings_place(const char *path, SettingGivenFn is_given, const void *user, Err *err)
{
    Settings s;
    Err ignored = {0}, was = *err;
    char *text;
    size_t length;
    Named named = {.message = was.text};
    Reading r = {.s = &s, .path = path, .first = &ignored};
    const char *key;
    settings_defaults(&s);
    /* Of the file itself it says where already, also where a key names the folder that the file lies in. */
    if (begins(was.text, path, ":") || file_read(path, LARGEST, &text, &length, &ignored) != STATUS_OK)
        return;
    read_text(&r, text, length, NULL);
    free(text);
    settings_each_path(&s, find_path, &named);
    for (int i = 0; (key = settings_key(i)); i++) {
        const int by_key = begins(was.text, key, ":");
        if (!r.seen[i].line || !(by_key || strcmp(named.key, key) == 0) || is_given(user, key))
            continue;
        fail_sub(err, was.code, was.sub, "%s:%d:%d: %s%s%s%s", path, r.seen[i].line, r.seen[i].column,
                 by_key ? "" : key, by_key ? "" : ": ", was.text,
                 was.code == STATUS_MISSING && strcmp(key, "motion.record") == 0
                     ? "; give one by --record FILE or take --record builtin:kobe-like"
                     : "");
        return;
    }
}
