#include "report/elsewhere.h"

#include "base/csv.h"
#include "base/hash.h"
#include "motion/builtin.h"
#include "motion/suite.h"

/* Of the bytes of its file and the words behind the path; of what is no file, of its name. */
static uint64_t content_of(const char *source)
{
    const size_t end = source_path_length(source);
    char path[OPTION_TEXT_MAX], *bytes;
    uint64_t hash = HASH_SEED;
    size_t length;
    Err unused;
    snprintf(path, sizeof path, "%.*s", (int)end, source);
    if (file_read(path, FILE_LARGEST, &bytes, &length, &unused) != STATUS_OK)
        return hash_fnv1a(source, strlen(source), hash);
    hash = hash_fnv1a(bytes, length, hash);
    free(bytes);
    return hash_fnv1a(source + end, strlen(source + end), hash);
}

/* The same record under another name counts once too, which the notes say. */
static Status add(const char *source, void *user, Err *err)
{
    OtherRecords *r = user;
    const uint64_t content = content_of(source);
    size_t i = 0;
    while (i <= r->n && r->content[i] != content)
        i++;
    const char *other = i == 0 ? r->own : i <= r->n ? r->source[i - 1] : source;
    if (r->notes && strcmp(source, other) != 0)
        fprintf(r->notes, "note: %s has the content of %s, which is shown already\n", source, other);
    if (i <= r->n)
        return STATUS_OK;
    if (r->n == ELSEWHERE_MAX)
        return misused(err, "more than %d earthquakes make no report", ELSEWHERE_MAX);
    TRY(option_put_path(r->text[r->n], source, err));
    r->source[r->n] = r->text[r->n];
    r->content[++r->n] = content;
    return STATUS_OK;
}

/* The first one apart. */
static Status add_own(const char *source, void *user, Err *err)
{
    OtherRecords *r = user;
    if (r->n_seen++ > 0)
        return add(source, r, err);
    r->content[0] = content_of(source);
    return option_put_path(r->own, source, err);
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
