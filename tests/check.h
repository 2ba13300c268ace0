/* tests/check.h -- comparisons that cmocka leaves to us. */
#pragma once

#include "base/status.h" /* before cmocka.h, which defines a macro fail() */
#include "base/clock.h"
#include "base/linalg.h"
#include "base/random.h"
#include "base/stat.h"
#include "base/units.h"
#include "settings/settings.h"

#include <math.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>
#include <cmocka.h>

/* The sanitized pass looks for faults of memory and arithmetic: where a test repeats the same code for accuracy's sake, it
 * does so less often there. */
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define SANITIZED 1
#else
#define SANITIZED 0
#endif

/* The textbook problems as an external simulator (bench/textbook.h), of the same mode as the test. */
#ifndef BUILD_FOLDER
#define BUILD_FOLDER "build/release"
#endif
#define TEXTBOOK_WORKER BUILD_FOLDER "/textbook"

/* What the calls of a test say of their faults; it begins empty. */
static Err err __attribute__((unused));

/* What a block of a test owns is released where the block ends, the last first; after a failed assertion it is not.
 * OWNED(run_free) Run run = run_in("a"); FREED char *text = text_of(path); for JSON there is json_auto_t of jansson. */
#define OWNED(release) __attribute__((cleanup(release)))
#define FREED          OWNED(free_pointed)
static inline void free_pointed(void *pointer)
{
    void *block;
    memcpy(&block, pointer, sizeof block);
    free(block);
}

/* FOR_EACH(const char *, word, "a", "b") ... *word ...: the statement for every one of the values. */
#define ARRAY_OF(type, ...) ((const __typeof__(type)[]){__VA_ARGS__})
#define COUNT_OF(type, ...) (sizeof ARRAY_OF(type, __VA_ARGS__) / sizeof(type))
#define FOR_EACH(type, at, ...)                                                                                        \
    for (const __typeof__(type) *at = ARRAY_OF(type, __VA_ARGS__), *at##_end = at + COUNT_OF(type, __VA_ARGS__);       \
         at < at##_end; at++)

/* What the format makes; to be freed. */
__attribute__((format(printf, 1, 2))) static inline char *formatted(const char *format, ...)
{
    char *text = NULL;
    va_list list;
    va_start(list, format);
    if (vasprintf(&text, format, list) < 0)
        abort();
    va_end(list);
    return text;
}

/* The same, kept until sixteen others were made. */
__attribute__((format(printf, 1, 2))) static inline char *brief(const char *format, ...)
{
    enum { KEPT = 16, TEXT_MAX = 16384 };
    static char kept[KEPT][TEXT_MAX];
    static size_t next;
    va_list list;
    va_start(list, format);
    char *text = kept[next++ % KEPT];
    if (vsnprintf(text, TEXT_MAX, format, list) >= TEXT_MAX)
        abort();
    va_end(list);
    return text;
}

/* A test puts itself on the list of its file, in the order in which they stand: TEST(what_is_so) { ... } */
enum { TESTS_MAX = 128 };
static struct CMUnitTest all_tests[TESTS_MAX] __attribute__((unused));
static size_t n_tests __attribute__((unused));
#define TEST(name)                                                                                                     \
    static void body_##name(void **state);                                                                             \
    static void test_##name(void **state)                                                                              \
    {                                                                                                                  \
        err = (Err){0};                                                                                                \
        body_##name(state);                                                                                            \
    }                                                                                                                  \
    __attribute__((constructor(200 + __LINE__))) static void add_##name(void)                                          \
    {                                                                                                                  \
        if (n_tests == TESTS_MAX)                                                                                      \
            abort(); /* too many in one file */                                                                        \
        all_tests[n_tests++] = (struct CMUnitTest){"test_" #name, test_##name, NULL, NULL, NULL};                      \
    }                                                                                                                  \
    static void body_##name(__attribute__((unused)) void **state)

/* The tests of one file, tests/test_NAME.c. Every file ends with SUITE(set up, tear down); tests/main.c, with which
 * files are linked into one program, runs those that it is asked for. */
typedef struct Suite Suite;
struct Suite {
    const char *file;
    struct CMUnitTest *tests;
    size_t *n;
    CMFixtureFunction set_up, tear_down; /* once for all tests of the file; NULL: nothing to do */
    CMFixtureFunction before_each;
    Suite *next;
};
void suite_add(Suite *suite);
#define SUITE_OF(...)                                                                                                  \
    __attribute__((constructor)) static void add_suite(void)                                                           \
    {                                                                                                                  \
        static Suite suite = {__FILE__, all_tests, &n_tests, __VA_ARGS__, NULL};                                       \
        suite_add(&suite);                                                                                             \
    }
#define SUITE(set_up, tear_down) SUITE_OF(set_up, tear_down, NULL)
#define SUITE_EACH(before_each)  SUITE_OF(NULL, NULL, before_each)

/* |actual - wanted| <= tolerance |wanted|; NaN fails. */
static inline void check_close(double actual, double wanted, double tolerance, const char *what, const char *file,
                               int line)
{
    if (!(fabs(actual - wanted) <= tolerance * fabs(wanted))) {
        print_error("%s is %.17g, wanted %.17g within %g\n", what, actual, wanted, tolerance);
        _fail(file, line);
    }
}
#define assert_close(actual, wanted, relative_tolerance)                                                               \
    check_close(actual, wanted, relative_tolerance, #actual, __FILE__, __LINE__)

/* assert_close of these members of both, at most eight. */
#define CLOSE_1(a, b, t, m)                                  assert_close((a).m, (b).m, t)
#define CLOSE_2(a, b, t, m, ...)                             (CLOSE_1(a, b, t, m), CLOSE_1(a, b, t, __VA_ARGS__))
#define CLOSE_3(a, b, t, m, ...)                             (CLOSE_1(a, b, t, m), CLOSE_2(a, b, t, __VA_ARGS__))
#define CLOSE_4(a, b, t, m, ...)                             (CLOSE_1(a, b, t, m), CLOSE_3(a, b, t, __VA_ARGS__))
#define CLOSE_5(a, b, t, m, ...)                             (CLOSE_1(a, b, t, m), CLOSE_4(a, b, t, __VA_ARGS__))
#define CLOSE_6(a, b, t, m, ...)                             (CLOSE_1(a, b, t, m), CLOSE_5(a, b, t, __VA_ARGS__))
#define CLOSE_7(a, b, t, m, ...)                             (CLOSE_1(a, b, t, m), CLOSE_6(a, b, t, __VA_ARGS__))
#define CLOSE_8(a, b, t, m, ...)                             (CLOSE_1(a, b, t, m), CLOSE_7(a, b, t, __VA_ARGS__))
#define CLOSE_OF(m1, m2, m3, m4, m5, m6, m7, m8, which, ...) which
#define assert_close_in(a, b, tolerance, ...)                                                                          \
    CLOSE_OF(__VA_ARGS__, CLOSE_8, CLOSE_7, CLOSE_6, CLOSE_5, CLOSE_4, CLOSE_3, CLOSE_2, CLOSE_1, 0)                   \
    (a, b, tolerance, __VA_ARGS__)

/* Comparisons of any two numbers, whose values are printed where they fail; the operands are then evaluated again. */
static inline void comparison_failed(const char *what, double left, double right, const char *file, int line)
{
    print_error("%s is not true: %.17g and %.17g\n", what, left, right);
    _fail(file, line);
}
#define CHECK_COMPARISON(left, operator, right)                                                                        \
    do {                                                                                                               \
        if (!((left) operator(right)))                                                                                 \
            comparison_failed(#left " " #operator" " #right, (double)(left), (double)(right), __FILE__, __LINE__);     \
    } while (0)
#define assert_less(left, right)        CHECK_COMPARISON(left, <, right)
#define assert_at_most(left, right)     CHECK_COMPARISON(left, <=, right)
#define assert_same_number(left, right) CHECK_COMPARISON(left, ==, right)

/* Each of the words stands in the text; those behind a ! do not. */
static inline void check_says(const char *text, const char *const words[], const char *file, int line)
{
    for (; *words; words++)
        if ((strstr(text, *words + (**words == '!')) != NULL) == (**words == '!')) {
            print_error("wanted '%s' in: %.2000s\n", *words, text);
            _fail(file, line);
        }
}
#define assert_words(text, ...) check_says(text, (const char *const[]){__VA_ARGS__, NULL}, __FILE__, __LINE__)

/* The same of a text that is released then. */
static inline void check_made(char *text, const char *const words[], const char *file, int line)
{
    check_says(text, words, file, line);
    free(text);
}
#define assert_words_in(text, ...) check_made(text, (const char *const[]){__VA_ARGS__, NULL}, __FILE__, __LINE__)
#define assert_text(text, wanted)                                                                                      \
    do {                                                                                                               \
        FREED char *made = text;                                                                                       \
        assert_string_equal(made, wanted);                                                                             \
    } while (0)

/* A call that fills err ends with the status, and err has the words. */
static inline void check_refused(Status status, Status wanted, const char *words, const char *file, int line)
{
    if (status != wanted || !strstr(err.text, words)) {
        print_error("%s (wanted %s): '%s'\n  wanted: '%s'\n", status_words(status), status_words(wanted), err.text,
                    words);
        _fail(file, line);
    }
}
#define assert_refused(call, status, words)                                                                            \
    do {                                                                                                               \
        err = (Err){0};                                                                                                \
        check_refused(call, status, words, __FILE__, __LINE__);                                                        \
    } while (0)

static inline void rest(double seconds)
{
    nanosleep(&(struct timespec){(time_t)seconds, (long)(1e9 * fmod(seconds, 1))}, NULL);
}

static inline void check_ok(Status status, const Err *why, const char *what, const char *file, int line)
{
    if (status != STATUS_OK) {
        print_error("%s: %s: %s\n", what, status_words(status), why->text);
        _fail(file, line);
    }
}
#define CHECK_OK(status, why) check_ok(status, why, #status, __FILE__, __LINE__)

/* The test is skipped where this file, of ../shared mostly, is not there. */
static inline void need_file(const char *path)
{
    if (access(path, R_OK) == 0)
        return;
    print_message("skipped: %s is not there\n", path);
    skip();
}

static inline Settings default_settings(void)
{
    Settings s;
    settings_defaults(&s);
    return s;
}

/* The format's words behind those of an array. */
#define append(text, ...) snprintf((text) + strlen(text), sizeof(text) - strlen(text), __VA_ARGS__)

static inline FILE *opened(const char *path, const char *mode)
{
    FILE *f = fopen(path, mode);
    if (!f)
        fail_msg("%s: cannot be opened", path);
    return f;
}

static inline void write_to(const char *path, const char *text)
{
    FILE *f = opened(path, "w");
    assert_at_most(0, fputs(text, f));
    assert_int_equal(fclose(f), 0);
}

/* The command of a shell succeeds. */
__attribute__((format(printf, 1, 2))) static inline void expect_shell(const char *format, ...)
{
    FREED char *command = NULL;
    va_list list;
    va_start(list, format);
    if (vasprintf(&command, format, list) < 0 || system(command) != 0)
        fail_msg("%s", command);
    va_end(list);
}
