#include "simulator/replicates.h"

#include <math.h>

#include "base/random.h"
#include "base/stat.h"

void replicate_design(uint32_t seed, size_t k, double tolerance_m, size_t n_gaps, double x[])
{
    Random random = random_stream(seed, RANDOM_REPLICATE, 0, (uint32_t)k);
    for (size_t j = 0; k > 0 && j < n_gaps; j++) {
        const double tiny = random_normal(&random), error = random_normal(&random);
        x[j] = fmax(x[j] * (1.0 + REPLICATE_CHANGE * tiny) + tolerance_m * error, 0.0);
    }
}

typedef struct {
    const SimResult *results; /* of one record */
    int measure;
} Sample;

static double value_of(size_t i, const void *user)
{
    const Sample *s = user;
    return measure_value(&s->results[i], s->measure);
}

/* Measure k over the records. */
static void combine_records(const ReplicatePlan *plan, const SimResult results[], int k, double *value, double *sd)
{
    const double sense = measure(k)->sense, n = (double)plan->n_records;
    *value = *sd = 0.0;
    for (size_t r = 0; r < plan->n_records; r++) {
        double mean, deviation;
        mean_and_sd(plan->n_replicates, value_of, &(Sample){results + r * plan->n_replicates, k}, &mean, &deviation);
        if (plan->takes_mean) {
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
    *out = (ReplicateSummary){.shown = results, .n_replicates = plan->n_replicates};
    for (size_t i = plan->n_records * plan->n_replicates; i-- > 0;) {
        out->seconds += results[i].seconds;
        if (!measures_are_known(&results[i], plan->judged)) {
            out->shown = &results[i];
            out->n_failed++;
        }
    }
    const int is_lost = out->n_failed > 0 && out->shown->outcome == RUN_OK;
    out->outcome = is_lost ? OUTCOME_NOT_FINITE : measure_outcome(out->shown->outcome);
    out->reason = is_lost ? "an objective or a limited result is not finite" : out->shown->reason;
    for (int k = 0; k < N_MEASURES; k++)
        combine_records(plan, results, k, &out->mean[k], &out->sd[k]);
}
