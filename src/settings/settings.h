/* settings/settings.h -- every setting of a study: the option structs of the modules, described by one table
 * (settings.c).
 *
 *   [section]            an INI file; a key is "section.key"
 *   key = value          a setting that is not written keeps its default
 *
 * The reader, the range check, `--set section.key=value`, `imtet settings` and the copy saved with a run are loops
 * over the table: a new setting is one line there and one field in the options of its module (options.h has them
 * together). Rules that tie settings together: rules.h.
 *
 * Ownership  Settings is a plain value: copy it freely.   Threads  no state. */
#pragma once

#include "base/status.h"
#include "settings/options.h"

void settings_defaults(Settings *s);

/* Reads an INI file over what s holds. All faults are reported, not only the first: one line each into `faults`
 * ("FILE:LINE:COLUMN: key: what is wrong and what to do"), whose number is returned through n_faults; err has the
 * first. Relative paths are taken from the folder of the INI file if such a file is there, else from the working
 * directory. A file has 1 MiB at most. faults may be NULL. */
Status settings_read(Settings *s, const char *path, FILE *faults, int *n_faults, Err *err);

/* Before a message that begins with a key which that file sets, or with a file or folder that a key of it names:
 * "FILE:LINE:COLUMN: KEY: ". is_given: keys that something else has set since. */
typedef int (*SettingGivenFn)(const void *user, const char *key);
void settings_place(const char *path, SettingGivenFn is_given, const void *user, Err *err);

/* Reads the settings of a saved run from text in memory. `path` names it in messages and is
 * where relative paths begin. */
Status settings_parse(Settings *s, const char *path, const char *text, Err *err);

/* When a run is resumed, a limit may be changed on request; a free setting changes no result (files are told apart by
 * their content). An output is a path that is written: it stays as it is. A first study touches the basic ones. */
typedef enum { SETTING_LIMIT = 1, SETTING_FREE = 2, SETTING_OUTPUT = 4, SETTING_BASIC = 8 } SettingFlags;

/* Calls `differs` for every setting that is not the same in both, in the order of the table, values as text. */
typedef void (*SettingsDiffFn)(const char *key, unsigned flags, const char *was, const char *is, void *user);
void settings_compare(const Settings *was, const Settings *is, SettingsDiffFn differs, void *user);

/* Calls `take` for every setting, in the order of the table: that of a key, or those that have the word in key or
 * meaning; NULL: all. */
typedef void (*SettingFn)(const char *key, const char *value, void *user);
void settings_each(const Settings *s, const char *word, SettingFn take, void *user);

/* Calls take for every file or folder that a setting reads, one by one. */
void settings_each_path(const Settings *s, SettingFn take, void *user);

Status settings_put(Settings *s, const char *key, const char *value, Err *err);

/* A file, an option or a call has said it, be it the default. */
int settings_gives(const Settings *s, const char *key);

/* "section.key=value" as given to --set. */
Status settings_set(Settings *s, const char *assignment, Err *err);

/* Every setting that names a file that is there: as its absolute path, so that it can be looked up from anywhere. */
void settings_make_absolute(Settings *s);

/* Makes paths relative to a folder (as realpath names it), except absolute ones, for a file in that folder. */
void settings_make_relative(Settings *s, char *folder);

/* search.fidelity is not off, and there is what it can screen: replicates that are none of noisy evaluations, or
 * levels. */
int settings_screens(const Settings *s);

/* The rules that tie settings together. */
Status settings_check(const Settings *s, Err *err);

/* The table itself, line by line. */
const char *settings_key(int i);   /* "section.key"; NULL behind the last */
const char *settings_words(int i); /* "a|b|c": of a choice its words, of a path the names that are no file; or NULL */

/* A valid INI file; described: each key after its meaning, unit and range; basic: those alone that a first study
 * touches and those that are no default. word as above. */
typedef enum { SETTINGS_PLAIN, SETTINGS_DESCRIBED, SETTINGS_BASIC } SettingsForm;
void settings_write(const Settings *s, FILE *out, SettingsForm form, const char *word);

/* The plain form as text, to be freed; NULL: no memory. */
char *settings_text(const Settings *s);
