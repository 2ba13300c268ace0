#include "evaluate/guard.h"

#include <errno.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

typedef struct {
    size_t slot;
    pid_t group;
} Note;

/* The guard's whole life, after fork() in a program with threads: only calls that are allowed in a signal handler. All
 * files are closed, for a lock or another program's pipe would live on with them. */
static _Noreturn void watch_over(int from, size_t n_slots, pid_t group[])
{
    Note note;
    ssize_t n;
    setsid();
    dup2(from, STDIN_FILENO);
    close_range(STDIN_FILENO + 1, ~0U, 0);
    while ((n = recv(STDIN_FILENO, &note, sizeof note, 0)) > 0 || (n < 0 && errno == EINTR))
        if (n == (ssize_t)sizeof note && note.slot < n_slots)
            group[note.slot] = note.group;
    for (size_t i = 0; i < n_slots; i++)
        if (group[i] > 0)
            kill(-group[i], SIGKILL);
    _exit(0);
}

static Status start_process(Guard *g, Err *err)
{
    int ends[2];
    if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0)
        return fail(err, STATUS_INTERNAL, "no socket to watch over the workers: %s", strerror(errno));
    const pid_t pid = fork();
    const int cause = errno;
    if (pid == 0)
        watch_over(ends[0], g->n_slots, g->group);
    close(ends[0]);
    if (pid < 0) {
        close(ends[1]);
        return fail(err, STATUS_INTERNAL, "no process to watch over the workers: %s", strerror(cause));
    }
    g->pid = pid;
    g->to = ends[1];
    return STATUS_OK;
}

static void forget_process(Guard *g)
{
    if (g->pid == 0)
        return;
    close(g->to);
    while (waitpid(g->pid, NULL, 0) < 0 && errno == EINTR)
        ;
    g->pid = 0;
}

Status guard_start(Guard *g, size_t n_slots, Err *err)
{
    *g = (Guard){.n_slots = n_slots, .group = calloc(n_slots, sizeof *g->group)};
    if (!g->group)
        return fail(err, STATUS_NO_MEMORY, "no memory to watch over %zu workers", n_slots);
    pthread_mutex_init(&g->lock, NULL);
    return start_process(g, err);
}

void guard_tell(Guard *g, size_t slot, pid_t group)
{
    Note note;
    memset(&note, 0, sizeof note); /* padding included */
    note.slot = slot;
    note.group = group;
    pthread_mutex_lock(&g->lock);
    g->group[slot] = group;
    while (g->pid && send(g->to, &note, sizeof note, MSG_NOSIGNAL) < 0 && errno == EINTR)
        ;
    pthread_mutex_unlock(&g->lock);
    guard_look(g);
}

/* It writes nothing, so that there is something to be read only when its end of the socket is closed. A new one begins
 * with what this one knew. */
void guard_look(Guard *g)
{
    char byte;
    pthread_mutex_lock(&g->lock);
    if (g->pid && recv(g->to, &byte, 1, MSG_PEEK | MSG_DONTWAIT) == 0)
        forget_process(g);
    if (!g->pid)
        start_process(g, &(Err){0});
    pthread_mutex_unlock(&g->lock);
}

void guard_end(Guard *g)
{
    if (!g->group)
        return;
    forget_process(g);
    pthread_mutex_destroy(&g->lock);
    free(g->group);
    *g = (Guard){0};
}
