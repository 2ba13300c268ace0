#include "evaluate/replicates.h"

#include "base/random.h"
#include "base/stat.h"

enum { PARTS_MAX = TOWER_RECORDS_MAX * 1000 }; /* records and replicates that the settings allow */

/* Streams of the random numbers. */
enum { OF_GAPS, OF_STRUCTURE, OF_LEFT_GAPS };

static void change_gaps(Random random, size_t k, double tolerance_m, size_t n_gaps, double x[])
{
    for (size_t j = 0; k > 0 && j < n_gaps; j++) {
        const double tiny = random_normal(&random), error = random_normal(&random);
        x[j] = fmax(x[j] * (1.0 + REPLICATE_CHANGE * tiny) + tolerance_m * error, 0.0);
    }
}

void replicate_design(uint32_t seed, size_t k, double tolerance_m, size_t n_gaps, double x[])
{
    change_gaps(random_stream(seed, RANDOM_REPLICATE, OF_GAPS, (uint32_t)k), k, tolerance_m, n_gaps, x);
}

void replicate_gaps(uint32_t seed, size_t k, double tolerance_m, const DesignSpace *s, Design *d)
{
    const size_t n = s->n_floors;
    replicate_design(seed, k, tolerance_m, n, d->gap[0]);
    if (s->gap_sides == GAPS_BOTH)
        memcpy(d->gap[1], d->gap[0], n * sizeof *d->gap[0]);
    else
        change_gaps(random_stream(seed, RANDOM_REPLICATE, OF_LEFT_GAPS, (uint32_t)k), k, tolerance_m, n, d->gap[1]);
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
    Random random = random_stream(seed, RANDOM_REPLICATE, OF_STRUCTURE, (uint32_t)k);
    AsBuilt b = AS_DESIGNED;
    if (k == 0)
        return b;
    b.restitution = u->restitution * random_normal(&random);
    b.contact_stiffness = draw_factor(&random, u->contact_stiffness);
    b.core_stiffness = draw_factor(&random, u->core_stiffness);
    b.building_stiffness = draw_factor(&random, u->building_stiffness);
    b.core_damping = draw_factor(&random, u->damping);
    b.building_damping = draw_factor(&random, u->damping);
    b.ground_stiffness = draw_factor(&random, u->ground_stiffness);
    b.strength = draw_factor(&random, u->strength);
    return b;
}

typedef struct {
    const ReplicatePlan *plan;
    const char *parts;
    size_t size;
    int measure;
    size_t first; /* simulation of the record */
} Sample;

static size_t part_of(const ReplicatePlan *plan, size_t i)
{
    return i % plan->n_replicates * plan->n_records + i / plan->n_replicates;
}

/* Simulation i in the order of the records, then of their replicates. */
static const Measured *simulation(const Sample *s, size_t i)
{
    return (const Measured *)(const void *)(s->parts + part_of(s->plan, i) * s->size);
}

static double value_of(const Sample *s, size_t i)
{
    return simulation(s, s->first + i)->value[s->measure];
}

double robust_pooled(const ReplicatePlan *plan, double sense, size_t n, double v[], double *sd)
{
    double mean;
    mean_and_sd_of(n, v, &mean, sd);
    if (plan->rule == ROBUST_MEAN_PLUS_SD || !isfinite(mean))
        return isfinite(*sd) ? mean + sense * *sd : mean;
    sort_values(n, v);
    const double place = (sense > 0 ? plan->quantile : 1 - plan->quantile) * (double)(n - 1);
    const size_t below = (size_t)place, above = below + 1 < n ? below + 1 : below;
    return v[below] + (place - (double)below) * (v[above] - v[below]);
}

/* Measure over all simulations, by a rule that knows no records. */
static void combine_all(Sample *s, double *value, double *sd)
{
    double v[PARTS_MAX];
    const size_t n = s->plan->n_records * s->plan->n_replicates;
    for (size_t i = 0; i < n; i++)
        v[i] = value_of(s, i);
    *value = robust_pooled(s->plan, measure(s->measure)->sense, n, v, sd);
}

/* Measure over the records. */
static void combine_records(Sample *s, double *value, double *sd)
{
    const double sense = measure(s->measure)->sense, n = (double)s->plan->n_records;
    *value = *sd = 0.0;
    for (size_t r = 0; r < s->plan->n_records; r++) {
        double mean, deviation, v[PARTS_MAX];
        s->first = r * s->plan->n_replicates;
        for (size_t i = 0; i < s->plan->n_replicates; i++)
            v[i] = value_of(s, i);
        mean_and_sd_of(s->plan->n_replicates, v, &mean, &deviation);
        if (s->plan->rule == ROBUST_MEAN) {
            *value += mean / n;
            *sd += deviation * deviation / n;
        } else if (r == 0 || sense * mean > sense * *value) {
            *value = mean;
            *sd = deviation * deviation;
        }
    }
    *sd = sqrt(*sd);
    s->first = 0;
}

void replicates_summarise(const ReplicatePlan *plan, const void *parts, size_t size, ReplicateSummary *out)
{
    static const char *const RULES[] = {"worst", "mean", "mean + sd", "quantile"};
    const int is_mean = plan->rule == ROBUST_WORST && plan->n_records == 1;
    Sample sample = {.plan = plan, .parts = parts, .size = size};
    *out = (ReplicateSummary){.rule = RULES[is_mean ? ROBUST_MEAN : plan->rule],
                              .spread = plan->spread,
                              .n_records = plan->n_records,
                              .n_replicates = plan->n_replicates};
    for (size_t i = plan->n_records * plan->n_replicates; i-- > 0;) {
        const Measured *m = simulation(&sample, i);
        out->seconds += m->seconds;
        if (m->outcome != RUN_OK) {
            out->shown = part_of(plan, i);
            out->outcome = measure_outcome(m->outcome);
            out->n_failed++;
        }
    }
    const int has_records = plan->rule == ROBUST_WORST || plan->rule == ROBUST_MEAN;
    for (sample.measure = 0; sample.measure < N_MEASURES; sample.measure++)
        (has_records ? combine_records : combine_all)(&sample, &out->mean[sample.measure], &out->sd[sample.measure]);
}
