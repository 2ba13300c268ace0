#include "report/verdict.h"

#include <stdarg.h>

#include "base/figure.h"
#include "base/json.h"
#include "base/stat.h"
#include "base/text.h"
#include "base/units.h"
#include "motion/suite.h"
#include "settings/settings.h"
#include "store/folder.h"
#include "store/output.h"

static const double S235_PA = 235e6, OFF_DRAWING = 0.1; /* [-] of J1, from where on a search has to see it */

typedef struct {
    const Evaluations *e;
    const VerdictOf *of;
    const double *x;
    FILE *out;                   /* a line for every sentence */
    size_t first;                /* record that was read */
    double own[LADDER_MEASURES]; /* under it */
    size_t n_links;              /* records under which links are better in J1, and in J3 */
    double off;                  /* [-] mean of J1 as built over that of the drawing, less 1 */
    Settings next;               /* what a search should have */
    int has_next;                /* other than the settings at hand */
} Verdict;

int verdict_compare(double sense, double value, double error, double other)
{
    static const double SHARE = 1e-3;
    const double gain = sense * (other - value), least = fmax(SHARE * fabs(other), error);
    return gain > least ? 1 : gain < -least ? -1 : 0;
}

/* "J1 0.0581 m, drift 0.53 %, J3 1.9 g"; sd NULL: not known. */
static void say_values(const Verdict *v, const double value[], const double sd[])
{
    static const char *const FORMATS[LADDER_MEASURES] = {"J1 %s m", ", drift %s %%", ", J3 %s g"};
    char text[FIGURE_MAX];
    for (int k = 0; k < LADDER_MEASURES; k++) {
        const double factor = measure(LADDER_MEASURE[k])->words.factor;
        figure_text(factor * value[k], NAN, sd ? factor * sd[k] : NAN, "", text);
        text[strlen(text) - (text[strlen(text) - 1] == ' ')] = 0;
        fprintf(v->out, FORMATS[k], text);
    }
}

/* What failed is infinite. Of one record "1 of 1" says no more than the factor. */
static void say_others(Verdict *v)
{
    static const SceneKind OTHERS[] = {SCENE_NO_CORE, SCENE_RIGID, SCENE_LINKS};
    static const char *const HEADS[LADDER_MEASURES] = {" J1", ", drift", ", J3"};
    const Evaluations *e = v->e;
    for (size_t o = 0; o < N_OF(OTHERS) && evaluated_has(e, &e->run[v->first], OTHERS[o]); o++) {
        fprintf(v->out, "%s %s", o ? "; against" : "Against", SCENES[OTHERS[o]].words);
        for (int k = 0; k < LADDER_MEASURES; k++) {
            double ratio[TOWER_RECORDS_MAX];
            size_t n = 0, better = 0;
            for (size_t i = 0; i < e->n_records && n < TOWER_RECORDS_MAX; i++) {
                const double own = ida_value(&e->run[i], SCENE_IMPACT, LADDER_MEASURE[k]);
                const double other = ida_value(&e->run[i], OTHERS[o], LADDER_MEASURE[k]);
                if (e->record[i].readable != STATUS_OK)
                    continue;
                ratio[n++] = own / other;
                better += verdict_compare(1, own, 0, other) > 0;
                v->n_links += k != 1 && OTHERS[o] == SCENE_LINKS && verdict_compare(1, other, 0, own) > 0;
            }
            sort_values(n, ratio);
            fprintf(v->out, "%s \u00d7 %.3g", HEADS[k], 0.5 * (ratio[(n - 1) / 2] + ratio[n / 2]));
            if (n > 1)
                fprintf(v->out, " (%s%zu of %zu)", o + k ? "" : "better under ", better, n);
        }
    }
    fputs(".\n", v->out);
}

__attribute__((format(printf, 4, 5))) static Status put_next(Verdict *v, Err *err, const char *key, const char *format,
                                                             ...)
{
    char value[2 * OPTION_TEXT_MAX];
    va_list list;
    va_start(list, format);
    vsnprintf(value, sizeof value, format, list);
    va_end(list);
    v->has_next = 1;
    return settings_put(&v->next, key, value, err);
}

/* s: under the first record alone. */
static Status say_model(Verdict *v, const Settings *s, Err *err)
{
    static const char *const WHO[] = {"the design", "the core rigidly connected", "the building alone", "all together"};
    size_t n_said = 0;
    Ladder *found = NULL;
    const Ladder *l = v->of->ladder;
    Status status = STATUS_OK;
    if (!l) {
        TRY_ROOM(found, 1, "a ladder", err);
        status = ladder_find(s, v->x, LADDER_BRIEF, found, err);
        l = found;
    }

    /* Effects that some scene needs and the model leaves out, by the first scene that needs them. */
    for (size_t who = 0; who < N_OF(WHO) && status == STATUS_OK; who++)
        for (size_t i = 0, n = 0; i < l->n; i++) {
            const LadderEffect *e = &l->effect[i];
            size_t scene = 0;
            while (scene < LADDER_SCENES && !(ladder_in_tolerances(l, e->change[scene], (int)scene) > 1))
                scene++;
            if (!e->is_kept || e->is_set || scene != who)
                continue;
            if (n++ == 0)
                fprintf(v->out, "%s %s: ", n_said++ ? "; by" : "The model leaves out what is needed by", WHO[who]);
            fprintf(v->out, "%s%s", n > 1 ? ", " : "", e->words);
        }
    for (size_t i = 0; i < l->n; i++) /* in the order of the effects: a mat that lifts is behind its ground */
        if (l->effect[i].is_kept && !l->effect[i].is_set)
            THEN(status, put_next(v, err, l->effect[i].key, "%s", l->effect[i].with));
    fputs(v->has_next ? ". With these effects it has " : "The model has every effect that the scenes need: ", v->out);
    if (v->has_next) {
        say_values(v, l->set[0], NULL);
        fputs(" instead of ", v->out);
    }
    say_values(v, v->own, NULL);
    fprintf(v->out, " under %s.\n", evaluated_name(&v->e->record[v->first]));
    free(found);
    return status;
}

static Status say_as_built(Verdict *v, Settings *s, Err *err)
{
    Problem p;
    SimResult shown;
    ReplicateSummary sum;
    double mean[LADDER_MEASURES], sd[LADDER_MEASURES];
    s->sim.replicates = VERDICT_REPLICATES;
    s->sim.gap_tolerance_m = s->sim.gap_tolerance_m > 0 ? s->sim.gap_tolerance_m : VERDICT_GAP_M;
    TRY(tower_open(&p, s, TOWER_AS_SET, VERDICT_REPLICATES, err));
    const Status status = tower_replicate(&p, 1, v->x, &shown, &sum, err);
    problem_close(&p);
    TRY(status);
    for (int k = 0; k < LADDER_MEASURES; k++) {
        mean[k] = sum.mean[LADDER_MEASURE[k]];
        sd[k] = sum.sd[LADDER_MEASURE[k]];
    }
    v->off = mean[0] / v->own[0] - 1;
    fprintf(v->out, "As built, with gaps %g mm off (mean ± standard deviation of %d, %zu failed): ",
            1e3 * s->sim.gap_tolerance_m, VERDICT_REPLICATES, sum.n_failed);
    say_values(v, mean, sd);
    fprintf(v->out, "; J1 is on average %+.0f %% off the drawing.\n", round(100 * v->off) + 0.0); /* no -0 */
    return STATUS_OK;
}

/* A search in which this does not break: demand `factor` times the limit. */
static Status plan_remedy(Verdict *v, MeasureId id, double limit, double factor, Err *err)
{
    static const double STIFFENERS = 0.25, CLAMPED = 1.5; /* [-] G b / 2 over G b / 3, where the mat begins to lift */
    const char *name = measure(id)->name, *now = v->next.search.limits, *variables = v->next.design.variables;
    const CoreOptions *core = &v->next.core;
    char ground[OPTION_TEXT_MAX], anchored[OPTION_TEXT_MAX];
    if (id == MEASURE_UPLIFT || id == MEASURE_CORE_OVERTURNING) {
        snprintf(ground, sizeof ground, "soil=C radius=%g", core->width_m);
        ladder_anchors(strcmp(core->foundation, "fixed") ? core->foundation : ground,
                       ceil(factor * (id == MEASURE_UPLIFT ? limit : CLAMPED)), anchored);
        TRY(put_next(v, err, "core.foundation", "%s", anchored));
        return strstr(variables, "anchors") ? STATUS_OK
                                            : put_next(v, err, "design.variables", "%s, anchors", variables);
    }
    if (id == MEASURE_CORE_BUCKLING && core->stiffeners == 0)
        TRY(put_next(v, err, "core.stiffeners", "%g", STIFFENERS));
    for (const char *at = now; (at = strstr(at, name)); at++) /* not as a part of another name, nor in a chance */
        if ((at == now || strchr(", ", at[-1])) && strchr("<> =", at[strlen(name)]))
            return STATUS_OK;
    return put_next(v, err, "search.limits", "%s%s%s<=%g", strcmp(now, "none") ? now : "",
                    strcmp(now, "none") ? ", " : "", name, limit);
}

static Status say_limits(Verdict *v, const Settings *s, Err *err)
{
    enum { EXTENSIVE = 2 }; /* DamagePart.median */
    const struct DamagePart *part = DAMAGE_PARTS;
    const int is_clamped = strcmp(s->core.foundation, "fixed") == 0;
    Foundation f = {0};
    foundation_parse(s->core.foundation, 1, &f, NULL); /* of settings that were checked */
    const double held_nm = v->e->run[v->first].result->mcore_kg * GRAVITY * s->core.width_m / 2;
    struct {
        const char *what;
        MeasureId id;
        double limit, factor;
    } all[] = {{"stress of the core (S235)", MEASURE_CORE_STRESS, S235_PA, 0},
               {"buckling of the bare wall", MEASURE_CORE_BUCKLING, 1, 0},
               {"uplift of the core", MEASURE_UPLIFT, fmax(f.anchors, 1), 0},
               {"overturning of the clamped core over what its weight holds", MEASURE_CORE_OVERTURNING,
                is_clamped ? held_nm : INFINITY, 0},
               {"indentation (contact law)", MEASURE_INDENTATION, INDENTATION_RATIO_MAX, 0},
               {part[0].words, MEASURE_DRIFT_RATIO, part[0].median[EXTENSIVE], 0},
               {part[1].words, MEASURE_DRIFT_RATIO, part[1].median[EXTENSIVE], 0},
               {part[2].words, MEASURE_J3, part[2].median[EXTENSIVE], 0}};
    fputs("Demand over limit, the gravest first (of the building: extensive damage)", v->out);
    for (size_t i = 0; i < N_OF(all); i++)
        for (size_t k = 0; k < v->e->n_records; k++)
            if (v->e->record[k].readable == STATUS_OK)
                all[i].factor = fmax(all[i].factor, measure_value(v->e->run[k].result, all[i].id) / all[i].limit);
    for (size_t i = 0; i < N_OF(all); i++) {
        size_t most = 0;
        for (size_t j = 1; j < N_OF(all); j++)
            most = all[j].factor > all[most].factor ? j : most;
        if (all[most].factor > 0)
            fprintf(v->out, "%s %s %.3g", i ? "," : ":", all[most].what, all[most].factor);
        if (all[most].factor > 1)
            TRY(plan_remedy(v, all[most].id, all[most].limit, all[most].factor, err));
        all[most].factor = 0;
    }
    fputs(".\n", v->out);
    return STATUS_OK;
}

static void put_set(const char *key, unsigned flags, const char *was, const char *is, void *out)
{
    (void)flags;
    (void)was;
    text_set(out, "%s=%s", key, is);
}

Status verdict_find(const Settings *given, const Evaluations *e, const double x[], const VerdictOf *of, char **out,
                    Err *err)
{
    Verdict v = {.e = e, .of = of, .x = x, .next = *given};
    Settings s = *given;
    size_t length;
    *out = NULL;
    if (s.sim.engine != ENGINE_FAST)
        return bad_data(err, "sim.engine: a verdict takes the engine fast");
    while (v.first < e->n_records && e->record[v.first].readable != STATUS_OK)
        v.first++;
    if (v.first == e->n_records)
        return bad_data(err, "no verdict: %s", e->record[0].why.text);
    TRY(option_put_path(s.motion.record, e->record[v.first].path, err));
    TRY(settings_put(&s, "motion.records", "none", err));
    for (int k = 0; k < LADDER_MEASURES; k++)
        v.own[k] = ida_value(&e->run[v.first], SCENE_IMPACT, LADDER_MEASURE[k]);
    v.out = text_open(out, &length);
    if (!v.out)
        return fail_memory(err, 1, "a verdict");
    say_others(&v);
    Status status = say_model(&v, &s, err);
    THEN(status, say_as_built(&v, &s, err));
    THEN(status, say_limits(&v, &s, err));

    /* What nothing before has asked for: gaps that are off, links; else the design is made easier to build. */
    if (!v.has_next && !(v.off <= OFF_DRAWING)) {
        THEN(status, put_next(&v, err, "sim.gap_tolerance_m", "%g", fmax(given->sim.gap_tolerance_m, VERDICT_GAP_M)));
        THEN(status, put_next(&v, err, "sim.replicates", "4"));
    }
    if (!v.has_next && v.n_links > e->n_read) {
        THEN(status, put_next(&v, err, "design.variables", "gaps, thickness, links"));
        THEN(status, put_next(&v, err, "design.devices", "gap, link, none"));
    }
    if (!v.has_next && of->design) {
        fprintf(v.out, "Next: imtet simplify %s --design %s --gap-step 5\n", of->operand, of->design);
    } else {
        fprintf(v.out, "Next: imtet optimize %s --new", of->operand);
        settings_compare(given, &v.next, put_set, v.out);
        fputc('\n', v.out);
    }
    if (text_close(v.out) != 0)
        THEN(status, fail_memory(err, 1, "a verdict"));
    if (status == STATUS_OK)
        return STATUS_OK;
    free(*out);
    *out = NULL;
    return status;
}

static Status add_own(const char *source, void *user, Err *err)
{
    return evaluations_add(user, source, 1, err);
}

Status verdict_of_run(const Run *run, size_t row, const Settings *used, const Ladder *ladder, char **out, Err *err)
{
    Settings s = *used;
    Evaluations e = {.n_levels = 1, .has_links = 1};
    Output o;
    char path[PATH_MAX], id[24], folder[4 * PATH_MAX + 3], *text;
    Status status = STATUS_OK;
    snprintf(id, sizeof id, "%ld", run->table.row[row].id);
    folder_path(run->folder, "verdicts.json", path);
    json_t *all = json_load_file(path, 0, NULL);
    const char *known = json_string_value(json_object_get(all, id));
    text = known ? strdup(known) : NULL;
    s.sim.forces = FORCES_YES;
    *out = NULL;
    if (!known) {
        all = all ? all : json_object();
        status = suite_of_study(&s.motion, add_own, &e, err);
        THEN(status, evaluations_read(&e, &s, err));
        THEN(status, evaluations_run(&e, run->schema.n_var, run_x(run, row), NULL, err));
        THEN(status, verdict_find(&s, &e, run_x(run, row), &(VerdictOf){"RUN", id, ladder}, &text, err));
        evaluations_free(&e);
        if (status == STATUS_OK)
            json_object_set_new(all, id, json_words(text));
        if (status == STATUS_OK && !run->id_step && output_open_inside(&o, path, &(Err){0}) == STATUS_OK) {
            json_dumpf(all, o.stream, JSON_INDENT(1) | JSON_SORT_KEYS);
            output_close(&o, &(Err){0});
        }
    }
    /* The folder may have moved since: it is named as it is now. */
    const char *at = text ? strstr(text, " RUN ") : NULL;
    if (at && asprintf(out, "%.*s %s%s", (int)(at - text), text, text_shell(run->folder, folder), at + 4) < 0)
        *out = NULL;
    free(text);
    json_decref(all);
    return status;
}
