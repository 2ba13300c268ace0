#include "scene/spectrum.h"

#include <math.h>

#include "base/units.h"

/* ---- oscillator ----------------------------------------------------------------------------------------------- */

typedef struct {
    double w, zeta, wd, per_ww; /* [rad/s], [-], damped [rad/s], 1 / w^2 */
} Oscillator;

/* What one interval of length tau does:   h impulse response, its slope h1, I1 = int h, I2 = int I1   (all at tau) */
typedef struct {
    double h, h1, I1, I2;
} Flow;

/* While w tau is small the closed forms below lose their digits to cancellation; I1 is then summed as the power
 * series of y'' + 2 zeta y' + y = 1, y(0) = y'(0) = 0 in x = w tau, and I2, h, h1 are its integral and derivatives. */
static Flow flow_series(const Oscillator *o, double tau)
{
    const double x = o->w * tau;
    double c = 0.5, c_before = 0, power = x; /* c_k, c_{k-1}, x^{k-1} */
    double y = 0, y1 = 0, y_int = 0;
    for (int k = 2; k < 30; k++) {
        y1 += k * c * power;
        y += c * power * x;
        y_int += c * power * x * x / (k + 1);
        const double c_next = -(2 * o->zeta * k * c + c_before) / ((k + 1.0) * k);
        c_before = c;
        c = c_next;
        power *= x;
    }
    const double w = o->w;
    return (Flow){.h = y1 / w, .h1 = 1 - 2 * o->zeta * y1 - y, .I1 = y / (w * w), .I2 = y_int / (w * w * w)};
}

static Flow flow(const Oscillator *o, double tau)
{
    if (o->w * tau < 1)
        return flow_series(o, tau);
    const double decay = exp(-o->zeta * o->w * tau), ww = o->w * o->w;
    const double c = cos(o->wd * tau) * decay, s = sin(o->wd * tau) * decay / o->wd;
    Flow f = {.h = s, .h1 = c - o->zeta * o->w * s};
    f.I1 = (1 - c - o->zeta * o->w * s) / ww;
    f.I2 = (tau - s - 2 * o->zeta * o->w * f.I1) / ww;
    return f;
}

typedef struct {
    double u, v; /* [m], [m/s] */
} State;

/* Ground acceleration a + slope tau. The response to unit initial displacement is h1 + 2 zeta w h. */
static inline State advance(const Oscillator *o, const Flow *f, State y, double a, double slope)
{
    const double g = f->h1 + 2 * o->zeta * o->w * f->h;
    return (State){.u = g * y.u + f->h * y.v - a * f->I1 - slope * f->I2,
                   .v = -o->w * o->w * f->h * y.u + f->h1 * y.v - a * f->h - slope * f->I1};
}

/* ---- largest displacement inside an interval ------------------------------------------------------------------- */

typedef struct {
    const Oscillator *o;
    State y;         /* at its beginning */
    double a, slope; /* [m/s2], [m/s3] */
} Interval;

static State state_at(const Interval *in, double tau)
{
    const Flow f = flow(in->o, tau);
    return advance(in->o, &f, in->y, in->a, in->slope);
}

/* The velocity is monotone in lo..hi and changes sign: Newton, kept inside by bisection. |u| at its zero. */
static double extremum(const Interval *in, double lo, double hi, double v_lo)
{
    const Oscillator *o = in->o;
    double tau = 0.5 * (lo + hi), u = 0;
    for (int i = 0; i < 60; i++) {
        const State y = state_at(in, tau);
        u = y.u;
        if ((y.v > 0) == (v_lo > 0))
            lo = tau;
        else
            hi = tau;
        const double accel = -in->a - in->slope * tau - 2 * o->zeta * o->w * y.v - o->w * o->w * y.u;
        double next = tau - y.v / accel;
        if (!(next > lo && next < hi))
            next = 0.5 * (lo + hi);
        if (fabs(next - tau) <= 1e-12 * hi)
            break;
        tau = next;
    }
    return fabs(u);
}

/* Largest |u| between the ends of an interval of length dt.
 *
 * The relative acceleration obeys the homogeneous equation, so its zeros lie pi / wd apart at known places, and the
 * velocity is monotone between them. Of the many half cycles that a stiff oscillator makes in one interval only the
 * first and the last few can hold the maximum: its peaks, one period apart, are a line plus a geometric sequence, which
 * is convex. */
static double largest_inside(const Interval *in, double dt, double v_end)
{
    const Oscillator *o = in->o;
    const double r = -in->a - 2 * o->zeta * o->w * in->y.v - o->w * o->w * in->y.u; /* u''(0)  */
    const double j = -in->slope - 2 * o->zeta * o->w * r - o->w * o->w * in->y.v;   /* u'''(0) */
    double phase = atan2(-r * o->wd, r * o->zeta * o->w + j);                       /* wd tau of a zero, modulo pi */
    phase -= M_PI * floor(phase / M_PI);
    const double half_cycles = ceil(fmax(o->wd * dt - phase, 0) / M_PI);
    double lo = 0, v_lo = in->y.v, largest = 0;
    for (double k = 0; k <= half_cycles; k++) {
        if (k == 4 && half_cycles > 9) {
            k = half_cycles - 4;
            lo = (phase + (k - 1) * M_PI) / o->wd;
            v_lo = state_at(in, lo).v;
        }
        const int last = k == half_cycles;
        const double hi = last ? dt : (phase + k * M_PI) / o->wd;
        const double v_hi = last ? v_end : state_at(in, hi).v;
        if (v_lo * v_hi < 0)
            largest = fmax(largest, extremum(in, lo, hi, v_lo));
        lo = hi;
        v_lo = v_hi;
    }
    return largest;
}

/* Can |u| be larger than `largest` in the interval? It is a line p (what the ground's line leads to in the end) and a
 * free vibration e about it, whose energy never grows: |u| <= max |p| + root(e(0)^2 + (e'(0) / w)^2). */
static inline int may_exceed(const Interval *in, double dt, double largest)
{
    const Oscillator *o = in->o;
    const double rise = -in->slope * o->per_ww, p = -in->a * o->per_ww - 2 * o->zeta * o->w * rise * o->per_ww;
    const double e = in->y.u - p, de = (in->y.v - rise) * o->w * o->per_ww;
    const double room = largest - fmax(fabs(p), fabs(p + rise * dt));
    return !(room >= 0 && e * e + de * de <= room * room);
}

/* Advances y over an interval and returns the largest |u| in it, or `so_far` where that is larger. */
static double cross(const Oscillator *o, const Flow *f, State *y, double a, double slope, double dt, double so_far)
{
    const Interval in = {.o = o, .y = *y, .a = a, .slope = slope};
    *y = advance(o, f, in.y, a, slope);
    if (!may_exceed(&in, dt, so_far))
        return so_far;
    return fmax(so_far, fmax(fabs(y->u), largest_inside(&in, dt, y->v)));
}

static double largest_displacement(const Motion *m, const Oscillator *o)
{
    const Flow f = flow(o, m->dt_s);
    State y = {0};
    double largest = 0;
    for (size_t i = 0; i + 1 < m->n; i++) {
        const double slope = (m->accel[i + 1] - m->accel[i]) / m->dt_s;
        largest = cross(o, &f, &y, m->accel[i], slope, m->dt_s, largest);
    }
    const double half_period = M_PI / o->wd;
    const Flow rest = flow(o, half_period);
    return cross(o, &rest, &y, 0, 0, half_period, largest);
}

void spectrum_psa(const Motion *m, double zeta, size_t n, const double T[], double psa[])
{
#pragma omp parallel for schedule(dynamic)
    for (size_t i = 0; i < n; i++) {
        if (!(T[i] > 0)) { /* rigid: moves with the ground */
            psa[i] = motion_peak(m);
            continue;
        }
        const double w = 2 * M_PI / T[i];
        const Oscillator o = {.w = w, .zeta = zeta, .wd = w * sqrt(1 - zeta * zeta), .per_ww = 1 / (w * w)};
        psa[i] = w * w * largest_displacement(m, &o);
    }
}

/* ---- figures -------------------------------------------------------------------------------------------------- */

typedef struct {
    double a, slope, dt; /* one interval of the ground acceleration */
    double v, d;         /* [m/s], [m] at its beginning */
} Ground;

static double velocity(const Ground *g, double tau)
{
    return g->v + tau * (g->a + tau * g->slope / 2);
}

static double displacement(const Ground *g, double tau)
{
    return g->d + tau * (g->v + tau * (g->a / 2 + tau * g->slope / 6));
}

/* The velocity peaks where the acceleration is zero. */
static double largest_velocity(const Ground *g)
{
    const double tau = -g->a / g->slope;
    const double inside = tau > 0 && tau < g->dt ? fabs(velocity(g, tau)) : 0;
    return fmax(inside, fabs(velocity(g, g->dt)));
}

/* The displacement peaks where the velocity v + a tau + slope tau^2 / 2 is zero; roots without cancellation. */
static double largest_ground_displacement(const Ground *g)
{
    double largest = fabs(displacement(g, g->dt));
    const double root = sqrt(g->a * g->a - 2 * g->slope * g->v); /* NaN: none */
    const double q = -(g->a + copysign(root, g->a));
    const double zeros[2] = {q / g->slope, 2 * g->v / q};
    for (int i = 0; i < 2; i++)
        if (zeros[i] > 0 && zeros[i] < g->dt) /* false for NaN and infinity */
            largest = fmax(largest, fabs(displacement(g, zeros[i])));
    return largest;
}

/* int a^2 from the beginning of the interval to tau */
static double square_integral(const Ground *g, double tau)
{
    const double b = g->a + g->slope * tau;
    return tau * (g->a * g->a + g->a * b + b * b) / 3;
}

static double absolute_integral(const Ground *g)
{
    const double b = g->a + g->slope * g->dt;
    if (g->a * b >= 0)
        return g->dt * fabs(g->a + b) / 2;
    return g->dt * (g->a * g->a + b * b) / (2 * fabs(b - g->a));
}

static Ground ground_at(const Motion *m, size_t i)
{
    return (Ground){.a = m->accel[i], .slope = (m->accel[i + 1] - m->accel[i]) / m->dt_s, .dt = m->dt_s};
}

/* When int a^2 has reached `level`; by bisection inside the interval where it does. */
static double time_of_level(const Motion *m, double level)
{
    double sum = 0;
    for (size_t i = 0; i + 1 < m->n; i++) {
        const Ground g = ground_at(m, i);
        const double more = square_integral(&g, g.dt);
        if (sum + more >= level) {
            double lo = 0, hi = g.dt;
            for (int k = 0; k < 52; k++) {
                const double middle = 0.5 * (lo + hi);
                if (sum + square_integral(&g, middle) < level)
                    lo = middle;
                else
                    hi = middle;
            }
            return (double)i * m->dt_s + hi;
        }
        sum += more;
    }
    return (double)(m->n - 1) * m->dt_s;
}

void motion_figures(const Motion *m, MotionFigures *out)
{
    double v = 0, d = 0, squares = 0;
    *out = (MotionFigures){.pga_m_s2 = motion_peak(m), .duration_s = (double)(m->n - 1) * m->dt_s};
    for (size_t i = 0; i + 1 < m->n; i++) {
        Ground g = ground_at(m, i);
        g.v = v;
        g.d = d;
        out->pgv_m_s = fmax(out->pgv_m_s, largest_velocity(&g));
        out->pgd_m = fmax(out->pgd_m, largest_ground_displacement(&g));
        out->cav_m_s += absolute_integral(&g);
        squares += square_integral(&g, g.dt);
        v = velocity(&g, g.dt);
        d = displacement(&g, g.dt);
    }
    out->arias_m_s = M_PI / (2 * GRAVITY) * squares;
    out->d5_95_s = squares > 0 ? time_of_level(m, 0.95 * squares) - time_of_level(m, 0.05 * squares) : 0;
}

void motion_histories(const Motion *m, double v[], double d[], double husid[])
{
    v[0] = d[0] = husid[0] = 0;
    for (size_t i = 0; i + 1 < m->n; i++) {
        Ground g = ground_at(m, i);
        g.v = v[i];
        g.d = d[i];
        v[i + 1] = velocity(&g, g.dt);
        d[i + 1] = displacement(&g, g.dt);
        husid[i + 1] = husid[i] + square_integral(&g, g.dt);
    }
    const double all = husid[m->n - 1];
    for (size_t i = 0; i < m->n && all > 0; i++)
        husid[i] /= all;
}
