#include "cmd/signals.h"

#include <signal.h>
#include <stddef.h>

/* A handler has no argument for its state: the one place where the program keeps some of its own. */
static volatile sig_atomic_t asked;

static void note(int signal_number)
{
    asked = signal_number;
    signal(SIGINT, SIG_DFL);
    signal(SIGTERM, SIG_DFL);
}

void signals_catch(void)
{
    struct sigaction action = {.sa_handler = note};
    sigemptyset(&action.sa_mask);
    asked = 0;
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    signal(SIGXFSZ, SIG_IGN);
}

int signals_asked(void *unused)
{
    (void)unused;
    return asked;
}
