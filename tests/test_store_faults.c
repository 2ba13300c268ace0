/* Inside a study, the k-th call of one kind to the database, the files or the allocator fails: the study ends with a
 * reason, and the same settings then go on to the same front. FAULTS=60 in the environment: so many of each kind, else
 * a few. The linker puts the functions below in the place of the real ones (Makefile). */
#include "runs.h"

#include <sqlite3.h>

#include "run/store.h"
#include "run/study.h"

enum { SOME = 6 };

typedef enum { STEP, EXEC, PREPARE, OPEN, CALLOC, MALLOC, REALLOC, MEMSTREAM, FOPEN, FLUSH, RENAME, N_KINDS } Kind;
static const char *const KINDS[N_KINDS] = {"sqlite3_step",    "sqlite3_exec",   "sqlite3_prepare_v2",
                                           "sqlite3_open_v2", "calloc",         "malloc",
                                           "realloc",         "open_memstream", "fopen",
                                           "fflush",          "rename"};

static struct {
    int armed;
    Kind kind;
    long at, n[N_KINDS];
} fault;

static int fails(Kind kind)
{
    if (!fault.armed)
        return 0;
    fault.n[kind]++;
    return kind == fault.kind && fault.n[kind] == fault.at;
}

#define WRAP(type, name, kind, failed, parameters, arguments)                                                          \
    type __real_##name parameters;                                                                                     \
    type __wrap_##name parameters;                                                                                     \
    type __wrap_##name parameters                                                                                      \
    {                                                                                                                  \
        return fails(kind) ? (failed) : __real_##name arguments;                                                       \
    }

WRAP(int, sqlite3_step, STEP, SQLITE_IOERR, (sqlite3_stmt * s), (s))
WRAP(int, sqlite3_exec, EXEC, SQLITE_FULL,
     (sqlite3 * d, const char *sql, int (*f)(void *, int, char **, char **), void *user, char **message),
     (d, sql, f, user, message))
WRAP(int, sqlite3_prepare_v2, PREPARE, SQLITE_NOMEM,
     (sqlite3 * d, const char *sql, int n, sqlite3_stmt **s, const char **tail), (d, sql, n, s, tail))
WRAP(int, sqlite3_open_v2, OPEN, SQLITE_CANTOPEN, (const char *path, sqlite3 **d, int flags, const char *vfs),
     (path, d, flags, vfs))
WRAP(void *, calloc, CALLOC, NULL, (size_t n, size_t size), (n, size))
WRAP(void *, malloc, MALLOC, NULL, (size_t size), (size))
WRAP(void *, realloc, REALLOC, NULL, (void *old, size_t size), (old, size))
WRAP(FILE *, open_memstream, MEMSTREAM, NULL, (char **text, size_t *n), (text, n))
WRAP(FILE *, fopen, FOPEN, NULL, (const char *path, const char *mode), (path, mode))
WRAP(int, fflush, FLUSH, EOF, (FILE * f), (f))
WRAP(int, rename, RENAME, -1, (const char *from, const char *to), (from, to))

static Status study(const Settings *s, Err *err)
{
    StudySummary summary;
    return study_run(s, &(StudyOptions){0}, &summary, NULL, err);
}

static int stop_after(void *left)
{
    return --*(int *)left < 0;
}

/* Every other study has a first half already and goes on from there. */
static void run_half(const Settings *s)
{
    int left = 17;
    Err err = {0};
    StudySummary summary;
    const StudyOptions options = {.stop = stop_after, .user = &left};
    assert_int_equal(study_run(s, &options, &summary, NULL, &err), STATUS_STOPPED);
}

static void fail_once(Kind kind, long at, const char *front)
{
    Err err = {0};
    char command[128];
    snprintf(command, sizeof command, "rm -rf '%s/faulty'", place.folder);
    assert_int_equal(system(command), 0);
    const Settings s = settings_of(TEXTBOOK, "faulty");
    if (at % 2 == 0)
        run_half(&s);
    memset(&fault, 0, sizeof fault);
    fault.kind = kind;
    fault.at = at;
    fault.armed = 1;
    const Status status = study(&s, &err);
    fault.armed = 0;
    if (status != STATUS_OK && !err.text[0])
        fail_msg("%s %ld: fails and says nothing", KINDS[kind], at);
    Err again = {0};
    if (status != STATUS_OK && study(&s, &again) != STATUS_OK)
        fail_msg("%s %ld: '%s', and then '%s'", KINDS[kind], at, err.text, again.text);
    char *now = read_in_place("faulty/front.csv");
    if (strcmp(now, front) != 0)
        fail_msg("%s %ld: another front", KINDS[kind], at);
    free(now);
}

static void test_a_study_whose_kth_call_fails_goes_on_to_the_same_front(void **state)
{
    (void)state;
    Err err = {0};
    const char *wanted = getenv("FAULTS");
    const long most = wanted ? strtol(wanted, NULL, 10) : SOME;
    const Settings s = settings_of(TEXTBOOK, "whole");
    long n[N_KINDS];
    memset(&fault, 0, sizeof fault);
    fault.armed = 1;
    CHECK_OK(study(&s, &err), &err);
    fault.armed = 0;
    memcpy(n, fault.n, sizeof n);
    char *front = read_in_place("whole/front.csv");
    for (Kind kind = 0; kind < N_KINDS; kind++)
        for (long at = 1; at <= n[kind]; at += n[kind] <= most ? 1 : (n[kind] + most - 1) / most)
            fail_once(kind, at, front);
    free(front);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_study_whose_kth_call_fails_goes_on_to_the_same_front),
    };
    return cmocka_run_group_tests(tests, make_place, clear_place);
}
