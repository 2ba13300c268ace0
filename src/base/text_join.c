/* What of base/text.h needs no stream, so that the engine of a page has it too. */
#include "base/text.h"

#include <stdarg.h>
#include <string.h>

void text_join(char text[], size_t size, const char *separator, const char *format, ...)
{
    size_t n = strlen(text);
    va_list values;
    va_start(values, format);
    n += snprintf(text + n, size - n, "%s", n ? separator : "");
    if (n < size)
        vsnprintf(text + n, size - n, format, values);
    va_end(values);
}

size_t index_of_word(const char *word, const char *const list[], size_t n)
{
    size_t i = 0;
    while (i < n && strcmp(list[i], word) != 0)
        i++;
    return i;
}
