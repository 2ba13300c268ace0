#include "moga/searching.h"

#include <math.h>

#include "moga/dominance.h"

void guide_begin(Search *s)
{
    s->agreement = 1.0;
    s->sources = (Rivals){{1.0 - VARIATION_CREDIT_FIRST, VARIATION_CREDIT_FIRST},
                          {1.0 - VARIATION_CHANCE_FIRST, VARIATION_CHANCE_FIRST}};
    s->ways = (Rivals){{0.5, 0.5}, {0.5, 0.5}};
}

/* Once, when enough has been timed: a surface that costs more wall time per simulation than COST_MAX simulations steps
 * aside. The decision is part of the state, so that a search that goes on keeps it. */
void guide_weigh_costs(Search *s)
{
    if (s->config->surrogate != SURROGATE_AUTO || s->aside != ASIDE_OPEN || s->n_guided < COST_SAMPLE)
        return;
    const double simulation = s->simulating_s / (double)s->n_timed, own = s->guided_s / (double)s->n_guided;
    s->aside = own > COST_MAX * simulation ? ASIDE_YES : ASIDE_NO;
}

int guide_may_lead(const Search *s)
{
    return s->config->surrogate != SURROGATE_OFF && s->aside != ASIDE_YES;
}

/* Whether the surface leads: it explains its own data, and what it foretold of late batches came in that order. */
int guide_leads(const Search *s)
{
    return guide_may_lead(s) && surrogate_is_usable(s->surrogate) && s->agreement > AGREEMENT_MIN;
}

/* Second one's part of what both share. */
static double second_share(const Rivals *r, double power, double doubt)
{
    const double first = pow(r->credit[0] / r->chance[0], power),
                 second = pow(r->credit[1] / r->chance[1] / doubt, power);
    return first + second > 0.0 ? second / (first + second) : 0.5;
}

/* PBI is the better guide where the surface foretells the front so well that directions can be kept to, rays where it
 * is work to reach the front at all or where it has not the shape of a simplex. */
double guide_rays(const Search *s)
{
    const double least = 1.0 / (double)batch_size(s); /* one design, so that more is learnt of both */
    return fmin(fmax(second_share(&s->ways, CRITERION_POWER, 1.0), least), 1.0 - least);
}

int guide_trusts(const Search *s, const Population *g, size_t i)
{
    return guide_leads(s) && g->uncertainty[i] < s->config->trust_error;
}

/* gain[measure][rival] of number[rival] results: the shares of both, in the mean over the measures. Nothing is learnt
 * where one had no result or nobody gained. */
static void learn(Rivals *r, double gain[INFILL_KINDS][2], const double number[2])
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
        r->credit[i] += CREDIT_WEIGHT * (share[i] / measures - r->credit[i]);
        r->chance[i] += CREDIT_WEIGHT * (number[i] / (number[0] + number[1]) - r->chance[i]);
    }
}

/* By what the results gained over the front that the generation began with. */
static void judge_rivals(Search *s)
{
    double by_source[INFILL_KINDS][2] = {{0}}, by_way[INFILL_KINDS][2] = {{0}}, of_source[2] = {0}, of_way[2] = {0};
    double failed = 0.0;
    for (size_t i = 0; i < s->n_came; i++) {
        const int is_infill = s->kind[i] == KIND_INFILL;
        if (!is_infill && s->kind[i] != KIND_OFFSPRING)
            continue;
        const Source source = is_infill ? SOURCE_SURFACE : SOURCE_PLAIN;
        of_source[source] += 1.0;
        of_way[s->way[i]] += is_infill;
        failed += is_infill && !s->ok[i];
        for (int k = 0; k < INFILL_KINDS && s->ok[i]; k++) {
            const double gain = infill_gain(s->gained[k], s->F + i * s->problem->n_obj);
            by_source[k][source] += gain;
            by_way[k][s->way[i]] += is_infill ? gain : 0.0;
        }
    }
    if (of_source[SOURCE_SURFACE] > 0.0)
        s->lost += CREDIT_WEIGHT * (failed / of_source[SOURCE_SURFACE] - s->lost);
    learn(&s->sources, by_source, of_source);
    learn(&s->ways, by_way, of_way);
}

/* Whoever gained more per simulation has nearly all of the batch, the other one a design at least; none before a
 * surface can have saturated. */
size_t guide_plain(const Search *s)
{
    const size_t batch = batch_size(s), least = batch / VARIATION_SHARE_MIN + 1;
    const size_t lost = (size_t)(s->lost * (double)batch + 0.5); /* as many as of the surface's own would fail */
    if (s->archive.n < INFILL_ALONE * s->problem->n_var)
        return lost;
    const size_t credited =
        (size_t)(second_share(&s->sources, GENERATOR_POWER, VARIATION_MARGIN) * (double)batch + 0.5);
    const size_t wanted = credited > lost ? credited : lost;
    return wanted < least ? least : wanted < batch - least ? wanted : batch - least;
}

/* Kendall's tau of the columns a[i stride], b[i stride]: pairs in the same order minus pairs in the opposite one, as a
 * share of the pairs whose rows are both ok; 0 where there is none. */
static double kendall_tau(size_t n, size_t stride, const double a[], const double b[], const unsigned char ok[])
{
    long same = 0, pairs = 0;
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < i; j++) {
            const double product = (a[i * stride] - a[j * stride]) * (b[i * stride] - b[j * stride]);
            if (!ok[i] || !ok[j])
                continue;
            same += (product > 0.0) - (product < 0.0);
            pairs++;
        }
    return pairs > 0 ? (double)same / (double)pairs : 0.0;
}

/* How far the surface foretold the order of the results that came, in the mean over the objectives. */
void guide_judge(Search *s)
{
    const size_t m = s->problem->n_obj;
    size_t n = 0;
    double mean = 0.0;
    judge_rivals(s);
    for (size_t i = 0; i < s->n_came; i++) {
        n += s->foretold[i];
        s->foretold[i] &= s->ok[i];
    }
    if (n < 4)
        return;
    for (size_t k = 0; k < m; k++)
        mean += kendall_tau(s->n_came, m, s->foreseen + k, s->F + k, s->foretold) / (double)m;
    s->agreement += AGREEMENT_WEIGHT * (mean - s->agreement);
}

/* The front to be improved; where nothing is feasible yet, the population. */
void guide_measure_front(Search *s)
{
    for (size_t i = 0; i < s->population.n; i++)
        s->chosen[i] = i;
    Infill *const all[] = {s->infill[INFILL_PBI], s->infill[INFILL_HYPERVOLUME], s->gained[INFILL_PBI],
                           s->gained[INFILL_HYPERVOLUME]};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        if (s->archive.n_front > 0)
            infill_measure(all[i], s->archive.n_front, s->archive.front, s->archive.estimate);
        else
            infill_measure(all[i], s->population.n, s->chosen, s->population.F);
}

/* -- the surface, timed -------------------------------------------------------------------------------------------- */

Status guide_fit(Search *s, Err *err)
{
    const double before = search_seconds(s);
    const Status status = surrogate_fit(s->surrogate, &s->archive, s->infill[INFILL_PBI], err);
    s->surrogate_s += search_seconds(s) - before;
    return status;
}

int guide_expects_failure(const Search *s, const double x[])
{
    const Problem *p = s->problem;
    const Archive *a = &s->archive;
    double least[FAILURE_NEIGHBOURS];
    int failed[FAILURE_NEIGHBOURS] = {0}, any = 0;
    for (int k = 0; k < FAILURE_NEIGHBOURS; k++)
        least[k] = INFINITY;
    for (size_t row = 0; a->n_failed > 0 && row < a->n; row++) {
        double square = 0.0;
        if (a->replicates[row] == 0)
            continue;
        for (size_t d = 0; d < p->n_var; d++) {
            const double width = p->upper[d] - p->lower[d], off = x[d] - a->X[row * p->n_var + d];
            square += width > 0.0 ? off * off / (width * width) : 0.0;
        }
        int k = FAILURE_NEIGHBOURS; /* into its place among the nearest */
        for (; k > 0 && square < least[k - 1]; k--)
            if (k < FAILURE_NEIGHBOURS) {
                least[k] = least[k - 1];
                failed[k] = failed[k - 1];
            }
        if (k < FAILURE_NEIGHBOURS) {
            least[k] = square;
            failed[k] = !a->usable[row];
        }
    }
    for (int k = 0; k < FAILURE_NEIGHBOURS; k++)
        any |= failed[k];
    return any;
}

/* The surface knows nothing of failures: what is expected to fail counts as infeasible, the last to be chosen. */
static void expect_failures(const Search *s, Population *g, size_t first)
{
    if (s->archive.n_failed == 0)
        return;
#pragma omp parallel for schedule(static)
    for (size_t i = first; i < g->n; i++)
        if (g->row[i] == PREDICTED)
            g->violation[i] += guide_expects_failure(s, g->X + i * g->n_var);
}

void guide_predict(Search *s, Population *group, size_t first, int with_uncertainty)
{
    const double before = search_seconds(s);
    surrogate_predict(s->surrogate, group, first, with_uncertainty);
    if (surrogate_is_usable(s->surrogate))
        expect_failures(s, group, first);
    s->surrogate_s += search_seconds(s) - before;
}

void guide_descend(Search *s, InfillKind kind, size_t n, const size_t directions[], double X[])
{
    const double before = search_seconds(s);
    surrogate_descend(s->surrogate, &s->archive, s->infill[kind], n, directions, X);
    s->surrogate_s += search_seconds(s) - before;
}
