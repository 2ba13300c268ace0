#include "cmd/outputs.h"

#include <limits.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/text.h"
#include "scene/building_read.h"
#include "settings/settings.h"
#include "store/folder.h"
#include "store/output.h"

/* Options whose value is a file that is written. */
static const char *const WRITTEN[] = {"--csv",           "--svg", "--history", "--contacts",
                                      "--floor-spectra", "--out", "--dossier", "--pelicun"};
enum { N_WRITTEN = N_OF(WRITTEN) };

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

/* Is it that file, or one in that folder, which is no run's and holds more than pictures? */
static int is_read_from(const char *out, const char *place)
{
    struct stat is, other;
    char folder[PATH_MAX];
    if (stat(out, &is) != 0 || !S_ISREG(is.st_mode) || stat(place, &other) != 0)
        return 0;
    if (S_ISDIR(other.st_mode) && !folder_is_run(place) && !text_ends(out, ".svg")) {
        folder_of(out, folder);
        if (stat(folder, &is) != 0)
            return 0;
    }
    return is.st_dev == other.st_dev && is.st_ino == other.st_ino;
}

typedef struct {
    const char *out;
    char reader[80]; /* empty: no setting names it */
} Looking;

static void compare(const char *key, const char *path, void *user)
{
    Looking *l = user;
    struct stat is;
    const int is_folder = stat(path, &is) == 0 && S_ISDIR(is.st_mode);
    if (is_read_from(l->out, path) && (!is_folder || building_reads(basename(l->out))))
        snprintf(l->reader, sizeof l->reader, "%s names", key);
}

/* word: a file, a folder, a run, or one of its designs: FILE:N, RUN:ID. A run reads what the settings in its folder
 * name when a design of it is simulated again. */
static int is_read(const char *out, const char *word)
{
    Settings s;
    char place[PATH_MAX], file[PATH_MAX];
    const char *colon = strrchr(word, ':');
    const size_t ends[] = {strlen(word), colon ? (size_t)(colon - word) : 0};
    Looking l = {.out = out};
    for (int k = 0; k < (colon ? 2 : 1); k++) {
        snprintf(place, sizeof place, "%.*s", (int)ends[k], word);
        if (is_read_from(out, place))
            return 1;
        if (!folder_is_run(place) || snprintf(file, sizeof file, "%s/settings.ini", place) >= PATH_MAX)
            continue;
        settings_defaults(&s);
        if (settings_read(&s, file, NULL, NULL, &(Err){0}) == STATUS_OK)
            settings_each_path(&s, compare, &l);
    }
    return l.reader[0] != 0;
}

static Status refuse(const Given *out, const char *reader, Err *err)
{
    return misused(err, "%s would replace %s, which %s; name another file", out->option->name, out->value, reader);
}

static Status check_one(const Args *args, const Given *out, Err *err)
{
    int n_readers = 0;
    struct stat is, there;
    char folder[PATH_MAX], beside[PATH_MAX];
    if (folder_keeps(out->value))
        return refuse(out, "a run needs", err);
    if (stat(out->value, &is) == 0 && S_ISREG(is.st_mode) && !(is.st_mode & (S_IWUSR | S_IWGRP | S_IWOTH)))
        return refuse(out, "is write-protected", err);

    /* Is there a folder that takes it? That of --out may be made by the command. */
    folder_of(out->value, folder);
    if (strcmp(out->option->name, "--out") != 0 && access(folder, W_OK) != 0)
        return fail_errno(err, out->value, "cannot be written");
    for (int j = 0; j < args->n_operands; j++)
        n_readers += is_read(out->value, args->operands[j]);
    for (int j = 0; j < args->n_given; j++) {
        const Given *other = &args->given[j];
        if (other == out || !other->value)
            continue;

        /* The same name in the same folder, there or not, however it was typed. */
        folder_of(other->value, beside);
        if (is_written(other) && strcmp(basename(other->value), basename(out->value)) == 0 && stat(folder, &is) == 0 &&
            stat(beside, &there) == 0 && is.st_dev == there.st_dev && is.st_ino == there.st_ino)
            return misused(err, "%s and %s are one file, %s; name another file", out->option->name, other->option->name,
                           out->value);
        const char *equals = strcmp(other->option->name, "--set") == 0 ? strchr(other->value, '=') : NULL;
        n_readers += !is_written(other) && is_read(out->value, equals ? equals + 1 : other->value);
    }
    return n_readers ? refuse(out, "the command reads", err) : STATUS_OK;
}

Status outputs_check(const Args *args, Err *err)
{
    const char *first = outputs_standard(args, 0), *second = outputs_standard(args, 1);
    if (second)
        return misused(err, "%s and %s both want standard output; give one of them a file", first, second);
    for (int i = 0; i < args->n_given; i++)
        if (is_written(&args->given[i]))
            TRY(check_one(args, &args->given[i], err));
    return STATUS_OK;
}

Status outputs_spare(const Args *args, const Settings *s, Err *err)
{
    for (int i = 0; i < args->n_given; i++) {
        Looking l = {.out = args->given[i].value};
        if (is_written(&args->given[i]))
            settings_each_path(s, compare, &l);
        if (l.reader[0])
            return refuse(&args->given[i], l.reader, err);
    }
    return STATUS_OK;
}
