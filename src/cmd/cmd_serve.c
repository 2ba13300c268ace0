#include <fcntl.h>
#include <limits.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "cmd/commands.h"
#include "cmd/signals.h"
#include "serve/serve.h"

/* The address holds the token and stands on no command line, which all users of the machine see: the browser is given a
 * file that leads there and that only its user can read. */
static Status open_browser(const char *url, char path[PATH_MAX], Err *err)
{
    const char *place = getenv("XDG_RUNTIME_DIR");
    char *words[] = {"xdg-open", path, NULL};
    posix_spawn_file_actions_t quiet;
    pid_t pid;
    snprintf(path, PATH_MAX, "%s/imtet-XXXXXX.html", place && *place ? place : "/tmp");
    const int fd = mkstemps(path, 5);
    FILE *f = fd >= 0 ? fdopen(fd, "w") : NULL;
    if (!f) {
        path[0] = 0;
        return fail(err, STATUS_IO, "--open: no file for the browser; open the address above yourself");
    }
    fprintf(f, "<!DOCTYPE html><meta http-equiv=\"refresh\" content=\"0;url=%s\">\n", url);
    fclose(f);
    posix_spawn_file_actions_init(&quiet);
    posix_spawn_file_actions_addopen(&quiet, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_addopen(&quiet, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    const int failed = posix_spawnp(&pid, words[0], &quiet, NULL, words, environ);
    posix_spawn_file_actions_destroy(&quiet);
    return failed ? fail(err, STATUS_MISSING, "--open: xdg-open is not there; open the address above yourself")
                  : STATUS_OK;
}

static void greet(const Server *s, const char *folder)
{
    char host[HOST_NAME_MAX + 1] = "HOST";
    const char *user = getenv("USER");
    gethostname(host, sizeof host - 1);
    printf("%s is shown at\n  %s\nfrom another machine: ssh -N -L %d:127.0.0.1:%d %s@%s   and the same address there\n"
           "Ctrl-C ends it\n",
           folder, serve_url(s), serve_port(s), serve_port(s), user && *user ? user : "USER", host);
    fflush(stdout);
}

static Status run(const Args *args, Err *err)
{
    Server *server;
    ServeOptions options = {.folder = args->operand};
    char page[PATH_MAX] = "";
    Err why = {0};
    long port;
    TRY(args_moved(args, &options.moved, err));
    TRY(args_whole(args, "--port", 1, 65535, 0, &port, err));
    options.port = (int)port;
    signals_catch();
    TRY(serve_open(&server, &options, err));
    greet(server, args->operand);
    if (args_has(args, "--open") && open_browser(serve_url(server), page, &why) != STATUS_OK)
        fprintf(stderr, "%s\n", why.text);
    while (!signals_asked(NULL))
        nanosleep(&(struct timespec){.tv_nsec = 100000000}, NULL);
    if (page[0])
        unlink(page);
    _exit(fflush(stdout)); /* nothing is to be stored, and no simulation under way is waited for */
}

static const ArgOption OPTIONS[] = {
    {"--port", "N", NULL, 0, "on this port (default: one that is free)"},
    {"--open", NULL, NULL, 0, "opens the page in the browser of this machine"},
    OPTION_MOVED,
    OPTION_END,
};

const Command CMD_SERVE = {
    .name = "serve",
    .group = GROUP_STUDY,
    .operand = "RUN",
    .summary = "a run as a page in the browser, live: progress, any design, what-if",
    .example = "imtet serve results/quick --open",
    .details =
        "Serves the page of `imtet report` on this machine alone (127.0.0.1), at an address that nobody guesses, and\n"
        "with it the progress of a run under way, any design simulated at a click, and sliders that change gaps,\n"
        "thickness, motion and restitution of a design and show its response at once. RUN may be a folder of runs:\n"
        "they are listed, and two are compared. Nothing is written. Ctrl-C ends it.",
    .options = OPTIONS,
    .is_alone = 1,
    .run = run,
};
