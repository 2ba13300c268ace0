#include "report/convergence.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "moga/cover.h"
#include "store/saved.h"

static Status take_generations(const Saved *h, Convergence *c, Err *err)
{
    c->simulated = calloc(3 * (h->n_generations + 1), sizeof *c->simulated);
    if (!c->simulated)
        return fail(err, STATUS_NO_MEMORY, "no memory for %zu generations", h->n_generations);
    c->volume = c->simulated + h->n_generations + 1;
    c->standard_error = c->volume + h->n_generations + 1;
    for (size_t i = 0; i < h->n_generations; i++) {
        const double v = h->generation[i].hypervolume;
        if (!isfinite(v))
            continue;
        c->simulated[c->n] = (double)h->generation[i].simulated;
        c->volume[c->n] = v;
        c->standard_error[c->n++] = sqrt(fmax(v * (1 - v), 0.0) / COVER_SAMPLES);
    }
    return STATUS_OK;
}

Status convergence_read(const char *folder, Convergence *out, Err *err)
{
    char path[PATH_MAX];
    Saved h;
    memset(out, 0, sizeof *out);
    if (!saved_path(folder, path, sizeof path))
        return STATUS_OK;
    TRY(saved_read(&h, folder, err));
    for (size_t i = 0; i < h.n; i++)
        out->n_evaluated += h.row[i].kind != KIND_UNFINISHED;
    out->n_failed = h.n_failed;
    const Status status = take_generations(&h, out, err);
    saved_free(&h);
    return status;
}

void convergence_free(Convergence *c)
{
    free(c->simulated);
    memset(c, 0, sizeof *c);
}
