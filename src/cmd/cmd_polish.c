#include "cmd/commands.h"
#include "cmd/designs.h"
#include "cmd/improve.h"
#include "study/polish.h"

static Status take_options(const Args *args, Improve *m, Err *err)
{
    const Schema *schema = &m->run.schema;
    const char *improve = args_value(args, "--improve"), *keep = args_value(args, "--keep");
    ImproveConfig *c = &m->config;
    TRY(polish_allows(m->run.settings, err));
    for (size_t k = 0; k < schema->n_obj; k++) {
        c->weight[k] = improve ? strcmp(improve, "all") == 0 : k == 0;
        c->slack[k] = keep && strcmp(keep, "all") != 0 ? INFINITY : -1.0;
    }
    if (improve && strcmp(improve, "all") != 0)
        TRY(pairs_take(schema, "--improve", improve, 1.0, c->weight, err));
    if (keep && strcmp(keep, "all") != 0)
        TRY(pairs_take(schema, "--keep", keep, -1.0, c->slack, err));
    TRY(weights_check(schema, "--improve", c->weight, err));
    long evals;
    TRY(args_whole(args, "--max-evals", 1, 1000000, 300, &evals, err));
    TRY(args_whole(args, "--replicates", 1, 1000, 4, &c->replicates, err));
    const size_t needed = polish_evals_min(m->run.settings, c->replicates);
    if ((size_t)evals < needed)
        return misused(
            err, "--max-evals must be at least %zu with these --replicates (for a tower 6 times as many), and is %ld",
            needed, evals);
    c->max_evals = evals;
    return STATUS_OK;
}

static void put_objectives(json_t *row, const Schema *schema, const char *end, const double values[])
{
    char name[TABLE_NAME_MAX + 16];
    for (size_t k = 0; k < schema->n_obj && isfinite(values[0]); k++) {
        snprintf(name, sizeof name, "%s%s", schema_objective(schema, k)->name, end);
        json_object_set_new(row, name, json_number(values[k]));
    }
}

static const char *verdict_of(const Improved *r)
{
    return !r->has_changed        ? "No improvement was found that keeps the other objectives."
           : !r->keeps            ? "The improvement does not keep the other objectives when it is simulated again."
           : isnan(r->gain_error) ? "The spread is unknown, because each design was simulated once."
           : polish_counts(r)     ? "Confirmed by new simulations: the gain is more than the standard deviation."
           : r->gain > fmax(POLISH_GAIN_MIN, 2.0 * r->gain_error)
               ? "The gain is not more than the standard deviation at twice the steps."
           : r->gain <= POLISH_GAIN_MIN ? "The gain in new simulations is less than 0.1 % of the range of the front."
                                        : "The gain in new simulations is not more than the standard deviation.";
}

/* Both designs, the gain of every objective that was to be improved, what is to be thought of it, and the cost. */
static Status work(const Args *args, Improve *m, Err *err)
{
    const Improved *r = &m->result;
    TRY(take_options(args, m, err));
    TRY(improve_design(&m->run, m->row, &m->config, polish_design, &m->result, err));
    const Evaluation *before = &r->designs.row[POLISH_BEFORE], *end = &r->designs.row[POLISH_END];
    if (polish_counts(r))
        TRY(improve_store(m, end, err));

    /* One row in natural signs: the polished design as in front.csv but for the id of the design that it came from;
     * then of every objective how it was before, and where they are known the standard deviations of both and the
     * likely error. */
    const Schema *schema = &m->run.schema;
    const long from = m->run.table.row[m->row].id;
    json_t *rows = json_array(), *row = json_put(figures_row(rows), "polished_from=%ld", from);
    for (size_t j = 0; j < schema->n_var; j++)
        json_object_set_new(row, schema_variable(schema, j)->name, json_number(end->x[j]));
    for (size_t k = 0; k < schema->n_obj; k++)
        json_object_set_new(row, schema_objective(schema, k)->name, json_number(end->f[k]));
    put_objectives(row, schema, "_before", before->f);
    put_objectives(row, schema, "_before_sd", before->sd);
    put_objectives(row, schema, "_sd", end->sd);
    put_objectives(row, schema, "_error", m->result.error[POLISH_END]);
    Document d = {.data = json_of("design=%ld verdict=%s tried=%zu simulated=%zu failed=%zu seconds=%g polished=%p",
                                  m->id, verdict_of(r), r->cost.n_evaluated, r->cost.n_simulated, r->cost.n_failed,
                                  r->cost.seconds, json_incref(rows)),
                  .rows = rows};
    json_t *table = document_table(&d);
    improve_row(m, table, "before", POLISH_BEFORE, from);
    if (r->has_changed)
        improve_row(m, table, "polished", POLISH_END, m->id);
    for (size_t k = 0; r->has_changed && k < schema->n_obj; k++) {
        const Column *c = schema_objective(schema, k);
        const double gain = c->sense * (before->f[k] - end->f[k]);
        const double error = hypot(before->sd[k], end->sd[k]) / sqrt((double)m->config.replicates);
        char known[60] = "";
        if (isfinite(error))
            snprintf(known, sizeof known, " with a standard error of %.2g", error);
        if (m->config.weight[k] > 0.0)
            document_say(&d, "%s is %s by %.3g%s", c->name, gain < 0.0 ? "worse" : "better", fabs(gain), known);
    }
    document_say(&d, "%s", verdict_of(r));
    improve_say(&d, m);
    return document_give(&d, args, err);
}

static Status run(const Args *args, Err *err)
{
    return improve_run(args, work, err);
}

const Command CMD_POLISH = {
    .name = "polish",
    .group = GROUP_STUDY,
    .operand = "RUN",
    .summary = "improve objectives of a design and keep the others",
    .example = "imtet polish results/quick --design knee --improve j2_m",
    .details =

        "Improves objectives of a design of RUN (default: the knee) by NLopt on the simulator. The other\n"
        "objectives get no worse than their spread. At the end both designs are simulated again. If the gain\n"
        "exceeds the standard deviation, the new design is stored in the run; its kind is polished.",
    .options =
        {
            VALUE("--design", "ID", DESIGN_OF_RUN),
            VALUE("--improve", "NAME[=W],...",
                  "objectives to improve, with weights in ranges of the front, or all; default: the first objective"),
            VALUE("--keep", "NAME[=S],...",
                  "objectives that lose at most their standard deviation, or the share S of their value; default: all"),
            VALUE("--max-evals", "N", "largest number of simulations; default: 300"),
            VALUE("--replicates", "N",
                  "simulations of a noisy design, such as a tower's, that are averaged; default: 4"),
            VALUE("--csv", "FILE",
                  "the polished design, its objectives before and after, their errors, into FILE; -: standard output"),
            OPTION_JSON,
            OPTION_MOVED,
        },
    .run = run,
};
