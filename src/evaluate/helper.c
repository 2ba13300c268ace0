#include "evaluate/helper.h"

#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <sys/pidfd.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

enum { TO_US = STDERR_FILENO + 1 };

typedef struct {
    pid_t pid;
    int why; /* errno */
} Started;

/* -- the helper's whole life: it comes of a program with threads, so only system calls ----------------------------- */

/* In the child, which shares the memory of the helper where it becomes a command. Returns where a call fails. */
static void become(const HelperWork *w, size_t slot, pid_t parent)
{
    sigset_t none;
    sigemptyset(&none);
    if (setpgid(0, 0) != 0 || prctl(PR_SET_PDEATHSIG, SIGKILL) != 0)
        return;
    if (getppid() != parent) /* it has ended before the signal was set */
        _exit(127);
    sigprocmask(SIG_SETMASK, &none, NULL);
    if (w->words) {
        execvp(w->words[0], w->words);
        return;
    }
    close(TO_US);
    w->serve(w->self, slot);
    _exit(0);
}

/* Start the worker in a process group of its own. A command shares our memory until it has begun, and with it why. */
static Started start_worker(const HelperWork *w, size_t slot)
{
    const pid_t parent = getpid();
    volatile int why = 0;
    const pid_t child = w->words ? vfork() : fork();
    if (child == 0) {
        become(w, slot, parent);
        why = errno;
        _exit(127);
    }
    setpgid(child, child); /* a fork may not have come to it yet, and is to be killed */
    return (Started){child, child < 0 ? errno : why};
}

/* Standard error is the worker's too. */
static _Noreturn void live(const HelperWork *w, size_t slot, int in, int out, int to)
{
    int how;
    sigset_t all;
    sigfillset(&all);
    sigprocmask(SIG_SETMASK, &all, NULL);
    setsid();
    dup2(in, STDIN_FILENO);
    dup2(out, STDOUT_FILENO);
    if (to != TO_US)
        dup3(to, TO_US, O_CLOEXEC);
    close_range(TO_US + 1, ~0U, 0);
    const Started s = start_worker(w, slot);
    close(STDIN_FILENO);
    close(STDOUT_FILENO);
    send(TO_US, &s, sizeof s, MSG_NOSIGNAL);
    if (!s.why)
        poll((struct pollfd[]){{TO_US, POLLIN, 0}, {pidfd_open(s.pid, 0), POLLIN, 0}}, 2, -1);
    if (s.pid > 0) {
        kill(-s.pid, SIGKILL);
        waitpid(s.pid, &how, 0);
        send(TO_US, &how, sizeof how, MSG_NOSIGNAL);
    }
    _exit(0);
}

/* -- the program --------------------------------------------------------------------------------------------------- */

/* Whether a message of that size has come; the end of the helper is none. */
static int hear(const Helper *h, void *message, size_t size)
{
    ssize_t n;
    while ((n = recv(h->to, message, size, 0)) < 0 && errno == EINTR)
        ;
    return n == (ssize_t)size;
}

int helper_start(Helper *h, const HelperWork *work, size_t slot, int in, int out)
{
    int ends[2];
    Started s = {0};
    if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0)
        return errno;
    *h = (Helper){.pid = fork(), .to = ends[0]};
    if (h->pid == 0)
        live(work, slot, in, out, ends[1]);
    s.why = errno;
    close(ends[1]);
    if (h->pid > 0 && !hear(h, &s, sizeof s))
        s.why = ECHILD;
    h->group = s.pid;
    if (s.why)
        helper_end(h);
    return s.why;
}

int helper_end(Helper *h)
{
    int how;
    shutdown(h->to, SHUT_WR);
    if (!hear(h, &how, sizeof how)) {
        how = -1;
        if (h->group > 0)
            kill(-h->group, SIGKILL);
    }
    close(h->to);
    while (h->pid > 0 && waitpid(h->pid, NULL, 0) < 0 && errno == EINTR)
        ;
    *h = (Helper){0};
    return how;
}
