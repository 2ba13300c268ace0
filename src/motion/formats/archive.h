/* motion/formats/archive.h -- the members of an archive in memory: zip, tar, and gzip, bzip2, xz with or without tar.
 *
 * Memory  all of a member at a time, ARCHIVE_BYTES_MAX of all members: what unpacks to more is refused
 * Errors  no archive, damaged, too large */
#ifndef IMTET_MOTION_FORMATS_ARCHIVE_H
#define IMTET_MOTION_FORMATS_ARCHIVE_H

#include <stddef.h>

#include "base/status.h"

#define ARCHIVE_BYTES_MAX ((size_t)1 << 28)

int archive_is(const unsigned char bytes[], size_t n);

/* Calls take for every file in the order of the archive; name: with folders. */
typedef Status (*ArchiveFn)(const char *name, const char *bytes, size_t n, void *user, Err *err);
Status archive_each(const char *path, const char *bytes, size_t n, ArchiveFn take, void *user, Err *err);

#endif
