#include "moga/group.h"

#include "base/carve.h"

static void layout(Group *g, Carve *c)
{
    g->X = carve(c, g->n_max * g->n_var, sizeof(double));
    g->F = carve(c, g->n_max * g->n_obj, sizeof(double));
    g->violation = carve(c, g->n_max, sizeof(double));
    g->uncertainty = carve(c, g->n_max, sizeof(double));
    g->row = carve(c, g->n_max, sizeof(size_t));
    g->age = carve(c, g->n_max, sizeof(size_t));
}

Status group_create(Group *g, size_t n_max, size_t n_var, size_t n_obj, Err *err)
{
    *g = (Group){.n_max = n_max, .n_var = n_var, .n_obj = n_obj};
    Carve c = {0};
    layout(g, &c);
    g->store = carve_store(&c);
    if (!g->store)
        return fail(err, STATUS_NO_MEMORY, "no memory for a population of %zu designs", n_max);
    layout(g, &(Carve){.base = g->store});
    return STATUS_OK;
}

void group_free(Group *g)
{
    free(g->store);
    *g = (Group){0};
}

size_t group_add(Group *g, const double x[])
{
    const size_t i = g->n++;
    memcpy(g->X + i * g->n_var, x, g->n_var * sizeof *x);
    memset(g->F + i * g->n_obj, 0, g->n_obj * sizeof *g->F);
    g->violation[i] = g->uncertainty[i] = 0.0;
    g->row[i] = PREDICTED;
    g->age[i] = 0;
    return i;
}

static void copy(Group *to, size_t i, const Group *from, size_t j)
{
    memmove(to->X + i * to->n_var, from->X + j * from->n_var, to->n_var * sizeof *to->X);
    memmove(to->F + i * to->n_obj, from->F + j * from->n_obj, to->n_obj * sizeof *to->F);
    to->violation[i] = from->violation[j];
    to->uncertainty[i] = from->uncertainty[j];
    to->row[i] = from->row[j];
    to->age[i] = from->age[j];
}

void group_copy_member(Group *to, const Group *from, size_t i)
{
    copy(to, to->n++, from, i);
}

void group_keep(Group *g, size_t n, const size_t chosen[])
{
    for (size_t i = 0; i < n; i++)
        copy(g, i, g, chosen[i]);
    g->n = n;
}

void group_copy(Group *to, const Group *from)
{
    to->n = 0;
    for (size_t i = 0; i < from->n; i++)
        group_copy_member(to, from, i);
}

void group_pack(Group *g, Pack *p, size_t n_rows)
{
    size_t n = g->n;
    pack_size(p, &n, g->n_max);
    pack(p, g->X, n * g->n_var * sizeof *g->X);
    pack(p, g->F, n * g->n_obj * sizeof *g->F);
    pack(p, g->violation, n * sizeof *g->violation);
    pack(p, g->uncertainty, n * sizeof *g->uncertainty);
    for (size_t i = 0; i < n && !p->faulty; i++) {
        size_t code = g->row[i] == PREDICTED ? 0 : g->row[i] + 1;
        pack_size(p, &code, n_rows);
        pack_size(p, &g->age[i], SIZE_MAX);
        g->row[i] = code == 0 ? PREDICTED : code - 1;
    }
    g->n = p->faulty ? g->n : n;
}
