#include "moga/searching.h"

#include <math.h>

#include "moga/dominance.h"
#include "moga/order.h"

/* Kendall's tau below which the surface no longer leads, and how much one batch counts in its running mean. */
static const double LEAST_AGREEMENT = 0.15, AGREEMENT_WEIGHT = 0.25;
/* Where descents end so far off their directions (sine of the angle, median), the front has not the shape of a simplex:
 * from OFF_LEAST on simulations are chosen by rays too, from OFF_MOST on mostly. One generation's weight in the mean.
 */
static const double OFF_LEAST = 0.15, OFF_MOST = 0.35, RAYS_MOST = 0.85, OFF_WEIGHT = 0.2;

/* Surface and plain children share a batch by this power of what each gained per simulation; whoever gained less gets
 * the LEAST_SHARE-th part. So few plain children tell little about their gain: it has to be greater by DOUBT. One
 * generation's weight in the mean. */
static const double CREDIT_WEIGHT = 0.1, CREDIT_POWER = 8.0, DOUBT = 1.3;
enum { LEAST_SHARE = 16, ALONE = 18 /* simulations for each variable that the surface has alone */ };

/* A surface costs wall time; with it a search needs a fifth of the simulations of a plain one, mostly less
 * (docs/search.md). It therefore pays as long as its time for one simulation is below that of PAYS simulations. */
static const double PAYS = 4.0;
enum { COST_SAMPLE = 60 }; /* simulations chosen by the surface, before costs are weighed */

/* Once, when enough has been timed: a surface that costs more wall time per simulation than PAYS simulations steps
 * aside. The decision is part of the state, so that a search that goes on keeps it. */
void guide_weigh_costs(Search *s)
{
    if (s->config->surrogate != SURROGATE_AUTO || s->aside != ASIDE_OPEN || s->n_guided < COST_SAMPLE)
        return;
    const double simulation = s->simulating_s / (double)s->n_timed, own = s->guided_s / (double)s->n_guided;
    s->aside = own > PAYS * simulation ? ASIDE_YES : ASIDE_NO;
}

int guide_may_lead(const Search *s)
{
    return s->config->surrogate != SURROGATE_OFF && s->aside != ASIDE_YES;
}

/* Whether the surface leads: it explains its own data, and what it foretold of late batches came in that order. */
int guide_leads(const Search *s)
{
    return guide_may_lead(s) && surface_stands(s->surface) && s->agreement > LEAST_AGREEMENT;
}

/* Part of a batch that is chosen by rays, the rest by PBI: PBI is the better guide where every direction meets the
 * front, but where most of them miss it, rays measure what a design adds to the hypervolume whatever the front's shape.
 */
double guide_rays(const Search *s)
{
    return RAYS_MOST * fmin(fmax((s->off - OFF_LEAST) / (OFF_MOST - OFF_LEAST), 0.0), 1.0);
}

/* How far off their directions this generation's descents by PBI end, as the surface sees them. */
void guide_judge_directions(Search *s)
{
    const size_t first = s->offspring.n - s->n_followed, n = s->n_followed - s->n_followed_rays;
    for (size_t j = 0; j < n; j++) {
        const size_t i = s->n_followed_rays + j;
        s->apart[j] =
            infill_off(s->infill[INFILL_PBI], s->followed[i], s->offspring.F + (first + i) * s->problem->n_obj);
    }
    sort_numbers(n, s->apart);
    s->off += OFF_WEIGHT * (s->apart[n / 2] - s->off);
}

int guide_trusts(const Search *s, const Group *g, size_t i)
{
    return guide_leads(s) && g->uncertainty[i] < s->config->trust_error;
}

/* Each source's share of what the results gained: the length of the rays that they dominate and the front that the
 * generation began with does not. */
static void judge_sources(Search *s)
{
    double gain[SOURCES] = {0}, number[SOURCES] = {0};
    for (size_t i = 0; i < s->n_came; i++) {
        if (s->kind[i] != KIND_INFILL && s->kind[i] != KIND_OFFSPRING)
            continue;
        const Source source = s->kind[i] == KIND_INFILL ? SOURCE_SURFACE : SOURCE_PLAIN;
        gain[source] += s->ok[i] ? infill_gain(s->gained, s->F + i * s->problem->n_obj) : 0.0;
        number[source] += 1.0;
    }
    const double all = gain[SOURCE_SURFACE] + gain[SOURCE_PLAIN];
    if (!(all > 0.0) || number[SOURCE_SURFACE] == 0.0 || number[SOURCE_PLAIN] == 0.0)
        return;
    for (int k = 0; k < SOURCES; k++) {
        s->credit[k] += CREDIT_WEIGHT * (gain[k] / all - s->credit[k]);
        s->chance[k] += CREDIT_WEIGHT * (number[k] / (number[SOURCE_SURFACE] + number[SOURCE_PLAIN]) - s->chance[k]);
    }
}

/* Whoever gained more per simulation has nearly all of the batch, the other one a design at least; none before a
 * surface can have saturated. */
size_t guide_plain(const Search *s)
{
    const size_t batch = batch_size(s), least = batch / LEAST_SHARE + 1;
    if (s->archive.n < ALONE * s->problem->n_var)
        return 0;
    const double plain = pow(s->credit[SOURCE_PLAIN] / s->chance[SOURCE_PLAIN] / DOUBT, CREDIT_POWER);
    const double surface = pow(s->credit[SOURCE_SURFACE] / s->chance[SOURCE_SURFACE], CREDIT_POWER);
    const size_t wanted = (size_t)(plain / (plain + surface) * (double)batch + 0.5);
    return wanted < least ? least : wanted < batch - least ? wanted : batch - least;
}

/* How far the surface foretold the order of the results that came, in the mean over the objectives. */
void guide_judge(Search *s)
{
    const size_t m = s->problem->n_obj;
    size_t n = 0;
    double mean = 0.0;
    judge_sources(s);
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
    Infill *const all[] = {s->infill[INFILL_PBI], s->infill[INFILL_RAYS], s->gained};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        if (s->archive.n_front > 0)
            infill_measure(all[i], s->archive.n_front, s->archive.front, s->archive.estimate);
        else
            infill_measure(all[i], s->population.n, s->chosen, s->population.F);
}

/* -- the surface, timed ---------------------------------------------------------------------------------------------
 */

Status guide_fit(Search *s, Err *err)
{
    const double before = search_seconds(s);
    const Status status = surface_fit(s->surface, &s->archive, s->infill[INFILL_PBI], err);
    s->surrogate_s += search_seconds(s) - before;
    return status;
}

void guide_predict(Search *s, Group *group, size_t first, int with_uncertainty)
{
    const double before = search_seconds(s);
    surface_predict(s->surface, group, first, with_uncertainty);
    s->surrogate_s += search_seconds(s) - before;
}

void guide_descend(Search *s, InfillKind kind, size_t n, const size_t directions[], double X[])
{
    const double before = search_seconds(s);
    surface_descend(s->surface, &s->archive, s->infill[kind], n, directions, X);
    s->surrogate_s += search_seconds(s) - before;
}
