#include "sim/linear.h"

#include "base/carve.h"
#include "base/linalg.h"
#include "sim/energy_balance.h"
#include "sim/peak_monitor.h"

/* Stretches (straight loads, one sample of the motion each) are crossed in blocks, so that products of matrices do the
 * work; a block has at most so many numbers of output. Of a large system it always has all its stretches: products of
 * few columns would take twice the time. */
enum { BLOCK_NUMBERS = 1 << 16, BLOCK_STRETCHES = 32, LARGE = 64 /* coordinates */ };

/* Rows of the outputs of a state. */
typedef struct {
    int u, acceleration, apart, rate, power, plastic, n; /* where each group begins; in all */
} Rows;

typedef struct {
    const LinearSystem *s;
    const LinearRun *run;
    Rows rows;
    int loads;                          /* the ground, and each floor with a force */
    int size, parts_max, stretches_max; /* 2 m + 2 loads, the state and its loads, each with its slope; 2 n more where
                                         * storeys yield */
    const SimModel *storeys;            /* NULL: none yields */
    int at_force;                       /* [N] of the plastic drifts in the state, behind them their rates */
    double *drift, *answer;             /* (n, 2 m) drifts of a state; (n, n) drift i at the end for a unit rate j */
    double *change;                     /* (size, size) h d/dt of a state */
    double *spent;                      /* (n) e of sim/storey.h */
    double hysteresis;                  /* [J] */
    FloorSet yielding;                  /* bilinear storeys in the last step */
    double *D;                          /* (m, m) [1/s] */
    double *Y_ddot;                     /* (m, size) y'' of a state */
    double *coordinates;                /* (n_building + n_core, size) modal coordinates, where forces are wanted */
    double *outputs, *slopes;           /* (rows.n, size); (n_loss + loads, size) derivatives of rates and powers */
    double *exponential, *whole;        /* (size, size) for a part of h, for all parts of a stretch */
    double h;
    int parts;
    double *z;                             /* (size) */
    double *Z, *Z_next;                    /* (size, stretches) */
    double *Y;                             /* (parts + 1) (rows.n, stretches) */
    double *Q;                             /* (parts + 1) (n_building + n_core, stretches) */
    double *Y_slope;                       /* (n_loss + loads, stretches) */
    double *load, *load_slope;             /* (loads, BLOCK_STRETCHES) [m/s2], [N] where a stretch begins; per s */
    double *damped, *rate_max, *apart_max; /* (n_loss) [J], [m/s]; (n_apart) [m] */
    double input;                          /* [J] */
    double *work;                          /* (3 size, n or n_loss, size): the largest */
    PeakMonitor peaks;
    long steps;
    void *store;
} Linear;

static int n_coordinates(const Linear *d)
{
    return d->s->n_building + d->s->n_core;
}

static void layout(void *linear, Carve *c)
{
    Linear *d = linear;
    const size_t m = (size_t)d->s->m, size = (size_t)d->size, out = (size_t)d->rows.n;
    const size_t stretches = (size_t)d->stretches_max, losses = (size_t)d->s->n_loss, n = (size_t)d->s->n;
    const size_t widest = n > losses ? n : losses, work = 3 * size > widest ? 3 * size : widest;
    const size_t loads = (size_t)d->loads;
    const size_t coordinates = d->run->forces ? (size_t)n_coordinates(d) : 0;
    CARVE(c, d->D, m * m);
    CARVE(c, d->Y_ddot, m * size);
    CARVE(c, d->coordinates, coordinates * size);
    CARVE(c, d->outputs, out * size);
    CARVE(c, d->slopes, (losses + loads) * size);
    CARVE(c, d->exponential, size * size);
    CARVE(c, d->whole, size * size);
    CARVE(c, d->z, size);
    CARVE(c, d->Z, size * stretches);
    CARVE(c, d->Z_next, size * stretches);
    CARVE(c, d->Y, (d->parts_max + 1) * out * stretches);
    CARVE(c, d->Q, (d->parts_max + 1) * coordinates * stretches);
    CARVE(c, d->Y_slope, (losses + loads) * stretches);
    CARVE(c, d->load, loads * BLOCK_STRETCHES);
    CARVE(c, d->load_slope, loads * BLOCK_STRETCHES);
    CARVE(c, d->damped, losses);
    CARVE(c, d->rate_max, losses);
    CARVE(c, d->apart_max, d->s->n_apart);
    CARVE(c, d->work, work * size);
    CARVE(c, d->drift, d->storeys ? n * m : 0);
    CARVE(c, d->answer, d->storeys ? n * n : 0);
    CARVE(c, d->spent, d->storeys ? n : 0);
    CARVE(c, d->change, d->storeys ? size * size : 0);
}

/* -- storeys that yield -------------------------------------------------------------------------------------------- */

/* Their forces c k p load the coordinates by the drifts of these, and are straight lines over a step. */
static void set_storeys(Linear *d)
{
    const LinearSystem *s = d->s;
    const int n = s->n, m = s->m, at = d->at_force;
    for (int k = 0; k < m; k++)
        for (int j = 0; j < n; j++) {
            const double drift = s->psi[k * n + j] - (j > 0 ? s->psi[k * n + j - 1] : 0);
            d->Y_ddot[(at + j) * m + k] = drift;
            d->drift[k * n + j] = drift / s->omega[k];
        }
    for (int j = 0; j < n; j++)
        if (d->storeys->yield_n_m[j] > 0)
            d->outputs[(at + j) * d->rows.n + d->rows.plastic + j] = 1 / d->storeys->yield_n_m[j];
}

static void drifts_of(const Linear *d, const double z[], double out[])
{
    linalg_product(d->s->n, d->s->m, 1, d->drift, z, out);
}

/* What a unit rate of the forces moves in a step. */
static void set_answer(Linear *d)
{
    for (int j = 0; j < d->s->n; j++)
        drifts_of(d, d->exponential + (size_t)(d->at_force + d->s->n + j) * (size_t)d->size, d->answer + j * d->s->n);
}

/* Iterations of a step at most, whose share of the building's stiffness in its inertia is small: each gains its square.
 */
enum { ROUNDS = 6 };

/* The state z1 at the end of a step of h from z0, so far with the forces of the start: the plastic drifts follow the
 * drifts at both ends. */
static void yield_in_step(Linear *d, double h, const double z0[], double z1[])
{
    const SimModel *b = d->storeys;
    const int n = d->s->n;
    double d0[FLOORS_MAX], free[FLOORS_MAX], d1[FLOORS_MAX], p[FLOORS_MAX], e[FLOORS_MAX], rate[FLOORS_MAX] = {0};
    drifts_of(d, z0, d0);
    drifts_of(d, z1, free);
    memcpy(d1, free, sizeof d1);
    for (int round = 0, moved = 1; round < ROUNDS && moved; round++) {
        moved = 0;
        for (int j = 0; j < n; j++) {
            const double k = b->yield_n_m[j], p0 = k > 0 ? z0[d->at_force + j] / k : 0, before = rate[j];
            e[j] = d->spent[j];
            p[j] = k > 0 ? storey_advance(&b->storey_law, b->yield_m[j], d0[j], d1[j], p0, &e[j]) : 0;
            rate[j] = k * (p[j] - p0) / h;
            moved |= rate[j] != before;
        }
        linalg_product(n, n, 1, d->answer, rate, d1);
        for (int j = 0; j < n; j++)
            d1[j] += free[j];
    }
    for (int j = 0; j < n; j++) {
        const double k = b->yield_n_m[j], y = b->yield_m[j], turned = rate[j] * h;
        const double *column = d->exponential + (size_t)(d->at_force + n + j) * (size_t)d->size;
        if (b->storey_law.kind == HYSTERESIS_BILINEAR)
            d->hysteresis += fabs(turned) * y;
        d->spent[j] = e[j];
        for (int i = 0; i < d->size && k > 0; i++)
            z1[i] += column[i] * rate[j];
        z1[d->at_force + n + j] = 0; /* it was of this step */
    }
}

/* Hysteresis, and what the modes hold of it too much, at the end. */
static void report_storeys(const Linear *d, SimResult *result)
{
    const SimModel *b = d->storeys;
    const int n = d->s->n;
    double drift[FLOORS_MAX], p[FLOORS_MAX] = {0}, load[FLOORS_MAX];
    drifts_of(d, d->z, drift);
    result->hysteresis_j = d->hysteresis;
    for (int j = 0; j < n; j++) {
        const double k = b->yield_n_m[j], y = b->yield_m[j];
        p[j] = k > 0 ? d->z[d->at_force + j] / k : 0;
        const double z = drift[j] - p[j];
        result->kinetic_strain_j -= 0.5 * k * (drift[j] * drift[j] - z * z);
        if (b->storey_law.kind == HYSTERESIS_BOUC_WEN && k > 0)
            result->hysteresis_j += k * (y * y * d->spent[j] - 0.5 * z * z);
    }
    model_report_plastic(b, p, result);
    memset(result->residual_drift_m, 0, sizeof result->residual_drift_m);
    memcpy(load, d->z + d->at_force, sizeof *load * (size_t)n);
    for (int k = 0; k < d->s->m; k++) {
        double sum = 0;
        for (int j = 0; j < n; j++)
            sum += d->drift[k * n + j] * load[j];
        for (int j = 0; j < n; j++)
            result->residual_drift_m[j] += d->drift[k * n + j] * sum;
    }
}

/* -- matrices ------------------------------------------------------------------------------------------------------ */

/* Load k on coordinate i: -Gamma a, or psi of the floor times its force. */
static double load_on(const LinearSystem *s, int i, int k)
{
    return k == 0 ? -s->gamma[i] : s->psi[i * s->n + k - 1];
}

/* y'' = -W (W y) - D y' + loads as rows of the state. */
static void set_acceleration(Linear *d)
{
    const LinearSystem *s = d->s;
    const int m = s->m;
    for (int j = 0; j < m; j++)
        for (int i = 0; i < m; i++) {
            for (int k = 0; k < s->n_loss; k++)
                d->D[j * m + i] += s->P[i * s->n_loss + k] * s->loss[k] * s->P[j * s->n_loss + k];
            d->Y_ddot[(m + j) * m + i] = -d->D[j * m + i];
        }
    for (int i = 0; i < m; i++) {
        d->Y_ddot[i * m + i] = -s->omega[i];
        for (int k = 0; k < d->loads; k++)
            d->Y_ddot[(2 * m + k) * m + i] = load_on(s, i, k);
    }
}

/* Rows `at` .. of a matrix of `rows`: A (r, m) of y, that is A / w of W y; stride: rows of A. */
static void output_of_y(const Linear *d, double matrix[], int rows, int at, int r, int stride, const double A[])
{
    for (int k = 0; k < d->s->m; k++)
        for (int i = 0; i < r; i++)
            matrix[k * rows + at + i] = A[k * stride + i] / d->s->omega[k];
}

static void set_outputs(Linear *d)
{
    const LinearSystem *s = d->s;
    const int n = s->n, m = s->m, losses = s->n_loss, out = d->rows.n;
    output_of_y(d, d->outputs, out, d->rows.u, n, n, s->psi);
    output_of_y(d, d->outputs, out, d->rows.apart, s->n_apart, s->n_apart, s->apart);
    if (d->run->forces)
        output_of_y(d, d->coordinates, n_coordinates(d), 0, n_coordinates(d), losses, s->P);
    linalg_product(n, m, d->size, s->psi, d->Y_ddot, d->work);
    for (int k = 0; k < d->size; k++)
        for (int j = 0; j < n; j++)
            d->outputs[k * out + d->rows.acceleration + j] = d->work[k * n + j] + (k == 2 * m);
    for (int k = 0; k < m; k++) {
        memcpy(d->outputs + (m + k) * out + d->rows.rate, s->P + k * losses, (size_t)losses * sizeof *s->P);
        for (int l = 0; l < d->loads; l++)
            d->outputs[(m + k) * out + d->rows.power + l] = load_on(s, k, l);
    }
    linalg_product(losses, m, d->size, s->P, d->Y_ddot, d->work);
    for (int k = 0; k < d->size; k++) {
        double *slope = d->slopes + k * (losses + d->loads);
        memcpy(slope, d->work + k * losses, (size_t)losses * sizeof *d->work);
        for (int l = 0; l < d->loads; l++)
            for (int i = 0; i < m; i++)
                slope[losses + l] += load_on(s, i, l) * d->Y_ddot[k * m + i];
    }
}

/* out = A^power, A (n, n) kept; work (2 n n) */
static void raise(int n, const double A[], int power, double out[], double work[])
{
    const size_t bytes = (size_t)n * (size_t)n * sizeof *A;
    double *square = work, *next = work + n * n;
    memset(out, 0, bytes);
    for (int i = 0; i < n; i++)
        out[i * n + i] = 1;
    memcpy(square, A, bytes);
    for (; power > 0; power >>= 1) {
        if (power & 1) {
            linalg_product(n, n, n, square, out, next);
            memcpy(out, next, bytes);
        }
        linalg_product(n, n, n, square, square, next);
        memcpy(square, next, bytes);
    }
}

/* (z, a, a') after h = exponential (z, a, a'). */
static void set_step(Linear *d, double h, int parts)
{
    const int m = d->s->m, size = d->size;
    double *A = d->work;
    memset(A, 0, sizeof *A * (size_t)(size * size));
    for (int i = 0; i < m; i++) {
        A[(m + i) * size + i] = h * d->s->omega[i];
        for (int k = 0; k < size; k++)
            A[k * size + m + i] = h * d->Y_ddot[k * m + i];
    }
    for (int l = 0; l < d->loads; l++)
        A[(2 * m + d->loads + l) * size + 2 * m + l] = h;
    for (int j = 0; d->storeys && j < d->s->n; j++)
        A[(d->at_force + d->s->n + j) * size + d->at_force + j] = h;
    if (d->storeys)
        memcpy(d->change, A, sizeof *A * (size_t)(size * size));
    linalg_exponential(size, A, d->exponential, d->work + size * size);
    raise(size, d->exponential, parts, d->whole, d->work);
    d->h = h;
    d->parts = parts;
    if (d->storeys)
        set_answer(d);
}

/* -- a block of stretches ------------------------------------------------------------------------------------------ */

/* Y (rows.n, count) at one instant of every stretch: weight f of the energies, f = loss rate^2 and load times its power
 * per unit. */
static void add_power(Linear *d, int count, const double Z[], const double Y[], double weight)
{
    for (int i = 0; i < count; i++) {
        const double *y = Y + i * d->rows.n, *rate = y + d->rows.rate;
        for (int k = 0; k < d->s->n_loss; k++)
            d->damped[k] += weight * d->s->loss[k] * rate[k] * rate[k];
        for (int l = 0; l < d->loads; l++)
            d->input += weight * Z[i * d->size + 2 * d->s->m + l] * y[d->rows.power + l];
    }
}

/* The same of f'. */
static void add_power_slope(Linear *d, int count, const double Z[], const double Y[], double weight)
{
    const int losses = d->s->n_loss, m = d->s->m, all = losses + d->loads;
    linalg_product(all, d->size, count, d->slopes, Z, d->Y_slope);
    for (int i = 0; i < count; i++) {
        const double *y = Y + i * d->rows.n, *rate = y + d->rows.rate, *slope = d->Y_slope + i * all;
        const double *load = Z + i * d->size + 2 * m;
        for (int k = 0; k < losses; k++)
            d->damped[k] += weight * d->s->loss[k] * 2 * rate[k] * slope[k];
        for (int l = 0; l < d->loads; l++)
            d->input += weight * (load[d->loads + l] * y[d->rows.power + l] + load[l] * slope[losses + l]);
    }
}

static void raise_magnitudes(int n, const double now[], double largest[])
{
    for (int i = 0; i < n; i++)
        largest[i] = fmax(largest[i], fabs(now[i]));
}

/* y (rows.n), q (n_coordinates) at time t; q is read where forces are wanted. */
static void look(Linear *d, double t, double ground, const double y[], const double q[])
{
    const LinearSystem *s = d->s;
    PeakPoint *point = peak_monitor_next(&d->peaks);
    point->t = t;
    memcpy(point->of[PEAK_DISPLACEMENT], y + d->rows.u, (size_t)s->n * sizeof *y);
    memcpy(point->of[PEAK_ACCELERATION], y + d->rows.acceleration, (size_t)s->n * sizeof *y);
    peak_monitor_add(&d->peaks);
    raise_magnitudes(s->n_apart, y + d->rows.apart, d->apart_max);
    raise_magnitudes(s->n_apart, y + d->rows.rate + s->n_loss - s->n_apart, d->rate_max);
    if (d->run->forces)
        force_monitor_point(d->run->forces, &(ForcePoint){.t = t,
                                                          .ground = ground,
                                                          .building_q = q,
                                                          .building_v = y + d->rows.rate,
                                                          .plastic = d->storeys ? y + d->rows.plastic : NULL,
                                                          .core_q = q + s->n_building});
}

static void send_sample(const Linear *d, double t, double spacing, double ground, const double u[],
                        const double u_ddot[])
{
    const EngineOptions *o = d->run->sampling;
    o->sample(
        &(SimSample){
            .t = t, .spacing = spacing, .ground = ground, .u = u, .u_ddot = u_ddot, .input_j = NAN, .contacts_j = NAN},
        o->sample_user);
}

/* Parts of a stretch from one sample to the next, which divide it evenly; more than there are where none is wanted. */
static int parts_per_sample(const Linear *d, int parts, double h)
{
    const EngineOptions *o = d->run->sampling;
    int n = parts;
    if (!o || !o->sample)
        return parts + 1;
    while (n > 1 && o->sample_spacing > 0 && (n * h > o->sample_spacing * (1 + 1e-12) || parts % n != 0))
        n--;
    return n;
}

/* Bilinear storeys that begin to yield on the way from z0 to z1: the shares x of the step, ascending; returns how many.
 */
static int find_kinks(Linear *d, const double z0[], const double z1[], double x[])
{
    const SimModel *b = d->storeys;
    const FloorSet before = d->yielding;
    double d0[FLOORS_MAX], d1[FLOORS_MAX];
    int n = 0;
    d->yielding = 0;
    drifts_of(d, z0, d0);
    drifts_of(d, z1, d1);
    for (int j = 0; j < d->s->n && b->storey_law.kind == HYSTERESIS_BILINEAR; j++) {
        const double f0 = z0[d->at_force + j], turned = z1[d->at_force + j] - f0;
        if (turned == 0)
            continue;
        const double at = (f0 / b->yield_n_m[j] + copysign(b->yield_m[j], turned) - d0[j]) / (d1[j] - d0[j]);
        d->yielding |= (FloorSet)1 << j;
        if (!(at > 0) && before >> j & 1)
            continue;
        int i = n++;
        for (; i > 0 && x[i - 1] > at; i--)
            x[i] = x[i - 1];
        x[i] = fmin(fmax(at, 0), 1);
    }
    return n;
}

/* Acceleration is largest where a storey begins to yield, more often than not: there the state is the Hermite cubic
 * between z0 and z1, with the plastic drifts of the law. t: of z0. */
static void look_at_kinks(Linear *d, double t, const double z0[], const double z1[])
{
    const SimModel *b = d->storeys;
    const int n = d->s->n, size = d->size, n_q = d->run->forces ? n_coordinates(d) : 0, ground = 2 * d->s->m;
    double x[FLOORS_MAX], d0[FLOORS_MAX], d1[FLOORS_MAX], spent = 0; /* not of bilinear storeys */
    double *s0 = d->work, *s1 = s0 + size, *z = s1 + size, *y = z + size, *q = y + d->rows.n;
    const int kinks = find_kinks(d, z0, z1, x);
    if (kinks == 0)
        return;
    linalg_product(size, size, 1, d->change, z0, s0);
    linalg_product(size, size, 1, d->change, z1, s1);
    drifts_of(d, z0, d0);
    drifts_of(d, z1, d1);
    for (int k = 0; k < kinks; k++) {
        const double at = x[k], left = 1 - at, rise = at * at * (3 - 2 * at);
        for (int i = 0; i < size; i++)
            z[i] = z0[i] + rise * (z1[i] - z0[i]) + at * left * (left * s0[i] - at * s1[i]);
        for (int j = 0; j < n; j++)
            if (b->yield_n_m[j] > 0)
                z[d->at_force + j] =
                    b->yield_n_m[j] * storey_advance(&b->storey_law, b->yield_m[j], d0[j], d0[j] + at * (d1[j] - d0[j]),
                                                     z0[d->at_force + j] / b->yield_n_m[j], &spent);
        linalg_product(d->rows.n, size, 1, d->outputs, z, y);
        if (d->run->forces)
            linalg_product(n_q, size, 1, d->coordinates, z, q);
        look(d, t + at * d->h, z[ground], y, q);
        peak_monitor_break(&d->peaks);
    }
}

/* After part k of stretch i of count, which began at t; a sample `each` parts after the last one, 0: none. */
static void show(Linear *d, double t, int i, int k, int count, int each)
{
    const double at = k * d->h, ground = d->load[i * d->loads] + d->load_slope[i * d->loads] * at;
    const size_t column = (size_t)(k * count + i), n_q = d->run->forces ? (size_t)n_coordinates(d) : 0;
    const double *y = d->Y + column * (size_t)d->rows.n;
    look(d, t + at, ground, y, d->Q + column * n_q);
    if (each > 0)
        send_sample(d, t + at, each * d->h, ground, y + d->rows.u, y + d->rows.acceleration);
}

/* Columns of Z: the states where the stretches begin, with their loads; d->z goes to where the last one ends. */
static void find_starts(Linear *d, int count)
{
    const int m = d->s->m, size = d->size, loads = d->loads;
    for (int i = 0; i < count; i++) {
        memcpy(d->z + 2 * m, d->load + i * loads, (size_t)loads * sizeof *d->z);
        memcpy(d->z + 2 * m + loads, d->load_slope + i * loads, (size_t)loads * sizeof *d->z);
        memcpy(d->Z + i * size, d->z, (size_t)size * sizeof *d->z);
        if (!d->storeys) /* else one stretch at a time, part by part */
            linalg_product(size, size, 1, d->whole, d->Z + i * size, d->z);
    }
}

/* count stretches from t on, each of `length`, whole ones or what is left of one, during which the loads are load +
 * load_slope (time since its start). */
static void cross(Linear *d, double t, double length, int is_whole, int count)
{
    const int parts = (int)ceil(length / d->run->step), out = d->rows.n, n_q = n_coordinates(d);
    const double h = length / (double)parts;
    const int each = parts_per_sample(d, parts, h);
    if (!(fabs(h - d->h) <= 1e-13 * h) || parts != d->parts)
        set_step(d, h, parts);
    find_starts(d, count);
    linalg_product(out, d->size, count, d->outputs, d->Z, d->Y);
    add_power(d, count, d->Z, d->Y, 0.5 * h);
    add_power_slope(d, count, d->Z, d->Y, h * h / 12);
    if (t == 0 && d->loads > 1) /* a force may begin with a jump; Q is 0 at rest */
        look(d, 0, d->load[0], d->Y, d->Q);
    for (int k = 1; k <= parts; k++) {
        double *Y = d->Y + (size_t)k * (size_t)(out * count), *before = d->Z;
        linalg_product(d->size, d->size, count, d->exponential, d->Z, d->Z_next);
        d->Z = d->Z_next;
        d->Z_next = before;
        if (d->storeys)
            yield_in_step(d, h, before, d->Z);
        linalg_product(out, d->size, count, d->outputs, d->Z, Y);
        if (d->run->forces)
            linalg_product(n_q, d->size, count, d->coordinates, d->Z, d->Q + (size_t)k * (size_t)(n_q * count));
        add_power(d, count, d->Z, Y, k < parts ? h : 0.5 * h);
        if (d->storeys) {
            look_at_kinks(d, t + (k - 1) * h, before, d->Z);
            show(d, t, 0, k, count, is_whole && k % each == 0 ? each : 0);
        }
    }
    add_power_slope(d, count, d->Z, d->Y + (size_t)parts * (size_t)(out * count), -h * h / 12);
    if (d->storeys)
        memcpy(d->z, d->Z, (size_t)d->size * sizeof *d->z);
    for (int i = 0; i < count && !d->storeys; i++)
        for (int k = 1; k <= parts; k++)
            show(d, t + i * length, i, k, count, is_whole && k % each == 0 ? each : 0);
    d->steps += (long)count * parts;
}

/* -- a run --------------------------------------------------------------------------------------------------------- */

static int is_finite(const Linear *d)
{
    double sum = d->input;
    for (int i = 0; i < 2 * d->s->m; i++)
        sum += d->z[i] * d->z[i];
    return isfinite(sum);
}

/* The loads of stretch k as the i-th of a block; after the last sample there are none. */
static void set_loads(Linear *d, const Motion *motion, size_t k, int i)
{
    for (int l = 0; l < d->loads; l++) {
        const int width = l > 0 ? motion->n_force : 1, shaking = k + 1 < motion->n;
        const double *at = l > 0 ? motion->force + k * (size_t)width + l - 1 : motion->accel + k;
        d->load[i * d->loads + l] = shaking ? at[0] : 0;
        d->load_slope[i * d->loads + l] = shaking ? (at[width] - at[0]) / motion->dt_s : 0;
    }
}

/* Sample by sample to the end. Returns how far the response was finite. */
static double walk(Linear *d, const Motion *motion)
{
    const double dt = motion->dt_s, duration = d->run->duration;
    const size_t whole = (size_t)(duration / dt * (1 + 1e-9));
    const int parts = (int)ceil(dt / d->run->step), each = parts_per_sample(d, parts, dt / parts);
    if (each <= parts) {
        const double rest[FLOORS_MAX] = {0};
        send_sample(d, 0, each * dt / parts, motion->accel[0], rest, rest);
    }
    for (size_t k = 0; k < whole;) {
        const int count = (int)(whole - k < (size_t)d->stretches_max ? whole - k : (size_t)d->stretches_max);
        for (int i = 0; i < count; i++)
            set_loads(d, motion, k + (size_t)i, i);
        cross(d, (double)k * dt, dt, 1, count);
        if (!is_finite(d))
            return (double)k * dt;
        k += (size_t)count;
    }
    const double left = duration - (double)whole * dt;
    if (left > 1e-9 * dt) {
        set_loads(d, motion, whole, 0);
        cross(d, (double)whole * dt, left, 0, 1);
    }
    return is_finite(d) ? duration : (double)whole * dt;
}

static Status prepare(Linear *d, const Motion *motion, Err *err)
{
    const LinearSystem *s = d->s;
    const int n = s->n, apart = 2 * n, rate = apart + s->n_apart, power = rate + s->n_loss;
    const int plastic = power + 1 + motion->n_force, all = plastic + (d->storeys ? n : 0);
    d->loads = 1 + motion->n_force;
    d->rows = (Rows){0, n, apart, rate, power, plastic, all};
    d->at_force = 2 * s->m + 2 * d->loads;
    d->size = d->at_force + (d->storeys ? 2 * n : 0);
    d->parts_max = (int)ceil(motion->dt_s / d->run->step) + 1;
    const int fit = BLOCK_NUMBERS / (d->parts_max * all);
    d->stretches_max = d->storeys ? 1 : d->s->m > LARGE || fit > BLOCK_STRETCHES ? BLOCK_STRETCHES : fit < 1 ? 1 : fit;
    d->store = carve_all(layout, d);
    if (!d->store)
        return fail_memory(err, n, "floors");
    set_acceleration(d);
    if (d->storeys)
        set_storeys(d);
    set_outputs(d);
    return STATUS_OK;
}

static double largest_of(int n, const double values[])
{
    double largest = 0;
    for (int i = 0; i < n; i++)
        largest = fmax(largest, values[i]);
    return largest;
}

/* What the modes of both together have damped, as parts of building and core: sum_i P_ik^2 = 1. */
static void book_by_shares(const Linear *d)
{
    const LinearSystem *s = d->s;
    const int n = n_coordinates(d);
    for (int k = 0; n + k < s->n_loss; k++) {
        for (int i = 0; i < n; i++)
            d->damped[i] += pow(s->P[k * s->n_loss + i], 2) * d->damped[n + k];
        d->damped[n + k] = 0;
    }
}

static void report(const Linear *d, SimResult *result)
{
    const LinearSystem *s = d->s;
    double energy = 0;
    for (int i = 0; i < 2 * s->m; i++)
        energy += 0.5 * d->z[i] * d->z[i];
    result->steps = d->steps;
    result->input_energy_j = d->input;
    result->kinetic_strain_j = energy;
    result->stroke_m = largest_of(s->n_apart, d->apart_max);
    result->dashpot_n = s->n_apart > 0 ? s->loss[s->n_loss - 1] * largest_of(s->n_apart, d->rate_max) : 0;
    peak_monitor_report(&d->peaks, result);
    if (d->storeys)
        report_storeys(d, result);
    if (s->n_apart == 0)
        book_by_shares(d);
    energy_balance_close(result, s->n_building, s->like, s->n_loss - s->n_building, d->damped);
}

Status linear_run(const LinearSystem *s, const Motion *motion, const LinearRun *run, SimResult *result, Err *err)
{
    Linear d = {.s = s, .run = run, .storeys = run->storeys, .peaks.n = s->n};
    memset(result, 0, sizeof *result);
    result->n_floors = result->n_modes = s->n;
    if (run->forces)
        force_monitor_start(run->forces, s->n_core);
    const Status status = prepare(&d, motion, err);
    if (status == STATUS_OK) {
        const double reached = walk(&d, motion);
        if (reached < run->duration) {
            result->outcome = RUN_NOT_FINITE;
            snprintf(result->reason, sizeof result->reason, "t = %.6g s: motion or response is not a finite number",
                     reached);
        } else {
            report(&d, result);
        }
    }
    free(d.store);
    return status;
}

Status engine_linear(LinearKind kind, const Building *b, const CoreBeam *core, const LinearDevice *device,
                     const SimModel *storeys, const Motion *motion, const EngineOptions *options, SimResult *result,
                     Err *err)
{
    static const double STEP[] = {[ACCURACY_COARSE] = 2e-3, [ACCURACY_STANDARD] = 1e-3, [ACCURACY_FINE] = 5e-4};
    const LinearRun run = {options->duration, STEP[options->accuracy], options->forces, options, storeys};
    LinearSystem s;
    TRY(linear_system_make(&s, kind, b, core, device, b->model.n, err));
    const Status status = linear_run(&s, motion, &run, result, err);
    linear_system_free(&s);
    return status;
}
