#include "moga/population.h"

#include <float.h>

#include "base/carve.h"

static void layout(void *population, Carve *c)
{
    Population *p = population;
    p->X = carve(c, p->n_max * p->n_var, sizeof(double));
    p->F = carve(c, p->n_max * p->n_obj, sizeof(double));
    p->error = carve(c, p->n_max * p->n_obj, sizeof(double));
    p->violation = carve(c, p->n_max, sizeof(double));
    p->uncertainty = carve(c, p->n_max, sizeof(double));
    p->chance = carve(c, p->n_max, sizeof(double));
    p->row = carve(c, p->n_max, sizeof(size_t));
    p->age = carve(c, p->n_max, sizeof(size_t));
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
    memcpy(p->X + i * p->n_var, x, p->n_var * sizeof *x);
    memset(p->F + i * p->n_obj, 0, p->n_obj * sizeof *p->F);
    memset(p->error + i * p->n_obj, 0, p->n_obj * sizeof *p->error);
    p->violation[i] = p->uncertainty[i] = 0.0;
    p->chance[i] = 1.0;
    p->row[i] = PREDICTED;
    p->age[i] = 0;
    return i;
}

static void copy(Population *to, size_t i, const Population *from, size_t j)
{
    memmove(to->X + i * to->n_var, from->X + j * from->n_var, to->n_var * sizeof *to->X);
    memmove(to->F + i * to->n_obj, from->F + j * from->n_obj, to->n_obj * sizeof *to->F);
    memmove(to->error + i * to->n_obj, from->error + j * from->n_obj, to->n_obj * sizeof *to->error);
    to->violation[i] = from->violation[j];
    to->uncertainty[i] = from->uncertainty[j];
    to->chance[i] = from->chance[j];
    to->row[i] = from->row[j];
    to->age[i] = from->age[j];
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

void population_pack(Population *population, Pack *p, size_t n_rows)
{
    size_t n = population->n;
    pack_size(p, &n, population->n_max);
    pack_numbers(p, population->X, n * population->n_var, -DBL_MAX, DBL_MAX);
    pack_numbers(p, population->F, n * population->n_obj, -DBL_MAX, DBL_MAX);
    pack_numbers(p, population->violation, n, 0.0, DBL_MAX);
    pack_numbers(p, population->uncertainty, n, 0.0, DBL_MAX);
    pack_numbers(p, population->chance, n, 0.0, 1.0);
    for (size_t i = 0; i < n && !p->faulty; i++) {
        size_t code = population->row[i] == PREDICTED ? 0 : population->row[i] + 1;
        pack_size(p, &code, n_rows);
        pack_size(p, &population->age[i], UINT32_MAX);
        population->row[i] = code == 0 ? PREDICTED : code - 1;
    }
    population->n = p->faulty ? population->n : n;
}
