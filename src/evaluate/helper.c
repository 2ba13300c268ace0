#include "evaluate/helper.h"

#include <errno.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

typedef enum { RUN, KILL, FORGET } What;

typedef struct {
    size_t slot;
    What what;
} Order;

typedef struct {
    pid_t pid;
    int why; /* errno */
} Reply;

/* A message with room for two descriptors beside it. */
typedef struct {
    struct msghdr head;
    struct iovec part;
    union {
        struct cmsghdr head;
        char bytes[CMSG_SPACE(2 * sizeof(int))];
    } beside;
} Message;

static void message_make(Message *m, Order *order)
{
    memset(m, 0, sizeof *m);
    m->part = (struct iovec){order, sizeof *order};
    m->head = (struct msghdr){
        .msg_iov = &m->part, .msg_iovlen = 1, .msg_control = m->beside.bytes, .msg_controllen = sizeof m->beside.bytes};
}

/* -- the helper's whole life: it may have come of a program with threads, so only system calls --------------------- */

/* In the child, which shares the memory of the helper. Returns where a call fails. */
static void become(char *const words[], const int ends[2], pid_t parent)
{
    sigset_t none;
    sigemptyset(&none);
    if (setpgid(0, 0) != 0 || dup2(ends[0], STDIN_FILENO) < 0 || dup2(ends[1], STDOUT_FILENO) < 0 ||
        prctl(PR_SET_PDEATHSIG, SIGKILL) != 0)
        return;
    if (getppid() != parent) /* it has ended before the signal was set */
        _exit(127);
    sigprocmask(SIG_SETMASK, &none, NULL);
    execvp(words[0], words);
}

static Reply start_worker(char *const words[], const int ends[2])
{
    const pid_t parent = getpid();
    volatile int why = 0;
    const pid_t child = vfork();
    if (child == 0) {
        become(words, ends, parent);
        why = errno;
        _exit(127);
    }
    if (child > 0 && why)
        waitpid(child, NULL, 0);
    return child < 0 ? (Reply){0, errno} : (Reply){why ? 0 : child, why};
}

static Reply obey(const Helper *h, const Order *order, const int ends[2])
{
    pid_t *group = &h->group[order->slot];
    Reply reply = {0};
    if (order->what == RUN) {
        reply = start_worker(h->words, ends);
        close(ends[0]);
        close(ends[1]);
    } else if (*group > 0) {
        if (order->what == KILL)
            kill(-*group, SIGKILL);
        waitpid(*group, NULL, 0);
    }
    *group = reply.pid;
    return reply;
}

static _Noreturn void live(const Helper *h, int from)
{
    Order order;
    Message m;
    sigset_t all;
    sigfillset(&all);
    sigprocmask(SIG_SETMASK, &all, NULL);
    setsid();
    dup2(from, STDIN_FILENO);
    close(STDOUT_FILENO); /* standard error is the workers' too */
    close_range(STDERR_FILENO + 1, ~0U, 0);
    for (;;) {
        int ends[2] = {-1, -1};
        message_make(&m, &order);
        if (recvmsg(STDIN_FILENO, &m.head, MSG_CMSG_CLOEXEC) <= 0)
            break;
        const struct cmsghdr *beside = CMSG_FIRSTHDR(&m.head);
        if (beside)
            memcpy(ends, CMSG_DATA(beside), sizeof ends);
        const Reply reply = obey(h, &order, ends);
        send(STDIN_FILENO, &reply, sizeof reply, MSG_NOSIGNAL);
    }
    for (size_t i = 0; i < h->n_slots; i++)
        if (h->group[i] > 0)
            kill(-h->group[i], SIGKILL);
    _exit(0);
}

/* -- the program --------------------------------------------------------------------------------------------------- */

static void forget_process(Helper *h)
{
    if (h->pid == 0)
        return;
    close(h->to);
    while (waitpid(h->pid, NULL, 0) < 0 && errno == EINTR)
        ;
    h->pid = 0;
}

static int start_process(Helper *h)
{
    int ends[2];
    if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0)
        return errno;
    h->pid = fork();
    const int cause = errno;
    if (h->pid == 0)
        live(h, ends[0]);
    close(ends[0]);
    h->to = ends[1];
    if (h->pid > 0)
        return 0;
    close(ends[1]);
    h->pid = 0;
    return cause;
}

Status helper_start(Helper *h, char *const words[], size_t n_slots, Err *err)
{
    *h = (Helper){.words = words, .n_slots = n_slots, .group = calloc(n_slots, sizeof *h->group)};
    if (!h->group)
        return fail(err, STATUS_NO_MEMORY, "no memory to watch over %zu workers", n_slots);
    pthread_mutex_init(&h->lock, NULL);
    const int cause = start_process(h);
    return cause ? fail(err, STATUS_INTERNAL, "no process to start workers: %s", strerror(cause)) : STATUS_OK;
}

/* 0: there is no helper any more. */
static int command(Helper *h, Order order, const int ends[2], Reply *reply)
{
    Message m;
    ssize_t n;
    message_make(&m, &order);
    if (ends) {
        m.beside.head = (struct cmsghdr){CMSG_LEN(2 * sizeof(int)), SOL_SOCKET, SCM_RIGHTS};
        memcpy(CMSG_DATA(&m.beside.head), ends, 2 * sizeof(int));
    } else {
        m.head.msg_controllen = 0;
    }
    while ((n = sendmsg(h->to, &m.head, MSG_NOSIGNAL)) < 0 && errno == EINTR)
        ;
    while (n > 0 && (n = recv(h->to, reply, sizeof *reply, 0)) < 0 && errno == EINTR)
        ;
    return n == (ssize_t)sizeof *reply;
}

int helper_run(Helper *h, size_t slot, int in, int out, pid_t *pid)
{
    const int ends[2] = {in, out};
    Reply reply = {0};
    pthread_mutex_lock(&h->lock);
    if (!h->pid || !command(h, (Order){slot, RUN}, ends, &reply)) {
        forget_process(h);
        reply.why = start_process(h);
        if (!reply.why && !command(h, (Order){slot, RUN}, ends, &reply))
            reply.why = ECHILD;
    }
    h->group[slot] = *pid = reply.why ? 0 : reply.pid;
    pthread_mutex_unlock(&h->lock);
    return reply.why;
}

/* What a worker of a helper that is gone has left behind is killed here. */
void helper_release(Helper *h, size_t slot, int kill_it)
{
    Reply reply;
    pthread_mutex_lock(&h->lock);
    if (h->group[slot] > 0 && (!h->pid || !command(h, (Order){slot, kill_it ? KILL : FORGET}, NULL, &reply)))
        kill(-h->group[slot], SIGKILL);
    h->group[slot] = 0;
    pthread_mutex_unlock(&h->lock);
}

int helper_is_lost(Helper *h)
{
    char byte;
    pthread_mutex_lock(&h->lock);
    const int is_lost = !h->pid || recv(h->to, &byte, 1, MSG_PEEK | MSG_DONTWAIT) == 0;
    pthread_mutex_unlock(&h->lock);
    return is_lost;
}

void helper_end(Helper *h)
{
    if (!h->group)
        return;
    forget_process(h);
    pthread_mutex_destroy(&h->lock);
    free(h->group);
    *h = (Helper){0};
}
