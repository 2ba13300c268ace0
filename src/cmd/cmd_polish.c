#include <stdlib.h>
#include <string.h>

#include "cmd/commands.h"
#include "cmd/show.h"
#include "polish/polish.h"
#include "run/front.h"
#include "run/output.h"
#include "run/subject.h"

typedef struct {
    Settings settings;
    Front front;
    Subject *subject;
    size_t row;
    double slack[OBJECTIVES_MAX], f[OBJECTIVES_MAX], f_start[OBJECTIVES_MAX];
    unsigned char keep[OBJECTIVES_MAX];
    PolishConfig config;
    PolishResult result;
} Work;

static Status take_number(const Args *args, const char *name, double standard, double *value, Err *err)
{
    const char *text = args_value(args, name);
    char *end;
    *value = text ? strtod(text, &end) : standard;
    if (text && (end == text || *end || !(*value >= 0.0 && *value < 1e9)))
        return fail(err, STATUS_USAGE, "%s: '%.40s' is no number of 0 or more", name, text);
    return STATUS_OK;
}

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
    double evals, seconds, slack;
    w->config.improve = 0;
    if (improve)
        TRY(schema_pick_objective(schema, "--improve", improve, STATUS_USAGE, &w->config.improve, err));
    TRY(take_kept(args, w, err));
    TRY(take_number(args, "--evals", 200, &evals, err));
    TRY(take_number(args, "--seconds", 0, &seconds, err));
    TRY(take_number(args, "--slack", 0, &slack, err));
    for (size_t k = 0; k < schema->n_obj; k++) {
        const double f = front_f(&w->front, w->row)[k];
        w->slack[k] = slack * (f < 0 ? -f : f);
    }
    w->config.algorithm = args_has(args, "--algorithm") ? args_value(args, "--algorithm") : "cobyla";
    w->config.keep = w->keep;
    w->config.slack = w->slack;
    w->config.max_evals = evals < 1 ? 1 : (size_t)evals;
    w->config.max_seconds = seconds;
    w->config.seed = (uint32_t)w->settings.search.seed;
    return STATUS_OK;
}

static Status open_run(const Args *args, Work *w, Err *err)
{
    const char *id = args_value(args, "--design");
    if (!id)
        return fail(err, STATUS_USAGE, "--design ID is missing; %s/front.csv lists them, knee is one too",
                    args->operand);
    TRY(run_settings(&w->settings, args->operand, err));
    TRY(front_read(&w->front, args->operand, err));
    TRY(front_pick(&w->front, args->operand, id, &w->row, err));
    TRY(take_options(args, w, err));
    return subject_open(&w->subject, &w->settings, err);
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
        print_number(o.stream, j < schema->n_var ? w->result.x[j] : schema->column[j].sense * w->f[j - schema->n_var]);
    }
    fputc('\n', o.stream);
    return output_close(&o, err);
}

static void show(const Work *w)
{
    const Schema *schema = &w->front.schema;
    const size_t k = w->config.improve;
    double before[OBJECTIVES_MAX], after[OBJECTIVES_MAX];
    for (size_t j = 0; j < schema->n_obj; j++) {
        before[j] = schema_objective(schema, j)->sense * w->f_start[j];
        after[j] = schema_objective(schema, j)->sense * w->f[j];
    }
    show_objective_names(schema);
    show_objectives("before", front_id(&w->front, w->row), schema->n_obj, before);
    show_objectives("polished", 0, schema->n_obj, after);
    printf("\n%s: %zu evaluations, %zu failed, %.1f s; ", w->config.algorithm, w->result.n_evaluated,
           w->result.n_failed, w->result.seconds);
    if (w->f[k] < w->f_start[k])
        printf(
            "%s changed by %.3g %%. Repeat it with other seeds or motions before trusting a gain below the spread.\n",
            schema_objective(schema, k)->name, 100.0 * (after[k] - before[k]) / (before[k] != 0 ? before[k] : 1));
    else
        printf("no improvement of %s was found that keeps the others.\n", schema_objective(schema, k)->name);
}

static Status polish(const Args *args, Work *w, Err *err)
{
    TRY(open_run(args, w, err));
    w->result.x = calloc(w->front.schema.n_var, sizeof *w->result.x);
    w->result.f = w->f;
    w->result.f_start = w->f_start;
    if (!w->result.x)
        return fail(err, STATUS_NO_MEMORY, "no memory for a design");
    TRY(polish_run(subject_problem(w->subject), &w->config, front_x(&w->front, w->row), &w->result, err));
    show(w);
    return args_has(args, "--csv") ? write_csv(w, args_value(args, "--csv"), err) : STATUS_OK;
}

static Status run(const Args *args, Err *err)
{
    Work w = {0};
    const Status status = polish(args, &w, err);
    subject_close(w.subject);
    front_free(&w.front);
    free(w.result.x);
    return status;
}

static const ArgOption OPTIONS[] = {
    {"--design", "ID", NULL, 0, "column id of RUN/front.csv, or knee"},
    {"--improve", "NAME", NULL, 0, "the objective to improve; the first one if not given"},
    {"--keep", "NAMES", NULL, 0, "all, or a comma list: these may not get worse"},
    {"--slack", "S", NULL, 0, "but by this share of their value; 0 if not given"},
    {"--algorithm", "NAME", NULL, 0, "cobyla | bobyqa | sbplx | isres"},
    {"--evals", "N", NULL, 0, "stop after so many simulations; 200 if not given"},
    {"--seconds", "T", NULL, 0, "stop after so long; 0: no limit"},
    {"--csv", "FILE", NULL, 0, "the polished design and its objectives into FILE; -: standard output"},
    OPTION_END,
};

const Command CMD_POLISH = {
    .name = "polish",
    .operand = "RUN",
    .summary = "improve one objective of a design, the others kept",
    .example = "imtet polish results/quick --design knee --improve j2_m",
    .details = "Starts at one design of the front of the folder RUN and improves one objective with NLopt on the true\n"
               "simulation, while the others do not get worse. The run itself is left as it is.",
    .options = OPTIONS,
    .run = run,
};
