#include "base/json.h"

#include <math.h>
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

json_t *json_append(json_t *list, json_t *value)
{
    if (json_array_append_new(list, value) == 0)
        return list;
    json_decref(list);
    return NULL;
}

json_t *json_numbers_every(size_t step, size_t n, const double values[])
{
    json_t *list = json_array();
    for (size_t i = 0; i < n; i += step)
        list = json_append(list, json_number(values[i]));
    return list;
}

json_t *json_numbers(size_t n, const double values[])
{
    return json_numbers_every(1, n, values);
}
