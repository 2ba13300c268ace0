#include "cmd/signals.h"

#include <errno.h>
#include <signal.h>
#include <stdatomic.h>
#include <time.h>

/* A handler has no argument for its state: the one place where the program keeps some of its own. */
static atomic_int asked;
static atomic_llong first_ns; /* when the first one came, 0: none did */

/* `timeout` and others signal the process and then its group: that is one request. */
static const long long ONE_WISH_NS = 200000000;

static const int STOP_SIGNALS[] = {SIGINT, SIGTERM, SIGHUP, SIGUSR1};
enum { N_STOP_SIGNALS = sizeof STOP_SIGNALS / sizeof STOP_SIGNALS[0] };

static void note(int signal_number)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t); /* allowed in a handler: signal-safety(7) */
    const long long now = 1000000000LL * t.tv_sec + t.tv_nsec;
    const int before = errno; /* of the call that is interrupted */
    long long first = 0;
    if (atomic_compare_exchange_strong(&first_ns, &first, now))
        atomic_store(&asked, signal_number);
    else if (now - first >= ONE_WISH_NS) {
        signal(signal_number, SIG_DFL);
        raise(signal_number); /* comes when the handler returns */
    }
    errno = before;
}

void signals_catch(void)
{
    const struct sigaction wanted = {.sa_handler = note, .sa_flags = SA_RESTART};
    struct sigaction before;
    atomic_store(&asked, 0);
    atomic_store(&first_ns, 0);
    for (int i = 0; i < N_STOP_SIGNALS; i++)
        if (sigaction(STOP_SIGNALS[i], NULL, &before) == 0 && before.sa_handler != SIG_IGN)
            sigaction(STOP_SIGNALS[i], &wanted, NULL); /* what nohup, or the shell behind `&`, ignores stays ignored */
    signal(SIGXFSZ, SIG_IGN);
}

int signals_asked(void *)
{
    return atomic_load(&asked);
}
