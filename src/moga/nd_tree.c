#include "moga/nd_tree.h"

#include "base/dominance.h"

/* Points of a leaf before it is split: 20 in the paper, which costs a tenth more here; children of a node: as many as
 * objectives and one, but no more than this. Jaszkiewicz and Lust, section V. */
enum { LEAF_MAX = 40, CHILDREN_MAX = 8 };

/* Bounds of a node stand with its parent: what is looked at lies together. */
typedef struct Node Node;
struct Node {
    size_t n_child;          /* 0: a leaf */
    Node **child;            /* (n_child) */
    double *bounds;          /* (n_child, 2, n_obj) ideal and nadir of the children */
    uint32_t n, n_max, *row; /* (n_max) of a leaf */
};

struct NdTree {
    size_t n_obj, n_children;
    const double *F; /* (.., n_obj) of this call */
    Node *root;      /* NULL: no point */
    double *bounds;  /* (2, n_obj) of the root */
    double *weight;  /* (n_obj) 1 / width of all points */
    size_t n_removed, n_removed_max, *removed;
    int lacks_memory;
};

/* -- memory -------------------------------------------------------------------------------------------------------- */

static void node_free(Node *q)
{
    if (!q)
        return;
    for (size_t c = 0; c < q->n_child; c++)
        node_free(q->child[c]);
    free(q->child);
    free(q->bounds);
    free(q->row);
    free(q);
}

static void note_removed(NdTree *t, size_t row)
{
    if (t->n_removed == t->n_removed_max) {
        const size_t wider = t->n_removed_max > 0 ? 2 * t->n_removed_max : LEAF_MAX + 4;
        size_t *more = realloc(t->removed, wider * sizeof *more);
        if (!more) {
            t->lacks_memory = 1;
            return;
        }
        t->removed = more;
        t->n_removed_max = wider;
    }
    t->removed[t->n_removed++] = row;
}

Status nd_tree_create(NdTree **out, size_t n_obj, Err *err)
{
    NdTree *t = calloc(1, sizeof *t);
    *out = t;
    if (t)
        t->bounds = calloc(3 * n_obj, sizeof *t->bounds);
    if (!t || !t->bounds) {
        free(t);
        *out = NULL;
        return fail(err, STATUS_NO_MEMORY, "no memory for the front");
    }
    t->weight = t->bounds + 2 * n_obj;
    t->n_obj = n_obj;
    t->n_children = n_obj < CHILDREN_MAX ? n_obj + 1 : CHILDREN_MAX;
    return STATUS_OK;
}

void nd_tree_free(NdTree *t)
{
    if (!t)
        return;
    node_free(t->root);
    free(t->bounds);
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

/* Whether a point of the node, whose bounds these are, dominates f. There is one at least, and it is no worse than the
 * nadir. */
static int is_dominated(const NdTree *t, const Node *q, const double bounds[], const double f[])
{
    const size_t m = t->n_obj;
    if (!is_no_worse(m, bounds, f))
        return 0;
    if (is_dominating(m, bounds + m, f))
        return 1;
    for (size_t i = 0; i < q->n; i++)
        if (is_dominating(m, point(t, q, i), f))
            return 1;
    for (size_t c = 0; c < q->n_child; c++)
        if (is_dominated(t, q->child[c], q->bounds + 2 * c * m, f))
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
static Node *remove_dominated(NdTree *t, Node *q, double bounds[], const double f[])
{
    const size_t m = t->n_obj, had_points = q->n, had_children = q->n_child;
    if (!is_no_worse(m, f, bounds + m))
        return q;
    if (is_dominating(m, f, bounds)) {
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
        double *own = q->bounds + 2 * c * m;
        Node *child = remove_dominated(t, q->child[c], own, f);
        if (!child)
            continue;
        memmove(q->bounds + 2 * q->n_child * m, own, 2 * m * sizeof *own);
        q->child[q->n_child++] = child;
    }
    if (q->n > 0 || q->n_child > 1)
        return q;
    Node *only = q->n_child == 1 ? q->child[0] : NULL;
    if (only)
        memcpy(bounds, q->bounds, 2 * m * sizeof *bounds);
    q->n_child = 0;
    node_free(q);
    return only;
}

/* -- insertion ----------------------------------------------------------------------------------------------------- */

static void extend(size_t m, double bounds[], const double f[])
{
    for (size_t k = 0; k < m; k++) {
        bounds[k] = MIN_OF(f[k], bounds[k]);
        bounds[m + k] = MAX_OF(f[k], bounds[m + k]);
    }
}

static void bound_one(size_t m, double bounds[], const double f[])
{
    memcpy(bounds, f, m * sizeof *f);
    memcpy(bounds + m, f, m * sizeof *f);
}

/* Square of the distance in widths of all points. */
static double square_between(const NdTree *t, const double a[], const double b[])
{
    double square = 0.0;
    for (size_t k = 0; k < t->n_obj; k++) {
        const double off = (a[k] - b[k]) * t->weight[k];
        square += off * off;
    }
    return square;
}

/* The child of a node whose bounds have the middle that is nearest to f. */
static size_t nearest_child(const NdTree *t, const Node *q, const double f[])
{
    const size_t m = t->n_obj;
    size_t nearest = 0;
    double min = INFINITY;
    for (size_t c = 0; c < q->n_child; c++) {
        const double *bounds = q->bounds + 2 * c * m;
        double square = 0.0;
        for (size_t k = 0; k < m; k++) {
            const double off = (f[k] - 0.5 * (bounds[k] + bounds[m + k])) * t->weight[k];
            square += off * off;
        }
        if (square < min) {
            min = square;
            nearest = c;
        }
    }
    return nearest;
}

/* Points of a leaf that are far from each other, the first among them, of no more than it has when it grows; returns
 * how many. Equal ones are not far. */
static size_t choose_seeds(const NdTree *t, const Node *q, size_t seeds[CHILDREN_MAX])
{
    const size_t step = 1 + (q->n - 1) / (LEAF_MAX + 1);
    size_t n = 1;
    for (seeds[0] = 0; n < t->n_children; n++) {
        double farthest = 0.0;
        for (size_t i = 0; i < q->n; i += step) {
            double nearest = INFINITY;
            for (size_t s = 0; s < n; s++)
                nearest = fmin(nearest, square_between(t, point(t, q, i), point(t, q, seeds[s])));
            if (nearest > farthest) {
                farthest = nearest;
                seeds[n] = i;
            }
        }
        if (!(farthest > 0.0))
            break;
    }
    return n;
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

/* Each point goes to a leaf about the nearest seed. Without memory, or where all points are equal, the leaf stays as it
 * is. */
static void split(NdTree *t, Node *q)
{
    const size_t m = t->n_obj;
    size_t seeds[CHILDREN_MAX];
    const size_t n = choose_seeds(t, q, seeds);
    Node made = {.n_child = n};
    int is_whole = n > 1 && (made.bounds = malloc(2 * n * m * sizeof *made.bounds)) != NULL &&
                   (made.child = calloc(n, sizeof *made.child)) != NULL;
    for (size_t s = 0; is_whole && s < n; s++) {
        is_whole = (made.child[s] = calloc(1, sizeof *q)) != NULL;
        bound_one(m, made.bounds + 2 * s * m, point(t, q, seeds[s]));
    }
    for (size_t i = 0; is_whole && i < q->n; i++)
        is_whole = leaf_add(made.child[nearest_child(t, &made, point(t, q, i))], q->row[i]);
    for (size_t s = 0; is_whole && s < n; s++) {
        is_whole = made.child[s]->n > 0; /* none is, where numbers are so large that distances are not known */
        for (size_t i = 0; i < made.child[s]->n; i++)
            extend(m, made.bounds + 2 * s * m, point(t, made.child[s], i));
    }
    Node *gone = is_whole ? q : &made, kept = is_whole ? made : *q;
    for (size_t s = 0; made.child && !is_whole && s < n; s++)
        node_free(made.child[s]);
    free(gone->child);
    free(gone->bounds);
    free(gone->row);
    *q = kept;
}

/* Point f goes to the leaf whose bounds have the nearest middle; 0: there is no memory. */
static int insert(NdTree *t, const double f[], size_t row)
{
    const size_t m = t->n_obj;
    if (!t->root) {
        t->root = calloc(1, sizeof *t->root);
        bound_one(m, t->bounds, f);
    }
    if (!t->root)
        return 0;
    extend(m, t->bounds, f);
    for (size_t k = 0; k < m; k++) { /* distances are in widths of all points */
        const double width = t->bounds[m + k] - t->bounds[k];
        t->weight[k] = width > 0.0 ? 1.0 / width : 0.0;
    }
    Node *q = t->root;
    while (q->n_child > 0) {
        const size_t c = nearest_child(t, q, f);
        extend(m, q->bounds + 2 * c * m, f);
        q = q->child[c];
    }
    if (!leaf_add(q, row))
        return 0;
    if (q->n > LEAF_MAX)
        split(t, q);
    return 1;
}

Status nd_tree_insert(NdTree *t, const double F[], size_t row, NdChange *change, Err *err)
{
    const double *f = F + row * t->n_obj;
    t->F = F;
    t->n_removed = 0;
    *change = (NdChange){.is_in = !t->root || !is_dominated(t, t->root, t->bounds, f)};
    if (change->is_in && t->root)
        t->root = remove_dominated(t, t->root, t->bounds, f);
    if (change->is_in && (t->lacks_memory || !insert(t, f, row)))
        return fail(err, STATUS_NO_MEMORY, "no memory for the front");
    change->n_removed = t->n_removed;
    change->removed = t->removed;
    return STATUS_OK;
}
