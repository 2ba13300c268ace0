#include "scene/yielding.h"

#include "base/linalg.h"

/* Of what may yield without the rest of the building falling: below 1 by this share. */
static const double STANDS = 0.98;

void storey_spring(int n, int j, double spring, double K[])
{
    K[j * n + j] += spring;
    if (j > 0) {
        K[(j - 1) * n + j - 1] += spring;
        K[j * n + j - 1] -= spring;
        K[(j - 1) * n + j] -= spring;
    }
}

Status yielding_parts(int n, const double K_elastic[], const double M[], const double K[], const double yield_m[],
                      double *hardening, double k[], Err *err)
{
    double *phi, shear = 0;
    TRY_ROOM(phi, (2 * (size_t)n + 1) * n, "yielding storeys", err);
    double *yields = phi + n * n, *omega = yields + n * n;
    Status status = linalg_modes(n, K_elastic, M, omega, phi, err);

    /* k_j = V_j / d_j of the first mode under the forces K phi. */
    for (int j = n - 1; j >= 0 && status == STATUS_OK; j--) {
        for (int i = 0; i < n; i++)
            shear += K_elastic[j * n + i] * phi[i * n];
        const double drift = phi[j * n] - (j > 0 ? phi[(j - 1) * n] : 0);
        k[j] = yield_m[j] > 0 ? shear / drift : 0;
        if (yield_m[j] > 0 && !(k[j] > 0 && isfinite(k[j])))
            status =
                bad_data(err,
                         "building: storey %d has no stiffness in the first mode (%.3g N/m), so that nothing of it can "
                         "yield; leave building.yield_drift at 0",
                         j + 1, k[j]);
    }

    /* The largest eigenvalue of B' diag(k) B x = lambda K x says how much of that may yield. */
    for (int j = 0; j < n && status == STATUS_OK; j++)
        storey_spring(n, j, k[j], yields);
    if (status == STATUS_OK)
        status = linalg_modes(n, yields, K, omega, phi, err);
    const double c = fmin(1 - *hardening, STANDS / (omega[n - 1] * omega[n - 1]));
    free(phi);
    TRY(status);
    *hardening = 1 - c;
    for (int j = 0; j < n; j++)
        k[j] *= c;
    return STATUS_OK;
}
