/* base/json.h -- objects and numbers as JSON.
 *
 *   json_of("n=%zu peak_g=%g name=%s done=%c floors=%p", n, peak, name, is_done, json_numbers(n_floors, values))
 *
 * Ownership  the caller's reference
 * Errors     none: refused memory ends the program (json_memory, main.c), so that nothing is half there */
#pragma once

#include <jansson.h>

json_t *json_number(double value); /* null where it is not finite */
json_t *json_numbers(size_t n, const double values[]);
json_t *json_numbers_every(size_t step, size_t n, const double values[]); /* every step-th of n */

/* A name or a path of users: what is no UTF-8, and so no JSON, becomes \xE4. */
json_t *json_words(const char *text);

/* Members of an object in their order, "KEY=TYPE KEY=TYPE ..." with the types of printf, so that the compiler checks
 * the values: %d, %ld, %zu; %g: json_number; %s: json_words; %c: a boolean; %p: a json_t, which is taken over. NULL for
 * %s or %p: that member is left out. Returns o. */
__attribute__((format(printf, 2, 3))) json_t *json_put(json_t *o, const char *members, ...);
#define json_of(...) json_put(json_object(), __VA_ARGS__)

const char *json_text(const json_t *o, const char *key); /* a member's; empty: it has none */

json_t *json_pair(size_t n, const double one[], const double other[]); /* [[...], [...]] */
