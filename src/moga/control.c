#include "moga/control.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "moga/constants.h"

void control_begin(SurrogateControl *c)
{
    *c = (SurrogateControl){.agreement = 1.0,
                            .probe_share = PROBE_SHARE,
                            .generators = {{1.0 - VARIATION_CREDIT_FIRST, VARIATION_CREDIT_FIRST},
                                           {1.0 - VARIATION_CHANCE_FIRST, VARIATION_CHANCE_FIRST}},
                            .criteria = {{0.5, 0.5}, {0.5, 0.5}}};
}

void control_pack(SurrogateControl *c, Pack *p, size_t n_obj)
{
    pack_numbers(p, &c->agreement, 1, -1.0, 1.0);
    pack_numbers(p, &c->failure_rate, 1, 0.0, 1.0);
    pack_numbers(p, &c->probe_share, 1, 0.0, fmax(PROBE_SHARE, PROBE_PAY));
    for (int i = 0; i < 2; i++) {
        Credit *credit = i == 0 ? &c->generators : &c->criteria;
        pack_numbers(p, credit->gain, 2, 0.0, 1.0);
        pack_numbers(p, credit->designs, 2, DBL_MIN, 1.0);
    }
    pack_size(p, &c->n_kept, AGREEMENT_RESULTS_MIN - 1);
    pack_numbers(p, c->F, c->n_kept * n_obj, -DBL_MAX, DBL_MAX);
    pack_numbers(p, c->predicted, c->n_kept * n_obj, -DBL_MAX, DBL_MAX);
}

/* -- whether the surrogate is used --------------------------------------------------------------------------------- */

int control_agrees(const SurrogateControl *c)
{
    return c->agreement > AGREEMENT_MIN;
}

/* -- shares of a batch --------------------------------------------------------------------------------------------- */

/* Part of the second alternative, whose gain counts only by what it exceeds `margin` times the first one's. */
static double second_share(const Credit *r, double power, double margin)
{
    const double first = pow(r->gain[0] / r->designs[0], power),
                 second = pow(r->gain[1] / r->designs[1] / margin, power);
    return first + second > 0.0 ? second / (first + second) : 0.5;
}

/* Either generator gets batch / VARIATION_SHARE_MIN + 1 designs at least, so that its credit is known. */
static size_t variation_designs(const SurrogateControl *c, size_t size, size_t n, size_t n_var)
{
    const size_t min = size / VARIATION_SHARE_MIN + 1, failing = (size_t)(c->failure_rate * (double)size + 0.5);
    if (n < INFILL_ALONE * n_var)
        return failing;
    const double share = second_share(&c->generators, GENERATOR_POWER, VARIATION_MARGIN);
    const size_t credited = (size_t)(share * (double)size + 0.5), wanted = credited > failing ? credited : failing;
    return wanted < min ? min : wanted < size - min ? wanted : size - min;
}

BatchShares control_batch_shares(const SurrogateControl *c, size_t size, size_t n, size_t n_var)
{
    const double one = 1.0 / (double)size; /* either criterion gets a design at least */
    return (BatchShares){variation_designs(c, size, n, n_var),
                         fmin(fmax(second_share(&c->criteria, CRITERION_POWER, 1.0), one), 1.0 - one)};
}

double control_probe_share(const SurrogateControl *c)
{
    return fmin(fmax(c->probe_share, PROBE_SHARE_MIN), PROBE_SHARE_MAX);
}

/* -- results of a batch -------------------------------------------------------------------------------------------- */

/* gain[measure][alternative] of number[alternative] results: shares, in the mean over the measures. Nothing is learnt
 * where one alternative had no result or there was no gain. */
static void learn(Credit *r, double gain[INFILL_KINDS][2], const double number[2])
{
    double share[2] = {0}, measures = 0.0;
    for (int k = 0; k < INFILL_KINDS; k++) {
        const double all = gain[k][0] + gain[k][1];
        for (int i = 0; all > 0.0 && i < 2; i++)
            share[i] += gain[k][i] / all;
        measures += all > 0.0;
    }
    if (measures == 0.0 || number[0] == 0.0 || number[1] == 0.0)
        return;
    for (int i = 0; i < 2; i++) {
        r->gain[i] += CREDIT_WEIGHT * (share[i] / measures - r->gain[i]);
        r->designs[i] += CREDIT_WEIGHT * (number[i] / (number[0] + number[1]) - r->designs[i]);
    }
}

static void learn_credits(SurrogateControl *c, const BatchResults *r, Infill *const measure[INFILL_KINDS])
{
    double generator_gain[INFILL_KINDS][2] = {{0}}, criterion_gain[INFILL_KINDS][2] = {{0}};
    double by_generator[2] = {0}, by_criterion[2] = {0}, failed = 0.0;
    for (size_t i = 0; i < r->n; i++) {
        const int is_infill = r->kind[i] == KIND_INFILL;
        if ((!is_infill && r->kind[i] != KIND_OFFSPRING) || r->criterion[i] == CRITERION_NONE)
            continue;
        const Generator generator = is_infill ? GENERATOR_INFILL : GENERATOR_VARIATION;
        by_generator[generator] += 1.0;
        by_criterion[r->criterion[i]] += is_infill;
        failed += is_infill && !r->ok[i];
        for (int k = 0; k < INFILL_KINDS && r->ok[i]; k++) {
            const double gain = infill_gain(measure[k], r->F + i * r->n_obj);
            generator_gain[k][generator] += gain;
            criterion_gain[k][r->criterion[i]] += is_infill ? gain : 0.0;
        }
    }
    if (by_generator[GENERATOR_INFILL] > 0.0)
        c->failure_rate += CREDIT_WEIGHT * (failed / by_generator[GENERATOR_INFILL] - c->failure_rate);
    learn(&c->generators, generator_gain, by_generator);
    learn(&c->criteria, criterion_gain, by_criterion);
}

static void learn_probes(SurrogateControl *c, const BatchResults *r)
{
    for (size_t i = 0; i < r->n; i++) {
        double better = 0.0;
        if (r->kind[i] != KIND_OFFSPRING || r->criterion[i] != CRITERION_NONE || !r->was_predicted[i] || !r->ok[i])
            continue;
        for (size_t k = 0; k < r->n_obj; k++)
            better += (r->predicted[i * r->n_obj + k] - r->F[i * r->n_obj + k]) / r->range[k] / (double)r->n_obj;
        c->probe_share += PROBE_WEIGHT * ((better > PROBE_FIND ? PROBE_PAY : 0.0) - c->probe_share);
    }
}

/* Objective k of the results that are kept: pairs in the same order minus pairs in the opposite one, as a share of all
 * pairs. Kendall, Biometrika 30 (1938) 81-93. */
static double kendall_tau(const SurrogateControl *c, size_t n_obj, size_t k)
{
    long same = 0, pairs = 0;
    for (size_t i = 0; i < c->n_kept; i++)
        for (size_t j = 0; j < i; j++) {
            const double product = (c->predicted[i * n_obj + k] - c->predicted[j * n_obj + k]) *
                                   (c->F[i * n_obj + k] - c->F[j * n_obj + k]);
            same += (product > 0.0) - (product < 0.0);
            pairs++;
        }
    return (double)same / (double)pairs;
}

/* The predicted results that succeeded. */
static void keep_results(SurrogateControl *c, const BatchResults *r)
{
    const size_t m = r->n_obj;
    for (size_t i = 0; i < r->n; i++) {
        if (!r->was_predicted[i] || !r->ok[i])
            continue;
        memcpy(c->F + c->n_kept * m, r->F + i * m, m * sizeof *c->F);
        memcpy(c->predicted + c->n_kept * m, r->predicted + i * m, m * sizeof *c->predicted);
        c->n_kept++;
    }
}

void control_judge(SurrogateControl *c, const BatchResults *r, Infill *const gain[INFILL_KINDS])
{
    double tau = 0.0;
    learn_credits(c, r, gain);
    learn_probes(c, r);
    keep_results(c, r);
    if (c->n_kept < AGREEMENT_RESULTS_MIN)
        return;
    for (size_t k = 0; k < r->n_obj; k++)
        tau += kendall_tau(c, r->n_obj, k) / (double)r->n_obj;
    c->agreement += AGREEMENT_WEIGHT * (tau - c->agreement);
    c->n_kept = 0;
}
