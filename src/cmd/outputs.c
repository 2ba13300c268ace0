#include "cmd/outputs.h"

#include <errno.h>
#include <limits.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "store/folder.h"

/* Options whose value is a file that is written. */
static const char *const WRITTEN[] = {"--csv", "--svg", "--history", "--contacts", "--floor-spectra", "--out"};
enum { N_WRITTEN = sizeof WRITTEN / sizeof WRITTEN[0] };

static int is_written(const Given *g)
{
    for (size_t k = 0; k < N_WRITTEN; k++)
        if (strcmp(g->option->name, WRITTEN[k]) == 0)
            return strcmp(g->value, "-") != 0;
    return 0;
}

const char *outputs_standard(const Args *args, int i)
{
    for (int j = 0; j < args->n_given; j++) {
        const Given *g = &args->given[j];
        if (((g->value && strcmp(g->value, "-") == 0) || strcmp(g->option->name, "--json") == 0) && i-- == 0)
            return g->option->name;
    }
    return NULL;
}

static void folder_of(const char *path, char folder[PATH_MAX])
{
    const char *slash = strrchr(path, '/');
    snprintf(folder, PATH_MAX, "%.*s", slash ? (int)(slash - path) + 1 : 1, slash ? path : ".");
}

/* Is there a folder that takes it? The folder of --out may be made by the command. */
static Status check_one(const Given *out, Err *err)
{
    struct stat is;
    char folder[PATH_MAX];
    folder_of(out->value, folder);
    if (folder_keeps(out->value))
        return fail(err, STATUS_USAGE, "%s would replace %s, which a run needs; name another file", out->option->name,
                    out->value);
    if (stat(out->value, &is) == 0 && S_ISREG(is.st_mode) && !(is.st_mode & (S_IWUSR | S_IWGRP | S_IWOTH)))
        return fail(err, STATUS_USAGE, "%s: %s is write-protected; name another file", out->option->name, out->value);
    return strcmp(out->option->name, "--out") == 0 || access(folder, W_OK) == 0
               ? STATUS_OK
               : fail(err, status_of_errno(errno, STATUS_IO), "%s: cannot be written: %s", out->value, strerror(errno));
}

Status outputs_check(const Args *args, Err *err)
{
    const char *first = outputs_standard(args, 0), *second = outputs_standard(args, 1);
    if (second)
        return fail(err, STATUS_USAGE, "%s and %s both want standard output; give one of them a file", first, second);
    for (int i = 0; i < args->n_given; i++)
        if (is_written(&args->given[i]))
            TRY(check_one(&args->given[i], err));
    return STATUS_OK;
}
