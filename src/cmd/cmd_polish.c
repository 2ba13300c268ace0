#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cmd/commands.h"
#include "cmd/designs.h"
#include "cmd/pairs.h"
#include "cmd/show.h"
#include "store/output.h"
#include "store/store.h"
#include "study/refine.h"
#include "settings/options.h"

typedef struct {
    RunStore *store; /* open from the first look at the design until the better one is in */
    const Run *run;
    size_t row; /* of the design */
    double weight[OBJECTIVES_MAX];
    unsigned char keep[OBJECTIVES_MAX];
    RefineConfig config;
    Refined result;
} Work;

static Status take_kept(const Args *args, Work *w, Err *err)
{
    const Schema *schema = &w->run->schema;
    const char *list = args_value(args, "--keep");
    char name[TABLE_NAME_MAX];
    size_t k;
    memset(w->keep, !list || strcmp(list, "all") == 0, schema->n_obj);
    for (size_t i = 0; list && strcmp(list, "all") != 0 && i < list_count(list); i++) {
        if (!list_item(list, i, name, sizeof name))
            return fail(err, STATUS_USAGE, "--keep: name %zu is empty or too long", i + 1);
        TRY(schema_pick_objective(schema, "--keep", name, STATUS_USAGE, &k, err));
        w->keep[k] = 1;
    }
    return STATUS_OK;
}

static Status take_improved(const Args *args, Work *w, Err *err)
{
    const Schema *schema = &w->run->schema;
    const char *list = args_value(args, "--improve");
    for (size_t k = 0; k < schema->n_obj; k++)
        w->weight[k] = list ? strcmp(list, "all") == 0 : k == 0;
    if (list && strcmp(list, "all") != 0)
        TRY(pairs_take(schema, "--improve", list, 1.0, w->weight, err));
    return weights_check(schema, "--improve", w->weight, err);
}

static Status take_options(const Args *args, Work *w, Err *err)
{
    long evals;
    TRY(refine_allows(w->run->settings, err));
    TRY(take_improved(args, w, err));
    TRY(take_kept(args, w, err));
    TRY(args_whole(args, "--evals", 1, 1000000, 300, &evals, err));
    TRY(args_whole(args, "--replicates", 1, 1000, 4, &w->config.replicates, err));
    TRY(args_number(args, "--seconds", 0, 1e9, 0, &w->config.max_seconds, err));
    const size_t needed = refine_evals_min(w->run->settings, w->config.replicates);
    if ((size_t)evals < needed)
        return fail(err, STATUS_USAGE,
                    "--evals %ld: the design at the start, one that is tried, and both designs at the end take %zu "
                    "simulations (6 times --replicates of a tower: at the end also at twice the steps); give more, or "
                    "fewer --replicates",
                    evals, needed);
    TRY(args_number(args, "--slack", 0, 1e6, -1, &w->config.slack, err));
    w->config.gain_min = w->run->settings->search.polish_gain_min;
    w->config.algorithm = args_value(args, "--algorithm");
    w->config.weight = w->weight;
    w->config.keep = w->keep;
    w->config.max_evals = (size_t)evals;
    return STATUS_OK;
}

static Status take_design(const Args *args, Work *w, Err *err)
{
    const char *word = args_value(args, "--design");
    return word ? design_of_run(w->run, word, &w->row, NULL, err)
                : fail(err, STATUS_USAGE, "--design ID is missing: an id of %s, knee or best_NAME", args->operand);
}

static Status open_run(const Args *args, Work *w, Err *err)
{
    RecordPaths moved;
    TRY(store_open_run(&w->store, args->operand, err));
    w->run = store_run(w->store);
    TRY(take_design(args, w, err));
    TRY(take_options(args, w, err));
    TRY(args_moved(args, &moved, err));
    return record_paths_find(w->run->settings, w->run->provenance, &moved, err);
}

/* One row in natural signs: the polished design as in front.csv but for the id of the design that it came from; then of every
 * objective how it was before, and where they are known the standard deviations of both and the estimated error. */
static Status write_csv(const Work *w, const char *path, Err *err)
{
    const Schema *schema = &w->run->schema;
    const Refined *r = &w->result;
    const struct {
        const char *suffix;
        const double *values;
    } more[] = {{"before", r->f_start}, {"before_sd", r->spread_start}, {"sd", r->spread}, {"error", r->error}};
    enum { N_MORE = sizeof more / sizeof more[0] };
    Output o;
    TRY(output_open(&o, path, err));
    fputs("polished_from", o.stream);
    for (size_t j = 0; j < schema->n_var + schema->n_obj; j++)
        fprintf(o.stream, ",%s", schema->column[j].name);
    for (size_t i = 0; i < N_MORE; i++)
        for (size_t k = 0; k < schema->n_obj && isfinite(more[i].values[0]); k++)
            fprintf(o.stream, ",%s_%s", schema_objective(schema, k)->name, more[i].suffix);
    fprintf(o.stream, "\n%ld", w->run->table.row[w->row].id);
    print_cells(o.stream, schema->n_var, r->x);
    print_cells(o.stream, schema->n_obj, r->f);
    for (size_t i = 0; i < N_MORE; i++)
        print_cells(o.stream, isfinite(more[i].values[0]) ? schema->n_obj : 0, more[i].values);
    fputc('\n', o.stream);
    return output_close(&o, err);
}

static void show_gain(const Work *w, size_t k)
{
    const Column *c = schema_objective(&w->run->schema, k);
    const Refined *r = &w->result;
    const double gain = c->sense * (r->f_start[k] - r->f[k]);
    const double error = hypot(r->spread_start[k], r->spread[k]) / sqrt((double)w->config.replicates);
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
           : r->gain > fmax(r->gain_min, 2.0 * r->gain_error)
               ? "Simulated at twice the steps on both designs it is not."
           : r->gain <= r->gain_min ? "Simulated again on both designs this is less than search.polish_gain_min."
                                    : "Simulated again on both designs this is not more than the standard deviation.";
}

static void show(const Work *w, long id)
{
    const Schema *schema = &w->run->schema;
    const Refined *r = &w->result;
    char label[32];
    show_objective_names(schema);
    show_objectives("before", w->run->table.row[w->row].id, schema, r->f_start, r->error);
    snprintf(label, sizeof label, "sd %s",
             spread_word(w->run->settings->sim.gap_tolerance_m, &w->run->settings->uncertain));
    show_objectives("polished", id, schema, r->f, r->error);
    if (isfinite(r->spread_start[0]))
        show_objectives(label, 0, schema, r->spread_start, NULL);
    if (isfinite(r->error[0]))
        show_objective_errors(schema, r->error);
    printf("\n%zu designs tried in %zu simulations, %zu failed, %.1f s\n", r->n_evaluated, r->n_simulated, r->n_failed,
           r->seconds);
    for (size_t k = 0; r->has_changed && k < schema->n_obj; k++)
        if (w->weight[k] > 0.0)
            show_gain(w, k);
    puts(verdict_of(r));
    if (id)
        printf("stored in the run as design %ld.\n", id);
}

static Status polish(const Args *args, Work *w, Err *err)
{
    long id = 0;
    TRY(open_run(args, w, err));
    TRY(refine_design(w->run, w->row, &w->config, &w->result, err));
    const Evaluation better = refined_evaluation(&w->result);
    if (refined_counts(&w->result))
        TRY(store_add_evaluations(w->store, 1, &better, &id, err));
    show(w, id);
    return args_has(args, "--csv") ? write_csv(w, args_value(args, "--csv"), err) : STATUS_OK;
}

static Status run(const Args *args, Err *err)
{
    Work w = {0};
    const Status status = polish(args, &w, err);
    refined_free(&w.result);
    store_free(w.store);
    return status;
}

static const ArgOption OPTIONS[] = {
    {"--design", "ID", NULL, 0, DESIGN_OF_RUN},
    {"--improve", "NAME[=W],...", NULL, 0,
     "objectives to improve, with weights in ranges of the front, or all; the first"},
    {"--keep", "NAMES", NULL, 0, "all, or a comma list: these may not get worse"},
    {"--slack", "S", NULL, 0, "but by this share of their value; their spread if not given"},
    {"--algorithm", "NAME", NULL, 0, "cobyla | bobyqa | sbplx | isres: half of the simulations go to it"},
    {"--evals", "N", NULL, 0, "simulate at most so often; 300 if not given"},
    {"--replicates", "N", NULL, 0, "simulations of a noisy design (the tower's), whose mean counts; 4"},
    {"--seconds", "T", NULL, 0, "stop after so long; 0: no limit"},
    {"--csv", "FILE", NULL, 0,
     "the polished design, its objectives and those before, their deviations and errors into FILE; -: standard output"},
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
        "Improves objectives of a design of RUN while the others get no worse than their spread: a surrogate "
        "of\n"
        "the nearest simulations, on which NLopt looks for better designs, and the simulator in turn. At the end both\n"
        "designs are simulated again; a gain beyond the standard deviation goes into the run as a design of the kind "
        "polished.",
    .options = OPTIONS,
    .run = run,
};
