#include "motion/spectrum.h"

#include "base/units.h"

/* ---- oscillator ----------------------------------------------------------------------------------------------- */

typedef struct {
    double w, zeta, wd;                /* [rad/s], [-], damped [rad/s] */
    double ww, damping, per_w, per_ww; /* w^2, 2 zeta w, 1 / w, 1 / w^2 */
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

/* What an interval of length tau does, in closed form where that keeps its digits. */
static Flow flow(const Oscillator *o, double tau)
{
    if (o->w * tau < 1)
        return flow_series(o, tau);
    const double decay = exp(-o->zeta * o->w * tau);
    const double c = cos(o->wd * tau) * decay, s = sin(o->wd * tau) * decay / o->wd;
    Flow f = {.h = s, .h1 = c - o->zeta * o->w * s};
    f.I1 = (1 - c - o->zeta * o->w * s) / o->ww;
    f.I2 = (tau - s - o->damping * f.I1) / o->ww;
    return f;
}

typedef struct {
    double u, v; /* [m], [m/s] */
} State;

/* ---- largest displacement inside an interval ------------------------------------------------------------------- */

typedef struct {
    const Oscillator *o;
    State y;         /* at its beginning */
    double a, slope; /* [m/s2], [m/s3] ground acceleration a + slope tau */
} Interval;

/* The response to unit initial displacement is h1 + 2 zeta w h. */
static State state_at(const Interval *in, double tau)
{
    const Oscillator *o = in->o;
    const State y = in->y;
    const Flow f = flow(o, tau);
    const double g = f.h1 + o->damping * f.h;
    return (State){.u = g * y.u + f.h * y.v - in->a * f.I1 - in->slope * f.I2,
                   .v = -o->ww * f.h * y.u + f.h1 * y.v - in->a * f.h - in->slope * f.I1};
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
        const double accel = -in->a - in->slope * tau - o->damping * y.v - o->ww * y.u;
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
    const double r = -in->a - o->damping * in->y.v - o->ww * in->y.u; /* u''(0)  */
    const double j = -in->slope - o->damping * r - o->ww * in->y.v;   /* u'''(0) */
    double phase = atan2(-r * o->wd, r * o->zeta * o->w + j);         /* wd tau of a zero, modulo pi */
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

/* ---- over the motion --------------------------------------------------------------------------------------------- */

/* What an interval of length dt does, and what the bounds on |u| need. */
typedef struct {
    double uu, uv, vu, vv, I1, I2; /* u' = uu u + uv v - I1 a - I2 slope, v' = vu u + vv v - uv a - I1 slope */
    double lag, dt, chord;         /* 2 zeta / w^3, dt^4 / 64 */
} Step;

/* Advances y over an interval and raises the largest |u| to what is in it. u is a line p (what the ground's line leads
 * to in the end) and a free vibration e about it, whose energy never grows: |u| <= max |p| + root(e(0)^2 + (e'(0) /
 * w)^2). A good bound for short periods. Where |u''| <= c, u lies less than dt^2 / 8 c above its chord; u'' = r at the
 * beginning, r' = j there, is a free vibration: c^2 = r^2 + (j / w)^2. A good bound for periods much longer than dt. */
static void cross(const Oscillator *o, const Step *g, State *y, double *largest, double a, double slope)
{
    const Interval in = {.o = o, .y = *y, .a = a, .slope = slope};
    const double rise = -slope * o->per_ww, p = -a * o->per_ww - g->lag * rise;
    const double e = in.y.u - p, de = (in.y.v - rise) * o->per_w, square = e * e + de * de;
    const double line0 = *largest - fabs(p), line1 = *largest - fabs(p + rise * g->dt);
    y->u = g->uu * in.y.u + g->uv * in.y.v - a * g->I1 - slope * g->I2;
    y->v = g->vu * in.y.u + g->vv * in.y.v - a * g->uv - slope * g->I1;
    *largest = fmax(*largest, fabs(y->u));
    if (line0 >= 0 && line1 >= 0 && square <= line0 * line0 && square <= line1 * line1)
        return;
    const double r = -a - o->damping * in.y.v - o->ww * in.y.u, j = -slope - o->damping * r - o->ww * in.y.v;
    const double above = g->chord * (r * r + j * j * o->per_ww);
    const double room0 = *largest - fabs(in.y.u), room1 = *largest - fabs(y->u);
    if (!(above <= room0 * room0 && above <= room1 * room1))
        *largest = fmax(*largest, largest_inside(&in, g->dt, y->v));
}

/* Over the motion and then half a period at rest. */
static double largest_displacement(const Motion *m, const Oscillator *o)
{
    const double half_period = M_PI / o->wd;
    const Flow f = flow(o, m->dt_s);
    const Step g = {.uu = f.h1 + o->damping * f.h,
                    .uv = f.h,
                    .vu = -o->ww * f.h,
                    .vv = f.h1,
                    .I1 = f.I1,
                    .I2 = f.I2,
                    .lag = o->damping * o->per_ww,
                    .dt = m->dt_s,
                    .chord = pow(m->dt_s, 4) / 64};
    Interval rest = {.o = o};
    double largest = 0;
    for (size_t i = 0; i + 1 < m->n; i++)
        cross(o, &g, &rest.y, &largest, m->accel[i], (m->accel[i + 1] - m->accel[i]) / m->dt_s);
    const State end = state_at(&rest, half_period);
    return fmax(largest, fmax(fabs(end.u), largest_inside(&rest, half_period, end.v)));
}

void spectrum_psa(const Motion *m, double zeta, size_t n, const double T[], double psa[])
{
#pragma omp parallel for schedule(dynamic)
    for (size_t i = 0; i < n; i++) {
        const double w = 2 * M_PI / T[i]; /* a rigid one moves with the ground */
        const Oscillator o = {w, zeta, w * sqrt(1 - zeta * zeta), w * w, 2 * zeta * w, w * (1 / (w * w)), 1 / (w * w)};
        psa[i] = T[i] > 0 ? w * w * largest_displacement(m, &o) : motion_peak(m);
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

/* int a^2 from the beginning of the interval to tau */
static double square_integral(const Ground *g, double tau)
{
    const double b = g->a + g->slope * tau;
    return tau * (g->a * g->a + g->a * b + b * b) / 3;
}

/* Interval i, behind another one or, where that is of no length, at rest. */
static Ground ground_behind(const Ground *before, const Motion *m, size_t i)
{
    return (Ground){.a = m->accel[i],
                    .slope = (m->accel[i + 1] - m->accel[i]) / m->dt_s,
                    .dt = m->dt_s,
                    .v = velocity(before, before->dt),
                    .d = displacement(before, before->dt)};
}

/* When int a^2 has reached `level`; by bisection inside the interval where it does. */
static double time_of_level(const Motion *m, double level)
{
    double sum = 0;
    for (size_t i = 0; i + 1 < m->n; i++) {
        const Ground g = ground_behind(&(Ground){0}, m, i);
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
    return motion_duration(m);
}

void motion_figures(const Motion *m, MotionFigures *out)
{
    Ground g = {0};
    double squares = 0;
    *out = (MotionFigures){.pga_m_s2 = motion_peak(m), .duration_s = motion_duration(m)};
    for (size_t i = 0; i + 1 < m->n; i++) {
        g = ground_behind(&g, m, i);
        const double a = g.a, b = a + g.slope * g.dt, peak = -a / g.slope;

        /* The velocity peaks where the acceleration is zero. */
        if (peak > 0 && peak < g.dt)
            out->pgv_m_s = fmax(out->pgv_m_s, fabs(velocity(&g, peak)));
        out->pgv_m_s = fmax(out->pgv_m_s, fabs(velocity(&g, g.dt)));

        /* The displacement peaks where the velocity v + a tau + slope tau^2 / 2 is zero; roots without cancellation,
         * NaN where there are none, which like infinity lies in no interval. */
        const double q = -(a + copysign(sqrt(a * a - 2 * g.slope * g.v), a));
        const double at[] = {q / g.slope, 2 * g.v / q};
        for (int k = 0; k < 2; k++)
            if (at[k] > 0 && at[k] < g.dt)
                out->pgd_m = fmax(out->pgd_m, fabs(displacement(&g, at[k])));
        out->pgd_m = fmax(out->pgd_m, fabs(displacement(&g, g.dt)));
        out->cav_m_s += a * b >= 0 ? g.dt * fabs(a + b) / 2 : g.dt * (a * a + b * b) / (2 * fabs(b - a));
        squares += square_integral(&g, g.dt);
    }
    out->arias_m_s = M_PI / (2 * GRAVITY) * squares;
    out->d5_95_s = squares > 0 ? time_of_level(m, 0.95 * squares) - time_of_level(m, 0.05 * squares) : 0;
}

void motion_histories(const Motion *m, double v[], double d[], double husid[])
{
    Ground g = {0};
    v[0] = d[0] = husid[0] = 0;
    for (size_t i = 0; i + 1 < m->n; i++) {
        g = ground_behind(&g, m, i);
        v[i + 1] = velocity(&g, g.dt);
        d[i + 1] = displacement(&g, g.dt);
        husid[i + 1] = husid[i] + square_integral(&g, g.dt);
    }
    const double all = husid[m->n - 1];
    for (size_t i = 0; i < m->n && all > 0; i++)
        husid[i] /= all;
}
