/* Building and core moving as one: linear, so that the only error is where we look.
 *
 *   (M + Mc) u'' + (C + Cc) u' + (K + Kc) u = -(M + Mc) 1 a(t),    C = M Phi diag(2 zeta w) Phi' M,  Cc likewise
 *
 * The building has the n degrees of freedom of its model, the core's join those of the floors (floors <= n).
 *
 * In the modes Psi of the pair (K + Kc, M + Mc), u = Psi y, with z = [W y; y'] (so that |z|^2 / 2 is the energy):
 *
 *   z' = [0 W; -W -D] z + [0; -Gamma] a,   D = P' diag(2 zeta w) P,   P = [Phi' M; Phic' Mc] Psi,   q' = P y'
 *
 * D is full: the pair shares no modes with its halves. Over a step the load is a straight line, and the step is exact:
 * (z, a, a') is multiplied by the exponential of one matrix (C. F. Van Loan, IEEE Trans. Autom. Control 23 (1978) 395).
 * Energies are integrated by the trapezoidal rule with its end correction (Euler-Maclaurin), straight stretch by
 * stretch: int f dt = h (f_0/2 + f_1 + ... + f_n/2) + h^2/12 (f_0' - f_n') + O(h^4) (f_0''' - f_n''') */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/carve.h"
#include "base/linalg.h"
#include "sim/engine.h"
#include "sim/energy_balance.h"
#include "sim/peak_monitor.h"

typedef struct {
    int n, floors, size; /* degrees of freedom; size = 2 n + 2, the state and its load */
    double step;         /* longest [s] */

    /* matrices by columns: entry (i, j) of a matrix with r rows is at [j r + i] */
    double *omega, *gamma; /* (n) of the pair [rad/s], [sqrt(kg)] */
    double *psi;           /* (n, n) */
    double *shapes;        /* (floors, n) of psi */
    double *D;             /* (n, n) [1/s] */
    double *P;             /* (n + floors, n) */
    double *loss;          /* (n + floors) 2 zeta w of building and core modes [rad/s] */
    double *exponential;   /* (size, size) for steps of h */
    double h;

    double *z, *z_next; /* (size) state, then a and a' */
    double *y_ddot, *y; /* (n) */
    double *rate;       /* (n + floors) q' of building and core modes */
    double *q;          /* (n + floors) */
    double *damped;     /* (n + floors) [J] */
    double input;       /* [J] */
    double *work;       /* (3 size size) */
    PeakMonitor peaks;
    ForceMonitor *forces; /* may be NULL */
    long steps;
    void *store;
} Rigid;

static void layout(void *rigid, Carve *c)
{
    Rigid *d = rigid;
    const size_t n = (size_t)d->n, size = (size_t)d->size, real = sizeof(double);
    const size_t floors = (size_t)d->floors, both = n + floors;
    d->omega = carve(c, n, real);
    d->gamma = carve(c, n, real);
    d->psi = carve(c, n * n, real);
    d->shapes = carve(c, floors * n, real);
    d->D = carve(c, n * n, real);
    d->P = carve(c, both * n, real);
    d->loss = carve(c, both, real);
    d->exponential = carve(c, size * size, real);
    d->z = carve(c, size, real);
    d->z_next = carve(c, size, real);
    d->y_ddot = carve(c, n, real);
    d->y = carve(c, n, real);
    d->rate = carve(c, both, real);
    d->q = carve(c, both, real);
    d->damped = carve(c, both, real);
    d->work = carve(c, 3 * size * size, real);
}

/* out (r) = A (r, c) x */
static void multiply(int r, int c, const double A[], const double x[], double out[])
{
    memset(out, 0, sizeof *out * (size_t)r);
    for (int j = 0; j < c; j++)
        for (int i = 0; i < r; i++)
            out[i] += A[(size_t)j * (size_t)r + (size_t)i] * x[j];
}

/* C (n, n) = A B */
static void product(int n, const double A[], const double B[], double C[])
{
    for (int j = 0; j < n; j++)
        multiply(n, n, A, B + (size_t)j * (size_t)n, C + (size_t)j * (size_t)n);
}

/* out = exp(A), A (n, n) overwritten: Taylor to full precision where |A| <= 1/2, then squared back up. work (2 n n) */
static void exponentiate(int n, double A[], double out[], double work[])
{
    const size_t nn = (size_t)n * (size_t)n;
    double *term = work, *next = work + nn, norm = 0;
    int halvings = 0;
    for (int j = 0; j < n; j++) {
        double sum = 0;
        for (int i = 0; i < n; i++)
            sum += fabs(A[j * n + i]);
        norm = fmax(norm, sum);
    }
    for (; norm > 0.5 && halvings < 60; halvings++)
        norm *= 0.5;
    for (size_t i = 0; i < nn; i++)
        A[i] = ldexp(A[i], -halvings);
    memset(out, 0, nn * sizeof *out);
    memset(term, 0, nn * sizeof *term);
    for (int i = 0; i < n; i++)
        out[i * n + i] = term[i * n + i] = 1;
    for (int k = 1; k <= 16; k++) { /* 0.5^17 / 17! < 1e-19 */
        product(n, A, term, next);
        for (size_t i = 0; i < nn; i++)
            out[i] += term[i] = next[i] / k;
    }
    for (; halvings > 0; halvings--) {
        product(n, out, out, next);
        memcpy(out, next, nn * sizeof *out);
    }
}

/* (z, a, a') after h = exponential (z, a, a'). */
static void set_step(Rigid *d, double h)
{
    const int n = d->n, size = d->size;
    double *A = d->work;
    memset(A, 0, sizeof *A * (size_t)(size * size));
    for (int i = 0; i < n; i++) {
        A[(n + i) * size + i] = h * d->omega[i];
        A[i * size + n + i] = -h * d->omega[i];
        A[2 * n * size + n + i] = -h * d->gamma[i];
        for (int j = 0; j < n; j++)
            A[(n + j) * size + n + i] = -h * d->D[j * n + i];
    }
    A[(2 * n + 1) * size + 2 * n] = h;
    exponentiate(size, A, d->exponential, d->work + size * size);
    d->h = h;
}

/* Rows first .. first+m-1 of P: phi' M Psi, from row-major phi and M (m, m) of the first m degrees of freedom. */
static void project(Rigid *d, int first, int m, const double phi[], const double M[])
{
    const int n = d->n, rows = n + d->floors;
    for (int k = 0; k < n; k++)
        for (int l = 0; l < m; l++) {
            double m_psi = 0;
            for (int j = 0; j < m; j++)
                m_psi += M[l * m + j] * d->psi[k * n + j];
            for (int i = 0; i < m; i++)
                d->P[k * rows + first + i] += phi[l * m + i] * m_psi;
        }
}

static Status find_pair_modes(Rigid *d, const Building *b, const CoreBeam *core, Err *err)
{
    const int n = d->n, nn = n * n;
    double *K = d->work, *M = K + nn, *psi = M + nn;
    core_beam_join(core, &b->model, K, M);
    TRY(linalg_modes(n, K, M, d->omega, psi, err));
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            d->psi[i * n + j] = psi[j * n + i];
    for (int i = 0; i < n; i++)
        memcpy(d->shapes + i * d->floors, d->psi + i * n, (size_t)d->floors * sizeof *d->shapes);
    return STATUS_OK;
}

/* D, and Gamma = P' gamma of building and core. */
static void set_damping(Rigid *d, const double building_gamma[], const double core_gamma[])
{
    const int n = d->n, rows = n + d->floors;
    for (int j = 0; j < n; j++) {
        for (int i = 0; i < n; i++)
            for (int k = 0; k < rows; k++)
                d->D[j * n + i] += d->P[i * rows + k] * d->loss[k] * d->P[j * rows + k];
        for (int k = 0; k < rows; k++)
            d->gamma[j] += d->P[j * rows + k] * (k < n ? building_gamma[k] : core_gamma[k - n]);
    }
}

static Status prepare(Rigid *d, const SceneOptions *o, const Building *b, const CoreBeam *core, Err *err)
{
    const int n = d->n;
    d->store = carve_all(layout, d);
    if (!d->store)
        return fail(err, STATUS_NO_MEMORY, "rigid: no memory for %d floors", n);
    TRY(find_pair_modes(d, b, core, err));
    project(d, 0, n, b->model.phi, b->model.M);
    project(d, n, d->floors, core->phi, core->M);
    for (int i = 0; i < n; i++)
        d->loss[i] = 2 * b->model.zeta[i] * b->model.omega[i];
    for (int i = 0; i < d->floors; i++)
        d->loss[n + i] = 2 * o->core.damping * core->omega[i];
    set_damping(d, b->model.gamma, core->gamma);
    return STATUS_OK;
}

/* y'' and q' of the present state. */
static void find_rates(Rigid *d)
{
    const int n = d->n;
    const double *z = d->z, *y_dot = d->z + n, a = d->z[2 * n];
    multiply(n, n, d->D, y_dot, d->y_ddot);
    for (int i = 0; i < n; i++)
        d->y_ddot[i] = -d->omega[i] * z[i] - d->y_ddot[i] - d->gamma[i] * a;
    multiply(n + d->floors, n, d->P, y_dot, d->rate);
}

/* q and q' of building and core by their own modes. */
static void record_forces(Rigid *d, double t)
{
    const int n = d->n;
    multiply(n + d->floors, n, d->P, d->y, d->q);
    force_monitor_point(
        d->forces,
        &(ForcePoint){.t = t, .ground = d->z[2 * n], .building_q = d->q, .building_v = d->rate, .core_q = d->q + n});
}

static void look(Rigid *d, double t)
{
    const int n = d->n;
    PeakPoint *point = peak_monitor_next(&d->peaks);
    for (int i = 0; i < n; i++)
        d->y[i] = d->z[i] / d->omega[i];
    point->t = t;
    multiply(d->floors, n, d->shapes, d->y, point->of[PEAK_DISPLACEMENT]);
    multiply(d->floors, n, d->shapes, d->y_ddot, point->of[PEAK_ACCELERATION]);
    for (int j = 0; j < d->floors; j++)
        point->of[PEAK_ACCELERATION][j] += d->z[2 * n];
    peak_monitor_add(&d->peaks);
    if (d->forces)
        record_forces(d, t);
}

static double dot(int n, const double a[], const double b[])
{
    double sum = 0;
    for (int i = 0; i < n; i++)
        sum += a[i] * b[i];
    return sum;
}

/* Adds weight f to every energy: f = 2 zeta w q'^2 and -a Gamma' y'. */
static void add_power(Rigid *d, double weight)
{
    const int n = d->n;
    for (int i = 0; i < n + d->floors; i++)
        d->damped[i] += weight * d->loss[i] * d->rate[i] * d->rate[i];
    d->input -= weight * d->z[2 * n] * dot(n, d->gamma, d->z + n);
}

/* Adds weight f'. */
static void add_power_slope(Rigid *d, double weight)
{
    const int n = d->n;
    const double a = d->z[2 * n], slope = d->z[2 * n + 1];
    double *q_ddot = d->work;
    multiply(n + d->floors, n, d->P, d->y_ddot, q_ddot);
    for (int i = 0; i < n + d->floors; i++)
        d->damped[i] += weight * d->loss[i] * 2 * d->rate[i] * q_ddot[i];
    d->input -= weight * (slope * dot(n, d->gamma, d->z + n) + a * dot(n, d->gamma, d->y_ddot));
}

/* From t on for `length`, while the ground acceleration is a + slope (time since t). */
static void cross_stretch(Rigid *d, double t, double length, double a, double slope)
{
    const int n = d->n;
    const long parts = (long)ceil(length / d->step);
    const double h = length / (double)parts;
    if (!(fabs(h - d->h) <= 1e-13 * h))
        set_step(d, h);
    d->z[2 * n] = a;
    d->z[2 * n + 1] = slope;
    find_rates(d);
    add_power(d, 0.5 * h);
    add_power_slope(d, h * h / 12);
    for (long k = 1; k <= parts; k++) {
        multiply(d->size, d->size, d->exponential, d->z, d->z_next);
        memcpy(d->z, d->z_next, sizeof *d->z * (size_t)(2 * n));
        d->z[2 * n] = a + slope * (double)k * h;
        find_rates(d);
        add_power(d, k < parts ? h : 0.5 * h);
        look(d, t + (double)k * h);
    }
    add_power_slope(d, -h * h / 12);
    d->steps += parts;
}

/* Sample by sample to the end; after the last sample the ground is at rest. Returns how far the response was finite. */
static double walk(Rigid *d, const Motion *motion, double duration)
{
    double t = 0;
    for (size_t k = 0; t < duration; k++) {
        const int shaking = k + 1 < motion->n;
        const double a = shaking ? motion->accel[k] : 0;
        const double slope = shaking ? (motion->accel[k + 1] - motion->accel[k]) / motion->dt_s : 0;
        const double left = duration - (double)k * motion->dt_s;
        const int last = left <= motion->dt_s * (1 + 1e-9);
        cross_stretch(d, t, last && left < motion->dt_s * (1 - 1e-9) ? left : motion->dt_s, a, slope);
        if (!isfinite(dot(2 * d->n, d->z, d->z) + d->input))
            return t;
        t = last ? duration : (double)(k + 1) * motion->dt_s;
    }
    return duration;
}

static void report(const Rigid *d, const int like[], SimResult *result)
{
    result->steps = d->steps;
    result->input_energy_j = d->input;
    result->kinetic_strain_j = 0.5 * dot(2 * d->n, d->z, d->z);
    peak_monitor_report(&d->peaks, result);
    energy_balance_close(result, d->n, like, d->floors, d->damped);
}

Status engine_rigid(const SceneOptions *o, const Building *b, const CoreBeam *core, const Motion *motion,
                    const EngineOptions *options, SimResult *result, Err *err)
{
    static const double STEP[] = {[ACCURACY_COARSE] = 2e-3, [ACCURACY_STANDARD] = 1e-3, [ACCURACY_FINE] = 5e-4};
    Rigid d = {.n = b->model.n,
               .floors = b->n,
               .size = 2 * b->model.n + 2,
               .step = STEP[options->accuracy],
               .peaks.n = b->n,
               .forces = options->forces};
    memset(result, 0, sizeof *result);
    result->n_floors = result->n_modes = b->n;
    if (d.forces)
        force_monitor_start(d.forces, b->n);
    const Status status = prepare(&d, o, b, core, err);
    if (status == STATUS_OK) {
        const double reached = walk(&d, motion, options->duration);
        if (reached < options->duration) {
            result->outcome = RUN_NOT_FINITE;
            snprintf(result->reason, sizeof result->reason, "t = %.6g s: motion or response is not a finite number",
                     reached);
        } else {
            report(&d, b->model.like, result);
        }
    }
    free(d.store);
    return status;
}
