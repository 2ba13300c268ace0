#include "motion/formats/record.h"

#include <archive.h>
#include <archive_entry.h>

int archive_is(const unsigned char bytes[], size_t n)
{
    return n > 4 &&
           (memcmp(bytes, "PK\003\004", 4) == 0 || memcmp(bytes, "\037\213", 2) == 0 || memcmp(bytes, "BZh", 3) == 0 ||
            (n > 6 && memcmp(bytes, "\3757zXZ", 5) == 0) || (n > 512 && memcmp(bytes + 257, "ustar", 5) == 0));
}

static struct archive *open_memory(const char *bytes, size_t n)
{
    struct archive *a = archive_read_new();
    if (!a)
        return NULL;
    archive_read_support_filter_all(a);
    archive_read_support_format_zip(a);
    archive_read_support_format_tar(a);
    archive_read_support_format_raw(a);
    if (archive_read_open_memory(a, bytes, n) == ARCHIVE_OK)
        return a;
    archive_read_free(a);
    return NULL;
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
            return bad_data(err, "%s: a damaged archive: %s", path,
                            archive_error_string(a) ? archive_error_string(a) : "unreadable");
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

static Status each_member(struct archive *a, const char *path, ArchiveFn take, void *user, Err *err)
{
    struct archive_entry *entry;
    size_t total = 0;
    int code;
    while ((code = archive_read_next_header(a, &entry)) == ARCHIVE_OK) {
        const char *name = archive_entry_pathname(entry);
        char *bytes;
        size_t n;
        if (archive_entry_filetype(entry) && archive_entry_filetype(entry) != AE_IFREG)
            continue;
        Status status = read_member(a, path, &bytes, &n, &total, err);
        if (status == STATUS_OK && n > 0)
            status = take(name ? name : "", bytes, n, user, err);
        free(bytes);
        TRY(status);
    }
    return code == ARCHIVE_EOF ? STATUS_OK
                               : bad_data(err, "%s: a damaged archive: %s", path,
                                          archive_error_string(a) ? archive_error_string(a) : "unreadable");
}

Status archive_each(const char *path, const char *bytes, size_t n, ArchiveFn take, void *user, Err *err)
{
    struct archive *a = open_memory(bytes, n);
    if (!a)
        return bad_data(err, "%s: a damaged archive", path);
    const Status status = each_member(a, path, take, user, err);
    archive_read_free(a);
    return status;
}
