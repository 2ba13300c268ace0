/* K-RVEA: Chugh, Jin, Miettinen, Hakanen and Sindhya, IEEE Trans. Evol. Comput. 22 (2018) 129-142. Each objective is
 * modelled by the program's interpolant (rbf/rbf.h); RVEA (moga/selection.h) runs GENERATIONS generations on the
 * predictions; of its last population at most UPDATES designs are evaluated, one for each cluster of reference vectors
 * with members: that with the least angle-penalised distance, or, where DELTA of the fixed vectors have lost their
 * members since the last time, that with the greatest error. The training set is at most 11 n_var - 1 designs: of the
 * vector with the most of them one at random leaves.
 *
 * Not as in the paper: the first sample has 4 n_var + 12 designs, as for the other methods; the error is the
 * interpolant's local leave-one-out error, in ranges of the population; ranges of fixed vectors are those of the first
 * sample. Failed and infeasible designs have the worst value of every objective. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bench/search/families.h"
#include "bench/search/methods.h"
#include "moga/selection.h"
#include "moga/variation.h"
#include "rbf/rbf.h"

enum { UPDATES = 5, GENERATIONS = 20, TUNE_EVERY = 25, LLOYD = 5 };
static const double DELTA = 0.05;
static const double ZERO[FAMILY_VAR_MAX];

/* Ranges by which objectives are divided before angles are measured. */
typedef struct {
    double ideal[FAMILY_OBJ_MAX], range[FAMILY_OBJ_MAX];
} Ranges;

typedef struct {
    const Problem *p;
    const Settings *s;
    Course *c;
    Rbf *rbf;
    Directions w;
    Selection *selection;
    size_t n_train_max, n_train, n, n_inactive; /* n: members; n_inactive: fixed vectors without members before */
    Ranges first;                               /* of the first sample */
    double *V, *gap;               /* (w.n, n_obj) unit vectors; (w.n) [rad] angle to the nearest other one */
    double *X;                     /* (c->n_max + UPDATES, n_var) evaluated, in the unit cube */
    double *U, *F;                 /* (n_train_max, n_var) (n_train_max, n_obj) training set */
    double *Y, *predicted, *error; /* (pool, n_var) (pool, n_obj) (pool, n_obj) members and their children */
    double *penalised;             /* (pool) */
    size_t *train;                 /* (n_train_max + UPDATES) rows */
    size_t *selected, *near;       /* (pool) (pool or n_train_max + UPDATES): nearest vector */
    size_t *members;               /* (w.n) */
    size_t *cluster;               /* (w.n) of a vector */
    double one[FAMILY_VAR_MAX];
} Krvea;

/* -- vectors ------------------------------------------------------------------------------------------------------- */

static double angle_of(size_t m, const double a[], const double b[])
{
    double along = 0.0, square = 0.0;
    for (size_t k = 0; k < m; k++) {
        along += a[k] * b[k];
        square += a[k] * a[k];
    }
    return atan2(sqrt(fmax(square - along * along, 0.0)), along);
}

static void measure_gaps(Krvea *q)
{
    const size_t m = q->p->n_obj;
    directions_unit(&q->w, q->V);
    for (size_t i = 0; i < q->w.n; i++) {
        q->gap[i] = M_PI_2;
        for (size_t j = 0; j < q->w.n; j++)
            if (j != i)
                q->gap[i] = fmin(q->gap[i], angle_of(m, q->V + i * m, q->V + j * m));
    }
}

static Ranges ranges_of(size_t n, size_t m, const double F[])
{
    Ranges r;
    for (size_t k = 0; k < m; k++) {
        double max = -INFINITY;
        r.ideal[k] = INFINITY;
        for (size_t i = 0; i < n; i++) {
            r.ideal[k] = fmin(r.ideal[k], F[i * m + k]);
            max = fmax(max, F[i * m + k]);
        }
        r.range[k] = fmax(max - r.ideal[k], 1e-12);
    }
    return r;
}

/* Nearest vector, angle-penalised distance at the end of RVEA. */
static size_t associate(const Krvea *q, const Ranges *r, const double f[], double *penalised)
{
    const size_t m = q->p->n_obj;
    double z[FAMILY_OBJ_MAX], square = 0.0, least = INFINITY;
    size_t nearest = 0;
    for (size_t k = 0; k < m; k++) {
        z[k] = (f[k] - r->ideal[k]) / r->range[k];
        square += z[k] * z[k];
    }
    for (size_t i = 0; i < q->w.n; i++) {
        const double angle = angle_of(m, z, q->V + i * m);
        if (angle < least) {
            least = angle;
            nearest = i;
        }
    }
    *penalised = sqrt(square) * (1.0 + (double)m * least / q->gap[nearest]);
    return nearest;
}

/* Returns how many vectors have members. */
static size_t associate_all(Krvea *q, const Ranges *r, size_t n, const double F[])
{
    size_t n_active = 0;
    double unused;
    memset(q->members, 0, q->w.n * sizeof *q->members);
    for (size_t i = 0; i < n; i++) {
        q->near[i] = associate(q, r, F + i * q->p->n_obj, i < q->n ? &q->penalised[i] : &unused);
        n_active += q->members[q->near[i]]++ == 0;
    }
    return n_active;
}

/* -- training set -------------------------------------------------------------------------------------------------- */

/* Objectives of a row; the worst of those that count, where it does not. */
static void objectives(const Krvea *q, size_t row, const double worst[], double f[])
{
    const size_t m = q->p->n_obj;
    memcpy(f, q->c->counts[row] ? q->c->F + row * m : worst, m * sizeof *f);
}

static void gather(Krvea *q)
{
    const size_t m = q->p->n_obj, n_var = q->p->n_var;
    double worst[FAMILY_OBJ_MAX];
    for (size_t k = 0; k < m; k++) {
        worst[k] = 0.0;
        for (size_t i = 0, any = 0; i < q->c->n; i++)
            if (q->c->counts[i]) {
                worst[k] = any ? fmax(worst[k], q->c->F[i * m + k]) : q->c->F[i * m + k];
                any = 1;
            }
    }
    for (size_t i = 0; i < q->n_train; i++) {
        memcpy(q->U + i * n_var, q->X + q->train[i] * n_var, n_var * sizeof *q->U);
        objectives(q, q->train[i], worst, q->F + i * m);
    }
}

/* The last n_new stay. */
static void shrink_training_set(Krvea *q, size_t n_new, Random *r)
{
    if (q->n_train <= q->n_train_max)
        return;
    gather(q);
    const Ranges ranges = ranges_of(q->n_train, q->p->n_obj, q->F);
    q->n = 0;
    associate_all(q, &ranges, q->n_train - n_new, q->F);
    while (q->n_train > q->n_train_max) {
        size_t crowded = 0, skip, i = 0;
        for (size_t v = 1; v < q->w.n; v++)
            crowded = q->members[v] > q->members[crowded] ? v : crowded;
        for (skip = random_below(r, q->members[crowded]--); q->near[i] != crowded || skip-- > 0;)
            i++;
        memmove(q->near + i, q->near + i + 1, (q->n_train - n_new - i - 1) * sizeof *q->near);
        memmove(q->train + i, q->train + i + 1, (--q->n_train - i) * sizeof *q->train);
    }
}

static Status fit(Krvea *q, Err *err)
{
    const size_t before = q->c->n > UPDATES ? q->c->n - UPDATES : 0;
    gather(q);
    const int tuning = q->c->n / TUNE_EVERY != before / TUNE_EVERY;
    return (tuning ? rbf_tune : rbf_fit)(q->rbf, q->n_train, q->U, q->F, NULL, err);
}

/* -- RVEA on the predictions --------------------------------------------------------------------------------------- */

static void survive(Krvea *q, size_t n, double progress, Random *r)
{
    const size_t m = q->p->n_obj, n_var = q->p->n_var;
    q->n = selection_select(q->selection, n, q->predicted, NULL, q->w.n, progress, r, q->selected);
    for (size_t i = 0; i < q->n; i++) {
        const size_t from = q->selected[i]; /* i at least */
        memmove(q->Y + i * n_var, q->Y + from * n_var, n_var * sizeof *q->Y);
        memmove(q->predicted + i * m, q->predicted + from * m, m * sizeof *q->predicted);
        memmove(q->error + i * m, q->error + from * m, m * sizeof *q->error);
    }
}

static void run_rvea(Krvea *q, Random *r)
{
    const size_t m = q->p->n_obj, n_var = q->p->n_var;
    const SearchOptions *o = &q->s->search;
    memcpy(q->Y, q->U, q->n_train * n_var * sizeof *q->Y);
    rbf_eval(q->rbf, q->n_train, q->Y, q->predicted, q->error);
    survive(q, q->n_train, 0.0, r);
    for (int g = 1; g <= GENERATIONS; g++) {
        size_t n = q->n;
        double spare[FAMILY_VAR_MAX];
        for (; n < q->n + q->w.n; n++) {
            double *child = q->Y + n * n_var;
            const size_t a = random_below(r, q->n), b = random_below(r, q->n);
            crossover_sbx(r, n_var, ZERO, q->one, o->crossover_probability, o->crossover_eta, q->Y + a * n_var,
                          q->Y + b * n_var, child, spare);
            mutate_polynomial(r, n_var, ZERO, q->one, o->mutation_rate / (double)n_var, o->mutation_eta, child);
        }
        rbf_eval(q->rbf, n - q->n, q->Y + q->n * n_var, q->predicted + q->n * m, q->error + q->n * m);
        survive(q, n, (double)g / GENERATIONS, r);
    }
}

/* -- which are evaluated ------------------------------------------------------------------------------------------- */

static size_t nearest_centre(size_t n, size_t m, const double centre[], const double v[], double *distance)
{
    size_t best = 0;
    *distance = INFINITY;
    for (size_t c = 0; c < n; c++) {
        double square = 0.0;
        for (size_t k = 0; k < m; k++)
            square += (v[k] - centre[c * m + k]) * (v[k] - centre[c * m + k]);
        if (square < *distance) {
            *distance = square;
            best = c;
        }
    }
    return best;
}

/* Lloyd's iterations on the vectors with members, from those farthest from each other. */
static void cluster_vectors(Krvea *q, size_t n)
{
    const size_t m = q->p->n_obj;
    double centre[UPDATES * FAMILY_OBJ_MAX] = {0}, d;
    for (size_t c = 0; c < n; c++) {
        double farthest = -1.0;
        for (size_t v = 0; v < q->w.n; v++)
            if (q->members[v] > 0 && (nearest_centre(c, m, centre, q->V + v * m, &d), d > farthest)) {
                farthest = d;
                memcpy(centre + c * m, q->V + v * m, m * sizeof *centre);
            }
    }
    for (int round = 0; round < LLOYD; round++) {
        double sum[UPDATES * FAMILY_OBJ_MAX] = {0}, count[UPDATES] = {0};
        for (size_t v = 0; v < q->w.n; v++) {
            const size_t c = q->cluster[v] = nearest_centre(n, m, centre, q->V + v * m, &d);
            count[c] += q->members[v] > 0;
            for (size_t k = 0; k < m; k++)
                sum[c * m + k] += q->members[v] > 0 ? q->V[v * m + k] : 0.0;
        }
        for (size_t i = 0; i < n * m; i++)
            centre[i] = count[i / m] > 0.0 ? sum[i] / count[i / m] : centre[i];
    }
}

static double mean_error(const Krvea *q, const Ranges *r, size_t i)
{
    double sum = 0.0;
    for (size_t k = 0; k < q->p->n_obj; k++)
        sum += q->error[i * q->p->n_obj + k] / r->range[k];
    return sum;
}

/* Rows of the population into chosen (UPDATES); returns how many. */
static size_t choose(Krvea *q, size_t chosen[])
{
    const size_t inactive = q->w.n - associate_all(q, &q->first, q->n, q->predicted), before = q->n_inactive;
    const int explore = (double)inactive > (double)before + DELTA * (double)q->w.n;
    const Ranges ranges = ranges_of(q->n, q->p->n_obj, q->predicted);
    const size_t n_active = associate_all(q, &ranges, q->n, q->predicted), n = n_active < UPDATES ? n_active : UPDATES;
    double least[UPDATES];
    size_t n_chosen = 0;
    q->n_inactive = inactive;
    cluster_vectors(q, n);
    for (size_t c = 0; c < n; c++) {
        least[c] = INFINITY;
        for (size_t i = 0; i < q->n; i++) {
            const double cost = explore ? -mean_error(q, &ranges, i) : q->penalised[i];
            if (q->cluster[q->near[i]] == c && cost < least[c]) {
                least[c] = cost;
                chosen[n_chosen] = i;
            }
        }
        n_chosen += isfinite(least[c]);
    }
    return n_chosen;
}

static int is_known(const Krvea *q, const double u[])
{
    for (size_t i = 0; i < q->c->n; i++)
        if (memcmp(q->X + i * q->p->n_var, u, q->p->n_var * sizeof *u) == 0)
            return 1;
    return 0;
}

/* u (n_var) becomes the last of the training set. */
static void evaluate(Krvea *q, const double u[])
{
    double x[FAMILY_VAR_MAX], f[FAMILY_OBJ_MAX];
    const size_t row = q->c->n;
    memmove(q->X + row * q->p->n_var, u, q->p->n_var * sizeof *u);
    problem_from_cube(q->p, u, x);
    if (course_evaluate(q->c, q->p, x, f, NULL))
        q->train[q->n_train++] = row;
}

/* Designs that are known already are replaced by random ones. */
static void update(Krvea *q, Random *r)
{
    size_t chosen[UPDATES] = {0};
    const size_t before = q->n_train, n = choose(q, chosen);
    for (size_t i = 0; i < n; i++) {
        double *u = q->Y + chosen[i] * q->p->n_var;
        for (size_t d = 0, known = is_known(q, u) != 0; known && d < q->p->n_var; d++)
            u[d] = random_uniform(r);
        evaluate(q, u);
    }
    shrink_training_set(q, q->n_train - before, r);
}

static Status run(Krvea *q, Err *err)
{
    const uint32_t seed = (uint32_t)q->s->search.seed;
    const size_t n_var = q->p->n_var, first = 4 * n_var + 12;
    latin_hypercube(seed, 0, first, n_var, ZERO, q->one, q->Y, q->near);
    for (size_t i = 0; i < first; i++)
        evaluate(q, q->Y + i * n_var);
    gather(q);
    q->first = ranges_of(q->n_train, q->p->n_obj, q->F);
    q->n_inactive = q->w.n;
    while (q->c->n < q->c->n_max) {
        Random r = random_stream(seed, RANDOM_VARIATION, 1, (uint32_t)q->c->n);
        TRY(fit(q, err));
        run_rvea(q, &r);
        update(q, &r);
    }
    return STATUS_OK;
}

/* -- memory -------------------------------------------------------------------------------------------------------- */

static Status allocate(Krvea *q, Err *err)
{
    const size_t m = q->p->n_obj, n_var = q->p->n_var, n = q->w.n, train = q->n_train_max + UPDATES,
                 pool = train + 2 * n;
    q->V = calloc(n * (m + 1) + (q->c->n_max + UPDATES) * n_var + train * (n_var + m) + pool * (n_var + 2 * m + 1),
                  sizeof *q->V);
    q->train = calloc(train + 2 * pool + 2 * n, sizeof *q->train);
    if (!q->V || !q->train)
        return fail(err, STATUS_NO_MEMORY, "K-RVEA: no memory for %zu designs", q->c->n_max);
    q->gap = q->V + n * m;
    q->X = q->gap + n;
    q->U = q->X + (q->c->n_max + UPDATES) * n_var;
    q->F = q->U + train * n_var;
    q->Y = q->F + train * m;
    q->predicted = q->Y + pool * n_var;
    q->error = q->predicted + pool * m;
    q->penalised = q->error + pool * m;
    q->selected = q->train + train;
    q->near = q->selected + pool;
    q->members = q->near + pool;
    q->cluster = q->members + n;
    measure_gaps(q);
    TRY(rbf_create(&q->rbf, train, n_var, m, err));
    return selection_create(&q->selection, SELECTION_RVEA, pool, &q->w, err);
}

Status run_krvea(const Settings *s, const Problem *p, Course *c, Err *err)
{
    Krvea q = {.p = p, .s = s, .c = c, .n_train_max = 11 * p->n_var - 1};
    for (size_t d = 0; d < p->n_var; d++)
        q.one[d] = 1.0;
    TRY(directions_spread(&q.w, p->n_obj, (size_t)s->search.population, err));
    Status status = allocate(&q, err);
    if (status == STATUS_OK)
        status = run(&q, err);
    selection_free(q.selection);
    rbf_free(q.rbf);
    directions_free(&q.w);
    free(q.V);
    free(q.train);
    return status;
}
