#include "base/json.h"

#include <math.h>

json_t *json_number(double value)
{
    return isfinite(value) ? json_real(value) : json_null();
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
