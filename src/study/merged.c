#include "study/merged.h"

#include <stdarg.h>

#include "settings/settings.h"
#include "store/provenance.h"
#include "store/run_read.h"

/* -- one problem --------------------------------------------------------------------------------------------------- */

static int is_of_problem(const char *key)
{
    static const char *const OTHERS[] = {"run.",          "problem.command", "problem.timeout_s", "sim.threads",
                                         "motion.record", "motion.forces",   "building.model"}; /* files by content */
    int is =
        strncmp(key, "search.", 7) != 0 || strcmp(key, "search.objectives") == 0 || strcmp(key, "search.limits") == 0;
    for (size_t i = 0; i < N_OF(OTHERS); i++)
        is &= strncmp(key, OTHERS[i], strlen(OTHERS[i])) != 0;
    return is;
}

typedef struct {
    char text[300];
    size_t n;
} Listed;

__attribute__((format(printf, 2, 3))) static void list(Listed *l, const char *format, ...)
{
    va_list values;
    va_start(values, format);
    if (l->n > 0 && l->n < sizeof l->text)
        l->n += (size_t)snprintf(l->text + l->n, sizeof l->text - l->n, "; ");
    if (l->n < sizeof l->text)
        l->n += (size_t)vsnprintf(l->text + l->n, sizeof l->text - l->n, format, values);
    va_end(values);
}

static void list_difference(const char *key, unsigned flags, const char *was, const char *is, void *user)
{
    (void)flags;
    if (is_of_problem(key))
        list(user, "%s %.60s and %.60s", key, was, is);
}

static Status check_same(const Run *one, const Run *other, Err *err)
{
    static const char *const INPUTS[][2] = {{"record_fnv1a", "motion.record"},
                                            {"records_fnv1a", "motion.records"},
                                            {"forces_fnv1a", "motion.forces"},
                                            {"matrices_fnv1a", "building.model"}};
    Listed l = {0};
    settings_compare(one->settings, other->settings, list_difference, &l);
    for (size_t i = 0; i < N_OF(INPUTS); i++)
        if (provenance_hash(one->provenance, INPUTS[i][0]) != provenance_hash(other->provenance, INPUTS[i][0]))
            list(&l, "%s has another content", INPUTS[i][1]);
    if (one->schema.n_extra != other->schema.n_extra)
        list(&l, "the worker answers %zu and %zu constraint values", one->schema.n_extra, other->schema.n_extra);
    return l.n == 0 ? STATUS_OK
                    : bad_data(err, "%.60s and %.60s are runs of two problems: %s", one->folder, other->folder, l.text);
}

/* -- one table ----------------------------------------------------------------------------------------------------- */

/* The design that this one was made of has another id now. */
static void move_origin(Evaluation *e, long added, char reason[REASON_MAX])
{
    const size_t n = sizeof SIMPLIFIED_FROM - 1;
    if (strncmp(e->reason, SIMPLIFIED_FROM, n) != 0)
        return;
    snprintf(reason, REASON_MAX, "%s%ld", SIMPLIFIED_FROM, strtol(e->reason + n, NULL, 10) + added);
    e->reason = reason;
}

static Status append_rows(Run *to, const Run *from, int polished, long added, Err *err)
{
    const size_t polished_from = run_first_polished(from), m = from->schema.n_obj;
    char reason[REASON_MAX];
    for (size_t i = polished ? polished_from : 0; i < (polished ? from->table.n : polished_from); i++) {
        const size_t at = to->table.n;
        Evaluation e = from->table.row[i];
        e.id += added;
        e.err = NULL;
        move_origin(&e, added, reason);
        TRY(evaluation_table_append(&to->table, &e, err));
        memcpy(to->F + at * m, run_f(from, i), m * sizeof *to->F);
        to->place[at] = from->place[i];
        for (size_t j = 0; to->place[at].on_front && j < at; j++)
            to->place[at].on_front =
                !to->place[j].on_front || memcmp(run_x(to, j), e.x, to->schema.n_var * sizeof *e.x) != 0;
    }
    return STATUS_OK;
}

static Status append_finer(Run *to, const Run *from, long added, Err *err)
{
    for (size_t i = 0; i < from->finer.n; i++) {
        Evaluation e = from->finer.row[i];
        e.id += added;
        TRY(evaluation_table_append(&to->finer, &e, err));
    }
    return STATUS_OK;
}

/* Tables do not move any more. */
static void point_at_finer(Run *run)
{
    for (size_t i = 0; i < run->finer.n; i++) {
        Evaluation *finer = &run->finer.row[i];
        finer->err = run->table.row[run_find(run, finer->id)].err = finer->extra + run->schema.n_extra;
    }
}

static Status join(Run *to, size_t n, const Run run[], Err *err)
{
    size_t rows = 1;
    for (size_t k = 0; k < n; k++)
        rows += run[k].table.n;
    TRY_ROOM(to->F, rows * to->schema.n_obj, "designs", err);
    TRY_ROOM(to->place, rows, "designs", err);
    for (size_t part = 0; part < 2 * n; part++)
        TRY(append_rows(to, &run[part % n], part >= n, (long)(part % n) * to->id_step, err));
    for (size_t k = 0; k < n; k++)
        TRY(append_finer(to, &run[k], (long)k * to->id_step, err));
    point_at_finer(to);
    return run_form_front(to, err);
}

/* Of the first one what is none of its own: settings, columns, provenance. */
static void take_head(Run *to, Run *first)
{
    const Schema *s = &first->schema;
    snprintf(to->folder, sizeof to->folder, "%s", first->folder);
    to->settings = first->settings;
    to->provenance = first->provenance;
    to->schema = first->schema;
    to->table = evaluation_table(s->n_var, s->n_obj, s->n_extra);
    to->table.n_sd = first->table.n_sd;
    to->finer = evaluation_table(0, s->n_obj, first->finer.n_extra);
    first->settings = NULL;
    first->provenance = NULL;
    first->schema.column = NULL;
}

static void count(Run *to, const Run *from)
{
    to->n_failed += from->n_failed;
    to->n_repeats += from->n_repeats;
    to->n_finished += from->n_finished;
    to->planned_evals += from->planned_evals;
    for (size_t i = 0; i < from->table.n; i++)
        while (to->id_step <= from->table.row[i].id)
            to->id_step *= 10;
}

static Status read_all(Run *to, size_t n, const char *const folders[], Run run[], Err *err)
{
    for (size_t k = 0; k < n; k++) {
        TRY(run_read(&run[k], folders[k], err));
        TRY(check_same(&run[0], &run[k], err));
        count(to, &run[k]);
    }
    take_head(to, &run[0]);
    for (size_t k = 1; k < n; k++) {
        const size_t at = strlen(to->folder);
        snprintf(to->folder + at, sizeof to->folder - at, " + %s", folders[k]);
    }
    return join(to, n, run, err);
}

Status merged_read(Run *run, size_t n, const char *const folders[], Err *err)
{
    Run *each;
    *run = (Run){.id_step = 1000};
    TRY_ROOM(each, n, "runs", err);
    const Status status = read_all(run, n, folders, each, err);
    for (size_t k = 0; k < n; k++)
        run_free(&each[k]);
    free(each);
    if (status != STATUS_OK)
        run_free(run);
    return status;
}
