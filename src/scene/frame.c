#include "scene/frame.h"

#include <search.h>

#include "base/stat.h"

/* ---- parts and their names ------------------------------------------------------------------------------------ */

typedef struct {
    FrameKind kind;
    int index;
    char name[TABLE_NAME_MAX];
} Entry;

static int by_name(const void *a, const void *b)
{
    const Entry *p = a, *q = b;
    return p->kind != q->kind ? (int)p->kind - (int)q->kind : strcmp(p->name, q->name);
}

int frame_find(const Frame *f, FrameKind kind, const char *name)
{
    Entry wanted = {.kind = kind};
    text_copy(wanted.name, name);
    Entry *const *found = tfind(&wanted, &f->names, by_name);
    return found ? (*found)->index : -1;
}

/* A part, which begins with its name, behind those of the list, whose room doubles. */
static Status add_part(Frame *f, FrameKind kind, void *list, const void *part, size_t size, Err *err)
{
    static const char *const WORDS[FRAME_KINDS] = {"node", "section", "element"};
    const size_t n = f->n[kind];
    const char *name = part;
    char *parts;
    memcpy(&parts, list, sizeof parts);
    if ((n & (n - 1)) == 0) {
        char *wider = realloc(parts, (n ? 2 * n : 1) * size);
        if (!wider)
            return fail_memory(err, n, "parts of a frame");
        memcpy(list, &wider, sizeof wider);
        parts = wider;
    }
    if (frame_find(f, kind, name) >= 0)
        return bad_data(err, "%s %s is there twice", WORDS[kind], name);
    Entry *entry;
    TRY_ROOM(entry, 1, "the name of a part", err);
    *entry = (Entry){.kind = kind, .index = (int)n};
    text_copy(entry->name, name);
    if (!tsearch(entry, &f->names, by_name)) {
        free(entry);
        return fail_memory(err, 1, "the name of a part");
    }
    memcpy(parts + n * size, part, size);
    f->n[kind]++;
    return STATUS_OK;
}

Status frame_add_node(Frame *f, const FrameNode *node, Err *err)
{
    const int i = f->n[FRAME_NODES];
    for (int d = 0; d < FRAME_DOFS; d++)
        if (!(node->mass[d] >= 0))
            return bad_data(err, "a mass of %g; it must not be negative", node->mass[d]);
    TRY(add_part(f, FRAME_NODES, &f->node, node, sizeof *node, err));
    for (int d = 0; d < FRAME_DOFS; d++)
        f->node[i].follows[d] = i;
    return STATUS_OK;
}

Status frame_add_section(Frame *f, const FrameSection *s, Err *err)
{
    if (!(s->area > 0 && s->inertia > 0 && s->E > 0))
        return bad_data(err, "section %s: area %g, inertia %g and E %g must be above 0", s->name, s->area, s->inertia,
                        s->E);
    if (!(s->poisson > -1 && s->poisson <= 0.5))
        return bad_data(err, "poisson is %g; it must be above -1 and at most 0.5", s->poisson);
    return add_part(f, FRAME_SECTIONS, &f->section, s, sizeof *s, err);
}

Status frame_add_element(Frame *f, const FrameElement *e, Err *err)
{
    double span[2];
    frame_span(f, e, span);
    if (!e->is_spring && !(hypot(span[0], span[1]) > 0))
        return bad_data(err, "element %s has no length: nodes %s and %s are at one place", e->name,
                        f->node[e->node[0]].name, f->node[e->node[1]].name);
    return add_part(f, FRAME_ELEMENTS, &f->element, e, sizeof *e, err);
}

int frame_followed(const Frame *f, int node, int dof)
{
    while (f->node[node].follows[dof] != node)
        node = f->node[node].follows[dof];
    return node;
}

Status frame_tie(Frame *f, int node, int same_as, const int dof[FRAME_DOFS], Err *err)
{
    if (!dof[FRAME_X] && !dof[FRAME_Z] && !dof[FRAME_ROT])
        return bad_data(err, "ties nothing: none of x, z, rot is 1");
    for (int d = 0; d < FRAME_DOFS; d++) {
        const int a = frame_followed(f, node, d), b = frame_followed(f, same_as, d);
        if (dof[d] && a == b)
            return bad_data(err, "node %s and node %s are one, or tied already: a circle of ties", f->node[node].name,
                            f->node[same_as].name);
        if (dof[d])
            f->node[a].follows[d] = b;
    }
    f->n_ties++;
    return STATUS_OK;
}

void frame_free(Frame *f)
{
    tdestroy(f->names, free);
    free(f->node);
    free(f->section);
    free(f->element);
    free(f->storey_m);
    memset(f, 0, sizeof *f);
}

/* ---- floors --------------------------------------------------------------------------------------------------- */

/* Numbers the floors: heights of the level elements whose ends may move sideways, or, where there is none, of the
 * masses that may, each once, from below. */
static Status number_floors(Frame *f, Err *err)
{
    const FrameNode *node = f->node;
    double *z, lo = node[0].z, hi = lo;
    int found = 0, n = 0;
    const int room = MAX_OF(f->n[FRAME_ELEMENTS], f->n[FRAME_NODES]);
    TRY_ROOM(z, room, "heights of a frame", err);
    for (int i = 1; i < f->n[FRAME_NODES]; i++) {
        lo = fmin(lo, node[i].z);
        hi = fmax(hi, node[i].z);
    }
    const double tolerance = 1e-6 * (hi - lo);
    for (int e = 0; e < f->n[FRAME_ELEMENTS]; e++) {
        const FrameNode *a = &node[f->element[e].node[0]], *b = &node[f->element[e].node[1]];
        if (fabs(a->z - b->z) <= tolerance && !a->fixed[FRAME_X] && !b->fixed[FRAME_X])
            z[found++] = a->z;
    }
    const int is_stick = found == 0;
    for (int i = 0; i < f->n[FRAME_NODES] && is_stick; i++) /* a stick of masses */
        if (node[i].mass[FRAME_X] > 0 && !node[i].fixed[FRAME_X])
            z[found++] = node[i].z;
    sort_values(found, z);
    for (int i = 0; i < found; i++)
        if (n == 0 || z[i] - z[n - 1] > tolerance)
            z[n++] = z[i];
    for (int i = 0; i < f->n[FRAME_NODES]; i++)
        for (int k = 0; k < n; k++)
            if (fabs(node[i].z - z[k]) <= tolerance && !node[i].fixed[FRAME_X])
                f->node[i].floor = k + 1;
    free(z);
    return STATUS_OK;
}

int frame_floor_node(const Frame *f, int floor)
{
    double lo = HUGE_VAL, hi = -HUGE_VAL;
    int best = -1;
    for (int i = 0; i < f->n[FRAME_NODES]; i++)
        if (f->node[i].floor == floor) {
            lo = fmin(lo, f->node[i].x);
            hi = fmax(hi, f->node[i].x);
        }
    for (int i = 0; i < f->n[FRAME_NODES]; i++)
        if (f->node[i].floor == floor &&
            (best < 0 || fabs(f->node[i].x - 0.5 * (lo + hi)) < fabs(f->node[best].x - 0.5 * (lo + hi))))
            best = i;
    return best;
}

Status frame_find_floors(Frame *f, const char *model, int rigid, Err *err)
{
    int named = 0;
    double below = -HUGE_VAL;
    for (int i = 0; i < f->n[FRAME_NODES]; i++)
        named |= f->node[i].floor;
    if (!named)
        TRY(number_floors(f, err));
    for (int i = 0; i < f->n[FRAME_NODES]; i++)
        f->n_floors = MAX_OF(f->node[i].floor, f->n_floors);
    if (f->n_floors == 0)
        return bad_data(err, "%s: no floors: no level element has ends that may move sideways", model);
    if (f->n_floors > FLOORS_MAX)
        return bad_data(err, "%s: %d floors; at most %d are supported", model, f->n_floors, FLOORS_MAX);
    TRY_ROOM(f->storey_m, f->n_floors, "storeys of a frame", err);
    for (int floor = 1; floor <= f->n_floors && rigid; floor++) {
        const int first = frame_floor_node(f, floor);
        for (int i = 0; i < f->n[FRAME_NODES]; i++)
            if (f->node[i].floor == floor)
                f->node[frame_followed(f, i, FRAME_X)].follows[FRAME_X] = frame_followed(f, first, FRAME_X);
    }

    /* Storey heights: between the mean heights of the nodes of floors; the first one is above the highest node that is
     * held sideways below it. */
    for (int k = 1; k <= f->n_floors; k++) {
        int count = 0;
        double z = 0;
        for (int i = 0; i < f->n[FRAME_NODES]; i++)
            if (f->node[i].floor == k) {
                z += f->node[i].z;
                count++;
            }
        if (count == 0)
            return bad_data(err, "%s: there is no floor %d, but a floor %d", model, k, f->n_floors);
        z /= count;
        for (int i = 0; i < f->n[FRAME_NODES] && k == 1; i++)
            if (f->node[i].fixed[FRAME_X] && f->node[i].z < z)
                below = fmax(below, f->node[i].z);
        if (!isfinite(below))
            return bad_data(err, "%s: no node below the first floor (z %g m) is held along x", model, z);
        if (!(z > below))
            return bad_data(err, "%s: floor %d at %g m is not above %g m; bottom floor first", model, k, z, below);
        f->storey_m[k - 1] = z - below;
        below = z;
    }
    return STATUS_OK;
}
