#include "analysis/fragility.h"

#include <math.h>
#include <string.h>

static double normal_cdf(double z)
{
    return 0.5 * erfc(-z * M_SQRT1_2);
}

typedef struct {
    double gradient[2], information[3]; /* of a, b; aa, ab, bb */
} Score;

static Score score_of(size_t n, const double x[], const size_t n_at[], const size_t exceeded[], double a, double b)
{
    Score s = {{0}, {0}};
    for (size_t j = 0; j < n; j++) {
        const double l = log(x[j]), z = fmin(fmax(a + b * l, -8), 8);
        const double p = normal_cdf(z), q = normal_cdf(-z), density = exp(-0.5 * z * z) / sqrt(2 * M_PI);
        const double w = (double)n_at[j] * density * density / (p * q);
        const double g = density * ((double)exceeded[j] / p - ((double)n_at[j] - (double)exceeded[j]) / q);
        s.gradient[0] += g;
        s.gradient[1] += g * l;
        s.information[0] += w;
        s.information[1] += w * l;
        s.information[2] += w * l * l;
    }
    return s;
}

Fragility fragility_fit(size_t n, const double x[], const size_t n_at[], const size_t exceeded[])
{
    Fragility f = {NAN, NAN, NAN, NAN, {NAN, NAN}};
    double mean = 0, b = 2, some_stay = 0, some_exceed = INFINITY, between[2] = {0, INFINITY};
    for (size_t j = 0; j < n; j++) {
        const size_t stay = n_at[j] - exceeded[j];
        mean += log(x[j]) / (double)n;
        some_stay = stay > 0 ? fmax(some_stay, x[j]) : some_stay;
        some_exceed = exceeded[j] > 0 ? fmin(some_exceed, x[j]) : some_exceed;
        between[0] = stay > 0 && exceeded[j] == 0 ? fmax(between[0], x[j]) : between[0];
        between[1] = stay == 0 && exceeded[j] > 0 ? fmin(between[1], x[j]) : between[1];
    }

    /* 1. At most one intensity has both, none exceed below it, all above: the likelihood grows as beta falls to 0, and
     * says no more than that the median lies between the last that none exceed and the first that all do. */
    if (some_stay <= some_exceed) {
        memcpy(f.between, between, sizeof between);
        return f;
    }

    /* 2. Fisher scoring. */
    double a = -b * mean;
    Score s = {{0}, {0}};
    for (int i = 0; i < 200; i++) {
        s = score_of(n, x, n_at, exceeded, a, b);
        const double *h = s.information, det = h[0] * h[2] - h[1] * h[1];
        const double da = (h[2] * s.gradient[0] - h[1] * s.gradient[1]) / det;
        const double db = (h[0] * s.gradient[1] - h[1] * s.gradient[0]) / det;
        const double step = fmin(1, 1 / (fabs(da + db * mean) + fabs(db))); /* no further than a unit of z at once */
        a += step * da;
        b += step * db;
        if (fabs(da) + fabs(db) <= 1e-12 * (fabs(a) + fabs(b)))
            break;
    }
    if (!(b > 0)) /* rarer with intensity: no such curve */
        return f;
    s = score_of(n, x, n_at, exceeded, a, b);
    const double *h = s.information, det = h[0] * h[2] - h[1] * h[1];
    const double aa = h[2] / det, bb = h[0] / det, ab = -h[1] / det, u = -1 / b, v = a / (b * b);
    f.median = exp(-a / b);
    f.beta = 1 / b;
    f.sd_ln_median = sqrt(u * u * aa + 2 * u * v * ab + v * v * bb);
    f.sd_beta = sqrt(bb) / (b * b);
    return f;
}

double fragility_at(const Fragility *f, double x)
{
    return normal_cdf(log(x / f->median) / f->beta);
}

double fragility_rate(const Fragility *f, size_t n, const double hazard[])
{
    enum { PIECES = 200 };
    double rate = 0;
    for (size_t i = 0; i + 1 < n; i++) {
        const double *from = hazard + 2 * i, *to = from + 2, k = log(to[1] / from[1]) / log(to[0] / from[0]);
        for (int j = 0; j < PIECES; j++) {
            const double x = from[0] * pow(to[0] / from[0], (double)j / PIECES),
                         y = from[0] * pow(to[0] / from[0], (j + 1.0) / PIECES);
            rate += fragility_at(f, sqrt(x * y)) * from[1] * (pow(x / from[0], k) - pow(y / from[0], k));
        }
    }
    return rate + hazard[2 * n - 1] * fragility_at(f, hazard[2 * n - 2]);
}

/* L, by levels. */
static double loss_at(size_t n, const double x[], const double loss[], double at)
{
    size_t j = 0;
    while (j < n && x[j] < at)
        j++;
    if (j == n)
        return loss[n - 1];
    const double from = j > 0 ? x[j - 1] : 0, begin = j > 0 ? loss[j - 1] : 0;
    return begin + (loss[j] - begin) * (at - from) / (x[j] - from);
}

AnnualLoss annual_loss(size_t n, const double x[], const double loss[], size_t n_hazard, const double hazard[])
{
    const double *last = hazard + 2 * n_hazard - 2;
    AnnualLoss y = {.at_begin = hazard[1] * loss_at(n, x, loss, hazard[0]), .error = NAN};
    y.per_year = y.above = last[1] * loss_at(n, x, loss, last[0]);
    for (const double *row = hazard; row < last; row += 2) {
        const double k = log(row[3] / row[1]) / log(row[2] / row[0]);
        for (double a = row[0], b; a < row[2]; a = b) { /* to the next level or point */
            b = row[2];
            for (size_t j = n; j-- > 0;)
                b = x[j] > a && x[j] < b ? x[j] : b;
            /* L straight from `begin` at a to `end` at b, under lambda = rate (x / a)^k: by parts. */
            const double begin = loss_at(n, x, loss, a), end = loss_at(n, x, loss, b),
                         rate = row[1] * pow(a / row[0], k);
            const double e = k + 1, l = log(b / a), area = a * rate * (e != 0 ? expm1(e * l) / e : l);
            const double lost = begin * rate - end * rate * exp(k * l) + (end - begin) / (b - a) * area;
            y.per_year += lost;
            y.below += b <= x[0] ? lost : 0;
            y.above += a >= x[n - 1] ? lost : 0;
        }
    }
    return y;
}
