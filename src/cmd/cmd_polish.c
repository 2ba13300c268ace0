#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cmd/commands.h"
#include "cmd/look.h"
#include "cmd/show.h"
#include "run/front.h"
#include "run/output.h"
#include "run/refine.h"

typedef struct {
    Front front;
    Saved run;
    size_t row; /* of the front */
    unsigned char keep[OBJECTIVES_MAX];
    RefineConfig config;
    Refined result;
} Work;

static Status take_kept(const Args *args, Work *w, Err *err)
{
    const Schema *schema = &w->front.schema;
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

static Status take_options(const Args *args, Work *w, Err *err)
{
    const Schema *schema = &w->front.schema;
    const char *improve = args_value(args, "--improve");
    long evals;
    w->config.improve = 0;
    if (improve)
        TRY(schema_pick_objective(schema, "--improve", improve, STATUS_USAGE, &w->config.improve, err));
    TRY(take_kept(args, w, err));
    TRY(args_whole(args, "--evals", 1, 1000000, 120, &evals, err));
    TRY(args_whole(args, "--members", 1, 1000, 4, &w->config.members, err));
    TRY(args_number(args, "--seconds", 0, 1e9, 0, &w->config.max_seconds, err));
    TRY(args_number(args, "--slack", 0, 1e6, -1, &w->config.slack, err));
    w->config.algorithm = args_has(args, "--algorithm") ? args_value(args, "--algorithm") : "cobyla";
    w->config.keep = w->keep;
    w->config.max_evals = (size_t)evals;
    return STATUS_OK;
}

static Status open_run(const Args *args, Work *w, Err *err)
{
    Moved moved;
    TRY(look_design(args, &w->front, &w->row, err));
    TRY(take_options(args, w, err));
    TRY(args_moved(args, &moved, err));
    TRY(saved_read(&w->run, args->operand, err));
    return moved_find(&w->run.settings, w->run.provenance, &moved, err);
}

/* One row in natural signs, as in front.csv but for the id of the design that it came from. */
static Status write_csv(const Work *w, const char *path, Err *err)
{
    const Schema *schema = &w->front.schema;
    Output o;
    TRY(output_open(&o, path, err));
    fputs("polished_from", o.stream);
    for (size_t j = 0; j < schema->n_var + schema->n_obj; j++)
        fprintf(o.stream, ",%s", schema->column[j].name);
    fprintf(o.stream, "\n%ld", front_id(&w->front, w->row));
    for (size_t j = 0; j < schema->n_var + schema->n_obj; j++) {
        fputc(',', o.stream);
        print_number(o.stream, j < schema->n_var ? w->result.x[j] : w->result.f[j - schema->n_var]);
    }
    fputc('\n', o.stream);
    return output_close(&o, err);
}

static void show(const Work *w, long id)
{
    const Schema *schema = &w->front.schema;
    const Refined *r = &w->result;
    const size_t k = w->config.improve;
    const char *name = schema_objective(schema, k)->name;
    show_objective_names(schema);
    show_objectives("before", front_id(&w->front, w->row), schema->n_obj, r->f_start);
    show_objectives("polished", id, schema->n_obj, r->f);
    if (isfinite(r->spread_start[k]))
        show_objectives("spread before", 0, schema->n_obj, r->spread_start);
    const long each = w->run.settings.problem.kind == PROBLEM_TOWER ? w->config.members : 1;
    printf("\n%s: %zu designs tried with %ld simulation%s each, %zu failed, %.1f s\n", w->config.algorithm,
           r->n_evaluated, each, each == 1 ? "" : "s", r->n_failed, r->seconds);
    if (!r->has_changed)
        printf("no improvement of %s was found that keeps the others.\n", name);
    else if (isfinite(r->gain_error))
        printf("%s is better by %.3g with a standard error of %.2g, measured anew on both designs: %s.\n", name,
               r->gain, r->gain_error, refined_counts(r) ? "more than the spread" : "not more than the spread");
    else
        printf("%s is better by %.3g; one simulation each: nothing is known of the spread.\n", name, r->gain);
    if (id)
        printf("stored in the run as design %ld.\n", id);
}

static Status polish(const Args *args, Work *w, Err *err)
{
    long id = 0;
    TRY(open_run(args, w, err));
    TRY(refine_design(&w->run, saved_find(&w->run, front_id(&w->front, w->row)), &w->config, &w->result, err));
    if (refined_counts(&w->result))
        TRY(refined_store(args->operand, &w->result, &id, err));
    show(w, id);
    return args_has(args, "--csv") ? write_csv(w, args_value(args, "--csv"), err) : STATUS_OK;
}

static Status run(const Args *args, Err *err)
{
    Work w = {0};
    const Status status = polish(args, &w, err);
    refined_free(&w.result);
    saved_free(&w.run);
    front_free(&w.front);
    return status;
}

static const ArgOption OPTIONS[] = {
    {"--design", "ID", NULL, 0, "column id of RUN/front.csv, or knee"},
    {"--improve", "NAME", NULL, 0, "the objective to improve; the first one if not given"},
    {"--keep", "NAMES", NULL, 0, "all, or a comma list: these may not get worse"},
    {"--slack", "S", NULL, 0, "but by this share of their value; their spread if not given"},
    {"--algorithm", "NAME", NULL, 0, "cobyla | bobyqa | sbplx | isres"},
    {"--evals", "N", NULL, 0, "try at most so many designs; 120 if not given"},
    {"--members", "N", NULL, 0, "simulations of each (the tower's), whose mean counts; 4 if not given"},
    {"--seconds", "T", NULL, 0, "stop after so long; 0: no limit"},
    {"--csv", "FILE", NULL, 0, "the polished design and its objectives into FILE; -: standard output"},
    OPTION_MOVED,
    OPTION_END,
};

const Command CMD_POLISH = {
    .name = "polish",
    .operand = "RUN",
    .summary = "improve one objective of a design, the others kept",
    .example = "imtet polish results/quick --design knee --improve j2_m",
    .details =
        "Improves one objective of a design of RUN with NLopt while the others get no worse than their spread: first\n"
        "on a response surface of the run's simulations, then on the mean of several simulations. At the end both\n"
        "designs are simulated anew; a gain beyond the spread goes into the run as a design of the kind polished.",
    .options = OPTIONS,
    .run = run,
};
