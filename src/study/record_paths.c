#include "study/record_paths.h"

#include <unistd.h>

#include "motion/builtin.h"
#include "motion/motion_scale.h"
#include "motion/suite.h"
#include "settings/settings.h"
#include "store/provenance.h"

const char *const MOVED_KEY[N_MOVED] = {"motion.record", "motion.records", "motion.forces"};

static Status check_is_there(const char *source, const char *what, const char *key, Err *err)
{
    char path[OPTION_TEXT_MAX];
    snprintf(path, sizeof path, "%.*s", (int)source_path_length(source), source);
    if (builtin_name(path) || strcmp(path, "none") == 0 || access(path, R_OK) == 0)
        return STATUS_OK;
    return fail(err, STATUS_MISSING, "%s: a %s of the run is not there; where it was moved, say so: --set %s=PATH%s",
                path, what, key,
                strcmp(key, MOVED_KEY[MOVED_RECORDS]) == 0 ? ",... (all of them, in their order)" : "");
}

/* A record, of which `user` has seen so many. */
static Status check_record(const char *source, void *user, Err *err)
{
    size_t *seen = user;
    return check_is_there(source, "record", MOVED_KEY[(*seen)++ == 0 ? MOVED_RECORD : MOVED_RECORDS], err);
}

static Status check_all_there(const Settings *s, Err *err)
{
    size_t seen = 0;
    TRY(suite_of_study(&s->motion, check_record, &seen, err));
    return check_is_there(s->motion.forces, "file", MOVED_KEY[MOVED_FORCES], err);
}

typedef struct {
    MotionOptions one;
    uint64_t *now; /* (N_MOVED) */
    size_t seen;
} Hashed;

static Status hash_record(const char *source, void *user, Err *err)
{
    Hashed *h = user;
    Motion m = {0};
    TRY(option_put_path(h->one.record, source, err));
    TRY(motion_open(&m, &h->one, err));
    if (h->seen++ == 0)
        h->now[MOVED_RECORD] = m.file_hash;
    h->now[MOVED_RECORDS] = provenance_add_hash(h->now[MOVED_RECORDS], m.file_hash);
    h->now[MOVED_FORCES] = m.forces_hash;
    motion_free(&m);
    return STATUS_OK;
}

static Status compare(const Settings *s, const char *provenance, Err *err)
{
    static const char *const HASH[N_MOVED] = {"record_fnv1a", "records_fnv1a", "forces_fnv1a"};
    const char *const path[N_MOVED] = {s->motion.record, s->motion.records, s->motion.forces};
    uint64_t now[N_MOVED] = {0};
    TRY(suite_of_study(&s->motion, hash_record, &(Hashed){s->motion, now, 0}, err));
    for (int k = 0; k < N_MOVED; k++)
        if (provenance_hash(provenance, HASH[k]) != now[k])
            return bad_data(err, "%s: %.200s does not hold what it held for the run", MOVED_KEY[k], path[k]);
    return STATUS_OK;
}

Status record_paths_find(Settings *s, const char *provenance, const RecordPaths *moved, Err *err)
{
    if (s->problem.kind != PROBLEM_TOWER)
        return STATUS_OK;
    for (int k = 0; k < N_MOVED; k++)
        if (moved->path[k])
            TRY(settings_put(s, MOVED_KEY[k], moved->path[k], err));
    TRY(check_all_there(s, err));
    return compare(s, provenance, err);
}

Status record_paths_check(const Settings *s, const Run *run, Err *err)
{
    if (s->problem.kind != PROBLEM_TOWER)
        return STATUS_OK;
    TRY(check_all_there(s, err));
    Settings own = *s;
    settings_make_absolute(&own);
    const MotionOptions *is = &own.motion, *was = run ? &run->settings->motion : NULL;
    return was && strcmp(is->record, was->record) == 0 && strcmp(is->records, was->records) == 0 &&
                   strcmp(is->forces, was->forces) == 0
               ? compare(s, run->provenance, err)
               : STATUS_OK;
}
