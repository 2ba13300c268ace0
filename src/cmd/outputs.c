#include "cmd/outputs.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "scene/building_read.h"
#include "settings/settings.h"
#include "store/folder.h"

/* Options whose value is a file that is written. */
static const char *const WRITTEN[] = {"--csv", "--svg", "--history", "--contacts", "--floor-spectra", "--out"};

static int is_written(const Given *g)
{
    for (size_t k = 0; k < sizeof WRITTEN / sizeof WRITTEN[0]; k++)
        if (strcmp(g->option->name, WRITTEN[k]) == 0)
            return strcmp(g->value, "-") != 0;
    return 0;
}

static const Given *find(const Args *args, const char *name)
{
    for (int i = 0; i < args->n_given; i++)
        if (strcmp(args->given[i].option->name, name) == 0)
            return &args->given[i];
    return NULL;
}

const char *outputs_standard(const Args *args, int i)
{
    for (size_t k = 0; k < sizeof WRITTEN / sizeof WRITTEN[0]; k++) {
        const Given *g = find(args, WRITTEN[k]);
        if (g && strcmp(g->value, "-") == 0 && i-- == 0)
            return WRITTEN[k];
    }
    return find(args, "--json") && i == 0 ? "--json" : NULL;
}

static const char *name_of(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

/* The place of a file that is not there yet. */
static const char *place_of(const char *path, char place[PATH_MAX])
{
    char folder[PATH_MAX], real[PATH_MAX];
    const char *name = name_of(path);
    snprintf(folder, sizeof folder, "%.*s", name > path ? (int)(name - path) : 1, name > path ? path : ".");
    return realpath(folder, real) && snprintf(place, PATH_MAX, "%s/%s", real, name) < PATH_MAX ? place : path;
}

static int is_same_file(const char *path, const char *other)
{
    struct stat a, b;
    char first[PATH_MAX], second[PATH_MAX];
    if (stat(path, &a) != 0)
        return strcmp(place_of(path, first), place_of(other, second)) == 0;
    return S_ISREG(a.st_mode) && stat(other, &b) == 0 && a.st_dev == b.st_dev && a.st_ino == b.st_ino;
}

/* Is it a file of that folder? A run's has outputs too (folder_keeps), and a picture is read by no one. */
static int is_file_of(const char *path, const char *folder)
{
    struct stat a, b;
    char real[PATH_MAX];
    const char *end = strrchr(path, '.');
    if (!realpath(path, real) || stat(real, &a) != 0 || !S_ISREG(a.st_mode) || (end && strcmp(end, ".svg") == 0))
        return 0;
    *strrchr(real, '/') = 0;
    return folder_is_run(folder) == 0 && stat(real[0] ? real : "/", &a) == 0 && stat(folder, &b) == 0 &&
           a.st_dev == b.st_dev && a.st_ino == b.st_ino;
}

typedef struct {
    const char *out;
    char key[64]; /* of the setting that names it; empty: none does */
} Looking;

static void compare(const char *key, const char *path, void *user)
{
    Looking *l = user;
    if (is_same_file(l->out, path) || (is_file_of(l->out, path) && building_reads(name_of(l->out))))
        snprintf(l->key, sizeof l->key, "%s names", key);
}

/* What a run reads when it is simulated again, by the settings in its folder. */
static int is_read_by_run(const char *path, const char *folder)
{
    Settings s;
    char file[PATH_MAX];
    Looking l = {.out = path};
    if (!folder_is_run(folder) || snprintf(file, sizeof file, "%s/settings.ini", folder) >= PATH_MAX)
        return 0;
    settings_defaults(&s);
    if (settings_read(&s, file, NULL, NULL, &(Err){0}) == STATUS_OK)
        settings_each_path(&s, compare, &l);
    return l.key[0] != 0;
}

/* A file, a folder of files, a run. */
static int is_read_at(const char *path, const char *place)
{
    return is_same_file(path, place) || is_file_of(path, place) || is_read_by_run(path, place);
}

/* source: the same, or one of its designs, FILE:N, RUN:ID. */
static int is_read_from(const char *path, const char *source)
{
    char place[PATH_MAX];
    const char *colon = strrchr(source, ':');
    snprintf(place, sizeof place, "%.*s", colon ? (int)(colon - source) : 0, source);
    return is_read_at(path, source) || (colon && is_read_at(path, place));
}

static Status refuse(const Given *out, const char *reader, Err *err)
{
    return fail(err, STATUS_USAGE, "%s would replace %s, which %s; name another file", out->option->name, out->value,
                reader);
}

static Status check_one(const Args *args, const Given *out, Err *err)
{
    struct stat is;
    if (folder_keeps(out->value))
        return refuse(out, "a run needs", err);
    if (stat(out->value, &is) == 0 && S_ISREG(is.st_mode) && !(is.st_mode & (S_IWUSR | S_IWGRP | S_IWOTH)))
        return refuse(out, "is write-protected", err);
    for (int j = 0; j < args->n_operands; j++)
        if (is_read_from(out->value, args->operands[j]))
            return refuse(out, "the command reads", err);
    for (int j = 0; j < args->n_given; j++) {
        const Given *other = &args->given[j];
        if (other == out || !other->value)
            continue;
        if (is_written(other) && is_same_file(out->value, other->value))
            return fail(err, STATUS_USAGE, "%s and %s are one file, %s; name another file", out->option->name,
                        other->option->name, out->value);
        const char *equals = strcmp(other->option->name, "--set") == 0 ? strchr(other->value, '=') : NULL;
        if (!is_written(other) && is_read_from(out->value, equals ? equals + 1 : other->value))
            return refuse(out, "the command reads", err);
    }
    return STATUS_OK;
}

Status outputs_check(const Args *args, Err *err)
{
    const char *first = outputs_standard(args, 0), *second = outputs_standard(args, 1);
    if (second)
        return fail(err, STATUS_USAGE, "%s and %s both want standard output; give %s a file", first, second, first);
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
        if (l.key[0])
            return refuse(&args->given[i], l.key, err);
    }
    return STATUS_OK;
}
