#include "moga/state.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "rbf/rbf.h"

/* Output k of design i by the cheap level, and of its row in the archive. */
static double cheap_value(const Search *s, size_t i, size_t k)
{
    return s->screening.y[i * (s->problem->n_obj + s->problem->n_con) + k];
}

static double value_of(const Search *s, size_t row, size_t k)
{
    const Archive *a = &s->archive;
    return k < a->n_obj ? a->Y[row * a->n_obj + k] : a->H[row * a->n_con + k - a->n_obj];
}

/* Output k of screened design i by the whole evaluation, which it has. */
static double whole_value(const Search *s, size_t i, size_t k)
{
    return value_of(s, s->screening.design[i].finished, k);
}

/* Sums over designs and lines through them stay finite. */
static int is_far_from_overflow(const Search *s, size_t i)
{
    static const double MOST = DBL_MAX * 0x1p-32;
    for (size_t k = 0; k < s->problem->n_obj + s->problem->n_con; k++)
        if (!(fabs(cheap_value(s, i, k)) < MOST && fabs(whole_value(s, i, k)) < MOST))
            return 0;
    return 1;
}

/* Designs that have both levels, in screening.rows. */
static size_t find_pairs(Search *s)
{
    Screening *q = &s->screening;
    q->n_rows = 0;
    for (size_t i = 0; i < q->n; i++)
        if (q->design[i].finished != SIZE_MAX && s->archive.usable[q->design[i].finished] && is_far_from_overflow(s, i))
            q->rows[q->n_rows++] = i;
    return q->n_rows;
}

/* The power of two of `most`: what is divided by it keeps its digits. */
static double scale_of(double most)
{
    return most > 0.0 ? ldexp(1.0, ilogb(most)) : 1.0;
}

typedef struct {
    double from, to, slope; /* means, slope between them */
    double rest;            /* size of what it leaves */
} Line;

static Line fit_line(const Search *s, size_t k)
{
    const Screening *q = &s->screening;
    const double n = (double)q->n_rows;
    Line line = {0.0, 0.0, 1.0, 1.0};
    double xx = 0.0, xy = 0.0, x_most = 0.0, y_most = 0.0;
    for (size_t j = 0; j < q->n_rows; j++) {
        line.from += cheap_value(s, q->rows[j], k) / n;
        line.to += whole_value(s, q->rows[j], k) / n;
    }
    for (size_t j = 0; j < q->n_rows; j++) {
        x_most = fmax(x_most, fabs(cheap_value(s, q->rows[j], k) - line.from));
        y_most = fmax(y_most, fabs(whole_value(s, q->rows[j], k) - line.to));
    }
    const double x_scale = scale_of(x_most), y_scale = scale_of(y_most);
    for (size_t j = 0; j < q->n_rows; j++) {
        const double x = (cheap_value(s, q->rows[j], k) - line.from) / x_scale;
        xx += x * x;
        xy += x * ((whole_value(s, q->rows[j], k) - line.to) / y_scale);
    }
    line.slope = xx > 0.0 ? xy / xx * (y_scale / x_scale) : 1.0;
    if (!isfinite(line.slope)) /* beside what the whole evaluation says, the cheap level is constant */
        line.slope = 0.0;
    return line;
}

static int order_of(double a, double b)
{
    return (a > b) - (a < b);
}

/* Kendall's tau of objective k, of the pairs that the whole evaluation tells apart: one that the cheap level does not tell
 * apart counts as half of an agreement and half of its contrary. NAN: there is no such pair. */
static double agreement_of(const Search *s, size_t k)
{
    const Screening *q = &s->screening;
    double same = 0.0, pairs = 0.0;
    for (size_t i = 0; i < q->n_rows; i++)
        for (size_t j = 0; j < i; j++) {
            const size_t a = q->rows[i], b = q->rows[j];
            const int whole = order_of(whole_value(s, a, k), whole_value(s, b, k));
            same += whole * order_of(cheap_value(s, a, k), cheap_value(s, b, k));
            pairs += whole != 0;
        }
    return pairs > 0.0 ? same / pairs : NAN;
}

/* An objective that the whole evaluation does not tell apart says nothing. */
static double mean_agreement(const Search *s)
{
    const size_t m = s->problem->n_obj;
    double sum = 0.0, n = 0.0, *tau = s->scratch.f;
    for (size_t k = 0; k < m; k++) {
        tau[k] = agreement_of(s, k);
        n += !isnan(tau[k]);
    }
    for (size_t k = 0; k < m; k++)
        sum += isnan(tau[k]) ? 0.0 : tau[k] / n;
    return n > 0.0 ? sum : 1.0;
}

/* Of a cheap level that is no part of the whole: all answers are those of the whole evaluation. */
static int levels_are_the_same(const Search *s)
{
    const Screening *q = &s->screening;
    int is_same = q->is_apart;
    for (size_t j = 0; j < q->n_rows && is_same; j++)
        for (size_t k = 0; k < s->problem->n_obj + s->problem->n_con; k++)
            is_same &= cheap_value(s, q->rows[j], k) == whole_value(s, q->rows[j], k);
    return is_same;
}

/* What is predicted from the cheap level is not used any more, but for an initial sample that is to be finished. */
static void turn_off(Search *s)
{
    Screening *q = &s->screening;
    q->is_on = 0;
    for (size_t i = 0; i < q->n; i++)
        if (q->design[i].finished == SIZE_MAX && (q->is_apart || s->archive.generation[q->design[i].row] > 0))
            pareto_archive_drop(&s->archive, q->design[i].row);
}

static void look_at_agreement(Search *s)
{
    Screening *q = &s->screening;
    q->agreement = mean_agreement(s);
    q->is_same = levels_are_the_same(s);
    const double min = q->is_apart && q->n_rows > q->n_pairs ? APART_TAU_LATER : q->tau_min;
    if (q->agreement < min || !q->is_on)
        turn_off(s);
}

/* -- predictions --------------------------------------------------------------------------------------------------- */

static double *output_of(Search *s, size_t row, size_t k)
{
    Archive *a = &s->archive;
    return k < a->n_obj ? a->Y + row * a->n_obj + k : a->H + row * a->n_con + k - a->n_obj;
}

static double on_line(const Search *s, const Line *line, size_t i, size_t k)
{
    return line->to + line->slope * (cheap_value(s, i, k) - line->from);
}

/* What the lines leave of the pairs from `first` on, an interpolant of it, in units of each line's rest. */
static Status fit_rest(const Search *s, Line line[], size_t first, Rbf *rest, double X[], double F[], Err *err)
{
    const Screening *q = &s->screening;
    const size_t n_var = s->problem->n_var, n_out = s->problem->n_obj + s->problem->n_con, n = q->n_rows - first;
    for (size_t j = 0; j < n; j++) {
        const size_t i = q->rows[first + j];
        problem_to_cube(s->problem, s->archive.X + q->design[i].row * n_var, X + j * n_var);
        for (size_t k = 0; k < n_out; k++)
            F[j * n_out + k] = whole_value(s, i, k) - on_line(s, &line[k], i, k);
    }
    for (size_t k = 0; k < n_out; k++) {
        double most = 0.0;
        for (size_t j = 0; j < n; j++)
            most = fmax(most, fabs(F[j * n_out + k]));
        line[k].rest = scale_of(most);
        for (size_t j = 0; j < n; j++)
            F[j * n_out + k] /= line[k].rest;
    }
    return rbf_tune(rest, n, X, F, NULL, err);
}

static void add_rest(Search *s, const Line line[], const Rbf *rest, double u[], double d[])
{
    const Screening *q = &s->screening;
    const size_t n_var = s->problem->n_var, n_out = s->problem->n_obj + s->problem->n_con;
    for (size_t i = 0; i < q->n; i++) {
        if (!screening_is_open(s, i))
            continue;
        problem_to_cube(s->problem, s->archive.X + q->design[i].row * n_var, u);
        rbf_eval(rest, 1, u, d, NULL);
        for (size_t k = 0; k < n_out; k++)
            *output_of(s, q->design[i].row, k) += line[k].rest * d[k] * fmax(rbf_explained(rest, k), 0.0);
    }
}

/* Of the last pairs, as many as the surrogate takes. */
static Status predict_rest(Search *s, Line line[], Err *err)
{
    const Problem *p = s->problem;
    const size_t n_out = p->n_obj + p->n_con, all = s->screening.n_rows, max = s->config->surrogate_max,
                 first = all > max ? all - max : 0, n = all - first;
    Rbf *rest = NULL;
    double *X = calloc(n * (p->n_var + n_out), sizeof *X), *F = X ? X + n * p->n_var : NULL;
    Status status = X ? rbf_create(&rest, n, p->n_var, n_out, err)
                      : fail(err, STATUS_NO_MEMORY, "no memory for %zu designs of both levels", n);
    if (status == STATUS_OK)
        status = fit_rest(s, line, first, rest, X, F, err);
    if (status == STATUS_OK)
        add_rest(s, line, rest, X, F);
    rbf_free(rest);
    free(X);
    return status;
}

static int is_finite_prediction(const Search *s, size_t row)
{
    int is_finite = 1;
    for (size_t k = 0; k < s->problem->n_obj + s->problem->n_con; k++)
        is_finite &= isfinite(value_of(s, row, k)) != 0;
    return is_finite;
}

static Status predict(Search *s, Line line[], Err *err)
{
    const Problem *p = s->problem;
    const Screening *q = &s->screening;
    const int has_line = q->n_rows >= q->n_pairs;
    for (size_t k = 0; k < p->n_obj + p->n_con; k++) {
        line[k] = has_line ? fit_line(s, k) : (Line){0.0, 0.0, 1.0, 1.0};
        for (size_t i = 0; i < q->n; i++)
            if (screening_is_open(s, i))
                *output_of(s, q->design[i].row, k) = on_line(s, &line[k], i, k);
    }
    if (has_line && q->is_apart && p->n_var <= RBF_DIM_MAX)
        TRY(predict_rest(s, line, err));
    for (size_t i = 0; i < q->n; i++)
        if (screening_is_open(s, i) && !is_finite_prediction(s, q->design[i].row))
            pareto_archive_drop(&s->archive, q->design[i].row);
        else if (screening_is_open(s, i))
            pareto_archive_predicted(&s->archive, q->design[i].row);
    return STATUS_OK;
}

Status levels_compare(Search *s, Err *err)
{
    const size_t n_out = s->problem->n_obj + s->problem->n_con;
    if (find_pairs(s) >= s->screening.n_pairs)
        look_at_agreement(s);
    Line *line = calloc(n_out, sizeof *line);
    const Status status =
        line ? predict(s, line, err) : fail(err, STATUS_NO_MEMORY, "no memory for %zu outputs", n_out);
    free(line);
    return status;
}
