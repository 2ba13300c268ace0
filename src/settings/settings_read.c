#include "settings/settings.h"

#include <ctype.h>
#include <ini.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/csv.h"
#include "settings/rules.h"
#include "settings/table.h"

typedef struct {
    int line, column; /* from 1 */
} Place;

typedef struct {
    Settings *s;
    const char *path;
    FILE *faults;
    FILE *file;
    char *text; /* the line at hand, whole */
    size_t capacity;
    const char *long_value; /* in text: what did not fit into the library's line */
    int n_faults, line;
    Place seen[TABLE_MAX]; /* where it was set; line 0: nowhere */
    Err *first;
} Reading;

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

/* The line at hand without what marks a file as UTF-8. */
static const char *line_text(const Reading *r)
{
    return r->text + (r->line == 1 && strncmp(r->text, "\xEF\xBB\xBF", 3) == 0 ? 3 : 0);
}

/* The place of a character of the line at hand: characters count, not bytes. */
static Place place_of(const Reading *r, const char *at)
{
    Place place = {r->line, 1};
    for (const char *c = line_text(r); c < at; c++)
        place.column += (*c & 0xC0) != 0x80;
    return place;
}

static const char *skip_blanks(const char *text)
{
    return text + strspn(text, " \t");
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

/* Stands for a value that waits in long_value; no settings file holds this byte. */
static const char ELSEWHERE[] = "\x01";

/* The library takes lines of `size` - 1 bytes, too few for a long path: such a value waits in long_value. */
static void hand_over(Reading *r, char *text, char *line, int size)
{
    r->long_value = NULL;
    if (strlen(text) < (size_t)size) {
        memcpy(line, text, strlen(text) + 1);
        return;
    }
    char *equals = strchr(text, '=');
    char *note = strstr(text, " ;");
    if (text[0] == ';' || text[0] == '#') {
        line[0] = 0;
    } else if (!equals || equals - text + 4 > size) {
        report_fault(r, place_of(r, text), "the line is too long");
        line[0] = 0;
    } else {
        if (note)
            *note = 0;
        r->long_value = equals + 1 + strspn(equals + 1, " \t");
        snprintf(line, (size_t)size, "%.*s%s", (int)(equals + 1 - text), text, ELSEWHERE);
    }
}

/* Counts lines for the messages and refuses what the library would skip or join without a word: it reports its first
 * bad line only, and takes an indented line for a continuation of the one above. */
static char *next_line(char *line, int size, void *user)
{
    Reading *r = user;
    const ssize_t n = getline(&r->text, &r->capacity, r->file);
    if (n < 0)
        return NULL;
    r->line++;
    line[0] = 0;
    char *text = r->text;
    const int has_nul = strlen(text) != (size_t)n;
    text += skip_blanks(line_text(r)) - text;
    for (char *end = text + strlen(text); end > text && isspace((unsigned char)end[-1]);)
        *--end = 0;
    if (has_nul)
        report_fault(r, place_of(r, text), "holds a NUL byte; this is not a settings file");
    else if (strchr(";#", text[0]) || (text[0] == '[' && strchr(text, ']')) || strchr(text, '='))
        hand_over(r, text, line, size);
    else
        report_fault(r, place_of(r, text), "neither [section] nor key = value");
    return line;
}

static int take_pair(void *user, const char *section, const char *name, const char *value)
{
    Reading *r = user;
    char key[128];
    Err err = {0};
    int i = 0;
    if (strcmp(value, ELSEWHERE) == 0 && r->long_value)
        value = r->long_value;
    snprintf(key, sizeof key, "%s%s%s", section, section[0] ? "." : "", name);
    const char *begin = skip_blanks(line_text(r));
    if (table_find(key, &i, &err) != STATUS_OK) {
        report_fault(r, place_of(r, begin), err.text);
        return 1;
    }
    const Place at = place_of(r, skip_blanks(begin + strcspn(begin, "=:") + 1));
    if (table_assign(r->s, i, value, &err) != STATUS_OK) {
        report_fault(r, at, err.text);
        return 1;
    }
    Place *seen = &r->seen[i];
    if (seen->line) {
        fail(&err, STATUS_BAD_DATA, "%s: was set in line %d already; remove one of the two", settings_key(i),
             seen->line);
        report_fault(r, place_of(r, begin), err.text);
    }
    *seen = at;
    table_change_files(r->s, i, anchor_path, r);
    return 1;
}

static void report_broken(const size_t fields[RULE_FIELDS], const char *text, void *user)
{
    Reading *r = user;
    Place at = {0, 0};
    for (int k = 0; k < RULE_FIELDS && !at.line; k++)
        if (table_at(fields[k]) >= 0)
            at = r->seen[table_at(fields[k])];
    report_fault(r, at, text);
}

static Status read_stream(Reading *r, int *n_faults, Err *err)
{
    const int bad_line = ini_parse_stream(next_line, r, take_pair, r);
    const int whole = feof(r->file);
    free(r->text);
    if (!whole)
        return fail(err, STATUS_NO_MEMORY, "%s: no memory to read it", r->path);
    if (bad_line > 0 && r->n_faults == 0)
        report_fault(r, (Place){bad_line, 1}, "neither [section] nor key = value");
    rules_check(r->s, report_broken, r);
    if (n_faults)
        *n_faults = r->n_faults;
    return r->n_faults ? STATUS_BAD_DATA : STATUS_OK;
}

static Status read_text(Reading *r, const char *text, size_t length, int *n_faults, Err *err)
{
    r->first = err;
    r->file = length > 0 ? fmemopen((void *)(uintptr_t)text, length, "rb") : fopen("/dev/null", "rb");
    if (!r->file)
        return fail(err, STATUS_NO_MEMORY, "%s: no memory for its settings", r->path);
    const Status status = read_stream(r, n_faults, err);
    fclose(r->file);
    return status;
}

Status settings_read(Settings *s, const char *path, FILE *faults, int *n_faults, Err *err)
{
    enum { LARGEST = 1 << 20 }; /* [bytes] a hundred times the file with every setting and its description */
    char *text;
    size_t length;
    TRY(file_read(path, LARGEST, &text, &length, err));
    Reading r = {.s = s, .path = path, .faults = faults};
    const Status status = read_text(&r, text, length, n_faults, err);
    free(text);
    return status;
}

Status settings_parse(Settings *s, const char *path, const char *text, Err *err)
{
    Reading r = {.s = s, .path = path};
    return read_text(&r, text, strlen(text), NULL, err);
}
