#include "evaluate/pool.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdarg.h>
#include <unistd.h>

#include "base/clock.h"

enum { READ_BYTES = 1 << 16 };

/* A worker is looked at so often; and of a pause no more than twice that is its silence. */
static const double LOOK_S = 0.1;

/* A process that ends so soon after a request had ended after its answer before. */
static const double LEFT_BEFORE_S = 1.0;

/* To end by itself when its input has. */
static const double FAREWELL_S = 1.0;

/* -- one process --------------------------------------------------------------------------------------------------- */

static void close_pipes(const Worker *w)
{
    close(w->in);
    close(w->out);
    close(w->reader);
}

/* Open the pipes of a worker, and start its process; a worker that is none has one pipe, from us to us. */
static Status worker_start(Worker *w, Err *err)
{
    const Protocol *how = &w->pool->protocol;
    int to[2] = {-1, -1}, from[2] = {-1, -1}; /* the worker */
    int why = (!how->send && pipe2(to, O_CLOEXEC) != 0) || pipe2(from, O_CLOEXEC) != 0 ? errno : 0;
    if (!why && !how->send)
        why = helper_start(&w->helper, &how->work, w - w->pool->worker, to[0], from[1]);
    w->reader = how->send ? -1 : to[0];
    w->in = how->send ? from[1] : to[1];
    w->out = from[0];
    w->n_line = w->n_answered = w->n_sent = 0;
    if (!how->send)
        close(from[1]);
    if (why) {
        close_pipes(w);
        return bad_data(err, "%s: %s cannot be started: %s", how->name,
                        how->work.words ? *how->work.words : "a process", strerror(why));
    }
    fcntl(w->in, F_SETFL, O_NONBLOCK);
    fcntl(w->out, F_SETFL, O_NONBLOCK);
    return STATUS_OK;
}

static void worker_end(Worker *w)
{
    if (w->helper.pid == 0)
        return;
    w->how = helper_end(&w->helper);
    close_pipes(w);
}

/* Takes what comes. The end of a process counts where it left nothing to be read: a child of it may hold its output
 * open. */
static int listen_to(Worker *w, double seconds)
{
    const Protocol *how = &w->pool->protocol;
    struct pollfd ends[3] = {
        {w->n_sent < w->n_request ? w->in : -1, POLLOUT, 0}, {w->out, POLLIN, 0}, {w->helper.to, POLLIN, 0}};
    if (poll(ends, 3, (int)ceil(1e3 * seconds)) <= 0)
        return 0;
    if (!ends[1].revents && ends[2].revents)
        return 1;
    const ssize_t n = ends[1].revents
                          ? read(w->out, w->line + w->n_line, MIN_OF(LINE_MAX_BYTES - w->n_line, READ_BYTES))
                          : write(w->in, w->request + w->n_sent, w->n_request - w->n_sent);
    if (ends[1].revents && n > 0) {
        w->n_line += n;
        how->look(how->self, w);
    } else if (n > 0) {
        w->n_sent += n;
    }
    return ends[1].revents && (n == 0 || (n < 0 && errno != EAGAIN && errno != EINTR));
}

/* -- what becomes of its tasks ------------------------------------------------------------------------------------- */

void pool_settle(Worker *w, Outcome outcome, int kill_it, const char *format, ...)
{
    const Protocol *how = &w->pool->protocol;
    char reason[REASON_MAX];
    va_list list;
    if (kill_it)
        worker_end(w);
    if (kill_it && w->n > 1 && !how->send) { /* whose fault it was is not known */
        w->n = w->n_done;
        return;
    }
    va_start(list, format);
    vsnprintf(reason, sizeof reason, format, list);
    va_end(list);
    how->tell(how->self, w, outcome, reason);
    w->n_done += w->n_done < w->n;
    w->asked = clock_seconds();
}

Status pool_ask(Worker *w, size_t n, const Task tasks[], Err *err)
{
    const Protocol *how = &w->pool->protocol;
    w->task = tasks;
    w->n = n;
    w->n_done = 0;
    w->silent_s = 0.0;
    w->why = (Err){0};
    w->is_second = 0;
    if (w->helper.pid && poll(&(struct pollfd){w->helper.to, POLLIN, 0}, 1, 0) > 0)
        worker_end(w); /* it ended after its last answer: no fault of any design */
    if (w->helper.pid == 0 && !how->send)
        TRY(worker_start(w, err));
    w->n_request = how->write(how->self, w, w->request);
    w->n_sent = how->send ? w->n_request : 0;
    w->asked = clock_seconds();
    if (how->send)
        how->send(how->self, w);
    how->look(how->self, w); /* a worker that wrote without being asked */
    return STATUS_OK;
}

/* Wait until the tasks of a worker are settled, or no more is wanted and the worker has had its time to end. */
Status pool_wait(Worker *w, Err *err)
{
    const Protocol *how = &w->pool->protocol;
    const double limit_s = how->timeout_s * (how->send ? 1.0 : (double)w->n);
    double before = clock_seconds(), ending = 0.0; /* since when no more is wanted */
    while (w->n_done < w->n) {
        const int has_gone = listen_to(w, fmax(fmin(limit_s - w->silent_s, LOOK_S), 0.0));
        const double now = clock_seconds();
        w->silent_s += fmin(now - before, 2.0 * LOOK_S);
        before = now;

        /* 1. A worker that has ended, or is silent, is lost, and so is its task; of an end that was not the fault of
         * that a fresh worker is asked, once. */
        if (w->n_done < w->n && (has_gone || w->silent_s >= limit_s)) {
            const int was_leaving = how->may_leave && w->n_answered > 0 && w->n_line == 0 && !w->is_second &&
                                    clock_seconds() < w->asked + LEFT_BEFORE_S;
            worker_end(w);
            if (has_gone && w->n == 1 && (was_leaving || w->how == -1)) {
                w->is_second = 1;
                TRY(worker_start(w, err));
            } else if (has_gone) {
                pool_settle(w, OUTCOME_DEAD, 1, "the worker ended without an answer");
            } else {
                pool_settle(w, OUTCOME_TIMEOUT, 1, "no answer within %g s", how->timeout_s);
            }
        }

        /* 2. No more may be wanted. */
        if (w->n_done < w->n && ending > 0.0 && now > ending + how->grace_s) {
            worker_end(w);
            return fail(err, STATUS_STOPPED, "stopped");
        }
        if (ending == 0.0 && !goes_on(w->task->observer))
            ending = now;
    }
    if (w->why.code != STATUS_OK)
        *err = w->why;
    return w->why.code;
}

/* What a process that failed left of a batch is asked one by one, so that the design at fault fails alone. */
Status pool_do(Pool *p, size_t worker, size_t n, const Task tasks[], size_t *n_done, Err *err)
{
    Worker *w = &p->worker[worker];
    Status status = STATUS_OK;
    size_t most = TASKS_MAX;
    for (*n_done = 0; status == STATUS_OK && *n_done < n; *n_done += w->n_done) {
        const size_t asked = MIN_OF(MIN_OF(most, w->batch), n - *n_done);
        status = pool_ask(w, asked, tasks + *n_done, err);
        THEN(status, pool_wait(w, err));
        most = w->n_done < asked ? 1 : most;
    }
    return status;
}

/* -- life ---------------------------------------------------------------------------------------------------------- */

int pool_batch(Worker *w, size_t n)
{
    if (n < 1 || n > TASKS_MAX)
        return 0;
    char *room = n > w->batch ? realloc(w->request, n * w->pool->protocol.request_bytes) : w->request;
    if (room) {
        w->request = room;
        w->batch = n;
    }
    return 1;
}

Status pool_open(Pool *p, const Protocol *protocol, size_t n_workers, Err *err)
{
    *p = (Pool){.protocol = *protocol};
    TRY_ROOM(p->worker, n_workers, "workers", err);
    while (p->n_workers < n_workers) {
        Worker *w = &p->worker[p->n_workers++];
        *w = (Worker){.pool = p, .helper.to = -1, .in = -1, .out = -1, .reader = -1, .line = malloc(LINE_MAX_BYTES)};
        pool_batch(w, 1);
        if (!w->line || !w->request)
            return fail_memory(err, n_workers, "workers");
        if (!protocol->work.words) /* forks, while no thread holds a lock */
            TRY(worker_start(w, err));
    }
    return STATUS_OK;
}

/* Input closed, a moment to end by itself. */
void pool_close(Pool *p)
{
    const double until = clock_seconds() + FAREWELL_S;
    for (size_t i = 0; i < p->n_workers; i++)
        if (p->worker[i].helper.pid) {
            close(p->worker[i].in);
            p->worker[i].in = -1;
        }
    for (size_t i = 0; i < p->n_workers; i++) {
        Worker *w = &p->worker[i];
        if (w->helper.pid)
            poll(&(struct pollfd){w->helper.to, POLLIN, 0}, 1, (int)(1e3 * fmax(until - clock_seconds(), 0.0)));
        worker_end(w);
        if (p->protocol.send)
            close_pipes(w);
        free(w->line);
        free(w->request);
    }
    free(p->worker);
}
