#include "motion/forces.h"

#include "base/csv.h"
#include "base/hash.h"

static const double STEP_MAX = 0.02; /* [s] as of records; histories are shown so */

enum { FORCED_FLOORS_MAX = 128, SAMPLES_MAX = 10000000 };

/* The floor of column c, from 1. */
static Status floor_of(const Table *t, size_t c, int *floor, Err *err)
{
    int end = 0;
    if (sscanf(t->names[c], "floor_%d_n%n", floor, &end) == 1 && end > 0 && !t->names[c][end] && *floor >= 1 &&
        *floor <= FORCED_FLOORS_MAX)
        return STATUS_OK;
    return bad_data(err, "%s: column '%s': time_s and then floor_01_n, floor_02_n, ... are wanted, in N", t->path,
                    t->names[c]);
}

/* Checks header and rows, and adds up the columns of every floor. */
static Status read_rows(Motion *m, const Table *t, Err *err)
{
    double largest = 0;
    int floor = 0;
    if (t->n_cols < 2 || strcmp(t->names[0], "time_s") != 0)
        return bad_data(err, "%s: the header is time_s,floor_01_n,...; its first column is '%s'", t->path, t->names[0]);
    for (size_t c = 1; c < t->n_cols; c++) {
        TRY(floor_of(t, c, &floor, err));
        if (table_column(t, t->names[c]) != (int)c)
            return bad_data(err, "%s: column '%s' is there twice", t->path, t->names[c]);
        m->n_force = MAX_OF(floor, m->n_force);
    }
    const size_t width = m->n_force + 1;
    m->n_force_rows = t->n_rows;
    TRY_ROOM(m->force_rows, t->n_rows * width, "forces", err);
    for (size_t i = 0; i < t->n_rows; i++) {
        const double *row = t->values + i * t->n_cols;
        for (size_t c = 0; c < t->n_cols; c++)
            if (isnan(row[c]))
                return bad_data(err, "%s:%d: column %s is missing", t->path, t->line[i], t->names[c]);
        if (i == 0 ? row[0] != 0 : !(row[0] > row[-(long)t->n_cols]))
            return bad_data(err, "%s:%d: time_s is %g; times begin at 0 and ascend", t->path, t->line[i], row[0]);
        for (size_t c = 0; c < t->n_cols; c++) {
            floor = 0;
            if (c > 0)
                TRY(floor_of(t, c, &floor, err));
            m->force_rows[i * width + floor] += row[c];
            largest = c > 0 ? fmax(largest, fabs(row[c])) : largest;
        }
    }
    if (t->n_rows < 2)
        return bad_data(err, "%s: %zu rows; forces need two or more", t->path, t->n_rows);
    if (!(largest > 0))
        return bad_data(err, "%s: every force is 0; leave motion.forces at none", t->path);
    m->forces_hash = hash_fnv1a(m->force_rows, t->n_rows * width * sizeof *m->force_rows, HASH_SEED);
    return STATUS_OK;
}

Status forces_read(Motion *m, const char *path, Err *err)
{
    Table t = {0};
    Err why = {0};
    Status status = table_read(&t, path, TABLE_HEADED, &why);
    THEN(status, read_rows(m, &t, &why));
    table_free(&t);
    return status == STATUS_OK ? STATUS_OK : fail(err, status, "motion.forces: %s", why.text);
}

static const double *row_of(const Motion *m, size_t i)
{
    return m->force_rows + i * (m->n_force + 1);
}

/* [s] for both: the longest step of which all times of the rows are multiples, a part of the ground's step, or of the
 * shortest distance of two rows where it is at rest. */
static double common_step(Motion *m, int is_still, size_t *parts)
{
    enum { PARTS_TRIED = 100 };
    double shortest = HUGE_VAL;
    for (size_t i = 1; i < m->n_force_rows; i++)
        shortest = fmin(shortest, *row_of(m, i) - *row_of(m, i - 1));
    const double whole = is_still ? shortest : m->dt_s, longest = is_still ? STEP_MAX : shortest;
    const size_t least = (size_t)fmax(ceil(whole / longest * (1 - 1e-9)), 1);
    for (*parts = least; *parts < least + PARTS_TRIED; ++*parts) {
        const double step = whole / (double)*parts;
        double off = 0;
        for (size_t i = 0; i < m->n_force_rows; i++)
            off = fmax(off, fabs(*row_of(m, i) / step - round(*row_of(m, i) / step)));
        if (off < 1e-6)
            return step;
    }
    *parts = least;
    snprintf(m->warning, sizeof m->warning,
             "motion.forces: times that are no multiples of %g s, the step of the simulation; corners there move by "
             "less than that",
             whole / (double)least);
    return whole / (double)least;
}

Status forces_place(Motion *m, Err *err)
{
    if (!m->force_rows)
        return STATUS_OK;
    size_t parts, row = 0;
    const int is_still = !(motion_peak(m) > 0);
    const double step = common_step(m, is_still, &parts), last = *row_of(m, m->n_force_rows - 1) / step;
    const double ground = is_still ? 0 : (double)((m->n - 1) * parts), end = fmax(ground, ceil(last * (1 - 1e-9)));
    if (!(end < SAMPLES_MAX))
        return bad_data(err, "motion.forces: %.3g samples of %g s; give rows that lie less near", end, step);
    const size_t n = (size_t)end + 1, width = m->n_force;
    double *accel = calloc(n, sizeof *accel);
    m->force = calloc(n * width, sizeof *m->force);
    if (!accel || !m->force) {
        free(accel);
        return fail(err, STATUS_NO_MEMORY, "motion.forces: no memory for %zu samples", n);
    }
    for (size_t i = 0; i < n; i++) {
        const size_t k = i / parts, in = i % parts;
        if (!is_still && k < m->n)
            accel[i] = in == 0        ? m->accel[k]
                       : k + 1 < m->n ? m->accel[k] + (m->accel[k + 1] - m->accel[k]) * (double)in / (double)parts
                                      : 0;

        /* Linear between the rows about this time, and none after the last. */
        const double t = (double)i * step;
        while (row + 2 < m->n_force_rows && *row_of(m, row + 1) <= t)
            row++;
        const double *a = row_of(m, row), *b = row_of(m, row + 1), x = (t - a[0]) / (b[0] - a[0]);
        for (size_t j = 0; j < width; j++)
            m->force[i * width + j] = x <= 1 + 1e-9 ? a[1 + j] + fmin(x, 1) * (b[1 + j] - a[1 + j]) : 0;
    }
    free(m->accel);
    free(m->force_rows);
    m->accel = accel;
    m->force_rows = NULL;
    m->n = n;
    m->dt_s = step;
    return STATUS_OK;
}

double motion_force(const Motion *m, int j, double t)
{
    const double at = t / m->dt_s;
    const size_t k = at > 0 ? (size_t)at : 0;
    if (j >= m->n_force || k + 1 > m->n)
        return 0;
    const double *f = m->force + k * m->n_force + j;
    return k + 1 == m->n ? *f : *f + (f[m->n_force] - *f) * (at - (double)k);
}
