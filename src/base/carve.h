/* base/carve.h -- one allocation, laid out once; arrays that grow.
 *
 * A layout function names each array. The first pass (base NULL) only counts, the second hands out slices:
 *
 *   CARVE(c, m->x, n);                                   m->x: room for n of what it points to
 *   m->store = carve_all(layout, m);                     NULL: out of memory
 *   m = carve_object(layout, &plain, sizeof plain);      the same with the object itself
 *
 * Every slice starts on a cache line. The store is zeroed and released by free. */
#pragma once

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

enum { CARVE_LINE = 64 };

typedef struct {
    char *base;  /* NULL while counting */
    size_t used; /* bytes */
} Carve;

static inline void *carve(Carve *c, size_t n, size_t size)
{
    char *slice = c->base ? c->base + c->used : NULL;
    c->used += (n * size + CARVE_LINE - 1) / CARVE_LINE * CARVE_LINE;
    return slice;
}
#define CARVE(c, array, n) ((array) = carve(c, n, sizeof *(array)))

static inline void *carve_store(const Carve *c)
{
    const size_t size = c->used ? c->used : CARVE_LINE;
    void *store = aligned_alloc(CARVE_LINE, size);
    return store ? memset(store, 0, size) : NULL;
}

/* Counts, then hands out. */
static inline void *carve_all(void (*layout)(void *object, Carve *c), void *object)
{
    Carve c = {0};
    layout(object, &c);
    void *store = carve_store(&c);
    if (store)
        layout(object, &(Carve){.base = store});
    return store;
}

/* An object and its arrays in one store: a copy of `plain` (size), which knows how long they are. NULL: no memory. */
static inline void *carve_object(void (*layout)(void *object, Carve *c), void *plain, size_t size)
{
    Carve c = {0};
    carve(&c, 1, size);
    const size_t own = c.used;
    layout(plain, &c);
    char *object = carve_store(&c);
    if (object)
        layout(memcpy(object, plain, size), &(Carve){object, own});
    return object;
}

/* Memory of realloc with room for n of `size` bytes; where that is refused it stays as it is, and *lacks is set. */
static inline void *widened(void *array, size_t n, size_t size, int *lacks)
{
    void *wider = realloc(array, n * size + 1);
    *lacks |= !wider;
    return wider ? wider : array;
}

/* A wider slice that begins with the n_old elements of the old one. */
static inline void *carve_wider(Carve *c, const void *old, size_t n_old, size_t n, size_t size)
{
    char *slice = carve(c, n, size);
    return slice && n_old > 0 ? memcpy(slice, old, n_old * size) : slice;
}
#define CARVE_WIDER(c, array, n_old, n) ((array) = carve_wider(c, array, n_old, n, sizeof *(array)))
