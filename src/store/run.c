#include "store/run.h"

#include <float.h>

#include "base/text.h"
#include "evaluate/problem.h"
#include "evaluate/race.h"
#include "evaluate/scenario.h"
#include "moga/nd_tree.h"
#include "motion/suite.h"
#include "settings/settings.h"
#include "settings/options.h"
#include "store/folder.h"

void run_free(Run *run)
{
    schema_free(&run->schema);
    free(run->provenance);
    free(run->settings);
    if (run->F != run->table.f)
        free(run->F);
    evaluation_table_free(&run->table);
    evaluation_table_free(&run->finer);
    free(run->place);
    free(run->front);
    free(run->generation);
    free(run->session);
    free(run->state);
    free(run->mark);
    memset(run, 0, sizeof *run);
}

/* -- rows ---------------------------------------------------------------------------------------------------------- */

const double *run_x(const Run *run, size_t row)
{
    return run->table.x + row * run->schema.n_var;
}

const double *run_f(const Run *run, size_t row)
{
    return run->F + row * run->schema.n_obj;
}

double run_result(const Run *run, size_t row, size_t k)
{
    const size_t n_obj = run->schema.n_obj;
    return k < n_obj ? run_f(run, row)[k] : run->table.row[row].extra[k - n_obj];
}

int run_likely(const Run *run, size_t row, double error[])
{
    const double *err = run->table.row[row].err;
    for (size_t k = 0; k < run->schema.n_obj; k++)
        error[k] = err ? err[k] : NAN;
    return err != NULL;
}

int run_is_unpredictable(const Run *run, size_t row)
{
    for (size_t i = 0; i < run->finer.n; i++)
        if (run->finer.row[i].id == run->table.row[row].id)
            return run->finer.row[i].reason[0] != 0;
    return 0;
}

void run_steps(const Run *run, size_t row, SimOptions *sim)
{
    const SimOptions *set = &run->settings->sim;
    if (sim->accuracy != set->accuracy || sim->tolerance != set->tolerance)
        return;
    sim->steps_per_contact = 0; /* asked twice they are the same */
    for (long i = 0; i < run->table.row[row].level; i++)
        estimate_options(sim, sim);
}

size_t run_find(const Run *run, long id)
{
    size_t row = 0;
    while (row < run->table.n && run->table.row[row].id != id)
        row++;
    return row;
}

size_t run_first_polished(const Run *run)
{
    size_t n = run->table.n;
    while (n > 0 && kind_is_outside(run->table.row[n - 1].kind))
        n--;
    return n;
}

static double minimised(const Run *run, size_t row, size_t k)
{
    return schema_objective(&run->schema, k)->sense * run_f(run, row)[k];
}

/* -- which designs are on the front -------------------------------------------------------------------------------- */

void run_minimise(const Run *run, size_t row, double f[])
{
    for (size_t k = 0; k < run->schema.n_obj; k++)
        f[k] = minimised(run, row, k);
}

static int run_has_polished(const Run *run)
{
    return run_first_polished(run) < run->table.n;
}

static void list_front(Run *run)
{
    run->n_front = 0;
    for (size_t i = 0; i < run->table.n; i++)
        if (run->place[i].on_front)
            run->front[run->n_front++] = i;
}

Status run_form_front(Run *run, Err *err)
{
    const size_t m = run->schema.n_obj;
    NdTree *tree = NULL;
    NdChange change;
    double *F = calloc(run->table.n * m + 1, sizeof *F);
    free(run->front);
    run->front = calloc(run->table.n + 1, sizeof *run->front);
    Status status = F && run->front ? nd_tree_create(&tree, m, err) : fail_memory(err, run->table.n + 1, "designs");
    for (size_t i = 0; status == STATUS_OK && i < run->table.n; i++) {
        RunPlace *p = &run->place[i];
        p->on_front &= p->ok && !(run->table.row[i].violation > 0.0);
        if (!p->on_front)
            continue;
        run_minimise(run, i, F + i * m);
        status = nd_tree_insert(tree, F, i, &change, err);
        p->on_front = change.is_in;
        for (size_t k = 0; status == STATUS_OK && k < change.n_removed; k++)
            run->place[change.removed[k]].on_front = 0;
    }
    nd_tree_free(tree);
    free(F);
    if (status == STATUS_OK)
        list_front(run);
    return status;
}

/* Candidates are the front of the search, or all that were ever on it where designs have other values than the search
 * knew, and the polished designs, which it was found without. */
Status run_settle_front(Run *run, Err *err)
{
    const int has_finer = run->finer.n > 0;
    if (has_finer || run_has_polished(run)) {
        for (size_t i = 0; i < run->table.n; i++)
            run->place[i].on_front |=
                kind_is_outside(run->table.row[i].kind) || (has_finer && run->place[i].entered != NEVER);
        return run_form_front(run, err);
    }
    TRY_ROOM(run->front, run->table.n + 1, "designs", err);
    list_front(run);
    return STATUS_OK;
}

size_t run_evaluations(const Run *run, size_t first)
{
    /* As in the search; the first replicate of all records is one here. */
    const Settings *s = run->settings;
    const int by_record = s->search.fidelity == FIDELITY_RECORDS;
    const size_t n = by_record ? suite_count(&s->motion) : 1, cheap = by_record ? race_first(n) : 1;
    const size_t whole = n * (size_t)s->sim.replicates;
    size_t sum = 0;
    for (size_t i = first; i < run->table.n; i++) {
        const double *sd = run->table.row[i].sd; /* NULL: of one simulation of every record; the cheap level has none */
        EvaluationKind kind = run->table.row[i].kind;
        if (kind == KIND_UNFINISHED && settings_screens(s))
            kind = sd && isfinite(sd[0]) ? KIND_FINISHED : KIND_SCREENED;
        sum += kind == KIND_SCREENED   ? cheap
               : kind == KIND_FINISHED ? whole - cheap
               : kind_is_outside(kind) ? 0
                                       : whole;
    }
    return sum / whole;
}

void run_drop_polished(Run *run)
{
    while (run_has_polished(run))
        run->n_failed -= !run->place[--run->table.n].ok;
    for (size_t i = 0; i < run->table.n; i++)
        run->place[i].on_front = run->place[i].ok && run->place[i].entered != NEVER && run->place[i].left == NEVER;
    list_front(run);
}

/* -- designs that stand out ---------------------------------------------------------------------------------------- */

size_t run_best(const Run *run, size_t objective)
{
    size_t best = *run->front;
    for (size_t i = 1; i < run->n_front; i++)
        if (minimised(run, run->front[i], objective) < minimised(run, best, objective))
            best = run->front[i];
    return best;
}

FrontBox run_box(const Run *run)
{
    FrontBox box;
    for (size_t k = 0; k < run->schema.n_obj; k++) {
        double worst = -INFINITY;
        box.ideal[k] = minimised(run, run_best(run, k), k);
        for (size_t i = 0; i < run->n_front; i++)
            worst = fmax(worst, minimised(run, run->front[i], k));
        box.span[k] = worst > box.ideal[k] ? worst - box.ideal[k] : 1.0;
    }
    return box;
}

double run_scaled(const Run *run, const FrontBox *box, size_t row, size_t objective)
{
    return (minimised(run, row, objective) - box->ideal[objective]) / box->span[objective];
}

double run_distance2(const Run *run, const FrontBox *box, size_t row, size_t other)
{
    double sum = 0.0;
    for (size_t k = 0; k < run->schema.n_obj; k++) {
        const double d = run_scaled(run, box, row, k) - (other < run->table.n ? run_scaled(run, box, other, k) : 0.0);
        sum += d * d;
    }
    return sum;
}

size_t run_knee(const Run *run)
{
    size_t knee[1] = {*run->front};
    run_spread_out(run, 1, 1, knee);
    return *knee;
}

size_t run_spread_out(const Run *run, size_t n, int with_polished, size_t rows[])
{
    size_t chosen = 0;
    if (run->n_front == 0)
        return 0;
    const FrontBox box = run_box(run);
    for (; chosen < n; chosen++) {
        size_t found = run->table.n;
        double most = chosen == 0 ? -INFINITY : 0.0;
        for (size_t i = 0; i < run->n_front; i++) {
            const size_t row = run->front[i];
            if (!with_polished && kind_is_outside(run->table.row[row].kind))
                continue;

            /* The square of the scaled distance to the nearest of those chosen; of the first to the ideal point. */
            double merit = chosen == 0 ? -run_distance2(run, &box, row, run->table.n) : DBL_MAX;
            for (size_t c = 0; c < chosen; c++)
                merit = fmin(merit, run_distance2(run, &box, row, rows[c]));
            if (merit > most) {
                most = merit;
                found = row;
            }
        }
        if (found == run->table.n)
            break;
        rows[chosen] = found;
    }
    return chosen;
}

size_t run_nearest(const Run *run, size_t rows[NEAREST_MAX])
{
    size_t n = 0;
    for (size_t i = 0; i < run->table.n; i++) {
        size_t at = n;
        if (!run->place[i].ok || run->table.row[i].kind == KIND_SCREENED)
            continue;
        while (at > 0 && run->table.row[i].violation < run->table.row[rows[at - 1]].violation)
            at--;
        if (at == NEAREST_MAX)
            continue;
        n += n < NEAREST_MAX;
        memmove(rows + at + 1, rows + at, (n - 1 - at) * sizeof *rows);
        rows[at] = i;
    }
    return n;
}

/* -- a design by its name ------------------------------------------------------------------------------------------ */

/* Row of the design that this one was made of, or run->table.n. */
static size_t made_of(const Run *run, size_t row)
{
    const char *reason = run->table.row[row].reason;
    const size_t n = sizeof SIMPLIFIED_FROM - 1;
    return strncmp(reason, SIMPLIFIED_FROM, n) == 0 ? run_find(run, strtol(reason + n, NULL, 10)) : run->table.n;
}

int run_simplified(const Run *run, size_t row, size_t pair[2])
{
    const size_t n = run->table.n;
    pair[0] = made_of(run, row);
    pair[1] = row;
    for (size_t i = run_first_polished(run); pair[0] == n && i < n; i++)
        if (made_of(run, i) == row)
            pair[1] = i;
    if (pair[0] == n && pair[1] != row)
        pair[0] = row;
    return pair[0] < n;
}

int run_has_limits(const Run *run)
{
    return strcmp(run->settings->search.limits, "none") != 0 || run->settings->problem.constraints > 0;
}

Status run_why_empty(const Run *run, Err *err)
{
    char nearest[PATH_MAX], limits[160], quoted[4 * PATH_MAX + 3];
    const size_t n_ok = run->table.n - run->n_failed;
    const Settings *s = run->settings;
    const int has_nearest = folder_has(run->folder, "nearest.csv");
    Err why;
    folder_path(run->folder, "nearest.csv", nearest);
    if (evaluation_table_check(&run->table, &why) != STATUS_OK)
        return fail(err, STATUS_INTERNAL, "%s: %s; `imtet export %s --all --csv FILE` has all", run->folder, why.text,
                    text_shell(run->folder, quoted));
    if (run->n_finished == 0)
        return bad_data(err, "%s: there is no front before the initial sample is complete; %zu designs are simulated",
                        run->folder, run->table.n);
    const int has_list = strcmp(s->search.limits, "none") != 0, has_g = s->problem.constraints > 0;
    snprintf(limits, sizeof limits, "%.120s%s%s", has_list ? s->search.limits : "", has_list && has_g ? "," : "",
             has_g ? "g<=0" : "");
    if (run_has_limits(run))
        return fail(err, STATUS_UNMET, "%s: search.limits: none of %zu designs keeps %s%s%s", run->folder, n_ok, limits,
                    has_nearest ? "; those that come nearest: " : "", has_nearest ? nearest : "");
    return fail(err, STATUS_INTERNAL,
                "%s: every design failed at least once; `imtet export %s --all --csv FILE` says why", run->folder,
                text_shell(run->folder, quoted));
}

Status run_pick(const Run *run, const char *word, size_t *row, Err *err)
{
    static const char BEST[] = "best_";
    const int is_best = strncmp(word, BEST, sizeof BEST - 1) == 0;
    char *end;
    size_t k = 0;
    const long id = strtol(word, &end, 10);
    if (end != word && !*end) {
        *row = run_find(run, id);
        if (*row < run->table.n)
            return STATUS_OK;
        if (run->table.n == 0)
            return run_why_empty(run, err);
        long nearest = run->table.row[0].id;
        for (size_t i = 1; i < run->table.n; i++)
            if (labs(run->table.row[i].id - id) < labs(nearest - id))
                nearest = run->table.row[i].id;
        return bad_data(err, "%s: has no design %ld; the nearest id is %ld", run->folder, id, nearest);
    }
    if (!is_best && strcmp(word, "knee") != 0)
        return bad_data(err,
                        "%.40s: neither an id of a design of %s nor a word for one; did you mean knee, or best_%s?",
                        word, run->folder, schema_objective(&run->schema, 0)->name);
    if (is_best)
        TRY(schema_pick(&run->schema, run->schema.n_obj, "best_NAME", word + sizeof BEST - 1, &k, err));
    if (run->n_front == 0)
        return run_why_empty(run, err);
    *row = is_best ? run_best(run, k) : run_knee(run);
    return STATUS_OK;
}
