/* Gain and phase of the Butterworth filter against their closed forms. */
#include "check.h"

#include "base/filter.h"

static double warped(double hz, double dt)
{
    return tan(M_PI * hz * dt);
}

static double gain(FilterKind kind, double hz, double cutoff, double dt)
{
    const double r = pow(warped(hz, dt) / warped(cutoff, dt), 8);
    return kind == FILTER_LOW_PASS ? 1 / (1 + r) : r / (1 + r);
}

/* cos(2 pi f t) under a Gaussian window of many periods, filtered: its middle is the gain, and it stays even. */
static void check_harmonic(FilterKind kind, double hz, double cutoff, double dt)
{
    Filter f;
    CHECK_OK(filter_butterworth(&f, kind, cutoff, dt, &err), &err);
    const size_t half = (size_t)(200 / fmin(hz, cutoff) / dt), n = 2 * half + 1, all = n + filter_padding(&f);
    FREED double *x = calloc(all, sizeof *x);
    double odd = 0;
    for (size_t i = 0; i < n; i++) {
        const double t = ((double)i - (double)half) * dt, s = (double)i / (double)(n - 1) - 0.5;
        x[i] = cos(2 * M_PI * hz * t) * exp(-100 * s * s);
    }
    filter_zero_phase(&f, all, 1, x);
    const double wanted = gain(kind, hz, cutoff, dt);
    for (size_t i = 1; i < half; i++) /* none without a phase shift */
        odd = fmax(odd, fabs(x[half + i] - x[half - i]));
    assert_less(fabs(x[half] - wanted), 5e-4);
    assert_less(odd, 1e-6);
}

TEST(gain_is_that_of_two_passes_of_fourth_order_and_the_phase_is_zero)
{
    for (int kind = FILTER_LOW_PASS; kind <= FILTER_HIGH_PASS; kind++)
        FOR_EACH (double, ratio, 0.25, 0.5, 0.8, 1, 1.25, 2, 4) {
            check_harmonic(kind, 10 * *ratio, 10, 0.002);
            check_harmonic(kind, 0.1 * *ratio, 0.1, 0.01);
        }
}

TEST(the_gain_at_the_cutoff_is_one_half)
{
    assert_close(gain(FILTER_LOW_PASS, 25, 25, 0.005), 0.5, 1e-15);
    check_harmonic(FILTER_LOW_PASS, 25, 25, 0.005);
    check_harmonic(FILTER_HIGH_PASS, 0.05, 0.05, 0.005);
}

TEST(low_and_high_pass_of_an_impulse_add_up_in_area)
{
    enum { N = 20001 };
    for (int kind = FILTER_LOW_PASS; kind <= FILTER_HIGH_PASS; kind++) {
        Filter f;
        double *x = calloc(N, sizeof *x), area = 0;
        CHECK_OK(filter_butterworth(&f, kind, 1.0, 0.005, &err), &err);
        x[N / 2] = 1;
        filter_zero_phase(&f, N, 1, x);
        for (int i = 0; i < N; i++)
            area += x[i];
        assert_less(fabs(area - (kind == FILTER_LOW_PASS)), 1e-9); /* gain at zero frequency */
        for (int i = 1; i < N / 2; i++)
            assert_less(fabs(x[N / 2 + i] - x[N / 2 - i]), 1e-9);
        free(x);
    }
}

TEST(the_padding_takes_up_what_rings_on)
{
    enum { N = 400 };
    for (int kind = FILTER_LOW_PASS; kind <= FILTER_HIGH_PASS; kind++) {
        Filter f;
        CHECK_OK(filter_butterworth(&f, kind, 2.0, 0.01, &err), &err);
        const size_t pad = filter_padding(&f), all = N + 20 * pad;
        FREED double *x = calloc(all, sizeof *x), *y = calloc(all, sizeof *y);
        for (size_t i = 0; i < N; i++)
            x[i] = y[i] = sin(0.3 * (double)i) + 0.5;
        filter_zero_phase(&f, N + pad, 1, x);
        filter_zero_phase(&f, all, 1, y);
        for (size_t i = 0; i < N; i++)
            assert_less(fabs(x[i] - y[i]), 1e-5);
    }
}

TEST(signals_side_by_side_are_filtered_as_each_alone)
{
    enum { N = 300, WIDTH = 21 };
    Filter f;
    double *all = malloc(N * WIDTH * sizeof *all), one[N];
    CHECK_OK(filter_butterworth(&f, FILTER_LOW_PASS, 3, 0.01, &err), &err);
    for (int i = 0; i < N * WIDTH; i++)
        all[i] = sin(0.37 * i * i);
    for (int j = 0; j < WIDTH; j += 5) {
        FREED double *copy = malloc(N * WIDTH * sizeof *copy);
        memcpy(copy, all, N * WIDTH * sizeof *copy);
        for (int i = 0; i < N; i++)
            one[i] = all[i * WIDTH + j];
        filter_zero_phase(&f, N, WIDTH, copy);
        filter_zero_phase(&f, N, 1, one);
        for (int i = 0; i < N; i++)
            assert_same_number(one[i], copy[i * WIDTH + j]);
    }
    free(all);
}

TEST(a_cutoff_beyond_half_the_sampling_rate_is_refused)
{
    Filter f;
    FOR_EACH (double, bad, 0, -1, 50, 80, NAN, INFINITY)
        assert_refused(filter_butterworth(&f, FILTER_LOW_PASS, *bad, 0.01, &err), STATUS_BAD_DATA, "50 Hz");
}

SUITE(NULL, NULL)
