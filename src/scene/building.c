#include "scene/building.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/linalg.h"
#include "base/table.h"

/* The matrices of configs/sac20, linked in as they are (Makefile, rule for *.csv.o). */
extern const char _binary_configs_sac20_guyan_K_csv_start[], _binary_configs_sac20_guyan_K_csv_end[];
extern const char _binary_configs_sac20_guyan_M_csv_start[], _binary_configs_sac20_guyan_M_csv_end[];
extern const char _binary_configs_sac20_appendix_K_csv_start[], _binary_configs_sac20_appendix_K_csv_end[];
extern const char _binary_configs_sac20_appendix_M_csv_start[], _binary_configs_sac20_appendix_M_csv_end[];

static const struct {
    const char *model, *matrix, *start, *end;
} COMPILED_IN[] = {
    {"guyan", "K", _binary_configs_sac20_guyan_K_csv_start, _binary_configs_sac20_guyan_K_csv_end},
    {"guyan", "M", _binary_configs_sac20_guyan_M_csv_start, _binary_configs_sac20_guyan_M_csv_end},
    {"appendix", "K", _binary_configs_sac20_appendix_K_csv_start, _binary_configs_sac20_appendix_K_csv_end},
    {"appendix", "M", _binary_configs_sac20_appendix_M_csv_start, _binary_configs_sac20_appendix_M_csv_end},
};

static Status read_matrix(Table *t, const char *model, const char *matrix, char path[], size_t size, Err *err)
{
    snprintf(path, size, "%s/%s.csv", model, matrix);
    for (size_t i = 0; i < sizeof COMPILED_IN / sizeof COMPILED_IN[0]; i++)
        if (!strcmp(model, COMPILED_IN[i].model) && !strcmp(matrix, COMPILED_IN[i].matrix))
            return table_parse(t, path, COMPILED_IN[i].start, (size_t)(COMPILED_IN[i].end - COMPILED_IN[i].start), 0,
                               err);
    return table_read(t, path, 0, err);
}

static Status check_symmetric(int n, double A[], const char *path, Err *err)
{
    double largest = 0;
    for (int i = 0; i < n * n; i++)
        largest = fmax(largest, fabs(A[i]));
    for (int i = 0; i < n; i++)
        for (int j = 0; j < i; j++) {
            double *lower = &A[i * n + j], *upper = &A[j * n + i];
            if (!(fabs(*lower - *upper) <= 1e-6 * largest))
                return fail(err, STATUS_BAD_DATA,
                            "%s: not symmetric: row %d column %d is %.9g but row %d column %d is %.9g", path, i + 1,
                            j + 1, *lower, j + 1, i + 1, *upper);
            *lower = *upper = 0.5 * (*lower + *upper);
        }
    const int pivot = linalg_indefinite_at(n, A);
    if (pivot < 0)
        return fail(err, STATUS_NO_MEMORY, "%s: no memory to factor %d x %d", path, n, n);
    if (pivot > 0)
        return fail(err, STATUS_BAD_DATA,
                    "%s: not positive definite: the leading block of %d rows is singular or worse", path, pivot);
    return STATUS_OK;
}

static Status load_matrix(const char *model, const char *matrix, double **A, int *n, Err *err)
{
    Table t;
    char path[600];
    TRY(read_matrix(&t, model, matrix, path, sizeof path, err));
    Status s = STATUS_OK;
    if (t.n_rows != t.n_cols)
        s = fail(err, STATUS_BAD_DATA, "%s: %zu rows of %zu columns; a square matrix is needed", path, t.n_rows,
                 t.n_cols);
    else if (t.n_rows > FLOORS_MAX)
        s = fail(err, STATUS_BAD_DATA, "%s: %zu floors; at most %d are supported", path, t.n_rows, FLOORS_MAX);
    else
        s = check_symmetric((int)t.n_rows, t.values, path, err);
    if (s == STATUS_OK) {
        *A = t.values;
        *n = (int)t.n_rows;
        t.values = NULL;
    }
    table_free(&t);
    return s;
}

static Status find_modes(Building *b, Err *err)
{
    const int n = b->n;
    b->phi = calloc((size_t)(n * n + 2 * n), sizeof *b->phi);
    if (!b->phi)
        return fail(err, STATUS_NO_MEMORY, "building: no memory for %d modes", n);
    b->omega = b->phi + n * n;
    b->gamma = b->omega + n;
    TRY(linalg_modes(n, b->K, b->M, b->omega, b->phi, err));
    linalg_participation(n, b->M, b->phi, b->gamma);
    return STATUS_OK;
}

Status building_load(Building *b, const char *model, Err *err)
{
    memset(b, 0, sizeof *b);
    int n_mass = 0;
    Status s = load_matrix(model, "K", &b->K, &b->n, err);
    if (s == STATUS_OK)
        s = load_matrix(model, "M", &b->M, &n_mass, err);
    if (s == STATUS_OK && n_mass != b->n)
        s = fail(err, STATUS_BAD_DATA, "%s/M.csv: %d floors, but K.csv has %d", model, n_mass, b->n);
    if (s == STATUS_OK)
        s = find_modes(b, err);
    if (s == STATUS_OK) {
        const size_t bytes = (size_t)(b->n * b->n) * sizeof *b->K;
        b->hash = hash_fnv1a(b->M, bytes, hash_fnv1a(b->K, bytes, HASH_SEED));
    } else {
        building_free(b);
    }
    return s;
}

void building_free(Building *b)
{
    free(b->K);
    free(b->M);
    free(b->phi);
    memset(b, 0, sizeof *b);
}
