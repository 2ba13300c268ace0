#include "moga/selection.h"

#include "base/carve.h"
#include "base/clones.h"
#include "base/dominance.h"
#include "moga/normalisation.h"

struct Selection {
    size_t n_max, n_obj, n_dir;
    double *across; /* (n_obj, n_dir) directions of length 1 */
    double *along;  /* (n_dir) of a design */
    Normalisation normalisation;
    size_t *rank;       /* (n_max) */
    size_t *scratch;    /* (3 n_max) */
    size_t *list;       /* (n_max) rows of one layer */
    size_t *niche;      /* (n_max) direction of each row */
    double *distance;   /* (n_max) from it */
    size_t *members;    /* (n_dir) taken so far */
    size_t *candidates; /* (n_dir) that are left in the layer which does not fit */
    size_t *ties;       /* (n_dir or n_max) */
    unsigned char *taken;
    const double *aspire; /* (n_obj) or NULL */
};

static void layout(void *selection, Carve *c)
{
    Selection *s = selection;
    const size_t n = s->n_max, m = s->n_obj, r = s->n_dir;
    CARVE(c, s->across, r * m);
    CARVE(c, s->along, r);
    CARVE(c, s->normalisation.ideal, m);
    CARVE(c, s->normalisation.width, m);
    CARVE(c, s->normalisation.plane, m * (m + 1));
    CARVE(c, s->normalisation.pivot, m);
    CARVE(c, s->rank, n);
    CARVE(c, s->scratch, 3 * n);
    CARVE(c, s->list, n);
    CARVE(c, s->niche, n);
    CARVE(c, s->distance, n);
    CARVE(c, s->members, r);
    CARVE(c, s->candidates, r);
    CARVE(c, s->ties, MAX_OF(n, r));
    CARVE(c, s->taken, n);
}

Status selection_create(Selection **out, size_t n_max, const Directions *directions, const double aspire[], Err *err)
{
    const size_t n_obj = directions->n_obj;
    Selection plain = {n_max, n_obj, directions->n, .normalisation.n_obj = n_obj, .aspire = aspire};
    Selection *s = *out = carve_object(layout, &plain, sizeof plain);
    if (!s)
        return fail_memory(err, n_max, "designs to select from");
    directions_across(directions, s->across);
    return STATUS_OK;
}

/* Nearest direction and the distance of the normalised objectives from its line. */
CLONED_V3 static void associate(Selection *s, size_t i, const double f[])
{
    double square = 0.0, longest = -INFINITY;
    for (size_t r = 0; r < s->n_dir; r++)
        s->along[r] = 0.0;
    for (size_t k = 0; k < s->n_obj; k++) {
        const double z = normalised(&s->normalisation, k, f[k]), *w = s->across + k * s->n_dir;
        square += z * z;
#pragma omp simd
        for (size_t r = 0; r < s->n_dir; r++)
            s->along[r] += z * w[r];
    }
    for (size_t r = 0; r < s->n_dir; r++)
        if (s->along[r] > longest) {
            longest = s->along[r];
            s->niche[i] = r;
        }
    s->distance[i] = sqrt(fmax(square - longest * longest, 0.0));
}

static size_t rows_of_layer(Selection *s, size_t n, size_t layer)
{
    size_t count = 0;
    for (size_t i = 0; i < n; i++)
        if (s->rank[i] == layer)
            s->list[count++] = i;
    return count;
}

/* One of the directions that still have candidates and, among those, the fewest members, gets one more: a direction
 * without members the nearest candidate, else any of them. */
static void fill_niches(Selection *s, size_t n_list, size_t wanted, Random *random)
{
    memset(s->candidates, 0, s->n_dir * sizeof *s->candidates);
    for (size_t j = 0; j < n_list; j++)
        s->candidates[s->niche[s->list[j]]]++;
    while (wanted-- > 0) {
        size_t fewest = SIZE_MAX, nearest = SIZE_MAX, n_ties = 0;
        for (size_t r = 0; r < s->n_dir; r++)
            if (s->candidates[r] > 0 && s->members[r] < fewest)
                fewest = s->members[r];
        for (size_t r = 0; r < s->n_dir; r++)
            if (s->candidates[r] > 0 && s->members[r] == fewest)
                s->ties[n_ties++] = r;
        const size_t r = s->ties[random_below(random, n_ties)];
        n_ties = 0;
        for (size_t j = 0; j < n_list; j++) {
            const size_t i = s->list[j];
            if (s->taken[i] || s->niche[i] != r)
                continue;
            s->ties[n_ties++] = i;
            if (nearest == SIZE_MAX || s->distance[i] < s->distance[nearest])
                nearest = i;
        }
        s->taken[fewest == 0 ? nearest : s->ties[random_below(random, n_ties)]] = 1;
        s->members[r]++;
        s->candidates[r]--;
    }
}

/* Those that violate less, and of these those that are least behind the levels, of whichever is most behind. */
static void take_achieving(Selection *s, size_t n, const double F[], const double violation[], size_t keep)
{
    nondominated_sort(n, s->n_obj, F, violation, s->rank, s->scratch);
    normalisation_fit_range(&s->normalisation, rows_of_layer(s, n, 0), s->list, F);
    for (size_t i = 0; i < n; i++) {
        s->distance[i] = -INFINITY;
        for (size_t k = 0; k < s->n_obj; k++)
            s->distance[i] =
                fmax(s->distance[i], normalised_behind(&s->normalisation, k, s->aspire[k], F[i * s->n_obj + k]));
    }
    for (size_t taken = 0; taken < n && taken < keep; taken++) {
        size_t best = SIZE_MAX;
        for (size_t i = 0; i < n; i++) {
            const int comes_first =
                best == SIZE_MAX || (violation && violation[i] != violation[best] ? violation[i] < violation[best]
                                                                                  : s->distance[i] < s->distance[best]);
            if (comes_first && !s->taken[i])
                best = i;
        }
        s->taken[best] = 1;
    }
}

/* Takes whole layers, then fills the niches from the one that does not fit. */
static void take_layers(Selection *s, size_t n, const double F[], const double violation[], size_t keep, Random *random)
{
    const size_t n_layers = nondominated_sort(n, s->n_obj, F, violation, s->rank, s->scratch);
    size_t n_taken = 0, layer = 0, n_list = 0;
    memset(s->members, 0, s->n_dir * sizeof *s->members);
    if (n > 0)
        normalisation_fit(&s->normalisation, rows_of_layer(s, n, 0), s->list, F);
    for (size_t i = 0; i < n; i++)
        associate(s, i, F + i * s->n_obj);
    for (; layer < n_layers; layer++) {
        n_list = rows_of_layer(s, n, layer);
        if (n_taken + n_list > keep)
            break;
        for (size_t j = 0; j < n_list; j++) {
            s->taken[s->list[j]] = 1;
            s->members[s->niche[s->list[j]]]++;
        }
        n_taken += n_list;
    }
    if (layer < n_layers)
        fill_niches(s, n_list, keep - n_taken, random);
}

size_t selection_select(Selection *s, size_t n, const double F[], const double violation[], size_t keep, Random *random,
                        size_t selected[])
{
    size_t n_selected = 0;
    memset(s->taken, 0, n);
    if (s->aspire)
        take_achieving(s, n, F, violation, keep);
    else
        take_layers(s, n, F, violation, keep, random);
    for (size_t i = 0; i < n; i++)
        if (s->taken[i])
            selected[n_selected++] = i;
    return n_selected;
}
