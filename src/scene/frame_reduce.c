#include "base/linalg.h"
#include "scene/core_beam.h"
#include "scene/frame.h"

/* ---- unknowns ------------------------------------------------------------------------------------------------- */

enum { ENDS = 2, LOCAL = ENDS * FRAME_DOFS };

/* Unknowns 0..n_slaves-1 are removed; from n_slaves on are the masters: the floors, then others that are kept; n, one
 * more than there are, stands for what the ground holds. */
typedef struct {
    const Frame *frame;
    int n_slaves, n, band; /* band: largest distance of two coupled slaves */
    int n_shapes;          /* masters, or one more: what is missed of the ground's motion */
    int *unknown;          /* (displacements) */
} Numbering;

static int n_displacements(const Frame *f)
{
    return f->n[FRAME_NODES] * FRAME_DOFS;
}

static int n_masters(const Numbering *u)
{
    return u->n - u->n_slaves;
}

/* The displacement that this one equals. */
static int root_of(const Frame *f, int i)
{
    return frame_followed(f, i / FRAME_DOFS, i % FRAME_DOFS) * FRAME_DOFS + i % FRAME_DOFS;
}

typedef struct {
    double z, x;
    int node;
} Place;

/* From the bottom up, which keeps the band narrow. */
static int by_height(const void *a, const void *b)
{
    const Place *p = a, *q = b;
    if (p->z != q->z)
        return p->z < q->z ? -1 : 1;
    if (p->x != q->x)
        return p->x < q->x ? -1 : 1;
    return p->node - q->node;
}

/* What becomes of a displacement that follows no other; before it has a number this stands in the place of that. */
enum { HELD = -4, FLOOR, KEPT, SLAVE };

/* Numbers from `next` on for what is of one kind; returns the next one. */
static int number_kind(Numbering *u, const Place place[], int kind, int next)
{
    for (int k = 0; k < n_displacements(u->frame); k++) {
        int *unknown = &u->unknown[root_of(u->frame, place[k / FRAME_DOFS].node * FRAME_DOFS + k % FRAME_DOFS)];
        if (*unknown == kind)
            *unknown = next++;
    }
    return next;
}

/* Held, floors, slaves; an unknown that equals a held one is held. */
static Status sort_unknowns(Numbering *u, Err *err)
{
    const Frame *f = u->frame;
    for (int i = 0; i < n_displacements(f); i++)
        if (f->node[i / FRAME_DOFS].fixed[i % FRAME_DOFS])
            u->unknown[root_of(f, i)] = HELD;
    for (int floor = 1; floor <= f->n_floors; floor++) {
        int *unknown = &u->unknown[root_of(f, frame_floor_node(f, floor) * FRAME_DOFS + FRAME_X)];
        if (*unknown == HELD || *unknown == FLOOR)
            return bad_data(err, "frame: floor %d cannot move by itself: it is held or tied", floor);
        *unknown = FLOOR;
    }
    return STATUS_OK;
}

static Status number_unknowns(Numbering *u, Err *err)
{
    const Frame *f = u->frame;
    const int n = f->n[FRAME_NODES];
    Place *place;
    TRY_ROOM(place, n, "nodes of a frame", err);
    for (int i = 0; i < n; i++)
        place[i] = (Place){f->node[i].z, f->node[i].x, i};
    qsort(place, n, sizeof *place, by_height);
    u->n_slaves = number_kind(u, place, SLAVE, 0);
    for (int floor = 1; floor <= f->n_floors; floor++)
        u->unknown[root_of(f, frame_floor_node(f, floor) * FRAME_DOFS + FRAME_X)] = u->n_slaves + floor - 1;
    u->n = number_kind(u, place, KEPT, u->n_slaves + f->n_floors);
    free(place);
    for (int i = 0; i < n_displacements(f); i++) {
        const int unknown = u->unknown[root_of(f, i)];
        u->unknown[i] = unknown == HELD ? u->n : unknown;
    }
    return STATUS_OK;
}

static void element_unknowns(const Numbering *u, const FrameElement *e, int at[LOCAL])
{
    for (int k = 0; k < LOCAL; k++)
        at[k] = u->unknown[e->node[k / FRAME_DOFS] * FRAME_DOFS + k % FRAME_DOFS];
}

static void find_band(Numbering *u)
{
    for (int e = 0; e < u->frame->n[FRAME_ELEMENTS]; e++) {
        int at[LOCAL];
        element_unknowns(u, &u->frame->element[e], at);
        for (int k = 0; k < LOCAL * LOCAL; k++) {
            const int i = at[k / LOCAL], j = at[k % LOCAL];
            if (i < u->n_slaves && j < u->n_slaves && i - j > u->band)
                u->band = i - j;
        }
    }
}

/* ---- elements ------------------------------------------------------------------------------------------------- */

/* a = T' a T */
static void transform(int n, double a[], const double T[])
{
    double copy[LOCAL * LOCAL], work[LOCAL * LOCAL];
    memcpy(copy, a, n * n * sizeof *a);
    linalg_congruent(n, n, copy, T, work, a);
}

/* The moment at end r of the bending part vanishes: the rotation there follows the other three unknowns statically. */
static void release(double k[4][4], double m[4][4], int r)
{
    double T[4][4] = {{0}};
    for (int i = 0; i < 4; i++) {
        T[i][i] = i != r;
        T[r][i] = k[r][r] > 0 && i != r ? -k[r][i] / k[r][r] : 0;
    }
    transform(4, k[0], T[0]);
    transform(4, m[0], T[0]);
}

/* Bending and stretching of an element along (c, s) in one matrix of x, z, rotation at both ends. */
static void join_and_turn(const double bend[4][4], double along_same, double along_other, double c, double s,
                          double a[LOCAL][LOCAL])
{
    static const int BENDING[4] = {1, 2, 4, 5}; /* deflection and rotation at each end */
    double t[LOCAL][LOCAL] = {{0}};
    memset(a, 0, LOCAL * sizeof a[0]);
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++)
            a[BENDING[i]][BENDING[j]] = bend[i][j];
    a[0][0] = a[3][3] = along_same;
    a[0][3] = a[3][0] = along_other;
    for (int end = 0; end < LOCAL; end += FRAME_DOFS) {
        t[end][end] = t[end + 1][end + 1] = c;
        t[end][end + 1] = s;
        t[end + 1][end] = -s;
        t[end + 2][end + 2] = 1;
    }
    transform(LOCAL, a[0], t[0]);
}

/* Stiffness and mass of x, z, rotation at both ends; a rotation is positive from x to z. */
static void element_matrices(const Frame *f, const FrameElement *e, double k[LOCAL][LOCAL], double m[LOCAL][LOCAL])
{
    const FrameSection *s = &f->section[e->section];
    const FrameNode *a = &f->node[e->node[0]], *b = &f->node[e->node[1]];
    const double dx = b->x - a->x, dz = b->z - a->z, l = hypot(dx, dz);
    const double axial = s->E * s->area / l, mass = s->mass_per_m * l + e->added_mass;
    double bend[4][4], sway[4][4];
    beam_element(&(Beam){.EI = s->E * s->inertia,
                         .kGA = s->E / (2 * (1 + s->poisson)) * s->shear_area,
                         .mass_per_m = mass / l,
                         .length = l},
                 bend, sway);
    for (int end = 0; end < ENDS; end++)
        if (e->pinned[end])
            release(bend, sway, 2 * end + 1);
    join_and_turn(bend, axial, -axial, dx / l, dz / l, k);
    join_and_turn(sway, mass / 3, mass / 6, dx / l, dz / l, m);
}

/* ---- which unknowns are kept ---------------------------------------------------------------------------------- */

/* Diagonal of the mass matrix by displacement, each in the place of the one that it equals. */
static void add_up_mass(const Frame *f, double *mass)
{
    for (int e = 0; e < f->n[FRAME_ELEMENTS]; e++) {
        double k[LOCAL][LOCAL], m[LOCAL][LOCAL];
        element_matrices(f, &f->element[e], k, m);
        for (int i = 0; i < LOCAL; i++)
            mass[root_of(f, f->element[e].node[i / FRAME_DOFS] * FRAME_DOFS + i % FRAME_DOFS)] += m[i][i];
    }
    for (int i = 0; i < n_displacements(f); i++)
        mass[root_of(f, i)] += f->node[i / FRAME_DOFS].mass[i % FRAME_DOFS];
}

/* Of the largest mass (a rotary one counts as at 1 m): what has less is condensed as if it had none. Such masses keep a
 * solver of other programs going; they would put frequencies in the model whose rounding drowns the lowest. */
static const double NEGLIGIBLE_MASS = 1e-8;

/* A displacement is one of the full model's if it has mass and is named in the frame, or none is named. Without mass
 * static condensation is exact. */
static Status find_kept(Numbering *u, Err *err)
{
    const Frame *f = u->frame;
    const int n = n_displacements(f);
    int named = 0;
    double largest = 0, *mass = calloc(n, sizeof *mass);
    if (!mass)
        return fail_memory(err, n, "masses");
    add_up_mass(f, mass);
    for (int i = 0; i < n; i++) {
        largest = fmax(largest, mass[i]);
        named |= f->node[i / FRAME_DOFS].keep[i % FRAME_DOFS];
    }
    for (int i = 0; i < n; i++)
        if ((!named || f->node[i / FRAME_DOFS].keep[i % FRAME_DOFS]) && mass[root_of(f, i)] > NEGLIGIBLE_MASS * largest)
            u->unknown[root_of(f, i)] = KEPT;
    free(mass);
    return STATUS_OK;
}

/* full: with the unknowns of the full model beside the floors. */
static Status numbering_make(Numbering *u, const Frame *f, int full, Err *err)
{
    const int n = n_displacements(f);
    *u = (Numbering){.frame = f, .unknown = malloc(n * sizeof *u->unknown)};
    if (!u->unknown)
        return fail_memory(err, n, "unknowns");
    for (int i = 0; i < n; i++)
        u->unknown[i] = SLAVE;
    if (full)
        TRY(find_kept(u, err));
    TRY(sort_unknowns(u, err));
    TRY(number_unknowns(u, err));
    u->n_shapes = n_masters(u) + !full;
    find_band(u);
    return STATUS_OK;
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
    return bad_data(err, "frame: a mechanism: nothing resists when node %s (x %g m, z %g m) %s; fix it, or connect it",
                    node->name, node->x, node->z, WORDS[i % FRAME_DOFS]);
}

typedef struct {
    size_t rows;  /* n + 1 */
    double *Kss;  /* (n_slaves, band + 1) lower band, column by column */
    double *T;    /* (n_shapes, rows) displacements in a shape, row by row: of the slaves, 1 of its master, 0 of the
                   * ground's */
    double *F;    /* (n_shapes, rows) forces that belong to it */
    double *diag; /* (rows) of the stiffness of all unknowns */
} Shapes;

static void assemble_slaves(const Numbering *u, const Shapes *s)
{
    const int n = u->n_slaves, height = u->band + 1;
    for (int e = 0; e < u->frame->n[FRAME_ELEMENTS]; e++) {
        int at[LOCAL];
        double k[LOCAL][LOCAL], m[LOCAL][LOCAL];
        element_unknowns(u, &u->frame->element[e], at);
        element_matrices(u->frame, &u->frame->element[e], k, m);
        for (int i = 0; i < LOCAL; i++) {
            s->diag[at[i]] += k[i][i];
            for (int j = 0; j < LOCAL && at[i] < n; j++) {
                if (at[j] >= n && at[j] < u->n)
                    s->T[(at[j] - n) * s->rows + at[i]] -= k[i][j];
                else if (at[i] >= at[j])
                    s->Kss[at[j] * (size_t)height + (at[i] - at[j])] += k[i][j];
            }
        }
    }
}

/* Factors in place; a pivot that has lost so many digits of the diagonal is zero but for rounding, and what has it
 * moves without resistance. first: unknown of the first row. */
static const double PIVOT_LOST = 1e-11, SWAY_LOST = 1e-12;
static Status factor(const Numbering *u, int n, int band, double A[], const Shapes *s, int first, double lost, Err *err)
{
    const int info = n > 0 ? linalg_factor_band(n, band, A) : 0;
    const int factored = info > 0 ? info - 1 : n;
    int p = 0;
    while (p < factored && pow(A[p * (band + 1)], 2) > lost * s->diag[first + p])
        p++;
    if (info < 0)
        return fail(err, STATUS_NO_MEMORY, "frame: no memory to factor %d unknowns", n);
    return p < n ? fail_mechanism(u, displacement_of(u, first + p), err) : STATUS_OK;
}

static Status solve_slaves(const Numbering *u, const Shapes *s, Err *err)
{
    const int n = u->n_slaves;
    TRY(factor(u, n, u->band, s->Kss, s, 0, PIVOT_LOST, err));
    if (n > 0)
        linalg_solve_band(n, u->band, s->Kss, n_masters(u), (int)s->rows, s->T);
    for (int m = 0; m < n_masters(u); m++)
        s->T[m * s->rows + (n + m)] = 1;
    return STATUS_OK;
}

/* The shape behind the masters': r, 1 of every slave along x, less what all masters together move of it. */
static void find_missed(const Numbering *u, const Shapes *s)
{
    double *missed = s->T + n_masters(u) * s->rows;
    for (int i = FRAME_X; i < n_displacements(u->frame); i += FRAME_DOFS)
        if (u->unknown[i] < u->n_slaves)
            missed[u->unknown[i]] = 1;
    for (int m = 0; m < n_masters(u); m++)
        for (int i = 0; i < u->n_slaves; i++)
            missed[i] -= s->T[m * s->rows + i];
}

/* A = T' K T, or T' M T with the masses of the nodes. */
static void sum_up(const Numbering *u, const Shapes *s, int is_mass, double A[])
{
    const Frame *f = u->frame;
    memset(s->F, 0, u->n_shapes * s->rows * sizeof *s->F);
    for (int e = 0; e < f->n[FRAME_ELEMENTS]; e++) {
        int at[LOCAL];
        double k[LOCAL][LOCAL], m[LOCAL][LOCAL];
        element_unknowns(u, &f->element[e], at);
        element_matrices(f, &f->element[e], k, m);
        for (size_t row = 0; row < u->n_shapes * s->rows; row += s->rows)
            for (int i = 0; i < LOCAL; i++)
                for (int j = 0; j < LOCAL; j++)
                    s->F[row + at[i]] += (is_mass ? m : k)[i][j] * s->T[row + at[j]];
    }
    for (int i = 0; i < n_displacements(f) && is_mass; i++)
        for (int p = 0; p < u->n_shapes; p++) {
            const size_t at = p * s->rows + u->unknown[i];
            s->F[at] += f->node[i / FRAME_DOFS].mass[i % FRAME_DOFS] * s->T[at];
        }
    linalg_product_of_rows(u->n_shapes, (int)s->rows, s->T, s->F, A);
}

static Status check_sway(const Numbering *u, const Shapes *s, const double K[], Err *err)
{
    const int n = n_masters(u);
    double *L;
    TRY_ROOM(L, n * n, "numbers of a frame", err);
    for (int j = 0; j < n; j++)
        for (int i = j; i < n; i++)
            L[j * n + i - j] = K[i * u->n_shapes + j];
    const Status status = factor(u, n, n - 1, L, s, u->n_slaves, SWAY_LOST, err);
    free(L);
    return status;
}

static Status check_mass(const Numbering *u, const double M[], Err *err)
{
    for (int k = 0; k < u->frame->n_floors; k++)
        if (!(M[k * u->n_shapes + k] > 0))
            return bad_data(err,
                            "frame: floor %d (node %s) has no mass: give masses.csv, mass_kg_per_m or added_mass_kg",
                            k + 1, u->frame->node[displacement_of(u, u->n_slaves + k) / FRAME_DOFS].name);
    return STATUS_OK;
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

static Status condense(Numbering *u, const Shapes *s, FrameFull *out, Err *err)
{
    assemble_slaves(u, s);
    TRY(solve_slaves(u, s, err));
    if (u->n_shapes > n_masters(u)) {
        find_missed(u, s);
        sum_up(u, s, 1, out->M);
        u->n_shapes -= !is_missed(u->n_shapes, out->M);
    }
    sum_up(u, s, 0, out->K);
    sum_up(u, s, 1, out->M);
    out->n = u->n_shapes;
    TRY(check_sway(u, s, out->K, err));
    return check_mass(u, out->M, err);
}

static Status reduce(Numbering *u, FrameFull *out, Err *err)
{
    const size_t n = u->n_slaves, shapes = u->n_shapes, band = (size_t)u->band + 1;
    TRY(frame_full_make(out, u->n_shapes, err));
    for (int i = FRAME_X; i < n_displacements(u->frame); i += FRAME_DOFS) /* what moves along x follows the ground */
        if (u->unknown[i] >= u->n_slaves && u->unknown[i] < u->n)
            out->influence[u->unknown[i] - u->n_slaves] = 1;
    if (u->n_shapes > n_masters(u)) /* and so does what they miss of it */
        out->influence[n_masters(u)] = 1;
    Shapes s = {.rows = (size_t)u->n + 1};
    TRY_ROOM(s.Kss, n * band + (2 * shapes + 1) * s.rows, "numbers of a frame", err);
    s.T = s.Kss + n * band;
    s.F = s.T + shapes * s.rows;
    s.diag = s.F + shapes * s.rows;
    const Status status = condense(u, &s, out, err);
    free(s.Kss);
    return status;
}

Status frame_reduce(const Frame *f, FrameKept kept, FrameFull *out, Err *err)
{
    Numbering u;
    *out = (FrameFull){0};
    Status status = numbering_make(&u, f, kept == FRAME_FULL, err);
    if (status == STATUS_OK)
        status = reduce(&u, out, err);
    free(u.unknown);
    if (status != STATUS_OK)
        frame_full_free(out);
    return status;
}

Status frame_full_make(FrameFull *full, int n, Err *err)
{
    const size_t size = n, nn = size * size;
    *full = (FrameFull){.n = n, .K = calloc(2 * nn + size, sizeof *full->K)};
    if (!full->K)
        return fail_memory(err, n, "degrees of freedom");
    full->M = full->K + nn;
    full->influence = full->M + nn;
    return STATUS_OK;
}

void frame_full_free(FrameFull *full)
{
    free(full->K);
    *full = (FrameFull){0};
}
