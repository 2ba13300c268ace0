#include "report/elsewhere.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include "motion/builtin.h"
#include "motion/suite.h"

/* The file of a source, or what it is called. */
static void place_of(const char *source, char place[PATH_MAX])
{
    if (!realpath(source, place))
        snprintf(place, PATH_MAX, "%s", source);
}

static int is_there(const OtherRecords *r, const char *source)
{
    char place[PATH_MAX], other[PATH_MAX];
    place_of(source, place);
    for (size_t i = 0; i <= r->n; i++) {
        place_of(i < r->n ? r->source[i] : r->own, other);
        if (strcmp(place, other) == 0)
            return 1;
    }
    return 0;
}

static Status add(const char *source, void *user, Err *err)
{
    OtherRecords *r = user;
    if (is_there(r, source))
        return STATUS_OK;
    if (r->n == ELSEWHERE_MAX)
        return misused(err, "more than %d earthquakes make no report", ELSEWHERE_MAX);
    TRY(option_put_path(r->text[r->n], source, err));
    r->source[r->n] = r->text[r->n];
    r->n++;
    return STATUS_OK;
}

/* The first one apart. */
static Status add_own(const char *source, void *user, Err *err)
{
    OtherRecords *r = user;
    return r->n_seen++ > 0 ? add(source, r, err) : option_put_path(r->own, source, err);
}

Status elsewhere_of_study(OtherRecords *r, const MotionOptions *study, Err *err)
{
    return suite_of_study(study, add_own, r, err);
}

Status elsewhere_add(OtherRecords *r, const char *source, Err *err)
{
    return suite_each(source, add, r, err);
}

/* user: a source that is looked for; NULL once it was found. */
static Status find_source(const char *source, void *user, Err *err)
{
    const char **wanted = user;
    (void)err;
    if (*wanted && strcmp(source, *wanted) == 0)
        *wanted = NULL;
    return STATUS_OK;
}

Status elsewhere_otherwise(OtherRecords *r, const MotionOptions *study, Err *err)
{
    static const char *const BUILT_IN[] = {BUILTIN_MOTION_LIST(CHOICE_WORD)};
    const int none = r->n == 0;
    for (size_t i = 0; none && i < N_OF(BUILT_IN); i++) {
        const char *unused = BUILT_IN[i];
        TRY(suite_of_study(study, find_source, &unused, err));
        TRY(unused ? add(unused, r, err) : STATUS_OK);
    }
    return STATUS_OK;
}
