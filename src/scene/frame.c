#include "scene/frame.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/linalg.h"
#include "scene/beam.h"

/* ---- assembly: unknowns --------------------------------------------------------------------------------------- */

enum { HELD = -1, ENDS = 2, LOCAL = ENDS * FRAME_DOFS };

/* Unknowns 0..n_slaves-1 are removed; n_slaves.. are the masters: the floors, then others that are kept. */
typedef struct {
    const Frame *frame;
    int n_slaves, n_masters, band; /* band: largest distance of two coupled slaves */
    int n_shapes;                  /* n_masters, or one more: what is missed of the ground's motion */
    int *root;                     /* (n_nodes * FRAME_DOFS) the displacement that this one equals */
    int *unknown;                  /* (n_nodes * FRAME_DOFS) its number, or HELD */
} Numbering;

/* While they are numbered: not yet, or master k. */
static const int NOT_NUMBERED = INT32_MAX;
static int as_master(int k)
{
    return HELD - 1 - k;
}

static int find_root(const Numbering *u, int i)
{
    while (u->root[i] != i)
        i = u->root[i];
    return i;
}

static void unite(Numbering *u, int a, int b)
{
    u->root[find_root(u, b)] = find_root(u, a);
}

/* The node that stands for a floor: the nearest to the middle of its nodes. */
static int floor_node(const Frame *f, int floor)
{
    double lo = HUGE_VAL, hi = -HUGE_VAL;
    int best = -1;
    for (int i = 0; i < f->n_nodes; i++)
        if (f->node[i].floor == floor) {
            lo = fmin(lo, f->node[i].x);
            hi = fmax(hi, f->node[i].x);
        }
    for (int i = 0; i < f->n_nodes; i++)
        if (f->node[i].floor == floor &&
            (best < 0 || fabs(f->node[i].x - 0.5 * (lo + hi)) < fabs(f->node[best].x - 0.5 * (lo + hi))))
            best = i;
    return best;
}

static void unite_displacements(Numbering *u, int rigid_floors)
{
    const Frame *f = u->frame;
    for (int i = 0; i < f->n_nodes * FRAME_DOFS; i++)
        u->root[i] = i;
    for (int t = 0; t < f->n_ties; t++)
        for (int d = 0; d < FRAME_DOFS; d++)
            if (f->tie[t].dof[d])
                unite(u, f->tie[t].same_as * FRAME_DOFS + d, f->tie[t].node * FRAME_DOFS + d);
    for (int floor = 1; floor <= f->n_floors && rigid_floors; floor++) {
        const int first = floor_node(f, floor);
        for (int i = 0; i < f->n_nodes; i++)
            if (f->node[i].floor == floor)
                unite(u, first * FRAME_DOFS + FRAME_X, i * FRAME_DOFS + FRAME_X);
    }
}

typedef struct {
    double z, x;
    int node;
} Place;

static int by_height(const void *a, const void *b)
{
    const Place *p = a, *q = b;
    if (p->z != q->z)
        return p->z < q->z ? -1 : 1;
    if (p->x != q->x)
        return p->x < q->x ? -1 : 1;
    return p->node - q->node;
}

/* What is not yet numbered, from the bottom up, which keeps the band narrow. kept (by displacement; NULL: none):
 * masters, the others are slaves. */
static Status number_the_rest(Numbering *u, const char *kept, Err *err)
{
    const Frame *f = u->frame;
    Place *place = malloc((size_t)f->n_nodes * sizeof *place);
    if (!place)
        return fail(err, STATUS_NO_MEMORY, "frame: no memory for %d nodes", f->n_nodes);
    for (int i = 0; i < f->n_nodes; i++)
        place[i] = (Place){f->node[i].z, f->node[i].x, i};
    qsort(place, (size_t)f->n_nodes, sizeof *place, by_height);
    for (int k = 0; k < f->n_nodes; k++)
        for (int d = 0; d < FRAME_DOFS; d++) {
            const int root = find_root(u, place[k].node * FRAME_DOFS + d);
            if (u->unknown[root] == NOT_NUMBERED)
                u->unknown[root] = kept && kept[root] ? as_master(u->n_masters++) : u->n_slaves++;
        }
    free(place);
    return STATUS_OK;
}

/* Held, floors, the rest, in this order; an unknown that equals a held one is held. */
static Status number_unknowns(Numbering *u, const char *kept, Err *err)
{
    const Frame *f = u->frame;
    const int n = f->n_nodes * FRAME_DOFS;
    for (int i = 0; i < n; i++)
        u->unknown[i] = NOT_NUMBERED;
    for (int i = 0; i < n; i++)
        if (f->node[i / FRAME_DOFS].fixed[i % FRAME_DOFS])
            u->unknown[find_root(u, i)] = HELD;
    for (int floor = 1; floor <= f->n_floors; floor++) {
        int *unknown = &u->unknown[find_root(u, floor_node(f, floor) * FRAME_DOFS + FRAME_X)];
        if (*unknown != NOT_NUMBERED)
            return fail(err, STATUS_BAD_DATA, "frame: floor %d cannot move by itself: it is held or tied", floor);
        *unknown = as_master(u->n_masters++);
    }
    TRY(number_the_rest(u, kept, err));
    for (int i = 0; i < n; i++) {
        int *unknown = &u->unknown[find_root(u, i)];
        if (*unknown < HELD)
            *unknown = u->n_slaves + as_master(*unknown);
    }
    for (int i = 0; i < n; i++)
        u->unknown[i] = u->unknown[find_root(u, i)];
    return STATUS_OK;
}

static void element_unknowns(const Numbering *u, const FrameElement *e, int at[LOCAL])
{
    for (int k = 0; k < LOCAL; k++)
        at[k] = u->unknown[e->node[k / FRAME_DOFS] * FRAME_DOFS + k % FRAME_DOFS];
}

static void find_band(Numbering *u)
{
    for (int e = 0; e < u->frame->n_elements; e++) {
        int at[LOCAL], lo = INT32_MAX, hi = -1;
        element_unknowns(u, &u->frame->element[e], at);
        for (int k = 0; k < LOCAL; k++)
            if (at[k] >= 0 && at[k] < u->n_slaves) {
                lo = at[k] < lo ? at[k] : lo;
                hi = at[k] > hi ? at[k] : hi;
            }
        u->band = hi - lo > u->band ? hi - lo : u->band;
    }
}

/* ---- assembly: elements --------------------------------------------------------------------------------------- */

/* The moment at end r of the bending part vanishes: the rotation there follows the other three unknowns statically. */
static void release(double k[4][4], double m[4][4], int r)
{
    double follow[4], column[4];
    const double pivot = k[r][r], inertia = m[r][r];
    for (int i = 0; i < 4; i++) {
        follow[i] = pivot > 0 && i != r ? -k[r][i] / pivot : 0;
        column[i] = i != r ? m[i][r] : 0;
    }
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++) {
            k[i][j] = i == r || j == r ? 0 : k[i][j] - pivot * follow[i] * follow[j];
            m[i][j] = i == r || j == r
                          ? 0
                          : m[i][j] + follow[i] * column[j] + column[i] * follow[j] + inertia * follow[i] * follow[j];
        }
}

static double element_length(const Frame *f, const FrameElement *e)
{
    const FrameNode *a = &f->node[e->node[0]], *b = &f->node[e->node[1]];
    return hypot(b->x - a->x, b->z - a->z);
}

/* Bending and stretching in one matrix of x, z, rotation along the element. */
static void join(const double bend[4][4], double along_same, double along_other, double joined[LOCAL][LOCAL])
{
    static const int BENDING[4] = {1, 2, 4, 5}; /* deflection and rotation at each end */
    memset(joined, 0, LOCAL * sizeof joined[0]);
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++)
            joined[BENDING[i]][BENDING[j]] = bend[i][j];
    joined[0][0] = joined[3][3] = along_same;
    joined[0][3] = joined[3][0] = along_other;
}

/* a = turn' a turn, from the element's direction (c, s) to x and z. */
static void turn(double a[LOCAL][LOCAL], double c, double s)
{
    double t[LOCAL][LOCAL] = {{0}}, half[LOCAL][LOCAL] = {{0}};
    for (int end = 0; end < LOCAL; end += FRAME_DOFS) {
        t[end][end] = t[end + 1][end + 1] = c;
        t[end][end + 1] = s;
        t[end + 1][end] = -s;
        t[end + 2][end + 2] = 1;
    }
    for (int i = 0; i < LOCAL; i++)
        for (int j = 0; j < LOCAL; j++)
            for (int m = 0; m < LOCAL; m++)
                half[i][j] += a[i][m] * t[m][j];
    memset(a, 0, LOCAL * sizeof a[0]);
    for (int i = 0; i < LOCAL; i++)
        for (int j = 0; j < LOCAL; j++)
            for (int m = 0; m < LOCAL; m++)
                a[i][j] += t[m][i] * half[m][j];
}

/* Stiffness and mass of x, z, rotation at both ends; a rotation is positive from x to z. */
static void element_matrices(const Frame *f, const FrameElement *e, double k[LOCAL][LOCAL], double m[LOCAL][LOCAL])
{
    const FrameSection *s = &f->section[e->section];
    const FrameNode *a = &f->node[e->node[0]], *b = &f->node[e->node[1]];
    const double l = element_length(f, e), axial = s->E * s->area / l, mass = s->mass_per_m * l + e->added_mass;
    double bend[4][4], sway[4][4];
    beam_element(&(Beam){.EI = s->E * s->inertia, .kGA = s->kGA, .mass_per_m = mass / l, .length = l}, bend, sway);
    for (int end = 0; end < ENDS; end++)
        if (e->pinned[end])
            release(bend, sway, 2 * end + 1);
    join(bend, axial, -axial, k);
    join(sway, mass / 3, mass / 6, m);
    turn(k, (b->x - a->x) / l, (b->z - a->z) / l);
    turn(m, (b->x - a->x) / l, (b->z - a->z) / l);
}

/* ---- which unknowns are kept ---------------------------------------------------------------------------------- */

static int any_is_named(const Frame *f)
{
    int named = 0;
    for (int i = 0; i < f->n_nodes * FRAME_DOFS; i++)
        named |= f->node[i / FRAME_DOFS].keep[i % FRAME_DOFS];
    return named;
}

/* Diagonal of the mass matrix by displacement, each in the place of the one that it equals. */
static void add_up_mass(const Numbering *u, double mass[])
{
    const Frame *f = u->frame;
    for (int e = 0; e < f->n_elements; e++) {
        double k[LOCAL][LOCAL], m[LOCAL][LOCAL];
        element_matrices(f, &f->element[e], k, m);
        for (int i = 0; i < LOCAL; i++)
            mass[find_root(u, f->element[e].node[i / FRAME_DOFS] * FRAME_DOFS + i % FRAME_DOFS)] += m[i][i];
    }
    for (int i = 0; i < f->n_nodes * FRAME_DOFS; i++)
        mass[find_root(u, i)] += f->node[i / FRAME_DOFS].mass[i % FRAME_DOFS];
}

/* Of the largest mass (a rotary one counts as at 1 m): what has less is condensed as if it had none. Such masses keep a
 * solver of other programs going; they would put frequencies in the model whose rounding drowns the lowest. */
static const double NEGLIGIBLE_MASS = 1e-8;

/* kept[i]: displacement i is one of the full model's: it has mass and is named in the frame, or none is named.
 * Without mass static condensation is exact. */
static Status find_kept(const Numbering *u, char kept[], Err *err)
{
    const Frame *f = u->frame;
    const int named = any_is_named(f);
    double *mass = calloc((size_t)f->n_nodes, FRAME_DOFS * sizeof *mass);
    if (!mass)
        return fail(err, STATUS_NO_MEMORY, "frame: no memory for the masses of %d nodes", f->n_nodes);
    double largest = 0;
    add_up_mass(u, mass);
    for (int i = 0; i < f->n_nodes * FRAME_DOFS; i++)
        largest = fmax(largest, mass[i]);
    for (int i = 0; i < f->n_nodes * FRAME_DOFS; i++)
        if (!named || f->node[i / FRAME_DOFS].keep[i % FRAME_DOFS])
            kept[find_root(u, i)] = mass[find_root(u, i)] > NEGLIGIBLE_MASS * largest;
    free(mass);
    return STATUS_OK;
}

/* full: with the unknowns of the full model beside the floors. */
static Status numbering_make(Numbering *u, const Frame *f, int rigid_floors, int full, Err *err)
{
    const size_t n = (size_t)f->n_nodes * FRAME_DOFS;
    *u = (Numbering){.frame = f, .root = malloc(2 * n * sizeof *u->root)};
    char *kept = full ? calloc(n, 1) : NULL;
    if (!u->root || (full && !kept)) {
        free(kept);
        return fail(err, STATUS_NO_MEMORY, "frame: no memory for %zu unknowns", n);
    }
    u->unknown = u->root + n;
    unite_displacements(u, rigid_floors);
    Status status = full ? find_kept(u, kept, err) : STATUS_OK;
    if (status == STATUS_OK)
        status = number_unknowns(u, kept, err);
    free(kept);
    u->n_shapes = u->n_masters + !full;
    if (status == STATUS_OK)
        find_band(u);
    return status;
}

/* ---- condensation --------------------------------------------------------------------------------------------- */

/* The displacement that has an unknown. */
static int displacement_of(const Numbering *u, int unknown)
{
    int i = 0;
    while (u->unknown[i] != unknown)
        i++;
    return i;
}

static Status fail_mechanism(const Numbering *u, int i, Err *err)
{
    static const char *const WORDS[] = {"moves along x", "moves along z", "turns"};
    const FrameNode *node = &u->frame->node[i / FRAME_DOFS];
    return fail(err, STATUS_BAD_DATA,
                "frame: a mechanism: nothing resists when node %s (x %g m, z %g m) %s; fix it, or connect it",
                node->name, node->x, node->z, WORDS[i % FRAME_DOFS]);
}

typedef struct {
    double *Kss;  /* (n_slaves, band + 1) lower band, column by column */
    double *T;    /* (n_shapes, n_slaves) displacements of the slaves per unit of a master, row by row */
    double *diag; /* (n_slaves) of Kss before it is factored */
    double *size; /* (n_shapes) sum of the magnitudes of the terms of a diagonal entry of K; what rounding leaves of a
                   * mechanism is a part of it */
} Slaves;

static void assemble_slaves(const Numbering *u, const Slaves *s)
{
    const int n = u->n_slaves, height = u->band + 1;
    for (int e = 0; e < u->frame->n_elements; e++) {
        int at[LOCAL];
        double k[LOCAL][LOCAL], m[LOCAL][LOCAL];
        element_unknowns(u, &u->frame->element[e], at);
        element_matrices(u->frame, &u->frame->element[e], k, m);
        for (int i = 0; i < LOCAL; i++)
            for (int j = 0; j < LOCAL; j++) {
                if (at[i] < 0 || at[i] >= n || at[j] < 0)
                    continue;
                if (at[j] >= n)
                    s->T[(size_t)(at[j] - n) * (size_t)n + (size_t)at[i]] -= k[i][j];
                else if (at[i] >= at[j])
                    s->Kss[(size_t)at[j] * (size_t)height + (size_t)(at[i] - at[j])] += k[i][j];
            }
    }
    for (int i = 0; i < n; i++)
        s->diag[i] = s->Kss[(size_t)i * (size_t)height];
}

/* A pivot that has lost so many digits is zero but for rounding. */
static const double PIVOT_LOST = 1e-11, SWAY_LOST = 1e-12;

static Status solve_slaves(const Numbering *u, Slaves *s, Err *err)
{
    const int n = u->n_slaves, height = u->band + 1;
    if (n == 0)
        return STATUS_OK;
    const int info = linalg_factor_band(n, u->band, s->Kss);
    if (info < 0)
        return fail(err, STATUS_NO_MEMORY, "frame: no memory to factor %d unknowns", n);
    if (info > 0)
        return fail_mechanism(u, displacement_of(u, info - 1), err);
    for (int i = 0; i < n; i++)
        if (pow(s->Kss[(size_t)i * (size_t)height], 2) < PIVOT_LOST * s->diag[i])
            return fail_mechanism(u, displacement_of(u, i), err);
    linalg_solve_band(n, u->band, s->Kss, u->n_masters, s->T);
    return STATUS_OK;
}

/* The shape behind the masters': r, 1 of every slave along x, less what all masters together move of it. */
static void find_missed(const Numbering *u, const Slaves *s)
{
    const size_t n = (size_t)u->n_slaves, masters = (size_t)u->n_masters;
    if (u->n_shapes == u->n_masters)
        return;
    double *missed = s->T + masters * n;
    for (int i = FRAME_X; i < u->frame->n_nodes * FRAME_DOFS; i += FRAME_DOFS)
        if (u->unknown[i] >= 0 && u->unknown[i] < u->n_slaves)
            missed[u->unknown[i]] = 1;
    for (size_t m = 0; m < masters; m++)
        for (size_t i = 0; i < n; i++)
            missed[i] -= s->T[m * n + i];
}

/* Displacement of an unknown when master m alone moves by one. */
static double displacement(const Numbering *u, const Slaves *s, int unknown, int m)
{
    if (unknown < 0)
        return 0;
    if (unknown >= u->n_slaves)
        return unknown - u->n_slaves == m;
    return s->T[(size_t)m * (size_t)u->n_slaves + (size_t)unknown];
}

/* A of an element whose unknowns are all masters. */
static void add_masters(const Numbering *u, const int at[LOCAL], const double a[LOCAL][LOCAL], double A[])
{
    for (int i = 0; i < LOCAL; i++)
        for (int j = 0; j < LOCAL; j++)
            if (at[i] >= 0 && at[j] >= 0)
                A[(at[i] - u->n_slaves) * u->n_shapes + at[j] - u->n_slaves] += a[i][j];
}

static int has_slave(const Numbering *u, const int at[LOCAL])
{
    int any = 0;
    for (int i = 0; i < LOCAL; i++)
        any |= at[i] >= 0 && at[i] < u->n_slaves;
    return any;
}

/* A += T' a T of one element. */
static void add_element(const Numbering *u, const Slaves *s, const int at[LOCAL], const double a[LOCAL][LOCAL],
                        double A[])
{
    const int n = u->n_shapes;
    if (!has_slave(u, at)) {
        add_masters(u, at, a, A);
        return;
    }
    for (int p = 0; p < n; p++) {
        double force[LOCAL] = {0};
        for (int i = 0; i < LOCAL; i++)
            for (int j = 0; j < LOCAL; j++)
                force[i] += a[i][j] * displacement(u, s, at[j], p);
        for (int q = 0; q < n; q++)
            for (int i = 0; i < LOCAL; i++)
                A[p * n + q] += force[i] * displacement(u, s, at[i], q);
    }
}

static void add_node(const Numbering *u, const Slaves *s, int i, double M[])
{
    const double *mass = u->frame->node[i].mass;
    const int n = u->n_shapes;
    for (int d = 0; d < FRAME_DOFS; d++)
        for (int p = 0; p < n && mass[d] > 0; p++) {
            const int unknown = u->unknown[i * FRAME_DOFS + d];
            for (int q = 0; q < n; q++)
                M[p * n + q] += mass[d] * displacement(u, s, unknown, p) * displacement(u, s, unknown, q);
        }
}

static void add_size(const Numbering *u, const Slaves *s, const int at[LOCAL], const double k[LOCAL][LOCAL])
{
    for (int p = 0; p < u->n_shapes; p++) {
        double t[LOCAL];
        for (int i = 0; i < LOCAL; i++)
            t[i] = displacement(u, s, at[i], p);
        for (int i = 0; i < LOCAL; i++)
            for (int j = 0; j < LOCAL; j++)
                s->size[p] += fabs(k[i][j] * t[i] * t[j]);
    }
}

static void sum_up(const Numbering *u, const Slaves *s, double K[], double M[])
{
    const Frame *f = u->frame;
    for (int e = 0; e < f->n_elements; e++) {
        int at[LOCAL];
        double k[LOCAL][LOCAL], m[LOCAL][LOCAL];
        element_unknowns(u, &f->element[e], at);
        element_matrices(f, &f->element[e], k, m);
        add_size(u, s, at, k);
        add_element(u, s, at, k, K);
        add_element(u, s, at, m, M);
    }
    for (int i = 0; i < f->n_nodes; i++)
        add_node(u, s, i, M);
}

/* The displacement with the largest part in the motion v (n_masters) of the masters. */
static int moves_most(const Numbering *u, const Slaves *s, const double v[])
{
    double most = 0;
    int best = 0;
    for (int i = 0; i < u->frame->n_nodes * FRAME_DOFS; i++) {
        double part = 0;
        for (int m = 0; m < u->n_masters; m++)
            part += v[m] * displacement(u, s, u->unknown[i], m);
        if (i % FRAME_DOFS != FRAME_ROT && fabs(part) > most * (1 + 1e-9)) {
            most = fabs(part);
            best = i;
        }
    }
    return best;
}

/* Master p follows those before it without resistance: v = [-K11^-1 k1p; 1; 0] is in the null space of K. */
static Status fail_sway(const Numbering *u, const Slaves *s, int p, const double K[], Err *err)
{
    const int n = u->n_shapes;
    double *A = calloc((size_t)(p * p + n + 1), sizeof *A);
    if (!A)
        return fail(err, STATUS_NO_MEMORY, "frame: no memory to factor %d x %d", p, p);
    double *v = A + p * p;
    for (int i = 0; i < p; i++) {
        memcpy(&A[i * p], &K[i * n], (size_t)p * sizeof *A);
        v[i] = -K[i * n + p];
    }
    v[p] = 1;
    Status status = p > 0 ? linalg_solve_spd(p, 1, A, v, err) : STATUS_OK;
    if (status == STATUS_OK)
        status = fail_mechanism(u, moves_most(u, s, v), err);
    free(A);
    return status;
}

static Status check_sway(const Numbering *u, const Slaves *s, const double K[], Err *err)
{
    const int n = u->n_masters;
    double *L = malloc((size_t)(n * n) * sizeof *L);
    int p = 0, info = -1;
    for (int j = 0; L && j < n; j++)
        for (int i = j; i < n; i++)
            L[j * n + i - j] = K[i * u->n_shapes + j];
    if (L)
        info = linalg_factor_band(n, n - 1, L);
    const int factored = info > 0 ? info - 1 : n;
    while (L && p < factored && L[p * n] * L[p * n] > SWAY_LOST * s->size[p])
        p++;
    free(L);
    if (info < 0)
        return fail(err, STATUS_NO_MEMORY, "frame: no memory to factor %d x %d", n, n);
    return p < n ? fail_sway(u, s, p, K, err) : STATUS_OK;
}

static Status check_mass(const Numbering *u, const double M[], Err *err)
{
    for (int k = 0; k < u->frame->n_floors; k++)
        if (!(M[k * u->n_shapes + k] > 0))
            return fail(err, STATUS_BAD_DATA,
                        "frame: floor %d (node %s) has no mass: give masses.csv, mass_kg_per_m or added_mass_kg", k + 1,
                        u->frame->node[displacement_of(u, u->n_slaves + k) / FRAME_DOFS].name);
    return STATUS_OK;
}

static Status condense(const Numbering *u, double K[], double M[], Err *err)
{
    const size_t n = (size_t)u->n_slaves, shapes = (size_t)u->n_shapes, band = (size_t)u->band + 1;
    Slaves s = {.Kss = calloc(n * band + shapes * n + n + shapes + 1, sizeof *s.Kss)};
    if (!s.Kss)
        return fail(err, STATUS_NO_MEMORY, "frame: no memory for %zu unknowns, band %zu", n, band);
    s.T = s.Kss + n * band;
    s.diag = s.T + shapes * n;
    s.size = s.diag + n;
    assemble_slaves(u, &s);
    Status status = solve_slaves(u, &s, err);
    if (status == STATUS_OK) {
        find_missed(u, &s);
        sum_up(u, &s, K, M);
    }
    if (status == STATUS_OK)
        status = check_sway(u, &s, K, err);
    if (status == STATUS_OK)
        status = check_mass(u, M, err);
    free(s.Kss);
    return status;
}

/* Of the ground's load: the missed shape's part of it below which that shape is left out. */
static const double MISSED_MIN = 1e-3;

static int is_missed(int n, const double M[])
{
    double load = 0, missed = 0;
    for (int p = 0; p < n; p++) {
        for (int q = 0; q < n; q++)
            load += M[p * n + q];
        missed += fabs(M[p * n + n - 1]);
    }
    return missed > MISSED_MIN * load;
}

/* Without the last shape: rows of one number fewer. */
static void drop_last(FrameFull *out)
{
    const size_t n = (size_t)out->n, fewer = n - 1;
    for (size_t p = 1; p < fewer; p++) {
        memmove(out->K + p * fewer, out->K + p * n, fewer * sizeof *out->K);
        memmove(out->M + p * fewer, out->M + p * n, fewer * sizeof *out->M);
    }
    out->n--;
}

/* Masters that move along x follow the ground, and so does what they miss of it. */
static void find_influence(const Numbering *u, double influence[])
{
    for (int i = FRAME_X; i < u->frame->n_nodes * FRAME_DOFS; i += FRAME_DOFS)
        if (u->unknown[i] >= u->n_slaves)
            influence[u->unknown[i] - u->n_slaves] = 1;
    if (u->n_shapes > u->n_masters)
        influence[u->n_masters] = 1;
}

static Status reduce(const Numbering *u, FrameFull *out, Err *err)
{
    const size_t n = (size_t)u->n_shapes, nn = n * n;
    out->n = u->n_shapes;
    out->K = calloc(2 * nn + n, sizeof *out->K);
    if (!out->K)
        return fail(err, STATUS_NO_MEMORY, "frame: no memory for %zu degrees of freedom", n);
    out->M = out->K + nn;
    out->influence = out->M + nn;
    find_influence(u, out->influence);
    TRY(condense(u, out->K, out->M, err));
    if (u->n_shapes > u->n_masters && !is_missed(out->n, out->M))
        drop_last(out);
    return STATUS_OK;
}

Status frame_reduce(const Frame *f, int rigid_floors, FrameKept kept, FrameFull *out, Err *err)
{
    Numbering u;
    *out = (FrameFull){0};
    Status status = numbering_make(&u, f, rigid_floors, kept == FRAME_FULL, err);
    if (status == STATUS_OK)
        status = reduce(&u, out, err);
    free(u.root);
    if (status != STATUS_OK)
        frame_full_free(out);
    return status;
}

void frame_full_free(FrameFull *full)
{
    free(full->K);
    *full = (FrameFull){0};
}
