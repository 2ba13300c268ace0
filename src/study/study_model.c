#include "study/study_model.h"

#include "analysis/model_choice.h"
#include "base/json.h"
#include "settings/settings.h"

json_t *study_model_of(const Run *run)
{
    json_t *all = json_loads(run->provenance, 0, NULL);
    json_t *model = json_incref(json_object_get(all, "model"));
    json_decref(all);
    return model;
}

/* -- the choice ---------------------------------------------------------------------------------------------------- */

Status study_model(Settings *s, const Run *run, const Observer *stop, json_t **model, Err *err)
{
    ModelChoice *c;
    Status status = STATUS_OK;
    *model = NULL;
    if (s->sim.model != MODEL_AUTO || s->problem.kind != PROBLEM_TOWER)
        return STATUS_OK;
    if (run) { /* what it has chosen, where these settings leave it open */
        json_t *chosen = study_model_of(run), *value;
        const char *key;
        json_object_foreach(json_object_get(chosen, "settings"), key, value)
        {
            if (!settings_gives(s, key) && json_is_string(value))
                THEN(status, settings_put(s, key, json_string_value(value), err));
        }
        json_decref(chosen);
        return status;
    }
    TRY_ROOM(c, 1, "the choice of a model", err);
    status = model_choose(s, stop, c, err);
    if (status == STATUS_OK && c->n_simulations > 0)
        *model = json_put(ladder_json(&c->ladder), "designs=%zu records=%zu cases=%zu simulations=%zu speed_factor=%g",
                          c->n_designs, c->n_records, c->n_cases, c->n_simulations, c->ladder.all_s / c->ladder.set_s);
    free(c);
    return status;
}

/* -- at the end ---------------------------------------------------------------------------------------------------- */

/* The ladder of the choice, as far as it is asked again; words are those of `model`. */
static void read_ladder(const json_t *model, Ladder *l)
{
    size_t i;
    json_t *row;
    json_array_foreach(json_object_get(model, "effects"), i, row)
    {
        LadderEffect *e = &l->effect[l->n];
        const json_t *most = json_object_get(row, "in_tolerances");
        if (l->n == LADDER_MAX)
            break;
        *e = (LadderEffect){.words = json_text(row, "without"), .key = json_text(row, "setting")};
        text_copy(e->with, json_text(row, "with"));
        text_copy(e->without, json_text(row, "otherwise"));
        e->is_set = strcmp(json_text(row, "is_set"), "yes") == 0;
        e->is_kept = strcmp(json_text(row, "kept"), "yes") == 0;
        e->most = json_is_number(most) ? json_number_value(most) : INFINITY;
        l->n++;
    }
    for (int k = 0; k < LADDER_MEASURES; k++) {
        char name[40];
        snprintf(name, sizeof name, "%s_pct", measure(LADDER_MEASURE[k])->name);
        l->tolerance[k] = json_number_value(json_object_get(json_object_get(model, "tolerance"), name)) / 100;
    }
}

static Status confirm(const Run *run, json_t *model, const Observer *stop, Err *err)
{
    size_t rows[1 + OBJECTIVES_MAX], n_cases;
    const size_t n_var = run->schema.n_var;
    size_t n = 0; /* rows of knee and best designs, each once */
    Ladder before = {0}, now;
    ModelCase *cases;
    double *X;
    json_t *designs = json_array(), *more = json_object();
    for (size_t k = 0; k <= run->schema.n_obj; k++) {
        const size_t row = k == 0 ? run_knee(run) : run_best(run, k - 1);
        size_t i = 0;
        while (i < n && rows[i] != row)
            i++;
        rows[n] = row;
        n += i == n;
    }
    read_ladder(model, &before);
    now = before;
    TRY_ROOM(X, n * n_var + 1, "designs", err);
    for (size_t i = 0; i < n; i++)
        memcpy(X + i * n_var, run_x(run, rows[i]), n_var * sizeof *X);
    const Status status = model_confirm(run->settings, n, n_var, X, stop, &now, &cases, &n_cases, err);
    for (size_t i = 0; i < n_cases && status == STATUS_OK; i++) {
        const ModelCase *c = &cases[i];
        const size_t row = rows[(size_t)(c->x - X) / n_var];
        int is_enough = c->by_set.outcome == RUN_OK;
        json_t *set = json_object(), *with_more = json_object();
        for (int k = 0; k < LADDER_MEASURES; k++) {
            const char *name = measure(LADDER_MEASURE[k])->name;
            is_enough &= fabs(ladder_change(&c->by_set, &c->by_more, k)) <= now.tolerance[k];
            json_object_set_new(set, name, json_number(c->by_set.value[LADDER_MEASURE[k]]));
            json_object_set_new(with_more, name, json_number(c->by_more.value[LADDER_MEASURE[k]]));
        }
        json_array_append_new(designs, json_of("design=%ld record=%zu is_enough=%c by_the_set=%p with_more=%p",
                                               run->table.row[row].id, c->record + 1, is_enough, set, with_more));
    }
    for (size_t i = 0; i < now.n; i++)
        if (now.effect[i].is_kept && !before.effect[i].is_kept)
            json_object_set_new(more, now.effect[i].key, json_string(now.effect[i].with));
    json_put(model, "confirmed=%p", json_of("designs=%p more=%p", designs, more));
    free(cases);
    free(X);
    return status;
}

Status study_model_confirm(RunStore *store, const Observer *stop, Err *err)
{
    Run run;
    TRY(store_read(store, RUN_FRONT, &run, err));
    json_t *all = json_loads(run.provenance, 0, NULL), *model = json_object_get(all, "model");
    Status status = STATUS_OK;
    if (model && run.n_front > 0) {
        status = confirm(&run, model, stop, err);
        free(run.provenance);
        run.provenance = json_dumps(all, JSON_INDENT(2) | JSON_REAL_PRECISION(17));
        THEN(status, store_provenance(store, &run, err));
    }
    json_decref(all);
    run_free(&run);
    return status;
}
