#include "cmd/outputs.h"

#include <errno.h>
#include <limits.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "scene/building_read.h"
#include "settings/settings.h"
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

/* Is it that file, or one in that folder, which is no run's and holds more than pictures? */
static int is_read_from(const char *out, const char *place)
{
    struct stat is, other;
    char folder[PATH_MAX];
    const char *end = strrchr(out, '.');
    if (stat(out, &is) != 0 || !S_ISREG(is.st_mode) || stat(place, &other) != 0)
        return 0;
    if (S_ISDIR(other.st_mode) && !folder_is_run(place) && !(end && strcmp(end, ".svg") == 0)) {
        folder_of(out, folder);
        if (stat(folder, &is) != 0)
            return 0;
    }
    return is.st_dev == other.st_dev && is.st_ino == other.st_ino;
}

/* word: a file, a folder, or a design of one: FILE:N, RUN:ID. */
static int is_read(const char *out, const char *word)
{
    char place[PATH_MAX];
    const char *colon = strrchr(word, ':');
    snprintf(place, sizeof place, "%.*s", colon ? (int)(colon - word) : 0, word);
    return is_read_from(out, word) || (colon && is_read_from(out, place));
}

static Status refuse(const Given *out, const char *reader, Err *err)
{
    return fail(err, STATUS_USAGE, "%s would replace %s, which %s; name another file", out->option->name, out->value,
                reader);
}

/* Is there a folder that takes it? The folder of --out may be made by the command. */
static Status check_one(const Args *args, const Given *out, Err *err)
{
    int n_readers = 0;
    struct stat is;
    char folder[PATH_MAX];
    folder_of(out->value, folder);
    if (folder_keeps(out->value))
        return refuse(out, "a run needs", err);
    if (stat(out->value, &is) == 0 && S_ISREG(is.st_mode) && !(is.st_mode & (S_IWUSR | S_IWGRP | S_IWOTH)))
        return refuse(out, "is write-protected", err);
    if (strcmp(out->option->name, "--out") != 0 && access(folder, W_OK) != 0)
        return fail(err, status_of_errno(errno, STATUS_IO), "%s: cannot be written: %s", out->value, strerror(errno));
    for (int j = 0; j < args->n_operands; j++)
        n_readers += is_read(out->value, args->operands[j]);
    for (int j = 0; j < args->n_given; j++) {
        const Given *other = &args->given[j];
        const char *value = other->value, *equals = value ? strchr(value, '=') : NULL;
        if (other == out || !value)
            continue;
        if (is_written(other) && strcmp(value, out->value) == 0)
            return fail(err, STATUS_USAGE, "%s and %s are one file, %s; name another file", out->option->name,
                        other->option->name, out->value);
        n_readers += !is_written(other) && (is_read(out->value, value) || (equals && is_read(out->value, equals + 1)));
    }
    return n_readers ? refuse(out, "the command reads", err) : STATUS_OK;
}

Status outputs_check(const Args *args, Err *err)
{
    const char *first = outputs_standard(args, 0), *second = outputs_standard(args, 1);
    if (second)
        return fail(err, STATUS_USAGE, "%s and %s both want standard output; give one of them a file", first, second);
    for (int i = 0; i < args->n_given; i++)
        if (is_written(&args->given[i]))
            TRY(check_one(args, &args->given[i], err));
    return STATUS_OK;
}

typedef struct {
    const char *out;
    int is_named; /* by a setting */
} Looking;

/* Of a building's folder only its own files count. */
static void compare(const char *key, const char *path, void *user)
{
    Looking *l = user;
    struct stat is;
    const int is_folder = stat(path, &is) == 0 && S_ISDIR(is.st_mode);
    const char *slash = strrchr(l->out, '/');
    (void)key;
    l->is_named |= is_read_from(l->out, path) && (!is_folder || building_reads(slash ? slash + 1 : l->out));
}

Status outputs_spare(const Args *args, const Settings *s, Err *err)
{
    for (int i = 0; i < args->n_given; i++) {
        Looking l = {.out = args->given[i].value};
        if (is_written(&args->given[i]))
            settings_each_path(s, compare, &l);
        if (l.is_named)
            return refuse(&args->given[i], "a setting names", err);
    }
    return STATUS_OK;
}
