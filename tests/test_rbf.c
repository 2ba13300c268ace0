#include "check.h"
#include "rbf/model.h"
#include "rbf/rbf.h"

enum { N = 60, D = 4, OUT = 2 };

static double bowl(const double x[])
{
    return 3.0 + sin(3.0 * x[0]) * cos(2.0 * x[1]) + x[2] * x[2] - 0.5 * x[3];
}

static double plane(const double x[])
{
    return -2e5 + 3e4 * x[0] - 7e4 * x[1] + 1e4 * x[2] + 2e3 * x[3];
}

static void scatter(uint32_t seed, size_t n, double X[], double F[])
{
    Random r = random_stream(seed, RANDOM_TEST, 0, 0);
    for (size_t i = 0; i < n; i++) {
        for (size_t d = 0; d < D; d++)
            X[i * D + d] = random_uniform(&r);
        F[i * OUT] = bowl(X + i * D);
        F[i * OUT + 1] = plane(X + i * D);
    }
}

static Rbf *fitted(size_t n, const double X[], const double F[], int tune)
{
    Rbf *m;
    CHECK_OK(rbf_create(&m, N, D, OUT, &err), &err);
    CHECK_OK((tune ? rbf_tune : rbf_fit)(m, n, X, F, NULL, &err), &err);
    return m;
}

TEST(the_surface_goes_through_its_data)
{
    double X[N * D], F[N * OUT], f[OUT];
    scatter(1, N, X, F);
    for (int tune = 0; tune < 2; tune++) {
        FREED Rbf *m = fitted(N, X, F, tune);
        for (int i = 0; i < N; i++) {
            rbf_eval(m, 1, X + i * D, f, NULL);
            assert_less(fabs(f[0] - F[i * OUT]), 1e-4);
        }
    }
}

TEST(linear_functions_are_reproduced_everywhere)
{
    double X[N * D], F[N * OUT], Y[N * D], wanted[N * OUT], f[OUT];
    scatter(1, N, X, F);
    scatter(2, N, Y, wanted);
    FREED Rbf *m = fitted(N, X, F, 0);
    for (int i = 0; i < N; i++) {
        rbf_eval(m, 1, Y + i * D, f, NULL);
        assert_close(f[1], wanted[i * OUT + 1], 1e-9);
    }
    assert_less(1 - 1e-12, rbf_explained(m, 1));
}

TEST(tuning_lowers_the_error_at_unseen_points)
{
    double X[N * D], F[N * OUT], Y[N * D], wanted[N * OUT], f[OUT], square[2] = {0};
    scatter(1, N, X, F);
    scatter(2, N, Y, wanted);
    for (int tune = 0; tune < 2; tune++) {
        FREED Rbf *m = fitted(N, X, F, tune);
        for (int i = 0; i < N; i++) {
            rbf_eval(m, 1, Y + i * D, f, NULL);
            square[tune] += (f[0] - wanted[i * OUT]) * (f[0] - wanted[i * OUT]) / N;
        }
    }
    assert_less(square[1], square[0]);
    assert_less(sqrt(square[1]), 5e-3);
}

/* A product of two variables, as the mass of a section is, and a function of which every centre says something. */
TEST(an_exact_output_is_told_by_a_few_centres_and_others_by_all)
{
    enum { MANY = 160 };
    double X[MANY * D], F[MANY * OUT], Y[N * D], wanted[N * OUT], f[OUT], J[OUT * D];
    FREED Rbf *m;
    scatter(1, MANY, X, F);
    scatter(2, N, Y, wanted);
    for (size_t i = 0; i < MANY; i++)
        F[i * OUT + 1] = (1.0 + X[i * D]) * (2.0 + X[i * D + 1]);
    for (size_t i = 0; i < MANY; i++)
        F[i * OUT] = sin(40.0 * X[i * D]) + (double)(i % 7);
    CHECK_OK(rbf_create(&m, MANY, D, OUT, &err), &err);
    for (int tuned = 0; tuned < 2; tuned++) {
        CHECK_OK((tuned ? rbf_fit : rbf_tune)(m, MANY, X, F, NULL, &err), &err);
        assert_same_number(m->output[0].n, MANY);
        assert_same_number(m->output[1].n, FEW_CENTRES);
        for (int i = 0; i < N; i++) {
            const double *y = Y + i * D;
            rbf_slope(m, 1, y, f, J);
            assert_close(f[1], (1.0 + y[0]) * (2.0 + y[1]), 1e-3);
            assert_close(J[D], 2.0 + y[1], 1e-2);
        }
        assert_less(1.0 - 1e-9, rbf_explained(m, 1));
        assert_true(rbf_leave_one_out(m, 1)[MANY - 1] == 0.0);
    }
}

static void set_shape(Rbf *m, size_t output, RbfForm form)
{
    const double theta[D] = {2.0, 1.0, 0.5, 0.7};
    m->output[output].form = form;
    memcpy(m->output[output].shape.theta, theta, sizeof theta);
}

/* Every kernel, tail and nugget, with answers of equal and of different variance, against surfaces that were each
 * fitted without one centre. Standardisation scales data and answer alike and the nugget is relative to the kernel, so
 * leaving a centre out changes neither. */
TEST(closed_form_leave_one_out_errors_equal_refits)
{
    enum { FEW = 30 };
    double X[FEW * D], F[FEW * OUT], V[FEW * OUT], X1[FEW * D], F1[FEW * OUT], V1[FEW * OUT], f[OUT];
    scatter(3, FEW, X, F);
    for (size_t i = 0; i < FEW * OUT; i++)
        V[i] = 1.0 / (double)(1 + i % 5);
    Rbf *all, *without;
    CHECK_OK(rbf_create(&all, N, D, OUT, &err), &err);
    CHECK_OK(rbf_create(&without, N, D, OUT, &err), &err);
    for (int kernel = 0; kernel < RBF_N_KERNELS; kernel++)
        for (int tail = 0; tail < RBF_N_TAILS; tail++)
            for (int noisy = 0; noisy < 3; noisy++) {
                const RbfForm form = {(RbfKernel)kernel, (RbfTail)tail, noisy ? 1e-2 : 1e-7};
                set_shape(all, 0, form);
                set_shape(without, 0, form);
                CHECK_OK(rbf_fit(all, FEW, X, F, noisy == 2 ? V : NULL, &err), &err);
                for (size_t out = 0; out < FEW; out += 7) {
                    for (size_t i = 0, j = 0; i < FEW; i++) {
                        if (i == out)
                            continue;
                        memcpy(X1 + j * D, X + i * D, D * sizeof *X);
                        memcpy(V1 + j * OUT, V + i * OUT, OUT * sizeof *V);
                        memcpy(F1 + j++ * OUT, F + i * OUT, OUT * sizeof *F);
                    }
                    CHECK_OK(rbf_fit(without, FEW - 1, X1, F1, noisy == 2 ? V1 : NULL, &err), &err);
                    rbf_eval(without, 1, X + out * D, f, NULL);
                    assert_less(fabs(rbf_leave_one_out(all, 0)[out] - (F[out * OUT] - f[0])), 2e-6);
                }
            }
    free(all);
    free(without);
}

/* Answers again of the same designs are centres that coincide, and the likelihood of a surface knows them by their mean
 * alone: i answers are as good as one with the i-th part of the variance. */
TEST(a_mean_of_answers_with_its_part_of_the_variance_is_worth_all_of_them)
{
    enum { FEW = 20 };
    double X[FEW * D], F[FEW * OUT], V[FEW * OUT], every_X[N * D], every_F[N * OUT], Y[FEW * D], ignored[FEW * OUT];
    double f[OUT], wanted[OUT];
    size_t n = 0;
    Random r = random_stream(5, RANDOM_TEST, 1, 0);
    scatter(5, FEW, X, F);
    scatter(6, FEW, Y, ignored);
    for (size_t i = 0; i < FEW; i++) {
        const size_t answers = 1 + i % 4;
        double mean[OUT] = {0};
        for (size_t j = 0; j < answers; j++, n++)
            for (size_t k = 0; k < OUT; k++) {
                every_F[n * OUT + k] = F[i * OUT + k] * (1.0 + 0.05 * random_normal(&r));
                mean[k] += every_F[n * OUT + k] / (double)answers;
                memcpy(every_X + n * D, X + i * D, D * sizeof *X);
                V[i * OUT + k] = 1.0 / (double)answers;
            }
        memcpy(F + i * OUT, mean, sizeof mean);
    }
    assert_same_number(n, 50);
    FREED Rbf *means, *all;
    CHECK_OK(rbf_create(&means, N, D, OUT, &err), &err);
    CHECK_OK(rbf_create(&all, N, D, OUT, &err), &err);
    for (size_t k = 0; k < OUT; k++) {
        set_shape(means, k, (RbfForm){RBF_MATERN, RBF_LINEAR, 3e-2});
        set_shape(all, k, (RbfForm){RBF_MATERN, RBF_LINEAR, 3e-2});
    }
    CHECK_OK(rbf_fit(means, FEW, X, F, V, &err), &err);
    CHECK_OK(rbf_fit(all, n, every_X, every_F, NULL, &err), &err);
    for (size_t i = 0; i < FEW; i++) {
        rbf_eval(means, 1, Y + i * D, f, NULL);
        rbf_eval(all, 1, Y + i * D, wanted, NULL);
        for (size_t k = 0; k < OUT; k++)
            assert_close(f[k], wanted[k], 1e-9);
    }
}

/* Every other answer scatters ten times as much. The nugget is that of the rest. */
TEST(tuning_finds_the_nugget_of_answers_of_different_variance)
{
    enum { MANY = 200 };
    const double deviation = 0.02;
    double X[MANY * D], F[MANY * OUT], V[MANY * OUT], Y[MANY * D], wanted[MANY * OUT], f[OUT], square[2] = {0};
    Random r = random_stream(9, RANDOM_TEST, 1, 0);
    scatter(9, MANY, X, F);
    scatter(10, MANY, Y, wanted);
    for (size_t i = 0; i < MANY; i++) {
        V[i * OUT] = V[i * OUT + 1] = i % 2 ? 100.0 : 1.0;
        F[i * OUT] += deviation * sqrt(V[i * OUT]) * random_normal(&r);
    }
    for (int told = 0; told < 2; told++) {
        FREED Rbf *m;
        CHECK_OK(rbf_create(&m, MANY, D, OUT, &err), &err);
        CHECK_OK(rbf_tune(m, MANY, X, F, told ? V : NULL, &err), &err);
        for (size_t i = 0; i < MANY; i++) {
            rbf_eval(m, 1, Y + i * D, f, NULL);
            square[told] += (f[0] - wanted[i * OUT]) * (f[0] - wanted[i * OUT]) / MANY;
        }
    }
    if (!(square[1] < 0.25 * square[0] && square[1] < deviation * deviation))
        fail_msg("root mean square error %g where the variances are told, %g where they are not", sqrt(square[1]),
                 sqrt(square[0]));
}

TEST(equal_designs_with_different_answers_are_averaged)
{
    double X[N * D], F[N * OUT], f[OUT];
    scatter(4, N, X, F);
    memcpy(X + D, X, D * sizeof *X);
    F[OUT] = F[0] + 0.2;
    FREED Rbf *m = fitted(N, X, F, 1);
    rbf_eval(m, 1, X, f, NULL);
    assert_less(fabs(f[0] - (F[0] + 0.1)), 0.08);
}

TEST(the_error_estimate_is_of_the_size_of_the_true_error)
{
    double X[N * D], F[N * OUT], Y[N * D], wanted[N * OUT], f[OUT], e[OUT], square = 0, estimate = 0;
    for (uint32_t seed = 1; seed <= 10; seed++) {
        scatter(seed, N, X, F);
        scatter(100 + seed, N, Y, wanted);
        FREED Rbf *m = fitted(N, X, F, 0);
        for (int i = 0; i < N; i++) {
            rbf_eval(m, 1, Y + i * D, f, e);
            square += (f[0] - wanted[i * OUT]) * (f[0] - wanted[i * OUT]);
            estimate += e[0] * e[0];
        }
    }
    if (!(estimate > square / 4 && estimate < square * 9))
        fail_msg("estimate %g, true %g", estimate, square);
}

TEST(a_constant_output_is_predicted_without_error)
{
    double X[N * D], F[N * OUT], f[OUT], e[OUT];
    scatter(1, N, X, F);
    for (int i = 0; i < N; i++)
        F[i * OUT] = 4.0;
    FREED Rbf *m = fitted(N, X, F, 1);
    rbf_eval(m, 1, (const double[D]){0.1, 0.9, 0.4, 0.2}, f, e);
    assert_close(f[0], 4.0, 1e-12);
    assert_less(e[0], 1e-12);
}

TEST(a_value_that_is_not_finite_is_refused)
{
    double X[N * D], F[N * OUT];
    scatter(1, N, X, F);
    F[17 * OUT] = NAN;
    FREED Rbf *m;
    CHECK_OK(rbf_create(&m, N, D, OUT, &err), &err);
    assert_int_equal(rbf_fit(m, N, X, F, NULL, &err), STATUS_BAD_DATA);
    assert_int_equal(rbf_tune(m, N, X, F, NULL, &err), STATUS_BAD_DATA);
}

/* Without that centre nothing is known of its variable: its coefficient of the tail has no leave-one-out error. */
TEST(a_centre_that_alone_moves_a_variable_is_fitted_all_the_same)
{
    for (uint32_t seed = 1; seed <= 50; seed++) {
        double X[N * D], F[N * OUT], f[OUT], e[OUT];
        scatter(seed, N, X, F);
        for (int i = 0; i < N; i++)
            for (int d = 0; d < D; d++)
                X[i * D + d] = i == d ? 0.3 : 0.0;
        for (int i = 0; i < N * OUT; i++)
            F[i] = X[i / OUT * D] + 2.0 * X[i / OUT * D + 1];
        FREED Rbf *m = fitted(N, X, F, 1);
        assert_int_equal(rbf_left_out(m), 0);
        rbf_eval(m, 1, (const double[D]){0.1, 0.2, 0.1, 0.1}, f, e);
        for (int k = 0; k < OUT; k++)
            assert_true(isfinite(f[k]) && isfinite(e[k]) && isfinite(rbf_explained(m, (size_t)k)));
    }
}

TEST(the_mean_stands_for_an_output_that_cannot_be_fitted)
{
    double X[N * D], F[N * OUT], f[OUT], mean = 0.0;
    scatter(1, N, X, F);
    FREED Rbf *m = fitted(N, X, F, 1);
    m->output[0].shape.theta[1] = NAN;
    CHECK_OK(rbf_fit(m, N, X, F, NULL, &err), &err);
    assert_int_equal(rbf_left_out(m), 1);
    m->output[0].shape.theta[1] = 1.0;
    rbf_eval(m, 1, (const double[D]){0.1, 0.2, 0.1, 0.1}, f, NULL);
    for (int i = 0; i < N; i++)
        mean += F[i * OUT] / N;
    assert_close(f[0], mean, 1e-12);
    assert_true(rbf_explained(m, 0) == 0.0 && rbf_explained(m, 1) > 0.0);
    for (int i = 0; i < N; i++)
        assert_close(rbf_leave_one_out(m, 0)[i], (F[i * OUT] - mean) * N / (N - 1), 1e-9);
}

TEST(the_slope_of_the_surface_equals_differences_for_every_form)
{
    double X[N * D], F[N * OUT], f[OUT], up[OUT], down[OUT], J[OUT * D];
    scatter(7, N, X, F);
    enum { FORMS = RBF_N_KERNELS * RBF_N_TAILS };
    for (int form = 0; form < FORMS; form++) {
        FREED Rbf *m = fitted(N, X, F, 1);
        for (size_t k = 0; k < OUT; k++)
            m->output[k].form = (RbfForm){(RbfKernel)(form / RBF_N_TAILS), (RbfTail)(form % RBF_N_TAILS), 1e-6};
        CHECK_OK(rbf_fit(m, N, X, F, NULL, &err), &err);
        double x[D] = {0.31, 0.62, 0.48, 0.77}, y[OUT];
        rbf_slope(m, 1, x, f, J);
        rbf_eval(m, 1, x, y, NULL);
        for (size_t k = 0; k < OUT; k++)
            assert_close(f[k], y[k], 1e-10);
        for (size_t d = 0; d < D; d++) {
            const double at = x[d], h = 1e-5;
            x[d] = at + h;
            rbf_eval(m, 1, x, up, NULL);
            x[d] = at - h;
            rbf_eval(m, 1, x, down, NULL);
            x[d] = at;
            assert_less(fabs(J[d] - (up[0] - down[0]) / (2 * h)), 1e-4);
            assert_less(fabs(J[D + d] - (up[1] - down[1]) / (2 * h)), 10.0); /* of 1e5 */
        }
    }
}

/* Two waves to the box in each of ten variables, higher in the last than in the others, on a slope: a product of ten would
 * need the waves in every corner. Of rings nothing is a sum over the variables. */
TEST(waves_along_single_variables_are_found_from_few_designs_and_only_where_there_are_any)
{
    enum { MANY = 10, DESIGNS = 100 };
    static double X[DESIGNS * MANY], F[DESIGNS * 2];
    Random r = random_stream(11, RANDOM_TEST, 0, 0);
    for (size_t i = 0; i < DESIGNS; i++) {
        F[2 * i] = F[2 * i + 1] = 0.0;
        for (size_t d = 0; d < MANY; d++) {
            const double x = X[i * MANY + d] = random_uniform(&r);
            F[2 * i] += x - (d + 1 == MANY ? 2.0 : 1.0) * cos(4.0 * M_PI * x);
            F[2 * i + 1] += (x - 0.3) * (x - 0.3);
        }
        F[2 * i + 1] = sin(4.0 * F[2 * i + 1]);
    }
    FREED Rbf *m;
    CHECK_OK(rbf_create(&m, DESIGNS, MANY, 2, &err), &err);
    CHECK_OK(rbf_tune(m, DESIGNS, X, F, NULL, &err), &err);
    assert_true(rbf_is_additive(m, 0) && !rbf_is_additive(m, 1));
    assert_less(0.9, rbf_explained(m, 0));
    double square = 0.0, spread = 0.0, f[2];
    for (size_t i = 0; i < DESIGNS; i++) {
        double x[MANY], answer = 0.0;
        for (size_t d = 0; d < MANY; d++) {
            x[d] = random_uniform(&r);
            answer += x[d] - (d + 1 == MANY ? 2.0 : 1.0) * cos(4.0 * M_PI * x[d]);
        }
        rbf_eval(m, 1, x, f, NULL);
        square += (f[0] - answer) * (f[0] - answer);
        spread += (answer - 5.0) * (answer - 5.0);
    }
    assert_less(square, 0.1 * spread);
}

SUITE(NULL, NULL)
