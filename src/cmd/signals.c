#include "cmd/signals.h"

#include <signal.h>
#include <stddef.h>

/* A handler has no argument for its state: the one place where the program keeps some of its own. */
static volatile sig_atomic_t asked;

static const int WISHES[] = {SIGINT, SIGTERM, SIGHUP};
enum { N_WISHES = sizeof WISHES / sizeof WISHES[0] };

static void note(int signal_number)
{
    asked = signal_number;
    for (int i = 0; i < N_WISHES; i++)
        signal(WISHES[i], SIG_DFL);
}

void signals_catch(void)
{
    const struct sigaction wanted = {.sa_handler = note, .sa_flags = SA_RESTART};
    struct sigaction before;
    asked = 0;
    for (int i = 0; i < N_WISHES; i++)
        if (sigaction(WISHES[i], NULL, &before) == 0 && (WISHES[i] != SIGHUP || before.sa_handler != SIG_IGN))
            sigaction(WISHES[i], &wanted, NULL); /* under nohup the end of the terminal stays without meaning */
    signal(SIGXFSZ, SIG_IGN);
}

int signals_asked(void *unused)
{
    (void)unused;
    return asked;
}
