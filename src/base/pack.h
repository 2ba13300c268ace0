/* base/pack.h -- a state as bytes: one walk over its values both writes them and reads them back.
 *
 *   static void walk(Pack *p, Thing *t)
 *   {
 *       pack_size(p, &t->n, t->n_max);
 *       pack(p, t->x, t->n * sizeof *t->x);
 *   }
 *   Pack out = {0};                                walk(&out, t);      out.bytes, out.n are the state; free(out.bytes)
 *   Pack in = {.bytes = b, .n = n, .reading = 1};  walk(&in, t);       pack_finished(&in): all of it fitted
 *
 * What is added to a state is one line in its walk, and cannot be written in one order and read in another. A fault
 * (memory, too few bytes, a count or number beyond its limits) is kept and turns the rest of the walk into nothing;
 * what is left to be read is then unchanged. Numbers are in the order of bytes of the machine.
 *
 * Threads  a Pack belongs to one thread. */
#pragma once

#include <stddef.h>
#include <stdint.h>

typedef struct {
    unsigned char *bytes;
    size_t n, n_max; /* written so far, room; while reading: n is the length of the state */
    size_t at;       /* read so far */
    int reading, faulty;
} Pack;

void pack(Pack *p, void *value, size_t size);

/* n numbers; when they are read, one that is no number or lies outside least..most is a fault. */
void pack_numbers(Pack *p, double *x, size_t n, double least, double most);

/* A count or an index: 64 bits; one above `most` is a fault. */
void pack_size(Pack *p, size_t *value, size_t most);

/* A value that must be the same as when the state was written: a version, a shape. */
void pack_expect(Pack *p, uint64_t value);

/* Reading: every byte was used and fitted. Writing: there was memory enough. */
int pack_finished(const Pack *p);
