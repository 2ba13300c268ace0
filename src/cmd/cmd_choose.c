
#include "base/text.h"
#include "cmd/commands.h"
#include "cmd/designs.h"
#include "cmd/show.h"
#include "store/export.h"
#include "store/output.h"

typedef struct {
    const Run *run;
    FrontBox box;
    unsigned char *allowed; /* (run->table.n) */
} Choice;

static Status apply_limit(Choice *c, const char *option, int is_max, const char *text, Err *err)
{
    size_t k, n_known = 0;
    double limit;
    TRY(pair_take(&c->run->schema, option, text, &k, &limit, err));
    for (size_t i = 0; i < c->run->n_front; i++) {
        const double f = run_result(c->run, c->run->front[i], k);
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

/* NAN where the point has no value. */
static Status take_reference(const Choice *c, const char *list, double reference[], Err *err)
{
    for (size_t k = 0; k < c->run->schema.n_obj; k++)
        reference[k] = NAN;
    return pairs_take(&c->run->schema, "--reference", list, NAN, reference, err);
}

typedef double (*CostFn)(const Choice *c, size_t row, const double values[]);

static double weighted_cost(const Choice *c, size_t row, const double weights[])
{
    double sum = 0;
    for (size_t k = 0; k < c->run->schema.n_obj; k++)
        sum += weights[k] * run_scaled(c->run, &c->box, row, k);
    return sum;
}

/* To a point in natural signs, NAN where the point has no value; NULL: the ideal one. */
static double distance_cost(const Choice *c, size_t row, const double point[])
{
    double sum = 0;
    for (size_t k = 0; point && k < c->run->schema.n_obj; k++) {
        const double off = (run_f(c->run, row)[k] - point[k]) / c->box.span[k];
        sum += isnan(point[k]) ? 0 : off * off;
    }
    return point ? sum : run_distance2(c->run, &c->box, row);
}

/* -- what is chosen ------------------------------------------------------------------------------------------------ */

enum { PICKS_MAX = OBJECTIVES_MAX + 3 };

typedef struct {
    size_t n_left, n; /* designs within the limits; picks */
    struct {
        char name[TABLE_NAME_MAX + 8];
        size_t row;
    } pick[PICKS_MAX];
} Picks;

/* The cheapest design within the limits. */
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
        double alone[OBJECTIVES_MAX] = {0};
        alone[k] = 1;
        add_pick(c, name, weighted_cost, alone, p);
    }
    if (args_has(args, "--weights"))
        add_pick(c, "weighted", weighted_cost, weights, p);
    if (args_has(args, "--reference"))
        add_pick(c, "nearest to reference", distance_cost, reference, p);
    return STATUS_OK;
}

/* Where the knee within the limits is another design than the one that RUN:knee names. */
static void tell_knees(const Run *run, const Picks *p)
{
    const long knee = run->table.row[run_knee(run)].id, here = run->table.row[p->pick[0].row].id;
    if (here != knee)
        printf("\nthe knee within the limits is design %ld; %s:knee, of the whole front, is design %ld\n", here,
               run->folder, knee);
}

static void show_table(const Run *run, const Picks *p)
{
    json_t *table = json_array();
    char quoted[4 * PATH_MAX + 3];
    printf("%zu of %zu designs are within the limits\n\n", p->n_left, run->n_front);
    size_t n_unknown = 0;
    for (size_t i = 0; i < p->n; i++) {
        figures_of_run(table, run, p->pick[i].name, p->pick[i].row);
        n_unknown += run->finer.n > 0 && !run->table.row[p->pick[i].row].err;
    }
    figures_print(table);
    if (n_unknown > 0)
        printf("\n%zu designs have no error estimate; `imtet evaluate %s --design ID` makes one\n", n_unknown,
               run->id_step > 0 ? "RUN" : text_shell(run->folder, quoted));
    if (p->n > 0)
        tell_knees(run, p);
}

static void show_variables(const Run *run, const Picks *p)
{
    char word[KIND_WORD_MAX];
    for (size_t i = 0; i < p->n; i++) {
        if (strncmp(p->pick[i].name, "best_", 5) == 0)
            continue;
        printf("\n%s:", p->pick[i].name);
        for (size_t j = 0; j < run->schema.n_var; j++)
            if (schema_word(&run->schema, j, run_x(run, p->pick[i].row)[j], word))
                printf(" %s=%s", schema_variable(&run->schema, j)->name, word);
            else
                printf(" %s=%.6g", schema_variable(&run->schema, j)->name, run_x(run, p->pick[i].row)[j]);
    }
    putchar('\n');
}

/* As front.csv; a design that was picked twice stands there once. */
static Status write_csv(const Run *run, const Picks *p, const char *path, Err *err)
{
    Output o;
    TRY(output_open(&o, path, err));
    size_t n = 0, rows[PICKS_MAX];
    for (size_t i = 0; i < p->n; i++) {
        size_t before = 0;
        while (before < n && rows[before] != p->pick[i].row)
            before++;
        if (before == n)
            rows[n++] = p->pick[i].row;
    }
    return output_end(&o, export_designs(o.stream, run, EXPORT_FRONT, n, rows, err), err);
}

/* Values of n columns that begin at `first`; a column that is listed alone where `list` is given. */
static json_t *json_values(const Schema *schema, size_t first, size_t n, const size_t list[], const double values[])
{
    char word[KIND_WORD_MAX];
    json_t *o = json_object();
    for (size_t i = 0; i < n; i++) {
        const size_t k = list ? list[i] : i;
        const int is_word = first + k < schema->n_var && schema_word(schema, first + k, values[k], word);
        json_object_set_new(o, schema->column[first + k].name, is_word ? json_string(word) : json_number(values[k]));
    }
    return o;
}

static json_t *describe(const Run *run, const Picks *p)
{
    const Schema *s = &run->schema;
    json_t *picks = json_array();
    for (size_t i = 0; i < p->n; i++) {
        const Evaluation *e = &run->table.row[p->pick[i].row];
        double error[OBJECTIVES_MAX];
        json_t *pick = json_of("name=%s id=%ld objectives=%p limited=%p variables=%p", p->pick[i].name, e->id,
                               json_values(s, s->n_var, s->n_obj, NULL, run_f(run, p->pick[i].row)),
                               json_values(s, s->n_var + s->n_obj, s->n_limited, s->limited, e->extra),
                               json_values(s, 0, s->n_var, NULL, e->x));
        if (run_likely(run, p->pick[i].row, error))
            json_put(pick, "error=%p",
                     json_of("likely=%p unpredictable=%c", json_values(s, s->n_var, s->n_obj, NULL, error),
                             run_is_unpredictable(run, p->pick[i].row)));
        json_array_append_new(picks, pick);
    }
    return json_of("run=%s front=%ld within_limits=%ld designs=%p", run->folder, run->n_front, p->n_left, picks);
}

static Status show(const Args *args, const Run *run, const Picks *p, Err *err)
{
    const char *csv = args_value(args, "--csv");
    const int as_json = args_has(args, "--json"), as_table = !csv && !as_json;
    if (csv)
        TRY(write_csv(run, p, csv, err));
    if (args_has(args, "--json"))
        TRY(show_json(describe(run, p), err));
    else if (!csv)
        show_table(run, p);
    if (p->n_left == 0)
        return fail(err, STATUS_UNMET,
                    "no design of the front is within the limits; `imtet optimize` with search.limits looks for some");
    if (as_table)
        show_variables(run, p);
    return STATUS_OK;
}

static Status choose(const Args *args, Choice *c, Err *err)
{
    Picks picks;
    TRY(find_picks(args, c, &picks, err));
    return show(args, c->run, &picks, err);
}

static Status choose_of(const Args *args, const Run *run, Err *err)
{
    if (run->n_front == 0)
        return run_why_empty(run, err);
    Choice c = {.run = run, .box = run_box(run)};
    TRY_ROOM(c.allowed, run->table.n, "designs", err);
    const Status status = choose(args, &c, err);
    free(c.allowed);
    return status;
}

static const ArgOption OPTIONS[] = {
    VALUES("--max", "NAME=VALUE",
           "only designs whose NAME, an objective or another result, is no larger; may be repeated"),
    VALUES("--min", "NAME=VALUE", "the same, no smaller"),
    VALUE("--weights", "NAME=W,...", "the least weighted sum of objectives scaled to 0 (best) .. 1 (worst)"),
    VALUE("--reference", "NAME=VALUE,...", "reference point: the design nearest to these values"),
    VALUE("--csv", "FILE", "the designs chosen, as rows of front.csv, into FILE; -: standard output"),
    SWITCH("--json", "the designs chosen with their names, objectives and variables, on standard output"),
    OPTION_END,
};

const Command CMD_CHOOSE = {
    .name = "choose",
    .group = GROUP_DECIDE,
    .operand = "RUN...",
    .summary = "designs of a front by limits, weights or a reference point",
    .example = "imtet choose results/quick --max j3_g=5 --weights j1_m=2,mcore_kg=1",
    .details =

        "Picks designs from the front of the folder RUN, within the limits: the knee (nearest to the ideal\n"
        "point when every objective is scaled to 0..1 over the front), the best design of each objective, the\n"
        "best weighted one, and the one nearest to a reference point.\n"
        "Other commands accept a design by its id, RUN:417, and designs of the whole front by name: RUN:knee,\n"
        "RUN:best_j1_m.",
    .options = OPTIONS,
    .run_of = choose_of,
    .only_reads = 1,
};
