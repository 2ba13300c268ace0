#include "base/pack.h"

#include <stdlib.h>
#include <string.h>

void pack(Pack *p, void *value, size_t size)
{
    const size_t room = p->reading ? p->n - p->at : p->n_max - p->n;
    if (size > room && !p->reading && !p->faulty) {
        const size_t n_max = 2 * (p->n + size);
        unsigned char *wider = realloc(p->bytes, n_max);
        p->faulty |= !wider;
        p->bytes = wider ? wider : p->bytes;
        p->n_max = wider ? n_max : p->n_max;
    }
    p->faulty |= p->reading && size > room;
    if (p->faulty || size == 0)
        return;
    if (p->reading) {
        memcpy(value, p->bytes + p->at, size);
        p->at += size;
    } else {
        memcpy(p->bytes + p->n, value, size);
        p->n += size;
    }
}

void pack_numbers(Pack *p, double *x, size_t n, double least, double most)
{
    pack(p, x, n * sizeof *x);
    for (size_t i = 0; i < n && p->reading && !p->faulty; i++)
        p->faulty = !(x[i] >= least && x[i] <= most);
}

void pack_size(Pack *p, size_t *value, size_t most)
{
    uint64_t wide = *value;
    pack(p, &wide, sizeof wide);
    p->faulty = p->faulty || wide > most;
    if (!p->faulty)
        *value = wide;
}

void pack_expect(Pack *p, uint64_t value)
{
    uint64_t found = value;
    pack(p, &found, sizeof found);
    p->faulty = p->faulty || found != value;
}

int pack_finished(const Pack *p)
{
    return !p->faulty && (!p->reading || p->at == p->n);
}
