#include "base/json.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/visible.h"

json_t *json_number(double value)
{
    return isfinite(value) ? json_real(value) : json_null();
}

json_t *json_words(const char *text)
{
    enum { LONGEST = 8 }; /* [bytes] of a character that is shown, for one of the text */
    json_t *string = json_string(text);
    if (string)
        return string;
    const size_t size = LONGEST * strlen(text) + 1;
    char *shown = calloc(size, 1);
    if (!shown)
        return NULL;
    visible_text(shown, size, text);
    string = json_string(shown);
    free(shown);
    return string;
}

const char *json_text(const json_t *o, const char *key)
{
    const char *text = json_string_value(json_object_get(o, key));
    return text ? text : "";
}

json_t *json_put(json_t *o, const char *members, ...)
{
    char key[64];
    const char *text;
    va_list values;
    va_start(values, members);
    for (const char *at = members; *at; at += strspn(at, " ")) {
        json_t *value;
        const size_t n = strcspn(at, "=");
        snprintf(key, sizeof key, "%.*s", (int)n, at);
        at += n + 2; /* behind =% */
        switch (*at) {
        case 'd':
            value = json_integer(va_arg(values, int));
            break;
        case 'g':
            value = json_number(va_arg(values, double));
            break;
        case 'l':
        case 'z':
            value = json_integer(va_arg(values, long));
            break;
        case 'c':
            value = json_boolean(va_arg(values, int));
            break;
        case 's':
            text = va_arg(values, const char *);
            value = text ? json_words(text) : NULL;
            break;
        default:
            value = va_arg(values, json_t *);
        }
        json_object_set_new(o, key, value);
        at += strcspn(at, " ");
    }
    va_end(values);
    return o;
}

json_t *json_numbers_every(size_t step, size_t n, const double values[])
{
    json_t *list = json_array();
    for (size_t i = 0; i < n; i += step)
        json_array_append_new(list, json_number(values[i]));
    return list;
}

json_t *json_numbers(size_t n, const double values[])
{
    return json_numbers_every(1, n, values);
}

json_t *json_pair(size_t n, const double one[], const double other[])
{
    return json_pack("[o, o]", json_numbers(n, one), json_numbers(n, other));
}
