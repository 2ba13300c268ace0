#include "evaluate/replicates.h"

#include "base/random.h"
#include "base/stat.h"
#include "motion/suite.h"

enum { PARTS_MAX = TOWER_RECORDS_MAX * 1000 }; /* records and replicates that the settings allow */

/* Streams of the random numbers. */
enum { OF_GAPS, OF_STRUCTURE, OF_LEFT_GAPS, OF_BOOTSTRAP };

void replicate_design(uint32_t seed, int is_left, size_t k, double tolerance_m, size_t n_gaps, double x[])
{
    Random random = random_stream(seed, RANDOM_REPLICATE, is_left ? OF_LEFT_GAPS : OF_GAPS, (uint32_t)k);
    for (size_t j = 0; k > 0 && j < n_gaps; j++) {
        const double tiny = random_normal(&random), error = random_normal(&random);
        x[j] = fmax(x[j] * (1.0 + REPLICATE_CHANGE * tiny) + tolerance_m * error, 0.0);
    }
}

void replicate_gaps(uint32_t seed, size_t k, double tolerance_m, const DesignSpace *s, Design *d)
{
    const size_t n = s->n_floors;
    replicate_design(seed, 0, k, tolerance_m, n, d->gap[0]);
    if (s->gap_sides == GAPS_BOTH)
        copy_values(n, d->gap[0], d->gap[1]);
    else
        replicate_design(seed, 1, k, tolerance_m, n, d->gap[1]);
}

ReplicatePlan replicate_plan(const SimOptions *o, size_t n_records)
{
    return (ReplicatePlan){.n_records = n_records,
                           .n_replicates = o->replicates,
                           .rule = o->quantile > 0 ? ROBUST_QUANTILE : o->robust,
                           .quantile = o->quantile > 0 ? o->quantile : 1 - o->tail,
                           .spread = spread_word(o->gap_tolerance_m, &o->uncertain)};
}

double replicate_rate(const ReplicatePlan *plan, const char *record)
{
    Source source;
    const int is_summed = plan->n_records == 1 || plan->rule == ROBUST_MEAN;
    return is_summed && source_read(record, &source, NULL) == STATUS_OK ? source.rate * (double)plan->n_records : 0;
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

/* Of simulation i in the order of the records, then of their replicates. */
static size_t part_of(const ReplicatePlan *plan, size_t i)
{
    return i % plan->n_replicates * plan->n_records + i / plan->n_replicates;
}

double robust_pooled(const ReplicatePlan *plan, double sense, size_t n, double v[], double *sd)
{
    double mean;
    mean_and_sd_of(n, v, &mean, sd);
    if (plan->rule == ROBUST_MEAN_PLUS_SD || !isfinite(mean))
        return isfinite(*sd) ? mean + sense * *sd : mean;
    sort_values(n, v);
    if (plan->rule == ROBUST_CVAR) { /* the mean of the worst share, the last of them counted in part */
        const double wanted = fmax((1.0 - plan->quantile) * (double)n, 1.0);
        double sum = 0.0;
        for (size_t i = 0; i < n && (double)i < wanted; i++)
            sum += fmin(wanted - (double)i, 1.0) * v[sense > 0 ? n - 1 - i : i];
        return sum / wanted;
    }
    const double place = (sense > 0 ? plan->quantile : 1 - plan->quantile) * (double)(n - 1);
    const size_t below = (size_t)place, above = below + 1 < n ? below + 1 : below;
    return v[below] + (place - (double)below) * (v[above] - v[below]);
}

/* Measure k of a design by the rule of its plan. v (n_records, n_replicates): its values, which are sorted; drawn
 * (n_records): the records in the place of those, NULL: themselves. */
static void combine_measure(const ReplicatePlan *plan, int k, const double values[], const size_t drawn[],
                            double *value, double *sd)
{
    const size_t n_records = plan->n_records, n = plan->n_replicates;
    const double sense = measure(k)->sense;
    double v[PARTS_MAX];
    for (size_t r = 0; r < n_records; r++)
        copy_values(n, values + (drawn ? drawn[r] : r) * n, v + r * n);

    /* 1. Chances are means of all simulations; other rules know no records either, but for the mean and the worst. */
    if (k >= MEASURES_LISTED) {
        mean_and_sd_of(n_records * n, v, value, sd);
        return;
    }
    if (plan->rule != ROBUST_WORST && plan->rule != ROBUST_MEAN) {
        *value = robust_pooled(plan, sense, n_records * n, v, sd);
        return;
    }

    /* 2. The mean of each record, then over the records. */
    *value = *sd = 0.0;
    for (size_t r = 0; r < n_records; r++) {
        double mean, deviation;
        mean_and_sd_of(n, v + r * n, &mean, &deviation);
        if (plan->rule == ROBUST_MEAN) {
            *value += mean / (double)n_records;
            *sd += deviation * deviation / (double)n_records;
        } else if (r == 0 || sense * mean > sense * *value) {
            *value = mean;
            *sd = deviation * deviation;
        }
    }
    *sd = sqrt(*sd);
}

void replicates_summarise(const ReplicatePlan *plan, const void *parts, size_t size, int wants_errors,
                          ReplicateSummary *out)
{
    static const char *const RULES[] = {"worst", "mean", "mean + sd", "cvar", "quantile"};
    const int is_mean = plan->rule == ROBUST_WORST && plan->n_records == 1;
    const size_t n = plan->n_records * plan->n_replicates;
    const size_t n_suites = wants_errors && plan->n_records > 1 ? BOOTSTRAP : 0;
    size_t drawn[BOOTSTRAP][TOWER_RECORDS_MAX];
    double values[PARTS_MAX];
    *out = (ReplicateSummary){.rule = RULES[is_mean ? ROBUST_MEAN : plan->rule],
                              .spread = plan->n_records > 1 && plan->rule > ROBUST_MEAN ? "over records" : plan->spread,
                              .n_records = plan->n_records,
                              .n_replicates = plan->n_replicates};

    /* 1. What failed first. */
    for (size_t i = n; i-- > 0;) {
        const size_t part = part_of(plan, i);
        const Measured *m = measured_part(parts, size, part);
        out->seconds += m->seconds;
        if (m->outcome != RUN_OK) {
            out->shown = part;
            out->outcome = (Outcome)m->outcome;
            out->n_failed++;
        }
    }

    /* 2. Suites of records for the bootstrap. */
    for (size_t b = 0; b < n_suites; b++) {
        Random random = random_stream(0, RANDOM_REPLICATE, OF_BOOTSTRAP, (uint32_t)b);
        for (size_t r = 0; r < plan->n_records; r++)
            drawn[b][r] = random_below(&random, plan->n_records);
    }

    /* 3. Every measure, and its deviation over the suites. */
    for (int k = 0; k < N_MEASURES; k++) {
        double sum = 0, squares = 0, value, sd;
        for (size_t i = 0; i < n; i++)
            values[i] = measured_part(parts, size, part_of(plan, i))->value[k];
        combine_measure(plan, k, values, NULL, &out->mean[k], &out->sd[k]);
        for (size_t b = 0; b < n_suites; b++) {
            combine_measure(plan, k, values, drawn[b], &value, &sd);
            sum += value - out->mean[k];
            squares += (value - out->mean[k]) * (value - out->mean[k]);
        }
        const double square = (squares - sum * sum / BOOTSTRAP) / (BOOTSTRAP - 1);
        out->error[k] = n_suites > 0 ? sqrt(square < 0 ? 0 : square) : NAN;
    }
}
