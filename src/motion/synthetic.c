#include "motion/synthetic.h"

#include "base/random.h"
#include "base/units.h"
#include "motion/spectrum.h"

static const double SECONDS = 40, DT_S = 0.02, LOWEST_HZ = 0.1, HIGHEST_HZ = 20, DAMPING = 0.05;
enum { CORRECTIONS = 8, WAVES = 5, SEED = 22 };

/* What is drawn of a motion, by streams of its number. */
enum { OF_TARGET, OF_ENVELOPE, OF_PHASES };

static Random stream(size_t i, uint32_t what)
{
    return random_stream(SEED, RANDOM_MOTION, what, (uint32_t)i);
}

double synthetic_target(double T)
{
    const double plateau = GRAVITY, begin = 0.12, end = 0.6;
    return plateau * (T < begin ? 0.4 + 0.6 * T / begin : T <= end ? 1 : end / T);
}

/* exp(eps_i) at period j: half of the variance is common to all periods, cosines of ln T have the rest. */
static double scatter(size_t i, size_t j)
{
    Random random = stream(i, OF_TARGET);
    double eps = sqrt(0.5) * random_normal(&random), left = 1;
    for (int m = 1; m < WAVES; m++) {
        left *= 0.5;
        eps += sqrt(left) * random_normal(&random) * cos(m * M_PI * (double)j / (SUITE_PERIODS - 1));
    }
    return exp(SUITE_SPREAD * eps);
}

/* Bands (SUITE_PERIODS, n): cosines about each period, with the amplitudes that a flat spectrum of unit height has but
 * for a factor. */
static void make_bands(size_t motion, size_t n, const double e[], double bands[])
{
    Random random = stream(motion, OF_PHASES);
    const double step = log(SUITE_LONGEST_S / SUITE_SHORTEST_S) / (SUITE_PERIODS - 1);
    for (long k = lround(LOWEST_HZ * SECONDS); k <= lround(HIGHEST_HZ * SECONDS); k++) {
        const double hz = (double)k / SECONDS, phase = 2 * M_PI * random_uniform(&random);
        const double at = fmin(fmax(-log(hz * SUITE_SHORTEST_S) / step, 0), SUITE_PERIODS - 1.000001);
        const size_t j = (size_t)at;
        const double share = (at - (double)j) / sqrt(hz), rest = (1 - (at - (double)j)) / sqrt(hz);
        const double turn = 2 * M_PI * hz * DT_S, c = cos(turn), s = sin(turn);
        double x = cos(phase), y = sin(phase), *band = bands + j * n;
        for (size_t i = 0; i < n; i++) {
            const double a = e[i] * x, next = c * x - s * y;
            y = s * x + c * y;
            x = next;
            band[i] += rest * a;
            band[n + i] += share * a;
        }
    }
}

/* Subtracts e (p + q t) such that the ground ends at rest where it began: of an acceleration that is linear between
 * samples and 0 at both ends, velocity and displacement at the end are those of sum a and of sum a t. */
static void end_at_rest(size_t n, const double e[], double a[])
{
    double s[3] = {0}, b[2] = {0};
    for (size_t k = 0; k < n; k++) {
        const double t = (double)k * DT_S;
        s[0] += e[k];
        s[1] += e[k] * t;
        s[2] += e[k] * t * t;
        b[0] += a[k];
        b[1] += a[k] * t;
    }
    const double det = s[0] * s[2] - s[1] * s[1];
    const double p = (b[0] * s[2] - b[1] * s[1]) / det, q = (s[0] * b[1] - s[1] * b[0]) / det;
    for (size_t k = 0; k < n; k++)
        a[k] -= e[k] * (p + q * (double)k * DT_S);
}

/* The sum of the bands whose spectrum is the motion's own target: each band is corrected by the ratio of both. */
static void fit(size_t i, const double bands[], Motion *m)
{
    double T[SUITE_PERIODS], psa[SUITE_PERIODS], factor[SUITE_PERIODS], target[SUITE_PERIODS];
    for (size_t j = 0; j < SUITE_PERIODS; j++) {
        double sum = 0;
        for (size_t other = 0; other < SUITE_MOTIONS; other++)
            sum += scatter(other, j) / SUITE_MOTIONS;
        T[j] = SUITE_SHORTEST_S * pow(SUITE_LONGEST_S / SUITE_SHORTEST_S, (double)j / (SUITE_PERIODS - 1));
        factor[j] = target[j] = synthetic_target(T[j]) * scatter(i, j) / sum;
    }
    for (int c = 0; c <= CORRECTIONS; c++) {
        memset(m->accel, 0, m->n * sizeof *m->accel);
        for (size_t j = 0; j < SUITE_PERIODS; j++)
            for (size_t k = 0; k < m->n; k++)
                m->accel[k] += factor[j] * bands[j * m->n + k];
        if (c == CORRECTIONS)
            break;
        spectrum_psa(m, DAMPING, SUITE_PERIODS, T, psa);
        for (size_t j = 0; j < SUITE_PERIODS; j++)
            factor[j] *= target[j] / psa[j];
    }
    for (size_t k = 0; k < m->n; k++)
        m->accel[k] = rint(m->accel[k] * 1e6) / 1e6;
}

Status synthetic_motion(Motion *m, size_t i, Err *err)
{
    const size_t n = lround(SECONDS / DT_S) + 1;
    double *e;
    TRY_ROOM(m->accel, n, "samples of a motion", err);
    if (!(e = calloc((SUITE_PERIODS + 1) * n, sizeof *e))) {
        free(m->accel);
        m->accel = NULL;
        return fail_memory(err, n, "samples of a motion");
    }
    m->n = n;
    m->dt_s = DT_S;

    /* The envelope, zero at both ends. */
    Random random = stream(i, OF_ENVELOPE);
    const double rise = 2 + 3 * random_uniform(&random), stay = 4 + 8 * random_uniform(&random),
                 decay = 3 + 3 * random_uniform(&random), taper = 6;
    for (size_t k = 0; k < n; k++) {
        const double t = (double)k * DT_S, over = t - rise - stay, left = SECONDS - t;
        e[k] = (t < rise ? t * t / (rise * rise) : 1) * (over > 0 ? exp(-over / decay) : 1) *
               (left < taper ? 0.5 - 0.5 * cos(M_PI * left / taper) : 1);
    }
    make_bands(i, n, e, e + n);
    for (size_t j = 1; j <= SUITE_PERIODS; j++)
        end_at_rest(n, e, e + j * n);
    fit(i, e + n, m);
    free(e);
    return STATUS_OK;
}
