#include "scene/yielding.h"

#include "base/linalg.h"

/* Of what may yield without the rest of the building falling: below 1 by this share. */
static const double STANDS = 0.98;

/* k_j = V_j / d_j of the mode phi (n), entries `stride` apart, under the forces K phi. */
static Status storey_stiffness(int n, const double K[], const double phi[], int stride, const double yield_m[],
                               double k[], Err *err)
{
    double shear = 0;
    for (int j = n - 1; j >= 0; j--) {
        for (int i = 0; i < n; i++)
            shear += K[j * n + i] * phi[i * stride];
        const double drift = phi[j * stride] - (j > 0 ? phi[(j - 1) * stride] : 0);
        k[j] = yield_m[j] > 0 ? shear / drift : 0;
        if (yield_m[j] > 0 && !(k[j] > 0 && isfinite(k[j])))
            return bad_data(
                err,
                "building: storey %d has no stiffness in the first mode (%.3g N/m), so that nothing of it can "
                "yield; leave building.yield_drift at 0",
                j + 1, k[j]);
    }
    return STATUS_OK;
}

/* Largest eigenvalue of B' diag(k) B x = lambda K x; work: (2 n n + n). */
static Status largest_share(int n, const double k[], const double K[], double work[], double *lambda, Err *err)
{
    double *yields = work, *phi = work + n * n, *omega = phi + n * n;
    memset(yields, 0, sizeof *yields * n * n);
    for (int j = 0; j < n; j++) {
        yields[j * n + j] += k[j];
        if (j > 0) {
            yields[(j - 1) * n + j - 1] += k[j];
            yields[j * n + j - 1] = yields[(j - 1) * n + j] = -k[j];
        }
    }
    TRY(linalg_modes(n, yields, K, omega, phi, err));
    *lambda = omega[n - 1] * omega[n - 1];
    return STATUS_OK;
}

Status yielding_parts(int n, const double K_elastic[], const double M[], const double K[], const double yield_m[],
                      double *hardening, double k[], Err *err)
{
    const size_t nn = n * n;
    double *work = malloc((2 * nn + n) * sizeof *work), lambda;
    if (!work)
        return fail(err, STATUS_NO_MEMORY, "building: no memory for its yielding storeys");
    Status status = linalg_modes(n, K_elastic, M, work + 2 * nn, work, err);
    if (status == STATUS_OK)
        status = storey_stiffness(n, K_elastic, work, n, yield_m, k, err);
    if (status == STATUS_OK)
        status = largest_share(n, k, K, work, &lambda, err);
    free(work);
    TRY(status);
    const double c = fmin(1 - *hardening, STANDS / lambda);
    *hardening = 1 - c;
    for (int j = 0; j < n; j++)
        k[j] *= c;
    return STATUS_OK;
}
