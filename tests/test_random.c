#include "check.h"

/* Random123's known answers for philox4x32-10: counter and key all zero, and digits of pi. The stream's counter is
 * (block, individual, generation, 0) and its key (seed, purpose), so both can be asked for by name. */
TEST(the_first_numbers_are_the_published_known_answers)
{
    const uint32_t zero[4] = {0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8};
    const uint32_t pi[4] = {0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1};
    Random a = random_stream(0, (RandomPurpose)0, 0, 0);
    Random b = {.key = {0xa4093822, 0x299f31d0}, .counter = {0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}};
    for (int i = 0; i < 4; i++) {
        assert_int_equal(random_bits(&a), zero[i]);
        assert_int_equal(random_bits(&b), pi[i]);
    }
}

TEST(the_same_name_gives_the_same_numbers_and_another_name_others)
{
    Random a = random_stream(7, RANDOM_TEST, 3, 11), b = random_stream(7, RANDOM_TEST, 3, 11);
    Random others[] = {random_stream(8, RANDOM_TEST, 3, 11), random_stream(7, RANDOM_NICHING, 3, 11),
                       random_stream(7, RANDOM_TEST, 4, 11), random_stream(7, RANDOM_TEST, 3, 12)};
    for (int i = 0; i < 1000; i++) {
        const double u = random_uniform(&a);
        assert_same_number(u, random_uniform(&b));
        for (size_t k = 0; k < sizeof others / sizeof others[0]; k++)
            assert_true(u != random_uniform(&others[k]));
    }
}

/* Mean 1/2 and variance 1/12 with standard errors of sqrt(1/12n) and sqrt(1/180n); wanted within five of them. */
TEST(uniform_numbers_have_their_mean_and_variance_and_neighbouring_streams_no_correlation)
{
    enum { N = 100000 };
    double sum = 0, square = 0, product = 0;
    for (uint32_t i = 0; i < N; i++) {
        Random a = random_stream(1, RANDOM_TEST, 0, i), b = random_stream(1, RANDOM_TEST, 0, i + 1);
        const double u = random_uniform(&a) - 0.5, v = random_uniform(&b) - 0.5;
        assert_true(u >= -0.5 && u < 0.5);
        sum += u;
        square += u * u;
        product += u * v;
    }
    assert_less(fabs(sum / N), 5 * sqrt(1.0 / 12 / N));
    assert_less(fabs(square / N - 1.0 / 12), 5 * sqrt(1.0 / 180 / N));
    assert_less(fabs(product / N), 5 / (12 * sqrt(N)));
}

/* Chi squared of 6 classes has 5 degrees of freedom: above 25 once in 7,000 seeds. */
TEST(integers_below_n_are_equally_likely)
{
    enum { N = 60000 };
    size_t count[6] = {0};
    Random r = random_stream(5, RANDOM_TEST, 0, 0);
    for (int i = 0; i < N; i++)
        count[random_below(&r, 6)]++;
    double chi2 = 0;
    for (int k = 0; k < 6; k++)
        chi2 += ((double)count[k] - N / 6.0) * ((double)count[k] - N / 6.0) / (N / 6.0);
    assert_less(chi2, 25);
    for (int i = 0; i < 100; i++)
        assert_int_equal(random_below(&r, 1), 0);
}

TEST(normal_numbers_have_the_moments_of_a_normal)
{
    enum { N = 100000 };
    double moment[5] = {0};
    Random r = random_stream(5, RANDOM_TEST, 0, 0);
    for (int i = 0; i < N; i++) {
        const double z = random_normal(&r);
        for (int k = 1; k < 5; k++)
            moment[k] += pow(z, k) / N;
    }
    assert_less(fabs(moment[1]), 5 * sqrt(1.0 / N));
    assert_less(fabs(moment[2] - 1), 5 * sqrt(2.0 / N));
    assert_less(fabs(moment[3]), 5 * sqrt(15.0 / N));
    assert_less(fabs(moment[4] - 3), 5 * sqrt(96.0 / N));
}

TEST(a_shuffle_keeps_every_item)
{
    size_t list[50], seen[50] = {0}, moved = 0;
    for (size_t i = 0; i < 50; i++)
        list[i] = i;
    Random r = random_stream(5, RANDOM_TEST, 0, 0);
    random_shuffle(&r, 50, list);
    for (size_t i = 0; i < 50; i++) {
        seen[list[i]]++;
        moved += list[i] != i;
    }
    for (size_t i = 0; i < 50; i++)
        assert_int_equal(seen[i], 1);
    assert_less(30, moved);
}

SUITE(NULL, NULL)
