/* Objectives over a suite of records, fragility curves and yearly rates, by closed forms and known samples. */
#include "runs.h"

#include "analysis/fragility.h"
#include "base/random.h"
#include "base/stat.h"
#include "evaluate/replicates.h"

enum { RECORDS = 40 };

/* Drift ratios 0.001, 0.002, ... in an order of their own, and whether they exceed 0.0305: 10 of 40. */
static void fill(Measured parts[RECORDS])
{
    MeasureOrder order;
    Err err = {0};
    CHECK_OK(measures_order(&order, "j1_m,p(drift_ratio>0.0305)", "none", 0, &err), &err);
    for (size_t i = 0; i < RECORDS; i++) {
        SimResult r = {.drift_ratio_max = 0.001 * (double)(1 + (i * 7) % RECORDS), .j1_m = 2};
        measures_chances(&order, &r);
        parts[i] = measured(&r);
    }
}

static ReplicateSummary summary_of(const ReplicatePlan *plan)
{
    Measured parts[RECORDS];
    ReplicateSummary s;
    fill(parts);
    replicates_summarise(plan, parts, sizeof *parts, &s);
    replicates_errors(plan, parts, sizeof *parts, &s);
    return s;
}

TEST(cvar_of_known_samples_is_the_mean_of_the_worst_with_the_last_in_part)
{
    double v[] = {5, 1, 4, 2, 3};
    const ReplicatePlan fifth = {5, 1, ROBUST_CVAR, 0.8, NULL}, half = {5, 1, ROBUST_CVAR, 0.5, NULL},
                        all = {5, 1, ROBUST_CVAR, 0, NULL};
    double sd;
    assert_close(robust_pooled(&fifth, 1, 5, v, &sd), 5, 1e-14);
    assert_close(robust_pooled(&fifth, -1, 5, v, &sd), 1, 1e-14);
    assert_close(robust_pooled(&half, 1, 5, v, &sd), (5 + 4 + 0.5 * 3) / 2.5, 1e-14);
    assert_close(robust_pooled(&half, -1, 5, v, &sd), (1 + 2 + 0.5 * 3) / 2.5, 1e-14);
    assert_close(robust_pooled(&all, 1, 5, v, &sd), 3, 1e-14);
}

TEST(a_chance_is_the_share_of_all_simulations_by_every_rule)
{
    for (Robust rule = ROBUST_WORST; rule <= ROBUST_QUANTILE; rule++) {
        const ReplicatePlan records = {RECORDS, 1, rule, 0.8, NULL}, both = {RECORDS / 4, 4, rule, 0.8, NULL};
        assert_close(summary_of(&records).mean[MEASURES_LISTED], 0.25, 1e-14);
        assert_close(summary_of(&both).mean[MEASURES_LISTED], 0.25, 1e-14);
        assert_close(summary_of(&records).mean[MEASURE_J1], 2, 1e-14);
    }
}

TEST(standard_errors_are_those_of_the_closed_forms_where_there_are_some)
{
    const ReplicatePlan mean = {RECORDS, 1, ROBUST_MEAN, 0, NULL}, cvar = {RECORDS, 1, ROBUST_CVAR, 0.8, NULL},
                        one = {1, RECORDS, ROBUST_MEAN, 0, NULL};
    const double n = RECORDS, spread = 0.001 * sqrt((n * n - 1) / 12); /* of the numbers 1 to n */
    const ReplicateSummary s = summary_of(&mean);
    assert_close(s.error[MEASURE_DRIFT_RATIO], spread / sqrt(n), 0.15); /* 200 suites know it to 5 % */
    assert_close(s.error[MEASURES_LISTED], sqrt(0.25 * 0.75 / n), 0.15);
    assert_at_most(s.error[MEASURE_J1], 0); /* the same under every record */
    const ReplicateSummary worst = summary_of(&cvar);
    assert_close(worst.mean[MEASURE_DRIFT_RATIO], 0.0365, 1e-12); /* of 33 to 40 */
    assert_less(0, worst.error[MEASURE_DRIFT_RATIO]);
    assert_true(isnan(summary_of(&one).error[MEASURE_DRIFT_RATIO]));
}

TEST(a_study_minimises_and_limits_probabilities)
{
    Run run;
    Err err = {0};
    char path[PATH_MAX];
    write_in_place("tower.ini", SIX_FLOORS_INI
                   "record = builtin:suite-01\nrecords = builtin:suite-02,builtin:suite-03,builtin:suite-04\n"
                   "[sim]\nduration_s = 14\naccuracy = coarse\nrobust = cvar\n"
                   "[search]\nobjectives = p(drift_ratio>0.012), j3_g\nlimits = p(j1_m>0.1)<=0.75\n"
                   "initial = 10\npopulation = 8\nmax_evals = 14\nthreads = 2\npolish = 0\n");
    free(output_of("optimize @/tower.ini --out @/chance"));
    CHECK_OK(run_read(&run, path_of("chance", path), &err), &err);
    const Schema *s = &run.schema;
    assert_string_equal(schema_objective(s, 0)->name, "p(drift_ratio>0.012)");
    assert_int_equal(s->n_limited, 1);
    assert_string_equal(schema_extra(s, s->limited[0])->name, "p(j1_m>0.1)");
    for (size_t i = 0; i < run.table.n; i++) {
        const double p = 4 * run_f(&run, i)[0], q = 4 * run.table.row[i].extra[s->limited[0]];
        assert_true(p == floor(p) && p >= 0 && p <= 4 && q == floor(q) && q >= 0 && q <= 4);
    }
    run_free(&run);
    json_t *o = json_of("simulate @/tower.ini --design @/chance:knee --json");
    json_t *replicates = json_object_get(o, "replicates");
    assert_string_equal(json_string_value(json_object_get(replicates, "rule")), "cvar");
    assert_less(0, number(json_object_get(replicates, "standard_error"), "j3_g"));
    json_decref(o);
    expect(65, "is no p(NAME>NUMBER) with a column as NAME",
           "optimize @/tower.ini --set 'search.objectives=p(drift>0.01)' --out @/no");
    expect(65, "more than 4 probabilities",
           "optimize @/tower.ini --out @/no --set 'search.objectives=p(j1_m>1),p(j1_m>2),p(j1_m>3),p(j1_m>4)'");
}

/* -- fragility ----------------------------------------------------------------------------------------------------- */

enum { LEVELS = 12 };

/* n simulations at each of LEVELS intensities, each of a capacity drawn from the curve. */
static Fragility sampled(double median, double beta, size_t n, uint32_t seed)
{
    double x[LEVELS];
    size_t n_at[LEVELS], exceeded[LEVELS] = {0};
    for (size_t j = 0; j < LEVELS; j++) {
        Random random = random_stream(seed, RANDOM_TEST, 0, (uint32_t)j);
        x[j] = 0.1 * (double)(j + 1);
        n_at[j] = n;
        for (size_t i = 0; i < n; i++)
            exceeded[j] += median * exp(beta * random_normal(&random)) < x[j];
    }
    return fragility_fit(LEVELS, x, n_at, exceeded);
}

TEST(lognormal_samples_recover_their_parameters_within_their_standard_errors)
{
    enum { SEEDS = 200 };
    double inside = 0, inside_beta = 0;
    for (uint32_t seed = 0; seed < SEEDS; seed++) {
        const Fragility f = sampled(0.5, 0.4, 44, seed);
        inside += fabs(log(f.median / 0.5)) < 1.96 * f.sd_ln_median;
        inside_beta += fabs(f.beta - 0.4) < 1.96 * f.sd_beta;
    }
    assert_close(inside / SEEDS, 0.95, 0.04); /* 200 trials of 0.95: a standard deviation of 0.015 */
    assert_close(inside_beta / SEEDS, 0.95, 0.05);
    const Fragility many = sampled(0.5, 0.4, 200000, 1);
    assert_close(many.median, 0.5, 2e-3);
    assert_close(many.beta, 0.4, 5e-3);
}

TEST(what_the_counts_do_not_say_is_not_known)
{
    const double x[] = {1, 2, 4};
    const size_t n_at[] = {5, 5, 5};
    assert_true(isnan(fragility_fit(3, x, n_at, (size_t[]){0, 0, 0}).median));
    assert_true(isnan(fragility_fit(3, x, n_at, (size_t[]){5, 5, 5}).median));
    const Fragility parted = fragility_fit(3, x, n_at, (size_t[]){0, 5, 5});
    assert_close(parted.median, sqrt(2), 1e-12);
    assert_true(isnan(parted.beta) && isnan(parted.sd_ln_median));
    assert_true(isnan(fragility_fit(3, x, n_at, (size_t[]){4, 3, 1}).beta));
    const Fragility f = fragility_fit(3, x, n_at, (size_t[]){1, 2, 4});
    assert_less(0, f.beta);
    assert_close(fragility_at(&f, f.median), 0.5, 1e-12);
}

/* lambda = k0 x^-k, all intensities: k0 median^-k exp(k^2 beta^2 / 2) (Cornell 1996). */
TEST(the_yearly_rate_is_that_of_the_closed_form)
{
    const double k0 = 1e-4, k = 2.5;
    const Fragility f = {0.6, 0.4, 0, 0};
    double hazard[60];
    for (int i = 0; i < 30; i++) {
        hazard[2 * i] = 0.01 * pow(1000, i / 29.0);
        hazard[2 * i + 1] = k0 * pow(hazard[2 * i], -k);
    }
    assert_close(fragility_rate(&f, 30, hazard), k0 * pow(0.6, -k) * exp(k * k * 0.16 / 2), 1e-4);
    const Fragility step = {0.6, NAN, NAN, NAN};
    assert_close(fragility_rate(&step, 30, hazard), k0 * pow(0.6, -k), 2e-2);
}

int main(void)
{
    return RUN_TESTS(make_place, clear_place);
}
