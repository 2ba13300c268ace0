/* base/text.h -- characters, lists of words, words inside HTML, and a stream into memory that says when there was none:
 * glibc's open_memstream loses what it had no room for, and neither ferror nor fclose tells.
 *
 * Ownership  *text is malloc'd, ends with a zero byte behind its *length, and is the caller's
 * Errors     text_open: NULL; text_close: not 0. *text is NULL then */
#pragma once

#include <stdio.h>

/* Of ASCII, whatever the locale. */
static inline int is_digit(char c)
{
    return c >= '0' && c <= '9';
}
static inline int is_letter(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}
static inline int is_blank(char c)
{
    return c == ' ' || (c >= '\t' && c <= '\r');
}

/* More behind what is in text (size), the separator between where there is something; what has no room is left out. */
__attribute__((format(printf, 4, 5))) void text_join(char text[], size_t size, const char *separator,
                                                     const char *format, ...);

/* Where the word stands in list[0..n); n: nowhere. */
size_t index_of_word(const char *word, const char *const list[], size_t n);

FILE *text_open(char **text, size_t *length);
int text_close(FILE *stream);

int text_ends(const char *text, const char *end); /* a path in ".csv", say */

/* A word of a command line, in quotes where a shell would take it otherwise; to has room for 4 strlen(word) + 3. */
char *text_shell(const char *word, char *to);

/* " --set ASSIGNMENT", as a shell takes it. */
__attribute__((format(printf, 2, 3))) void text_set(FILE *out, const char *assignment, ...);

/* Words of users inside HTML or SVG. */
void text_html(FILE *out, const char *words);
