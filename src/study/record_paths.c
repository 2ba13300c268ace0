#include "study/record_paths.h"

#include <unistd.h>

#include "motion/builtin.h"
#include "motion/motion_scale.h"
#include "settings/options.h"
#include "store/provenance.h"

static Status check_is_there(const char *path, const char *key, Err *err)
{
    if (builtin_name(path) || strcmp(path, "none") == 0 || access(path, R_OK) == 0)
        return STATUS_OK;
    return fail(err, STATUS_MISSING,
                "%s: a record of the run is not there; where it was moved, say so: --set motion.%s", path, key);
}

static Status check_all_there(const Settings *s, Err *err)
{
    char path[OPTION_TEXT_MAX];
    for (size_t i = 0; i < motion_n_records(&s->motion); i++) {
        TRY(motion_record(&s->motion, i, path, err));
        TRY(check_is_there(path, i == 0 ? "record=PATH" : "records=PATH,... (all of them, in their order)", err));
    }
    return STATUS_OK;
}

static Status hash_record(const MotionOptions *s, const char *path, uint64_t *hash, Err *err)
{
    Motion m = {0};
    MotionOptions one = *s;
    snprintf(one.record, sizeof one.record, "%s", path);
    const Status status = motion_open(&m, &one, err);
    *hash = m.file_hash;
    motion_free(&m);
    return status;
}

static Status hash_all(const Settings *s, uint64_t *record, uint64_t *records, Err *err)
{
    char path[OPTION_TEXT_MAX];
    uint64_t hash;
    *record = *records = 0;
    for (size_t i = 0; i < motion_n_records(&s->motion); i++) {
        TRY(motion_record(&s->motion, i, path, err));
        TRY(hash_record(&s->motion, path, &hash, err));
        *record = i == 0 ? hash : *record;
        *records = provenance_add_hash(*records, hash);
    }
    return STATUS_OK;
}

Status record_paths_find(Settings *s, const char *provenance, const RecordPaths *moved, Err *err)
{
    const Settings was = *s;
    uint64_t record, records;
    if (s->problem.kind != PROBLEM_TOWER)
        return STATUS_OK;
    if (moved->record)
        TRY(option_put_path(s->motion.record, moved->record, err));
    if (moved->records)
        TRY(option_put_path(s->motion.records, moved->records, err));
    TRY(check_all_there(s, err));
    if (!moved->record && !moved->records)
        return STATUS_OK;
    TRY(hash_all(s, &record, &records, err));
    if (moved->record && provenance_hash(provenance, "record_fnv1a") != record)
        return bad_data(err, "%s: does not hold what the run's record %.200s held", moved->record, was.motion.record);
    if (moved->records && provenance_hash(provenance, "records_fnv1a") != records)
        return bad_data(err, "%.200s: do not hold what the run's records %.200s held", moved->records,
                        was.motion.records);
    return STATUS_OK;
}
