#include "moga/archive.h"

#include "base/carve.h"
#include "base/hash.h"
#include "evaluate/problem.h"
#include "base/dominance.h"

/* Grows by doubling up to so many. */
enum { MANY_ROWS = 100000 };

/* The first n rows stay as they are. Means are the rows themselves while there are no replicates. */
static void layout(void *archive, Carve *c)
{
    Archive *a = archive;
    const size_t n = a->n, n_max = a->n_max, v = a->n_var, m = a->n_obj, k = a->n_con, known = a->S ? n * m : 0;
    CARVE_WIDER(c, a->X, n * v, n_max * v);
    CARVE_WIDER(c, a->Y, n * m, n_max * m);
    CARVE_WIDER(c, a->H, n * k, n_max * k);
    if (a->has_means) {
        CARVE_WIDER(c, a->F, n * m, n_max * m);
        CARVE_WIDER(c, a->G, n * k, n_max * k);
        CARVE_WIDER(c, a->S, known, n_max * m);
        CARVE_WIDER(c, a->sd, known, n_max * m);
        CARVE_WIDER(c, a->error, known, n_max * m);
    } else {
        a->F = a->Y;
        a->G = a->H;
    }
    CARVE_WIDER(c, a->violation, n, n_max);
    CARVE_WIDER(c, a->generation, n, n_max);
    CARVE_WIDER(c, a->front, a->n_listed, n_max);
    CARVE_WIDER(c, a->replicates, n, n_max);
    CARVE_WIDER(c, a->noise, n > 0 ? m : 0, m);
    CARVE_WIDER(c, a->ok, n, n_max);
    CARVE_WIDER(c, a->usable, n, n_max);
    CARVE_WIDER(c, a->kind, n, n_max);
    CARVE_WIDER(c, a->on_front, n, n_max);
    CARVE(c, a->slot, a->n_slots);
    CARVE(c, a->scratch.row, n_max);
    CARVE(c, a->scratch.value, n_max);
    CARVE(c, a->scratch.mark, n_max);
    CARVE(c, a->expected, n_max);
    CARVE(c, a->is_chosen, n_max);
}

/* Where x is, or where it would go: slots hold a row plus one, 0 is free; at most half of them are taken. By FNV-1a of
 * whole words. */
static size_t slot_of(const Archive *a, const double x[])
{
    uint64_t h = HASH_SEED, word;
    for (size_t j = 0; j < a->n_var; j++) {
        memcpy(&word, &x[j], sizeof word);
        h = (h ^ word ^ word >> 32) * HASH_PRIME;
    }
    size_t i = (h ^ h >> 32) & (a->n_slots - 1);
    while (a->slot[i] && memcmp(a->X + (a->slot[i] - 1) * a->n_var, x, a->n_var * sizeof *x) != 0)
        i = (i + 1) & (a->n_slots - 1);
    return i;
}

/* Row of the first simulation of the row's design: its own, where it is the first. */
static size_t design_of(Archive *a, size_t row)
{
    uint32_t *slot = &a->slot[slot_of(a, a->X + row * a->n_var)];
    if (!*slot)
        *slot = (uint32_t)(row + 1);
    return *slot - 1;
}

/* Room for n_max rows, with or without means. */
static Status resize(Archive *a, size_t n_max, int has_means, Err *err)
{
    Archive counted = *a;
    Carve c = {0};
    counted.n_max = n_max;
    counted.has_means = has_means;
    for (counted.n_slots = 4; counted.n_slots < 2 * n_max;)
        counted.n_slots *= 2;
    Archive wider = counted;
    layout(&counted, &c);
    wider.store = n_max < UINT32_MAX ? aligned_alloc(CARVE_LINE, c.used) : NULL; /* slots */
    if (!wider.store)
        return fail(err, STATUS_NO_MEMORY, "no memory for an archive of %zu designs", n_max);
    if (has_means) /* else every row is set as it comes, and room to spare is none that the system has to give */
        memset(wider.store, 0, c.used);
    layout(&wider, &(Carve){.base = wider.store});
    memset(wider.slot, 0, wider.n_slots * sizeof *wider.slot);
    if (a->n == 0)
        memset(wider.noise, 0, a->n_obj * sizeof *wider.noise);
    free(a->store);
    *a = wider;
    for (size_t row = 0; row < a->n; row++)
        if (a->kind[row] != KIND_SCREENED || a->replicates[row] > 0)
            design_of(a, row);
    return STATUS_OK;
}

Status pareto_archive_init(Archive *a, size_t n_max, size_t n_var, size_t n_obj, size_t n_con, Err *err)
{
    *a = (Archive){.n_var = n_var, .n_obj = n_obj, .n_con = n_con};
    TRY(nd_tree_create(&a->tree, n_obj, err));
    return resize(a, n_max > 0 ? n_max : 1, 0, err);
}

void pareto_archive_free(Archive *a)
{
    nd_tree_free(a->tree);
    free(a->store);
    *a = (Archive){0};
}

void pareto_archive_list_front(Archive *a)
{
    size_t kept = 0;
    if (a->n_listed == a->n_front)
        return;
    for (size_t i = 0; i < a->n_listed; i++)
        if (a->on_front[a->front[i]])
            a->front[kept++] = a->front[i];
    a->n_listed = kept;
}

/* The front is compared with the new design alone, which stays outside where a member dominates it, and otherwise
 * replaces those that it dominates. */
static void compare_with_front(Archive *a, size_t row)
{
    const size_t m = a->n_obj;
    const double *f = a->F + row * m, *error = a->error + row * m;
    pareto_archive_list_front(a);
    for (size_t i = 0; i < a->n_front; i++)
        if (dominates_surely(m, a->F + a->front[i] * m, a->error + a->front[i] * m, f, error))
            return;
    size_t kept = 0;
    for (size_t i = 0; i < a->n_front; i++) {
        const size_t member = a->front[i];
        if (dominates_surely(m, f, error, a->F + member * m, a->error + member * m))
            a->on_front[member] = 0;
        else
            a->front[kept++] = member;
    }
    a->on_front[row] = 1;
    a->front[kept] = row;
    a->n_front = a->n_listed = kept + 1;
}

static void set_errors(Archive *a, size_t row)
{
    for (size_t k = 0; k < a->n_obj; k++) {
        const size_t i = row * a->n_obj + k;
        a->sd[i] = sqrt(noise_variance(&a->noise[k], a->F[i], a->S[i], a->replicates[row]));
        a->error[i] = a->sd[i] / sqrt((double)a->replicates[row]);
    }
}

/* A design joins; whether it is on the front says the tree, which knows of no standard errors: there are none without
 * replicates. */
static Status add_design(Archive *a, size_t row, Err *err)
{
    const size_t m = a->n_obj, k = a->n_con;
    NdChange change;
    a->replicates[row] = 1;
    a->usable[row] = a->ok[row];
    a->violation[row] = a->ok[row] ? violation_of(k, a->H + row * k) : INFINITY;
    if (a->has_means) {
        copy_values(m, a->Y + row * m, a->F + row * m);
        copy_values(k, a->H + row * k, a->G + row * k);
        memset(a->S + row * m, 0, m * sizeof *a->S);
        set_errors(a, row);
    }
    if (a->violation[row] > 0.0 || a->kind[row] == KIND_SCREENED)
        return STATUS_OK;
    if (a->n_replicates > 0) {
        compare_with_front(a, row);
        return STATUS_OK;
    }
    TRY(nd_tree_insert(a->tree, a->F, row, &change, err));
    for (size_t i = 0; i < change.n_removed; i++)
        a->on_front[change.removed[i]] = 0;
    a->n_front -= change.n_removed;
    if (change.is_in) {
        a->n_front++;
        a->on_front[row] = 1;
        a->front[a->n_listed++] = row;
    }
    return STATUS_OK;
}

/* Welford's running mean and sum of squares. A design with a replicate that failed is no longer usable. */
static Status add_replicate(Archive *a, size_t row, size_t design, Err *err)
{
    if (!a->has_means)
        TRY(resize(a, a->n_max, 1, err));
    const double n = (double)++a->replicates[design];
    a->n_replicates++;
    a->replicates[row] = 0;
    a->usable[row] = 0;
    a->violation[row] = INFINITY;
    a->is_stale = 1;
    a->usable[design] = a->usable[design] && a->ok[row];
    if (!a->usable[design])
        return STATUS_OK;
    for (size_t k = 0; k < a->n_obj; k++) {
        const size_t i = design * a->n_obj + k;
        const double y = a->Y[row * a->n_obj + k], off = y - a->F[i];
        a->F[i] += off / n;
        a->S[i] += off * (y - a->F[i]);
    }
    for (size_t k = 0; k < a->n_con; k++)
        a->G[design * a->n_con + k] += (a->H[row * a->n_con + k] - a->G[design * a->n_con + k]) / n;
    a->violation[design] = violation_of(a->n_con, a->G + design * a->n_con);
    return STATUS_OK;
}

Status pareto_archive_insert(Archive *a, const double x[], const double f[], const double g[], int ok,
                             EvaluationKind kind, size_t generation, Err *err)
{
    /* 1. Room. */
    const size_t wider = a->n_max + (a->n_max < MANY_ROWS ? a->n_max : a->n_max / 4);
    if (a->n == a->n_max)
        TRY(resize(a, wider, a->has_means, err));

    /* 2. The row as it is. */
    const size_t row = a->n++;
    copy_values(a->n_var, x, a->X + row * a->n_var);
    copy_values(a->n_obj, f, a->Y + row * a->n_obj);
    copy_values(a->n_con, g, a->H + row * a->n_con);
    a->ok[row] = ok && all_finite(a->n_obj, f) && all_finite(a->n_con, g);
    a->n_failed += !a->ok[row];
    a->kind[row] = (unsigned char)kind;
    a->generation[row] = generation;
    a->on_front[row] = 0;

    /* 3. A design that is evaluated in full now takes the place of its screened row. */
    size_t design = design_of(a, row);
    if (design != row && a->kind[design] == KIND_SCREENED) {
        pareto_archive_drop(a, design);
        a->replicates[design] = 0;
        a->violation[design] = INFINITY;
        a->slot[slot_of(a, x)] = (uint32_t)(row + 1);
        design = row;
    }

    /* 4. A new design, or a further replicate. */
    const size_t was_usable = design == row ? 0 : a->usable[design];
    TRY(design == row ? add_design(a, row, err) : add_replicate(a, row, design, err));
    a->n_usable += a->usable[design];
    a->n_usable -= was_usable;
    return STATUS_OK;
}

void pareto_archive_drop(Archive *a, size_t row)
{
    a->n_usable -= a->usable[row];
    a->usable[row] = 0;
}

/* The list of the front holds the designs with several replicates before it is made again. */
void pareto_archive_update_noise(Archive *a)
{
    size_t n = 0;
    if (!a->is_stale)
        return;
    for (size_t row = 0; row < a->n; row++)
        if (a->usable[row] && a->replicates[row] > 1)
            a->front[n++] = row;
    for (size_t k = 0; k < a->n_obj; k++)
        a->noise[k] = noise_fit(n, a->front, a->replicates, a->n_obj, k, a->F, a->S);
    a->n_front = a->n_listed = 0;
    memset(a->on_front, 0, a->n);
    for (size_t row = 0; row < a->n; row++) {
        if (!a->usable[row])
            continue;
        set_errors(a, row);
        if (!(a->violation[row] > 0.0))
            compare_with_front(a, row);
    }
    a->is_stale = 0;
}

size_t pareto_archive_find(const Archive *a, const double x[])
{
    const size_t row = a->slot[slot_of(a, x)];
    return row ? row - 1 : a->n;
}
