#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cmd/commands.h"
#include "cmd/pairs.h"
#include "cmd/show.h"
#include "store/export.h"
#include "store/output.h"
#include "store/run_read.h"
#include "study/confidence.h"

typedef struct {
    const Run *run;
    FrontBox box;
    unsigned char *allowed; /* (run->table.n) */
} Choice;

/* Objective k, or from n_obj on a further measure; NAN: not known. */
static double result_of(const Run *run, size_t row, size_t k)
{
    const size_t n_obj = run->schema.n_obj;
    return k < n_obj ? run_f(run, row)[k] : run->table.row[row].extra[k - n_obj];
}

static Status apply_limit(Choice *c, const char *option, int is_max, const char *text, Err *err)
{
    size_t k, n_known = 0;
    double limit;
    TRY(pair_take(&c->run->schema, option, text, &k, &limit, err));
    for (size_t i = 0; i < c->run->n_front; i++) {
        const double f = result_of(c->run, c->run->front[i], k);
        n_known += !isnan(f);
        if (!(is_max ? f <= limit : f >= limit))
            c->allowed[c->run->front[i]] = 0;
    }
    return n_known > 0
               ? STATUS_OK
               : fail(err, STATUS_UNMET, "%s: this run has no %s of its designs: make it an objective or a limit",
                      option, schema_objective(&c->run->schema, k)->name);
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

/* -- what is chosen ------------------------------------------------------------------------------------------------ */

enum { PICKS_MAX = OBJECTIVES_MAX + 3 };

typedef struct {
    size_t n_left, n; /* designs within the limits; picks */
    struct {
        char name[TABLE_NAME_MAX + 8];
        size_t row;
    } pick[PICKS_MAX];
    double confidence[PICKS_MAX]; /* probability of being nondominated; NAN: without noise */
} Picks;

/* The cheapest design within the limits; values[0] of best_cost is the objective's number. */
static void add_pick(const Choice *c, const char *name, CostFn cost, const double values[], Picks *p)
{
    const Run *run = c->run;
    size_t best = run->table.n;
    for (size_t i = 0; i < run->n_front; i++) {
        const size_t row = run->front[i];
        if (c->allowed[row] && (best == run->table.n || cost(c, row, values) < cost(c, best, values)))
            best = row;
    }
    snprintf(p->pick[p->n].name, sizeof p->pick[0].name, "%s", name);
    p->pick[p->n++].row = best;
}

static double best_cost(const Choice *c, size_t row, const double values[])
{
    return run_scaled(c->run, &c->box, row, (size_t)values[0]);
}

static Status find_picks(const Args *args, Choice *c, Picks *p, Err *err)
{
    double weights[OBJECTIVES_MAX], reference[OBJECTIVES_MAX];
    p->n = 0;
    TRY(apply_limits(args, c, &p->n_left, err));
    if (args_has(args, "--weights"))
        TRY(take_weights(c, args_value(args, "--weights"), weights, err));
    if (args_has(args, "--reference"))
        TRY(take_reference(c, args_value(args, "--reference"), reference, err));
    if (p->n_left == 0)
        return STATUS_OK;
    add_pick(c, "knee", distance_cost, NULL, p);
    for (size_t k = 0; k < c->run->schema.n_obj; k++) {
        char name[TABLE_NAME_MAX + 8];
        snprintf(name, sizeof name, "best_%s", schema_objective(&c->run->schema, k)->name);
        add_pick(c, name, best_cost, (const double[]){(double)k}, p);
    }
    if (args_has(args, "--weights"))
        add_pick(c, "weighted", weighted_cost, weights, p);
    if (args_has(args, "--reference"))
        add_pick(c, "nearest to reference", reference_cost, reference, p);
    return STATUS_OK;
}

/* -- the part of the front that is sure ---------------------------------------------------------------------------- */

/* Designs of the front within the limits that are nondominated with a probability of `wanted` or more. */
typedef struct {
    double wanted; /* 0: not asked for */
    size_t n, n_asked;
    size_t *row; /* (n) */
    double *p;   /* (n) */
} Sure;

/* Why no design of the front has a probability. */
static const char *why_unknown(const Run *run)
{
    if (schema_is_noisy(run->settings))
        return "no design of the front has a known error: the search has repeated none so far, or all are polished";
    if (run->schema.has_spread)
        return "the replicates of a tower (sim.replicates) err alike in every design, so that their errors are not "
               "independent, as this probability takes them; NAME_sd of front.csv shows how large they are";
    return "the objectives of this run have no known errors: its settings name no noise (problem.noise, "
           "problem.noisy), or no repeats (search.replicate_share, search.replicates_max)";
}

/* One set of draws for the picks and, where it is asked for, the front within the limits. */
static Status find_confidence(const Choice *c, Picks *p, Sure *sure, Err *err)
{
    const Run *run = c->run;
    sure->row = calloc(p->n + run->n_front + 1, sizeof *sure->row);
    sure->p = calloc(p->n + run->n_front + 1, sizeof *sure->p);
    if (!sure->row || !sure->p)
        return fail(err, STATUS_NO_MEMORY, "no memory for a front");
    size_t n = 0;
    for (size_t k = 0; k < p->n; k++)
        sure->row[n++] = p->pick[k].row;
    for (size_t i = 0; i < run->n_front && sure->wanted > 0.0; i++)
        if (c->allowed[run->front[i]])
            sure->row[n++] = run->front[i];
    TRY(confidence_of_designs(run, n, sure->row, sure->p, err));
    memcpy(p->confidence, sure->p, p->n * sizeof *p->confidence);
    for (size_t i = p->n; i < n; i++) {
        sure->n_asked += !isnan(sure->p[i]);
        if (sure->p[i] >= sure->wanted) {
            sure->row[sure->n] = sure->row[i];
            sure->p[sure->n++] = sure->p[i];
        }
    }
    return sure->n_asked > 0 || n == p->n ? STATUS_OK : fail(err, STATUS_USAGE, "--confidence: %s", why_unknown(run));
}

static void show_sure(const Run *run, const Sure *sure)
{
    if (sure->wanted == 0.0)
        return;
    printf("\n%zu of %zu designs are nondominated with a probability of %g or more:\n", sure->n, sure->n_asked,
           sure->wanted);
    for (size_t i = 0; i < sure->n; i++)
        printf("%s%ld (%.2f)", i ? ", " : "", run->table.row[sure->row[i]].id, sure->p[i]);
    putchar('\n');
}

static json_t *describe_sure(const Run *run, const Sure *sure)
{
    json_t *list = json_array();
    for (size_t i = 0; i < sure->n; i++)
        json_array_append_new(list, json_pack("{s:I, s:f}", "id", (json_int_t)run->table.row[sure->row[i]].id,
                                              "nondominated_probability", sure->p[i]));
    return list;
}

static void show_confidence(const Picks *p)
{
    static const char HEAD[] = "\nprobability of being nondominated, by the standard errors of the means:\n";
    size_t n = 0;
    for (size_t i = 0; i < p->n; i++)
        if (!isnan(p->confidence[i]))
            printf("%s%s %.2f", n++ ? ", " : HEAD, p->pick[i].name, p->confidence[i]);
    if (n > 0)
        putchar('\n');
}

static void show_table(const Run *run, const Picks *p)
{
    printf("%zu of %zu designs are within the limits\n\n", p->n_left, run->n_front);
    show_objective_names(&run->schema);
    for (size_t i = 0; i < p->n; i++)
        show_objectives(p->pick[i].name, run->table.row[p->pick[i].row].id, &run->schema, run_f(run, p->pick[i].row),
                        NULL);
    if (run->schema.n_limited == 0)
        return;
    putchar('\n');
    show_limited_names(&run->schema);
    for (size_t i = 0; i < p->n; i++)
        show_limited(p->pick[i].name, run->table.row[p->pick[i].row].id, &run->schema,
                     run->table.row[p->pick[i].row].extra);
}

static void show_variables(const Run *run, const Picks *p)
{
    for (size_t i = 0; i < p->n; i++) {
        if (strncmp(p->pick[i].name, "best_", 5) == 0)
            continue;
        printf("\n%s:", p->pick[i].name);
        for (size_t j = 0; j < run->schema.n_var; j++)
            printf(" %s=%.6g", schema_variable(&run->schema, j)->name, run_x(run, p->pick[i].row)[j]);
    }
    putchar('\n');
}

/* As front.csv; a design that was picked twice stands there once. */
static Status write_csv(const Run *run, const Picks *p, const char *path, Err *err)
{
    Output o;
    TRY(output_open(&o, path, err));
    export_front_header(o.stream, &run->schema);
    for (size_t i = 0; i < p->n; i++) {
        size_t before = 0;
        while (before < i && p->pick[before].row != p->pick[i].row)
            before++;
        if (before == i)
            export_design(o.stream, run, p->pick[i].row);
    }
    return output_close(&o, err);
}

static json_t *json_values(size_t n, const Column columns[], const double values[])
{
    json_t *o = json_object();
    for (size_t k = 0; k < n; k++)
        json_object_set_new(o, columns[k].name, json_number(values[k]));
    return o;
}

static json_t *json_limited(const Run *run, size_t row)
{
    const Schema *s = &run->schema;
    json_t *o = json_object();
    for (size_t k = 0; k < s->n_limited; k++)
        json_object_set_new(o, schema_extra(s, s->limited[k])->name,
                            json_number(run->table.row[row].extra[s->limited[k]]));
    return o;
}

static json_t *describe(const Run *run, const Picks *p, const Sure *sure)
{
    const Schema *schema = &run->schema;
    json_t *picks = json_array();
    for (size_t i = 0; i < p->n; i++) {
        const size_t row = p->pick[i].row;
        json_array_append_new(picks,
                              json_pack("{s:s, s:I, s:o, s:o, s:o, s:o}", "name", p->pick[i].name, "id",
                                        (json_int_t)run->table.row[row].id, "objectives",
                                        json_values(schema->n_obj, schema->column + schema->n_var, run_f(run, row)),
                                        "limited", json_limited(run, row), "variables",
                                        json_values(schema->n_var, schema->column, run_x(run, row)),
                                        "nondominated_probability", json_number(p->confidence[i])));
    }
    json_t *o = json_pack("{s:s, s:I, s:I, s:o}", "run", run->folder, "front", (json_int_t)run->n_front,
                          "within_limits", (json_int_t)p->n_left, "designs", picks);
    if (sure->wanted > 0.0)
        json_object_set_new(o, "confident", describe_sure(run, sure));
    return o;
}

static Status show(const Args *args, const Run *run, const Picks *p, const Sure *sure, Err *err)
{
    const char *csv = args_value(args, "--csv");
    if (csv)
        TRY(write_csv(run, p, csv, err));
    if (args_has(args, "--json"))
        TRY(show_json(describe(run, p, sure), err));
    else if (!csv)
        show_table(run, p);
    if (!csv && !args_has(args, "--json")) {
        show_confidence(p);
        show_sure(run, sure);
    }
    if (p->n_left == 0)
        return fail(err, STATUS_UNMET,
                    "no design of the front is within the limits; `imtet optimize` with "
                    "search.limits looks for some");
    if (!csv && !args_has(args, "--json"))
        show_variables(run, p);
    return STATUS_OK;
}

static Status choose(const Args *args, Choice *c, Sure *sure, Err *err)
{
    Picks picks;
    TRY(find_picks(args, c, &picks, err));
    TRY(args_number(args, "--confidence", 0.01, 1, 0, &sure->wanted, err));
    if (!args_has(args, "--csv") || args_has(args, "--json")) /* which has no place for it */
        TRY(find_confidence(c, &picks, sure, err));
    return show(args, c->run, &picks, sure, err);
}

static Status choose_of(const Args *args, const Run *run, Err *err)
{
    if (run->n_front == 0)
        return run_why_empty(run, err);
    Choice c = {.run = run, .box = run_box(run), .allowed = calloc(run->table.n, 1)};
    Sure sure = {0};
    const Status status =
        c.allowed ? choose(args, &c, &sure, err) : fail(err, STATUS_NO_MEMORY, "no memory for a choice");
    free(sure.row);
    free(sure.p);
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
    {"--max", "NAME=VALUE", NULL, 1,
     "only designs whose NAME, an objective or another result, is no larger; may be repeated"},
    {"--min", "NAME=VALUE", NULL, 1, "the same, no smaller"},
    {"--weights", "NAME=W,...", NULL, 0, "the least weighted sum of objectives scaled to 0 (best) .. 1 (worst)"},
    {"--reference", "NAME=VALUE,...", NULL, 0, "reference point: the design nearest to these values"},
    {"--confidence", "P", NULL, 0,
     "noisy runs: list the designs of the front that are nondominated with this probability"},
    {"--csv", "FILE", NULL, 0, "the designs chosen, as rows of front.csv, into FILE; -: standard output"},
    {"--json", NULL, NULL, 0, "the designs chosen with their names, objectives and variables, on standard output"},
    OPTION_END,
};

const Command CMD_CHOOSE = {
    .name = "choose",
    .group = GROUP_DECIDE,
    .operand = "RUN",
    .summary = "designs of a front by limits, weights or a reference point",
    .example = "imtet choose results/quick --max j3_g=5 --weights j1_m=2,mcore_kg=1",
    .details =
        "Of the front of the folder RUN, among the designs within the limits: the knee (nearest to the ideal point\n"
        "when every objective is scaled to 0..1 over the front), the best of every objective, the best weighted one,\n"
        "the one nearest to a reference point. Other commands take a design by its id, RUN:417, and those of the\n"
        "whole front by name: RUN:knee, RUN:best_j1_m.",
    .options = OPTIONS,
    .run = run,
    .only_reads = 1,
};
