/* Objectives over a suite of records, fragility curves and yearly rates, by closed forms and known samples. */
#include "runs.h"

#include "analysis/evaluations.h"
#include "evaluate/consequences.h"
#include "evaluate/race.h"
#include "evaluate/replicates.h"
#include "motion/motion_scale.h"
#include "motion/spectrum.h"

enum { RECORDS = 40 };

/* Drift ratios 0.001, 0.002, ... in an order of their own, and whether they exceed 0.0305: 10 of 40. */
static void fill(Measured parts[RECORDS])
{
    MeasureOrder order;
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
    replicates_summarise(plan, parts, sizeof *parts, 1, &s);
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
    write_in_place("tower.ini", SIX_FLOORS_INI
                   "record = builtin:elcentro-like\nrecords = builtin:sylmar-like,builtin:suite-03,builtin:suite-04\n"
                   "[sim]\nduration_s = 4\naccuracy = coarse\nrobust = cvar\n"
                   "[search]\nobjectives = p(drift_ratio>0.012), j3_g\nlimits = p(j1_m>0.1)<=0.75\n"
                   "initial = 8\npopulation = 8\nmax_evals = 12\nthreads = 2\npolish = 0\n");
    free(output_of("optimize @/tower.ini --out @/chance"));
    OWNED(run_free) Run run = run_in("chance");
    const Schema *s = &run.schema;
    assert_string_equal(schema_objective(s, 0)->name, "p(drift_ratio>0.012)");
    assert_int_equal(s->n_limited, 1);
    assert_string_equal(schema_extra(s, s->limited[0])->name, "p(j1_m>0.1)");
    for (size_t i = 0; i < run.table.n; i++) {
        const double p = 4 * run_f(&run, i)[0], q = 4 * run.table.row[i].extra[s->limited[0]];
        assert_true(p == floor(p) && p >= 0 && p <= 4 && q == floor(q) && q >= 0 && q <= 4);
    }
    json_auto_t *o = as_json("simulate @/tower.ini --design @/chance:knee --json");
    json_t *replicates = json_object_get(o, "replicates");
    assert_string_equal(json_string_value(json_object_get(replicates, "rule")), "cvar");
    assert_less(0, number(json_object_get(replicates, "standard_error"), "j3_g"));
    expect(65, "is no p(NAME>NUMBER) with a column as NAME",
           "optimize @/tower.ini --set 'search.objectives=p(drift_ratio>)' --out @/no");
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
    static const struct {
        size_t exceeded[3];
        double from, to;
    } PARTED[] = {{{0, 0, 0}, 4, INFINITY}, {{5, 5, 5}, 0, 1},        {{0, 5, 5}, 1, 2}, {{0, 2, 5}, 1, 4},
                  {{0, 4, 5}, 1, 4},        {{0, 0, 2}, 2, INFINITY}, {{4, 5, 5}, 0, 2}};
    const double hazard[] = {0.5, 0.1, 8, 0.001};
    for (size_t i = 0; i < sizeof PARTED / sizeof PARTED[0]; i++) {
        const Fragility parted = fragility_fit(3, x, n_at, PARTED[i].exceeded);
        assert_true(isnan(parted.median) && isnan(parted.beta) && isnan(parted.sd_ln_median));
        assert_true(parted.between[0] == PARTED[i].from && parted.between[1] == PARTED[i].to);
        assert_true(isnan(fragility_at(&parted, 2)) && isnan(fragility_rate(&parted, 2, hazard)));
    }
    const Fragility falling = fragility_fit(3, x, n_at, (size_t[]){4, 3, 1});
    assert_true(isnan(falling.median) && isnan(falling.beta) && isnan(falling.between[0]));
    const Fragility f = fragility_fit(3, x, n_at, (size_t[]){1, 2, 4});
    assert_less(0, f.beta);
    assert_close(fragility_at(&f, f.median), 0.5, 1e-12);
}

/* lambda = k0 x^-k, all intensities: k0 median^-k exp(k^2 beta^2 / 2) (Cornell 1996). */
TEST(the_yearly_rate_is_that_of_the_closed_form)
{
    const double k0 = 1e-4, k = 2.5;
    const Fragility f = {.median = 0.6, .beta = 0.4};
    double hazard[60];
    for (int i = 0; i < 30; i++) {
        hazard[2 * i] = 0.01 * pow(1000, i / 29.0);
        hazard[2 * i + 1] = k0 * pow(hazard[2 * i], -k);
    }
    assert_close(fragility_rate(&f, 30, hazard), k0 * pow(0.6, -k) * exp(k * k * 0.16 / 2), 1e-4);
}

/* -- annual loss --------------------------------------------------------------------------------------------------- */

/* lambda = k0 x^-k from 0.02 to 5 at points of a table. */
enum { POINTS = 7 };
static void power_law(double k0, double k, double hazard[2 * POINTS])
{
    for (int i = 0; i < POINTS; i++) {
        hazard[2 * i] = 0.02 * pow(250, i / (POINTS - 1.0));
        hazard[2 * i + 1] = k0 * pow(hazard[2 * i], -k);
    }
}

/* Of L = s x to x = 1 and constant above, by parts s (x0 lambda(x0) + integral of lambda from x0 to 1), however many
 * levels show it; a logarithm where lambda is 1 / x. Below the first level: s times the integral of x k lambda / x. */
TEST(the_annual_loss_of_a_loss_straight_in_intensity_is_that_of_the_closed_form)
{
    static const double EXPONENT[] = {0.7, 1, 2.5}, X[] = {0.1, 0.35, 1}, LOSS[] = {0.04, 0.14, 0.4};
    const double k0 = 1e-4, s = 0.4, x0 = 0.02;
    for (int i = 0; i < 3; i++) {
        const double k = EXPONENT[i];
        double hazard[2 * POINTS];
        power_law(k0, k, hazard);
        const double area = k == 1 ? log(1 / x0) : (1 - pow(x0, 1 - k)) / (1 - k);
        const double low = k == 1 ? log(0.1 / x0) : (pow(0.1, 1 - k) - pow(x0, 1 - k)) / (1 - k);
        const AnnualLoss y = annual_loss(3, X, LOSS, POINTS, hazard),
                         last = annual_loss(1, X + 2, LOSS + 2, POINTS, hazard);
        assert_close(y.per_year, s * k0 * (pow(x0, 1 - k) + area), 1e-12);
        assert_close(last.per_year, y.per_year, 1e-12);
        assert_close(y.below, s * k0 * k * low, 1e-12);
        assert_close(y.above, s * k0, 1e-12);
        assert_close(y.at_begin, s * k0 * pow(x0, 1 - k), 1e-12);
        assert_close(last.below + last.above, y.per_year, 1e-12);
    }
}

TEST(a_constant_loss_comes_as_often_as_the_first_point_and_a_step_as_often_as_its_place)
{
    const double x[] = {0.01, 0.3, 0.3 * (1 + 1e-9), 2}, constant[] = {0.3, 0.3, 0.3, 0.3}, step[] = {0, 0, 1, 1};
    double hazard[2 * POINTS];
    power_law(2e-3, 1.7, hazard);
    const AnnualLoss y = annual_loss(4, x, constant, POINTS, hazard), z = annual_loss(4, x, step, POINTS, hazard);
    assert_close(y.per_year, 0.3 * hazard[1], 1e-12);
    assert_close(y.at_begin, y.per_year, 1e-12);
    assert_at_most(y.below, 0);
    assert_close(y.above, 0.3 * 2e-3 * pow(2, -1.7), 1e-12);
    assert_close(z.per_year, 2e-3 * pow(0.3, -1.7), 1e-8);
}

TEST(beyond_the_last_point_of_the_hazard_all_events_lose_what_they_lose_there)
{
    const double x[] = {1, 4}, loss[] = {0.2, 0.8}, hazard[] = {0.5, 0.1, 2, 0.025}; /* 0.05 / x, L = 0.2 x */
    const AnnualLoss y = annual_loss(2, x, loss, 2, hazard);
    assert_close(y.above, 0.4 * 0.025, 1e-12);
    assert_close(y.per_year, 0.2 * 0.05 * (1 + log(4)), 1e-12);
    assert_close(y.below, 0.2 * 0.05 * log(2), 1e-12);
    const AnnualLoss low = annual_loss(1, (double[]){0.2}, (double[]){0.7}, 2, hazard);
    assert_close(low.per_year, 0.7 * 0.1, 1e-12);
    assert_close(low.at_begin, low.per_year, 1e-12);
    assert_at_most(low.below, 0);
}

/* Of two records one loses nothing and one fails: the mean is the half of all, and so is its standard error. */
TEST(a_simulation_that_failed_has_lost_the_whole_building)
{
    static EvaluatedRun run[3];
    EvaluatedRecord record[3] = {{0}, {.readable = STATUS_BAD_DATA}, {0}};
    const double level = 0.1, hazard[] = {0.1, 0.02, 1, 0.001};
    const Evaluations e = {.n_records = 3, .n_levels = 1, .record = record, .level = &level, .run = run, .n_read = 2};
    for (int i = 0; i < 3; i++)
        run[i].result[SCENE_RIGID] = (SimResult){.n_floors = 1, .outcome = i == 2 ? RUN_NOT_FINITE : RUN_OK};
    const AnnualLoss y = ida_annual_loss(&e, SCENE_RIGID, 2, hazard);
    assert_close(y.per_year, 0.02 / 2, 1e-12);
    assert_close(y.error, 0.02 / 2, 1e-12);
    assert_int_equal(y.n_failed, 1);
}

/* -- consequences -------------------------------------------------------------------------------------------------- */

TEST(a_state_begins_at_its_median_where_it_is_as_likely_as_not)
{
    assert_int_equal(damage_state(PART_STRUCTURE, 0.0059), 0);
    assert_string_equal(damage_word(damage_state(PART_STRUCTURE, 0.0213)), "moderate");
    assert_string_equal(damage_word(damage_state(PART_DRIFT, 0.0213)), "moderate");
    assert_string_equal(damage_word(damage_state(PART_ACCELERATION, 11)), "complete");
    for (DamagedPart p = 0; p < N_PARTS; p++) {
        const struct DamagePart *d = &DAMAGE_PARTS[p];
        double before = 0;
        for (int s = 0; s < DAMAGE_STATES; s++) { /* half of a step at its median, by the chances of the others */
            double cost = 0, last = 0;
            for (int k = 0; k < DAMAGE_STATES; k++) {
                const double z = log(d->median[s] / d->median[k]) / d->beta;
                cost += (k == s ? 0.5 : 0.5 * (1 + erf(z / sqrt(2)))) * (d->cost[k] - last);
                last = d->cost[k];
            }
            assert_close(damage_cost(p, d->median[s]), cost, 1e-12);
            assert_less(before, cost);
            before = cost;
        }
    }
}

/* Nothing moves: nothing is lost. Everything is beyond repair: the three parts are the whole building. */
TEST(the_loss_lies_between_nothing_and_the_whole_building)
{
    SimResult r = {.n_floors = 3, .repair = {0.192, 0.329, 0.479}};
    char text[DAMAGE_WORDS_MAX];
    assert_at_most(damage_loss(&r), 0);
    for (int j = 0; j < 3; j++)
        r.drift_ratio[j] = r.drift_ratio_max = 1e3, r.peak_acceleration_g[j] = r.j3_g = 1e5;
    assert_close(damage_loss(&r), 1, 1e-9);
    assert_close(measured(&r).value[MEASURE_LOSS], 1, 1e-9);
    assert_non_null(strstr(damage_words(&r, text), "parts sensitive to acceleration: beyond complete"));
    r.drift_ratio_max = 2.5e-7;
    assert_non_null(strstr(damage_words(&r, text), "steel frame: none (0.0000250 %)"));
    r.drift_ratio[1] = r.drift_ratio[2] = 0;
    assert_close(damage_loss(&r), (0.192 + 0.329) / 3 + 0.479, 1e-9);
    r.repair = (RepairOptions){0.1, 0.2, 0.6};
    assert_close(damage_loss(&r), (0.1 + 0.2) / 3 + 0.6, 1e-9);
}

/* -- as a command -------------------------------------------------------------------------------------------------- */
#define SUITE_LIST "evaluate @/tower.ini --design @/chance:knee --record @/three_list.txt "
#define CURVES     SUITE_LIST "--sa 0.1:0.1:0.6 --fragility 'drift_ratio=0.012,drift_ratio<=0.02,j3_g=0.5' "

static const json_t *curve_of(const json_t *o, const char *of, const char *scene)
{
    size_t i;
    json_t *c;
    json_array_foreach(json_object_get(o, "fragility"), i, c)
    {
        if (strcmp(json_string_value(json_object_get(c, "of")), of) == 0 &&
            strcmp(json_string_value(json_object_get(c, "scene")), scene) == 0)
            return c;
    }
    return NULL;
}

/* Of a word of a picture [px], downwards. */
static double height_of(const char *svg, const char *word)
{
    double y = NAN;
    const char *at = strstr(svg, brief(">%s</tspan>", word));
    while (at && at > svg && strncmp(at, "translate(", 10) != 0)
        at--;
    if (!at || sscanf(at, "translate(%*f,%lf)", &y) != 1)
        fail_msg("%s is not in the picture", word);
    return y;
}

/* No row of the key is as low as the first title of a panel, below which its frame begins. */
static void expect_key_above_the_panels(void)
{
    free(output_of(CURVES "--svg @/curves.svg"));
    FREED char *svg = read_in_place("curves.svg");
    const double title = height_of(svg, "drift_ratio &gt; 0.012");
    FOR_EACH (const char *, word, "with core", "rigidly connected", "without core", "viscous links")
        assert_less(height_of(svg, *word), title - 10);
    const char *height = strstr(svg, "height=\"");
    assert_non_null(height);
    assert_less(title + 300, strtod(height + 8, NULL)); /* [px] the panels are on the picture */
}

/* L of a record in the middle of many short pieces of the hazard curve of the test, 0.001 / x to 0.1 g, then 0.0001 /
 * x^2 to 1 g. */
static double lost_in_a_year(const double loss[6])
{
    enum { PIECES = 20000 };
    double sum = loss[5] * 0.0001, before = 0.1;
    for (int i = 1; i <= PIECES; i++) {
        const double x = 0.01 * pow(100, (double)i / PIECES), at = 0.01 * pow(100, (i - 0.5) / PIECES);
        const double rate = x < 0.1 ? 0.001 / x : 0.0001 / (x * x);
        const int j = (int)fmin(at / 0.1, 6); /* levels below */
        const double from = j > 0 ? loss[j - 1] : 0, to = loss[j < 6 ? j : 5];
        sum += (from + (to - from) * (at / 0.1 - j)) * (before - rate);
        before = rate;
    }
    return sum;
}

static void expect_annual_losses(const json_t *o, const char *const scenes[4])
{
    for (size_t c = 0; c < 4; c++) {
        const json_t *row = json_array_get(json_object_get(o, "annual_loss"), c);
        double year[3], mean, sd;
        assert_string_equal(json_string_value(json_object_get(row, "scene")), scenes[c]);
        for (size_t r = 0; r < 3; r++) {
            double loss[6];
            for (size_t l = 0; l < 6; l++)
                loss[l] = number(json_object_get(json_array_get(json_object_get(o, "records"), 6 * r + l), scenes[c]),
                                 "loss");
            year[r] = lost_in_a_year(loss);
        }
        mean_and_sd_of(3, year, &mean, &sd);
        assert_close(number(row, "annual_loss"), mean, 1e-5);
        assert_close(number(row, "standard_error"), sd / sqrt(3), 1e-4);
    }
}

/* What was counted is what the rows of the records have; the building alone answers in proportion to Sa. */
TEST(curves_are_of_the_simulations_beside_them_and_links_are_the_same_everywhere)
{
    write_in_place("three_list.txt", "builtin:elcentro-like\nbuiltin:sylmar-like\nbuiltin:suite-03\n");
    write_in_place("hazard.csv", "sa_g,rate_per_year\n0.01,0.1\n0.1,0.01\n1,0.0001\n");
    json_auto_t *o = as_json(CURVES "--hazard @/hazard.csv --json");
    json_t *run;
    static const char *const KEYS[] = {"with_core", "no_core", "rigid", "links"};
    size_t i, n[4] = {0};
    double at_first[3], link = 0;
    json_array_foreach(json_object_get(o, "records"), i, run)
    {
        for (int c = 0; c < 4; c++)
            n[c] += number(json_object_get(run, KEYS[c]), "j3_g") > 0.5;
        const double j1 = number(json_object_get(run, "no_core"), "j1_m"), sa = number(run, "sa_g");
        assert_close(sa, 0.1 * (double)(i % 6 + 1), 1e-12);
        at_first[i / 6] = i % 6 == 0 ? j1 / sa : at_first[i / 6];
        assert_close(j1 / sa, at_first[i / 6], 1e-9);
        link = i == 0 ? number(json_object_get(run, "links"), "link_ns_m") : link;
        assert_same_number(number(json_object_get(run, "links"), "link_ns_m"), link);
    }
    assert_int_equal(i, 18);
    for (int c = 0; c < 4; c++) {
        const json_t *curve = curve_of(o, "j3_g", KEYS[c]), *exceeded = json_object_get(curve, "exceeded");
        size_t sum = 0;
        for (size_t l = 0; l < 6; l++)
            sum += (size_t)json_integer_value(json_array_get(exceeded, l));
        assert_int_equal(sum, n[c]);
        const json_t *rate = json_object_get(curve, "rate_per_year");
        if (json_is_number(rate)) /* of 0.01 g at most, and of the last intensity at least where all exceed it */
            assert_less(json_number_value(rate), 0.1);
    }
    expect_annual_losses(o, KEYS);
    FREED char *table = output_of(CURVES "--csv @/rows.csv --hazard @/hazard.csv"), *rows = read_in_place("rows.csv");
    assert_words(table, "per_year", "annual_loss", "begin lower"); /* than 0.1 g, of a hazard from 0.01 g */
    assert_words(rows, "record,scene,outcome,sa_g,pga_g,scale,");
    assert_text(output_of(CURVES "--csv -"), rows);
    if (has_browser())
        expect_key_above_the_panels();
}

#define ON_TWO "evaluate @/tower.ini --design @/chance:knee --record @/two_list.txt "

/* So begins the row of the building alone, whose rate is not known. */
static void expect_alone(const char *words, const char *range, const char *limit)
{
    FREED char *said = output_of(ON_TWO "--sa %s --fragility %s --hazard @/hazard.csv", range, limit);
    const char *row = strstr(said, "no core");
    char *end = row ? strchr(row, '\n') : NULL;
    assert_non_null(end);
    *end = 0;
    row += strlen("no core");
    row += strspn(row, " ");
    if (strncmp(row, words, strlen(words)) != 0)
        fail_msg("%s: not '%s'", row, words);
    assert_non_null(strstr(row, " -")); /* no rate */
}

TEST(intensities_that_are_too_far_apart_are_told_by_bounds_and_without_a_rate)
{
    write_in_place("two_list.txt", "builtin:elcentro-like\nbuiltin:sylmar-like\n");
    json_auto_t *o = as_json(ON_TWO "--sa 0.1 --json");
    const json_t *records = json_object_get(o, "records");
    double sum = 0; /* one of two exceeds the half of it at 0.1 g */
    for (size_t i = 0; i < 2; i++)
        sum += number(json_object_get(json_array_get(records, i), "no_core"), "j1_m");
    FREED char *limit = formatted("j1_m=%.9g", sum / 2);
    expect_alone("between 0.01 and 1.01: finer steps", "0.01:1:1.01", limit);
    expect_alone("between 0.01 and 0.19: finer steps", "0.01:0.09:0.2", limit);
    expect_alone("below 1: begin lower", "0.1:0.9:1", limit);
    expect_alone("above 0.01: end higher", "0.01:0.09:0.1", limit);
    expect_alone("never", "0.01:0.01:0.02", limit);
    expect_alone("always", "1:1:2", limit);
    expect_alone("- ", "0.1:0.9:1", "core_stress_pa=1");
}

TEST(one_spectral_acceleration_is_a_scaling_at_the_first_period_of_the_building)
{
    json_auto_t *o = as_json(SUITE_LIST "--sa 0.2 --json"), *b = as_json("building @/tower.ini --json");
    const json_t *hz = json_object_get(b, "building_hz");
    const double T = 1 / json_number_value(json_array_get(hz, 0));
    OWNED(motion_free) Motion m;
    CHECK_OK(motion_load(&m, "builtin:elcentro-like", UNIT_FROM_FILE, &err), &err);
    double at = 0;
    spectrum_psa(&m, 0.05, 1, &T, &at);
    assert_close(number(json_array_get(json_object_get(o, "records"), 0), "scale"), 0.2 * 9.81 / at, 1e-6);
    expect(2, "--sa and --pga do not go together", SUITE_LIST "--sa 0.2 --pga 0.3");
    expect(2, "--fragility needs intensities", SUITE_LIST "--sa 0.2 --fragility j3_g=1");
    expect(2, "is not a list of NAME=NUMBER", SUITE_LIST "--sa 0.1:0.1:0.2 --fragility j3_g");
    expect(2, "drift is no result", SUITE_LIST "--sa 0.1:0.1:0.2 --fragility drift=1");
    expect(2, "neither a probability nor annual_loss is a limit of one simulation",
           SUITE_LIST "--sa 0.1:0.1:0.2 --fragility limits");
    expect(65, "no storey yields", SUITE_LIST "--sa 0.1:0.1:0.2 --fragility ductility=2");
    write_in_place("pga.csv", "pga_g,rate_per_year\n0.01,0.1\n0.1,0.01\n");
    write_in_place("up.csv", "sa_g,rate_per_year\n0.01,0.1\n0.1,0.2\n");
    expect(65, "pga.csv: needs columns sa_g and rate_per_year with at least two rows", CURVES "--hazard @/pga.csv");
    expect(65, "up.csv:3: intensities must rise, and their rates fall", CURVES "--hazard @/up.csv");
}

#define FOLDER "evaluate @/tower.ini --design @/chance:knee --record @/some --sa 0.1:0.1:0.2 "

TEST(a_file_of_a_folder_that_cannot_be_read_is_listed_beside_the_levels_of_the_others)
{
    char motion[12000] = "time_s,acceleration_m_s2\n";
    for (int i = 0; i < 300; i++)
        append(motion, "%.2f,%.6f\n", 0.02 * i, sin(0.3 * i));
    write_in_place("some/a.txt", "no numbers here\n1 2 x\n");
    write_in_place("some/b.csv", motion);
    json_auto_t *o = as_json(FOLDER "--json");
    assert_int_equal(json_array_size(json_object_get(o, "unreadable")), 1);
    assert_int_equal(json_array_size(json_object_get(o, "records")), 2);
    free(output_of(FOLDER "--csv -"));
}

/* -- annual loss as an objective ----------------------------------------------------------------------------------- */

#define OF_YEARS                                                                                                       \
    "--set search.objectives=annual_loss,j3_g --set sim.robust=mean --set motion.pga_g=0 "                             \
    "--set 'motion.record=builtin:elcentro-like factor=0.5 rate=0.02' "
#define YEARS "@/tower.ini " OF_YEARS "--set motion.records=@/year_list.txt "

TEST(the_annual_loss_of_a_study_is_the_sum_over_its_records_of_rate_and_loss)
{
    static const char *const SOURCE[] = {"builtin:elcentro-like factor=0.5", "builtin:elcentro-like factor=1.5",
                                         "builtin:sylmar-like"};
    static const double RATE[] = {0.02, 0.003, 0.0007};
    double sum = 0;
    write_in_place("year_list.txt", "builtin:elcentro-like factor=0.5 rate=0.02\n# rarer\n"
                                    "builtin:elcentro-like factor=1.5 rate=0.003\nbuiltin:sylmar-like rate=7e-4\n");
    free(output_of("optimize " YEARS "--set search.fidelity=records --set 'search.limits=annual_loss<=0.01' "
                   "--out @/years"));
    for (int i = 0; i < 3; i++) {
        json_auto_t *o = as_json("simulate @/tower.ini --design @/years:knee --json --set motion.records=none --set "
                                 "motion.pga_g=0 --set 'motion.record=%s'",
                                 SOURCE[i]);
        assert_true(json_is_null(json_object_get(o, "annual_loss")));
        sum += RATE[i] * number(o, "loss");
    }
    json_auto_t *o = as_json("simulate " YEARS "--design @/years:knee --json");
    const json_t *mean = json_object_get(o, "replicates");
    assert_close(number(json_object_get(mean, "mean"), "annual_loss"), sum, 1e-12);
    assert_less(0, number(json_object_get(mean, "standard_error"), "annual_loss"));
    json_auto_t *parts = as_json("evaluate @/years --design knee --json"); /* every record by its part of the sum */
    for (size_t i = 0; i < 3; i++)
        sum -=
            number(json_object_get(json_array_get(json_object_get(parts, "records"), i), "with_core"), "annual_loss");
    assert_true(fabs(sum) < 1e-12);
    free(output_of("evaluate @/years --design knee --record builtin:suite-02")); /* without a rate */
}

TEST(an_annual_loss_without_its_rates_is_refused_with_what_to_do)
{
    write_in_place("year_list.txt", "builtin:suite-02 rate=0.02\n");
    expect(65, "motion.pga_g = 0.3: annual_loss (search.objectives or search.limits) wants every record as strong",
           "check @/tower.ini " OF_YEARS "--set motion.records=@/year_list.txt --set motion.pga_g=0.3 "
           "--set 'motion.record=builtin:suite-01 rate=0.02'");
    write_in_place("year_list.txt", "builtin:suite-02 factor=0.4 rate=0\n");
    expect(65, "year_list.txt:1", "simulate " YEARS "--design @/years:knee --json");
    write_in_place("year_list.txt", "builtin:suite-02 rate=0.02\nbuiltin:suite-03 factor=2\n");
    expect(65, "year_list.txt:2: motion.records: builtin:suite-03 factor=2: annual_loss wants the events of a year",
           "optimize " YEARS "--out @/no");
    expect(65,
           "motion.records: builtin:suite-03: annual_loss wants the events of a year that every record stands for: "
           "write rate=NUMBER behind it",
           "check @/tower.ini " OF_YEARS "--set motion.records=builtin:suite-03");
    expect(65, "motion.record: builtin:suite-01: annual_loss wants",
           "check " YEARS "--set motion.record=builtin:suite-01");
    write_in_place("year_list.txt", "builtin:suite-02 rate=0.02\n");
    expect(65, "sim.robust: annual_loss (search.objectives or search.limits) is a sum over the records",
           "check " YEARS "--set sim.robust=worst");
    expect(65, "set sim.robust = mean", "check " YEARS "--set sim.robust=0.9");
    expect(65, "set sim.robust = mean",
           "check @/tower.ini --set 'search.limits=annual_loss<=0.1' --set sim.robust=cvar");
    expect(65, "p(annual_loss>0.01): annual_loss is a sum over records, no result of one simulation",
           "check " YEARS "--set 'search.objectives=j3_g,p(annual_loss>0.01)'");
    expect(2, "neither a probability nor annual_loss is a limit of one simulation",
           SUITE_LIST "--sa 0.1:0.1:0.2 --fragility annual_loss=0.1");
}

/* -- records that speak for the rest ------------------------------------------------------------------------------- */

enum { WORLD_RECORDS = 24, WORLD_DESIGNS = 40, WORLD_OBJECTIVES = 2 };

/* Designs with two factors: most records show the first, some the second, all with noise; those at `clear` show their
 * factor without. */
typedef struct {
    double y[WORLD_DESIGNS][WORLD_RECORDS];
} World;

static void make_world(World *w, uint32_t seed, const size_t clear[2])
{
    for (size_t i = 0; i < WORLD_DESIGNS; i++) {
        Random random = random_stream(seed, RANDOM_TEST, 1, (uint32_t)i);
        const double factor[2] = {random_normal(&random), random_normal(&random)};
        for (size_t r = 0; r < WORLD_RECORDS; r++) {
            const double noise = r == clear[0] || r == clear[1] ? 0 : 2;
            w->y[i][r] = factor[r == clear[1] || (r != clear[0] && r % 3 == 0)] + noise * random_normal(&random);
        }
    }
}

/* Mean, and a number that no record tells apart. */
static void means(size_t n, const size_t records[], double y[], void *user)
{
    const World *w = user;
    for (size_t i = 0; i < WORLD_DESIGNS; i++) {
        y[i * WORLD_OBJECTIVES] = 0;
        y[i * WORLD_OBJECTIVES + 1] = 7;
        for (size_t r = 0; r < n; r++)
            y[i * WORLD_OBJECTIVES] += w->y[i][records[r]] / (double)n;
    }
}

TEST(the_records_that_show_the_factors_of_the_designs_are_seen_first)
{
    static World w;
    size_t order[WORLD_RECORDS], found = 0;
    assert_int_equal(race_first(9), 1);
    assert_int_equal(race_first(15), 3);
    assert_int_equal(race_first(WORLD_RECORDS), 4);
    assert_int_equal(race_first(44), 4);
    for (uint32_t seed = 0; seed < 50; seed++) {
        const size_t clear[2] = {seed % 12, 12 + seed % 12};
        size_t seen[WORLD_RECORDS] = {0};
        make_world(&w, seed, clear);
        CHECK_OK(race_order(WORLD_RECORDS, WORLD_DESIGNS, WORLD_OBJECTIVES, means, &w, order, &err), &err);
        for (size_t i = 0; i < WORLD_RECORDS; i++)
            seen[order[i]]++;
        for (size_t i = 0; i < WORLD_RECORDS; i++)
            assert_int_equal(seen[i], 1);
        for (size_t i = 0; i < race_first(WORLD_RECORDS); i++)
            found += order[i] == clear[0] || order[i] == clear[1];
    }
    assert_less(75, (double)found); /* of 100; four records at random: 16 or 17 */
}

/* ---- hand-over --------------------------------------------------------------------------------------------------- */

static const double *column_of(const Table *t, const char *name)
{
    const int c = table_column(t, name);
    if (c < 0)
        fail_msg("no column %s", name);
    return t->values + c;
}

/* By pelicun's rules: EVENT-TYPE-PLACE-DIRECTION above, units in the first row, then samples from 0. */
TEST(demands_for_pelicun_have_a_row_per_record_and_read_back_as_they_were_printed)
{
    static const char HEAD[] = ",1-PFA-0-1,1-PFA-1-1,1-PFA-2-1,1-PFA-3-1,1-PFA-4-1,1-PFA-5-1,1-PFA-6-1,1-PID-1-1,"
                               "1-PID-2-1,1-PID-3-1,1-PID-4-1,1-PID-5-1,1-PID-6-1\n"
                               "Units,g,g,g,g,g,g,g,unitless,unitless,unitless,unitless,unitless,unitless\n0,";
    json_auto_t *o = as_json(SUITE_LIST "--pga 0.3 --pelicun @/pelicun.csv --json");
    char *text = read_in_place("pelicun.csv"), *row = text + strlen(HEAD) - 2;
    assert_true(strncmp(text, HEAD, strlen(HEAD)) == 0);
    for (int i = 0; i < 3; i++) {
        const json_t *r = json_object_get(json_array_get(json_object_get(o, "records"), (size_t)i), "with_core");
        assert_int_equal(strtol(row, &row, 10), i);
        assert_close(strtod(row + 1, &row), 0.3, 1e-12);
        for (size_t j = 0; j < 6; j++)
            assert_same_number(strtod(row + 1, &row),
                               json_real_value(json_array_get(json_object_get(r, "peak_acceleration_g"), j)));
        for (size_t j = 0; j < 6; j++)
            assert_same_number(strtod(row + 1, &row),
                               json_real_value(json_array_get(json_object_get(r, "peak_drift_ratio"), j)));
        assert_int_equal(*row++, '\n');
    }
    assert_int_equal(*row, 0);
    free(text);
    free(output_of(SUITE_LIST "--pga 0.3 --pelicun @/response.csv"));
    OWNED(table_free) Table t = table_of("response.csv");
    const json_t *third = json_object_get(json_array_get(json_object_get(o, "records"), 2), "with_core");
    assert_int_equal(t.n_rows, 3);
    assert_int_equal(t.n_cols, 2 + 3 * 6 + 1);
    const size_t last = 2 * t.n_cols;
    assert_close(column_of(&t, "id")[last], 3, 0);
    assert_close(column_of(&t, "1-PFA-0-1")[last], 0.3 * 9.81, 1e-12);
    const double roof = json_real_value(json_array_get(json_object_get(third, "peak_displacement_m"), 5));
    assert_close(column_of(&t, "1-PFD-6-1")[last], roof, 1e-12);
    assert_close(column_of(&t, "1-PRD-1-1")[last], roof / (4 + 5 * 3.5), 1e-9);
    expect(2, "--pelicun writes one intensity", SUITE_LIST "--pga 0.1:0.1:0.2 --pelicun @/no.csv");
}

TEST(an_event_for_simcenter_is_read_back_as_the_motion_that_it_is_of)
{
    free(output_of("spectrum builtin:kobe-like --pga 0.3 --history @/event.json"));
    OWNED(motion_free) Motion m, again;
    CHECK_OK(motion_load(&again, there("event.json"), UNIT_FROM_FILE, &err), &err);
    CHECK_OK(motion_load(&m, "builtin:kobe-like", UNIT_FROM_FILE, &err), &err);
    assert_int_equal(again.n, m.n);
    assert_close(again.dt_s, m.dt_s, 1e-15);
    assert_close(motion_peak(&again), 0.3 * 9.81, 1e-12);
    for (size_t i = 0; i < m.n; i++)
        assert_true(fabs(again.accel[i] - m.accel[i] * 0.3 * 9.81 / motion_peak(&m)) < 1e-12);
}

SUITE(make_place, clear_place)
