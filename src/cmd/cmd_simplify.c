#include "base/list.h"
#include "cmd/commands.h"
#include "cmd/designs.h"
#include "cmd/improve.h"
#include "cmd/show.h"
#include "study/simplify.h"

static const double KEPT = 0.02, KEPT_OTHERS = 0.1;

typedef struct {
    Improve from;
    const Run *run; /* of it */
    SimplifyConfig config;
    Simplified result;
} Work;

/* "5" or "5mm", in m. */
static Status take_mm(const char *option, const char *text, double *value, Err *err)
{
    char *end;
    const double mm = strtod(text, &end);
    if (end == text || (*end && strcmp(end, "mm") != 0) || !(mm >= 0.1 && mm <= 1e4))
        return misused(err, "%s: '%.40s' is no length in mm, as 5 or 5mm, from 0.1 to 10000", option, text);
    *value = 1e-3 * mm;
    return STATUS_OK;
}

static Status take_plates(const char *list, SimplifyConfig *c, Err *err)
{
    char item[32];
    c->n_plates = list_count(list);
    if (c->n_plates > PLATES_MAX)
        return misused(err, "--plates: more than %d", PLATES_MAX);
    for (size_t i = 0; i < c->n_plates; i++) {
        if (!list_item(list, i, item, sizeof item))
            return misused(err, "--plates: item %zu is empty or too long", i + 1);
        TRY(take_mm("--plates", item, &c->plate[i], err));
        if (i > 0 && c->plate[i] <= c->plate[i - 1])
            return misused(err, "--plates: give them in ascending order: %s stands behind a thicker one", item);
    }
    return STATUS_OK;
}

static Status take_options(const Args *args, Work *w, Err *err)
{
    const Schema *schema = &w->run->schema;
    SimplifyConfig *c = &w->config;
    for (size_t k = 0; k < schema->n_obj; k++)
        c->slack[k] = args_has(args, "--keep") ? INFINITY : k == 0 ? KEPT : KEPT_OTHERS;
    if (args_has(args, "--keep"))
        TRY(pairs_take(schema, "--keep", args_value(args, "--keep"), KEPT, c->slack, err));
    for (size_t k = 0; k < schema->n_obj; k++)
        if (c->slack[k] < 0.0)
            return misused(err, "--keep: %s may lose %g of its value; give 0 or more",
                           schema_objective(schema, k)->name, c->slack[k]);
    long zones;
    TRY(args_whole(args, "--zones", 1, MAX_OF(schema->design.n_floors, 1), 0, &zones, err));
    c->zones = (int)zones;
    if (args_has(args, "--gap-step"))
        TRY(take_mm("--gap-step", args_value(args, "--gap-step"), &c->gap_step, err));
    return args_has(args, "--plates") ? take_plates(args_value(args, "--plates"), c, err) : STATUS_OK;
}

static void show_path(const Work *w)
{
    static const char *const WORDS[] = {"as it is", "idle ones gone", "alike in zones",
                                        "on steps", "moved on steps", "fewer devices"};
    const Simplified *r = &w->result;
    json_t *table = json_array();
    for (size_t i = 0; i < r->n; i++) {
        char label[96];
        const Evaluation *e = &r->designs.row[i];
        if (i == SIMPLIFY_ZONES && w->config.zones == 0)
            continue;
        snprintf(label, sizeof label, "%s: %g, %.4g", WORDS[i],
                 schema_value(&w->run->schema, MEASURE_DEVICES, e->f, e->extra),
                 schema_value(&w->run->schema, MEASURE_COST, e->f, e->extra));
        figures_design(table, label, 0, &w->run->schema, e->f, r->error[i], e->sd, e->extra);
    }
    figures_print(table);
    puts("behind the colon: devices, and the cost by design.prices");
}

/* Name and number of every variable, gaps and plates in mm. */
static void show_design(const Work *w, const double x[])
{
    const Schema *s = &w->run->schema;
    putchar('\n');
    char text[KIND_WORD_MAX];
    for (size_t j = 0; j < s->n_var; j++) {
        const int is_length = (int)j < s->design.n_gaps + s->design.n_walls;
        if (!schema_word(s, j, x[j], text))
            snprintf(text, sizeof text, is_length ? "%g mm" : "%g", is_length ? 1e3 * x[j] : x[j]);
        printf("%-20s %s\n", schema_variable(s, j)->name,
               (int)j < s->design.n_gaps && x[j] >= DESIGN_OPEN_M ? "no stop" : text);
    }
}

/* The design of the run that the end of the path is; 0: it has none such. */
static long known_id(const Work *w)
{
    const Simplified *r = &w->result;
    const EvaluationTable *has = &w->run->table;
    for (size_t i = 0; i < has->n; i++)
        if (memcmp(r->designs.row[r->n - 1].x, has->row[i].x, w->run->schema.n_var * sizeof(double)) == 0)
            return has->row[i].id;
    return 0;
}

static Status store_end(Work *w, Err *err)
{
    const Simplified *r = &w->result;
    Evaluation *last = &r->designs.row[r->n - 1];
    const long known = known_id(w);
    char reason[48];
    if (r->loss[r->n - 1] > 1.0)
        return fail(err, STATUS_UNMET,
                    "%s: not stored: on these steps it loses more than may be lost, or violates limits: finer steps, "
                    "more plates or another --keep",
                    w->run->folder);
    if (known) { /* as where the same is asked for a second time */
        printf("it is design %ld of the run: nothing new to store.\n", known);
        return STATUS_OK;
    }
    snprintf(reason, sizeof reason, "%s%ld", SIMPLIFIED_FROM, w->run->table.row[w->from.row].id);
    last->reason = reason;
    TRY(improve_store(&w->from, last, err));
    improve_say(&w->from);
    return STATUS_OK;
}

static Status simplify(const Args *args, Work *w, Err *err)
{
    const char *word = args_value(args, "--design");
    TRY(improve_open(&w->from, args, word ? word : "knee", err));
    w->run = &w->from.run;
    TRY(take_options(args, w, err));
    TRY(simplify_design(w->run, w->from.row, &w->config, &w->result, err));
    const Simplified *r = &w->result;
    printf("design %ld of %s, %zu designs simulated, %.1f s\n\n", w->run->table.row[w->from.row].id, w->run->folder,
           r->n_evaluated, r->seconds);
    show_path(w);
    show_design(w, r->designs.row[r->n - 1].x);
    putchar('\n');
    if (r->designs.row[0].violation > 0.0)
        puts("The design violates the limits of its run, and so may what is made of it.");
    return store_end(w, err);
}

static Status run(const Args *args, Err *err)
{
    Work w = {0};
    const Status status = simplify(args, &w, err);
    simplified_free(&w.result);
    improve_close(&w.from);
    return status;
}

static const ArgOption OPTIONS[] = {
    VALUE("--design", "ID", DESIGN_OF_RUN),
    VALUE("--zones", "N", "floors of each of so many zones become alike; each stays as it is if not given"),
    VALUE("--gap-step", "MM", "gaps become multiples of it; they stay if not given"),
    VALUE("--plates", "MM,MM,...", "walls become one of these; they stay if not given"),
    VALUE(
        "--keep", "NAME[=S],...",
        "these may lose the share S of their value, 2% where none is given; if not given the first 2%, all others 10%"),
    OPTION_MOVED,
    OPTION_END,
};

const Command CMD_SIMPLIFY = {
    .name = "simplify",
    .group = GROUP_DECIDE,
    .operand = "RUN",
    .summary = "a design that can be built: fewer stops, gaps and plates as sold",
    .example = "imtet simplify results/kobe --design knee --gap-step 5 --plates 8,10,12,15,20 --keep j1_m=0.02",
    .details =
        "Takes out stops that never close, makes the floors of a zone alike, puts gaps and walls on steps, moves\n"
        "them on these, and takes out devices that earn less than --keep, each simulated under all records of RUN. "
        "Prints the path; the end goes into the\n"
        "run as a design of the kind polished.",
    .options = OPTIONS,
    .run = run,
};
