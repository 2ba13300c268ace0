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

/* The same name in the same folder, there or not, however it was typed. */
static int is_same_place(const char *one, const char *other)
{
    struct stat a, b;
    char folder[2][PATH_MAX];
    folder_of(one, folder[0]);
    folder_of(other, folder[1]);
    return strcmp(basename(one), basename(other)) == 0 && stat(folder[0], &a) == 0 && stat(folder[1], &b) == 0 &&
           a.st_dev == b.st_dev && a.st_ino == b.st_ino;
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

/* What a run reads when a design of it is simulated again, by the settings in its folder. */
static int is_read_by_run(const char *out, const char *folder)
{
    Settings s;
    char file[PATH_MAX];
    Looking l = {.out = out};
    if (!folder_is_run(folder) || snprintf(file, sizeof file, "%s/settings.ini", folder) >= PATH_MAX)
        return 0;
    settings_defaults(&s);
    if (settings_read(&s, file, NULL, NULL, &(Err){0}) == STATUS_OK)
        settings_each_path(&s, compare, &l);
    return l.reader[0] != 0;
}

static int is_read_at(const char *out, const char *place)
{
    return is_read_from(out, place) || is_read_by_run(out, place);
}

/* word: a file, a folder, a run, or one of its designs: FILE:N, RUN:ID. */
static int is_read(const char *out, const char *word)
{
    char place[PATH_MAX];
    const char *colon = strrchr(word, ':');
    snprintf(place, sizeof place, "%.*s", colon ? (int)(colon - word) : 0, word);
    return is_read_at(out, word) || (colon && is_read_at(out, place));
}

static Status refuse(const Given *out, const char *reader, Err *err)
{
    return misused(err, "%s would replace %s, which %s; name another file", out->option->name, out->value, reader);
}

/* Is there a folder that takes it? The folder of --out may be made by the command. */
static Status check_place(const Given *out, Err *err)
{
    char folder[PATH_MAX];
    folder_of(out->value, folder);
    if (strcmp(out->option->name, "--out") != 0 && access(folder, W_OK) != 0)
        return fail_errno(err, out->value, "cannot be written");
    return STATUS_OK;
}

static Status check_one(const Args *args, const Given *out, Err *err)
{
    int n_readers = 0;
    struct stat is;
    if (folder_keeps(out->value))
        return refuse(out, "a run needs", err);
    if (stat(out->value, &is) == 0 && S_ISREG(is.st_mode) && !(is.st_mode & (S_IWUSR | S_IWGRP | S_IWOTH)))
        return refuse(out, "is write-protected", err);
    TRY(check_place(out, err));
    for (int j = 0; j < args->n_operands; j++)
        n_readers += is_read(out->value, args->operands[j]);
    for (int j = 0; j < args->n_given; j++) {
        const Given *other = &args->given[j];
        if (other == out || !other->value)
            continue;
        if (is_written(other) && is_same_place(other->value, out->value))
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
