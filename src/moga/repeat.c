#include "moga/searching.h"

#include <math.h>

static void range_of_front(const Archive *a, size_t k, double *least, double *most)
{
    *least = INFINITY;
    *most = -INFINITY;
    for (size_t i = 0; i < a->n_front; i++) {
        *least = fmin(*least, a->F[a->front[i] * a->n_obj + k]);
        *most = fmax(*most, a->F[a->front[i] * a->n_obj + k]);
    }
}

/* Whether the standard deviation of an answer is more than a part of the front's range, in any objective. */
static int scatters_by(const Archive *a, double part)
{
    double least, most;
    for (size_t k = 0; k < a->n_obj; k++) {
        range_of_front(a, k, &least, &most);
        for (size_t i = 0; i < a->n_front; i++)
            if (a->sd[a->front[i] * a->n_obj + k] > part * (most - least))
                return 1;
    }
    return 0;
}

static int is_noticeable(const Archive *a)
{
    return a->n_replicates < NOISE_SAMPLE || scatters_by(a, NOISE_NEGLIGIBLE);
}

int repeat_tells_of_luck(const Search *s)
{
    return s->archive.n_replicates > 0 && scatters_by(&s->archive, NOISE_SIGNIFICANT);
}

static size_t n_pending_repeats(const Search *s)
{
    size_t n = 0;
    for (size_t i = 0; i < queue_pending(s->queue); i++)
        n += queue_design(s->queue, i).kind == KIND_REPEAT;
    return n;
}

/* Simulations that are left to be asked for. */
static size_t room_of(const Search *s)
{
    const size_t asked = s->archive.n + queue_pending(s->queue);
    return s->config->max_evals > asked ? s->config->max_evals - asked : 0;
}

double search_replicates(size_t n, double share, size_t n_var)
{
    return share * fmax((double)n - (double)(REPLICATE_AFTER * n_var), 0.0);
}

/* Repeats that may still be made, of those that `part` of n simulations bring with them. */
static size_t repeats_left(const Search *s, size_t n, double part)
{
    const double due = floor(part * search_replicates(n, s->config->repeats, s->problem->n_var));
    const size_t made = s->archive.n_replicates + n_pending_repeats(s);
    if (!s->problem->is_noisy || s->config->replicates_max < 2 || due <= (double)made || !is_noticeable(&s->archive))
        return 0;
    return (size_t)due - made;
}

/* What everybody looks at first, the best in one objective and the one nearest to the best of everything, counts more
 * than all directions together. */
static void add_landmarks(Search *s)
{
    const Archive *a = &s->archive;
    size_t knee = a->front[0];
    double nearest = INFINITY;
    for (size_t k = 0; k < a->n_obj; k++) {
        size_t best = a->front[0];
        for (size_t i = 1; i < a->n_front; i++)
            if (a->F[a->front[i] * a->n_obj + k] < a->F[best * a->n_obj + k])
                best = a->front[i];
        s->wins[best] += 2 * s->wishes.n + 1;
    }
    for (size_t i = 0; i < a->n_front; i++) {
        const double away = infill_length(s->infill[INFILL_PBI], a->F + a->front[i] * a->n_obj);
        if (away < nearest) {
            nearest = away;
            knee = a->front[i];
        }
    }
    s->wins[knee] += 2 * s->wishes.n + 1;
}

/* Of every direction, the design that is best in it. */
static void count_wins(Search *s)
{
    memset(s->wins, 0, s->archive.n * sizeof *s->wins);
    for (int kind = 0; kind < INFILL_KINDS; kind++)
        for (size_t r = 0; r < s->wishes.n; r++)
            s->wins[infill_best(s->infill[kind], r)]++;
    add_landmarks(s);
}

/* The design on the front with the fewest answers that something is built on, of these the one with the most wins;
 * archive.n where none is left. */
static size_t pick(const Search *s)
{
    const Archive *a = &s->archive;
    size_t best = a->n;
    for (size_t i = 0; i < a->n_front; i++) {
        const size_t row = a->front[i];
        const int comes_first = best == a->n || a->replicates[row] < a->replicates[best] ||
                                (a->replicates[row] == a->replicates[best] && s->wins[row] > s->wins[best]);
        if (s->wins[row] > 0 && a->replicates[row] < s->config->replicates_max && comes_first &&
            !queue_has(s->queue, a->X + row * a->n_var))
            best = row;
    }
    return best;
}

/* The front has been measured, as it is now. Landmarks with a single answer go alone: where they prove lucky there are
 * others next time, which are to be tried before anything else. */
static size_t append(Search *s, size_t n, size_t limit)
{
    const size_t n_var = s->problem->n_var, landmark = 2 * s->wishes.n + 1;
    int is_race = 0;
    if (s->archive.n_front == 0 || n >= limit)
        return n;
    count_wins(s);
    for (size_t row; n < limit && (row = pick(s)) < s->archive.n; n++) {
        const int is_new = s->wins[row] >= landmark && s->archive.replicates[row] == 1;
        if (is_race && !is_new)
            break;
        is_race = is_new;
        memcpy(s->X + n * n_var, s->archive.X + row * n_var, n_var * sizeof *s->X);
        s->draws[n] = s->archive.replicates[row];
        s->wins[row] = 0;
    }
    return n;
}

static size_t lesser(size_t a, size_t b)
{
    return a < b ? a : b;
}

size_t repeat_some(Search *s, size_t n)
{
    const size_t room = lesser(s->batch_max, room_of(s)), so_far = s->archive.n + queue_pending(s->queue) + n;
    return append(s, n, lesser(room, n + repeats_left(s, so_far, REPLICATE_EARLY)));
}

size_t repeat_last(Search *s)
{
    const size_t room = room_of(s);
    s->reserved = repeats_left(s, s->config->max_evals, 1.0);
    if (room > s->reserved)
        return 0;
    s->reserved = 0; /* where nobody is left to repeat, new designs are better than nothing */
    return append(s, 0, lesser(room, batch_size(s)));
}
