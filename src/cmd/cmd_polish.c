
#include "cmd/commands.h"
#include "cmd/designs.h"
#include "cmd/improve.h"
#include "cmd/show.h"
#include "study/refine.h"

typedef struct {
    Improve from;
    const Run *run; /* of it */
    RefineConfig config;
    Refined result;
} Work;

/* Of a list of names all that stand in it, with their numbers; "all": every objective. */
static Status take_list(const Args *args, const char *option, const Schema *schema, double otherwise, double values[],
                        Err *err)
{
    const char *list = args_value(args, option);
    if (strcmp(list, "all") != 0)
        return pairs_take(schema, option, list, otherwise, values, err);
    for (size_t k = 0; k < schema->n_obj; k++)
        values[k] = otherwise;
    return STATUS_OK;
}

static Status take_goal(const Args *args, Work *w, Err *err)
{
    const Schema *schema = &w->run->schema;
    const char *kept = args_value(args, "--keep");
    w->config.weight[0] = args_has(args, "--improve") ? 0.0 : 1.0;
    for (size_t k = 0; k < schema->n_obj; k++)
        w->config.slack[k] = kept ? INFINITY : -1.0;
    if (args_has(args, "--improve"))
        TRY(take_list(args, "--improve", schema, 1.0, w->config.weight, err));
    if (kept)
        TRY(take_list(args, "--keep", schema, -1.0, w->config.slack, err));
    return weights_check(schema, "--improve", w->config.weight, err);
}

static Status take_options(const Args *args, Work *w, Err *err)
{
    long evals;
    TRY(refine_allows(w->run->settings, err));
    TRY(take_goal(args, w, err));
    TRY(args_whole(args, "--evals", 1, 1000000, 300, &evals, err));
    TRY(args_whole(args, "--replicates", 1, 1000, 4, &w->config.replicates, err));
    const size_t needed = refine_evals_min(w->run->settings, w->config.replicates);
    if ((size_t)evals < needed)
        return misused(
            err,
            "--evals %ld: the design at the start, one that is tried, and both designs at the end take %zu "
            "simulations (6 times --replicates of a tower: at the end also at twice the steps); give more, or "
            "fewer --replicates",
            evals, needed);
    w->config.max_evals = evals;
    return STATUS_OK;
}

static void put_objectives(json_t *row, const Schema *schema, const char *end, const double values[])
{
    char name[TABLE_NAME_MAX + 16];
    for (size_t k = 0; k < schema->n_obj; k++) {
        snprintf(name, sizeof name, "%s%s", schema_objective(schema, k)->name, end);
        json_object_set_new(row, name, json_number(values[k]));
    }
}

/* One row in natural signs: the polished design as in front.csv but for the id of the design that it came from; then of
 * every objective how it was before, and where they are known the standard deviations of both and the likely error. */
static json_t *table_of(const Work *w)
{
    const Schema *schema = &w->run->schema;
    const Refined *r = &w->result;
    const Evaluation *start = &r->designs.row[0], *end = &r->designs.row[1];
    const struct {
        const char *end;
        const double *values;
    } more[] = {{"_before", start->f}, {"_before_sd", start->sd}, {"_sd", end->sd}, {"_error", r->error}};
    json_t *table = json_array(), *row = figures_row(table);
    json_put(row, "polished_from=%ld", w->run->table.row[w->from.row].id);
    for (size_t j = 0; j < schema->n_var; j++)
        json_object_set_new(row, schema_variable(schema, j)->name, json_number(end->x[j]));
    put_objectives(row, schema, "", end->f);
    for (size_t i = 0; i < N_OF(more); i++)
        if (isfinite(more[i].values[0]))
            put_objectives(row, schema, more[i].end, more[i].values);
    return table;
}

static void show_gain(const Work *w, size_t k)
{
    const Column *c = schema_objective(&w->run->schema, k);
    const Evaluation *start = &w->result.designs.row[0], *end = &w->result.designs.row[1];
    const double gain = c->sense * (start->f[k] - end->f[k]);
    const double error = hypot(start->sd[k], end->sd[k]) / sqrt((double)w->config.replicates);
    printf("%s is %s by %.3g", c->name, gain < 0.0 ? "worse" : "better", fabs(gain));
    if (isfinite(error))
        printf(" with a standard error of %.2g", error);
    putchar('\n');
}

static const char *verdict_of(const Refined *r)
{
    return !r->has_changed        ? "No improvement was found that keeps the others."
           : !r->keeps            ? "Simulated again, what was to be kept is not."
           : isnan(r->gain_error) ? "One simulation each: nothing is known of the spread."
           : refined_counts(r)    ? "Simulated again on both designs this is more than the standard deviation."
           : r->gain > fmax(REFINE_GAIN_MIN, 2.0 * r->gain_error)
               ? "Simulated at twice the steps on both designs it is not."
           : r->gain <= REFINE_GAIN_MIN
               ? "Simulated again on both designs this is less than 0.1 % of the range of the front."
               : "Simulated again on both designs this is not more than the standard deviation.";
}

static void show_table(const Work *w)
{
    const Schema *schema = &w->run->schema;
    const Refined *r = &w->result;
    const Evaluation *start = &r->designs.row[0], *end = &r->designs.row[1];
    const SimOptions *s = &w->run->settings->sim;
    json_t *table = json_array();
    figures_design(table, "before", w->run->table.row[w->from.row].id, schema, start->f, r->error, start->sd,
                   start->extra);
    if (r->has_changed)
        figures_design(table, "polished", w->from.id, schema, end->f, r->error, end->sd, end->extra);
    figures_print(table);
    if (isfinite(start->sd[0]))
        printf("sd: %s\n", spread_word(s->gap_tolerance_m, &s->uncertain));
}

static void show(const Work *w)
{
    const Schema *schema = &w->run->schema;
    const Refined *r = &w->result;
    show_table(w);
    printf("\n%zu designs tried in %zu simulations, %zu failed, %.1f s\n", r->n_evaluated, r->n_simulated, r->n_failed,
           r->seconds);
    for (size_t k = 0; r->has_changed && k < schema->n_obj; k++)
        if (w->config.weight[k] > 0.0)
            show_gain(w, k);
    puts(verdict_of(r));
    improve_say(&w->from);
}

static Status polish(const Args *args, Work *w, Err *err)
{
    const char *word = args_value(args, "--design");
    if (!word)
        return misused(err, "--design ID is missing: an id of %s, knee or best_NAME", args->operand);
    TRY(improve_open(&w->from, args, word, err));
    w->run = &w->from.run;
    TRY(take_options(args, w, err));
    TRY(refine_design(w->run, w->from.row, &w->config, &w->result, err));
    if (refined_counts(&w->result))
        TRY(improve_store(&w->from, &w->result.designs.row[1], err));
    if (args_has(args, "--json"))
        return show_json(json_of("design=%ld verdict=%s tried=%zu simulated=%zu failed=%zu seconds=%g polished=%p",
                                 w->from.id, verdict_of(&w->result), w->result.n_evaluated, w->result.n_simulated,
                                 w->result.n_failed, w->result.seconds, table_of(w)),
                         err);
    show(w);
    return args_has(args, "--csv") ? figures_csv(table_of(w), args_value(args, "--csv"), err) : STATUS_OK;
}

static Status run(const Args *args, Err *err)
{
    Work w = {0};
    const Status status = polish(args, &w, err);
    refined_free(&w.result);
    improve_close(&w.from);
    return status;
}

static const ArgOption OPTIONS[] = {
    VALUE("--design", "ID", DESIGN_OF_RUN),
    VALUE("--improve", "NAME[=W],...", "objectives to improve, with weights in ranges of the front, or all; the first"),
    VALUE("--keep", "NAME[=S],...",
          "these may lose no more than their deviation, or the share S of their value; all if not given"),
    VALUE("--evals", "N", "simulate at most so often; 300 if not given"),
    VALUE("--replicates", "N", "simulations of a noisy design (the tower's), whose mean counts; 4"),
    VALUE("--csv", "FILE",
          "the polished design, its objectives and those before, their deviations and errors into FILE; -: standard "
          "output"),
    OPTION_JSON,
    OPTION_MOVED,
    OPTION_END,
};

const Command CMD_POLISH = {
    .name = "polish",
    .group = GROUP_STUDY,
    .operand = "RUN",
    .summary = "improve objectives of a design, the others kept",
    .example = "imtet polish results/quick --design knee --improve j2_m",
    .details =
        "Improves objectives of a design of RUN while the others get no worse than their spread, by NLopt on the\n"
        "simulator. At the end both designs are simulated again; a gain beyond the standard deviation goes into the "
        "run\n"
        "as a design of the kind polished.",
    .options = OPTIONS,
    .run = run,
};
