#include "report/elsewhere.h"

#include "motion/builtin.h"
#include "motion/suite.h"

static Status add(OtherRecords *r, const char *source, Err *err)
{
    if (r->n == ELSEWHERE_MAX)
        return misused(err, "more than %d earthquakes make no report", ELSEWHERE_MAX);
    TRY(option_put_path(r->text[r->n], source, err));
    r->source[r->n] = r->text[r->n];
    r->n++;
    return STATUS_OK;
}

/* Of the study's own as many as there is room for, the first one apart. */
static Status add_own(const char *source, void *user, Err *err)
{
    OtherRecords *r = user;
    return r->n_seen++ > 0 && r->n < ELSEWHERE_MAX ? add(r, source, err) : STATUS_OK;
}

static Status add_given(const char *source, void *user, Err *err)
{
    return add(user, source, err);
}

Status elsewhere_of_study(OtherRecords *r, const MotionOptions *study, Err *err)
{
    return suite_of_study(study, add_own, r, err);
}

Status elsewhere_add(OtherRecords *r, const char *source, Err *err)
{
    return suite_each(source, add_given, r, err);
}

Status elsewhere_otherwise(OtherRecords *r, const MotionOptions *study, Err *err)
{
    static const char *const BUILT_IN[] = {BUILTIN_MOTION_LIST(CHOICE_WORD)};
    const int none = r->n == 0;
    for (size_t i = 0; none && i < N_OF(BUILT_IN); i++)
        if (strcmp(study->record, BUILT_IN[i]) != 0)
            TRY(add(r, BUILT_IN[i], err));
    return STATUS_OK;
}
