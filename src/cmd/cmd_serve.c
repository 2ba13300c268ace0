#include <limits.h>
#include <time.h>
#include <unistd.h>

#include "cmd/commands.h"
#include "cmd/signals.h"
#include "serve/serve.h"

static Status run(const Args *args, Err *err)
{
    Server *server;
    ServeOptions options = {.folder = args->operand};
    long port;
    TRY(args_moved(args, &options.moved, err));
    TRY(args_whole(args, "--port", 1, 65535, 0, &port, err));
    options.port = (int)port;
    signals_catch();
    TRY(serve_open(&server, &options, err));
    char host[HOST_NAME_MAX + 1] = "HOST";
    const char *user = getenv("USER");
    gethostname(host, sizeof host - 1);
    printf("%s is shown at\n  %s\n"
           "from another machine run  ssh -N -L %d:127.0.0.1:%d %s@%s  and open the same address\nCtrl-C ends it\n",
           args->operand, serve_url(server), serve_port(server), serve_port(server), user && *user ? user : "USER",
           host);
    fflush(stdout);
    while (!signals_asked(NULL))
        nanosleep(&(struct timespec){.tv_nsec = 100000000}, NULL);
    _exit(fflush(stdout)); /* nothing is to be stored, and no simulation under way is waited for */
}

const Command CMD_SERVE = {
    .name = "serve",
    .group = GROUP_STUDY,
    .operand = "RUN",
    .summary = "a run as a live page in the browser: progress, any design, what-if",
    .example = "imtet serve results/quick",
    .details =

        "Serves the page of `imtet report` on this machine alone (127.0.0.1), at an address that cannot be\n"
        "guessed. The page also shows the progress of a running study, simulates any design at a click, and\n"
        "has sliders that change gaps, thickness, motion and restitution of a design and show its response\n"
        "at once. RUN may be a folder of runs: the page then lists them and compares up to four. The server\n"
        "writes nothing but notes on designs. Ctrl-C ends it.",
    .options =
        {
            VALUE("--port", "N", "port of the server (default: a free one)"),
            OPTION_MOVED,
        },
    .is_alone = 1,
    .run = run,
};
