#include "base/text.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    char **text;
    size_t *length, room;
    int failed;
} Text;

/* 0: no memory, which becomes the error of the stream. */
static ssize_t append(void *cookie, const char *bytes, size_t n)
{
    Text *t = cookie;
    const size_t needed = *t->length + n + 1;
    if (needed > t->room) {
        const size_t room = needed > 2 * t->room ? needed : 2 * t->room;
        char *wider = realloc(*t->text, room);
        if (!wider) {
            t->failed = 1;
            return 0;
        }
        *t->text = wider;
        t->room = room;
    }
    memcpy(*t->text + *t->length, bytes, n);
    *t->length += n;
    (*t->text)[*t->length] = 0;
    return (ssize_t)n;
}

/* What is not whole is of use to nobody. */
static int end(void *cookie)
{
    Text *t = cookie;
    if (t->failed) {
        free(*t->text);
        *t->text = NULL;
    }
    free(t);
    return 0;
}

FILE *text_open(char **text, size_t *length)
{
    Text *t = malloc(sizeof *t);
    *text = calloc(1, 1);
    *length = 0;
    if (t)
        *t = (Text){text, length, 1, 0};
    FILE *f = t && *text ? fopencookie(t, "w", (cookie_io_functions_t){.write = append, .close = end}) : NULL;
    if (!f) {
        free(t);
        free(*text);
        *text = NULL;
    }
    return f;
}

int text_close(FILE *stream)
{
    const int failed = ferror(stream);
    return fclose(stream) != 0 || failed;
}

int text_ends(const char *text, const char *end)
{
    const size_t n = strlen(text), own = strlen(end);
    return n >= own && strcmp(text + n - own, end) == 0;
}

char *text_shell(const char *word, char *to)
{
    const int is_plain = *word && !strpbrk(word, " \t\n\"'`$&;()*?<>|\\!#~[]{}");
    char *end = to;
    if (!is_plain)
        *end++ = '\'';
    for (; *word; word++)
        end += *word == '\'' ? sprintf(end, "'\\''") : sprintf(end, "%c", *word);
    sprintf(end, "%s", is_plain ? "" : "'");
    return to;
}

void text_set(FILE *out, const char *assignment, ...)
{
    char setting[1024], text[4 * sizeof setting + 3];
    va_list list;
    va_start(list, assignment);
    vsnprintf(setting, sizeof setting, assignment, list);
    va_end(list);
    fprintf(out, " --set %s", text_shell(setting, text));
}

void text_html(FILE *out, const char *words)
{
    for (; *words; words++)
        if (strchr("<>&\"", *words))
            fprintf(out, "&#%d;", *words);
        else
            fputc(*words, out);
}
