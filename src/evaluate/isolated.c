#include "evaluate/isolated.h"

#include <errno.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

enum { LOOK_MS = 200 };

typedef struct {
    pid_t pid; /* 0: none */
    int fd;
} Child;

struct Isolated {
    size_t n_workers;
    IsolatedWork work;
    pthread_mutex_t lock; /* while one is forked: it closes the sockets of all others, that they see our end */
    Child child[];        /* (n_workers) */
};

typedef struct {
    Status status;
    Err err;
} Answer;

Status isolated_open(Isolated **out, size_t n_workers, const IsolatedWork *work, Err *err)
{
    Isolated *q = *out = calloc(1, sizeof *q + n_workers * sizeof(Child));
    if (!q)
        return fail_memory(err, n_workers, "processes");
    q->n_workers = n_workers;
    q->work = *work;
    pthread_mutex_init(&q->lock, NULL);
    return STATUS_OK;
}

/* Whole or not at all; 0: the other end has gone. */
static int pass(int fd, void *bytes, size_t n, int is_sent)
{
    char *at = bytes;
    for (ssize_t k; n > 0; at += k, n -= (size_t)k) {
        do
            k = is_sent ? send(fd, at, n, MSG_NOSIGNAL) : recv(fd, at, n, 0);
        while (k < 0 && errno == EINTR);
        if (k <= 0)
            return 0;
    }
    return 1;
}

static int go_on(void *user)
{
    (void)user;
    return 1;
}

/* The child: tasks until nobody sends any. */
static void serve(int fd, size_t worker, const IsolatedWork *work)
{
    Task task;
    while (pass(fd, &task, sizeof task, 0)) {
        Answer answer = {0};
        double *x = calloc(work->n_var, sizeof *x);
        task.result = calloc(1, task.size);
        task.x = x;
        task.may_go_on = go_on;
        if (!x || !task.result || !pass(fd, x, work->n_var * sizeof *x, 0))
            break;
        answer.status = work->simulate(work->self, worker, &task, &answer.err);
        if (!pass(fd, &answer, sizeof answer, 1) || !pass(fd, task.result, task.size, 1))
            break;
        free(x);
        free(task.result);
    }
    _exit(0);
}

/* Returns how it ended. */
static int end_child(Child *c)
{
    int status = 0;
    if (c->pid == 0)
        return 0;
    shutdown(c->fd, SHUT_RDWR); /* processes of another Isolated may have this end too */
    close(c->fd);
    waitpid(c->pid, &status, 0);
    c->pid = 0;
    return WIFSIGNALED(status) ? WTERMSIG(status) : -1;
}

static Status start_child(Isolated *q, size_t worker, Err *err)
{
    int ends[2] = {-1, -1};
    pthread_mutex_lock(&q->lock);
    const pid_t pid = socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) == 0 ? fork() : -1;
    const int cause = errno;
    if (pid == 0) {
        for (size_t i = 0; i < q->n_workers; i++)
            if (q->child[i].pid > 0)
                close(q->child[i].fd);
        close(ends[0]);
        serve(ends[1], worker, &q->work);
    }
    close(ends[1]);
    if (pid > 0)
        q->child[worker] = (Child){pid, ends[0]};
    else
        close(ends[0]);
    pthread_mutex_unlock(&q->lock);
    return pid > 0 ? STATUS_OK : fail(err, STATUS_INTERNAL, "run.isolate: no process: %s", strerror(cause));
}

/* Of a task that is sent; 0: the child has ended. */
static int take_answer(Child *c, const Task *task, Status *status, Err *err)
{
    Answer answer;
    while (poll(&(struct pollfd){c->fd, POLLIN, 0}, 1, LOOK_MS) <= 0)
        if (!task->may_go_on(task->user)) {
            kill(c->pid, SIGKILL);
            end_child(c);
            *status = fail(err, STATUS_STOPPED, "stopped");
            return 1;
        }
    if (!pass(c->fd, &answer, sizeof answer, 0) || !pass(c->fd, task->result, task->size, 0))
        return 0;
    *err = answer.status == STATUS_OK ? *err : answer.err;
    *status = answer.status;
    return 1;
}

Status isolated_run(Isolated *q, size_t worker, const Task *task, int *how, Err *err)
{
    Child *c = &q->child[worker];
    Status status = STATUS_OK;
    Task sent = *task;
    const size_t n_x = q->work.n_var * sizeof *task->x;
    *how = 0;
    if (c->pid > 0 && waitpid(c->pid, NULL, WNOHANG) != 0) { /* since its last answer: no fault of this design */
        close(c->fd);
        c->pid = 0;
    }
    if (c->pid == 0)
        TRY(start_child(q, worker, err));
    if (!pass(c->fd, &sent, sizeof sent, 1) || !pass(c->fd, (void *)(uintptr_t)task->x, n_x, 1) ||
        !take_answer(c, task, &status, err))
        *how = end_child(c);
    return status;
}

void isolated_close(Isolated *q)
{
    for (size_t i = 0; q && i < q->n_workers; i++)
        end_child(&q->child[i]);
    if (q)
        pthread_mutex_destroy(&q->lock);
    free(q);
}
