#include "motion/suite.h"

#include <dirent.h>
#include <errno.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/list.h"
#include "base/text.h"
#include "motion/builtin.h"
#include "motion/synthetic.h"

/* -- a source ------------------------------------------------------------------------------------------------------ */

enum { CHANNEL, FACTOR, RATE, N_WORDS };
static const char *const WORDS[N_WORDS] = {[CHANNEL] = " channel=", [FACTOR] = " factor=", [RATE] = " rate="};
#define NO_WORD "%.*s: '%s' is neither channel=NAME, factor=NUMBER nor rate=NUMBER"

size_t source_path_length(const char *text)
{
    size_t n = strlen(text);
    for (int k = 0; k < N_WORDS; k++) {
        const char *at = strstr(text, WORDS[k]);
        n = at ? MIN_OF(n, (size_t)(at - text)) : n;
    }
    while (n > 1 && text[n - 1] == ' ')
        n--;
    return n;
}

Status source_read(const char *text, Source *out, Err *err)
{
    const size_t length = source_path_length(text);
    char words[OPTION_TEXT_MAX], *rest = words, *end = words;
    unsigned seen = 0;
    *out = (Source){.factor = 1};
    snprintf(out->path, sizeof out->path, "%.*s", (int)length, text);
    const char *last = strrchr(out->path, ' '); /* of a path that is there, or of a misspelt word behind one */
    if (last && strchr(last, '=') && access(out->path, F_OK) != 0)
        return bad_data(err, NO_WORD, (int)(last - out->path), out->path, last + 1);
    text_copy(words, text + length);
    for (char *word; (word = strsep(&rest, " \t"));) {
        int k = 0;
        while (k < N_WORDS && strncmp(word, WORDS[k] + 1, strlen(WORDS[k]) - 1) != 0)
            k++;
        const char *value = strchr(word, '=');
        if (!*word)
            continue;
        if (k == N_WORDS || !value[1])
            return bad_data(err, NO_WORD, (int)length, text, word);
        if (seen >> k & 1)
            return bad_data(err, "%s: '%s': give it once", out->path, word);
        seen |= 1U << k;
        if (k == CHANNEL) {
            text_copy(out->channel, value + 1);
            continue;
        }
        const double number = *(k == FACTOR ? &out->factor : &out->rate) = strtod(value + 1, &end);
        if (*end || !(number > 0 && isfinite(number)))
            return bad_data(err, "%s: '%s': a %s is a number above 0", out->path, word,
                            k == FACTOR ? "factor" : "rate of events in a year");
    }
    return STATUS_OK;
}

/* -- a suite ------------------------------------------------------------------------------------------------------- */

static int by_name(const struct dirent **a, const struct dirent **b)
{
    return strcmp((*a)->d_name, (*b)->d_name); /* the same order in every language */
}

static int is_folder(const char *path)
{
    struct stat there;
    return stat(path, &there) == 0 && S_ISDIR(there.st_mode);
}

/* name in the folder of the first n characters of `path`, unless it leads from the root. */
static Status put_inside(char out[OPTION_TEXT_MAX], const char *path, size_t n, const char *name, Err *err)
{
    const int is_whole = name[0] == '/' || builtin_name(name) || n == 0;
    if (snprintf(out, OPTION_TEXT_MAX, "%.*s%s%s", is_whole ? 0 : (int)n, path, is_whole ? "" : "/", name) >=
        OPTION_TEXT_MAX)
        return bad_data(err, "%s: the path of %s is too long", path, name);
    return STATUS_OK;
}

/* Hands over the files of a folder in the order of their names. */
static Status each_of_folder(const char *folder, SourceFn take, void *user, Err *err)
{
    struct dirent **names = NULL;
    char path[OPTION_TEXT_MAX];
    size_t length = strlen(folder), n_files = 0;
    Status status = STATUS_OK;
    const int n = scandir(folder, &names, NULL, by_name);
    if (n < 0)
        return fail_missing(err, folder);
    while (length > 1 && folder[length - 1] == '/')
        length--;
    for (int i = 0; i < n; i++) {
        const int is_hidden = names[i]->d_name[0] == '.';
        if (!is_hidden)
            THEN(status, put_inside(path, folder, length, names[i]->d_name, err));
        if (status == STATUS_OK && !is_hidden && !is_folder(path)) {
            n_files++;
            status = take(path, user, err);
        }
        free(names[i]);
    }
    free(names);
    return status == STATUS_OK && n_files == 0 ? bad_data(err, "%s: is empty", folder) : status;
}

/* Hands over the sources of a list; what is wrong with one is said with its line. */
static Status each_of_list(const char *path, SourceFn take, void *user, Err *err)
{
    char line[OPTION_TEXT_MAX], source[OPTION_TEXT_MAX];
    const char *slash = strrchr(path, '/');
    FILE *f = fopen(path, "r");
    size_t n = 0;
    Status status = STATUS_OK;
    if (!f)
        return fail_missing(err, path);
    for (int at = 1; status == STATUS_OK && fgets(line, sizeof line, f); at++) {
        Source s;
        Err why = {0};
        if (!strchr(line, '\n') && !feof(f))
            status = bad_data(err, "%s:%d: is longer than %d characters", path, at, OPTION_TEXT_MAX - 2);
        size_t length = strcspn(line, "#\r\n");
        while (length > 0 && strchr(" \t", line[length - 1]))
            length--;
        line[length] = 0;
        const char *begin = line + strspn(line, " \t");
        if (status != STATUS_OK || !*begin)
            continue;
        n++;
        status = put_inside(source, path, slash ? slash - path : 0, begin, &why);
        THEN(status, source_read(source, &s, &why));
        THEN(status, take(source, user, &why));
        if (status != STATUS_OK)
            fail(err, status, "%s:%d: %.300s", path, at, why.text);
    }
    fclose(f);
    return status == STATUS_OK && n == 0 ? bad_data(err, "%s: names no record", path) : status;
}

static int is_list(const char *path)
{
    return text_ends(path, "list.txt");
}

Status suite_each(const char *item, SourceFn take, void *user, Err *err)
{
    char source[OPTION_TEXT_MAX];
    if (is_list(item) || is_folder(item))
        return (is_list(item) ? each_of_list : each_of_folder)(item, take, user, err);
    if (strcmp(item, SUITE_SOURCE) != 0)
        return take(item, user, err); /* who reads it says what is not there */
    for (int i = 1; i <= SUITE_MOTIONS; i++) {
        snprintf(source, sizeof source, SUITE_SOURCE "-%02d", i);
        TRY(take(source, user, err));
    }
    return STATUS_OK;
}

/* -- a study ------------------------------------------------------------------------------------------------------- */

typedef struct {
    const char *first;
    SourceFn *take;
    void *user;
} Others;

/* Leaves out the first record: the same file, however its path is written, with the same words behind it. */
static Status hand_over_other(const char *source, void *user, Err *err)
{
    const Others *o = user;
    const char *a = source, *b = o->first;
    struct stat s, t;
    Source of_a, of_b;
    const int is_same = strcmp(a, b) == 0 || (strcmp(a + source_path_length(a), b + source_path_length(b)) == 0 &&
                                              source_read(a, &of_a, NULL) == STATUS_OK &&
                                              source_read(b, &of_b, NULL) == STATUS_OK && stat(of_a.path, &s) == 0 &&
                                              stat(of_b.path, &t) == 0 && s.st_dev == t.st_dev && s.st_ino == t.st_ino);
    return is_same ? STATUS_OK : o->take(source, o->user, err);
}

Status suite_of_study(const MotionOptions *o, SourceFn take, void *user, Err *err)
{
    char item[OPTION_TEXT_MAX];
    const size_t n = list_is_given(o->records) ? list_count(o->records) : 0;
    TRY(take(o->record, user, err));
    for (size_t i = 0; i < n; i++) {
        if (!list_item(o->records, i, item, sizeof item))
            return bad_data(err, "motion.records: item %zu is empty or too long", i + 1);
        TRY(strcmp(item, SUITE_SOURCE) == 0 || is_list(item) || is_folder(item)
                ? suite_each(item, hand_over_other, &(Others){o->record, take, user}, err)
                : take(item, user, err));
    }
    return STATUS_OK;
}

static Status count(const char *source, void *user, Err *err)
{
    (void)source;
    (void)err;
    ++*(size_t *)user;
    return STATUS_OK;
}

Status suite_size(const MotionOptions *o, size_t *n, Err *err)
{
    *n = 0;
    return suite_of_study(o, count, n, err);
}

size_t suite_count(const MotionOptions *o)
{
    size_t n;
    return suite_size(o, &n, NULL) == STATUS_OK ? n : 1;
}
