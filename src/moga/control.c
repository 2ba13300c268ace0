#include "moga/control.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "evaluate/evaluation.h"
#include "moga/constants.h"

void control_begin(SurrogateControl *c)
{
    *c = (SurrogateControl){.agreement = 1.0, .probe_share = PROBE_SHARE};
}

void control_pack(SurrogateControl *c, Pack *p, size_t n_obj)
{
    pack_numbers(p, &c->agreement, 1, -1.0, 1.0);
    pack_numbers(p, &c->failure_rate, 1, 0.0, 1.0);
    pack_numbers(p, &c->probe_share, 1, 0.0, fmax(PROBE_SHARE, PROBE_PAY));
    pack_size(p, &c->n_kept, AGREEMENT_RESULTS_MIN - 1);
    pack_numbers(p, c->F, c->n_kept * n_obj, -DBL_MAX, DBL_MAX);
    pack_numbers(p, c->predicted, c->n_kept * n_obj, -DBL_MAX, DBL_MAX);
}

int control_agrees(const SurrogateControl *c)
{
    return c->agreement > AGREEMENT_MIN;
}

size_t control_variation(const SurrogateControl *c, size_t size)
{
    return (size_t)(c->failure_rate * (double)size + 0.5);
}

double control_probe_share(const SurrogateControl *c)
{
    return fmin(c->probe_share, PROBE_SHARE_MAX);
}

/* -- results of a batch -------------------------------------------------------------------------------------------- */

static void learn_failures(SurrogateControl *c, const BatchResults *r)
{
    double infill = 0.0, failed = 0.0;
    for (size_t i = 0; i < r->n; i++) {
        infill += r->kind[i] == KIND_INFILL;
        failed += r->kind[i] == KIND_INFILL && !r->ok[i];
    }
    if (infill > 0.0)
        c->failure_rate += AGREEMENT_WEIGHT * (failed / infill - c->failure_rate);
}

static void learn_probes(SurrogateControl *c, const BatchResults *r)
{
    for (size_t i = 0; i < r->n; i++) {
        double better = 0.0;
        if (!r->is_probe[i] || !r->was_predicted[i] || !r->ok[i])
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

void control_judge(SurrogateControl *c, const BatchResults *r)
{
    double tau = 0.0;
    learn_failures(c, r);
    learn_probes(c, r);
    keep_results(c, r);
    if (c->n_kept < AGREEMENT_RESULTS_MIN)
        return;
    for (size_t k = 0; k < r->n_obj; k++)
        tau += kendall_tau(c, r->n_obj, k) / (double)r->n_obj;
    c->agreement += AGREEMENT_WEIGHT * (tau - c->agreement);
    c->n_kept = 0;
}
