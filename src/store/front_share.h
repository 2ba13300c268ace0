/* store/front_share.h -- the hypervolume of a run: the share of a box that its front dominates.
 *
 * The box is about the first designs that succeeded (the first sample): in every objective from the worst of them to a
 * fifth of their range below the best. Measured with the fixed samples of moga/hypervolume.h.
 *
 * Life cycle  {0} -> front_share_follow ... -> front_share_free
 * Threads     one at a time */
#ifndef IMTET_STORE_FRONT_SHARE_H
#define IMTET_STORE_FRONT_SHARE_H

#include "moga/hypervolume.h"
#include "moga/search.h"

typedef struct {
    Hypervolume *hypervolume; /* NULL: no design has succeeded yet */
    size_t n;                 /* designs that were looked at */
} FrontShare;

/* The front as the search has it now. */
Status front_share_follow(FrontShare *share, const SearchView *view, Err *err);

double front_share_value(const FrontShare *share); /* NAN: none yet */
void front_share_free(FrontShare *share);

#endif
