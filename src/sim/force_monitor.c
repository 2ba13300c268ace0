#include "sim/force_monitor.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/carve.h"
#include "base/clones.h"
#include "base/units.h"

/* Two groups of outputs, each sampled for itself:
 *   slow    building: V_1..V_n, the overturning moment; velocities of the floors
 *   swift   core, on which impacts act: V_1..V_n, M_1..M_n, displacement of the top; building and core together: base
 *           shear, overturning moment
 * Rows of the tables are padded to vectors of eight. */
typedef double v8 __attribute__((vector_size(64)));
enum { LANES8 = 8 };

/* [s] Slow points that follow sooner are left out; contacts are shorter. */
static const double SLOW_SPACING = 4e-3;

/* A peak so far may be short of the true one by less than this share: what stays below it is of no interest. */
static const double NEAR_PEAK = 0.9;

typedef struct {
    int count;
    double spacing;             /* [s] */
    double t[2];                /* [s] of the last point and the one before */
    long points;                /* in a row */
    double *now, *last, *first; /* (count) at this point, the last, the one before */
    double *peak;               /* (count) over continuous time */
    double *reach_inverse;      /* (count) |output k| <= sqrt(energy) / reach_inverse_k (Cauchy-Schwarz); 0: always 0 */
    double quiet;               /* [2 J] so much energy raises no peak; < 0: not known */
} Group;

struct ForceMonitor {
    int n, nb, n_pad, building_out, core_out, totals_at; /* (core_out): the totals stand in the last eight */
    int core_modes, nc, has_residual;
    double z[FLOORS_MAX + 1];
    const CoreBeam *core;
    SceneOptions options;
    double weight_n, thickness[2]; /* [N] of the floors; [m] at base and top */

    double *building_rows; /* (nb, building_out) a row per mode */
    double *velocity_rows; /* (nb, n_pad) */
    double *core_rows;     /* (n, core_out) */
    double *total_rows;    /* (nb, 8) of building modes */
    double *force_rows;    /* (n, core_out) of a unit force on floor j, by the modes left out */
    double *ground_row;    /* (core_out) of a unit ground acceleration, by them */
    Group slow, swift;

    SimContact open[FLOORS_MAX];
    SimContactFn contact;
    void *contact_user;
    SimForces sum; /* contacts so far */
    void *store;
};

static int padded(int n)
{
    return (n + LANES8 - 1) / LANES8 * LANES8;
}

static void layout_group(Group *g, Carve *c, int count, double spacing)
{
    double **const of[] = {&g->now, &g->last, &g->first, &g->peak, &g->reach_inverse};
    for (size_t i = 0; i < sizeof of / sizeof of[0]; i++)
        *of[i] = carve(c, (size_t)count, sizeof(double));
    g->count = count;
    g->spacing = spacing;
}

static void layout(ForceMonitor *m, Carve *c)
{
    const size_t n = (size_t)m->n, nb = (size_t)m->nb, core = (size_t)m->core_out;
    m->building_rows = carve(c, nb * (size_t)m->building_out, sizeof(double));
    m->velocity_rows = carve(c, nb * (size_t)m->n_pad, sizeof(double));
    m->core_rows = carve(c, n * core, sizeof(double));
    m->total_rows = carve(c, nb * LANES8, sizeof(double));
    m->force_rows = carve(c, n * core, sizeof(double));
    m->ground_row = carve(c, core, sizeof(double));
    layout_group(&m->slow, c, m->building_out + m->n_pad, SLOW_SPACING);
    layout_group(&m->swift, c, m->core_out, 0);
}

Status force_monitor_create(ForceMonitor **out, int n_floors, int nb, Err *err)
{
    ForceMonitor *m = calloc(1, sizeof *m);
    *out = NULL;
    if (!m)
        return fail(err, STATUS_NO_MEMORY, "forces: out of memory");
    m->n = n_floors;
    m->nb = nb;
    m->n_pad = padded(n_floors);
    m->building_out = padded(n_floors + 1);
    m->totals_at = padded(2 * n_floors + 1);
    m->core_out = m->totals_at + LANES8;
    Carve count = {0};
    layout(m, &count);
    m->store = carve_store(&count);
    if (!m->store) {
        free(m);
        return fail(err, STATUS_NO_MEMORY, "forces: no memory for %d floors", n_floors);
    }
    layout(m, &(Carve){.base = m->store});
    *out = m;
    return STATUS_OK;
}

void force_monitor_free(ForceMonitor *m)
{
    if (m)
        free(m->store);
    free(m);
}

void force_monitor_on_contact(ForceMonitor *m, SimContactFn contact, void *user)
{
    m->contact = contact;
    m->contact_user = user;
}

/* -- a design --------------------------------------------------------------------------------------------------- */

/* Shears, and moments at the foot, of every storey for a mode of shape phi, entries `stride` apart: forces K phi. */
static void storey_forces(const ForceMonitor *m, const double K[], const double phi[], int stride, double shears[],
                          double moments[])
{
    const int n = m->n;
    double shear = 0, moment = 0;
    for (int s = n - 1; s >= 0; s--) {
        double force = 0;
        for (int j = 0; j < n; j++)
            force += K[s * n + j] * phi[j * stride];
        shear += force;
        moment += shear * (m->z[s + 1] - m->z[s]);
        shears[s] = shear;
        moments[s] = moment;
    }
}

static void set_building_rows(ForceMonitor *m, const Building *b)
{
    const int n = m->n;
    const BuildingModel *model = &b->model;
    double moments[FLOORS_MAX];
    for (int i = 0; i < m->nb; i++) {
        double *row = m->building_rows + i * m->building_out;
        storey_forces(m, b->K, model->phi + i, model->n, row, moments);
        row[n] = moments[0];
        m->total_rows[i * LANES8] = row[0];
        m->total_rows[i * LANES8 + 1] = moments[0];
        for (int j = 0; j < n; j++)
            m->velocity_rows[i * m->n_pad + j] = model->phi[j * model->n + i];
    }
}

static void set_core_rows(ForceMonitor *m, const CoreBeam *core)
{
    const int n = m->n;
    memset(m->core_rows, 0, sizeof(double) * (size_t)(n * m->core_out));
    for (int i = 0; i < n && core; i++) {
        double *row = m->core_rows + i * m->core_out;
        storey_forces(m, core->K, core->phi + i, n, row, row + n);
        row[2 * n] = core->phi[(n - 1) * n + i];
        row[m->totals_at] = row[0];
        row[m->totals_at + 1] = row[n];
    }
}

/* Adds to sums (count) the squares of the rows (n, count) over those of omega, NULL: 1. */
static void add_squares(int n, int count, const double rows[], const double omega[], double sums[])
{
    for (int i = 0; i < n; i++)
        for (int k = 0; k < count; k++) {
            const double r = rows[i * count + k] / (omega ? omega[i] : 1);
            sums[k] += r * r;
        }
}

static void set_reach(ForceMonitor *m, const Building *b, const CoreBeam *core)
{
    Group *const groups[] = {&m->slow, &m->swift};
    for (int i = 0; i < 2; i++)
        memset(groups[i]->reach_inverse, 0, sizeof(double) * (size_t)groups[i]->count);
    add_squares(m->nb, m->building_out, m->building_rows, b->model.omega, m->slow.reach_inverse);
    add_squares(m->nb, m->n_pad, m->velocity_rows, NULL, m->slow.reach_inverse + m->building_out);
    if (core) {
        add_squares(m->n, m->core_out, m->core_rows, core->omega, m->swift.reach_inverse);
        add_squares(m->nb, LANES8, m->total_rows, b->model.omega, m->swift.reach_inverse + m->totals_at);
    }
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < groups[i]->count; k++)
            if (groups[i]->reach_inverse[k] > 0)
                groups[i]->reach_inverse[k] = 1 / sqrt(groups[i]->reach_inverse[k]);
}

void force_monitor_set(ForceMonitor *m, const SceneOptions *o, const Building *b, const CoreBeam *core,
                       const double thickness[2])
{
    const int n = m->n;
    m->options = *o;
    m->core = core;
    m->nc = core ? n : 0;
    m->weight_n = 0;
    for (int s = 0; s < n; s++)
        m->z[s + 1] = m->z[s] + b->storey_m[s];
    for (int i = 0; i < n * n; i++)
        m->weight_n += b->M[i] * GRAVITY;
    m->thickness[0] = core ? thickness[0] : 0;
    m->thickness[1] = core ? thickness[1] : 0;
    set_building_rows(m, b);
    set_core_rows(m, core);
    set_reach(m, b, core);
}

/* -- points ----------------------------------------------------------------------------------------------------- */

/* What the modes left out add: quasi-static answers to the contacts and to the ground. */
static void set_residual(ForceMonitor *m)
{
    const int n = m->n, out = m->core_out;
    m->has_residual = m->core_modes < m->nc;
    memset(m->force_rows, 0, sizeof(double) * (size_t)(n * out));
    memset(m->ground_row, 0, sizeof(double) * (size_t)out);
    for (int i = m->core_modes; i < m->nc; i++) {
        const double *row = m->core_rows + i * out, omega = m->core->omega[i], flexibility = 1 / (omega * omega);
        for (int k = 0; k < out; k++) {
            m->ground_row[k] -= m->core->gamma[i] * flexibility * row[k];
            for (int j = 0; j < n; j++)
                m->force_rows[j * out + k] -= m->core->phi[j * n + i] * flexibility * row[k];
        }
    }
}

static void start_group(Group *g)
{
    g->points = 0;
    g->quiet = -1;
    memset(g->peak, 0, sizeof *g->peak * (size_t)g->count);
}

void force_monitor_start(ForceMonitor *m, int core_modes)
{
    m->core_modes = m->nc ? core_modes : 0;
    set_residual(m);
    start_group(&m->slow);
    start_group(&m->swift);
    memset(&m->sum, 0, sizeof m->sum);
    memset(m->open, 0, sizeof m->open);
    if (m->contact)
        m->contact(NULL, m->contact_user);
}

/* out_b += sum_i x_i rows_ib of three vectors b, rows (count, blocks): the sums stay in registers. */
static inline __attribute__((always_inline)) void add_three(int count, int blocks, const v8 *row, const double x[],
                                                            v8 *out)
{
    v8 s0 = out[0], s1 = out[1], s2 = out[2];
    for (int i = 0; i < count; i++, row += blocks) {
        s0 += row[0] * x[i];
        s1 += row[1] * x[i];
        s2 += row[2] * x[i];
    }
    out[0] = s0;
    out[1] = s1;
    out[2] = s2;
}

static inline __attribute__((always_inline)) void add_rows(int count, int width, const double rows[], const double x[],
                                                           double out[])
{
    const int blocks = width / LANES8;
    const v8 *row = (const v8 *)rows;
    v8 *sum = (v8 *)out;
    int b = 0;
    for (; b + 3 <= blocks; b += 3)
        add_three(count, blocks, row + b, x, sum + b);
    for (; b < blocks; b++) {
        v8 s = sum[b];
        for (int i = 0; i < count; i++)
            s += row[i * blocks + b] * x[i];
        sum[b] = s;
    }
}

CLONED static void slow_outputs(const ForceMonitor *m, const ForcePoint *p, double out[])
{
    memset(out, 0, sizeof *out * (size_t)m->slow.count);
    add_rows(m->nb, m->building_out, m->building_rows, p->building_q, out);
    add_rows(m->nb, m->n_pad, m->velocity_rows, p->building_v, out + m->building_out);
}

CLONED static void swift_outputs(const ForceMonitor *m, const ForcePoint *p, double out[])
{
    memset(out, 0, sizeof *out * (size_t)m->swift.count);
    add_rows(m->core_modes, m->core_out, m->core_rows, p->core_q, out);
    add_rows(m->nb, LANES8, m->total_rows, p->building_q, out + m->totals_at);
    if (!m->has_residual)
        return;
    add_rows(1, m->core_out, m->ground_row, &p->ground, out);
    for (FloorSet in = p->in_contact; in; in &= in - 1) {
        const int j = floor_set_first(in);
        add_rows(1, m->core_out, m->force_rows + j * m->core_out, p->force + j, out);
    }
}

/* Largest magnitude of the parabola through (-h0, y0), (0, y1), (h1, y2), |y1| the largest. */
static double parabola_top(double h0, double h1, double y0, double y1, double y2)
{
    const double d0 = (y1 - y0) / h0, d1 = (y2 - y1) / h1, curvature = (d1 - d0) / (h0 + h1);
    const double slope = d0 + curvature * h0;
    return curvature == 0 ? fabs(y1) : fabs(y1 - 0.25 * slope * slope / curvature);
}

/* Returns 1 where a peak rose, 2 or 3 where an output of the last point was a top: the largest of three, and not below
 * the peak so far. */
CLONED static int raise_to(int count, const double *restrict now, const double *restrict last,
                           const double *restrict first, double *restrict peak)
{
    int64_t tops = 0, higher = 0;
    for (int k = 0; k < count; k++) {
        const double y = fabs(now[k]), l = fabs(last[k]), f = fabs(first[k]), p = peak[k];
        tops |= (int64_t)(l > y) & (int64_t)(l >= f) & (int64_t)(l >= p);
        higher |= (int64_t)(y > p);
        peak[k] = y > p ? y : p;
    }
    return (int)higher + 2 * (int)tops;
}

static void raise_tops(Group *g, double t)
{
    const double h0 = g->t[0] - g->t[1], h1 = t - g->t[0];
    for (int k = 0; k < g->count; k++) {
        const double y = fabs(g->last[k]);
        if (y > fabs(g->now[k]) && y >= fabs(g->first[k]) && y >= g->peak[k])
            g->peak[k] = parabola_top(h0, h1, g->first[k], g->last[k], g->now[k]);
    }
}

/* Takes in g->now at time t. */
static void add_point(Group *g, double t)
{
    const int rose = raise_to(g->count, g->now, g->last, g->first, g->peak);
    if (rose > 1 && g->points > 1)
        raise_tops(g, t);
    if (rose)
        g->quiet = -1;
    double *oldest = g->first;
    g->first = g->last;
    g->last = g->now;
    g->now = oldest;
    g->t[1] = g->t[0];
    g->t[0] = t;
    g->points++;
}

static int is_due(const Group *g, double t)
{
    return g->points == 0 || (t > g->t[0] && t >= g->t[0] + g->spacing);
}

static void find_quiet(Group *g)
{
    double quiet = HUGE_VAL;
    for (int k = 0; k < g->count; k++) {
        const double speed = g->reach_inverse[k] > 0 ? g->peak[k] * g->reach_inverse[k] : HUGE_VAL;
        quiet = speed < quiet ? speed : quiet;
    }
    g->quiet = NEAR_PEAK * NEAR_PEAK * quiet * quiet;
}

static int may_rise(Group *g, double energy)
{
    if (g->quiet < 0)
        find_quiet(g);
    if (energy > g->quiet)
        return 1;
    g->points = 0;
    return 0;
}

int force_monitor_may_rise(ForceMonitor *m, double building, double core)
{
    const int slow = may_rise(&m->slow, building), swift = m->nc > 0 && may_rise(&m->swift, building + core);
    return slow || swift;
}

void force_monitor_point(ForceMonitor *m, const ForcePoint *p)
{
    if (is_due(&m->slow, p->t)) {
        slow_outputs(m, p, m->slow.now);
        add_point(&m->slow, p->t);
    }
    if (m->nc > 0 && is_due(&m->swift, p->t)) {
        swift_outputs(m, p, m->swift.now);
        add_point(&m->swift, p->t);
    }
}

/* -- contacts --------------------------------------------------------------------------------------------------- */

static int index_of(int side)
{
    return side > 0 ? 0 : 1;
}

void force_monitor_onset(ForceMonitor *m, int floor, int side, double t, double speed)
{
    m->open[floor] = (SimContact){.floor = floor, .side = side, .open = 1, .t = t, .approach = speed};
    m->sum.contacts[index_of(side)][floor]++;
}

void force_monitor_contact(ForceMonitor *m, int floor, double impulse, double lost, double force, double indentation)
{
    SimContact *c = &m->open[floor];
    const int side = index_of(c->side);
    c->impulse += impulse;
    c->lost += lost;
    c->force = fmax(c->force, force);
    c->indentation = fmax(c->indentation, indentation);
    m->sum.contact_impulse_ns[side][floor] += impulse;
    m->sum.contact_force_n[side][floor] = fmax(m->sum.contact_force_n[side][floor], force);
    m->sum.indentation_m[side][floor] = fmax(m->sum.indentation_m[side][floor], indentation);
}

int force_monitor_is_below(const ForceMonitor *m, int floor, int side, double force, double indentation)
{
    const int i = index_of(side);
    return !m->contact && force <= m->sum.contact_force_n[i][floor] && indentation <= m->sum.indentation_m[i][floor];
}

void force_monitor_end(ForceMonitor *m, int floor, double t, double speed)
{
    SimContact *c = &m->open[floor];
    if (!c->open)
        return;
    c->open = 0;
    c->duration = t - c->t;
    c->rebound = speed;
    if (m->contact)
        m->contact(c, m->contact_user);
}

static void close_open_contacts(ForceMonitor *m, double t)
{
    for (int j = 0; j < m->n; j++)
        if (m->open[j].open) {
            m->open[j].duration = t - m->open[j].t;
            if (m->contact)
                m->contact(&m->open[j], m->contact_user);
        }
}

/* -- results ---------------------------------------------------------------------------------------------------- */

static void report_stresses(const ForceMonitor *m, SimForces *out)
{
    const CoreOptions *o = &m->options.core;
    const double nu = o->poisson, plate = 4 * M_PI * M_PI * o->youngs_modulus_pa / (12 * (1 - nu * nu));
    out->stress_known = m->nc > 0 && o->section != CORE_EFFECTIVE;
    out->buckling_known = m->nc > 0 && o->section == CORE_BOX;
    for (int s = 0; s < m->n && out->stress_known; s++) {
        const CoreStorey c = core_beam_storey(o, m->n, s, m->thickness[0], m->thickness[1]);
        const double moment = fmax(out->core_moment_nm[s], s + 1 < m->n ? out->core_moment_nm[s + 1] : 0);
        const double stress = out->core_storey_stress_pa[s] = moment * 0.5 * c.depth / c.inertia;
        if (stress > out->core_stress_pa) {
            out->core_stress_pa = stress;
            out->core_stress_storey = s;
        }
        out->core_shear_stress_pa = fmax(out->core_shear_stress_pa, out->core_shear_n[s] * c.shear_stress_per_n);
        if (!out->buckling_known)
            continue;
        out->core_slenderness[s] = (o->side_m - 2 * c.thickness) / c.thickness;
        out->core_buckling_pa[s] = plate / (out->core_slenderness[s] * out->core_slenderness[s]);
        out->core_buckling_ratio = fmax(out->core_buckling_ratio, stress / out->core_buckling_pa[s]);
    }
}

static void report_contacts(const ForceMonitor *m, SimForces *out)
{
    for (int side = 0; side < SIDES; side++)
        for (int j = 0; j < m->n; j++)
            out->contact_force_max_n = fmax(out->contact_force_max_n, out->contact_force_n[side][j]);
}

void force_monitor_report(ForceMonitor *m, double t, SimForces *out)
{
    const int n = m->n;
    const double *building = m->slow.peak, *velocity = building + m->building_out, *core = m->swift.peak;
    const double *both = core + m->totals_at;
    close_open_contacts(m, t);
    *out = m->sum;
    for (int s = 0; s < n; s++) {
        out->building_shear_n[s] = building[s];
        out->peak_velocity_m_s[s] = velocity[s];
        out->core_shear_n[s] = core[s];
        out->core_moment_nm[s] = core[n + s];
    }
    out->building_base_shear_n = building[0];
    out->building_overturning_nm = building[n];
    out->core_base_shear_n = core[0];
    out->core_overturning_nm = core[n];
    out->core_top_m = core[2 * n];
    out->base_shear_n = m->nc > 0 ? both[0] : building[0];
    out->overturning_nm = m->nc > 0 ? both[1] : building[n];
    out->base_shear_ratio = m->weight_n > 0 ? out->base_shear_n / m->weight_n : 0;
    report_contacts(m, out);
    report_stresses(m, out);
    if (m->nc == 0)
        out->core_base_shear_n = out->core_overturning_nm = out->core_top_m = NAN;
    if (!out->stress_known)
        out->core_stress_pa = out->core_shear_stress_pa = NAN;
    if (!out->buckling_known)
        out->core_buckling_ratio = NAN;
}
