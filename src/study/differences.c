#include "study/differences.h"

#include "base/linalg.h"
#include "base/visible.h"
#include "settings/settings.h"
#include "store/provenance.h"

typedef struct {
    FILE *lines;
    size_t n_limits, n_others;
    char first[sizeof((Err *)0)->text]; /* of the others */
} Differences;

enum { SHOWN = 120 }; /* bytes of a long value in the message; the lines have all of it */

/* Counts and writes down a setting that differs. */
static void compare_one(const char *key, unsigned flags, const char *was, const char *is, void *user)
{
    Differences *d = user;
    const int is_limit = (flags & SETTING_LIMIT) != 0;
    if (flags & SETTING_FREE)
        return;
    if (!is_limit && d->n_others++ == 0)
        snprintf(d->first, sizeof d->first, "%s is %.*s%s there, now %.*s%s", key, visible_cut(was, SHOWN), was,
                 strlen(was) > SHOWN ? "..." : "", visible_cut(is, SHOWN), is, strlen(is) > SHOWN ? "..." : "");
    d->n_limits += is_limit;
    if (d->lines)
        fprintf(d->lines, "%s: %s in the run, now %s%s\n", key, was, is, is_limit ? " (a limit)" : "");
}

static void compare_hash(Differences *d, const char *key, uint64_t was, uint64_t is)
{
    const char *what = !was ? "is none in the run" : !is ? "is none now" : "has other content than when the run began";
    if (was == is)
        return;
    if (d->n_others++ == 0)
        snprintf(d->first, sizeof d->first, "%s %s", key, what);
    if (d->lines)
        fprintf(d->lines, "%s: %s\n", key, what);
}

Status differences_check(const Comparison *c, size_t n_there, int *has_new_limits, Err *err)
{
    Differences d = {.lines = c->lines};
    Inputs now;
    char kernels[32];
    const char *provenance = c->run->provenance;
    const uint64_t record = provenance_hash(provenance, "record_fnv1a");

    /* 1. Settings, and the content of the files that they name. */
    settings_compare(c->run->settings, c->used, compare_one, &d);
    TRY(provenance_inputs(&now, c->adapter, err));
    compare_hash(&d, "motion.record", record, now.record);
    compare_hash(&d, "motion.forces", provenance_hash(provenance, "forces_fnv1a"), now.forces);
    if (now.record == record)
        compare_hash(&d, "motion.records", provenance_hash(provenance, "records_fnv1a"), now.records);
    compare_hash(&d, "building.model", provenance_hash(provenance, "matrices_fnv1a"), now.matrices);
    *has_new_limits = d.n_limits > 0;

    /* 2. Another rounding is no other setting, but from here on it is another search. */
    provenance_blas(provenance, kernels);
    if (c->lines && *kernels && strcmp(kernels, linalg_kernel_name()) != 0)
        fprintf(c->lines,
                "note: linear algebra by the kernels %s in the run, now %s: rounded differently, the search goes on "
                "otherwise than it would there\n",
                kernels, linalg_kernel_name());
    if (d.n_others > 0)
        return bad_data(err,
                        "%s: holds a run with other settings: %s%s; put that back, or choose another --out, or --new",
                        c->run->folder, d.first, d.n_limits + d.n_others > 1 ? ", and more" : "");

    /* 3. A limit below what is there already would leave a run that is neither finished nor can be resumed. */
    const long most = c->used->search.max_evals;
    return most == c->run->settings->search.max_evals || most >= (long)n_there
               ? STATUS_OK
               : bad_data(err, "%s: search.max_evals = %ld is less than the %zu simulations that it holds",
                          c->run->folder, most, n_there);
}
