#include "evaluate/spawner.h"

#include <errno.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

struct SpawnJob {
    char *const *words;
    int in, out, is_done, why; /* why: errno */
    pid_t pid;
};

/* In the child, which shares the memory of the program: only system calls. Returns where one fails. */
static void become(const SpawnJob *job, pid_t parent)
{
    sigset_t none;
    sigemptyset(&none);
    if (setpgid(0, 0) != 0 || dup2(job->in, STDIN_FILENO) < 0 || dup2(job->out, STDOUT_FILENO) < 0 ||
        prctl(PR_SET_PDEATHSIG, SIGKILL) != 0)
        return;
    if (getppid() != parent) /* it has ended before the signal was set */
        _exit(127);
    sigprocmask(SIG_SETMASK, &none, NULL);
    execvp(job->words[0], job->words);
}

static void start(SpawnJob *job)
{
    const pid_t parent = getpid(), child = vfork();
    if (child == 0) {
        become(job, parent);
        job->why = errno;
        _exit(127);
    }
    if (child < 0)
        job->why = errno;
    else if (job->why)
        waitpid(child, NULL, 0);
    job->pid = child;
}

/* Without signals: they are those of the other threads, and a handler must not run in a child that shares the memory. */
static void *work(void *user)
{
    Spawner *s = user;
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_BLOCK, &all, NULL);
    pthread_mutex_lock(&s->lock);
    while (!s->is_ending) {
        if (s->job) {
            start(s->job);
            s->job->is_done = 1;
            s->job = NULL;
            pthread_cond_broadcast(&s->changed);
        }
        pthread_cond_wait(&s->changed, &s->lock);
    }
    pthread_mutex_unlock(&s->lock);
    return NULL;
}

Status spawner_start(Spawner *s, Err *err)
{
    *s = (Spawner){.is_running = 1};
    pthread_mutex_init(&s->lock, NULL);
    pthread_cond_init(&s->changed, NULL);
    if (pthread_create(&s->thread, NULL, work, s) == 0)
        return STATUS_OK;
    s->is_running = 0;
    return fail(err, STATUS_NO_MEMORY, "no thread to start workers");
}

int spawner_run(Spawner *s, char *const words[], int in, int out, pid_t *pid)
{
    SpawnJob job = {.words = words, .in = in, .out = out};
    pthread_mutex_lock(&s->lock);
    while (s->job)
        pthread_cond_wait(&s->changed, &s->lock);
    s->job = &job; /* until it is done, which is waited for */
    pthread_cond_broadcast(&s->changed);
    while (!job.is_done)
        pthread_cond_wait(&s->changed, &s->lock);
    pthread_mutex_unlock(&s->lock);
    *pid = job.why ? 0 : job.pid;
    return job.why;
}

void spawner_end(Spawner *s)
{
    if (!s->is_running)
        return;
    pthread_mutex_lock(&s->lock);
    s->is_ending = 1;
    pthread_cond_broadcast(&s->changed);
    pthread_mutex_unlock(&s->lock);
    pthread_join(s->thread, NULL);
    pthread_cond_destroy(&s->changed);
    pthread_mutex_destroy(&s->lock);
    *s = (Spawner){0};
}
