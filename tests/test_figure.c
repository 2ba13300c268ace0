/* A number for people has the digits that its error leaves, and never more. */
#include "program.h"

#include "base/figure.h"
#include "cmd/document.h"

static void expect_figure(double value, double error, double sd, const char *wanted)
{
    char text[FIGURE_MAX];
    figure_text(value, error, sd, "sd", text);
    if (strcmp(text, wanted) != 0)
        fail_msg("%g, error %g, sd %g: is '%s', wanted '%s'", value, error, sd, text, wanted);
}

/* Expected texts are written by hand, by the rule of GUM 7.2.6: value and error end at the same place. */
TEST(a_value_ends_where_its_error_begins)
{
    expect_figure(16.48, 1.7, NAN, "16 ± 2");
    expect_figure(13.25, 0.12, NAN, "13.2 ± 0.1");
    expect_figure(0.07664, 0.0009, NAN, "0.0766 ± 0.0009");
    expect_figure(9.96, 0.96, NAN, "10 ± 1");
    expect_figure(306251, 4100, NAN, "306000 ± 4000");
    expect_figure(-4.567, 0.021, NAN, "-4.57 ± 0.02");
    expect_figure(1.5312e8, 2.1e6, NAN, "(1.53 ± 0.02)·10^8");
    expect_figure(0, 0.3, NAN, "0.0 ± 0.3");
}

TEST(an_error_that_cannot_be_seen_is_not_shown)
{
    expect_figure(0.0766421, 5e-16, NAN, "0.07664");
    expect_figure(436251.3, 0, NAN, "436300");
    expect_figure(0, 0, NAN, "0");
}

TEST(without_an_error_there_are_three_digits_and_no_e)
{
    expect_figure(16.48, NAN, NAN, "16.5");
    expect_figure(436251.3, NAN, NAN, "436000");
    expect_figure(0.001234, NAN, NAN, "0.00123");
    expect_figure(0, NAN, NAN, "0");
    expect_figure(NAN, NAN, NAN, "-");
    expect_figure(INFINITY, 1, NAN, "-");
    expect_figure(1.5312e8, NAN, NAN, "1.53·10^8");
    expect_figure(1.5312e-9, NAN, NAN, "1.53·10^-9");
    expect_figure(1.234e-5, NAN, NAN, "0.0000123");
    expect_figure(-5.04e-5, 2.1e-5, NAN, "-0.00005 ± 0.00002");
}

TEST(an_error_as_large_as_the_value_leaves_its_order_or_zero)
{
    expect_figure(13.25, 14, NAN, "about 10");
    expect_figure(16.48, 40, NAN, "about 20");
    expect_figure(3, 400, NAN, "0 ± 400");
    expect_figure(-0.0066, 0.009, NAN, "0.000 ± 0.009");
    expect_figure(-0.0066, 0.01, NAN, "0.00 ± 0.01");
}

TEST(a_standard_deviation_above_the_error_is_what_is_printed)
{
    expect_figure(13.25, 0.1, 1.16, "13 ± 1 sd");
    expect_figure(13.25, 0.1, 0.01, "13.2 ± 0.1");
    expect_figure(13.25, NAN, 0.2, "13.2 ± 0.2 sd");
}

TEST(a_share_that_is_a_negative_nothing_is_none)
{
    Document d = {0};
    FREED char *text;
    size_t n;
    FILE *f = open_memstream(&text, &n);
    json_t *row = figures_row(document_table(&d));
    figures_put(row, "ed5_10_pct", -0.0066, NAN, NAN);
    figures_put(row, "edcs_pct", -3.21, NAN, NAN); /* a mean less a standard deviation */
    figures_put(row, "ed1_pct", -0.0066, 0.01, NAN);
    document_print(&d, f, 0);
    assert_int_equal(fclose(f), 0);
    if (!strstr(text, " 0.0 ") && !strstr(text, "\n0.0 "))
        fail_msg("%s", text);
    assert_words(text, "-3.21", "0.00 ± 0.01");
}

/* The page has the rule once more, in its own language: the same text for every value and error. */
TEST(the_page_writes_the_same_figures)
{
    static const double VALUES[] = {0,    16.48,   -16.48, 0.0766421, 436251.3, 1.5312e8, 1.5312e-9,
                                    9.96, -0.0066, 1e-4,   3.21e-5,   1e-6,     9.9999e-7};
    static const double SHARES[] = {NAN, 0, 1e-9, 1e-3, 0.013, 0.11, 0.6, 1.3, 30};
    char text[FIGURE_MAX], line[FIGURE_MAX + 2];
    if (system("command -v node >/dev/null") != 0)
        skip();
    FILE *f = opened(there("all.js"), "w");
    fputs("const finite = Number.isFinite, ALL = [", f);
    for (size_t i = 0; i < sizeof VALUES / sizeof VALUES[0]; i++)
        for (size_t k = 0; k < sizeof SHARES / sizeof SHARES[0]; k++)
            if (isnan(SHARES[k]))
                fprintf(f, "[%.17g, NaN], ", VALUES[i]);
            else
                fprintf(f, "[%.17g, %.17g], ", VALUES[i], SHARES[k] * fmax(fabs(VALUES[i]), 0.01));
    fputs("]; for (const [v, e] of ALL) console.log(figureText(v, e));\n", f);
    fclose(f);
    FILE *said = popen(brief("cat web/app/2-figure.js %s | node -", there("all.js")), "r");
    assert_non_null(said);
    for (size_t i = 0; i < sizeof VALUES / sizeof VALUES[0]; i++)
        for (size_t k = 0; k < sizeof SHARES / sizeof SHARES[0]; k++) {
            figure_text(VALUES[i], SHARES[k] * fmax(fabs(VALUES[i]), 0.01), NAN, "sd", text);
            assert_non_null(fgets(line, sizeof line, said));
            line[strcspn(line, "\n")] = 0;
            assert_string_equal(line, text);
        }
    pclose(said);
}

SUITE(make_place, clear_place)
