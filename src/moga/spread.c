#include "moga/spread.h"

#include <math.h>

Spread spread_fit(size_t n, const size_t rows[], const size_t answers[], size_t n_obj, size_t k, const double mean[],
                  const double S[])
{
    double freedom = 0.0, squares = 0.0, relative = 0.0, logs = 0.0;
    for (size_t i = 0; i < n; i++) {
        const size_t at = rows[i] * n_obj + k;
        const double nu = (double)answers[rows[i]] - 1.0, square = mean[at] * mean[at];
        if (!(square > 0.0) && !(S[at] > 0.0)) /* always 0: says nothing for either model */
            continue;
        freedom += nu;
        squares += S[at];
        relative += S[at] / square;
        logs += nu * log(square);
    }
    if (!(squares > 0.0))
        return (Spread){0.0, 0};
    /* -2 log-likelihood: sum nu (1 + log v); a mean of 0 makes the share no model at all */
    const int is_share = isfinite(relative) && isfinite(logs) &&
                         freedom * log(relative / freedom) + logs < freedom * log(squares / freedom);
    return (Spread){sqrt((is_share ? relative : squares) / freedom), is_share};
}

double spread_variance(const Spread *s, double mean, double S, size_t answers)
{
    const double deviation = s->is_share ? s->deviation * mean : s->deviation;
    return (deviation * deviation + S) / (double)answers;
}

void spread_estimate(size_t n, const size_t rows[], const double e[], size_t n_obj, size_t k, const double mean[],
                     const double error[], double estimate[])
{
    double surplus = 0.0;
    for (size_t i = 0; i < n; i++) {
        const double own = error[rows[i] * n_obj + k];
        surplus += (e[i] * e[i] - own * own) / (double)n;
    }
    for (size_t i = 0; i < n; i++) {
        const size_t at = rows[i] * n_obj + k;
        const double square = error[at] * error[at],
                     share = square > 0.0 ? square / (square + fmax(surplus, 0.0)) : 0.0;
        estimate[at] = mean[at] - fmin(fmax(share * e[i], -error[at]), error[at]);
    }
}
