#include "moga/population.h"

#include <float.h>

#include "base/carve.h"
#include "base/stat.h"

static void layout(void *population, Carve *c)
{
    Population *p = population;
    CARVE(c, p->X, p->n_max * p->n_var);
    CARVE(c, p->F, p->n_max * p->n_obj);
    CARVE(c, p->error, p->n_max * p->n_obj);
    CARVE(c, p->violation, p->n_max);
    CARVE(c, p->uncertainty, p->n_max);
    CARVE(c, p->chance, p->n_max);
    CARVE(c, p->row, p->n_max);
}

Status population_create(Population *p, size_t n_max, size_t n_var, size_t n_obj, Err *err)
{
    *p = (Population){.n_max = n_max, .n_var = n_var, .n_obj = n_obj};
    p->store = carve_all(layout, p);
    return p->store ? STATUS_OK : fail(err, STATUS_NO_MEMORY, "no memory for a population of %zu designs", n_max);
}

void population_free(Population *p)
{
    free(p->store);
    *p = (Population){0};
}

size_t population_add(Population *p, const double x[])
{
    const size_t i = p->n++;
    copy_values(p->n_var, x, p->X + i * p->n_var);
    memset(p->F + i * p->n_obj, 0, p->n_obj * sizeof *p->F);
    memset(p->error + i * p->n_obj, 0, p->n_obj * sizeof *p->error);
    p->violation[i] = p->uncertainty[i] = 0.0;
    p->chance[i] = 1.0;
    p->row[i] = PREDICTED;
    return i;
}

static void copy(Population *to, size_t i, const Population *from, size_t j)
{
    const size_t n_var = to->n_var, n_obj = to->n_obj;
    copy_values(n_var, from->X + j * n_var, to->X + i * n_var);
    copy_values(n_obj, from->F + j * n_obj, to->F + i * n_obj);
    copy_values(n_obj, from->error + j * n_obj, to->error + i * n_obj);
    to->violation[i] = from->violation[j];
    to->uncertainty[i] = from->uncertainty[j];
    to->chance[i] = from->chance[j];
    to->row[i] = from->row[j];
}

void population_append(Population *to, const Population *from, size_t i)
{
    copy(to, to->n++, from, i);
}

void population_keep(Population *p, size_t n, const size_t kept[])
{
    for (size_t i = 0; i < n; i++)
        copy(p, i, p, kept[i]);
    p->n = n;
}

void population_copy(Population *to, const Population *from)
{
    to->n = 0;
    for (size_t i = 0; i < from->n; i++)
        population_append(to, from, i);
}

void population_pack(Population *population, Pack *p, const Archive *a)
{
    const size_t m = population->n_obj;
    size_t n = population->n;
    pack_size(p, &n, population->n_max);
    for (size_t i = 0; i < n && !p->faulty; i++) {
        size_t row = p->reading ? 0 : population->row[i];
        pack_size(p, &row, a->n - 1);
        if (p->reading) {
            population->n = i;
            population_add(population, a->X + row * a->n_var);
            population->row[i] = row;
        }
        pack_numbers(p, population->F + i * m, m, -DBL_MAX, DBL_MAX);
        pack_numbers(p, population->violation + i, 1, 0.0, DBL_MAX);
    }
}
