#include "motion/formats/record.h"

#include <archive.h>
#include <archive_entry.h>

int archive_is(const char bytes[], size_t n)
{
    return n > 4 &&
           (memcmp(bytes, "PK\003\004", 4) == 0 || memcmp(bytes, "\037\213", 2) == 0 || memcmp(bytes, "BZh", 3) == 0 ||
            (n > 6 && memcmp(bytes, "\3757zXZ", 5) == 0) || (n > 512 && memcmp(bytes + 257, "ustar", 5) == 0));
}

static Status fail_damaged(struct archive *a, const char *path, Err *err)
{
    return bad_data(err, "%s: a damaged archive: %s", path,
                    archive_error_string(a) ? archive_error_string(a) : "unreadable");
}

/* All of the present member; *total counts the bytes of all members. */
static Status read_member(struct archive *a, const char *path, char **out, size_t *n, size_t *total, Err *err)
{
    size_t capacity = 0;
    *out = NULL;
    *n = 0;
    for (;;) {
        if (*n == capacity) {
            capacity = capacity ? 2 * capacity : 1 << 16;
            char *wider = realloc(*out, capacity + 1);
            if (!wider)
                return fail(err, STATUS_NO_MEMORY, "%s: no memory for a member of %zu bytes", path, capacity);
            *out = wider;
        }
        const la_ssize_t got = archive_read_data(a, *out + *n, capacity - *n);
        if (got < 0)
            return fail_damaged(a, path, err);
        if (got == 0)
            break;
        *n += got;
        *total += got;
        if (*total > ARCHIVE_BYTES_MAX)
            return bad_data(err, "%s: unpacks to more than %zu MiB", path, ARCHIVE_BYTES_MAX >> 20);
    }
    (*out)[*n] = 0;
    return STATUS_OK;
}

Status archive_each(const char *path, const char *bytes, size_t n, ArchiveFn take, void *user, Err *err)
{
    struct archive *a = archive_read_new();
    struct archive_entry *entry;
    Status status = STATUS_OK;
    size_t total = 0, length;
    int code = ARCHIVE_FATAL;
    char *member;
    if (a) {
        archive_read_support_filter_all(a);
        archive_read_support_format_zip(a);
        archive_read_support_format_tar(a);
        archive_read_support_format_raw(a);
        code = archive_read_open_memory(a, bytes, n);
    }
    if (code != ARCHIVE_OK) {
        archive_read_free(a);
        return bad_data(err, "%s: a damaged archive", path);
    }
    while (status == STATUS_OK && (code = archive_read_next_header(a, &entry)) == ARCHIVE_OK) {
        const char *name = archive_entry_pathname(entry);
        if (archive_entry_filetype(entry) && archive_entry_filetype(entry) != AE_IFREG)
            continue;
        status = read_member(a, path, &member, &length, &total, err);
        if (status == STATUS_OK && length > 0)
            status = take(name ? name : "", member, length, user, err);
        free(member);
    }
    if (status == STATUS_OK && code != ARCHIVE_EOF)
        status = fail_damaged(a, path, err);
    archive_read_free(a);
    return status;
}
