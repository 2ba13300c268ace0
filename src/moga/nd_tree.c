#include "moga/nd_tree.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "moga/dominance.h"

/* Points of a leaf before it is split; children of a node: as many as objectives and one, but no more than this. Jaszkiewicz
 * and Lust, section V. */
enum { LEAF_MAX = 20, CHILDREN_MAX = 8 };

typedef struct Node Node;
struct Node {
    size_t n_child; /* 0: a leaf */
    Node *child[CHILDREN_MAX];
    size_t n, n_max, *row; /* (n_max) of a leaf */
    double *ideal, *nadir; /* (n_obj) */
    double bounds[];
};

struct NdTree {
    size_t n_obj, n_children;
    Node *root; /* NULL: no point */
    size_t n_removed, n_removed_max, *removed;
    int lacks_memory;
};

/* -- memory -------------------------------------------------------------------------------------------------------- */

static Node *node_new(NdTree *t)
{
    Node *q = calloc(1, sizeof *q + 2 * t->n_obj * sizeof q->bounds[0]);
    if (!q)
        return NULL;
    q->ideal = q->bounds;
    q->nadir = q->bounds + t->n_obj;
    for (size_t k = 0; k < t->n_obj; k++) {
        q->ideal[k] = INFINITY;
        q->nadir[k] = -INFINITY;
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

static int list_add(size_t **list, size_t *n, size_t *n_max, size_t row)
{
    if (*n == *n_max) {
        const size_t wider = *n_max > 0 ? 2 * *n_max : LEAF_MAX + 4;
        size_t *more = realloc(*list, wider * sizeof *more);
        if (!more)
            return 0;
        *list = more;
        *n_max = wider;
    }
    (*list)[(*n)++] = row;
    return 1;
}

Status nd_tree_create(NdTree **out, size_t n_obj, Err *err)
{
    NdTree *t = calloc(1, sizeof *t);
    *out = t;
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

/* -- dominance ----------------------------------------------------------------------------------------------------- */

static int is_no_worse(size_t m, const double a[], const double b[])
{
    for (size_t k = 0; k < m; k++)
        if (!(a[k] <= b[k]))
            return 0;
    return 1;
}

/* Whether a point of the node dominates f. There is one at least, and it is no worse than the nadir. */
static int is_dominated(const NdTree *t, const Node *q, const double F[], const double f[])
{
    const size_t m = t->n_obj;
    if (!is_no_worse(m, q->ideal, f))
        return 0;
    if (dominates(m, q->nadir, f))
        return 1;
    for (size_t i = 0; i < q->n; i++)
        if (dominates(m, F + q->row[i] * m, f))
            return 1;
    for (size_t c = 0; c < q->n_child; c++)
        if (is_dominated(t, q->child[c], F, f))
            return 1;
    return 0;
}

static void note_removed(NdTree *t, size_t row)
{
    if (!list_add(&t->removed, &t->n_removed, &t->n_removed_max, row))
        t->lacks_memory = 1;
}

static void remove_all(NdTree *t, Node *q)
{
    for (size_t i = 0; i < q->n; i++)
        note_removed(t, q->row[i]);
    for (size_t c = 0; c < q->n_child; c++)
        remove_all(t, q->child[c]);
}

/* Points that f dominates; the node without them, or NULL: none is left. */
static Node *remove_dominated(NdTree *t, Node *q, const double F[], const double f[])
{
    const size_t m = t->n_obj, had_children = q->n_child;
    if (!is_no_worse(m, f, q->nadir))
        return q;
    if (dominates(m, f, q->ideal)) {
        remove_all(t, q);
        node_free(q);
        return NULL;
    }
    size_t kept = 0;
    for (size_t i = 0; i < q->n; i++)
        if (dominates(m, f, F + q->row[i] * m))
            note_removed(t, q->row[i]);
        else
            q->row[kept++] = q->row[i];
    q->n = kept;
    q->n_child = 0;
    for (size_t c = 0; c < had_children; c++) {
        Node *child = remove_dominated(t, q->child[c], F, f);
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
        q->ideal[k] = fmin(q->ideal[k], f[k]);
        q->nadir[k] = fmax(q->nadir[k], f[k]);
    }
}

/* Square of the distance in widths of all points. */
static double square_between(const NdTree *t, const double a[], const double b[])
{
    double square = 0.0;
    for (size_t k = 0; k < t->n_obj; k++) {
        const double width = t->root->nadir[k] - t->root->ideal[k], off = a[k] - b[k];
        square += width > 0.0 ? off * off / (width * width) : 0.0;
    }
    return square;
}

/* ... from the middle of a node's bounds. */
static double square_from_middle(const NdTree *t, const Node *q, const double f[])
{
    double square = 0.0;
    for (size_t k = 0; k < t->n_obj; k++) {
        const double width = t->root->nadir[k] - t->root->ideal[k], off = f[k] - 0.5 * (q->ideal[k] + q->nadir[k]);
        square += width > 0.0 ? off * off / (width * width) : 0.0;
    }
    return square;
}

static Node *nearest_child(const NdTree *t, const Node *q, const double f[])
{
    Node *nearest = q->child[0];
    double min = INFINITY;
    for (size_t c = 0; c < q->n_child; c++) {
        const double square = square_from_middle(t, q->child[c], f);
        if (square < min) {
            min = square;
            nearest = q->child[c];
        }
    }
    return nearest;
}

/* Points that are far from each other, the first row among them; returns how many. Equal ones are not far. */
static size_t choose_seeds(const NdTree *t, const Node *q, const double F[], size_t seeds[CHILDREN_MAX])
{
    const size_t m = t->n_obj;
    size_t n = 1;
    for (seeds[0] = q->row[0]; n < t->n_children; n++) {
        double farthest = 0.0;
        for (size_t i = 0; i < q->n; i++) {
            double nearest = INFINITY;
            for (size_t s = 0; s < n; s++)
                nearest = fmin(nearest, square_between(t, F + q->row[i] * m, F + seeds[s] * m));
            if (nearest > farthest) {
                farthest = nearest;
                seeds[n] = q->row[i];
            }
        }
        if (!(farthest > 0.0))
            break;
    }
    return n;
}

static int leaf_add(const NdTree *t, Node *q, const double F[], size_t row)
{
    if (!list_add(&q->row, &q->n, &q->n_max, row))
        return 0;
    extend(t->n_obj, q, F + row * t->n_obj);
    return 1;
}

/* Leaves about the seeds take the points. Without memory, or where all points are equal, the leaf stays as it is. */
static void split(NdTree *t, Node *q, const double F[])
{
    const size_t m = t->n_obj;
    size_t seeds[CHILDREN_MAX], made = 0;
    const size_t n = choose_seeds(t, q, F, seeds);
    Node *child[CHILDREN_MAX];
    int is_whole = n > 1;
    for (; is_whole && made < n; made++)
        if (!(child[made] = node_new(t)))
            break;
    is_whole = is_whole && made == n;
    for (size_t i = 0; is_whole && i < q->n; i++) {
        size_t nearest = 0;
        for (size_t s = 1; s < n; s++)
            if (square_between(t, F + q->row[i] * m, F + seeds[s] * m) <
                square_between(t, F + q->row[i] * m, F + seeds[nearest] * m))
                nearest = s;
        is_whole = leaf_add(t, child[nearest], F, q->row[i]);
    }
    if (!is_whole) {
        for (size_t s = 0; s < made; s++)
            node_free(child[s]);
        return;
    }
    memcpy(q->child, child, n * sizeof *child);
    q->n_child = n;
    q->n = q->n_max = 0;
    free(q->row);
    q->row = NULL;
}

static int insert(NdTree *t, const double F[], size_t row)
{
    const double *f = F + row * t->n_obj;
    if (!t->root && !(t->root = node_new(t)))
        return 0;
    Node *q = t->root;
    for (; q->n_child > 0; q = nearest_child(t, q, f))
        extend(t->n_obj, q, f);
    if (!leaf_add(t, q, F, row))
        return 0;
    if (q->n > LEAF_MAX)
        split(t, q, F);
    return 1;
}

Status nd_tree_insert(NdTree *t, const double F[], size_t row, NdChange *change, Err *err)
{
    const double *f = F + row * t->n_obj;
    t->n_removed = 0;
    *change = (NdChange){.is_in = !t->root || !is_dominated(t, t->root, F, f)};
    if (change->is_in && t->root)
        t->root = remove_dominated(t, t->root, F, f);
    if (change->is_in && (t->lacks_memory || !insert(t, F, row)))
        return fail(err, STATUS_NO_MEMORY, "no memory for the front");
    change->n_removed = t->n_removed;
    change->removed = t->removed;
    return STATUS_OK;
}
