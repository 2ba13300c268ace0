#include "base/number.h"

#include <float.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

__extension__ typedef unsigned __int128 Wide;

/* The largest power of five below 2^64, and the largest power of ten that is a double. */
enum { FIVES_MAX = 27, TENS_MAX = 22 };

static const uint64_t FIVES[FIVES_MAX + 1] = {1,
                                              5,
                                              25,
                                              125,
                                              625,
                                              3125,
                                              15625,
                                              78125,
                                              390625,
                                              1953125,
                                              9765625,
                                              48828125,
                                              244140625,
                                              1220703125,
                                              6103515625,
                                              30517578125,
                                              152587890625,
                                              762939453125,
                                              3814697265625,
                                              19073486328125,
                                              95367431640625,
                                              476837158203125,
                                              2384185791015625,
                                              11920928955078125,
                                              59604644775390625,
                                              298023223876953125,
                                              1490116119384765625,
                                              7450580596923828125};
static const double TENS[TENS_MAX + 1] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                          1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

static const uint64_t TEN_16 = 10000000000000000;

/* -- to text ------------------------------------------------------------------------------------------------------- */

/* The value m 2^e times 10^q is m 5^q / 2^shift. */
typedef struct {
    uint64_t m;
    int e;
} Binary;

static Wide scaled(Binary b, int q)
{
    return (Wide)b.m * FIVES[q];
}

/* Rounded to a whole number, half to even. */
static uint64_t digits_of(Binary b, int q)
{
    const Wide all = scaled(b, q);
    const int shift = -(b.e + q);
    const uint64_t whole = (uint64_t)(all >> shift);
    const Wide rest = all - ((Wide)whole << shift), half = (Wide)1 << (shift - 1);
    return whole + (rest > half || (rest == half && whole % 2 == 1));
}

/* Whether D / 10^q is nearer to the value than to its neighbours. They are 5^q apart in units of 2^-shift; below a power
 * of two half of that. */
static int reads_back(Binary b, int q, uint64_t D)
{
    const Wide all = scaled(b, q), found = (Wide)D << -(b.e + q);
    const int is_below = found < all, is_power = b.m == (uint64_t)1 << 52;
    const Wide off = is_below ? all - found : found - all;
    return off * (is_below && is_power ? 4 : 2) < FIVES[q];
}

/* x with 10^x <= value < 10^(x + 1). */
static int exponent_of(Binary b)
{
    const int x = (int)floor(0.30102999566398120 * (b.e + 52)), q = 16 - x;
    return x + (q <= FIVES_MAX && scaled(b, q) >> -(b.e + q) >= 10 * TEN_16);
}

/* The last n digits of D, 8 at most at a time: those of two halves do not wait for each other. */
static void spell(uint64_t D, int n, char text[])
{
    static const char PAIRS[] =
        "00010203040506070809101112131415161718192021222324252627282930313233343536373839404142434445464748"
        "49505152535455565758596061626364656667686970717273747576777879808182838485868788899091929394959697"
        "9899";
    for (int end = n; end > 0; end -= 8) {
        const int begin = end > 8 ? end - 8 : 0;
        uint32_t eight = (uint32_t)(D % 100000000);
        int i = end;
        D /= 100000000;
        for (; i - 2 >= begin; i -= 2, eight /= 100)
            memcpy(text + i - 2, PAIRS + 2 * (eight % 100), 2);
        if (i > begin)
            text[begin] = (char)('0' + eight % 10);
    }
}

/* "e-05"; |x| < 100 */
static char *put_exponent(int x, char *to)
{
    *to++ = 'e';
    *to++ = x < 0 ? '-' : '+';
    spell((uint64_t)abs(x), 2, to);
    return to + 2;
}

/* D has n digits, the first of 10^x. */
static size_t put_digits(uint64_t D, int n, int x, char text[])
{
    char digit[20], *to = text;
    int kept = n;
    if (D == (n == 15 ? TEN_16 / 10 : n == 16 ? TEN_16 : 10 * TEN_16)) { /* rounded up to the next power */
        D /= 10;
        x++;
    }
    spell(D, n, digit);
    while (kept > 1 && digit[kept - 1] == '0')
        kept--;
    const int whole = x < -4 || x >= n ? 1 : x < 0 ? 0 : x + 1; /* digits before the point */
    if (x < 0 && whole == 0)
        to = mempcpy(to, "0.0000", (size_t)(1 - x));
    for (int i = 0; i < whole; i++)
        *to++ = i < kept ? digit[i] : '0';
    if (kept > whole) {
        if (whole > 0)
            *to++ = '.';
        to = mempcpy(to, digit + whole, (size_t)(kept - whole));
    }
    return (size_t)((x < -4 || x >= n ? put_exponent(x, to) : to) - text);
}

static size_t text_by_printf(double value, char text[NUMBER_TEXT_MAX])
{
    int n = 0;
    for (int digits = 15; digits <= 17; digits++) {
        n = snprintf(text, NUMBER_TEXT_MAX, "%.*g", digits, value);
        if (digits < 17 && strtod(text, NULL) == value)
            break;
    }
    return (size_t)n;
}

size_t number_text(double value, char text[NUMBER_TEXT_MAX])
{
    const double size = fabs(value);
    uint64_t bits;
    if (value == 0.0)
        return (size_t)sprintf(text, "%s", signbit(value) ? "-0" : "0");
    if (!(size >= 1e-10 && size < 1e15))
        return text_by_printf(value, text);
    memcpy(&bits, &size, sizeof bits); /* of a normal number: 11 bits of exponent, 52 of the rest */
    const Binary b = {.m = (bits & (((uint64_t)1 << 52) - 1)) | (uint64_t)1 << 52, .e = (int)(bits >> 52) - 1075};
    const int x = exponent_of(b), sign = value < 0.0;
    text[0] = '-';
    for (int n = 15;; n++) {
        const int q = n - 1 - x;
        const uint64_t D = digits_of(b, q);
        if (n == 17 || reads_back(b, q, D)) {
            const size_t length = put_digits(D, n, x, text + sign) + (size_t)sign;
            text[length] = 0;
            return length;
        }
    }
}

/* -- from text ----------------------------------------------------------------------------------------------------- */

static int bits_of(uint64_t value)
{
    return 64 - __builtin_clzll(value);
}

/* D / 10^k, rounded half to even: of the quotient by 5^k 62 bits at least and whether there is a rest. */
static double quotient(uint64_t D, int k)
{
    const int shift = 63 + bits_of(FIVES[k]) - bits_of(D);
    const Wide all = (Wide)D << shift, found = all / FIVES[k];
    uint64_t q = (uint64_t)found;
    const int low = bits_of(q) - 53;
    const uint64_t rest = q & (((uint64_t)1 << low) - 1), half = (uint64_t)1 << (low - 1);
    const int is_more = found * FIVES[k] != all;
    q >>= low;
    q += rest > half || (rest == half && (is_more || q % 2 == 1));
    return ldexp((double)q, low - shift - k);
}

/* D / 10^k, k <= 2 FIVES_MAX, by quotients of 64 bits; 0: not so exact that it is known to which double it is rounded. A
 * quotient is half a unit in the last place of those bits off, 2^-11 of one of a double's; the second one as much again. */
static int quick_quotient(uint64_t D, int k, double *value)
{
#if LDBL_MANT_DIG == 64
    const int first = k < FIVES_MAX ? k : FIVES_MAX;
    const long double tens = (long double)FIVES[first] * (long double)((uint64_t)1 << first);
    long double q = (long double)D / tens;
    if (k > first)
        q /= (long double)FIVES[k - first] * (long double)((uint64_t)1 << (k - first));
    uint64_t bits;
    memcpy(&bits, &q, sizeof bits);
    *value = (double)q;
    return (bits & 2047) < 1024 - 2 || (bits & 2047) > 1024 + 2;
#else
    (void)D, (void)k, (void)value;
    return 0;
#endif
}

static uint64_t digit_of(const char *at)
{
    return (unsigned)(*at - '0');
}

/* Four at a time: a step waits for the one before. */
static const char *take_digits(const char *at, uint64_t *D)
{
    uint64_t all = *D;
    for (; digit_of(at) < 10 && digit_of(at + 1) < 10 && digit_of(at + 2) < 10 && digit_of(at + 3) < 10; at += 4)
        all = 10000 * all + 1000 * digit_of(at) + 100 * digit_of(at + 1) + 10 * digit_of(at + 2) + digit_of(at + 3);
    for (; digit_of(at) < 10; at++)
        all = 10 * all + digit_of(at);
    *D = all;
    return at;
}

/* The digits, the point left out; places: digits behind it. NULL: more than 19 from the first that is not 0, or none. */
static const char *read_digits(const char *at, uint64_t *D, int *places)
{
    const char *const begin = at, *end;
    *D = 0;
    end = at = take_digits(at, D);
    if (*at == '.')
        end = take_digits(at + 1, D);
    *places = end > at ? (int)(end - at) - 1 : 0;
    long n = end - begin - (end > at);
    if (n == 0)
        return NULL;
    for (const char *zero = begin; n > 19 && (*zero == '0' || *zero == '.'); zero++)
        n -= *zero == '0';
    return n > 19 ? NULL : end;
}

/* Behind "e-05", with the digits that it moves the point; `at` where there is no such thing. */
static const char *read_exponent(const char *at, int *places)
{
    if (at[0] != 'e') /* the end of the text, perhaps */
        return at;
    const int sign = at[1] == '-', begin = 1 + (sign || at[1] == '+');
    int exponent = 0, n = 0;
    for (; n < 3 && at[begin + n] >= '0' && at[begin + n] <= '9'; n++)
        exponent = 10 * exponent + at[begin + n] - '0';
    if (n == 0 || n == 3)
        return at;
    *places += sign ? exponent : -exponent;
    return at + begin + n;
}

double number_read(const char *text, const char **end)
{
    const int sign = text[0] == '-';
    char *last;
    uint64_t D;
    int k;
    const char *at = read_digits(text + sign, &D, &k);
    if (at)
        at = read_exponent(at, &k);
    if (at && (*at == 0 || *at == ',' || *at == ']')) {
        const int is_small = D < (uint64_t)1 << 53;
        *end = at;
        double size;
        int is_known = is_small && k >= 0 && k <= TENS_MAX;
        if (is_known)
            size = (double)D / TENS[k];
        else if (D > 0 && k > 0 && k <= 2 * FIVES_MAX)
            is_known = quick_quotient(D, k, &size);
        if (!is_known && D > 0 && k > 0 && k <= FIVES_MAX) {
            size = quotient(D, k);
            is_known = 1;
        }
        if (is_known)
            return sign ? -size : size;
    }
    const double value = strtod(text, &last);
    *end = last;
    return value;
}
