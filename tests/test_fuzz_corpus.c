/* The inputs that the fuzzers found worth keeping, each read once: no crash, hang or leak (a sanitized build
 * tells). */
#include "check.h"

#include <dirent.h>
#include <limits.h>

#include "base/csv.h"
#include "fuzz/targets.h"

enum { LONGEST_S = 10 };

static void replay_file(const char *path, void (*target)(const uint8_t *, size_t))
{
    FREED char *text;
    size_t length;
    CHECK_OK(file_read(path, FILE_LARGEST, &text, &length, &err), &err);
    FREED uint8_t *exact = malloc(length ? length : 1); /* so that reading one byte too far is noticed */
    assert_non_null(exact);
    memcpy(exact, text, length);
    alarm(LONGEST_S);
    target(exact, length);
    alarm(0);
}

static void replay(const char *name, void (*target)(const uint8_t *, size_t))
{
    int n = 0;
    FREED char *folder = formatted("tests/fuzz/corpus/%s", name);
    DIR *d = opendir(folder);
    assert_non_null(d);
    for (const struct dirent *e; (e = readdir(d));) {
        if (e->d_name[0] == '.')
            continue;
        replay_file(brief("%s/%s", folder, e->d_name), target);
        n++;
    }
    closedir(d);
    assert_at_most(10, n);
}

#define X(name)                                                                                                        \
    TEST(the_corpus_of_##name##_does_no_harm)                                                                          \
    {                                                                                                                  \
        replay(#name, fuzz_##name);                                                                                    \
    }
FUZZ_LIST(X)
#undef X

SUITE(NULL, NULL)
