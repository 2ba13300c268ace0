/* tests/main.c -- the program that the files of tests are linked into.
 *
 *   PROGRAM NAME [LETTERS]     runs tests/test_NAME.c, with LETTERS only the tests that have them in their names
 *
 * Behind cmocka's own lines it prints for every test `[ SECONDS  ] clock processor name`, the processor time with that
 * of the programs that the test has run, and at the end `[ FINISHED ]`: a test that ends the process is no success. Exit
 * status 3: no test has these letters. */
#include "check.h"

#include <sys/resource.h>

static Suite *suites;

void suite_add(Suite *suite)
{
    suite->next = suites;
    suites = suite;
}

static const Suite *find(const char *name)
{
    FREED char *end = formatted("/test_%s.c", name);
    for (const Suite *s = suites; s; s = s->next)
        if (strlen(s->file) > strlen(end) && strcmp(s->file + strlen(s->file) - strlen(end), end) == 0)
            return s;
    return NULL;
}

static double processor_s(void)
{
    double seconds = 0;
    for (int k = 0; k < 2; k++) {
        struct rusage u;
        getrusage(k == 0 ? RUSAGE_SELF : RUSAGE_CHILDREN, &u);
        seconds +=
            (double)(u.ru_utime.tv_sec + u.ru_stime.tv_sec) + 1e-6 * (double)(u.ru_utime.tv_usec + u.ru_stime.tv_usec);
    }
    return seconds;
}

/* The tests that run, in their order; each has a beginning and an end of ours. */
static struct {
    struct CMUnitTest tests[TESTS_MAX];
    CMFixtureFunction before_each, tear_down;
    int tear_down_failed;
    size_t n, now; /* now: one more than the test that runs */
    double clock, processor;
} chosen;

static int begin(void **state)
{
    chosen.now++;
    chosen.clock = clock_seconds();
    chosen.processor = processor_s();
    return chosen.before_each ? chosen.before_each(state) : 0;
}

static int end(void **state)
{
    (void)state;
    print_message("[ SECONDS  ] %.2f %.2f %s\n", clock_seconds() - chosen.clock, processor_s() - chosen.processor,
                  chosen.tests[chosen.now - 1].name);
    return 0;
}

static int tear_down(void **state)
{
    return chosen.tear_down_failed = chosen.tear_down && chosen.tear_down(state) != 0;
}

static void choose(const Suite *suite, const char *words)
{
    chosen.before_each = suite->before_each;
    chosen.tear_down = suite->tear_down;
    for (size_t i = 0; i < *suite->n; i++)
        if (strstr(suite->tests[i].name, words)) {
            chosen.tests[chosen.n] = suite->tests[i];
            chosen.tests[chosen.n].setup_func = begin;
            chosen.tests[chosen.n++].teardown_func = end;
        }
}

int main(int argc, char *argv[])
{
    const Suite *suite = argc > 1 ? find(argv[1]) : NULL;
    if (!suite) {
        fprintf(stderr, "usage: %s NAME [WORDS]; NAME is that of\n", argv[0]);
        for (const Suite *s = suites; s; s = s->next)
            fprintf(stderr, "  %s\n", s->file);
        return 2;
    }
    linalg_pin(); /* as the program does, whose bytes a study in this process must have */
    choose(suite, argc > 2 ? argv[2] : "");
    if (chosen.n == 0) {
        fprintf(stderr, "%s: no test of %s has `%s` in its name\n", argv[0], suite->file, argc > 2 ? argv[2] : "");
        return argc > 2 && argv[2][0] ? 3 : 2;
    }
    const int failed = _cmocka_run_group_tests(argv[1], chosen.tests, chosen.n, suite->set_up, tear_down);
    print_message("[ FINISHED ]\n");
    return failed || chosen.tear_down_failed;
}
