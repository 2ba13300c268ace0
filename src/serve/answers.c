#include "serve/answers.h"

#include "base/json.h"
#include "base/hypervolume.h"
#include "report/report_json.h"
#include "settings/settings.h"

json_t *answer_status(const View *view, const char *name)
{
    json_t *o = json_of("name=%s", name);
    if (view->snapshot) {
        const Run *run = &view->snapshot->run;
        const Standing *s = &view->snapshot->standing;
        const RunGeneration *last = run->n_generations > 0 ? &run->generation[run->n_generations - 1] : NULL;
        json_put(o,
                 "state=%s simulated=%ld max_evals=%ld failed=%ld front=%ld generation=%ld finished=%s "
                 "hypervolume=%g per_second=%g seconds=%g left_s=%g",
                 state_words(s->state), s->progress.simulated, s->max_evals, s->n_failed, run->n_front,
                 last ? last->number : -1, last ? last->finished : "", s->hypervolume, progress_rate(&s->progress),
                 s->seconds, s->left_s);
    }
    if (view->why.code != STATUS_OK)
        json_put(o, "state=%s reason=%s", "unreadable", view->why.text);
    return o;
}

static json_t *json_of_front(const Run *run)
{
    json_t *list = json_array();
    for (size_t i = 0; i < run->n_front; i++)
        json_array_append_new(list, json_numbers(run->schema.n_obj, run_f(run, run->front[i])));
    return list;
}

json_t *answer_front(const Snapshot *snapshot)
{
    const Run *run = &snapshot->run;
    json_t *ids = json_array(), *answer = growth_json(run);
    for (size_t i = 0; i < run->n_front; i++)
        json_array_append_new(ids, json_integer(run->table.row[run->front[i]].id));
    const long generation = run->n_generations > 0 ? run->generation[run->n_generations - 1].number : -1;
    json_put(answer, "generation=%ld knee=%p ids=%p f=%p", generation,
             run->n_front > 0 ? json_integer(run->table.row[run_knee(run)].id) : json_null(), ids, json_of_front(run));
    return answer;
}

/* -- some runs ----------------------------------------------------------------------------------------------------- */

/* Volume of the box after every generation: designs join when they come onto the front. */
static Status growth_in(const Run *run, const double lower[], const double reference[], json_t *out, Err *err)
{
    const size_t n = run->n_generations > 0 ? run->generation[run->n_generations - 1].number + 1 : 0;
    const size_t none = run->table.n;
    json_t *simulated = json_array(), *volume = json_array();
    double f[OBJECTIVES_MAX];
    Hypervolume *h;
    TRY(hypervolume_create(&h, run->schema.n_obj, lower, reference, 1, err));

    /* Rows by the generation in which they came onto the front: the first of each number (n), and the one after each
     * row. */
    size_t *first = malloc((n + none) * sizeof *first);
    for (size_t g = 0; first && g < n; g++)
        first[g] = none;
    for (size_t i = none; first && i-- > 0;) {
        const long at = run->place[i].ok ? run->place[i].entered : NEVER;
        if (at >= 0 && (size_t)at < n) {
            first[n + i] = first[at];
            first[at] = i;
        }
    }
    for (size_t g = 0; g < run->n_generations && first; g++) {
        for (size_t i = first[run->generation[g].number]; i < none; i = first[n + i]) {
            run_minimise(run, i, f);
            hypervolume_add(h, f);
        }
        json_array_append_new(simulated, json_integer(run->generation[g].simulated));
        json_array_append_new(volume, json_number(hypervolume_share(h)));
    }
    hypervolume_free(h);
    json_put(out, "simulated=%p volume=%p", simulated, volume);
    if (!first)
        return fail_memory(err, n, "generations");
    free(first);
    return STATUS_OK;
}

/* Of a search the problem makes the front: what else differs, such as its length, changes only how much is known. */
static void name_difference(const char *key, unsigned, const char *, const char *, void *user)
{
    if (strncmp(key, "search.", 7) != 0 && strncmp(key, "run.", 4) != 0)
        json_object_set_new(user, key, json_true());
}

Status answer_against(size_t n, const Snapshot *const snapshot[], const char *const name[], json_t **out, Err *err)
{
    double lower[OBJECTIVES_MAX], reference[OBJECTIVES_MAX], f[OBJECTIVES_MAX];
    const Schema *a = &snapshot[0]->run.schema;
    for (size_t r = 0; r < n; r++) {
        const Schema *b = &snapshot[r]->run.schema;
        if (snapshot[r]->run.n_front == 0)
            return fail(err, STATUS_MISSING, "%s: has no front yet", snapshot[r]->run.folder);
        int same = a->n_obj == b->n_obj;
        for (size_t k = 0; same && k < a->n_obj; k++)
            same = strcmp(schema_objective(a, k)->name, schema_objective(b, k)->name) == 0 &&
                   schema_objective(a, k)->sense == schema_objective(b, k)->sense;
        if (!same)
            return bad_data(err, "%s: has other objectives: its front cannot be compared", snapshot[r]->run.folder);
    }

    /* A box of all fronts: from a fifth of their range below the best to the worst. */
    for (size_t k = 0; k < a->n_obj; k++) {
        lower[k] = INFINITY;
        reference[k] = -INFINITY;
    }
    for (size_t r = 0; r < n; r++)
        for (size_t i = 0; i < snapshot[r]->run.n_front; i++) {
            run_minimise(&snapshot[r]->run, snapshot[r]->run.front[i], f);
            for (size_t k = 0; k < a->n_obj; k++) {
                lower[k] = fmin(lower[k], f[k]);
                reference[k] = fmax(reference[k], f[k]);
            }
        }
    hypervolume_box(a->n_obj, lower, reference);
    json_t *runs = json_array(), *differences = json_object(), *keys = json_array();
    Status status = STATUS_OK;
    for (size_t r = 0; r < n && status == STATUS_OK; r++) {
        json_t *one = json_of("name=%s f=%p", name[r], json_of_front(&snapshot[r]->run));
        status = growth_in(&snapshot[r]->run, lower, reference, one, err);
        json_array_append_new(runs, one);
        settings_compare(snapshot[0]->run.settings, snapshot[r]->run.settings, name_difference, differences);
    }
    for (void *at = json_object_iter(differences); at; at = json_object_iter_next(differences, at))
        json_array_append_new(keys, json_string(json_object_iter_key(at)));
    json_decref(differences);
    *out = json_of("runs=%p differences=%p", runs, keys);
    if (status != STATUS_OK)
        json_decref(*out);
    return status;
}
