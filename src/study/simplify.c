#include "study/simplify.h"

#include "settings/options.h"

/* Rounds of the descent on steps, at most. */
enum { ROUNDS = 50 };

/* -- variables and the devices that they stand for ----------------------------------------------------------------- */

static const DesignSpace *space_of(const Improver *m)
{
    return &m->run->schema.design;
}

/* The place of the word none of choice j; -1: it has none, or is no choice. */
static int none_of(const Improver *m, size_t j)
{
    int w = 0;
    for (const char *word; (word = design_word(space_of(m), (int)j, w)); w++)
        if (strcmp(word, "none") == 0)
            return w;
    return -1;
}

/* Variable j is a gap of the best design that is narrower than an open one. */
static int is_stop(const Improver *m, size_t j)
{
    return (int)j < space_of(m)->n_gaps && m->x[j] < DESIGN_OPEN_M;
}

/* Variable j without its device; NAN: it stands for none that may go. Devices are choices where the space has any,
 * whose last variable is one then. */
static double gone(const Improver *m, size_t j)
{
    const int none = none_of(m, j);
    if (none_of(m, m->problem->n_var - 1) < 0)
        return is_stop(m, j) ? DESIGN_OPEN_M : NAN;
    return none >= 0 && m->x[j] != none ? none : (double)NAN;
}

/* Variable k moves with variable j. */
static int moves_with(const Improver *m, size_t j, size_t k)
{
    return k == j || (m->config->zones > 0 && design_share_zone(space_of(m), (int)j, (int)k, m->config->zones));
}

/* The first variable of those that move together. */
static int leads(const Improver *m, size_t j)
{
    for (size_t k = 0; k < j; k++)
        if (moves_with(m, j, k))
            return 0;
    return 1;
}

/* -- designs of a round -------------------------------------------------------------------------------------------- */

/* The best design with variable j at `value`, with_zone: and what moves with it. It is repaired by the tower alone: the
 * steps of a search have no gap without a stop. */
static void add(Improver *m, size_t j, double value, int with_zone)
{
    const Problem *p = m->problem;
    double *x = m->X + m->n++ * p->n_var;
    memcpy(x, m->x, p->n_var * sizeof *x);
    for (size_t k = 0; k < p->n_var; k++)
        if (k == j || (with_zone && moves_with(m, j, k)))
            x[k] = value;
    p->repair(x, p->self);
}

/* The best design with all its numbers, as the next one of the path. */
static Status note(Improver *m, Simplification what, Err *err)
{
    Improved *out = m->out;
    double f[OBJECTIVES_MAX];
    if (what != SIMPLIFY_START)
        TRY(improver_note(m, 1, (const double *[]){m->x}, 0, err));
    TRY(improver_check(m, err));
    for (size_t k = 0; k < m->problem->n_obj; k++)
        f[k] = improver_path(m, what, k);
    for (size_t j = 0; j < m->problem->n_var; j++)
        out->n_left[what] += !isnan(gone(m, j));
    m->value = out->loss[what] = improver_loss(m, f, out->designs.row[what].violation);
    return STATUS_OK;
}

/* -- the path ------------------------------------------------------------------------------------------------------ */

/* Every stop alone is taken out; those without which the results are the same go together. What counts devices does not
 * tell; beside links a stop that never closes changes their steps, by next to nothing. */
static Status drop_idle(Improver *m, Err *err)
{
    static const double ALIKE = 1e-6;
    const size_t n_obj = m->problem->n_obj;
    m->n = 0;
    m->value = -INFINITY; /* all are looked at, none becomes the best */
    for (size_t j = 0; j < m->problem->n_var; j++)
        if (!isnan(gone(m, j)))
            add(m, j, gone(m, j), 0);
    TRY(improver_try(m, err));
    for (size_t j = 0, i = 0; j < m->problem->n_var; j++) {
        if (isnan(gone(m, j)))
            continue;
        int is_same = m->ok[i];
        for (size_t k = 0; k < n_obj; k++) {
            const int id = m->run->schema.order.of[k];
            is_same &= fabs(m->F[i * n_obj + k] - m->first[k]) <= ALIKE * fabs(m->first[k]) || id == MEASURE_DEVICES ||
                       id == MEASURE_COST;
        }
        if (is_same)
            m->x[j] = gone(m, j);
        i++;
    }
    return note(m, SIMPLIFY_CLOSING, err);
}

/* The mean of what moves with variable j, of gaps that are stops; of words the most frequent one, of equals the
 * first. */
static double middle_of(const Improver *m, size_t j)
{
    double sum = 0.0, word = m->x[j];
    size_t n = 0, most = 0;
    for (size_t k = 0; k < m->problem->n_var; k++) {
        size_t alike = 0;
        if (!moves_with(m, j, k) || ((int)k < space_of(m)->n_gaps && !is_stop(m, k)))
            continue;
        for (size_t i = 0; i < m->problem->n_var; i++)
            alike += moves_with(m, j, i) && m->x[i] == m->x[k];
        if (alike > most) {
            most = alike;
            word = m->x[k];
        }
        sum += m->x[k];
        n++;
    }
    return n == 0 || design_word(space_of(m), (int)j, 0) ? word : sum / (double)n;
}

static size_t nearest_plate(const ImproveConfig *c, double t)
{
    size_t best = 0;
    for (size_t i = 1; i < c->n_plates; i++)
        if (fabs(c->plate[i] - t) < fabs(c->plate[best] - t))
            best = i;
    return best;
}

/* An ImproveStep on the numbers that are sold: every neighbour of the best design. */
static Status move(Improver *m, double, Err *err)
{
    const ImproveConfig *c = m->config;
    m->n = 0;
    for (size_t j = 0; j < m->problem->n_var; j++) {
        if (!leads(m, j)) {
            continue;
        } else if (design_is_wall(space_of(m), (int)j) && c->n_plates > 0) {
            const size_t at = nearest_plate(c, m->x[j]);
            for (size_t next = at - 1; next != at + 3; next += 2) /* before the first one it is too large */
                if (next < c->n_plates)
                    add(m, j, c->plate[next], 1);
        } else if (is_stop(m, j) && c->gap_step > 0.0) {
            const double steps = round(m->x[j] / c->gap_step);
            add(m, j, (steps + 1.0) * c->gap_step, 1);
            if (steps > 1.0)
                add(m, j, (steps - 1.0) * c->gap_step, 1);
        }
    }
    return improver_try(m, err);
}

Status simplify_design(Improver *m, Err *err)
{
    const ImproveConfig *c = m->config;
    const size_t n_var = m->problem->n_var;
    SimOptions finer;
    m->violation = m->out->designs.row[SIMPLIFY_START].violation;
    TRY(note(m, SIMPLIFY_START, err));
    TRY(drop_idle(m, err));

    for (size_t j = 0; j < n_var && c->zones > 0; j++)
        if (leads(m, j)) {
            m->n = 0;
            add(m, j, middle_of(m, j), 1);
            memcpy(m->x, m->X, n_var * sizeof *m->x);
        }
    TRY(note(m, SIMPLIFY_ZONES, err));

    for (size_t j = 0; j < n_var; j++)
        if (design_is_wall(space_of(m), (int)j) && c->n_plates > 0)
            m->x[j] = c->plate[nearest_plate(c, m->x[j])];
        else if (is_stop(m, j) && c->gap_step > 0.0)
            m->x[j] = fmax(round(m->x[j] / c->gap_step), 1.0) * c->gap_step;
    TRY(note(m, SIMPLIFY_STEPS, err));

    /* Without a gain the same neighbours come again: one idle step ends it. */
    m->enough = 1.0;
    m->idle_max = 1;
    m->budget = ROUNDS * 2 * n_var;
    TRY(improver_descend(m, move, err));
    TRY(note(m, SIMPLIFY_MOVED, err));
    if (m->out->loss[SIMPLIFY_MOVED] <= 1.0) { /* device after device goes, the one that loses least, while it may */
        do {
            m->n = 0;
            m->value = nextafter(1.0, 2.0);
            for (size_t j = 0; j < n_var; j++)
                if (!isnan(gone(m, j)) && leads(m, j))
                    add(m, j, gone(m, j), 1);
            TRY(improver_try(m, err));
        } while (m->value <= 1.0);
        TRY(note(m, SIMPLIFY_FEWER, err));
    }
    return improver_finer(m->run->settings, &finer) ? improver_errors(m, SIMPLIFY_START, &finer, 0, err) : STATUS_OK;
}
