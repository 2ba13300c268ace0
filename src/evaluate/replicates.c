#include "evaluate/replicates.h"

#include <math.h>
#include <stdlib.h>

#include "base/random.h"
#include "base/stat.h"
#include "sim/as_built.h"

enum { PARTS_MAX = 16 * 1000 }; /* records and replicates that the settings allow */

void replicate_design(uint32_t seed, size_t k, double tolerance_m, size_t n_gaps, double x[])
{
    Random random = random_stream(seed, RANDOM_REPLICATE, 0, (uint32_t)k);
    for (size_t j = 0; k > 0 && j < n_gaps; j++) {
        const double tiny = random_normal(&random), error = random_normal(&random);
        x[j] = fmax(x[j] * (1.0 + REPLICATE_CHANGE * tiny) + tolerance_m * error, 0.0);
    }
}

int is_uncertain(const UncertainOptions *u)
{
    return u->restitution > 0 || u->contact_stiffness > 0 || u->core_stiffness > 0 || u->building_stiffness > 0 ||
           u->damping > 0;
}

const char *spread_word(double tolerance_m, const UncertainOptions *u)
{
    return tolerance_m > 0 || is_uncertain(u) ? "as built" : "predictability";
}

static double draw_factor(Random *random, double sd)
{
    const double s = sqrt(log1p(sd * sd));
    return exp(s * random_normal(random) - 0.5 * s * s);
}

AsBuilt replicate_as_built(uint32_t seed, size_t k, const UncertainOptions *u)
{
    Random random = random_stream(seed, RANDOM_REPLICATE, 1, (uint32_t)k);
    AsBuilt b = AS_DESIGNED;
    if (k == 0)
        return b;
    b.restitution = u->restitution * random_normal(&random);
    b.contact_stiffness = draw_factor(&random, u->contact_stiffness);
    b.core_stiffness = draw_factor(&random, u->core_stiffness);
    b.building_stiffness = draw_factor(&random, u->building_stiffness);
    b.core_damping = draw_factor(&random, u->damping);
    b.building_damping = draw_factor(&random, u->damping);
    return b;
}

/* Simulation i in the order of the records, then of their replicates. */
static const SimResult *result_of(const ReplicatePlan *plan, const SimResult results[], size_t i)
{
    return &results[i % plan->n_replicates * plan->n_records + i / plan->n_replicates];
}

typedef struct {
    const ReplicatePlan *plan;
    const SimResult *results;
    size_t first; /* simulation of the record */
    int measure;
} Sample;

static double value_of(size_t i, const void *user)
{
    const Sample *s = user;
    return measure_value(result_of(s->plan, s->results, s->first + i), s->measure);
}

static int by_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

double robust_pooled(const ReplicatePlan *plan, double sense, size_t n, double v[], double *sd)
{
    double mean;
    mean_and_sd_of(n, v, &mean, sd);
    if (plan->rule == ROBUST_MEAN_PLUS_SD || !isfinite(mean))
        return isfinite(*sd) ? mean + sense * *sd : mean;
    qsort(v, n, sizeof *v, by_value);
    const double place = (sense > 0 ? plan->quantile : 1 - plan->quantile) * (double)(n - 1);
    const size_t below = (size_t)place, above = below + 1 < n ? below + 1 : below;
    return v[below] + (place - (double)below) * (v[above] - v[below]);
}

/* Measure k over all simulations, by a rule that knows no records. */
static void combine_all(const ReplicatePlan *plan, const SimResult results[], int k, double *value, double *sd)
{
    double v[PARTS_MAX];
    const size_t n = plan->n_records * plan->n_replicates;
    for (size_t i = 0; i < n; i++)
        v[i] = measure_value(result_of(plan, results, i), k);
    *value = robust_pooled(plan, measure(k)->sense, n, v, sd);
}

/* Measure k over the records. */
static void combine_records(const ReplicatePlan *plan, const SimResult results[], int k, double *value, double *sd)
{
    const double sense = measure(k)->sense, n = (double)plan->n_records;
    *value = *sd = 0.0;
    for (size_t r = 0; r < plan->n_records; r++) {
        double mean, deviation;
        const Sample sample = {plan, results, r * plan->n_replicates, k};
        mean_and_sd(plan->n_replicates, value_of, &sample, &mean, &deviation);
        if (plan->rule == ROBUST_MEAN) {
            *value += mean / n;
            *sd += deviation * deviation / n;
        } else if (r == 0 || sense * mean > sense * *value) {
            *value = mean;
            *sd = deviation * deviation;
        }
    }
    *sd = sqrt(*sd);
}

void replicates_summarise(const ReplicatePlan *plan, const SimResult results[], ReplicateSummary *out)
{
    static const char *const RULES[] = {"worst", "mean", "mean + sd", "quantile"};
    const int is_mean = plan->rule == ROBUST_WORST && plan->n_records == 1;
    *out = (ReplicateSummary){.shown = results,
                              .rule = RULES[is_mean ? ROBUST_MEAN : plan->rule],
                              .spread = plan->spread,
                              .n_records = plan->n_records,
                              .n_replicates = plan->n_replicates};
    for (size_t i = plan->n_records * plan->n_replicates; i-- > 0;) {
        const SimResult *r = result_of(plan, results, i);
        out->seconds += r->seconds;
        if (r->outcome != RUN_OK) {
            out->shown = r;
            out->n_failed++;
        }
    }
    out->outcome = measure_outcome(out->shown->outcome);
    const int has_records = plan->rule == ROBUST_WORST || plan->rule == ROBUST_MEAN;
    for (int k = 0; k < N_MEASURES; k++)
        (has_records ? combine_records : combine_all)(plan, results, k, &out->mean[k], &out->sd[k]);
}
