#include "evaluate/external.h"

#include <ctype.h>
#include <jansson.h>

#include "base/clock.h"
#include "base/list.h"
#include "base/visible.h"
#include "evaluate/kinds.h"
#include "evaluate/pool.h"

enum {
    REQUEST_BYTES = 64,
    VALUE_BYTES = KIND_WORD_MAX + 4, /* of a variable: a word in quotes, or a number of 17 digits */
    WORDS_MAX = 128
};

typedef struct {
    char *words[WORDS_MAX + 1], *text; /* the command, NULL at its end */
    size_t n_var, n_obj;
    long n_con;            /* below 0: any number */
    double *lower, *upper; /* (n_var) */
    VariableKind *kind;    /* (n_var) NULL: all are real */
    Steps *steps;          /* (n_var) NULL: none is one of a list */
    char kinds[OPTION_TEXT_MAX];
    Pool pool;
} External;

/* -- one request --------------------------------------------------------------------------------------------------- */

/* Write a design, or a list of them, whole: half a request would be waited for. */
static size_t write_request(void *self, const Worker *w, char *request)
{
    const External *e = self;
    char *to = request, word[KIND_WORD_MAX];
    for (size_t i = 0; i < w->n; i++) {
        const Task *task = &w->task[i];
        to += sprintf(to, "%s{\"id\":%ld,\"x\":[", i > 0 ? "," : w->n > 1 ? "[" : "", task->id);
        for (size_t d = 0; d < e->n_var; d++)
            to += e->kind && kinds_word(e->kinds, d, task->x[d], word)
                      ? sprintf(to, "%s\"%s\"", d ? "," : "", word)
                      : sprintf(to, "%s%.17g", d ? "," : "", task->x[d]);
        to += sprintf(to, "]}");
    }
    to += sprintf(to, "%s\n", w->n > 1 ? "]" : "");
    return to - request;
}

static void tell(void *, Worker *w, Outcome outcome, const char *reason)
{
    ExternalAnswer *a = w->task[w->n_done].result;
    a->outcome = outcome;
    a->seconds = clock_seconds() - w->asked;
    text_copy(a->reason, reason);
}

/* Is it a list of min to max finite numbers? */
static int take_numbers(const json_t *list, size_t min, size_t max, double values[])
{
    const size_t n = json_array_size(list);
    if (!json_is_array(list) || n < min || n > max)
        return 0;
    for (size_t k = 0; k < n; k++) {
        const json_t *value = json_array_get(list, k);
        values[k] = json_is_number(value) ? json_number_value(value) : NAN;
    }
    return all_finite(n, values);
}

/* What Python, C and others print for numbers that are none (NaN, -Infinity, inf) is no JSON: a word outside strings
 * becomes "". */
static void blank_words(char *line)
{
    int in_string = 0;
    for (char *c = line; *c; c++) {
        size_t n = 0;
        if (in_string && *c == '\\' && c[1])
            c++;
        else if (*c == '"')
            in_string = !in_string;
        while (!in_string && isalpha((unsigned char)c[n]))
            n++;
        if (n < 3 || strncmp(c, "true", n) == 0 || strncmp(c, "false", n) == 0 || strncmp(c, "null", n) == 0) {
            c += n > 0 ? n - 1 : 0;
            continue;
        }
        if (c > line && c[-1] == '-')
            c[-1] = ' ';
        memset(c, ' ', n);
        memset(c, '"', 2);
        c += n - 1;
    }
}

/* Settle the next task by one answer. How many constraint values there should be is known where answers meet:
 * combine. */
static void take_design(const External *e, Worker *w, const json_t *o, const char *line)
{
    const json_t *f = json_object_get(o, "f"), *g = json_object_get(o, "g"), *why = json_object_get(o, "error");
    const json_t *id = json_object_get(o, "id"), *batch = json_object_get(o, "batch");
    const char *reason = json_is_string(why) ? json_string_value(why) : "error";
    const Task *task = &w->task[w->n_done];
    ExternalAnswer *a = task->result;
    a->n_con = json_array_size(g);
    if (!json_is_object(o) || !json_is_number(id))
        pool_settle(w, OUTCOME_GARBLED, 1, "wrote what is no answer: %.*s", visible_cut(line, 60), line);
    else if (json_number_value(id) != task->id)
        pool_settle(w, OUTCOME_GARBLED, 1, "answered id %.15g instead of %ld", json_number_value(id), task->id);
    else if (batch && !pool_batch(w, json_integer_value(batch)))
        pool_settle(w, OUTCOME_GARBLED, 1, "batch is no whole number from 1 to %d", TASKS_MAX);
    else if (why && !json_is_null(why))
        pool_settle(w, OUTCOME_ERROR, 0, "%.*s", visible_cut(reason, 120), reason);
    else if (!json_is_array(f))
        pool_settle(w, OUTCOME_GARBLED, 1, "neither f nor error in the answer: %.*s", visible_cut(line, 60), line);
    else if (!take_numbers(f, e->n_obj, e->n_obj, a->f))
        pool_settle(w, OUTCOME_NOT_FINITE, 0, "f is not %zu finite numbers", e->n_obj);
    else if (g && !take_numbers(g, 0, CONSTRAINTS_MAX, a->f + e->n_obj))
        pool_settle(w, OUTCOME_NOT_FINITE, 0, "g is not a list of at most %d finite numbers", CONSTRAINTS_MAX);
    else
        pool_settle(w, OUTCOME_OK, 0, "%s", "");
}

/* Take the first whole line in the buffer that is not blank: the answer of one design, or of a list of them the list of
 * their answers. What follows it waits for the next request, which it spoils. */
static void look_for_answer(void *self, Worker *w)
{
    const External *e = self;
    size_t used = 0;
    for (char *end; w->n_done < w->n && (end = memchr(w->line + used, '\n', w->n_line - used));) {
        char *line = w->line + used;
        const size_t length = end - line;
        json_error_t error;
        *end = 0;
        used += length + 1;
        const size_t blanks = strspn(line, " \t\r");
        if (blanks >= length)
            continue;
        if (line[blanks] == '{' || (line[blanks] == '[' && w->n > 1))
            blank_words(line);
        json_t *o = json_loadb(line, length, 0, &error);
        w->n_answered++;
        if (!o && (!error.text[0] || json_error_code(&error) == json_error_out_of_memory)) {
            /* Our memory, which says nothing of the design; jansson has no words where an object has no room. */
            fail_memory(&w->why, length, "bytes of an answer");
            w->n = w->n_done;
        } else if (!o && json_error_code(&error) == json_error_numeric_overflow)
            pool_settle(w, OUTCOME_NOT_FINITE, w->n > 1, "f is not %zu finite numbers: one is too large for a double",
                        e->n_obj);
        else if (json_is_array(o) && w->n > 1)
            for (size_t i = 0; i < json_array_size(o) && w->n_done < w->n; i++)
                take_design(e, w, json_array_get(o, i), line);
        else
            take_design(e, w, o, line);
        json_decref(o);
    }
    memmove(w->line, w->line + used, w->n_line - used);
    w->n_line -= used;
    if (w->n_done < w->n && w->n_line == LINE_MAX_BYTES)
        pool_settle(w, OUTCOME_GARBLED, 1, "wrote a line of more than %d bytes", LINE_MAX_BYTES);
}

/* -- as a simulator ------------------------------------------------------------------------------------------------ */

static Pool *pool(void *self)
{
    return &((External *)self)->pool;
}

/* An answer becomes an evaluation; only here it is known how many constraint values the first one of the run had. */
static void combine(const Problem *p, size_t, const void *parts, Evaluation *evaluation)
{
    const External *e = p->self;
    const ExternalAnswer *a = parts;
    char reason[REASON_MAX];
    evaluation_set_outcome(evaluation, a->outcome, a->reason);
    copy_values(p->n_obj, a->f, evaluation->f);
    if (a->outcome == OUTCOME_OK && e->n_con >= 0 && a->n_con != (size_t)e->n_con) {
        snprintf(reason, sizeof reason, "g has %zu values and not %ld as in the first answer of the run", a->n_con,
                 e->n_con);
        evaluation_set_outcome(evaluation, OUTCOME_NOT_FINITE, reason);
    } else if (a->outcome == OUTCOME_OK) {
        copy_values(a->n_con, a->f + p->n_obj, evaluation->extra);
    }
    evaluation->seconds = a->seconds;
    evaluation->replicates = 1;
}

static void external_close(void *self)
{
    External *e = self;
    pool_close(&e->pool);
    free(e->lower);
    free(e->kind);
    free(e->steps);
    free(e->text);
    free(e);
}

static const Simulator EXTERNAL = {.combine = combine, .close = external_close, .pool = pool};

/* -- opening ------------------------------------------------------------------------------------------------------- */

/* The number of each of n variables: one for all, or a list. */
static Status read_bounds(const char *key, const char *list, size_t n, double bounds[], Err *err)
{
    const size_t count = list_count(list);
    char word[64], *end;
    if (count != 1 && count != n)
        return bad_data(err, "%s: %zu numbers for %zu variables", key, count, n);
    for (size_t j = 0; j < n; j++) {
        if (!list_item(list, count == 1 ? 0 : j, word, sizeof word))
            return bad_data(err, "%s: number %zu is missing", key, j + 1);
        bounds[j] = strtod(word, &end);
        if (end == word || *end || !isfinite(bounds[j]))
            return bad_data(err, "%s: '%s' is not a number", key, word);
    }
    return STATUS_OK;
}

/* The words of a command, split at blanks, without their quotes. */
static Status split_command(External *e, const char *command, Err *err)
{
    const char *from = command + strspn(command, " \t");
    size_t n_words = 0;
    TRY_ROOM(e->text, strlen(from) + 2, "bytes of the command", err);
    for (char *to = e->text; *from; from += strspn(from, " \t"), *to++ = 0) {
        char quote = 0;
        if (n_words == WORDS_MAX)
            return bad_data(err, "problem.command: has more than %d words", WORDS_MAX);
        e->words[n_words++] = to;
        for (; *from && (quote || (*from != ' ' && *from != '\t')); ++from) {
            if (quote ? *from == quote : *from == '\'' || *from == '"')
                quote = quote ? 0 : *from;
            else
                *to++ = *from == '\\' && quote != '\'' && from[1] ? *++from : *from;
        }
        if (quote)
            return bad_data(err, "problem.command: a quote is left open");
    }
    return n_words > 0 ? STATUS_OK : bad_data(err, "problem.command: is empty; what is to be run?");
}

/* All of a problem that was allocated: the command, the box, the processes. */
static Status create(External *e, const ProblemOptions *o, size_t n_workers, Err *err)
{
    const size_t n_var = e->n_var;
    TRY(split_command(e, o->command, err));

    /* 1. The box; a choice has bounds of its own. */
    TRY_ROOM(e->lower, 2 * n_var, "bounds of variables", err);
    e->upper = e->lower + n_var;
    TRY(read_bounds("problem.lower", o->lower, n_var, e->lower, err));
    TRY(read_bounds("problem.upper", o->upper, n_var, e->upper, err));
    if (!kinds_are_real(o->kinds)) {
        text_copy(e->kinds, o->kinds);
        TRY_ROOM(e->kind, n_var, "variables", err);
        TRY(kinds_read(e->kinds, n_var, e->kind, e->lower, &e->steps, err));
    }
    for (size_t j = 0; j < n_var; j++)
        if (e->lower[j] > e->upper[j])
            return bad_data(err, "problem.lower: %g is above problem.upper = %g (variable %zu)", e->lower[j],
                            e->upper[j], j + 1);

    /* 2. The processes. */
    const Protocol protocol = {.name = "problem.command",
                               .work = {.words = e->words},
                               .request_bytes = REQUEST_BYTES + VALUE_BYTES * n_var,
                               .timeout_s = o->timeout_s,
                               .grace_s = PROCESS_GRACE_S,
                               .may_leave = 1,
                               .write = write_request,
                               .look = look_for_answer,
                               .tell = tell,
                               .self = e};
    return pool_open(&e->pool, &protocol, n_workers, err);
}

Status external_open(Problem *p, const ProblemOptions *o, size_t n_workers, Err *err)
{
    External *e;
    TRY_ROOM(e, 1, "a set of workers", err);
    e->n_var = o->variables;
    e->n_obj = o->objectives;
    const Status status = create(e, o, n_workers, err);
    if (status != STATUS_OK) {
        external_close(e);
        return status;
    }
    *p = (Problem){.n_var = e->n_var,
                   .n_obj = e->n_obj,
                   .lower = e->lower,
                   .upper = e->upper,
                   .kind = e->kind,
                   .steps = e->steps,
                   .simulator = &EXTERNAL,
                   .self = e,
                   .n_parts = 1,
                   .part_size = sizeof(ExternalAnswer) + (e->n_obj + CONSTRAINTS_MAX) * sizeof(double),
                   .n_workers = n_workers};
    external_constrain(p, o->constraints);
    return STATUS_OK;
}

void external_constrain(Problem *p, long n)
{
    External *e = p->self;
    e->n_con = n;
    p->n_extra = n < 0 ? CONSTRAINTS_MAX : (size_t)n;
}
