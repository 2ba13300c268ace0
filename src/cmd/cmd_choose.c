
#include "base/text.h"
#include "cmd/commands.h"
#include "cmd/designs.h"
#include "cmd/outputs.h"
#include "cmd/show.h"
#include "store/export.h"
#include "store/output.h"

typedef struct {
    const Run *run;
    FrontBox box;
    unsigned char *allowed; /* (run->table.n) */
} Choice;

/* Only designs within every --max and --min stay allowed. */
static Status apply_limits(const Args *args, Choice *c, size_t *n_left, Err *err)
{
    static const char *const LIMITS[] = {"--min", "--max"};
    const Run *run = c->run;
    const char *text;
    for (size_t i = 0; i < run->n_front; i++)
        c->allowed[run->front[i]] = 1;
    for (int is_max = 0; is_max < 2; is_max++)
        for (int next = 0; (text = args_next(args, LIMITS[is_max], &next));) {
            size_t k, n_known = 0;
            double limit;
            TRY(pair_take(&run->schema, LIMITS[is_max], text, &k, &limit, err));
            for (size_t i = 0; i < run->n_front; i++) {
                const double f = run_result(run, run->front[i], k);
                n_known += !isnan(f);
                if (!(is_max ? f <= limit : f >= limit))
                    c->allowed[run->front[i]] = 0;
            }
            if (n_known == 0)
                return fail(err, STATUS_UNMET, "%s: this run did not store %s: make it an objective or a limit",
                            LIMITS[is_max], schema_objective(&run->schema, k)->name);
        }
    *n_left = 0;
    for (size_t i = 0; i < run->n_front; i++)
        *n_left += c->allowed[run->front[i]];
    return STATUS_OK;
}

/* By weights of the scaled objectives, or (weights NULL) the square of the scaled distance to a point in natural signs,
 * NAN where the point has no value; point NULL: to the ideal one. */
static double cost_of(const Choice *c, size_t row, const double weights[], const double point[])
{
    double sum = 0;
    for (size_t k = 0; k < c->run->schema.n_obj; k++) {
        const double off = point ? (run_f(c->run, row)[k] - point[k]) / c->box.span[k] : 0;
        sum += weights ? weights[k] * run_scaled(c->run, &c->box, row, k) : isnan(off) ? 0 : off * off;
    }
    return weights || point ? sum : run_distance2(c->run, &c->box, row, c->run->table.n);
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
static void add_pick(const Choice *c, const char *name, const double weights[], const double point[], Picks *p)
{
    const Run *run = c->run;
    size_t best = run->table.n;
    for (size_t i = 0; i < run->n_front; i++) {
        const size_t row = run->front[i];
        if (c->allowed[row] &&
            (best == run->table.n || cost_of(c, row, weights, point) < cost_of(c, best, weights, point)))
            best = row;
    }
    snprintf(p->pick[p->n].name, sizeof p->pick[0].name, "%s", name);
    p->pick[p->n++].row = best;
}

static Status find_picks(const Args *args, Choice *c, Picks *p, Err *err)
{
    const Schema *schema = &c->run->schema;
    const char *weighted = args_value(args, "--weights"), *nearest = args_value(args, "--reference");
    double weights[OBJECTIVES_MAX] = {0}, reference[OBJECTIVES_MAX];
    p->n = 0;
    TRY(apply_limits(args, c, &p->n_left, err));
    for (size_t k = 0; k < schema->n_obj; k++)
        reference[k] = NAN;
    if (weighted) {
        TRY(pairs_take(schema, "--weights", weighted, NAN, weights, err));
        TRY(weights_check(schema, "--weights", weights, err));
    }
    TRY(nearest ? pairs_take(schema, "--reference", nearest, NAN, reference, err) : STATUS_OK);
    if (p->n_left == 0)
        return STATUS_OK;
    add_pick(c, "knee", NULL, NULL, p);
    for (size_t k = 0; k < schema->n_obj; k++) {
        char name[TABLE_NAME_MAX + 8];
        double alone[OBJECTIVES_MAX] = {0};
        snprintf(name, sizeof name, "best_%s", schema_objective(schema, k)->name);
        alone[k] = 1;
        add_pick(c, name, alone, NULL, p);
    }
    if (weighted)
        add_pick(c, "weighted", weights, NULL, p);
    if (nearest)
        add_pick(c, "nearest to reference", NULL, reference, p);
    return STATUS_OK;
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

static Status give(const Args *args, const Run *run, const Picks *p, Err *err)
{
    const Schema *s = &run->schema;
    char quoted[4 * PATH_MAX + 3];
    size_t n_unknown = 0, wanted = 0; /* wanted: the pick that was asked for, else the knee */
    json_t *picks = json_array(), *variables = json_array();
    Document d = {
        .data = json_of("run=%s front=%ld within_limits=%ld designs=%p", run->folder, run->n_front, p->n_left, picks)};
    document_say(&d, "%zu of %zu designs are within the limits", p->n_left, run->n_front);
    json_t *table = document_table(&d);
    for (size_t i = 0; i < p->n; i++) {
        const char *name = p->pick[i].name;
        const size_t row = p->pick[i].row;
        const Evaluation *e = &run->table.row[row];
        double error[OBJECTIVES_MAX];
        json_t *x = json_values(s, 0, s->n_var, NULL, e->x),
               *pick = json_of("name=%s id=%ld objectives=%p limited=%p variables=%p", name, e->id,
                               json_values(s, s->n_var, s->n_obj, NULL, run_f(run, row)),
                               json_values(s, s->n_var + s->n_obj, s->n_limited, s->limited, e->extra), x);
        if (run_likely(run, row, error))
            json_put(pick, "error=%p",
                     json_of("likely=%p unpredictable=%c", json_values(s, s->n_var, s->n_obj, NULL, error),
                             run_is_unpredictable(run, row)));
        json_array_append_new(picks, pick);
        figures_of_run(table, run, name, row);
        n_unknown += run->finer.n > 0 && !e->err;
        if (strncmp(name, "best_", 5) != 0) {
            json_object_update(json_put(figures_row(variables), "=%s", name), x);
            wanted = i;
        }
    }
    if (n_unknown > 0)
        document_say(&d, "%zu designs have no error estimate; `imtet evaluate %s --design ID` makes one", n_unknown,
                     run->id_step > 0 ? "RUN" : text_shell(run->folder, quoted));
    const size_t knee = run_knee(run);
    if (p->n > 0 && p->pick[0].row != knee)
        document_say(&d, "the knee within the limits is design %ld; %s:knee, of the whole front, is design %ld",
                     run->table.row[p->pick[0].row].id, run->folder, run->table.row[knee].id);
    json_array_extend(document_table(&d), variables);
    json_decref(variables);
    if (p->n > 0 && !outputs_standard(args, 0))
        document_verdict(&d, run, p->pick[wanted].row, NULL);
    Status status = args_has(args, "--csv") ? write_csv(run, p, args_value(args, "--csv"), err) : STATUS_OK;
    THEN(status, document_give(&d, args, err));
    document_free(&d);
    if (p->n_left == 0)
        THEN(status, fail(err, STATUS_UNMET,
                          "no design of the front is within the limits; search for some with search.limits"));
    return status;
}

static Status choose_of(const Args *args, const Run *run, Err *err)
{
    if (run->n_front == 0)
        return run_why_empty(run, err);
    Choice c = {.run = run, .box = run_box(run)};
    TRY_ROOM(c.allowed, run->table.n, "designs", err);
    Picks picks;
    Status status = find_picks(args, &c, &picks, err);
    THEN(status, give(args, run, &picks, err));
    free(c.allowed);
    return status;
}

const Command CMD_CHOOSE = {
    .name = "choose",
    .group = GROUP_DECIDE,
    .operand = "RUN...",
    .summary = "designs of a front by limits, weights or a reference point",
    .example = "imtet choose results/quick --max j3_g=5 --weights j1_m=2,mcore_kg=1",
    .details =

        "Picks designs from the front of the folder RUN, within the limits: the knee (nearest to the ideal\n"
        "point when every objective is scaled to 0..1 over the front), the best design of each objective, the\n"
        "best weighted one, and the one nearest to a reference point.\n\n"
        "Other commands accept a design by its id, RUN:417, and designs of the whole front by name: RUN:knee,\n"
        "RUN:best_j1_m.",
    .options =
        {
            VALUES("--max", "NAME=VALUE",
                   "only designs whose NAME (an objective or another result) is at most VALUE; may be repeated"),
            VALUES("--min", "NAME=VALUE", "only designs whose NAME is at least VALUE; may be repeated"),
            VALUE("--weights", "NAME=W,...",
                  "the design with the least weighted sum of objectives, each scaled to 0 (best) .. 1 (worst)"),
            VALUE("--reference", "NAME=VALUE,...", "the design nearest to these values (reference point)"),
            VALUE("--csv", "FILE", "the chosen designs as rows of front.csv into FILE; -: standard output"),
            SWITCH("--json", "the chosen designs with names, objectives and variables, as JSON on standard output"),
        },
    .run_of = choose_of,
};
