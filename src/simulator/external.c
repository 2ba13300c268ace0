#include "simulator/external.h"

#include <ctype.h>
#include <errno.h>
#include <fcntl.h>
#include <jansson.h>
#include <math.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "base/clock.h"
#include "simulator/guard.h"

enum { LINE_MAX_BYTES = 1 << 20, READ_BYTES = 1 << 16, WORDS_MAX = 128, GRACE_MS = 1000, LOOK_MS = 200 };

/* How long requests under way may still take when no more are wanted. */
static const double LAST_ANSWERS_S = 5.0;

typedef struct {
    pid_t pid; /* 0: not running */
    const Guard *guard;
    size_t slot; /* the guard's for its process group */
    int in, out;
    char *line; /* (LINE_MAX_BYTES) what has come of an answer */
    size_t n_line;
    char *request;
    size_t n_request, n_sent;
    size_t design; /* SIZE_MAX: idle */
    long id;
    double asked, deadline;
} Worker;

struct External {
    char *words[WORDS_MAX + 1], *text; /* the command, NULL at its end */
    size_t n_var, n_obj, n_workers;
    double timeout_s;
    long next_id;
    Worker *worker;
    Guard guard;
    struct pollfd *poll; /* (2 n_workers) */
};

/* One batch under way, and who works on it. */
typedef struct {
    Worker *worker; /* (n_workers) of the External's */
    struct pollfd *poll;
    size_t n_workers;
    size_t n, next, done;
    const double *X;
    const long *ids; /* (n) or NULL */
    double *F;
    Answer *answers;
    const Watch *watch;
    double ending; /* when it was told to stop; 0: it goes on */
    Status status; /* of the watch */
    Err *err;
} Batch;

const char *answer_word(AnswerOutcome outcome)
{
    static const char *const words[] = {
        [ANSWER_OK] = "ok",     [ANSWER_ERROR] = "error",     [ANSWER_NOT_FINITE] = "not_finite",
        [ANSWER_DEAD] = "dead", [ANSWER_TIMEOUT] = "timeout", [ANSWER_GARBLED] = "garbled",
    };
    return words[outcome];
}

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
    e->text = calloc(strlen(command) + 2, 1);
    if (!e->text)
        return fail(err, STATUS_NO_MEMORY, "no memory for the command");
    char *to = e->text;
    for (size_t n = 0;;) {
        command += strspn(command, " \t");
        if (!*command)
            return n > 0 ? STATUS_OK : fail(err, STATUS_BAD_DATA, "problem.command: is empty; what is to be run?");
        if (n == WORDS_MAX)
            return fail(err, STATUS_BAD_DATA, "problem.command: has more than %d words", WORDS_MAX);
        e->words[n++] = to;
        if (!take_word(&command, &to))
            return fail(err, STATUS_BAD_DATA, "problem.command: a quote is left open");
    }
}

/* -- one process --------------------------------------------------------------------------------------------------- */

static int spawn(External *e, Worker *w, const int to_child[2], const int from_child[2])
{
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    sigset_t none;
    sigemptyset(&none);
    posix_spawn_file_actions_init(&actions);
    posix_spawnattr_init(&attributes);
    posix_spawn_file_actions_adddup2(&actions, to_child[0], STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, from_child[1], STDOUT_FILENO);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK);
    posix_spawnattr_setsigmask(&attributes, &none);
    const int failed = posix_spawnp(&w->pid, e->words[0], &actions, &attributes, e->words, environ);
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
    if (failed)
        w->pid = 0;
    return failed;
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
    const int failed = spawn(e, w, to_child, from_child);
    close(to_child[0]);
    close(from_child[1]);
    w->in = to_child[1];
    w->out = from_child[0];
    w->n_line = 0;
    if (failed) {
        close(w->in);
        close(w->out);
        return fail(err, STATUS_BAD_DATA, "problem.command: %s cannot be started: %s", e->words[0], strerror(failed));
    }
    guard_tell(w->guard, w->slot, w->pid);
    fcntl(w->in, F_SETFL, O_NONBLOCK);
    fcntl(w->out, F_SETFL, O_NONBLOCK);
    return STATUS_OK;
}

static void worker_forget(Worker *w)
{
    guard_tell(w->guard, w->slot, 0);
    close(w->in);
    close(w->out);
    w->pid = 0;
}

static void worker_kill(Worker *w)
{
    if (w->pid == 0)
        return;
    kill(-w->pid, SIGKILL);
    while (waitpid(w->pid, NULL, 0) < 0 && errno == EINTR)
        ;
    worker_forget(w);
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

__attribute__((format(printf, 5, 6))) static void settle(Batch *b, Worker *w, AnswerOutcome outcome, int kill_it,
                                                         const char *format, ...)
{
    Answer *a = &b->answers[w->design];
    va_list list;
    va_start(list, format);
    vsnprintf(a->reason, sizeof a->reason, format, list);
    va_end(list);
    a->outcome = outcome;
    a->seconds = clock_seconds() - w->asked;
    b->done++;
    if (b->status == STATUS_OK)
        b->status = watch_done(b->watch, w->design, b->err);
    w->design = SIZE_MAX;
    if (kill_it)
        worker_kill(w);
}

static Status write_request(External *e, Worker *w, const double x[], Err *err)
{
    size_t size;
    free(w->request);
    w->request = NULL;
    FILE *f = open_memstream(&w->request, &size);
    if (!f)
        return fail(err, STATUS_NO_MEMORY, "no memory for a request");
    fprintf(f, "{\"id\":%ld,\"x\":[", w->id);
    for (size_t d = 0; d < e->n_var; d++)
        fprintf(f, "%s%.17g", d ? "," : "", x[d]);
    fputs("]}\n", f);
    if (fclose(f) != 0)
        return fail(err, STATUS_NO_MEMORY, "no memory for a request");
    w->n_request = size;
    w->n_sent = 0;
    return STATUS_OK;
}

static Status give_design(External *e, Worker *w, Batch *b, Err *err)
{
    if (w->pid && waitpid(w->pid, NULL, WNOHANG) == w->pid)
        worker_forget(w); /* it ended after its last answer: nobody's fault */
    if (w->pid == 0)
        TRY(worker_start(e, w, err));
    w->id = b->ids ? b->ids[b->next] : e->next_id++;
    TRY(write_request(e, w, b->X + b->next * e->n_var, err));
    w->design = b->next++;
    w->asked = clock_seconds();
    w->deadline = w->asked + e->timeout_s;
    return STATUS_OK;
}

static void send_more(Worker *w)
{
    const ssize_t n = write_quietly(w->in, w->request + w->n_sent, w->n_request - w->n_sent);
    if (n > 0)
        w->n_sent += (size_t)n;
    else if (n < 0 && errno != EAGAIN && errno != EINTR)
        w->n_sent = w->n_request; /* nobody reads: the end of its output tells */
}

/* f of an answer into F; 0 where it is not n_obj finite numbers. */
static int take_objectives(const External *e, const json_t *list, double f[])
{
    if (json_array_size(list) != e->n_obj)
        return 0;
    for (size_t k = 0; k < e->n_obj; k++) {
        const json_t *value = json_array_get(list, k);
        f[k] = json_is_number(value) ? json_number_value(value) : NAN;
        if (!isfinite(f[k]))
            return 0;
    }
    return 1;
}

/* What Python, C and others print for numbers that are none is no JSON: outside strings it becomes "". */
static void blank_non_numbers(char *line)
{
    static const char *const WORDS[] = {"NaN", "-NaN", "nan", "-nan", "Infinity", "-Infinity", "inf", "-inf"};
    int in_string = 0;
    for (char *c = line; *c; c++) {
        if (in_string && *c == '\\' && c[1])
            c++;
        else if (*c == '"')
            in_string = !in_string;
        for (size_t k = 0; !in_string && k < sizeof WORDS / sizeof WORDS[0]; k++) {
            const size_t length = strlen(WORDS[k]);
            if (strncmp(c, WORDS[k], length) != 0 || isalnum((unsigned char)c[length]))
                continue;
            memset(c, ' ', length);
            memset(c, '"', 2);
            c += length - 1;
            break;
        }
    }
}

static void take_answer(External *e, Worker *w, Batch *b, char *line, size_t length)
{
    json_error_t error;
    blank_non_numbers(line);
    json_t *o = json_loadb(line, length, 0, &error);
    const json_t *f = json_object_get(o, "f"), *why = json_object_get(o, "error"), *id = json_object_get(o, "id");
    if (!json_is_object(o) || !json_is_integer(id))
        settle(b, w, ANSWER_GARBLED, 1, "wrote what is no answer: %.60s", line);
    else if (json_integer_value(id) != w->id)
        settle(b, w, ANSWER_GARBLED, 1, "answered id %lld instead of %ld", (long long)json_integer_value(id), w->id);
    else if (why)
        settle(b, w, ANSWER_ERROR, 0, "%.120s", json_is_string(why) ? json_string_value(why) : "error");
    else if (!json_is_array(f))
        settle(b, w, ANSWER_GARBLED, 1, "neither f nor error in the answer: %.60s", line);
    else if (!take_objectives(e, f, b->F + w->design * e->n_obj))
        settle(b, w, ANSWER_NOT_FINITE, 0, "f is not %zu finite numbers", e->n_obj);
    else
        settle(b, w, ANSWER_OK, 0, "%s", "");
    json_decref(o);
}

/* The first whole line in the buffer is the answer; what follows it waits for the next request, which it spoils. */
static void look_for_answer(External *e, Worker *w, Batch *b)
{
    for (char *end; w->design != SIZE_MAX && (end = memchr(w->line, '\n', w->n_line)) != NULL;) {
        const size_t length = (size_t)(end - w->line), used = length + 1;
        *end = 0;
        if (strspn(w->line, " \t\r") < length)
            take_answer(e, w, b, w->line, length);
        memmove(w->line, w->line + used, w->n_line - used);
        w->n_line -= used;
    }
    if (w->design != SIZE_MAX && w->n_line == LINE_MAX_BYTES)
        settle(b, w, ANSWER_GARBLED, 1, "wrote a line of more than %d bytes", LINE_MAX_BYTES);
}

static void read_more(External *e, Worker *w, Batch *b)
{
    const size_t room = LINE_MAX_BYTES - w->n_line;
    const ssize_t n = read(w->out, w->line + w->n_line, room < READ_BYTES ? room : READ_BYTES);
    if (n > 0) {
        w->n_line += (size_t)n;
        look_for_answer(e, w, b);
    } else if (n == 0 || (errno != EAGAIN && errno != EINTR)) {
        settle(b, w, ANSWER_DEAD, 1, "the worker ended without an answer");
    }
}

/* -- a batch ------------------------------------------------------------------------------------------------------- */

static void look_after(External *e, Worker *w, const struct pollfd *in, const struct pollfd *out, Batch *b)
{
    if (w->design != SIZE_MAX && in->revents)
        send_more(w);
    if (w->design != SIZE_MAX && out->revents)
        read_more(e, w, b);
    if (w->design != SIZE_MAX && clock_seconds() >= w->deadline)
        settle(b, w, ANSWER_TIMEOUT, 1, "no answer within %g s", e->timeout_s);
}

static void wait_for_workers(const Batch *b)
{
    double first = INFINITY;
    for (size_t i = 0; i < b->n_workers; i++) {
        const Worker *w = &b->worker[i];
        const int busy = w->design != SIZE_MAX;
        b->poll[2 * i] = (struct pollfd){busy && w->n_sent < w->n_request ? w->in : -1, POLLOUT, 0};
        b->poll[2 * i + 1] = (struct pollfd){busy ? w->out : -1, POLLIN, 0};
        if (busy)
            first = fmin(first, w->deadline);
    }
    if (!(first < INFINITY))
        return;
    const double left_ms = 1e3 * (first - clock_seconds());
    if (poll(b->poll, 2 * b->n_workers, left_ms > 0.0 ? (int)fmin(ceil(left_ms), LOOK_MS) : 0) <= 0)
        for (size_t i = 0; i < 2 * b->n_workers; i++)
            b->poll[i].revents = 0;
}

/* Idle workers get the next designs, unless it is to end. */
static Status hand_out(External *e, Batch *b, Err *err)
{
    if (b->ending == 0.0 && b->done < b->n && !watch_go_on(b->watch))
        b->ending = clock_seconds();
    for (size_t i = 0; i < b->n_workers && b->next < b->n && b->ending == 0.0; i++) {
        Worker *w = &b->worker[i];
        if (w->design != SIZE_MAX)
            continue;
        TRY(give_design(e, w, b, err));
        look_for_answer(e, w, b); /* a worker that wrote without being asked */
    }
    return STATUS_OK;
}

/* Whoever still works is killed: its design counts as never asked for. */
static void drop_all(const Batch *b)
{
    for (size_t i = 0; i < b->n_workers; i++)
        if (b->worker[i].design != SIZE_MAX) {
            b->worker[i].design = SIZE_MAX;
            worker_kill(&b->worker[i]);
        }
}

static int is_over(const Batch *b)
{
    return b->done == b->n || b->status != STATUS_OK ||
           (b->ending > 0.0 && (b->done == b->next || clock_seconds() > b->ending + LAST_ANSWERS_S));
}

static Status run(External *e, Batch *b)
{
    while (!is_over(b)) {
        TRY(hand_out(e, b, b->err));
        wait_for_workers(b);
        for (size_t i = 0; i < b->n_workers; i++)
            look_after(e, &b->worker[i], &b->poll[2 * i], &b->poll[2 * i + 1], b);
    }
    drop_all(b);
    if (b->status == STATUS_OK && b->done < b->n)
        return fail(b->err, STATUS_STOPPED, "stopped");
    return b->status;
}

Status external_run(External *e, size_t n, const double X[], const long ids[], double F[], Answer answers[],
                    const Watch *watch, Err *err)
{
    return run(e, &(Batch){e->worker, e->poll, e->n_workers, .n = n, .X = X, .ids = ids, .F = F, .answers = answers,
                           .watch = watch, .err = err});
}

Status external_ask(External *e, size_t worker, const double x[], long id, double f[], Answer *answer,
                    const Watch *watch, Err *err)
{
    return run(e, &(Batch){e->worker + worker, e->poll + 2 * worker, 1, .n = 1, .X = x, .ids = &id, .F = f,
                           .answers = answer, .watch = watch, .err = err});
}

Status external_open(External **out, const char *command, size_t workers, double timeout_s, size_t n_var, size_t n_obj,
                     Err *err)
{
    External *e = calloc(1, sizeof *e);
    *out = NULL;
    if (!e)
        return fail(err, STATUS_NO_MEMORY, "no memory for workers");
    e->n_var = n_var;
    e->n_obj = n_obj;
    e->timeout_s = timeout_s;
    e->next_id = 1;
    e->worker = calloc(workers, sizeof *e->worker);
    e->poll = calloc(2 * workers, sizeof *e->poll);
    Status status = e->worker && e->poll ? split_command(e, command, err)
                                         : fail(err, STATUS_NO_MEMORY, "no memory for %zu workers", workers);
    for (size_t i = 0; status == STATUS_OK && i < workers; i++) {
        e->worker[i] = (Worker){.guard = &e->guard, .slot = i, .design = SIZE_MAX, .line = malloc(LINE_MAX_BYTES)};
        e->n_workers = i + 1;
        if (!e->worker[i].line)
            status = fail(err, STATUS_NO_MEMORY, "no memory for %zu workers", workers);
    }
    if (status == STATUS_OK)
        status = guard_start(&e->guard, workers, err);
    if (status == STATUS_OK)
        *out = e;
    else
        external_close(e);
    return status;
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
            if (w->pid && waitpid(w->pid, NULL, WNOHANG) == w->pid) {
                worker_forget(w);
                left--;
            }
        }
        if (left > 0)
            nanosleep(&(struct timespec){.tv_nsec = 5000000}, NULL);
    }
}

void external_close(External *e)
{
    if (!e)
        return;
    farewell(e);
    for (size_t i = 0; i < e->n_workers; i++) {
        worker_kill(&e->worker[i]);
        free(e->worker[i].line);
        free(e->worker[i].request);
    }
    guard_end(&e->guard);
    free(e->worker);
    free(e->poll);
    free(e->text);
    free(e);
}
