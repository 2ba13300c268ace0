/* base/json.h -- numbers as JSON.
 *
 * Ownership  the caller's reference. Errors  no memory: NULL, never a list with a value less; json_pack refuses the
 *            whole then */
#ifndef IMTET_BASE_JSON_H
#define IMTET_BASE_JSON_H

#include <jansson.h>

json_t *json_number(double value); /* null where it is not finite */
json_t *json_numbers(size_t n, const double values[]);
json_t *json_numbers_every(size_t step, size_t n, const double values[]); /* every step-th of n */

/* A name or a path of users: what is no UTF-8, and so no JSON, becomes \xE4. */
json_t *json_words(const char *text);

/* Takes value over; list, or NULL where one of the two is or there is no memory (list is released then). */
json_t *json_append(json_t *list, json_t *value);

#endif
