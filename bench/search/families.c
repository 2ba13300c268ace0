#include "bench/search/families.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/random.h"

typedef enum { SPHERE, RASTRIGIN, ACKLEY, ROSENBROCK, TRAPS } Distance;
typedef enum { LINEAR, CONVEX, CONCAVE, CURVE, PIECES, QUADRATICS } Front;
typedef enum { NEVER, SLAB, BALL, CHECKER } Failing;

typedef struct {
    Family family;
    Distance distance;
    Front front;
    Failing failing;
    double waves;  /* of Rastrigin's cosine in the unit interval */
    double height; /* ... its height */
    int is_rotated, is_scaled;
} Recipe;

static const Recipe RECIPES[] = {
    {{"ripples2", "Rastrigin, two objectives", 10, 2, 0, 0}, RASTRIGIN, CONVEX, NEVER, 4, 0.3, 0, 0},
    {{"ripples5", "Rastrigin, rotated, five objectives", 15, 5, 0, 0}, RASTRIGIN, CONCAVE, NEVER, 3, 0.2, 1, 0},
    {{"ackley3", "Ackley, shifted, three objectives", 12, 3, 0, 0}, ACKLEY, LINEAR, NEVER, 0, 0, 0, 0},
    {{"valley3", "Rosenbrock, rotated", 12, 3, 0, 0}, ROSENBROCK, CONCAVE, NEVER, 0, 0, 1, 0},
    {{"curve6", "degenerate: the front is a curve", 14, 6, 0, 0}, SPHERE, CURVE, NEVER, 0, 0, 1, 0},
    {{"pieces4", "disconnected", 12, 4, 0, 0}, SPHERE, PIECES, NEVER, 0, 0, 1, 0},
    {{"scales40", "objectives of 1e-3 to 1e6, 40 variables", 40, 3, 0, 0}, SPHERE, CONVEX, NEVER, 0, 0, 1, 1},
    {{"quadratics10", "ten quadratics, rotated", 16, 10, 0, 0}, SPHERE, QUADRATICS, NEVER, 0, 0, 1, 0},
    {{"limits4", "quadratics under two limits", 10, 4, 2, 0}, SPHERE, QUADRATICS, NEVER, 0, 0, 1, 0},
    {{"slab3", "a third of the box fails, the best of it", 10, 3, 0, 0}, SPHERE, CONCAVE, SLAB, 0, 0, 1, 0},
    {{"ball4", "fails about the minima of the quadratics", 8, 4, 0, 0}, SPHERE, QUADRATICS, BALL, 0, 0, 1, 0},
    {{"ripples3", "Rastrigin, rotated, aside", 12, 3, 0, 1}, RASTRIGIN, LINEAR, NEVER, 5, 0.25, 1, 0},
    {{"valley6", "Rosenbrock in six objectives, aside", 20, 6, 0, 1}, ROSENBROCK, CONVEX, NEVER, 0, 0, 1, 1},
    {{"limits7", "Ackley under a limit, aside", 14, 7, 1, 1}, ACKLEY, CONCAVE, NEVER, 0, 0, 0, 0},
    {{"checker3", "a third of the box fails, in squares, aside", 8, 3, 0, 1}, SPHERE, QUADRATICS, CHECKER, 0, 0, 0, 0},
    {{"slab5", "a third of the box fails, aside", 12, 5, 0, 1}, SPHERE, QUADRATICS, SLAB, 0, 0, 1, 0},
    {{"combs2", "Rastrigin, steep, ten waves", 10, 2, 0, 0}, RASTRIGIN, CONVEX, NEVER, 10, 1, 0, 0},
    {{"combs7", "Rastrigin, steep, six waves", 16, 7, 0, 0}, RASTRIGIN, CONCAVE, NEVER, 6, 1, 0, 0},
    {{"traps3", "deceptive, three objectives", 12, 3, 0, 0}, TRAPS, CONCAVE, NEVER, 0, 0, 0, 0},
    {{"combs3", "Rastrigin, steep, eight waves, aside", 14, 3, 0, 1}, RASTRIGIN, LINEAR, NEVER, 8, 1.5, 0, 0},
    {{"traps5", "deceptive, five objectives, aside", 10, 5, 0, 1}, TRAPS, LINEAR, NEVER, 0, 0, 0, 0},
    {{"traps4", "deceptive, four objectives, by name", 9, 4, 0, 2}, TRAPS, CONVEX, NEVER, 0, 0, 0, 0},
    {{"traps6", "deceptive, six objectives, by name", 12, 6, 0, 2}, TRAPS, CONCAVE, NEVER, 0, 0, 0, 0},
    {{"mixed7", "a sphere, 10 reals, 6 whole numbers, 6 choices", 22, 7, 0, 3}, SPHERE, CONCAVE, NEVER, 0, 0, 0, 0},
    {{"mixed3", "Rosenbrock, 6 reals, 4 whole numbers, 4 choices", 14, 3, 0, 3}, ROSENBROCK, CONVEX, NEVER, 0, 0, 0, 0},
};
enum { N_RECIPES = sizeof RECIPES / sizeof *RECIPES };

/* How many of the last variables are whole numbers and choices. */
typedef struct {
    const char *name;
    size_t n_whole, n_choice;
} Mix;

static const Mix MIXES[] = {{"mixed7", 6, 6}, {"mixed3", 4, 4}};
enum { N_MIXES = sizeof MIXES / sizeof *MIXES };

/* A recipe with its constants. */
typedef struct {
    Recipe recipe;
    const Mix *mix;                                 /* NULL: all variables are real */
    double shift[FAMILY_VAR_MAX];                   /* of the distance's zero */
    double turn[FAMILY_VAR_MAX][FAMILY_VAR_MAX];    /* orthogonal */
    double minimum[FAMILY_OBJ_MAX][FAMILY_VAR_MAX]; /* of each quadratic */
    double weight[FAMILY_OBJ_MAX][FAMILY_VAR_MAX];
    double lower[FAMILY_VAR_MAX], upper[FAMILY_VAR_MAX];
    VariableKind kind[FAMILY_VAR_MAX];
} Made;

size_t family_count(void)
{
    return N_RECIPES;
}

const Family *family(size_t i)
{
    return &RECIPES[i].family;
}

/* -- parts --------------------------------------------------------------------------------------------------------- */

/* y = turn (x - shift) of the variables from `first` on. */
static size_t turned(const Made *m, size_t first, const double x[], double y[])
{
    const size_t n = m->recipe.family.n_var - first;
    for (size_t i = 0; i < n; i++) {
        y[i] = m->recipe.is_rotated ? 0.0 : x[first + i] - m->shift[first + i];
        for (size_t j = 0; m->recipe.is_rotated && j < n; j++)
            y[i] += m->turn[i][j] * (x[first + j] - m->shift[first + j]);
    }
    return n;
}

static double rosenbrock(size_t n, const double y[])
{
    double sum = 0.0;
    for (size_t i = 0; i + 1 < n; i++) {
        const double a = 1.0 + 2.0 * y[i], b = 1.0 + 2.0 * y[i + 1], bend = b - a * a;
        sum += (10.0 * bend * bend + (1.0 - a) * (1.0 - a)) / (double)n;
    }
    return sum;
}

/* Falls towards the bounds but for a narrow valley about the zero. */
static double traps(size_t n, const double y[])
{
    double sum = 0.0;
    for (size_t i = 0; i < n; i++) {
        const double off = fabs(y[i]);
        sum += fmin(off / 0.06, fmax(1.0 - 1.2 * (off - 0.06), 0.2)) / (double)n;
    }
    return 4.0 * sum;
}

static double distance(const Made *m, size_t n, const double y[])
{
    double square = 0.0, waves = 0.0;
    if (m->recipe.distance == ROSENBROCK)
        return rosenbrock(n, y);
    if (m->recipe.distance == TRAPS)
        return traps(n, y);
    for (size_t i = 0; i < n; i++) {
        square += y[i] * y[i];
        waves += 1.0 - cos(2.0 * M_PI * m->recipe.waves * y[i]);
    }
    if (m->recipe.distance == RASTRIGIN)
        return 4.0 * square + m->recipe.height * waves;
    if (m->recipe.distance == ACKLEY)
        return 4.0 * (1.0 - exp(-4.0 * sqrt(square / (double)n)));
    return 4.0 * square;
}

/* -- fronts -------------------------------------------------------------------------------------------------------- */

static void simplex(size_t n_obj, const double x[], double f[])
{
    for (size_t k = 0; k < n_obj; k++) {
        f[k] = k > 0 ? 1.0 - x[n_obj - 1 - k] : 1.0;
        for (size_t d = 0; d + k + 1 < n_obj; d++)
            f[k] *= x[d];
    }
}

static void on_front(const Made *m, const double x[], double g, double f[])
{
    const size_t n = m->recipe.family.n_obj;
    if (m->recipe.front == CURVE) {
        for (size_t k = 0; k < n; k++) {
            const double off = x[0] - (double)k / (double)(n - 1);
            f[k] = off * off + g * (1.0 + 0.2 * (double)k);
        }
        return;
    }
    simplex(n, x, f);
    for (size_t k = 0; k < n; k++) {
        const double s = f[k];
        f[k] = m->recipe.front == CONVEX ? s * s : m->recipe.front == CONCAVE ? sqrt(s) : s;
        if (m->recipe.front == PIECES && k + 1 == n)
            f[k] += 0.3 * (1.0 + sin(9.0 * M_PI * x[0]));
        f[k] = f[k] * (1.0 + g) + 0.2 * g;
    }
}

static void quadratics(const Made *m, const double x[], double f[])
{
    double y[FAMILY_VAR_MAX];
    const size_t n = turned(m, 0, x, y);
    for (size_t k = 0; k < m->recipe.family.n_obj; k++) {
        f[k] = 0.0;
        for (size_t i = 0; i < n; i++)
            f[k] += m->weight[k][i] * (y[i] - m->minimum[k][i]) * (y[i] - m->minimum[k][i]);
    }
}

static double scale_of(const Made *m, size_t k)
{
    static const double SCALES[] = {1e-3, 1e6, 1.0, 1e3, 1e-1, 1e2};
    return m->recipe.is_scaled ? SCALES[k % 6] : 1.0;
}

static double square_off(size_t n, const double x[], const double centre[])
{
    double square = 0.0;
    for (size_t i = 0; i < n; i++)
        square += (x[i] - centre[i]) * (x[i] - centre[i]);
    return square;
}

/* A third of the box or so, which holds the best of an objective at least. */
static int fails(const Made *m, const double x[])
{
    const size_t n = m->recipe.family.n_var;
    double side = 0.0;
    switch (m->recipe.failing) {
    case NEVER:
        return 0;
    case SLAB: /* x[2] near the distance's zero, and its side */
        return x[2] > m->shift[2] - 0.08 && x[2] < m->shift[2] + 0.25;
    case BALL:
        for (size_t i = 0; i < n; i++)
            side += x[i] / (double)n;
        return square_off(n, x, m->shift) < 0.03 * (double)n || side < 0.42;
    case CHECKER:
        return ((int)(4.0 * x[0]) + (int)(4.0 * x[1])) % 3 == 0;
    }
    return 0;
}

static const double WORDS[] = {0.0, 0.75, 0.25, 1.0, 0.5}, TENTHS = 10.0;

/* What stands for whole numbers and choices. */
static void to_unit(const Made *m, const double x[], double u[])
{
    for (size_t j = 0; j < m->recipe.family.n_var; j++)
        u[j] = m->kind[j] == VARIABLE_CHOICE  ? WORDS[(size_t)x[j]]
               : m->kind[j] == VARIABLE_WHOLE ? x[j] / TENTHS
                                              : x[j];
}

/* Whole numbers and choices are rounded, for searches that do not know them. */
static void evaluate(const Made *m, const double x_real[], double f[], double g[])
{
    const Family *a = &m->recipe.family;
    double design[FAMILY_VAR_MAX], x[FAMILY_VAR_MAX], y[FAMILY_VAR_MAX];
    for (size_t j = 0; j < a->n_var; j++)
        design[j] = m->kind[j] == VARIABLE_WHOLE || m->kind[j] == VARIABLE_CHOICE ? round(x_real[j]) : x_real[j];
    to_unit(m, design, x);
    if (m->recipe.front == QUADRATICS) {
        quadratics(m, x, f);
    } else {
        const size_t n = turned(m, m->recipe.front == CURVE ? 1 : a->n_obj - 1, x, y);
        on_front(m, x, distance(m, n, y), f);
    }
    for (size_t k = 0; k < a->n_obj; k++)
        f[k] *= scale_of(m, k);
    if (a->n_con > 0) /* outside a ball about the best designs */
        g[0] = 0.03 * (double)a->n_var - square_off(a->n_var, x, m->shift);
    if (a->n_con > 1)
        g[1] = x[0] + x[1] + x[2] - 1.4;
}

/* simplex() the other way round. */
static size_t place_on_simplex(size_t n_obj, const double w[], double x[])
{
    double left = 1.0;
    for (size_t d = 0; d + 1 < n_obj; d++) {
        x[d] = left > 1e-12 ? fmin(fmax(1.0 - w[n_obj - 1 - d] / left, 0.0), 1.0) : 0.5;
        left *= x[d];
    }
    return n_obj - 1;
}

size_t family_place(const Problem *p, const double w[], double share, double x[])
{
    const Made *m = p->self;
    for (size_t j = 0; j < p->n_var; j++)
        x[j] = m->kind[j] == VARIABLE_WHOLE    ? round(TENTHS * m->shift[j])
               : m->kind[j] == VARIABLE_CHOICE ? 4.0
                                               : m->shift[j];
    if (m->recipe.front == QUADRATICS)
        return 0;
    if (m->recipe.front != CURVE)
        return place_on_simplex(p->n_obj, w, x);
    x[0] = share;
    return 1;
}

double family_evaluate(const Problem *p, const double x[], double f[])
{
    double g[FAMILY_CON_MAX];
    evaluate(p->self, x, f, g);
    return fails(p->self, x) ? INFINITY : violation_of(p->n_con, g);
}

/* -- as a problem -------------------------------------------------------------------------------------------------- */

static Status simulate(void *self, size_t worker, const Task *task, Err *err)
{
    const Made *m = self;
    const Family *a = &m->recipe.family;
    double *f = task->result, *g = f + a->n_obj;
    (void)worker;
    (void)err;
    evaluate(m, task->x, f, g);
    g[a->n_con] = fails(m, task->x);
    return STATUS_OK;
}

static void combine(const Problem *p, size_t n, const void *parts, Evaluation *e)
{
    (void)n;
    const Made *m = p->self;
    const Family *a = &m->recipe.family;
    const double *f = parts, *g = f + a->n_obj;
    memcpy(e->f, f, a->n_obj * sizeof *f);
    if (a->n_con > 0)
        memcpy(e->extra, g, a->n_con * sizeof *g);
    if (g[a->n_con] != 0.0)
        evaluation_set_outcome(e, OUTCOME_ERROR, "fails");
}

static void judge(const Evaluation *e, double f[], double g[], const void *user)
{
    const Made *m = user;
    memcpy(f, e->f, m->recipe.family.n_obj * sizeof *f);
    if (m->recipe.family.n_con > 0)
        memcpy(g, e->extra, m->recipe.family.n_con * sizeof *g);
}

static const Simulator FAMILY = {.simulate = simulate, .combine = combine, .close = free};

/* Rows of normal numbers made orthogonal, Gram and Schmidt twice. */
static void draw_turn(Random *r, size_t n, double turn[][FAMILY_VAR_MAX])
{
    for (size_t i = 0; i < n; i++) {
        for (size_t j = 0; j < n; j++)
            turn[i][j] = random_normal(r);
        for (size_t pass = 0; pass < 2 * i; pass++) {
            double along = 0.0;
            for (size_t j = 0; j < n; j++)
                along += turn[i][j] * turn[pass % i][j];
            for (size_t j = 0; j < n; j++)
                turn[i][j] -= along * turn[pass % i][j];
        }
        double square = 0.0;
        for (size_t j = 0; j < n; j++)
            square += turn[i][j] * turn[i][j];
        for (size_t j = 0; j < n; j++)
            turn[i][j] /= sqrt(square);
    }
}

static const Mix *mix_of(const char *name)
{
    for (size_t i = 0; i < N_MIXES; i++)
        if (strcmp(MIXES[i].name, name) == 0)
            return &MIXES[i];
    return NULL;
}

/* The distance's zero goes where whole numbers and choices can be. */
static void set_kinds(Made *m)
{
    const Mix *mix = m->mix;
    const size_t n = m->recipe.family.n_var, first = n - mix->n_whole - mix->n_choice;
    for (size_t j = first; j < n; j++) {
        const int is_whole = j < first + mix->n_whole;
        m->kind[j] = is_whole ? VARIABLE_WHOLE : VARIABLE_CHOICE;
        m->upper[j] = is_whole ? TENTHS : 4.0;
        m->shift[j] = is_whole ? round(TENTHS * m->shift[j]) / TENTHS : WORDS[4];
    }
}

static void draw(Made *m, size_t i)
{
    Random r = random_stream((uint32_t)i, RANDOM_TEST, 1, 0);
    for (size_t j = 0; j < FAMILY_VAR_MAX; j++) {
        m->upper[j] = 1.0;
        m->shift[j] = 0.3 + 0.4 * random_uniform(&r);
    }
    draw_turn(&r, m->recipe.family.n_var, m->turn);
    for (size_t k = 0; k < FAMILY_OBJ_MAX; k++)
        for (size_t j = 0; j < FAMILY_VAR_MAX; j++) {
            m->minimum[k][j] = 0.5 * random_uniform(&r) - 0.25;
            m->weight[k][j] = pow(10.0, random_uniform(&r));
        }
}

Status family_open(Problem *p, size_t i, Err *err)
{
    const Family *a = family(i);
    Made *m = calloc(1, sizeof *m);
    if (!m)
        return fail(err, STATUS_NO_MEMORY, "no memory for a problem");
    m->recipe = RECIPES[i];
    draw(m, i);
    m->mix = mix_of(a->name);
    if (m->mix)
        set_kinds(m);
    *p = (Problem){.n_var = a->n_var,
                   .n_obj = a->n_obj,
                   .n_con = a->n_con,
                   .n_extra = a->n_con,
                   .lower = m->lower,
                   .upper = m->upper,
                   .kind = m->mix ? m->kind : NULL,
                   .judge = judge,
                   .user = m,
                   .simulator = &FAMILY,
                   .self = m,
                   .n_parts = 1,
                   .part_size = (a->n_obj + a->n_con + 1) * sizeof(double),
                   .n_workers = 1};
    return STATUS_OK;
}
