#include "base/list.h"
#include "cmd/commands.h"
#include "cmd/designs.h"
#include "cmd/improve.h"
#include "evaluate/limits.h"
#include "store/run_read.h"
#include "study/simplify.h"

static const double KEPT = 0.02, KEPT_OTHERS = 0.1;

/* "5" or "5mm", in m. */
static Status take_mm(const char *option, const char *text, double *value, Err *err)
{
    char *end;
    const double mm = strtod(text, &end);
    if (end == text || (*end && strcmp(end, "mm") != 0) || !(mm >= 0.1 && mm <= 1e4))
        return misused(err, "%s: '%.40s' is not a length in mm such as 5 or 5mm, from 0.1 to 10000", option, text);
    *value = 1e-3 * mm;
    return STATUS_OK;
}

static Status take_options(const Args *args, Improve *m, Err *err)
{
    const Schema *schema = &m->run.schema;
    const char *keep = args_value(args, "--keep"), *gap_step = args_value(args, "--gap-step");
    const char *plates = args_value(args, "--plates");
    char item[32];
    ImproveConfig *c = &m->config;
    long zones;
    for (size_t k = 0; k < schema->n_obj; k++)
        c->slack[k] = keep ? INFINITY : k == 0 ? KEPT : KEPT_OTHERS;
    if (keep)
        TRY(pairs_take(schema, "--keep", keep, KEPT, c->slack, err));
    for (size_t k = 0; k < schema->n_obj; k++)
        if (c->slack[k] < 0.0)
            return misused(err, "--keep: %s may lose %g of its value; give 0 or more",
                           schema_objective(schema, k)->name, c->slack[k]);
    TRY(args_whole(args, "--zones", 1, MAX_OF(schema->design.n_floors, 1), 0, &zones, err));
    c->zones = (int)zones;
    if (gap_step)
        TRY(take_mm("--gap-step", gap_step, &c->gap_step, err));
    c->n_plates = plates ? list_count(plates) : 0;
    if (c->n_plates > PLATES_MAX)
        return misused(err, "--plates: more than %d", PLATES_MAX);
    for (size_t i = 0; i < c->n_plates; i++) {
        if (!list_item(plates, i, item, sizeof item))
            return misused(err, "--plates: item %zu is empty or too long", i + 1);
        TRY(take_mm("--plates", item, &c->plate[i], err));
        if (i > 0 && c->plate[i] <= c->plate[i - 1])
            return misused(err, "--plates: give them in ascending order: %s stands behind a thicker one", item);
    }
    return STATUS_OK;
}

/* The path with its cost, which is returned; then every variable at its end, gaps and plates in mm. */
static json_t *say_path(Document *d, const Improve *m)
{
    static const char *const WORDS[] = {"as it is", "idle ones gone", "alike in zones",
                                        "on steps", "moved on steps", "fewer devices"};
    const Schema *s = &m->run.schema;
    const EvaluationTable *path = &m->result.designs;
    json_t *table = document_table(d), *variables = json_object();
    for (size_t i = 0; i < path->n; i++) {
        char label[96];
        const Evaluation *e = &path->row[i];
        snprintf(label, sizeof label, "%s: %g, %.4g", WORDS[i], schema_value(s, MEASURE_DEVICES, e->f, e->extra),
                 schema_value(s, MEASURE_COST, e->f, e->extra));
        if (i != SIMPLIFY_ZONES || m->config.zones > 0)
            improve_row(m, table, label, i, i == SIMPLIFY_START ? m->run.table.row[m->row].id : 0);
    }
    document_say(d, "behind the colon: devices, and the cost by design.prices");
    const double *x = path->row[path->n - 1].x;
    for (size_t j = 0; j < s->n_var; j++) {
        char text[KIND_WORD_MAX];
        const int is_gap = (int)j < s->design.n_gaps, is_length = (int)j < s->design.n_gaps + s->design.n_walls;
        if (!schema_word(s, j, x[j], text))
            snprintf(text, sizeof text, is_length ? "%g mm" : "%g", is_length ? 1e3 * x[j] : x[j]);
        json_object_set_new(variables, schema_variable(s, j)->name,
                            json_string(is_gap && x[j] >= DESIGN_OPEN_M ? "no stop" : text));
    }
    document_list(d, variables);
    if (path->row[0].violation > 0.0)
        document_say(d, "The design violates the limits of its run; the simplified one may too.");
    return table;
}

static int is_unmet(const Improve *m)
{
    return m->result.loss[m->result.designs.n - 1] > 1.0;
}

/* What the end of the path loses beyond what may be lost, and the --keep that would do; the limits that it breaks. */
static Status fail_unmet(const Improve *m, Err *err)
{
    const Schema *s = &m->run.schema;
    const EvaluationTable *path = &m->result.designs;
    const Evaluation *start = path->row, *last = &path->row[path->n - 1];
    const int breaks_limits = last->violation > start->violation;
    char lost[200] = "", keep[200] = "";
    double g[LIMITS_MAX];
    Limits limits;
    for (size_t k = 0; k < s->n_obj; k++) {
        const Column *objective = schema_objective(s, k);
        const double may = m->config.slack[k];
        const double loses = objective->sense * (last->f[k] - start->f[k]) / fmax(fabs(start->f[k]), 1e-300);
        const size_t n = strlen(lost), n_keep = strlen(keep);
        if (!isfinite(may))
            continue;
        if (loses > may)
            snprintf(lost + n, sizeof lost - n, "%s%s loses %.2g %% (%.2g %% may be lost)", n ? ", " : "",
                     objective->name, 100 * loses, 100 * may);
        snprintf(keep + n_keep, sizeof keep - n_keep, "%s%s=%.4g", n_keep ? "," : "", objective->name,
                 fmax(may, ceil(1e3 * loses) / 1e3));
    }
    TRY(limits_read(&limits, s, m->run.settings->search.limits, err));
    limits_apply(&limits, s->n_obj, last, g);
    for (size_t i = 0; i < limits.n && breaks_limits; i++) {
        const size_t n = strlen(lost), r = limits.limit[i].result;
        if (g[i] > 0)
            snprintf(lost + n, sizeof lost - n, "%s%s misses its limit by %.2g %%", n ? ", " : "",
                     s->column[s->n_var + r].name, 100 * g[i]);
    }
    return fail(err, STATUS_UNMET, "%s: the best design on these steps is design %ld, but %s; %s%s", m->run.folder,
                m->id, lost, breaks_limits ? "take finer steps or more plates" : "this would do: --keep ",
                breaks_limits ? "" : keep);
}

static Status work(const Args *args, Improve *m, Err *err)
{
    TRY(take_options(args, m, err));
    if (m->run.settings->problem.kind != PROBLEM_TOWER)
        return bad_data(err, "%s: simplify needs a tower, with gaps and plates", m->run.folder);
    TRY(improve_design(&m->run, m->row, &m->config, simplify_design, &m->result, err));
    Document d = {0};
    json_t *path = say_path(&d, m);

    /* The end of the path is stored, marked where it does not keep what is to be kept, unless the run has it: who asks
     * for the same a second time gets the same answer. */
    const EvaluationTable *has = &m->run.table;
    Evaluation *last = &m->result.designs.row[m->result.designs.n - 1];
    char reason[64];
    Status status = STATUS_OK;
    for (size_t i = 0; i < has->n && m->id == 0; i++)
        if (memcmp(last->x, has->row[i].x, has->n_var * sizeof *last->x) == 0)
            m->id = has->row[i].id;
    snprintf(reason, sizeof reason, "%s%ld%s", SIMPLIFIED_FROM, has->row[m->row].id,
             is_unmet(m) ? " beyond --keep" : "");
    last->reason = reason;
    if (m->id == 0)
        status = improve_store(m, last, err);
    improve_say(&d, m);
    d.data = json_of("design=%ld path=%p", m->id, json_plain(path));
    if (!args_has(args, "--json")) {
        Run now; /* the run has changed since it was read */
        THEN(status, run_read(&now, m->run.folder, err));
        if (status == STATUS_OK) {
            document_verdict(&d, &now, run_find(&now, m->id), m->run.settings);
            run_free(&now);
        }
    }
    THEN(status, document_give(&d, args, err));
    document_free(&d);
    return status == STATUS_OK && is_unmet(m) ? fail_unmet(m, err) : status;
}

static Status run(const Args *args, Err *err)
{
    return improve_run(args, work, err);
}

const Command CMD_SIMPLIFY = {
    .name = "simplify",
    .group = GROUP_DECIDE,
    .operand = "RUN",
    .summary = "a design that can be built: fewer stops, standard gaps, stock plates",
    .example = "imtet simplify results/kobe --design knee --gap-step 5 --plates 8,10,12,15,20 --keep j1_m=0.02",
    .details = "Makes a design (default: the knee) easier to build, step by step: it removes stops that never\n"
               "close, makes the floors of a zone alike, rounds gaps and walls to steps, moves them on these steps,\n"
               "and removes devices while --keep holds. Each step is simulated under all records of RUN. Prints the\n"
               "path and stores its end in the run; its kind is polished. An end that loses more than --keep allows\n"
               "is marked (exit status 69), and the --keep that would do is named.",
    .options =
        {
            VALUE("--design", "ID", DESIGN_OF_RUN),
            VALUE("--zones", "N", "make the floors of each of N zones alike; default: they stay as they are"),
            VALUE("--gap-step", "MM", "round gaps to multiples of it; default: they stay"),
            VALUE("--plates", "MM,MM,...", "choose walls from these; default: they stay"),
            VALUE("--keep", "NAME[=S],...",
                  "objectives that may lose the share S of their value (2% without =S); default: the first 2%, others "
                  "10%"),
            OPTION_JSON,
            OPTION_MOVED,
        },
    .run = run,
};
