#include "motion/motion_source.h"

#include "motion/builtin.h"
#include "motion/motion_process.h"
#include "motion/motion_read.h"

static Status load(Motion *m, const char *source, const MotionHow *how, Err *err)
{
    static const char *const MOTIONS[] = {BUILTIN_MOTION_LIST(CHOICE_WORD)};
    if (builtin_name(source))
        return builtin_motion(m, builtin_name(source), err); /* in m/s2, one channel, whatever is said of files */
    const Status status = motion_read(m, source, how, err);
    const char *near =
        status == STATUS_MISSING ? nearest_word(source, MOTIONS, sizeof MOTIONS / sizeof MOTIONS[0]) : NULL;
    return near ? fail(err, status, "%s: there is no such file; did you mean %s?", source, near) : status;
}

Status motion_load(Motion *m, const char *source, MotionUnit unit, Err *err)
{
    return load(m, source, &(MotionHow){.unit = unit}, err);
}

Status motion_open(Motion *m, const MotionOptions *o, Err *err)
{
    MotionHow how = {.channel = o->channel, .dt_s = o->dt_s};
    TRY(motion_unit_parse(o->unit, &how.unit, &how.counts_per_m_s2, err));
    TRY(load(m, o->record, &how, err));
    const Status status = motion_process(m, o, err);
    if (status != STATUS_OK)
        motion_free(m);
    return status;
}
