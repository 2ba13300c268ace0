/* What programs of others read: every key of every --json and every column of every CSV stands in tests/frozen.txt. A
 * key that changes needs a line in CHANGELOG.md; `FREEZE=FILE build/release/tests/all frozen` writes the list anew.
 *
 * A line `= ARGUMENTS` of the list is a command. A line ` PATH ...: KEY ...` below it are objects of its JSON (of a list
 * [], of a member .NAME) and their keys, one of ` NAME.csv: COLUMN,...` the first row of a file. @ is the test's folder. */
#include "program.h"

#include "evaluate/measures.h"

enum { PATHS_MAX = 400, KEYS_MAX = 6000 };

typedef struct {
    char path[200], keys[KEYS_MAX];
} Object;

typedef struct {
    size_t n;
    Object at[PATHS_MAX];
} Objects;

/* Settings and variables are many and in lists of their own: of keys with a point the section alone counts. */
static void add_key(Object *o, const char *key)
{
    FREED char *word = formatted(" %.*s", (int)strcspn(key, "."), key);
    for (const char *at = o->keys; (at = strstr(at, word)); at++)
        if (at[strlen(word)] == ' ' || !at[strlen(word)])
            return;
    assert_less(strlen(o->keys) + strlen(word), KEYS_MAX);
    strcat(o->keys, word);
}

static Object *object_at(Objects *all, const char *path)
{
    size_t i = 0;
    while (i < all->n && strcmp(all->at[i].path, path) != 0)
        i++;
    assert_less(i, PATHS_MAX);
    if (i == all->n)
        snprintf(all->at[all->n++].path, sizeof all->at[i].path, "%s", path);
    return &all->at[i];
}

/* Below the names of results stand objects that are alike. */
static int is_result(const char *key)
{
    for (int k = 0; k < MEASURES_LISTED; k++)
        if (strcmp(measure(k)->name, key) == 0)
            return 1;
    return 0;
}

static void walk(Objects *all, const char *path, json_t *value)
{
    char below[200];
    const char *key;
    size_t i;
    json_t *part;
    Object *o = json_is_object(value) ? object_at(all, path) : NULL;
    json_object_foreach(value, key, part)
    {
        add_key(o, key);
        snprintf(below, sizeof below, "%.150s.%.40s", path, is_result(key) ? "RESULT" : key);
        walk(all, below, part);
    }
    snprintf(below, sizeof below, "%.190s[]", path);
    json_array_foreach(value, i, part) walk(all, below, part);
}

/* One line for object i and those behind it that have the same keys, which are then done. */
static void write_alike(FILE *list, Objects *all, size_t i)
{
    char keys[KEYS_MAX];
    snprintf(keys, sizeof keys, "%s", all->at[i].keys);
    for (size_t k = i; k < all->n && keys[0]; k++)
        if (strcmp(all->at[k].keys, keys) == 0) {
            fprintf(list, " %s", *all->at[k].path ? all->at[k].path : ".");
            all->at[k].keys[0] = 0;
        }
    if (keys[0])
        fprintf(list, ":%s\n", keys);
}

/* Below a command: what its output is, then the CSV files that it wrote. */
static void write_kinds(FILE *list, const char *arguments, const char *out)
{
    FREED Objects *all = calloc(1, sizeof *all);
    json_auto_t *json = json_loads(out, 0, NULL);
    if (json)
        walk(all, "", json);
    for (size_t i = 0; i < all->n; i++)
        write_alike(list, all, i);
    if (!json && strstr(arguments, "--csv -"))
        fprintf(list, " -: %.*s\n", (int)strcspn(out, "\n"), out);
    for (const char *at = arguments; (at = strstr(at, "@/")); at++) {
        FREED char *name = formatted("%.*s", (int)strcspn(at + 2, " "), at + 2), *path = in_place(name);
        if (strstr(name, ".csv") && !strstr(name, "given") && access(path, R_OK) == 0) {
            FREED char *text = text_of(path);
            fprintf(list, " %s: %.*s\n", name, (int)strcspn(text, "\n"), text);
        }
    }
}

/* What simulations are measured by, in their order, is long and stands in many places. */
static char *shortened(const char *list)
{
    char every[2][2048] = {"", ""}, *out = NULL;
    size_t length;
    FILE *f = open_memstream(&out, &length);
    for (int k = 0; k < MEASURES_LISTED; k++) {
        const char *name = measure(k)->name;
        snprintf(every[0] + strlen(every[0]), 60, "%s%s", k ? " " : "", name);
        snprintf(every[1] + strlen(every[1]), 60, "%s%s", k ? "," : "", name);
    }
    fprintf(f, "MEASURES: %s\n", every[0]);
    while (*list) {
        const int is_every =
            strncmp(list, every[0], strlen(every[0])) == 0 || strncmp(list, every[1], strlen(every[1])) == 0;
        fputs(is_every ? "MEASURES" : (char[]){*list, 0}, f);
        list += is_every ? strlen(every[0]) : 1;
    }
    fclose(f);
    return out;
}

TEST(keys_of_json_and_columns_of_csv_are_those_of_the_list)
{
    char *wanted = text_of("tests/frozen.txt"), *now = NULL, *rest = NULL;
    size_t length;
    FILE *list = open_memstream(&now, &length);
    FREED char *copy = strdup(wanted);
    write_in_place(
        "given.ini", SIX_FLOORS_INI
        "[design]\nvariables = gaps, thickness, links\n[sim]\nduration_s = 12\nforces = yes\n[search]\nmax_evals = 40\n"
        "limits = drift_ratio<=0.05\nthreads = 1\n");
    write_in_place("given_hazard.csv", "sa_g,rate_per_year\n0.01,0.1\n0.1,0.01\n1,0.0001\n");
    for (char *line = strtok_r(copy, "\n", &rest); line; line = strtok_r(NULL, "\n", &rest)) {
        if (line[0] == '#')
            fprintf(list, "%s\n", line);
        if (line[0] != '=')
            continue;
        FREED char *out = output_of("%s", line + 2);
        fprintf(list, "%s\n", line);
        write_kinds(list, line, out);
    }
    fclose(list);
    char *all = shortened(now);
    free(now);
    now = all;
    if (getenv("FREEZE"))
        write_to(getenv("FREEZE"), now);
    assert_string_equal(now, wanted);
    free(now);
    free(wanted);
}

SUITE(make_place, clear_place)
