/* base/keyed.h -- numbers by name in one text: "ag=0.3 soil=C", parted by blanks or commas.
 *
 * Errors   STATUS_BAD_DATA, one sentence that begins with the setting: a word that is no key, that stands twice, or a
 *          number outside its range
 * Threads  no state */
#pragma once

#include "base/status.h"

typedef struct {
    const char *key;
    unsigned kinds; /* of which text it is a key: a set of bits */
    double least, most;
    int letters; /* the number may also be a letter: A is 1, the last one is `most` */
} KeyedNumber;

/* x (n, at most 32) stays what it was where a key is not given. text: at most OPTION_TEXT_MAX.
 * kind: one bit, whose keys are taken. */
Status keyed_numbers(const char *setting, const char *text, unsigned kind, size_t n, const KeyedNumber keys[],
                     double x[], Err *err);
