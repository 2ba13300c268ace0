#include "store/front_share.h"

#include <math.h>

#include "evaluate/schema.h"

/* A box about the first designs that succeeded: from a fifth of their range below the best to the worst. */
static Status create_cover(FrontShare *share, const SearchView *v, Err *err)
{
    double lower[OBJECTIVES_MAX], reference[OBJECTIVES_MAX];
    size_t first = 0;
    while (first < v->n && !v->ok[first])
        first++;
    if (first == v->n)
        return STATUS_OK;
    for (size_t k = 0; k < v->n_obj; k++) {
        lower[k] = reference[k] = v->Y[first * v->n_obj + k];
        for (size_t i = first; i < v->n && v->generation[i] == v->generation[first]; i++)
            if (v->ok[i]) {
                lower[k] = fmin(lower[k], v->Y[i * v->n_obj + k]);
                reference[k] = fmax(reference[k], v->Y[i * v->n_obj + k]);
            }
        const double range = reference[k] > lower[k] ? reference[k] - lower[k] : 1.0;
        lower[k] -= 0.2 * range;
        reference[k] = fmax(reference[k], lower[k] + range);
    }
    return hypervolume_create(&share->hypervolume, v->n_obj, lower, reference, 1, err);
}

/* Only designs on the front count: one that an earlier one dominates adds nothing. Where repeats move designs and take
 * them off the front, all of it is measured again. */
Status front_share_follow(FrontShare *share, const SearchView *v, Err *err)
{
    if (v->n_replicates > 0)
        front_share_free(share);
    if (!share->hypervolume)
        TRY(create_cover(share, v, err));
    if (!share->hypervolume)
        return STATUS_OK;
    for (size_t i = v->n; i-- > share->n;) /* later designs dominate more: fewer samples are left for the others */
        if (v->on_front[i])
            hypervolume_add(share->hypervolume, v->F + i * v->n_obj);
    share->n = v->n;
    return STATUS_OK;
}

double front_share_value(const FrontShare *share)
{
    return share->hypervolume ? hypervolume_share(share->hypervolume) : NAN;
}

void front_share_free(FrontShare *share)
{
    hypervolume_free(share->hypervolume);
    *share = (FrontShare){0};
}
