#include "cmd/designs.h"

#include <sys/stat.h>

#include "cmd/show.h"
#include "evaluate/measures.h"
#include "store/folder.h"
#include "store/run_read.h"
#include "study/initial_designs.h"
#include "study/record_paths.h"

/* -- tables -------------------------------------------------------------------------------------------------------- */

/* Of a table of a run the columns of variables alone, in their order; a gap that is none of them is no result. */
static Status drop_results(Table *t, const char *path, const DesignSpace *space, Err *err)
{
    size_t kept = 0;
    char name[TABLE_NAME_MAX] = "";
    for (size_t c = 0; c < t->n_cols; c++) {
        for (int v = 0; v < space->n_var && strcmp(name, t->names[c]) != 0; v++)
            design_variable_name(space, v, name);
        if (strncmp(t->names[c], "gap", 3) == 0 && strcmp(name, t->names[c]) != 0)
            return bad_data(
                err,
                "%s: column %s belongs to another building or other design.variables: a design of these %d floors "
                "has no such column",
                path, t->names[c], space->n_floors);
    }
    for (int v = 0; v < space->n_var; v++) {
        design_variable_name(space, v, name);
        const int from = table_column(t, name);
        if (from < (int)kept)
            return bad_data(err, "%s: column %s is missing, which a design of %d floors has (design.variables)", path,
                            name, space->n_floors);
        for (size_t i = 0; i < t->n_rows; i++)
            t->values[i * t->n_cols + kept] = t->values[i * t->n_cols + from];
        snprintf(t->names[kept++], TABLE_NAME_MAX, "%s", name);
    }
    for (size_t i = 0; i < t->n_rows; i++)
        memmove(t->values + i * kept, t->values + i * t->n_cols, kept * sizeof *t->values);
    t->n_cols = kept;
    return STATUS_OK;
}

long design_number(const Designs *d, size_t i)
{
    return d->id ? d->id[i] : (long)i + 1;
}

/* The row of that number becomes the only one. */
static Status choose_row(Designs *d, const char *path, const char *choice, Err *err)
{
    char *end;
    const size_t n_var = d->space.n_var;
    const long wanted = strtol(choice, &end, 10);
    if (end == choice || *end)
        return bad_data(err, "%s:%.40s: a design of a file is chosen by its %s", path, choice,
                        d->id ? "id" : "row, from 1");
    for (size_t i = 0; i < d->n; i++)
        if (design_number(d, i) == wanted) {
            memmove(d->x, d->x + i * n_var, n_var * sizeof *d->x);
            d->line[0] = d->line[i];
            if (d->id)
                d->id[0] = d->id[i];
            d->n = 1;
            return STATUS_OK;
        }
    return bad_data(err, "%s: has no design %s%ld; it holds %zu", path, d->id ? "of id " : "", wanted, d->n);
}

/* A table with a column id is one of a run. */
static Status take_file(Designs *d, const char *path, const char *choice, const DesignSpace *space, Err *err)
{
    Table t;
    long *ids = NULL;
    Status status = design_table_read(&t, path, space, err);
    if (status == STATUS_MISSING && !strchr(path, '/') && !choice)
        return fail(err, status, "--design %s: there is no such file; a design is " DESIGN_WORDS, path);
    TRY(status);
    const int column = table_column(&t, "id");
    if (column >= 0) {
        ids = calloc(t.n_rows + 1, sizeof *ids);
        for (size_t i = 0; ids && i < t.n_rows; i++) {
            const double id = t.values[i * t.n_cols + column];
            ids[i] = isfinite(id) ? (long)id : 0;
        }
        status = ids ? drop_results(&t, path, space, err) : fail_memory(err, t.n_rows, "designs");
    }
    THEN(status, design_of_table(d, &t, path, space, err));
    table_free(&t);
    d->id = ids;
    return choice && status == STATUS_OK ? choose_row(d, path, choice, err) : status;
}

/* -- runs ---------------------------------------------------------------------------------------------------------- */

typedef struct {
    char path[PATH_MAX];
    const char *choice; /* behind the last colon; of a run the knee where there is none, else NULL */
    int is_run;
} Place;

static Status copy_row(Designs *d, const Run *run, size_t row, Err *err)
{
    const size_t n_var = run->schema.n_var;
    *d = (Designs){.n = 1, .space = run->schema.design};
    TRY_ROOM(d->x, n_var, "variables", err);
    TRY_ROOM(d->line, 1, "a design", err);
    TRY_ROOM(d->id, 1, "a design", err);
    memcpy(d->x, run_x(run, row), n_var * sizeof *d->x);
    d->id[0] = run->table.row[row].id;
    d->line[0] = (int)d->id[0];
    return STATUS_OK;
}

static Status check_space(const Run *run, const char *folder, const DesignSpace *space, Err *err)
{
    char name[TABLE_NAME_MAX];
    const size_t n_var = run->schema.n_var;
    for (size_t j = 0; j < n_var && (int)j < space->n_var; j++) {
        design_variable_name(space, (int)j, name);
        if (strcmp(schema_variable(&run->schema, j)->name, name) != 0)
            return bad_data(err, "%s: variable %zu of its designs is %s, here it is %s (design.variables)", folder,
                            j + 1, schema_variable(&run->schema, j)->name, name);
    }
    return n_var == (size_t)space->n_var
               ? STATUS_OK
               : bad_data(err,
                          "%s: its designs have %zu variables; designs of this building of %d floors have %d "
                          "(design.variables)",
                          folder, n_var, space->n_floors, space->n_var);
}

void known_of_run(const Run *run, size_t row, Known known[])
{
    const Schema *s = &run->schema;
    for (size_t k = 0; run_is_unpredictable(run, row) && k < s->n_obj + s->n_extra; k++)
        known[s->order.of[k]] = (Known){run_result(run, row, k), run->table.row[row].err[k]};
}

/* Said is where a motion has changed, for then the run knows of another simulation, and where the run knows the design
 * by other steps than those of its settings. */
static Status take_from_run(Designs *d, const Place *p, const DesignSpace *space, Settings *s, int as_known,
                            Known known[], Err *err)
{
    Run run;
    size_t row;
    Err why = {0};
    TRY(run_read(&run, p->path, err));
    Status status = run_pick(&run, p->choice, &row, err);
    THEN(status, check_space(&run, p->path, space, err));
    THEN(status, copy_row(d, &run, row, err));
    if (status == STATUS_OK && s && record_paths_check(s, &run, &why) == STATUS_BAD_DATA)
        fprintf(stderr, "note: %s\n", why.text);
    if (status == STATUS_OK && s && as_known) {
        const double before = s->sim.steps_per_contact;
        run_steps(&run, row, &s->sim);
        if (s->sim.steps_per_contact != before)
            fprintf(stderr, "design %ld: simulated with %g times the steps of sim.accuracy, as in the run\n", *d->id,
                    ldexp(1.0, (int)run.table.row[row].level));
        if (known)
            known_of_run(&run, row, known);
    }
    run_free(&run);
    return status;
}

/* -- words --------------------------------------------------------------------------------------------------------- */

static int is_there(const char *word, size_t length, Place *p)
{
    struct stat s;
    if (length >= sizeof p->path)
        return 0;
    snprintf(p->path, sizeof p->path, "%.*s", (int)length, word);
    return stat(p->path, &s) == 0;
}

/* FILE or RUN, with or without a choice; a path with a colon in it is taken whole where it is there. */
static void find_place(const char *word, Place *p)
{
    const char *colon = strrchr(word, ':');
    p->choice = NULL;
    if (!is_there(word, strlen(word), p) && colon && colon > word) {
        is_there(word, colon - word, p);
        p->choice = colon + 1;
    }
    p->is_run = run_drop_name(p->path) || run_is_there(p->path);
    if (p->is_run && !p->choice)
        p->choice = "knee";
}

Status designs_take(Designs *d, const char *word, const DesignSpace *space, Settings *s, int as_known, Known known[],
                    Err *err)
{
    Place p;
    struct stat there;
    memset(d, 0, sizeof *d);
    if (strlen(word) >= sizeof p.path)
        return fail(err, STATUS_MISSING, "%.60s...: the path is too long", word);
    find_place(word, &p);
    if (!p.is_run && stat(p.path, &there) == 0 && S_ISDIR(there.st_mode))
        return fail(err, STATUS_MISSING, "%.200s: holds no run: run.sqlite is missing", p.path);
    const Status status =
        p.is_run ? take_from_run(d, &p, space, s, as_known, known, err) : take_file(d, p.path, p.choice, space, err);
    if (status != STATUS_OK)
        design_free(d);
    return status;
}

/* -- of problems that are no tower --------------------------------------------------------------------------------- */

Status designs_of_problem(Designs *d, const char *word, const Schema *schema, Err *err)
{
    Place p;
    Run run;
    size_t row;
    *d = (Designs){0};
    find_place(word, &p);
    if (p.is_run) {
        TRY(run_read(&run, p.path, err));
        Status status = run_pick(&run, p.choice, &row, err);
        THEN(status, initial_designs_fit(&run, "--design", schema, err));
        THEN(status, copy_row(d, &run, row, err));
        d->space.n_var = (int)schema->n_var;
        run_free(&run);
        return status;
    }
    TRY(initial_designs_read("--design", p.path, schema, &d->x, &d->n, err));
    d->space.n_var = (int)schema->n_var;
    TRY_ROOM(d->line, d->n, "designs", err);
    return p.choice ? choose_row(d, p.path, p.choice, err) : STATUS_OK;
}

Status designs_take_one(Designs *d, const char *word, const DesignSpace *space, Settings *s, int as_known,
                        Known known[], Err *err)
{
    TRY(designs_take(d, word, space, s, as_known, known, err));
    const size_t n = d->n;
    const long first = design_number(d, 0);
    if (n == 1)
        return STATUS_OK;
    design_free(d);
    return misused(err, "--design %s: holds %zu designs; choose one of them: %s:%ld", word, n, word, first);
}

void known_raise(const Known known[], const SimResult *r, double sd[])
{
    for (int k = 0; k < N_MEASURES; k++)
        if (known[k].sd > 0 && fabs(measure_value(r, k) - known[k].value) <= known[k].sd)
            sd[k] = fmax(sd[k], known[k].sd);
}

void design_label(const Designs *d, const char *word, size_t i, char label[DESIGN_LABEL_MAX])
{
    const char *name = d->id ? word : basename(word);
    if (d->n == 0)
        snprintf(label, DESIGN_LABEL_MAX, "no core");
    else if (d->id)
        snprintf(label, DESIGN_LABEL_MAX, "design %ld", d->id[i]);
    else if (d->n == 1 && strchr(name, ':'))
        snprintf(label, DESIGN_LABEL_MAX, "%s", name);
    else
        snprintf(label, DESIGN_LABEL_MAX, "%.120s:%zu", name, i + 1);
}

Status design_of_run(const Run *run, const char *word, size_t *row, Designs *elsewhere, Err *err)
{
    struct stat s;
    Designs d;
    const int is_name = strspn(word, "0123456789") == strlen(word) || strcmp(word, "knee") == 0 ||
                        strncmp(word, "best_", 5) == 0; /* what only a run can have */
    if (elsewhere)
        *elsewhere = (Designs){0};
    if (is_name || (!strpbrk(word, "/:.") && stat(word, &s) != 0))
        return run_pick(run, word, row, err);
    TRY(designs_take_one(&d, word, &run->schema.design, NULL, 0, NULL, err));
    const size_t size = run->schema.n_var * sizeof *d.x; /* one of the front first */
    size_t i = 0;
    for (*row = run->table.n; i < run->n_front + run->table.n && *row == run->table.n; i++) {
        const size_t at = i < run->n_front ? run->front[i] : i - run->n_front;
        if (memcmp(run_x(run, at), d.x, size) == 0)
            *row = at;
    }
    if (*row == run->table.n && elsewhere) {
        *elsewhere = d;
        return STATUS_OK;
    }
    design_free(&d);
    return *row < run->table.n ? STATUS_OK : bad_data(err, "%s: is not a design of %s", word, run->folder);
}

/* -- results by name ----------------------------------------------------------------------------------------------- */

static Status split(const char *option, const char *text, double otherwise, char name[TABLE_NAME_MAX], double *value,
                    Err *err)
{
    char *end;
    const size_t length = strcspn(text, "=");
    if (length >= TABLE_NAME_MAX || (!text[length] && isnan(otherwise)))
        return misused(err, "%s: '%.60s' is not NAME=NUMBER", option, text);
    snprintf(name, TABLE_NAME_MAX, "%.*s", (int)length, text);
    *value = text[length] ? strtod(text + length + 1, &end) : otherwise;
    if (text[length] && end > text + length + 1 && *end == '%') {
        *value *= 0.01;
        end++;
    }
    if (text[length] && (end == text + length + 1 || *end || !isfinite(*value)))
        return misused(err, "%s: '%.60s' has no number behind =", option, text);
    return STATUS_OK;
}

Status pair_take(const Schema *schema, const char *option, const char *text, size_t *k, double *value, Err *err)
{
    char name[TABLE_NAME_MAX];
    TRY(split(option, text, NAN, name, value, err));
    return schema_pick(schema, schema->n_obj + schema->n_extra, option, name, k, err);
}

Status pairs_take(const Schema *schema, const char *option, const char *list, double otherwise, double values[],
                  Err *err)
{
    char item[TABLE_NAME_MAX + 40], name[TABLE_NAME_MAX];
    for (size_t j = 0; j < list_count(list); j++) {
        size_t k;
        double value;
        if (!list_item(list, j, item, sizeof item))
            return misused(err, "%s: item %zu is empty or too long", option, j + 1);
        TRY(split(option, item, otherwise, name, &value, err));
        TRY(schema_pick(schema, schema->n_obj, option, name, &k, err));
        values[k] = value;
    }
    return STATUS_OK;
}

/* A negative one would ask for the worst; nothing but zeros asks for nothing. */
Status weights_check(const Schema *schema, const char *option, const double weights[], Err *err)
{
    double sum = 0;
    for (size_t k = 0; k < schema->n_obj; k++) {
        if (weights[k] < 0)
            return misused(err, "%s: %s=%g is negative; a positive weight already asks for a better value", option,
                           schema_objective(schema, k)->name, weights[k]);
        sum += weights[k];
    }
    return sum > 0 ? STATUS_OK : misused(err, "%s: all of them are 0", option);
}

void figures_of_run(json_t *table, const Run *run, const char *label, size_t row)
{
    const Evaluation *e = &run->table.row[row];
    double error[OBJECTIVES_MAX];
    run_likely(run, row, error);
    json_t *shown = figures_design(table, label, e->id, &run->schema, run_f(run, row), error, e->sd, e->extra);
    if (run_is_unpredictable(run, row))
        json_put(shown, " =%s", "unpredictable");
}
