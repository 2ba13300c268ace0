#include "moga/noise.h"

NoiseModel noise_fit(size_t n, const size_t rows[], const size_t replicates[], size_t n_obj, size_t k,
                     const double mean[], const double S[])
{
    double freedom = 0.0, squares = 0.0, relative = 0.0, logs = 0.0;
    for (size_t i = 0; i < n; i++) {
        const size_t at = rows[i] * n_obj + k;
        const double nu = (double)replicates[rows[i]] - 1.0, square = mean[at] * mean[at];
        if (!(square > 0.0) && !(S[at] > 0.0)) /* always 0: the same likelihood in both */
            continue;
        freedom += nu;
        squares += S[at];
        relative += S[at] / square;
        logs += nu * log(square);
    }
    if (!(squares > 0.0))
        return (NoiseModel){0.0, 0};
    /* -2 log-likelihood: sum nu (1 + log v); a mean of 0 rules the relative model out */
    const int is_relative = isfinite(relative) && isfinite(logs) &&
                            freedom * log(relative / freedom) + logs < freedom * log(squares / freedom);
    return (NoiseModel){sqrt((is_relative ? relative : squares) / freedom), is_relative};
}

double noise_variance(const NoiseModel *model, double mean, double S, size_t replicates)
{
    const double sd = model->is_relative ? model->sd * mean : model->sd;
    return (sd * sd + S) / (double)replicates;
}
