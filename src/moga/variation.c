#include "moga/variation.h"

static double clamp(double x, double lower, double upper)
{
    return x < lower ? lower : x > upper ? upper : x;
}

/* Spread factor of SBX whose density is cut off so that the child does not pass a bound at distance `room` from the
 * parent on its side; `apart` is the distance of the parents. */
static double spread_factor(double u, double eta, double room, double apart)
{
    const double beta = 1.0 + 2.0 * room / apart, alpha = 2.0 - pow(beta, -(eta + 1.0));
    const double base = u <= 1.0 / alpha ? u * alpha : 1.0 / (2.0 - u * alpha);
    return pow(base, 1.0 / (eta + 1.0));
}

void crossover_sbx(Random *r, size_t n_var, const double lower[], const double upper[], double eta,
                   const double mother[], const double father[], double child1[], double child2[])
{
    random_uniform(r); /* every pair is crossed */
    for (size_t d = 0; d < n_var; d++) {
        const double a = fmin(mother[d], father[d]), b = fmax(mother[d], father[d]), apart = b - a;
        const int here = random_uniform(r) < 0.5;
        const double u = random_uniform(r);
        const int swapped = random_uniform(r) < 0.5;
        child1[d] = mother[d];
        child2[d] = father[d];
        if (!here || !(apart > 1e-14 * (upper[d] - lower[d])))
            continue;
        const double middle = 0.5 * (a + b);
        const double low = middle - 0.5 * apart * spread_factor(u, eta, a - lower[d], apart);
        const double high = middle + 0.5 * apart * spread_factor(u, eta, upper[d] - b, apart);
        child1[d] = clamp(swapped ? high : low, lower[d], upper[d]);
        child2[d] = clamp(swapped ? low : high, lower[d], upper[d]);
    }
}

void mutate_polynomial(Random *r, size_t n_var, const double lower[], const double upper[], double probability,
                       double eta, double x[])
{
    const double power = 1.0 / (eta + 1.0);
    for (size_t d = 0; d < n_var; d++) {
        const int here = random_uniform(r) < probability;
        const double u = random_uniform(r), width = upper[d] - lower[d];
        if (!here || !(width > 0.0))
            continue;
        double step;
        if (u < 0.5) {
            const double left = 1.0 - (x[d] - lower[d]) / width;
            step = pow(2.0 * u + (1.0 - 2.0 * u) * pow(left, eta + 1.0), power) - 1.0;
        } else {
            const double right = 1.0 - (upper[d] - x[d]) / width;
            step = 1.0 - pow(2.0 * (1.0 - u) + (2.0 * u - 1.0) * pow(right, eta + 1.0), power);
        }
        x[d] = clamp(x[d] + step * width, lower[d], upper[d]);
    }
}

void latin_hypercube(uint32_t seed, uint32_t generation, size_t n, size_t n_var, double X[], size_t slices[])
{
    for (size_t d = 0; d < n_var; d++) {
        Random r = random_stream(seed, RANDOM_SAMPLING, generation, (uint32_t)d);
        for (size_t i = 0; i < n; i++)
            slices[i] = i;
        random_shuffle(&r, n, slices);
        for (size_t i = 0; i < n; i++)
            X[i * n_var + d] = ((double)slices[i] + random_uniform(&r)) / (double)n;
    }
}

void cross_choices(Random *r, const Problem *p, const double mother[], const double father[], double child1[],
                   double child2[])
{
    for (size_t d = 0; d < p->n_var; d++) {
        if (problem_kind(p, d) != VARIABLE_CHOICE)
            continue;
        const int swapped = random_uniform(r) < 0.5;
        child1[d] = swapped ? father[d] : mother[d];
        child2[d] = swapped ? mother[d] : father[d];
    }
}

void mutate_discrete(Random *r, const Problem *p, const double before[], double x[])
{
    for (size_t d = 0; d < p->n_var; d++) {
        const double was = before[d];
        if (!problem_is_discrete(p, d) || x[d] == was)
            continue;
        if (problem_kind(p, d) == VARIABLE_CHOICE) {
            const double other = (double)random_below(r, (size_t)p->upper[d]);
            x[d] = other < was ? other : other + 1.0;
        } else if (problem_kind(p, d) == VARIABLE_STEPPED) {
            const Steps *s = &p->steps[d];
            const size_t from = steps_nearest(s, was), to = steps_nearest(s, x[d]);
            if (to != from || s->n == 1)
                x[d] = steps_at(s, to);
            else
                x[d] = steps_at(s, from == 0 || (x[d] > was && from + 1 < s->n) ? from + 1 : from - 1);
        } else {
            const double step = fmax(round(fabs(x[d] - was)), 1.0), to = round(was) + (x[d] < was ? -step : step);
            x[d] = to < p->lower[d] || to > p->upper[d] ? round(was) + (x[d] < was ? 1.0 : -1.0) : to;
        }
    }
}

void step_discrete(Random *r, const Problem *p, size_t d, const double from[], double x[])
{
    const double less = problem_kind(p, d) == VARIABLE_STEPPED ? 1e-9 * (p->upper[d] - p->lower[d]) : 1.0;
    copy_values(p->n_var, from, x);
    x[d] += random_uniform(r) < 0.5 ? less : -less;
    mutate_discrete(r, p, from, x);
    problem_repair(p, x);
}
