/* Numbers as text and back, against printf and strtod, which are right to the last bit. */
#include "check.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/number.h"
#include "base/random.h"

enum { N = SANITIZED ? 20000 : 300000 };

static void by_printf(double value, char text[NUMBER_TEXT_MAX])
{
    for (int digits = 15; digits <= 17; digits++) {
        snprintf(text, NUMBER_TEXT_MAX, "%.*g", digits, value);
        if (strtod(text, NULL) == value)
            return;
    }
}

static uint64_t bits_of(double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

static void check_read(const char *text)
{
    char *end;
    const char *found;
    const double wanted = strtod(text, &end), value = number_read(text, &found);
    if (found != end || bits_of(value) != bits_of(wanted))
        fail_msg("'%s' is read as %.17g up to '%s', wanted %.17g up to '%s'", text, value, found, wanted, end);
}

static void check_number(double value)
{
    char text[NUMBER_TEXT_MAX] = "", wanted[NUMBER_TEXT_MAX];
    const size_t length = number_text(value, text);
    by_printf(value, wanted);
    if (length != strlen(text) || strcmp(text, wanted) != 0)
        fail_msg("%a is written '%s', wanted '%s'", value, text, wanted);
    check_read(text);
}

static void check_both(double value)
{
    check_number(value);
    check_number(-value);
}

static void test_numbers_of_any_size_are_those_of_printf_and_strtod(void **state)
{
    (void)state;
    Random r = random_stream(1, RANDOM_TEST, 0, 0);
    for (int i = 0; i < N; i++) {
        check_both(random_uniform(&r));
        check_both(ldexp(0.5 + 0.5 * random_uniform(&r), (int)random_below(&r, 100) - 45));
        check_both(ldexp(1.0 + random_uniform(&r), (int)random_below(&r, 2000) - 1000));
    }
}

/* Of few digits, so that 15 do, and of so many that they just do not. */
static void test_decimal_numbers_come_out_as_they_went_in(void **state)
{
    (void)state;
    Random r = random_stream(2, RANDOM_TEST, 0, 0);
    for (int i = 0; i < N; i++) {
        char text[64];
        const int digits = 1 + (int)random_below(&r, 18), exponent = (int)random_below(&r, 40) - 20;
        snprintf(text, sizeof text, "%.*e", digits, random_uniform(&r) * pow(10.0, exponent));
        check_read(text);
        check_both(strtod(text, NULL));
        snprintf(text, sizeof text, "%.*f", digits, 1000.0 * random_uniform(&r));
        check_read(text);
        check_both(strtod(text, NULL));
    }
}

/* Where the neighbours are nearer below than above, where rounding carries, where a digit more begins, halves. */
static void test_powers_and_their_neighbours_are_right(void **state)
{
    (void)state;
    for (int e = -1074; e < 1024; e++) {
        const double value = ldexp(1.0, e);
        check_both(value);
        check_both(nextafter(value, INFINITY));
        check_both(nextafter(value, 0.0));
    }
    for (int e = -30; e < 30; e++)
        for (int k = 1; k < 100; k++) {
            char text[32];
            snprintf(text, sizeof text, "%de%d", k, e);
            const double value = strtod(text, NULL);
            check_both(value);
            check_both(nextafter(value, INFINITY));
            check_both(nextafter(value, 0.0));
            check_both(value + ldexp(0.5, e));
        }
    for (double value = 0.0; value < 70000.0; value += 0.5)
        check_number(value);
}

static void test_what_is_no_plain_number_is_read_as_by_strtod(void **state)
{
    (void)state;
    static const char *const TEXTS[] = {"",
                                        "-",
                                        ".",
                                        "-.",
                                        "null",
                                        "]",
                                        "0x10",
                                        "0x",
                                        "1.2.3",
                                        "1e5",
                                        "1.5e-05",
                                        "12e-3]",
                                        "1e+15",
                                        "1e-",
                                        "1e-5x",
                                        "1.2345678901234567e-10",
                                        "1e-22",
                                        "3e-23",
                                        "5e-27",
                                        "5e-28",
                                        "1e0005",
                                        "123456e-300",
                                        "1e",
                                        "1e400",
                                        "1e-400",
                                        "-0",
                                        "00012",
                                        ".5",
                                        "5.",
                                        "5.]",
                                        "inf",
                                        "nan",
                                        " 7",
                                        "+7",
                                        "--7",
                                        "18446744073709551615",
                                        "18446744073709551616",
                                        "99999999999999999999999999999999",
                                        "9007199254740993",
                                        "0.9007199254740993",
                                        "900719925474099.3",
                                        "0.00000000000000000000000012345678901234567",
                                        "123456789012345678901234567890.123",
                                        "0.000000000000000000000000000000000000000000000000001",
                                        "0.0000000000000000000000000000000000000"};
    for (size_t i = 0; i < sizeof TEXTS / sizeof *TEXTS; i++)
        check_read(TEXTS[i]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_numbers_of_any_size_are_those_of_printf_and_strtod),
        cmocka_unit_test(test_decimal_numbers_come_out_as_they_went_in),
        cmocka_unit_test(test_powers_and_their_neighbours_are_right),
        cmocka_unit_test(test_what_is_no_plain_number_is_read_as_by_strtod),
    };
    return cmocka_run_group_tests_name("number", tests, NULL, NULL);
}
