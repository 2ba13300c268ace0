/* sim/lanes.h -- eight numbers side by side, one vector of the widest instruction set.
 *
 * Vectors are not passed between functions: not every version of a CLONED one (base/clones.h) has registers for them.
 *
 * Threads  no state */
#pragma once

#include <stdint.h>

enum { LANES8 = 8 };
typedef double v8 __attribute__((vector_size(64)));
typedef int64_t m8 __attribute__((vector_size(64))); /* all ones where true */

#define V8_WHERE(m, a, b) ((v8)(((m8)(a) & (m)) | ((m8)(b) & ~(m))))
#define V8_ABS(a)         ((v8)((m8)(a)&INT64_MAX))

/* Is any of the eight true? */
static inline __attribute__((always_inline)) int m8_any(const m8 *mask)
{
    m8 bits = *mask;
    bits |= __builtin_shufflevector(bits, bits, 4, 5, 6, 7, 0, 1, 2, 3);
    bits |= __builtin_shufflevector(bits, bits, 2, 3, 0, 1, 6, 7, 4, 5);
    return (bits[0] | bits[1]) != 0;
}
