/* base/watch.h -- somebody who looks on while a batch of items is worked off.
 *
 * Threads  go_on may be called from several threads at once; calls of done exclude each other and happen after item i
 *          and its place in the caller's arrays are complete. */
#ifndef IMTET_BASE_WATCH_H
#define IMTET_BASE_WATCH_H

#include <stddef.h>

#include "base/status.h"

typedef struct {
    int (*go_on)(void *user);                       /* asked before each item; 0: nothing more is begun */
    Status (*done)(size_t i, void *user, Err *err); /* item i is finished; a fault ends the batch */
    void *user;
} Watch;

/* No watch at all (NULL) lets everything happen. */
static inline int watch_go_on(const Watch *w)
{
    return !w || !w->go_on || w->go_on(w->user);
}

static inline Status watch_done(const Watch *w, size_t i, Err *err)
{
    return w && w->done ? w->done(i, w->user, err) : STATUS_OK;
}

#endif
