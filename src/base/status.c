#include "base/status.h"

#include <errno.h>
#include <limits.h>
#include <stdarg.h>
#include <unistd.h>

#include "base/text.h"
#include "base/visible.h"

/* The sentence without invisible characters, which ends with dots where it was cut. */
static Status say(Err *err, Status code, ErrSub sub, const char *format, va_list args)
{
    static const char DOTS[] = "...";
    char raw[sizeof err->text]; /* may quote any bytes of a file */
    if (!err)
        return code;
    const int is_cut = vsnprintf(raw, sizeof raw, format, args) >= (int)sizeof raw;
    err->code = code;
    err->sub = sub;
    const int is_whole = visible_text(err->text, sizeof err->text, raw);
    if (is_cut || !is_whole)
        memcpy(err->text + visible_cut(err->text, sizeof err->text - sizeof DOTS), DOTS, sizeof DOTS);
    return code;
}

Status fail(Err *err, Status code, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    say(err, code, SUB_NONE, format, args);
    va_end(args);
    return code;
}

Status fail_sub(Err *err, Status code, ErrSub sub, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    say(err, code, sub, format, args);
    va_end(args);
    return code;
}

Status fail_memory(Err *err, size_t n, const char *what)
{
    return n == 1 ? fail(err, STATUS_NO_MEMORY, "no memory for %s", what)
                  : fail(err, STATUS_NO_MEMORY, "no memory for %zu %s", n, what);
}

Status status_of_errno(int why, Status otherwise)
{
    return why == ENOMEM ? STATUS_NO_MEMORY : otherwise;
}

Status fail_missing(Err *err, const char *path)
{
    const int why = errno;
    const char *slash = strrchr(path, '/');
    char folder[PATH_MAX];
    snprintf(folder, sizeof folder, "%.*s", slash ? (int)(slash - path) : 0, path);
    if (why == ENOENT && folder[0] && access(folder, F_OK) != 0)
        return fail(err, STATUS_MISSING, "%s: there is no folder %s", path, folder);
    return fail(err, status_of_errno(why, STATUS_MISSING), "%s: %s", path,
                why == ENOENT ? "there is no such file or folder" : strerror(why));
}

Status fail_errno(Err *err, const char *path, const char *what)
{
    return fail(err, status_of_errno(errno, STATUS_IO), "%s: %s: %s", path, what, strerror(errno));
}

static const struct {
    int exit_code;
    const char *words;
} LIST[] = {
#define X(name, exit_code, words) {exit_code, words},
    STATUS_LIST(X)
#undef X
};

const char *status_words(Status code)
{
    return LIST[code].words;
}

int status_exit_code(Status code)
{
    return LIST[code].exit_code;
}

/* Levenshtein distance over at most 63 characters of each word, one row at a time. */
static int edit_distance(const char *a, const char *b)
{
    enum { MOST = 63 };
    int row[MOST + 1];
    const int n = (int)strnlen(b, MOST);
    for (int j = 0; j <= n; j++)
        row[j] = j;
    for (int i = 0; i < MOST && a[i]; i++) {
        int diagonal = row[0]++;
        for (int j = 0; j < n; j++) {
            const int replaced = diagonal + (a[i] != b[j]);
            diagonal = row[j + 1];
            row[j + 1] = MIN_OF(replaced, MIN_OF(diagonal, row[j]) + 1);
        }
    }
    return row[n];
}

enum { BEGINNING_MIN = 2 }; /* characters that a beginning has to have */

const char *nearest_word(const char *word, const char *const list[], int n)
{
    const char *nearest = NULL;
    const size_t length = strlen(word);
    int least = 2 + (int)length / 3;
    for (int i = 0; i < n && length >= BEGINNING_MIN; i++)
        if (strncmp(word, list[i], length) == 0 && (!nearest || strlen(list[i]) < strlen(nearest))) {
            nearest = list[i];
            least = 0;
        }
    for (int i = 0; i < n; i++) { /* words differ by no less than their lengths */
        const int apart = abs((int)strlen(list[i]) - (int)length),
                  d = apart < least ? edit_distance(word, list[i]) : apart;
        if (d < least) {
            least = d;
            nearest = list[i];
        }
    }
    return nearest;
}

Status fail_no_word(Err *err, Status code, const char *where, const char *word, const char *noun,
                    const char *const list[], int n)
{
    char all[400] = "";
    const char *near = nearest_word(word, list, n);
    if (near)
        return fail(err, code, "%s: %.60s is no %s; did you mean %s?", where, word, noun, near);
    for (int i = 0; i < n && strlen(all) + strlen(list[i]) + 3 < sizeof all; i++)
        text_join(all, sizeof all, ", ", "%s", list[i]);
    return fail(err, code, "%s: %.40s is no %s; there are %s", where, word, noun, all);
}
