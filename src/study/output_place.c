#include "study/output_place.h"

#include <errno.h>
#include <limits.h>
#include <sys/stat.h>

#include "store/output.h"

static const char RESULTS[] = "results";

/* Where the part of the path that is there already leads, links followed. */
static int find_existing(const char *path, char found[PATH_MAX])
{
    char part[PATH_MAX];
    text_copy(part, path);
    while (!realpath(part, found)) {
        char *slash = strrchr(part, '/');
        if (errno != ENOENT || !slash || slash == part)
            return 0;
        *slash = 0;
    }
    return 1;
}

static int is_below(const char *path, const char *folder)
{
    const size_t n = strlen(folder);
    return strncmp(path, folder, n) == 0 && (path[n] == '/' || path[n] == 0);
}

Status output_place_check(const char *out, const char *settings_file, Err *err)
{
    char own[PATH_MAX], there[PATH_MAX], results[PATH_MAX];
    struct stat about;
    const char *path = out + (strncmp(out, "./", 2) == 0 ? 2 : 0);
    folder_of(settings_file, own);
    if (realpath(own, results) && realpath(out, there) && strcmp(results, there) == 0)
        return STATUS_OK;
    int has_step_up = 0;
    for (const char *part = path; *part; part += strspn(part, "/")) {
        const size_t n = strcspn(part, "/");
        has_step_up |= n == 2 && strncmp(part, "..", 2) == 0;
        part += n;
    }
    if (!is_below(path, RESULTS) || has_step_up)
        return bad_data(
            err,
            "%s: run.out: %.200s is not below %s/, the only place where a settings file may write; name another "
            "one on the command line: --out %.100s",
            settings_file, out, RESULTS, out);
    if (realpath(RESULTS, results) && stat(results, &about) == 0 && S_ISDIR(about.st_mode) &&
        (!find_existing(path, there) || !is_below(there, results)))
        return bad_data(
            err,
            "%s: run.out: %.200s is a link that leads out of %s/; where this is meant, say so on the command "
            "line: --out %.100s",
            settings_file, out, RESULTS, out);
    return STATUS_OK;
}
