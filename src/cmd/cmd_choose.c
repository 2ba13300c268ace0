#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cmd/commands.h"
#include "cmd/pairs.h"
#include "cmd/show.h"
#include "store/front.h"

typedef struct {
    Front front;
    double ideal[OBJECTIVES_MAX], span[OBJECTIVES_MAX];
    unsigned char *allowed; /* (front.n) */
} Choice;

static double sense_of(const Choice *c, size_t k)
{
    return schema_objective(&c->front.schema, k)->sense;
}

/* 0: the best on the front, 1: the worst */
static double scaled(const Choice *c, size_t i, size_t k)
{
    return (sense_of(c, k) * front_f(&c->front, i)[k] - c->ideal[k]) / c->span[k];
}

static Status apply_limit(Choice *c, const char *option, int is_max, const char *text, Err *err)
{
    size_t k;
    double limit;
    TRY(pair_take(&c->front.schema, option, text, NAN, &k, &limit, err));
    for (size_t i = 0; i < c->front.n; i++)
        if (is_max ? front_f(&c->front, i)[k] > limit : front_f(&c->front, i)[k] < limit)
            c->allowed[i] = 0;
    return STATUS_OK;
}

/* Only designs within every --max and --min stay allowed. */
static Status apply_limits(const Args *args, Choice *c, size_t *n_left, Err *err)
{
    static const char *const LIMITS[] = {"--min", "--max"};
    const char *text;
    memset(c->allowed, 1, c->front.n);
    for (int is_max = 0; is_max < 2; is_max++)
        for (int i = 0; (text = args_next(args, LIMITS[is_max], &i));)
            TRY(apply_limit(c, LIMITS[is_max], is_max, text, err));
    *n_left = 0;
    for (size_t i = 0; i < c->front.n; i++)
        *n_left += c->allowed[i];
    return STATUS_OK;
}

static Status take_weights(const Choice *c, const char *list, double weights[], Err *err)
{
    memset(weights, 0, c->front.n_obj * sizeof *weights);
    TRY(pairs_take(&c->front.schema, "--weights", list, NAN, weights, err));
    return weights_check(&c->front.schema, "--weights", weights, err);
}

/* NAN where nothing is wished for. */
static Status take_wishes(const Choice *c, const char *list, double wishes[], Err *err)
{
    for (size_t k = 0; k < c->front.n_obj; k++)
        wishes[k] = NAN;
    return pairs_take(&c->front.schema, "--wish", list, NAN, wishes, err);
}

typedef double (*CostFn)(const Choice *c, size_t i, const double values[]);

static double knee_cost(const Choice *c, size_t i, const double values[])
{
    double sum = 0;
    (void)values;
    for (size_t k = 0; k < c->front.n_obj; k++)
        sum += scaled(c, i, k) * scaled(c, i, k);
    return sum;
}

static double weighted_cost(const Choice *c, size_t i, const double weights[])
{
    double sum = 0;
    for (size_t k = 0; k < c->front.n_obj; k++)
        sum += weights[k] * scaled(c, i, k);
    return sum;
}

static double wish_cost(const Choice *c, size_t i, const double wishes[])
{
    double sum = 0;
    for (size_t k = 0; k < c->front.n_obj; k++) {
        const double off = (front_f(&c->front, i)[k] - wishes[k]) / c->span[k];
        sum += isnan(wishes[k]) ? 0 : off * off;
    }
    return sum;
}

static void show_best(const Choice *c, const char *label, CostFn cost, const double values[])
{
    size_t best = c->front.n;
    for (size_t i = 0; i < c->front.n; i++)
        if (c->allowed[i] && (best == c->front.n || cost(c, i, values) < cost(c, best, values)))
            best = i;
    show_objectives(label, front_id(&c->front, best), c->front.n_obj, front_f(&c->front, best));
    printf("    ");
    for (int j = 0; j < c->front.n_var; j++)
        printf(" %s=%.6g", schema_variable(&c->front.schema, (size_t)j)->name, front_x(&c->front, best)[j]);
    putchar('\n');
}

static Status choose(const Args *args, Choice *c, Err *err)
{
    size_t n_left;
    double weights[OBJECTIVES_MAX], wishes[OBJECTIVES_MAX];
    TRY(apply_limits(args, c, &n_left, err));
    if (args_has(args, "--weights"))
        TRY(take_weights(c, args_value(args, "--weights"), weights, err));
    if (args_has(args, "--wish"))
        TRY(take_wishes(c, args_value(args, "--wish"), wishes, err));
    printf("%zu of %zu designs are within the limits\n", n_left, c->front.n);
    if (n_left == 0)
        return fail(err, STATUS_UNMET,
                    "no design of the front is within the limits; `imtet optimize` with "
                    "search.limits looks for some");
    putchar('\n');
    show_objective_names(&c->front.schema);
    show_best(c, "knee", knee_cost, NULL);
    if (args_has(args, "--weights"))
        show_best(c, "weighted", weighted_cost, weights);
    if (args_has(args, "--wish"))
        show_best(c, "nearest wish", wish_cost, wishes);
    return STATUS_OK;
}

static Status run(const Args *args, Err *err)
{
    Choice c = {0};
    TRY(front_read(&c.front, args->operand, err));
    c.allowed = calloc(c.front.n + 1, 1);
    Status status = c.allowed ? STATUS_OK : fail(err, STATUS_NO_MEMORY, "no memory for a choice");
    if (status == STATUS_OK && c.front.n == 0)
        status = front_why_empty(args->operand, err);
    if (status == STATUS_OK) {
        front_box(&c.front, c.ideal, c.span);
        status = choose(args, &c, err);
    }
    free(c.allowed);
    front_free(&c.front);
    return status;
}

static const ArgOption OPTIONS[] = {
    {"--max", "NAME=VALUE", NULL, 1, "only designs whose objective is no larger; may be repeated"},
    {"--min", "NAME=VALUE", NULL, 1, "only designs whose objective is no smaller; may be repeated"},
    {"--weights", "NAME=W,...", NULL, 0, "the least weighted sum of objectives scaled to 0 (best) .. 1 (worst)"},
    {"--wish", "NAME=VALUE,...", NULL, 0, "the design nearest to these values"},
    OPTION_END,
};

const Command CMD_CHOOSE = {
    .name = "choose",
    .operand = "RUN",
    .summary = "designs of a front by limits, weights or wishes",
    .example = "imtet choose results/quick --max j3_g=5 --weights j1_m=2,mcore_kg=1",
    .details =
        "Of the front of the folder RUN, among the designs within the limits: the knee (nearest to the ideal point\n"
        "when every objective is scaled to 0..1 over the front), the best weighted one, the one nearest to a list\n"
        "of wishes; each with its objectives and variables.",
    .options = OPTIONS,
    .run = run,
};
