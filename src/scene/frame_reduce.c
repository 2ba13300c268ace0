#include "base/linalg.h"
#include "scene/core_beam.h"
#include "scene/frame.h"

/* Which displacements are removed, and the matrices of the condensation. Unknowns 0..n_slaves-1 are removed; from
 * n_slaves on are the masters: the floors, then others that are kept; n, one more than there are, stands for what the
 * ground holds. */
typedef struct {
    const Frame *frame;
    int n_displacements, n_slaves, n_masters, n;
    int band;     /* largest distance of two coupled slaves */
    int n_shapes; /* masters, or one more: what is missed of the ground's motion */
    int *unknown; /* (n_displacements) */
    int *root;    /* (n_displacements) the displacement that each equals; itself: it is tied to none */
    size_t rows;  /* n + 1 */
    double *Kss;  /* (n_slaves, band + 1) lower band, column by column */
    double *T;    /* (n_shapes, rows) displacements in a shape, row by row: of the slaves, 1 of its master, 0 of the
                   * ground's */
    double *F;    /* (n_shapes, rows) forces that belong to it */
    double *diag; /* (rows) of the stiffness of all unknowns */
} Condensation;

enum { ENDS = 2, LOCAL = ENDS * FRAME_DOFS };

/* ---- elements ------------------------------------------------------------------------------------------------- */

/* a = T' a T */
static void transform(int n, double a[], const double T[])
{
    double copy[LOCAL * LOCAL], work[LOCAL * LOCAL];
    memcpy(copy, a, n * n * sizeof *a);
    linalg_congruent(n, n, copy, T, work, a);
}

/* Bending and stretching of an element along an axis in one matrix of x, z, rotation of the nodes, to which rigid arms
 * connect its ends. */
static void join_and_turn(const double bend[4][4], double along_same, double along_other, const double axis[2],
                          const double (*arm)[2], double a[LOCAL][LOCAL])
{
    const double c = axis[0], s = axis[1];
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
        const double *o = arm[end / FRAME_DOFS];
        t[end][end + 2] = s * o[0] - c * o[1];
        t[end + 1][end + 2] = c * o[0] + s * o[1];
    }
    transform(LOCAL, a[0], t[0]);
}

/* Displacement k of the six of an element among those of the frame. */
static int displacement_of(const FrameElement *e, int k)
{
    return e->node[k / FRAME_DOFS] * FRAME_DOFS + k % FRAME_DOFS;
}

/* Stiffness and mass of x, z, rotation at both ends; a rotation is positive from x to z. at: what these six are by
 * `number` (n_displacements). */
static void element_matrices(const Frame *f, int element, const int number[], int at[LOCAL], double k[LOCAL][LOCAL],
                             double m[LOCAL][LOCAL])
{
    const FrameElement *e = &f->element[element];
    const FrameSection *s = &f->section[e->section];
    double bend[4][4], sway[4][4], span[2];
    for (int i = 0; i < LOCAL; i++)
        at[i] = number[displacement_of(e, i)];
    if (e->is_spring) {
        const double across = e->spring[1], about = e->spring[2], half = 0.5 * e->added_mass;
        const double apart[4][4] = {
            {across, 0, -across, 0}, {0, about, 0, -about}, {-across, 0, across, 0}, {0, -about, 0, about}};
        const double halves[4][4] = {[0][0] = half, [2][2] = half};
        join_and_turn(apart, e->spring[0], -e->spring[0], e->axis, e->offset, k);
        join_and_turn(halves, half, 0, e->axis, e->offset, m);
        return;
    }
    frame_span(f, e, span);
    const double l = hypot(span[0], span[1]), axis[2] = {span[0] / l, span[1] / l}, axial = s->E * s->area / l,
                 mass = s->mass_per_m * l + e->added_mass;
    beam_element(&(Beam){.EI = s->E * s->inertia,
                         .kGA = s->E / (2 * (1 + s->poisson)) * s->shear_area,
                         .mass_per_m = mass / l,
                         .length = l},
                 bend, sway);

    /* The moment at a pinned end vanishes: the rotation there follows the other three unknowns statically. */
    for (int r = 1; r < 4; r += 2) {
        double T[4][4] = {{0}};
        for (int i = 0; i < 4 && e->pinned[r / 2]; i++) {
            T[i][i] = i != r;
            T[r][i] = bend[r][r] > 0 && i != r ? -bend[r][i] / bend[r][r] : 0;
        }
        if (e->pinned[r / 2]) {
            transform(4, bend[0], T[0]);
            transform(4, sway[0], T[0]);
        }
    }
    join_and_turn(bend, axial, -axial, axis, e->offset, k);
    join_and_turn(sway, mass / 3, mass / 6, axis, e->offset, m);
}

/* ---- unknowns ------------------------------------------------------------------------------------------------- */

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
static int number_kind(Condensation *c, const Place place[], int kind, int next)
{
    for (int k = 0; k < c->n_displacements; k++) {
        int *unknown = &c->unknown[c->root[place[k / FRAME_DOFS].node * FRAME_DOFS + k % FRAME_DOFS]];
        if (*unknown == kind)
            *unknown = next++;
    }
    return next;
}

/* The unknown of the node that stands for a floor. */
static int *floor_unknown(Condensation *c, int floor)
{
    return &c->unknown[c->root[frame_floor_node(c->frame, floor) * FRAME_DOFS + FRAME_X]];
}

/* Of the largest mass (a rotary one counts as at 1 m): what has less is condensed as if it had none. Such masses keep a
 * solver of other programs going; they would put frequencies in the model whose rounding drowns the lowest. */
static const double NEGLIGIBLE_MASS = 1e-8;

/* A displacement is one of the full model's if it has mass and is named in the frame, or none is named. Without mass
 * static condensation is exact. */
static Status find_kept(Condensation *c, Err *err)
{
    const Frame *f = c->frame;
    const int n = c->n_displacements;
    int named = 0, at[LOCAL];
    double largest = 0, *mass, k[LOCAL][LOCAL], m[LOCAL][LOCAL];
    TRY_ROOM(mass, n, "masses", err);
    for (int e = 0; e < f->n[FRAME_ELEMENTS]; e++) {
        element_matrices(f, e, c->root, at, k, m);
        for (int i = 0; i < LOCAL; i++)
            mass[at[i]] += m[i][i];
    }
    for (int i = 0; i < n; i++)
        mass[c->root[i]] += f->node[i / FRAME_DOFS].mass[i % FRAME_DOFS];
    for (int i = 0; i < n; i++) {
        largest = fmax(largest, mass[i]);
        named |= f->node[i / FRAME_DOFS].keep[i % FRAME_DOFS];
    }
    for (int i = 0; i < n; i++)
        if ((!named || f->node[i / FRAME_DOFS].keep[i % FRAME_DOFS]) && mass[c->root[i]] > NEGLIGIBLE_MASS * largest)
            c->unknown[c->root[i]] = KEPT;
    free(mass);
    return STATUS_OK;
}

/* Numbers the unknowns. full: those of the full model are kept beside the floors. */
static Status number_unknowns(Condensation *c, int full, Err *err)
{
    const Frame *f = c->frame;
    const int nodes = f->n[FRAME_NODES], n = c->n_displacements = nodes * FRAME_DOFS;
    TRY_ROOM(c->unknown, 2 * n, "unknowns", err);
    c->root = c->unknown + n;

    /* Every displacement is a slave, or kept, or held; one that equals a held one is held; then the floors. */
    for (int i = 0; i < n; i++) {
        c->unknown[i] = SLAVE;
        c->root[i] = frame_followed(f, i / FRAME_DOFS, i % FRAME_DOFS) * FRAME_DOFS + i % FRAME_DOFS;
    }
    if (full)
        TRY(find_kept(c, err));
    for (int i = 0; i < n; i++)
        if (f->node[i / FRAME_DOFS].fixed[i % FRAME_DOFS])
            c->unknown[c->root[i]] = HELD;
    for (int floor = 1; floor <= f->n_floors; floor++) {
        int *unknown = floor_unknown(c, floor);
        if (*unknown == HELD || *unknown == FLOOR)
            return bad_data(err, "frame: floor %d cannot move by itself: it is held or tied", floor);
        *unknown = FLOOR;
    }

    /* Numbers for the slaves, the floors and what else is kept; what is tied has the number of what it equals. */
    Place *place;
    TRY_ROOM(place, nodes, "nodes of a frame", err);
    for (int i = 0; i < nodes; i++)
        place[i] = (Place){f->node[i].z, f->node[i].x, i};
    qsort(place, nodes, sizeof *place, by_height);
    c->n_slaves = number_kind(c, place, SLAVE, 0);
    for (int floor = 1; floor <= f->n_floors; floor++)
        *floor_unknown(c, floor) = c->n_slaves + floor - 1;
    c->n = number_kind(c, place, KEPT, c->n_slaves + f->n_floors);
    free(place);
    for (int i = 0; i < n; i++) {
        const int unknown = c->unknown[c->root[i]];
        c->unknown[i] = unknown == HELD ? c->n : unknown;
    }
    c->n_masters = c->n - c->n_slaves;
    c->n_shapes = c->n_masters + !full;
    for (int e = 0; e < f->n[FRAME_ELEMENTS]; e++)
        for (int k = 0; k < LOCAL * LOCAL; k++) {
            const int i = c->unknown[displacement_of(&f->element[e], k / LOCAL)],
                      j = c->unknown[displacement_of(&f->element[e], k % LOCAL)];
            if (i < c->n_slaves && j < c->n_slaves)
                c->band = MAX_OF(c->band, i - j);
        }
    return STATUS_OK;
}

/* ---- condensation --------------------------------------------------------------------------------------------- */

/* The node whose displacement has an unknown, and which one of it. */
static const FrameNode *node_of(const Condensation *c, int unknown, int *dof)
{
    int i = 0;
    while (c->unknown[i] != unknown)
        i++;
    *dof = i % FRAME_DOFS;
    return &c->frame->node[i / FRAME_DOFS];
}

/* Fills Kss, the right-hand sides -Ksm in T, and the diagonal of the stiffness of all unknowns. */
static void assemble_slaves(const Condensation *c)
{
    const int n = c->n_slaves, height = c->band + 1;
    for (int e = 0; e < c->frame->n[FRAME_ELEMENTS]; e++) {
        int at[LOCAL];
        double k[LOCAL][LOCAL], m[LOCAL][LOCAL];
        element_matrices(c->frame, e, c->unknown, at, k, m);
        for (int i = 0; i < LOCAL; i++) {
            for (int j = 0; j < LOCAL; j++) /* what ties cancel is not there to be lost */
                c->diag[at[i]] += at[i] == at[j] ? k[i][j] : 0;
            for (int j = 0; j < LOCAL && at[i] < n; j++) {
                if (at[j] >= n && at[j] < c->n)
                    c->T[(at[j] - n) * c->rows + at[i]] -= k[i][j];
                else if (at[i] >= at[j])
                    c->Kss[at[j] * (size_t)height + (at[i] - at[j])] += k[i][j];
            }
        }
    }
}

/* A pivot that has lost so many digits of the diagonal is zero but for rounding. */
static const double PIVOT_LOST = 1e-11, SWAY_LOST = 1e-12;

/* Factors the stiffness of the slaves or the masters in place. What has a pivot of zero moves without resistance. */
static Status factor(const Condensation *c, int masters, double A[], Err *err)
{
    static const char *const WORDS[] = {"moves along x", "moves along z", "turns"};
    const int n = masters ? c->n_masters : c->n_slaves, band = masters ? n - 1 : c->band;
    const int first = masters ? c->n_slaves : 0, info = n > 0 ? linalg_factor_band(n, band, A) : 0;
    const int factored = info > 0 ? info - 1 : n;
    int p = 0, dof;
    while (p < factored && pow(A[p * (band + 1)], 2) > (masters ? SWAY_LOST : PIVOT_LOST) * c->diag[first + p])
        p++;
    if (info < 0)
        return fail(err, STATUS_NO_MEMORY, "frame: no memory to factor %d unknowns", n);
    if (p == n)
        return STATUS_OK;
    const FrameNode *node = node_of(c, first + p, &dof);
    return bad_data(err, "frame: a mechanism: nothing resists when node %s (x %g m, z %g m) %s; fix it, or connect it",
                    node->name, node->x, node->z, WORDS[dof]);
}

/* A = T' K T, or T' M T with the masses of the nodes. */
static void sum_up(const Condensation *c, int is_mass, double A[])
{
    const Frame *f = c->frame;
    memset(c->F, 0, c->n_shapes * c->rows * sizeof *c->F);
    for (int e = 0; e < f->n[FRAME_ELEMENTS]; e++) {
        int at[LOCAL];
        double k[LOCAL][LOCAL], m[LOCAL][LOCAL];
        element_matrices(f, e, c->unknown, at, k, m);
        for (size_t row = 0; row < c->n_shapes * c->rows; row += c->rows)
            for (int i = 0; i < LOCAL; i++)
                for (int j = 0; j < LOCAL; j++)
                    c->F[row + at[i]] += (is_mass ? m : k)[i][j] * c->T[row + at[j]];
    }
    for (int i = 0; i < c->n_displacements && is_mass; i++)
        for (int p = 0; p < c->n_shapes; p++) {
            const size_t at = p * c->rows + c->unknown[i];
            c->F[at] += f->node[i / FRAME_DOFS].mass[i % FRAME_DOFS] * c->T[at];
        }
    linalg_product_of_rows(c->n_shapes, (int)c->rows, c->T, c->F, A);
}

/* Of the ground's load: the missed shape's part of it below which that shape is left out. */
static const double MISSED_MIN = 1e-3;

/* Condenses the frame to its masters, and to the shape that they miss of the ground's motion where that matters. */
static Status condense(Condensation *c, FrameFull *out, Err *err)
{
    const int n = c->n_slaves, masters = c->n_masters, is_full = c->n_shapes == masters;
    double *missed = c->T + masters * c->rows, *L, load = 0, moved = 0;
    int dof;

    /* The slaves follow every master by statics. */
    assemble_slaves(c);
    TRY(factor(c, 0, c->Kss, err));
    if (n > 0)
        linalg_solve_band(n, c->band, c->Kss, masters, (int)c->rows, c->T);
    for (int m = 0; m < masters; m++)
        c->T[m * c->rows + (n + m)] = 1;

    /* What moves along x follows the ground. Missed is r, 1 of every slave along x, less what all masters together move
     * of it. */
    for (int i = FRAME_X; i < c->n_displacements; i += FRAME_DOFS) {
        const int unknown = c->unknown[i];
        if (unknown >= n && unknown < c->n)
            out->influence[unknown - n] = 1;
        else if (!is_full && unknown < n)
            missed[unknown] = 1;
    }
    if (!is_full) {
        out->influence[masters] = 1;
        for (int m = 0; m < masters; m++)
            for (int i = 0; i < n; i++)
                missed[i] -= c->T[m * c->rows + i];
        sum_up(c, 1, out->M);
        for (int p = 0; p <= masters; p++) {
            for (int q = 0; q <= masters; q++)
                load += out->M[p * (masters + 1) + q];
            moved += fabs(out->M[p * (masters + 1) + masters]);
        }
        c->n_shapes -= !(moved > MISSED_MIN * load);
    }
    sum_up(c, 0, out->K);
    sum_up(c, 1, out->M);
    out->n = c->n_shapes;

    /* The masters must resist sideways, and every floor must have mass. */
    TRY_ROOM(L, masters * masters, "numbers of a frame", err);
    for (int j = 0; j < masters; j++)
        for (int i = j; i < masters; i++)
            L[j * masters + i - j] = out->K[i * out->n + j];
    const Status status = factor(c, 1, L, err);
    free(L);
    TRY(status);
    for (int k = 0; k < c->frame->n_floors; k++)
        if (!(out->M[k * out->n + k] > 0))
            return bad_data(err,
                            "frame: floor %d (node %s) has no mass: give masses.csv, mass_kg_per_m or added_mass_kg",
                            k + 1, node_of(c, n + k, &dof)->name);
    return STATUS_OK;
}

Status frame_reduce(const Frame *f, FrameKept kept, FrameFull *out, Err *err)
{
    Condensation c = {.frame = f};
    *out = (FrameFull){0};
    Status status = number_unknowns(&c, kept == FRAME_FULL, err);
    THEN(status, frame_full_make(out, c.n_shapes, err));
    if (status == STATUS_OK) {
        const size_t band = c.n_slaves * ((size_t)c.band + 1), shapes = c.n_shapes * (c.rows = (size_t)c.n + 1);
        c.Kss = calloc(band + 2 * shapes + c.rows, sizeof *c.Kss);
        c.T = c.Kss + band;
        c.F = c.T + shapes;
        c.diag = c.F + shapes;
        status = c.Kss ? condense(&c, out, err) : fail_memory(err, band + 2 * shapes, "numbers of a frame");
    }
    free(c.Kss);
    free(c.unknown);
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
