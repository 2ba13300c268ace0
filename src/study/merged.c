#include "study/merged.h"

#include <stdarg.h>

#include "settings/settings.h"
#include "store/provenance.h"
#include "store/run_read.h"

/* -- one problem --------------------------------------------------------------------------------------------------- */

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

/* Lists a setting that makes another problem; files are compared by content. */
static void list_difference(const char *key, unsigned, const char *was, const char *is, void *user)
{
    static const char *const OTHERS[] = {"run.",          "problem.command", "problem.timeout_s", "sim.threads",
                                         "motion.record", "motion.forces",   "building.model"};
    int is_of_problem =
        strncmp(key, "search.", 7) != 0 || strcmp(key, "search.objectives") == 0 || strcmp(key, "search.limits") == 0;
    for (size_t i = 0; i < N_OF(OTHERS); i++)
        is_of_problem &= strncmp(key, OTHERS[i], strlen(OTHERS[i])) != 0;
    if (is_of_problem)
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

/* The search's rows of a run, or its polished ones, behind those that are there. */
static Status append_rows(Run *to, const Run *from, int polished, long added, Err *err)
{
    const size_t polished_from = run_first_polished(from), m = from->schema.n_obj, n = sizeof SIMPLIFIED_FROM - 1;
    char reason[REASON_MAX];
    for (size_t i = polished ? polished_from : 0; i < (polished ? from->table.n : polished_from); i++) {
        const size_t at = to->table.n;
        Evaluation e = from->table.row[i];
        e.id += added;
        e.err = NULL;
        if (strncmp(e.reason, SIMPLIFIED_FROM, n) == 0) { /* the design that this one was made of has another id now */
            char *rest;
            const long from_id = strtol(e.reason + n, &rest, 10) + added;
            snprintf(reason, REASON_MAX, "%s%ld%s", SIMPLIFIED_FROM, from_id, rest);
            e.reason = reason;
        }
        TRY(evaluation_table_append(&to->table, &e, err));
        memcpy(to->F + at * m, run_f(from, i), m * sizeof *to->F);
        to->place[at] = from->place[i];
        for (size_t j = 0; to->place[at].on_front && j < at; j++)
            to->place[at].on_front =
                !to->place[j].on_front || memcmp(run_x(to, j), e.x, to->schema.n_var * sizeof *e.x) != 0;
    }
    return STATUS_OK;
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
        for (size_t i = 0; i < run[k].finer.n; i++) {
            Evaluation e = run[k].finer.row[i];
            e.id += (long)k * to->id_step;
            TRY(evaluation_table_append(&to->finer, &e, err));
        }
    for (size_t i = 0; i < to->finer.n; i++) { /* tables do not move any more */
        Evaluation *finer = &to->finer.row[i];
        finer->err = to->table.row[run_find(to, finer->id)].err = finer->extra + to->schema.n_extra;
    }
    return run_form_front(to, err);
}

static Status read_all(Run *to, size_t n, const char *const folders[], Run run[], Err *err)
{
    for (size_t k = 0; k < n; k++) {
        TRY(run_read(&run[k], folders[k], err));
        TRY(check_same(run, &run[k], err));
        to->n_failed += run[k].n_failed;
        to->n_repeats += run[k].n_repeats;
        to->n_finished += run[k].n_finished;
        to->planned_evals += run[k].planned_evals;
        for (size_t i = 0; i < run[k].table.n; i++)
            while (to->id_step <= run[k].table.row[i].id)
                to->id_step *= 10;
    }

    /* Settings, columns and provenance pass over from the first. */
    Run *first = run;
    const Schema *s = &to->schema;
    to->settings = first->settings;
    to->provenance = first->provenance;
    to->schema = first->schema;
    to->table = evaluation_table(s->n_var, s->n_obj, s->n_extra);
    to->table.n_sd = first->table.n_sd;
    to->finer = evaluation_table(0, s->n_obj, first->finer.n_extra);
    first->settings = NULL;
    first->provenance = NULL;
    first->schema.column = NULL;
    text_copy(to->folder, first->folder);
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
