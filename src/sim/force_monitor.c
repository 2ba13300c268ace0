#include "sim/force_monitor.h"

#include "base/carve.h"
#include "base/clones.h"
#include "base/units.h"
#include "scene/neighbour.h"
#include "scene/wall.h"
#include "sim/lanes.h"

/* Eight outputs, followed together:
 *   swift   core, on which impacts act: V_1..V_n, M_1..M_n, displacement of the top; building and core together: base
 *           shear, overturning moment
 *   slow    building: V_1, the overturning moment, V_2..V_n; velocities of the floors */
/* [s] Slow points that follow sooner are left out, but for the last; contacts are shorter. */
static const double SLOW_SPACING = 4e-3;

typedef struct {
    v8 mat;               /* of a unit of F of the mat that lifts */
    v8 last, first, peak; /* at the last point, the one before; over continuous time */
    int outputs;          /* of the eight */
    /* |output| is at most the sum of these times ForceReach.by */
    v8 reach[N_REACHES];
    double *room;                        /* of these: */
    double *building, *building_squares; /* (nb, 8) a row per mode, its square over w^2; NULL: none of the building */
    double *core, *core_squares;         /* (n, 8) */
    double *plastic;                     /* (n, 8) of building: of a unit plastic drift of storey j */
    double *force, *ground; /* (n, 8), (8) of a unit force on floor j, of the ground, by the modes left out */
    int of_velocities;      /* building's */
    int rose;               /* a peak, at the last point */
    int stale;              /* peaks rose since its limits were set, */
    long set;               /* at this look */
    double spacing, t[2];   /* [s] of the last point and the one before */
    long points, look;      /* in a row; at which look the last was due */
} Group;

struct ForceMonitor {
    int n, nb;
    int at_both, at_slow, at_velocity, n_groups; /* groups: core from 0, building and core, building, velocities */
    int core_modes, nc, own_modes, has_residual, with_storeys, yields;
    double z[FLOORS_MAX + 1];
    const CoreBeam *core;
    SceneOptions options;
    double weight_n, thickness[2]; /* [N] of the floors; [m] at base and top */
    double end;                    /* [s] of the run: its last point is never left out */

    Group *group;      /* (n_groups) */
    int *due;          /* (n_groups) those whose peaks may rise, n_due of them */
    int n_due, rising; /* rising: groups of which a peak rose at the last point */
    long looks;
    double
        *limit[N_REACHES]; /* (n_groups, padded) where the sum of these times ForceReach.by is below 1, no peak rises */

    SimContact open[FLOORS_MAX];
    SimContactFn contact;
    void *contact_user;
    SimForces sum; /* contacts so far */
};

static int eights(int n)
{
    return (n + LANES8 - 1) / LANES8;
}

/* A group that may have outputs of the core has tables of it, and of what its modes left out add. */
static void layout(void *object, Carve *c)
{
    ForceMonitor *m = object;
    CARVE(c, m->group, m->n_groups);
    CARVE(c, m->due, m->n_groups);
    for (int i = 0; i < N_REACHES; i++)
        CARVE(c, m->limit[i], eights(m->n_groups) * LANES8);
    for (int i = 0; i < m->n_groups; i++) {
        Group none, *g = c->base ? &m->group[i] : &none;
        CARVE(c, g->room, LANES8 * m->nb);
        CARVE(c, g->building_squares, LANES8 * m->nb);
        CARVE(c, g->plastic, LANES8 * m->n);
        if (i >= m->at_slow)
            continue;
        CARVE(c, g->core, LANES8 * m->n);
        CARVE(c, g->core_squares, LANES8 * m->n);
        CARVE(c, g->force, LANES8 * m->n);
        CARVE(c, g->ground, LANES8);
    }
}

Status force_monitor_create(ForceMonitor **out, int n_floors, int nb, Err *err)
{
    ForceMonitor plain = {.n = n_floors, .nb = nb, .at_both = eights(2 * n_floors + 1)};
    plain.at_slow = plain.at_both + 1;
    plain.at_velocity = plain.at_slow + eights(n_floors + 1);
    plain.n_groups = plain.at_velocity + eights(n_floors);
    ForceMonitor *m = *out = carve_object(layout, &plain, sizeof plain);
    if (!m)
        return fail_memory(err, n_floors, "floors");
    for (int i = m->at_slow; i < m->n_groups; i++) {
        m->group[i].spacing = SLOW_SPACING;
        m->group[i].of_velocities = i >= m->at_velocity;
    }
    return STATUS_OK;
}

void force_monitor_free(ForceMonitor *m)
{
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

typedef enum { ROW_BUILDING, ROW_CORE, ROW_PLASTIC, ROW_MAT } RowKind;

/* Row i of outputs (count) of groups from `at` on. */
static void put_row(ForceMonitor *m, int at, int i, int count, const double outputs[], RowKind of)
{
    for (int k = 0; k < count; k++) {
        Group *g = &m->group[at + k / LANES8];
        double *rows = of == ROW_CORE       ? g->core
                       : of == ROW_BUILDING ? g->building
                       : of == ROW_MAT      ? (double *)&g->mat
                                            : g->plastic;
        rows[i * LANES8 + k % LANES8] = outputs[k];
        g->outputs = k % LANES8 + 1;
    }
}

/* The tables of outputs, a row per mode, and per storey that yields. joined: the core moves in the building's modes. */
static void set_rows(ForceMonitor *m, const Building *b, const CoreBeam *core, int joined)
{
    const int n = m->n, modes = joined ? m->nb : n;
    const BuildingModel *model = &b->model;
    double nodes[FLOORS_MAX], outputs[2 * FLOORS_MAX + 1], moments[FLOORS_MAX], velocities[FLOORS_MAX];

    /* Modes of the building: base shear, overturning moment, shears of the other storeys; the floors' velocities. */
    for (int i = 0; i < m->nb; i++) {
        storey_forces(m, b->K, model->phi + i, model->n, outputs + 1, moments);
        outputs[0] = outputs[1];
        outputs[1] = moments[0];
        for (int j = 0; j < n; j++)
            velocities[j] = model->phi[j * model->n + i];
        put_row(m, m->at_both, i, 2, outputs, ROW_BUILDING);
        put_row(m, m->at_slow, i, n + 1, outputs, ROW_BUILDING);
        put_row(m, m->at_velocity, i, n, velocities, ROW_BUILDING);
    }

    /* Modes of the core. Those at the base stand beside the building's, where these are its modes too. */
    memset(outputs, 0, sizeof outputs);
    for (int i = 0; i < modes; i++) {
        for (int j = 0; core && j < n; j++)
            nodes[j] = joined ? building_shape(model, j, model->arm_contact, i) : core->phi[j * n + i];
        if (core) {
            storey_forces(m, core->K, nodes, 1, outputs, outputs + n);
            outputs[2 * n] = nodes[core->top - 1];
        }
        put_row(m, 0, i, 2 * n + 1, outputs, joined ? ROW_BUILDING : ROW_CORE);
        double *both = (joined ? m->group[m->at_both].building : m->group[m->at_both].core) + i * LANES8;
        for (int k = 0; k < 2; k++)
            both[k] = outputs[k * n] + (joined ? both[k] : 0);
    }

    /* A plastic drift of storey j takes its part of the shear of that storey, and its moment from all feet below. */
    for (int j = 0; j < n && b->yields; j++) {
        memset(outputs, 0, sizeof outputs);
        outputs[1] = -b->yield_n_m[j] * b->storey_m[j];
        outputs[j > 0 ? j + 1 : 0] = -b->yield_n_m[j];
        put_row(m, m->at_both, j, 2, outputs, ROW_PLASTIC);
        put_row(m, m->at_slow, j, n + 1, outputs, ROW_PLASTIC);
    }

    /* The mat of the core, where it lifts: forces -Kc z g = K z F / K_theta on the nodes. */
    memset(outputs, 0, sizeof outputs);
    if (core && core->uplift.theta_up > 0)
        storey_forces(m, core->K, m->z + 1, 1, outputs, outputs + n);
    for (int k = 0; core && core->uplift.theta_up > 0 && k < 2 * n; k++)
        outputs[k] /= core->base.rotation;
    put_row(m, 0, 0, 2 * n + 1, outputs, ROW_MAT);
    put_row(m, m->at_both, 0, 2, (double[]){outputs[0], outputs[n]}, ROW_MAT);
}

/* Squares of rows (n, 8) over those of omega, NULL: 1. */
static void set_squares(int n, const double rows[], const double omega[], double squares[])
{
    for (int i = 0; i < n * LANES8; i++) {
        const double r = rows[i] / (omega ? omega[i / LANES8] : 1);
        squares[i] = r * r;
    }
}

void force_monitor_set(ForceMonitor *m, const SceneOptions *o, const Building *b, const CoreBeam *core, int joined,
                       const double thickness[2])
{
    const int n = m->n;
    m->options = *o;
    m->core = core;
    m->nc = core ? n : 0;
    m->own_modes = joined ? 0 : m->nc;
    m->with_storeys = !o->sim.measures_only;
    m->yields = b->yields;
    m->weight_n = 0;
    for (int s = 0; s < n; s++)
        m->z[s + 1] = m->z[s] + b->storey_m[s];
    for (int i = 0; i < n * n; i++)
        m->weight_n += b->M[i] * GRAVITY;
    m->thickness[0] = core ? thickness[0] : 0;
    m->thickness[1] = core ? thickness[1] : 0;
    for (int i = 0; i < m->n_groups; i++)
        m->group[i].building = joined || i >= m->at_both ? m->group[i].room : NULL;
    set_rows(m, b, core, joined);

    /* What bounds the outputs (ForceReach): rows squared, over w^2 of displacements; sums over plastic drifts. */
    for (int i = 0; i < m->n_groups; i++) {
        Group *g = &m->group[i];
        memset(g->reach, 0, sizeof g->reach);
        g->reach[REACH_MAT] = V8_ABS(g->mat);
        for (int k = 0; k < LANES8 * n && b->yields && i >= m->at_both && i < m->at_velocity; k++)
            g->reach[REACH_PLASTIC][k % LANES8] += fabs(g->plastic[k]);
        if (g->building)
            set_squares(m->nb, g->building, g->of_velocities ? NULL : b->model.omega, g->building_squares);
        if (g->core && m->own_modes > 0)
            set_squares(n, g->core, core->omega, g->core_squares);
    }
}

/* -- points ----------------------------------------------------------------------------------------------------- */

/* Is there a core, are the building's storeys wanted? */
static int is_followed(const ForceMonitor *m, int group)
{
    return group < m->at_slow ? m->nc > 0 : group == m->at_slow || m->with_storeys;
}

void force_monitor_start(ForceMonitor *m, int core_modes, double end)
{
    m->end = end * (1 - 1e-12);
    m->core_modes = m->own_modes ? core_modes : 0;
    m->has_residual = m->core_modes < m->own_modes;
    m->n_due = m->rising = 0;
    m->looks = 0;
    for (int q = 0; q < N_REACHES; q++)
        memset(m->limit[q], 0, sizeof(double) * (size_t)(eights(m->n_groups) * LANES8));
    for (int i = 0; i < m->n_groups; i++) {
        Group *g = &m->group[i];
        g->points = g->look = g->set = 0;
        g->rose = 0;
        for (int k = 0; k < LANES8; k++)
            g->peak[k] = k < g->outputs ? 0 : HUGE_VAL;
        if (is_followed(m, i))
            m->due[m->n_due++] = i;
        if (!g->core)
            continue;

        /* What the modes left out add: quasi-static answers to the contacts and to the ground. */
        memset(g->force, 0, sizeof(double) * (size_t)((m->n + 1) * LANES8)); /* and the ground */
        for (int l = m->core_modes; l < m->own_modes; l++) {
            const double *row = g->core + l * LANES8, omega = m->core->omega[l], flexibility = 1 / (omega * omega);
            for (int k = 0; k < LANES8; k++) {
                g->ground[k] -= m->core->gamma[l] * flexibility * row[k];
                for (int j = 0; j < m->n; j++)
                    g->force[j * LANES8 + k] -= m->core->phi[j * m->n + l] * flexibility * row[k];
            }
        }
        for (int k = 0; k < LANES8; k++) {
            g->reach[REACH_GROUND][k] = fabs(g->ground[k]);
            g->reach[REACH_FORCE][k] = 0;
            for (int j = 0; j < m->n; j++)
                g->reach[REACH_FORCE][k] = fmax(g->reach[REACH_FORCE][k], fabs(g->force[j * LANES8 + k]));
        }
    }
    memset(&m->sum, 0, sizeof m->sum);
    memset(m->open, 0, sizeof m->open);
    if (m->contact)
        m->contact(NULL, m->contact_user);
}

/* sum += x_i rows_i, of which every second goes to `more`: each sum waits for its own last product. */
#define ADD_ROWS(count, rows, x, sum, more)                                                                            \
    do {                                                                                                               \
        const v8 *row_ = (const v8 *)(rows);                                                                           \
        int i_ = 0;                                                                                                    \
        for (; i_ + 2 <= (count); i_ += 2) {                                                                           \
            sum += row_[i_] * (x)[i_];                                                                                 \
            more += row_[i_ + 1] * (x)[i_ + 1];                                                                        \
        }                                                                                                              \
        if (i_ < (count))                                                                                              \
            sum += row_[i_] * (x)[i_];                                                                                 \
    } while (0)

/* Raises peaks to the parabola's of those outputs of the last point that are the largest of three: through (-h0, y0),
 * (0, y1), (h1, y2), |y1| the largest. */
static __attribute__((noinline)) void raise_tops(Group *g, const m8 *tops, const v8 *now, double t)
{
    const double h0 = g->t[0] - g->t[1], h1 = t - g->t[0];
    for (int k = 0; k < LANES8; k++) {
        const double y1 = g->last[k], d0 = (y1 - g->first[k]) / h0, d1 = ((*now)[k] - y1) / h1;
        const double curvature = (d1 - d0) / (h0 + h1), slope = d0 + curvature * h0;
        if ((*tops)[k])
            g->peak[k] = fmax(g->peak[k], curvature == 0 ? fabs(y1) : fabs(y1 - 0.25 * slope * slope / curvature));
    }
}

/* The outputs of a group at a point. */
static inline __attribute__((always_inline)) void find_outputs(const ForceMonitor *m, const Group *g,
                                                               const ForcePoint *p, v8 *out)
{
    v8 now = {0}, more = {0};
    if (g->building)
        ADD_ROWS(m->nb, g->building, g->of_velocities ? p->building_v : p->building_q, now, more);
    if (m->yields && g->building && p->plastic && !g->of_velocities)
        ADD_ROWS(m->n, g->plastic, p->plastic, now, more);
    if (g->core)
        ADD_ROWS(m->core_modes, g->core, p->core_q, now, more);
    if (g->core && m->has_residual) {
        more += *(const v8 *)g->ground * p->ground;
        for (FloorSet in = p->in_contact; in; in &= in - 1) {
            const int j = floor_set_first(in);
            more += ((const v8 *)g->force)[j] * p->force[j];
        }
    }
    if (p->mat_nm != 0)
        more += g->mat * p->mat_nm;
    *out = now + more;
}

CLONED void force_monitor_point(ForceMonitor *m, const ForcePoint *p)
{
    m->rising = 0;
    for (int i = 0; i < m->n_due; i++) {
        Group *g = &m->group[m->due[i]];
        if (m->looks > g->look + 1)
            g->points = 0;
        g->look = m->looks;
        if (g->points > 0 && !(p->t > g->t[0] && p->t >= fmin(g->t[0] + g->spacing, m->end)))
            continue;
        v8 now;
        find_outputs(m, g, p, &now);
        const v8 y = V8_ABS(now), first = V8_ABS(g->first);
        const m8 higher = y > g->peak;
        if (g->rose && g->points > 1) {
            const v8 beside = V8_WHERE(first > y, first, y);
            const m8 tops = V8_ABS(g->last) >= V8_WHERE(beside > g->peak, beside, g->peak);
            if (m8_any(&tops))
                raise_tops(g, &tops, &now, p->t);
        }
        g->rose = m8_any(&higher);
        m->rising += g->rose;
        if (g->rose) {
            g->peak = V8_WHERE(y > g->peak, y, g->peak);
            g->stale = 1;
        }
        g->first = g->last;
        g->last = now;
        g->t[1] = g->t[0];
        g->t[0] = p->t;
        g->points++;
    }
}

/* -- what may rise ---------------------------------------------------------------------------------------------- */

/* sqrt(squares_0 largest_0), and of the sum of the others. */
CLONED static void set_reach(int count, const double squares[], const double largest[], v8 reach[2])
{
    v8 first = *(const v8 *)squares * largest[0], sum = {0}, more = {0};
    ADD_ROWS(count - 1, squares + LANES8, largest + 1, sum, more);
    sum += more;
    for (int k = 0; k < LANES8; k++) {
        reach[0][k] = sqrt(first[k]);
        reach[1][k] = sqrt(sum[k]);
    }
}

/* The largest over the outputs of a group. */
CLONED static void set_limits(ForceMonitor *m, int i)
{
    Group *g = &m->group[i];
    const v8 least = (v8){0} + 1e-290, scale = 1 / V8_WHERE(g->peak > least, g->peak, least);
    g->stale = 0;
    g->set = m->looks;
    for (int q = 0; q < N_REACHES && is_followed(m, i); q++) {
        v8 most = g->reach[q] * scale, turned = __builtin_shufflevector(most, most, 4, 5, 6, 7, 0, 1, 2, 3);
        most = V8_WHERE(most > turned, most, turned);
        turned = __builtin_shufflevector(most, most, 2, 3, 0, 1, 6, 7, 4, 5);
        most = V8_WHERE(most > turned, most, turned);
        m->limit[q][i] = most[0] > most[1] ? most[0] : most[1];
    }
}

void force_monitor_energies(ForceMonitor *m, const double building[], const double core[])
{
    for (int i = 0; i < m->n_groups; i++) {
        Group *g = &m->group[i];
        if (!is_followed(m, i))
            continue;
        if (g->building)
            set_reach(m->nb, g->building_squares, building, &g->reach[REACH_BUILDING_1]);
        if (g->core && m->core_modes > 0)
            set_reach(m->core_modes, g->core_squares, core, &g->reach[REACH_CORE_1]);
        set_limits(m, i);
    }
}

/* Limits that are too strict for a while cost less than to follow every rise of a peak. */
enum { LOOKS_BETWEEN = 4 };

enum { GROUPS_MAX = 4 * FLOORS_MAX / LANES8 + 8 };

CLONED int force_monitor_may_rise(ForceMonitor *m, const ForceReach *r)
{
    m8 over[GROUPS_MAX / LANES8], all = {0};
    m->looks++;
    m->n_due = 0;

    /* 1. Group by group: may it come near a peak? */
    for (int b = 0; b < eights(m->n_groups); b++) {
        v8 sum = {0};
        for (int q = 0; q < N_REACHES; q++)
            sum += ((const v8 *)m->limit[q])[b] * r->by[q];
        over[b] = ~(sum <= 1);
        all |= over[b];
    }
    if (!m8_any(&all) && m->rising == 0)
        return 0;

    /* 2. The limits of these are set anew, if they are out of date. */
    for (int i = 0; i < m->n_groups; i++) {
        const Group *g = &m->group[i];
        const int rises = g->rose && g->look == m->looks - 1; /* its top may lie before the next point */
        int is_over = over[i / LANES8][i % LANES8] != 0;
        if (!rises && is_over && g->stale && m->looks >= g->set + LOOKS_BETWEEN) {
            double sum = 0;
            set_limits(m, i);
            for (int q = 0; q < N_REACHES; q++)
                sum += m->limit[q][i] * r->by[q];
            is_over = !(sum <= 1);
        }
        if (rises || is_over)
            m->due[m->n_due++] = i;
    }
    m->rising = 0;
    return m->n_due > 0;
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
    force_monitor_impulse(m, floor, impulse);
    c->lost += lost;
    c->force = fmax(c->force, force);
    c->indentation = fmax(c->indentation, indentation);
    m->sum.contact_force_n[side][floor] = fmax(m->sum.contact_force_n[side][floor], force);
    m->sum.indentation_m[side][floor] = fmax(m->sum.indentation_m[side][floor], indentation);
}

void force_monitor_impulse(ForceMonitor *m, int floor, double impulse)
{
    SimContact *c = &m->open[floor];
    c->impulse += impulse;
    m->sum.contact_impulse_ns[index_of(c->side)][floor] += impulse;
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

/* -- results ---------------------------------------------------------------------------------------------------- */

/* Stresses of the core's storeys, where its section has a shape, and how near its walls come to buckling. */
static void report_stresses(const ForceMonitor *m, SimForces *out)
{
    const CoreOptions *o = &m->options.core;
    out->stress_known = m->nc > 0 && core_section(o) != CORE_EFFECTIVE;
    out->buckling_known = m->nc > 0 && core_section(o) == CORE_BOX;
    for (int s = 0; s < m->n && out->stress_known; s++) {
        const CoreStorey c = core_beam_storey(o, m->n, s, m->thickness[0], m->thickness[1]);
        const double moment = fmax(out->core_moment_nm[s], s + 1 < m->n ? out->core_moment_nm[s + 1] : 0);
        const double gross = moment * 0.5 * c.depth / c.inertia, factor = core_wall_factor(o);
        const double buckling = out->buckling_known ? wall_buckling_pa(o, c.thickness, m->z[s + 1] - m->z[s]) : 0;
        const WallState wall =
            o->wall == WALL_EFFECTIVE ? wall_effective(gross, buckling) : (WallState){gross / factor, factor};
        const double stress = out->core_storey_stress_pa[s] = wall.stress;
        if (stress > out->core_stress_pa) {
            out->core_stress_pa = stress;
            out->core_stress_storey = s;
        }
        out->core_shear_stress_pa = fmax(out->core_shear_stress_pa, out->core_shear_n[s] * c.shear_stress_per_n);
        if (!out->buckling_known)
            continue;
        out->core_slenderness[s] = (o->width_m - 2 * c.thickness) / c.thickness;
        out->core_buckling_pa[s] = buckling;
        out->core_wall_share[s] = wall.share;
        out->core_wall_share_off =
            fmax(out->core_wall_share_off, fabs(wall.share / (o->wall_share[s] > 0 ? o->wall_share[s] : factor) - 1));
        out->core_buckling_ratio = fmax(out->core_buckling_ratio, stress / out->core_buckling_pa[s]);
    }
}

/* Of output k of the groups from `at` on. */
static double peak_of(const ForceMonitor *m, int at, int k)
{
    return m->group[at + k / LANES8].peak[k % LANES8];
}

void force_monitor_report(ForceMonitor *m, double t, SimForces *out)
{
    const int n = m->n;
    for (int j = 0; j < n; j++)
        if (m->open[j].open) {
            m->open[j].duration = t - m->open[j].t;
            if (m->contact)
                m->contact(&m->open[j], m->contact_user);
        }
    *out = m->sum;
    for (int s = 0; s < n; s++) {
        out->building_shear_n[s] = m->with_storeys || s == 0 ? peak_of(m, m->at_slow, s > 0 ? s + 1 : 0) : NAN;
        out->peak_velocity_m_s[s] = m->with_storeys ? peak_of(m, m->at_velocity, s) : NAN;
        out->core_shear_n[s] = peak_of(m, 0, s);
        out->core_moment_nm[s] = peak_of(m, 0, n + s);
    }
    out->building_base_shear_n = out->building_shear_n[0];
    out->building_overturning_nm = peak_of(m, m->at_slow, 1);
    out->core_base_shear_n = out->core_shear_n[0];
    out->core_overturning_nm = out->core_moment_nm[0];
    out->core_top_m = peak_of(m, 0, 2 * n);
    out->base_shear_n = m->nc > 0 ? peak_of(m, m->at_both, 0) : out->building_base_shear_n;
    out->overturning_nm = m->nc > 0 ? peak_of(m, m->at_both, 1) : out->building_overturning_nm;
    out->base_shear_ratio = m->weight_n > 0 ? out->base_shear_n / m->weight_n : 0;
    for (int side = 0; side < SIDES; side++)
        for (int j = 0; j < n; j++)
            out->contact_force_max_n = fmax(out->contact_force_max_n, out->contact_force_n[side][j]);
    report_stresses(m, out);
    if (m->nc == 0)
        out->core_base_shear_n = out->core_overturning_nm = out->core_top_m = NAN;
    if (!out->stress_known)
        out->core_stress_pa = out->core_shear_stress_pa = NAN;
    if (!out->buckling_known)
        out->core_buckling_ratio = NAN;

    /* The springs of the foundation carry the shear and the moment of the base. */
    const Foundation f = m->nc > 0 ? m->core->base : (Foundation){0};
    const double weight = m->nc > 0 ? core_beam_weight(m->core) : 0;
    out->base_rotation_rad = f.rotation > 0 ? out->core_overturning_nm / f.rotation : NAN;
    out->base_translation_m = f.translation > 0 ? out->core_base_shear_n / f.translation : NAN;
    out->uplift_ratio = f.radius_m > 0 ? out->core_overturning_nm / foundation_uplift_nm(&f, weight) : NAN;
    out->anchor_force_n = f.radius_m == 0 ? NAN
                          : f.anchors > 0 ? core_beam_anchor(m->core)
                                          : fmax(out->uplift_ratio - 1, 0) * weight;
}
