#include "evaluate/replicates.h"

#include "base/random.h"
#include "base/stat.h"

enum { PARTS_MAX = TOWER_RECORDS_MAX * 1000 }; /* records and replicates that the settings allow */

/* Streams of the random numbers. */
enum { OF_GAPS, OF_STRUCTURE, OF_LEFT_GAPS, OF_BOOTSTRAP };

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
    size_t first;        /* simulation of the record */
    const size_t *drawn; /* (n_records) records in the place of those; NULL: themselves */
} Sample;

static size_t part_of(const ReplicatePlan *plan, size_t i)
{
    return i % plan->n_replicates * plan->n_records + i / plan->n_replicates;
}

/* Simulation i in the order of the records, then of their replicates. */
static const Measured *simulation(const Sample *s, size_t i)
{
    const size_t n = s->plan->n_replicates;
    i = s->drawn ? s->drawn[i / n] * n + i % n : i;
    return (const Measured *)(const void *)(s->parts + part_of(s->plan, i) * s->size);
}

static double value_of(const Sample *s, size_t i)
{
    return simulation(s, s->first + i)->value[s->measure];
}

/* v (n) sorted by sense: the first are the worst. */
static double mean_of_worst(double share, double sense, size_t n, const double v[])
{
    const double wanted = fmax(share * (double)n, 1.0);
    double sum = 0.0;
    for (size_t i = 0; i < n && (double)i < wanted; i++)
        sum += fmin(wanted - (double)i, 1.0) * v[sense > 0 ? n - 1 - i : i];
    return sum / wanted;
}

double robust_pooled(const ReplicatePlan *plan, double sense, size_t n, double v[], double *sd)
{
    double mean;
    mean_and_sd_of(n, v, &mean, sd);
    if (plan->rule == ROBUST_MEAN_PLUS_SD || !isfinite(mean))
        return isfinite(*sd) ? mean + sense * *sd : mean;
    sort_values(n, v);
    if (plan->rule == ROBUST_CVAR)
        return mean_of_worst(1.0 - plan->quantile, sense, n, v);
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

static void combine_measure(Sample *s, int k, double *value, double *sd)
{
    const Robust rule = s->plan->rule;
    const ReplicatePlan mean = {s->plan->n_records, s->plan->n_replicates, ROBUST_MEAN_PLUS_SD, 0, NULL};
    double v[PARTS_MAX];
    s->measure = k;
    s->first = 0;
    if (k < MEASURES_LISTED) {
        (rule == ROBUST_WORST || rule == ROBUST_MEAN ? combine_records : combine_all)(s, value, sd);
        return;
    }
    for (size_t i = 0; i < mean.n_records * mean.n_replicates; i++)
        v[i] = value_of(s, i);
    mean_and_sd_of(mean.n_records * mean.n_replicates, v, value, sd);
}

void replicates_errors(const ReplicatePlan *plan, const void *parts, size_t size, ReplicateSummary *out)
{
    size_t drawn[TOWER_RECORDS_MAX];
    double sum[N_MEASURES] = {0}, squares[N_MEASURES] = {0}, value, sd;
    Sample sample = {.plan = plan, .parts = parts, .size = size, .drawn = drawn};
    for (size_t b = 0; b < BOOTSTRAP && plan->n_records > 1; b++) {
        Random random = random_stream(0, RANDOM_REPLICATE, OF_BOOTSTRAP, (uint32_t)b);
        for (size_t r = 0; r < plan->n_records; r++)
            drawn[r] = random_below(&random, plan->n_records);
        for (int k = 0; k < N_MEASURES; k++) {
            combine_measure(&sample, k, &value, &sd);
            sum[k] += value - out->mean[k];
            squares[k] += (value - out->mean[k]) * (value - out->mean[k]);
        }
    }
    for (int k = 0; k < N_MEASURES; k++) {
        const double square = (squares[k] - sum[k] * sum[k] / BOOTSTRAP) / (BOOTSTRAP - 1);
        out->error[k] = plan->n_records > 1 ? sqrt(square < 0 ? 0 : square) : NAN;
    }
}

void replicates_summarise(const ReplicatePlan *plan, const void *parts, size_t size, ReplicateSummary *out)
{
    static const char *const RULES[] = {"worst", "mean", "mean + sd", "cvar", "quantile"};
    const int is_mean = plan->rule == ROBUST_WORST && plan->n_records == 1;
    Sample sample = {.plan = plan, .parts = parts, .size = size};
    *out = (ReplicateSummary){.rule = RULES[is_mean ? ROBUST_MEAN : plan->rule],
                              .spread = plan->n_records > 1 && plan->rule > ROBUST_MEAN ? "over records" : plan->spread,
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
    for (int k = 0; k < N_MEASURES; k++) {
        combine_measure(&sample, k, &out->mean[k], &out->sd[k]);
        out->error[k] = NAN;
    }
}
