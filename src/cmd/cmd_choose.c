#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cmd/commands.h"
#include "cmd/pairs.h"
#include "cmd/show.h"
#include "store/run_read.h"

typedef struct {
    const Run *run;
    FrontBox box;
    unsigned char *allowed; /* (run->table.n) */
} Choice;

static Status apply_limit(Choice *c, const char *option, int is_max, const char *text, Err *err)
{
    size_t k;
    double limit;
    TRY(pair_take(&c->run->schema, option, text, NAN, &k, &limit, err));
    for (size_t i = 0; i < c->run->n_front; i++) {
        const double f = run_f(c->run, c->run->front[i])[k];
        if (is_max ? f > limit : f < limit)
            c->allowed[c->run->front[i]] = 0;
    }
    return STATUS_OK;
}

/* Only designs within every --max and --min stay allowed. */
static Status apply_limits(const Args *args, Choice *c, size_t *n_left, Err *err)
{
    static const char *const LIMITS[] = {"--min", "--max"};
    const Run *run = c->run;
    const char *text;
    for (size_t i = 0; i < run->n_front; i++)
        c->allowed[run->front[i]] = 1;
    for (int is_max = 0; is_max < 2; is_max++)
        for (int i = 0; (text = args_next(args, LIMITS[is_max], &i));)
            TRY(apply_limit(c, LIMITS[is_max], is_max, text, err));
    *n_left = 0;
    for (size_t i = 0; i < run->n_front; i++)
        *n_left += c->allowed[run->front[i]];
    return STATUS_OK;
}

static Status take_weights(const Choice *c, const char *list, double weights[], Err *err)
{
    memset(weights, 0, c->run->schema.n_obj * sizeof *weights);
    TRY(pairs_take(&c->run->schema, "--weights", list, NAN, weights, err));
    return weights_check(&c->run->schema, "--weights", weights, err);
}

/* NAN where nothing is wished for. */
static Status take_reference(const Choice *c, const char *list, double reference[], Err *err)
{
    for (size_t k = 0; k < c->run->schema.n_obj; k++)
        reference[k] = NAN;
    return pairs_take(&c->run->schema, "--reference", list, NAN, reference, err);
}

typedef double (*CostFn)(const Choice *c, size_t row, const double values[]);

static double distance_cost(const Choice *c, size_t row, const double values[])
{
    (void)values;
    return run_distance2(c->run, &c->box, row);
}

static double weighted_cost(const Choice *c, size_t row, const double weights[])
{
    double sum = 0;
    for (size_t k = 0; k < c->run->schema.n_obj; k++)
        sum += weights[k] * run_scaled(c->run, &c->box, row, k);
    return sum;
}

static double reference_cost(const Choice *c, size_t row, const double reference[])
{
    double sum = 0;
    for (size_t k = 0; k < c->run->schema.n_obj; k++) {
        const double off = (run_f(c->run, row)[k] - reference[k]) / c->box.span[k];
        sum += isnan(reference[k]) ? 0 : off * off;
    }
    return sum;
}

static void show_best(const Choice *c, const char *label, CostFn cost, const double values[])
{
    const Run *run = c->run;
    size_t best = run->table.n;
    for (size_t i = 0; i < run->n_front; i++) {
        const size_t row = run->front[i];
        if (c->allowed[row] && (best == run->table.n || cost(c, row, values) < cost(c, best, values)))
            best = row;
    }
    show_objectives(label, run->table.row[best].id, run->schema.n_obj, run_f(run, best));
    printf("    ");
    for (size_t j = 0; j < run->schema.n_var; j++)
        printf(" %s=%.6g", schema_variable(&run->schema, j)->name, run_x(run, best)[j]);
    putchar('\n');
}

static Status choose(const Args *args, Choice *c, Err *err)
{
    size_t n_left;
    double weights[OBJECTIVES_MAX], reference[OBJECTIVES_MAX];
    TRY(apply_limits(args, c, &n_left, err));
    if (args_has(args, "--weights"))
        TRY(take_weights(c, args_value(args, "--weights"), weights, err));
    if (args_has(args, "--reference"))
        TRY(take_reference(c, args_value(args, "--reference"), reference, err));
    printf("%zu of %zu designs are within the limits\n", n_left, c->run->n_front);
    if (n_left == 0)
        return fail(err, STATUS_UNMET,
                    "no design of the front is within the limits; `imtet optimize` with "
                    "search.limits looks for some");
    putchar('\n');
    show_objective_names(&c->run->schema);
    show_best(c, "knee", distance_cost, NULL);
    if (args_has(args, "--weights"))
        show_best(c, "weighted", weighted_cost, weights);
    if (args_has(args, "--reference"))
        show_best(c, "nearest to reference", reference_cost, reference);
    return STATUS_OK;
}

static Status choose_of(const Args *args, const Run *run, Err *err)
{
    if (run->n_front == 0)
        return run_why_empty(run, err);
    Choice c = {.run = run, .box = run_box(run), .allowed = calloc(run->table.n, 1)};
    const Status status = c.allowed ? choose(args, &c, err) : fail(err, STATUS_NO_MEMORY, "no memory for a choice");
    free(c.allowed);
    return status;
}

static Status run(const Args *args, Err *err)
{
    Run r;
    TRY(run_read(&r, args->operand, err));
    const Status status = choose_of(args, &r, err);
    run_free(&r);
    return status;
}

static const ArgOption OPTIONS[] = {
    {"--max", "NAME=VALUE", NULL, 1, "only designs whose objective is no larger; may be repeated"},
    {"--min", "NAME=VALUE", NULL, 1, "only designs whose objective is no smaller; may be repeated"},
    {"--weights", "NAME=W,...", NULL, 0, "the least weighted sum of objectives scaled to 0 (best) .. 1 (worst)"},
    {"--reference", "NAME=VALUE,...", NULL, 0, "reference point: the design nearest to these values"},
    OPTION_END,
};

const Command CMD_CHOOSE = {
    .name = "choose",
    .operand = "RUN",
    .summary = "designs of a front by limits, weights or a reference point",
    .example = "imtet choose results/quick --max j3_g=5 --weights j1_m=2,mcore_kg=1",
    .details =
        "Of the front of the folder RUN, among the designs within the limits: the knee (nearest to the ideal point\n"
        "when every objective is scaled to 0..1 over the front), the best weighted one, the one nearest to\n"
        "a reference point; each with its objectives and variables.",
    .options = OPTIONS,
    .run = run,
};
