#include "study/differences.h"

#include "base/linalg.h"
#include "base/visible.h"
#include "settings/settings.h"
#include "store/provenance.h"

typedef struct {
    FILE *lines;
    size_t n_limits, n_lowered, n_others; /* n_lowered: of the limits */
    char first[sizeof((Err *)0)->text];   /* of the others, else of the limits */
} Differences;

enum { SHOWN = 120 }; /* bytes of a long value in the message; the lines have all of it */

/* A limit of 0, or a word, is none. That of hours is of one session, and takes nothing from a run. */
static int is_lower(const char *key, const char *is, const char *was)
{
    const double now = strtod(is, NULL), before = strtod(was, NULL);
    return strcmp(key, "search.max_hours") != 0 && now > 0.0 && (now < before || !(before > 0.0));
}

static void add_difference(Differences *d, const char *key, int is_limit, const char *was, const char *is)
{
    if (d->n_others == 0 && (!is_limit || d->n_limits == 0))
        snprintf(d->first, sizeof d->first, "%s is %.*s%s there, now %.*s%s", key, visible_cut(was, SHOWN), was,
                 strlen(was) > SHOWN ? "..." : "", visible_cut(is, SHOWN), is, strlen(is) > SHOWN ? "..." : "");
    d->n_limits += is_limit;
    d->n_lowered += is_limit && is_lower(key, is, was);
    d->n_others += !is_limit;
    if (d->lines)
        fprintf(d->lines, "%s: %s in the run, now %s%s\n", key, was, is, is_limit ? " (a limit)" : "");
}

static void compare_one(const char *key, unsigned flags, const char *was, const char *is, void *user)
{
    if (!(flags & SETTING_FREE))
        add_difference(user, key, (flags & SETTING_LIMIT) != 0, was, is);
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

static Status compare_inputs(const Comparison *c, Differences *d, Err *err)
{
    Inputs now;
    TRY(provenance_inputs(&now, c->adapter, err));
    const char *provenance = c->run->provenance;
    const uint64_t record = provenance_hash(provenance, "record_fnv1a");
    compare_hash(d, "motion.record", record, now.record);
    compare_hash(d, "motion.forces", provenance_hash(provenance, "forces_fnv1a"), now.forces);
    if (now.record == record)
        compare_hash(d, "motion.records", provenance_hash(provenance, "records_fnv1a"), now.records);
    compare_hash(d, "building.model", provenance_hash(provenance, "matrices_fnv1a"), now.matrices);
    return STATUS_OK;
}

/* Another rounding is no other setting, but from here on it is another search. */
static void tell_kernels(const Comparison *c)
{
    char was[32];
    provenance_blas(c->run->provenance, was);
    if (c->lines && was[0] && strcmp(was, linalg_kernel_name()) != 0)
        fprintf(c->lines,
                "note: linear algebra by the kernels %s in the run, now %s: rounded differently, the search goes on "
                "otherwise than it would there\n",
                was, linalg_kernel_name());
}

/* A limit below what is there already would leave a run that is neither finished nor can be resumed. */
static Status check_limit(const Comparison *c, size_t n_there, Err *err)
{
    const long was = c->run->settings->search.max_evals, now = c->used->search.max_evals;
    return now == was || now >= (long)n_there
               ? STATUS_OK
               : bad_data(err, "%s: search.max_evals = %ld is less than the %zu simulations that it holds",
                          c->run->folder, now, n_there);
}

Status differences_check(const Comparison *c, size_t n_there, int *has_new_limits, Err *err)
{
    Differences d = {.lines = c->lines};
    settings_compare(c->run->settings, c->used, compare_one, &d);
    TRY(compare_inputs(c, &d, err));
    const size_t n = d.n_limits + d.n_others;
    *has_new_limits = d.n_limits > 0;
    tell_kernels(c);
    if (d.n_others == 0 && (c->force || d.n_lowered == 0))
        return check_limit(c, n_there, err);
    return bad_data(
        err, "%s: holds a run with other settings: %s%s; %s", c->run->folder, d.first, n > 1 ? ", and more" : "",
        d.n_others == 0 ? "--force-settings lowers limits" : "put that back, or choose another --out, or --new");
}
