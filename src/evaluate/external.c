#include "evaluate/external.h"

#include <ctype.h>
#include <errno.h>
#include <fcntl.h>
#include <jansson.h>
#include <poll.h>
#include <signal.h>
#include <sys/pidfd.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/list.h"
#include "base/visible.h"
#include "evaluate/helper.h"
#include "evaluate/kinds.h"

enum {
    REQUEST_BYTES = 64,
    VALUE_BYTES = KIND_WORD_MAX + 4, /* of a variable: a word in quotes, or a number of 17 digits */
    LINE_MAX_BYTES = 1 << 20,
    READ_BYTES = 1 << 16,
    WORDS_MAX = 128,
    GRACE_MS = 1000,
    LOOK_MS = 200
};

/* A process that ends so soon after a request had ended after its answer before. */
static const double LEFT_BEFORE_S = 1.0;

/* How long requests under way may still take when no more are wanted. */
static const double LAST_ANSWERS_S = 5.0;

typedef struct {
    pid_t pid;   /* 0: not running */
    int its_end; /* readable when the process has ended (pidfd); -1: the system has none */
    int in, out;
    char *line; /* (LINE_MAX_BYTES) what has come of an answer */
    size_t n_line;
    char *request; /* (batch) of REQUEST_BYTES and VALUE_BYTES of each variable */
    size_t batch;  /* designs that it wants at once */
    size_t n_request, n_sent;
    const Task *task; /* (n) under way, of which n_done are answered */
    size_t n, n_done;
    ExternalAnswer *answer; /* to be filled, of the next task; NULL: idle */
    double asked, deadline; /* the former of the next answer */
    size_t n_answered;      /* by this process */
    int again;              /* the request goes to a fresh process */
    int is_second;          /* ... it did */
} Worker;

typedef struct {
    char *words[WORDS_MAX + 1], *text; /* the command, NULL at its end */
    size_t n_var, n_obj, n_workers, part_size;
    long n_con; /* below 0: any number */
    double timeout_s;
    double *lower, *upper; /* (n_var) */
    VariableKind *kind;    /* (n_var) NULL: all are real */
    char kinds[OPTION_TEXT_MAX];
    Worker *worker; /* (n_workers) */
    Helper helper;
} External;

/* -- the command --------------------------------------------------------------------------------------------------- */

/* One word of *from, unquoted in place at `to`; *from moves behind it. 0: a quote is left open. */
static int take_word(const char **from, char **to)
{
    char quote = 0;
    for (; **from && (quote || (**from != ' ' && **from != '\t')); ++*from) {
        const char c = **from;
        if (quote ? c == quote : c == '\'' || c == '"')
            quote = quote ? 0 : c;
        else if (c == '\\' && quote != '\'' && (*from)[1])
            *(*to)++ = *++*from;
        else
            *(*to)++ = c;
    }
    *(*to)++ = 0;
    return !quote;
}

static Status split_command(External *e, const char *command, Err *err)
{
    TRY_ROOM(e->text, strlen(command) + 2, "bytes of the command", err);
    char *to = e->text;
    for (size_t n = 0;;) {
        command += strspn(command, " \t");
        if (!*command)
            return n > 0 ? STATUS_OK : bad_data(err, "problem.command: is empty; what is to be run?");
        if (n == WORDS_MAX)
            return bad_data(err, "problem.command: has more than %d words", WORDS_MAX);
        e->words[n++] = to;
        if (!take_word(&command, &to))
            return bad_data(err, "problem.command: a quote is left open");
    }
}

/* -- one process --------------------------------------------------------------------------------------------------- */

static size_t slot_of(const External *e, const Worker *w)
{
    return w - e->worker;
}

/* Where the system has no pidfd, the end of its output tells. */
static int has_ended(const Worker *w)
{
    return w->its_end >= 0 && poll(&(struct pollfd){w->its_end, POLLIN, 0}, 1, 0) > 0;
}

static Status worker_start(External *e, Worker *w, Err *err)
{
    int to_child[2], from_child[2];
    if (pipe2(to_child, O_CLOEXEC) != 0)
        return fail(err, STATUS_INTERNAL, "no pipe for a worker: %s", strerror(errno));
    if (pipe2(from_child, O_CLOEXEC) != 0) {
        close(to_child[0]);
        close(to_child[1]);
        return fail(err, STATUS_INTERNAL, "no pipe for a worker: %s", strerror(errno));
    }
    const int failed = helper_run(&e->helper, slot_of(e, w), to_child[0], from_child[1], &w->pid);
    close(to_child[0]);
    close(from_child[1]);
    w->in = to_child[1];
    w->out = from_child[0];
    w->n_line = 0;
    if (failed) {
        close(w->in);
        close(w->out);
        return bad_data(err, "problem.command: %s cannot be started: %s", e->words[0], strerror(failed));
    }
    w->its_end = pidfd_open(w->pid, 0);
    w->n_answered = 0;
    fcntl(w->in, F_SETFL, O_NONBLOCK);
    fcntl(w->out, F_SETFL, O_NONBLOCK);
    return STATUS_OK;
}

/* kill_it 0: it has ended by itself. */
static void worker_end(External *e, Worker *w, int kill_it)
{
    if (w->pid == 0)
        return;
    helper_release(&e->helper, slot_of(e, w), kill_it);
    close(w->in);
    close(w->out);
    if (w->its_end >= 0)
        close(w->its_end);
    w->its_end = -1;
    w->pid = 0;
}

/* write() without SIGPIPE: a worker that has gone is an answer, not a signal for the program. */
static ssize_t write_quietly(int fd, const char *text, size_t n)
{
    sigset_t pipe_signal, before, pending;
    sigemptyset(&pipe_signal);
    sigaddset(&pipe_signal, SIGPIPE);
    sigpending(&pending);
    const int was_pending = sigismember(&pending, SIGPIPE);
    pthread_sigmask(SIG_BLOCK, &pipe_signal, &before);
    const ssize_t written = write(fd, text, n);
    const int cause = errno;
    if (written < 0 && cause == EPIPE && !was_pending)
        while (sigtimedwait(&pipe_signal, NULL, &(struct timespec){0}) < 0 && errno == EINTR)
            ;
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    errno = cause;
    return written;
}

/* -- one request --------------------------------------------------------------------------------------------------- */

static void expect_next(Worker *w)
{
    w->asked = clock_seconds();
    w->answer = w->n_done < w->n ? w->task[w->n_done].result : NULL;
}

/* Whose fault it was that a process fails with several designs is not known: then none is settled. */
__attribute__((format(printf, 5, 6))) static void settle(External *e, Worker *w, Outcome outcome, int kill_it,
                                                         const char *format, ...)
{
    ExternalAnswer *a = w->answer;
    if (kill_it)
        worker_end(e, w, 1);
    if (kill_it && w->n > 1) {
        w->answer = NULL;
        return;
    }
    va_list list;
    va_start(list, format);
    vsnprintf(a->reason, sizeof a->reason, format, list);
    va_end(list);
    a->outcome = outcome;
    a->seconds = clock_seconds() - w->asked;
    w->n_done++;
    expect_next(w);
}

static char *write_design(const External *e, char *to, const Task *task)
{
    char word[KIND_WORD_MAX];
    to += sprintf(to, "{\"id\":%ld,\"x\":[", task->id);
    for (size_t d = 0; d < e->n_var; d++)
        if (e->kind && kinds_word(e->kinds, d, task->x[d], word))
            to += sprintf(to, "%s\"%s\"", d ? "," : "", word);
        else
            to += sprintf(to, "%s%.17g", d ? "," : "", task->x[d]);
    return to + sprintf(to, "]}");
}

/* A design, or a list of them, into room that is there: half a request would be waited for. */
static void write_request(const External *e, Worker *w)
{
    char *to = w->request;
    for (size_t i = 0; i < w->n; i++) {
        to += sprintf(to, "%s", i > 0 ? "," : w->n > 1 ? "[" : "");
        to = write_design(e, to, &w->task[i]);
    }
    to += sprintf(to, "%s\n", w->n > 1 ? "]" : "");
    w->n_request = to - w->request;
    w->n_sent = 0;
}

static Status send_request(External *e, Worker *w, size_t n, const Task tasks[], Err *err)
{
    if (w->pid && has_ended(w))
        worker_end(e, w, 0); /* it ended after its last answer: no fault of any design */
    if (w->pid == 0)
        TRY(worker_start(e, w, err));
    w->task = tasks;
    w->n = n;
    w->n_done = 0;
    write_request(e, w);
    expect_next(w);
    w->again = w->is_second = 0;
    w->deadline = w->asked + e->timeout_s * (double)n;
    return STATUS_OK;
}

static void send_more(Worker *w)
{
    const ssize_t n = write_quietly(w->in, w->request + w->n_sent, w->n_request - w->n_sent);
    if (n > 0)
        w->n_sent += n;
    else if (n < 0 && errno != EAGAIN && errno != EINTR)
        w->n_sent = w->n_request; /* nobody reads: the end of its output tells */
}

/* 0: they are not all finite numbers. */
static int take_numbers(const json_t *list, double values[])
{
    for (size_t k = 0; k < json_array_size(list); k++) {
        const json_t *value = json_array_get(list, k);
        values[k] = json_is_number(value) ? json_number_value(value) : NAN;
        if (!isfinite(values[k]))
            return 0;
    }
    return 1;
}

static int take_objectives(const External *e, const json_t *list, double f[])
{
    return json_array_size(list) == e->n_obj && take_numbers(list, f);
}

/* How many there should be is known where answers meet: combine. No g is none. */
static int take_constraints(const json_t *list, ExternalAnswer *a, double g[])
{
    a->n_con = json_array_size(list);
    return !list || (json_is_array(list) && a->n_con <= CONSTRAINTS_MAX && take_numbers(list, g));
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

static size_t request_bytes(const External *e)
{
    return REQUEST_BYTES + VALUE_BYTES * e->n_var;
}

/* "batch" of an answer: so many designs at once from now on, where there is memory. 0: it is no such number. */
static int take_batch(const External *e, Worker *w, const json_t *batch)
{
    const json_int_t n = json_integer_value(batch);
    if (!batch)
        return 1;
    if (!json_is_integer(batch) || n < 1 || n > TASKS_MAX)
        return 0;
    char *room = (size_t)n > w->batch ? realloc(w->request, n * request_bytes(e)) : w->request;
    if (room) {
        w->request = room;
        w->batch = n;
    }
    return 1;
}

static void take_design(External *e, Worker *w, const json_t *o, const char *line)
{
    const json_t *f = json_object_get(o, "f"), *why = json_object_get(o, "error"), *id = json_object_get(o, "id");
    const char *reason = json_is_string(why) ? json_string_value(why) : "error";
    const long wanted = w->task[w->n_done].id;
    if (!json_is_object(o) || !json_is_number(id))
        settle(e, w, OUTCOME_GARBLED, 1, "wrote what is no answer: %.*s", visible_cut(line, 60), line);
    else if (json_number_value(id) != wanted)
        settle(e, w, OUTCOME_GARBLED, 1, "answered id %.15g instead of %ld", json_number_value(id), wanted);
    else if (!take_batch(e, w, json_object_get(o, "batch")))
        settle(e, w, OUTCOME_GARBLED, 1, "batch is no whole number from 1 to %d", TASKS_MAX);
    else if (why && !json_is_null(why))
        settle(e, w, OUTCOME_ERROR, 0, "%.*s", visible_cut(reason, 120), reason);
    else if (!json_is_array(f))
        settle(e, w, OUTCOME_GARBLED, 1, "neither f nor error in the answer: %.*s", visible_cut(line, 60), line);
    else if (!take_objectives(e, f, w->answer->f))
        settle(e, w, OUTCOME_NOT_FINITE, 0, "f is not %zu finite numbers", e->n_obj);
    else if (!take_constraints(json_object_get(o, "g"), w->answer, w->answer->f + e->n_obj))
        settle(e, w, OUTCOME_NOT_FINITE, 0, "g is not a list of at most %d finite numbers", CONSTRAINTS_MAX);
    else
        settle(e, w, OUTCOME_OK, 0, "%s", "");
}

/* Of one design, or of a list of them the list of their answers. */
static void take_answer(External *e, Worker *w, char *line, size_t length)
{
    json_error_t error;
    const char first = line[strspn(line, " \t\r")];
    if (first == '{' || (first == '[' && w->n > 1))
        blank_words(line);
    json_t *o = json_loadb(line, length, 0, &error);
    w->n_answered++;
    if (!o && json_error_code(&error) == json_error_numeric_overflow)
        settle(e, w, OUTCOME_NOT_FINITE, w->n > 1, "f is not %zu finite numbers: one is too large for a double",
               e->n_obj);
    else if (json_is_array(o) && w->n > 1)
        for (size_t i = 0; i < json_array_size(o) && w->answer; i++)
            take_design(e, w, json_array_get(o, i), line);
    else
        take_design(e, w, o, line);
    json_decref(o);
}

/* The first whole line in the buffer that is not blank is the answer; what follows it waits for the next request,
 * which it spoils. */
static void look_for_answer(External *e, Worker *w)
{
    size_t used = 0;
    for (char *end; w->answer && (end = memchr(w->line + used, '\n', w->n_line - used)) != NULL;) {
        char *line = w->line + used;
        const size_t length = end - line;
        *end = 0;
        used += length + 1;
        if (strspn(line, " \t\r") < length)
            take_answer(e, w, line, length);
    }
    memmove(w->line, w->line + used, w->n_line - used);
    w->n_line -= used;
    if (w->answer && w->n_line == LINE_MAX_BYTES)
        settle(e, w, OUTCOME_GARBLED, 1, "wrote a line of more than %d bytes", LINE_MAX_BYTES);
}

/* A process that ends after its answers, as one that starts itself anew now and then, may be asked once more before
 * it is gone: no fault of the design, which another process gets. */
static void take_end(External *e, Worker *w)
{
    const int was_leaving =
        w->n_answered > 0 && w->n_line == 0 && !w->is_second && clock_seconds() < w->asked + LEFT_BEFORE_S;
    if (w->n == 1 && (was_leaving || helper_is_lost(&e->helper)))
        w->again = 1;
    else
        settle(e, w, OUTCOME_DEAD, 1, "the worker ended without an answer");
}

static void read_more(External *e, Worker *w)
{
    const size_t room = LINE_MAX_BYTES - w->n_line;
    const ssize_t n = read(w->out, w->line + w->n_line, MIN_OF(room, READ_BYTES));
    if (n > 0) {
        w->n_line += n;
        look_for_answer(e, w);
    } else if (n == 0 || (errno != EAGAIN && errno != EINTR)) {
        take_end(e, w);
    }
}

static Status ask_again(External *e, Worker *w, Err *err)
{
    worker_end(e, w, 1);
    TRY(worker_start(e, w, err));
    w->n_sent = 0;
    w->again = 0;
    w->is_second = 1;
    return STATUS_OK;
}

/* -- as a simulator ------------------------------------------------------------------------------------------------ */

/* The end of a process counts where it left nothing to be read: a child of it may hold its output open. */
static void wait_for(External *e, Worker *w)
{
    struct pollfd ends[3] = {
        {w->n_sent < w->n_request ? w->in : -1, POLLOUT, 0}, {w->out, POLLIN, 0}, {w->its_end, POLLIN, 0}};
    const double left_ms = 1e3 * (w->deadline - clock_seconds());
    const int came = poll(ends, 3, left_ms > 0.0 ? (int)fmin(ceil(left_ms), LOOK_MS) : 0) > 0;
    if (came && ends[1].revents)
        read_more(e, w);
    else if (came && ends[2].revents)
        take_end(e, w);
    else if (came && ends[0].revents)
        send_more(w);
    if (w->answer && clock_seconds() >= w->deadline)
        settle(e, w, OUTCOME_TIMEOUT, 1, "no answer within %g s", e->timeout_s);
}

static Status wait_for_answers(External *e, Worker *w, Err *err)
{
    double ending = 0.0;   /* since when no more is wanted */
    look_for_answer(e, w); /* a worker that wrote without being asked */
    while (w->answer) {
        if (ending == 0.0 && !w->task->may_go_on(w->task->user))
            ending = clock_seconds();
        if (ending > 0.0 && clock_seconds() > ending + LAST_ANSWERS_S) {
            w->answer = NULL;
            worker_end(e, w, 1);
            return fail(err, STATUS_STOPPED, "stopped");
        }
        wait_for(e, w);
        if (w->answer && w->again)
            TRY(ask_again(e, w, err));
    }
    return STATUS_OK;
}

/* What a process that failed left of a batch is asked one by one, so that the design at fault fails alone. */
static Status simulate_batch(void *self, size_t worker, size_t n, const Task tasks[], size_t *n_done, Err *err)
{
    External *e = self;
    Worker *w = &e->worker[worker];
    Status status = STATUS_OK;
    size_t asked = n;
    for (*n_done = 0; status == STATUS_OK && *n_done < n; asked = 1) {
        w->n_done = 0;
        status = send_request(e, w, asked, tasks + *n_done, err);
        if (status == STATUS_OK)
            status = wait_for_answers(e, w, err);
        *n_done += w->n_done;
    }
    return status;
}

static Status simulate(void *self, size_t worker, const Task *task, Err *err)
{
    size_t n_done;
    return simulate_batch(self, worker, 1, task, &n_done, err);
}

static size_t batch(void *self, size_t worker)
{
    const External *e = self;
    return e->worker[worker].batch;
}

static void combine(const Problem *p, size_t n, const void *parts, Evaluation *evaluation)
{
    (void)n;
    const External *e = p->self;
    const ExternalAnswer *a = parts;
    char reason[REASON_MAX];
    evaluation_set_outcome(evaluation, a->outcome, a->reason);
    memcpy(evaluation->f, a->f, p->n_obj * sizeof *a->f);
    if (a->outcome == OUTCOME_OK && e->n_con >= 0 && a->n_con != (size_t)e->n_con) {
        snprintf(reason, sizeof reason, "g has %zu values and not %ld as in the first answer of the run", a->n_con,
                 e->n_con);
        evaluation_set_outcome(evaluation, OUTCOME_NOT_FINITE, reason);
    } else if (a->outcome == OUTCOME_OK && a->n_con > 0) {
        memcpy(evaluation->extra, a->f + p->n_obj, a->n_con * sizeof *a->f);
    }
    evaluation->seconds = a->seconds;
    evaluation->replicates = 1;
}

/* Input closed, a moment to end by itself. */
static void farewell(External *e)
{
    size_t left = 0;
    for (size_t i = 0; i < e->n_workers; i++)
        if (e->worker[i].pid) {
            close(e->worker[i].in);
            e->worker[i].in = -1;
            left++;
        }
    for (int ms = 0; left > 0 && ms < GRACE_MS; ms += 5) {
        for (size_t i = 0; i < e->n_workers; i++) {
            Worker *w = &e->worker[i];
            if (w->pid && has_ended(w)) {
                worker_end(e, w, 0);
                left--;
            }
        }
        if (left > 0)
            nanosleep(&(struct timespec){.tv_nsec = 5000000}, NULL);
    }
}

static void external_close(void *self)
{
    External *e = self;
    farewell(e);
    for (size_t i = 0; i < e->n_workers; i++) {
        worker_end(e, &e->worker[i], 1);
        free(e->worker[i].line);
        free(e->worker[i].request);
    }
    helper_end(&e->helper);
    free(e->worker);
    free(e->lower);
    free(e->kind);
    free(e->text);
    free(e);
}

static const Simulator EXTERNAL = {.simulate = simulate,
                                   .combine = combine,
                                   .close = external_close,
                                   .batch = batch,
                                   .simulate_batch = simulate_batch};

/* -- opening ------------------------------------------------------------------------------------------------------- */

/* Number of each of n variables: one for all, or a list. */
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

static Status set_kinds(External *e, const ProblemOptions *o, Err *err)
{
    if (kinds_are_real(o->kinds))
        return STATUS_OK;
    snprintf(e->kinds, sizeof e->kinds, "%s", o->kinds);
    e->kind = calloc(e->n_var, sizeof *e->kind);
    return e->kind ? kinds_read(e->kinds, e->n_var, e->kind, e->lower, e->upper, err)
                   : fail(err, STATUS_NO_MEMORY, "no memory for %zu variables", e->n_var);
}

static Status set_bounds(External *e, const ProblemOptions *o, Err *err)
{
    TRY_ROOM(e->lower, 2 * e->n_var, "bounds of variables", err);
    e->upper = e->lower + e->n_var;
    TRY(read_bounds("problem.lower", o->lower, e->n_var, e->lower, err));
    TRY(read_bounds("problem.upper", o->upper, e->n_var, e->upper, err));
    TRY(set_kinds(e, o, err)); /* a choice has bounds of its own */
    for (size_t j = 0; j < e->n_var; j++)
        if (e->lower[j] > e->upper[j])
            return bad_data(err, "problem.lower: %g is above problem.upper = %g (variable %zu)", e->lower[j],
                            e->upper[j], j + 1);
    return STATUS_OK;
}

static Status create_workers(External *e, size_t n, Err *err)
{
    e->worker = calloc(n, sizeof *e->worker);
    for (; e->worker && e->n_workers < n; e->n_workers++) {
        Worker *w = &e->worker[e->n_workers];
        *w = (Worker){.its_end = -1, .line = malloc(LINE_MAX_BYTES), .request = malloc(request_bytes(e)), .batch = 1};
        if (!w->line || !w->request)
            break;
    }
    return e->n_workers == n ? STATUS_OK : fail_memory(err, n, "workers");
}

static Status create(External *e, const ProblemOptions *o, size_t n_workers, Err *err)
{
    TRY(split_command(e, o->command, err));
    TRY(set_bounds(e, o, err));
    TRY(create_workers(e, n_workers, err));
    return helper_start(&e->helper, e->words, n_workers, err);
}

Status external_open(Problem *p, const ProblemOptions *o, size_t n_workers, Err *err)
{
    External *e;
    TRY_ROOM(e, 1, "a set of workers", err);
    e->n_var = o->variables;
    e->n_obj = o->objectives;
    e->part_size = sizeof(ExternalAnswer) + (e->n_obj + CONSTRAINTS_MAX) * sizeof(double);
    e->timeout_s = o->timeout_s;
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
                   .simulator = &EXTERNAL,
                   .self = e,
                   .n_parts = 1,
                   .part_size = e->part_size,
                   .n_workers = e->n_workers};
    external_constrain(p, o->constraints);
    return STATUS_OK;
}

void external_constrain(Problem *p, long n)
{
    External *e = p->self;
    e->n_con = n;
    p->n_extra = n < 0 ? CONSTRAINTS_MAX : (size_t)n;
}
