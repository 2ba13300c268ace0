#include "moga/nd_tree.h"

#include "base/carve.h"
#include "base/dominance.h"
#include "base/stat.h"

/* Points of a leaf before it is split: 20 in the paper, which costs a tenth more here; children of a node: as many as
 * objectives and one, but no more than this. Jaszkiewicz and Lust, section V. */
enum { LEAF_MAX = 40, CHILDREN_MAX = 8 };

typedef struct Node Node;
struct Node {
    size_t n_child; /* 0: a leaf */
    Node *child[CHILDREN_MAX];
    uint32_t n, n_max, *row; /* (n_max) of a leaf */
    double bounds[];         /* (2, n_obj) ideal and nadir */
};

struct NdTree {
    size_t n_obj, n_children;
    const double *F; /* (.., n_obj) of this call */
    Node *root;      /* NULL: no point */
    size_t n_removed, n_removed_max, *removed;
    int lacks_memory;
    double weight[]; /* (n_obj) 1 / width of all points */
};

/* -- memory -------------------------------------------------------------------------------------------------------- */

/* A leaf at f; NULL: there is no memory. */
static Node *make_leaf(const NdTree *t, const double f[])
{
    const size_t m = t->n_obj;
    Node *q = calloc(1, sizeof *q + 2 * m * sizeof *f);
    if (q) {
        copy_values(m, f, q->bounds);
        copy_values(m, f, q->bounds + m);
    }
    return q;
}

static void node_free(Node *q)
{
    if (!q)
        return;
    for (size_t c = 0; c < q->n_child; c++)
        node_free(q->child[c]);
    free(q->row);
    free(q);
}

static void note_removed(NdTree *t, size_t row)
{
    if (t->n_removed == t->n_removed_max) {
        const size_t wider = 2 * t->n_removed_max + LEAF_MAX;
        t->removed = widened(t->removed, wider, sizeof *t->removed, &t->lacks_memory);
        if (t->lacks_memory)
            return;
        t->n_removed_max = wider;
    }
    t->removed[t->n_removed++] = row;
}

Status nd_tree_create(NdTree **out, size_t n_obj, Err *err)
{
    NdTree *t = *out = calloc(1, sizeof *t + n_obj * sizeof *t->weight);
    if (!t)
        return fail(err, STATUS_NO_MEMORY, "no memory for the front");
    t->n_obj = n_obj;
    t->n_children = n_obj < CHILDREN_MAX ? n_obj + 1 : CHILDREN_MAX;
    return STATUS_OK;
}

void nd_tree_free(NdTree *t)
{
    if (!t)
        return;
    node_free(t->root);
    free(t->removed);
    free(t);
}

static const double *point(const NdTree *t, const Node *q, size_t i)
{
    return t->F + q->row[i] * t->n_obj;
}

/* -- dominance ----------------------------------------------------------------------------------------------------- */

/* Most pairs differ in the first objective: it is looked at here. */
static int is_dominating(size_t m, const double a[], const double b[])
{
    return a[0] <= b[0] && dominates(m, a, b);
}

/* Whether a point of the node dominates f. There is one at least, and it is no worse than the nadir. */
static int is_dominated(const NdTree *t, const Node *q, const double f[])
{
    const size_t m = t->n_obj;
    if (!is_no_worse(m, q->bounds, f))
        return 0;
    if (is_dominating(m, q->bounds + m, f))
        return 1;
    for (size_t i = 0; i < q->n; i++)
        if (is_dominating(m, point(t, q, i), f))
            return 1;
    for (size_t c = 0; c < q->n_child; c++)
        if (is_dominated(t, q->child[c], f))
            return 1;
    return 0;
}

static void remove_all(NdTree *t, Node *q)
{
    for (size_t i = 0; i < q->n; i++)
        note_removed(t, q->row[i]);
    for (size_t c = 0; c < q->n_child; c++)
        remove_all(t, q->child[c]);
}

/* Points that f dominates leave; the node without them, or NULL: none is left. */
static Node *remove_dominated(NdTree *t, Node *q, const double f[])
{
    const size_t m = t->n_obj, had_points = q->n, had_children = q->n_child;
    if (!is_no_worse(m, f, q->bounds + m))
        return q;
    if (is_dominating(m, f, q->bounds)) {
        remove_all(t, q);
        node_free(q);
        return NULL;
    }
    q->n = 0;
    q->n_child = 0;
    for (size_t i = 0; i < had_points; i++)
        if (is_dominating(m, f, point(t, q, i)))
            note_removed(t, q->row[i]);
        else
            q->row[q->n++] = q->row[i];
    for (size_t c = 0; c < had_children; c++) {
        Node *child = remove_dominated(t, q->child[c], f);
        if (child)
            q->child[q->n_child++] = child;
    }
    if (q->n > 0 || q->n_child > 1)
        return q;
    Node *only = q->n_child == 1 ? q->child[0] : NULL;
    q->n_child = 0;
    node_free(q);
    return only;
}

/* -- insertion ----------------------------------------------------------------------------------------------------- */

static void extend(size_t m, Node *q, const double f[])
{
    for (size_t k = 0; k < m; k++) {
        q->bounds[k] = MIN_OF(f[k], q->bounds[k]);
        q->bounds[m + k] = MAX_OF(f[k], q->bounds[m + k]);
    }
}

/* Square of the distance from the middle of a and b, in widths of all points. */
static double square_from(const NdTree *t, const double a[], const double b[], const double f[])
{
    double square = 0.0;
    for (size_t k = 0; k < t->n_obj; k++) {
        const double off = (f[k] - 0.5 * (a[k] + b[k])) * t->weight[k];
        square += off * off;
    }
    return square;
}

/* The child of a node whose bounds have the middle that is nearest to f. */
static Node *nearest_child(const NdTree *t, const Node *q, const double f[])
{
    size_t nearest = 0;
    double min = INFINITY;
    for (size_t c = 0; c < q->n_child; c++) {
        const double *bounds = q->child[c]->bounds, square = square_from(t, bounds, bounds + t->n_obj, f);
        if (square < min) {
            min = square;
            nearest = c;
        }
    }
    return q->child[nearest];
}

static int leaf_add(Node *q, size_t row)
{
    enum { STEP = 8 };
    if (q->n == q->n_max) {
        const uint32_t n_max = q->n_max + (q->n_max > LEAF_MAX ? q->n_max : STEP);
        uint32_t *wider = realloc(q->row, n_max * sizeof *wider);
        if (!wider)
            return 0;
        q->row = wider;
        q->n_max = n_max;
    }
    q->row[q->n++] = (uint32_t)row;
    return 1;
}

/* Points of a leaf that are far from each other begin a leaf each, the first point among them, and every other point
 * goes to that about the nearest. Equal ones are not far; of more points than there are when a leaf grows some are
 * looked at. Without memory, or where all are equal, the leaf stays as it is. */
static void split(NdTree *t, Node *q)
{
    const size_t m = t->n_obj, step = 1 + (q->n - 1) / (LEAF_MAX + 1);
    const double *seed = point(t, q, 0);
    int is_whole = 1;
    while (seed && is_whole && q->n_child < t->n_children) {
        double farthest = 0.0;
        is_whole = (q->child[q->n_child] = make_leaf(t, seed)) != NULL;
        q->n_child += is_whole;
        seed = NULL;
        for (size_t i = 0; is_whole && i < q->n; i += step) {
            double nearest = INFINITY;
            for (size_t c = 0; c < q->n_child; c++)
                nearest = fmin(nearest, square_from(t, q->child[c]->bounds, q->child[c]->bounds, point(t, q, i)));
            if (nearest > farthest) {
                farthest = nearest;
                seed = point(t, q, i);
            }
        }
    }
    for (size_t i = 0; is_whole && i < q->n; i++)
        is_whole = leaf_add(nearest_child(t, q, point(t, q, i)), q->row[i]);
    for (size_t c = 0; is_whole && c < q->n_child; c++) {
        Node *child = q->child[c];
        is_whole = child->n > 0; /* none is, where numbers are so large that distances are not known */
        for (size_t i = 0; i < child->n; i++)
            extend(m, child, point(t, child, i));
    }
    if (is_whole && q->n_child > 1) {
        free(q->row);
        q->row = NULL;
        q->n = q->n_max = 0;
    } else {
        while (q->n_child > 0)
            node_free(q->child[--q->n_child]);
    }
}

Status nd_tree_insert(NdTree *t, const double F[], size_t row, NdChange *change, Err *err)
{
    const size_t m = t->n_obj;
    const double *f = F + row * m;
    t->F = F;
    t->n_removed = 0;
    const int is_in = !t->root || !is_dominated(t, t->root, f);
    if (is_in && t->root)
        t->root = remove_dominated(t, t->root, f);
    *change = (NdChange){is_in, t->n_removed, t->removed};
    if (!is_in)
        return STATUS_OK;

    /* It goes to the leaf whose bounds have the nearest middle, in widths of all points. */
    Node *q = t->root = t->root ? t->root : make_leaf(t, f);
    for (size_t k = 0; q && k < m; k++) {
        const double width = MAX_OF(q->bounds[m + k], f[k]) - MIN_OF(q->bounds[k], f[k]);
        t->weight[k] = width > 0.0 ? 1.0 / width : 0.0;
    }
    while (q && q->n_child > 0) {
        extend(m, q, f);
        q = nearest_child(t, q, f);
    }
    if (!q || t->lacks_memory || !leaf_add(q, row))
        return fail(err, STATUS_NO_MEMORY, "no memory for the front");
    extend(m, q, f);
    if (q->n > LEAF_MAX)
        split(t, q);
    return STATUS_OK;
}
