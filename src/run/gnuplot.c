#include "run/gnuplot.h"

#include <errno.h>
#include <fcntl.h>
#include <spawn.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "run/output.h"

extern char **environ;

void gnuplot_quote(FILE *script, const char *text)
{
    fputc('\'', script);
    for (; *text; text++) {
        if (*text == '\'')
            fputc('\'', script); /* '' stands for ' */
        if ((unsigned char)*text >= ' ')
            fputc(*text, script);
    }
    fputc('\'', script);
}

/* Its exit status, or -1 with errno where it could not be started. What it has to say of faults is dropped: with a
 * script of ours there is none that a user could mend. */
static int run(FILE *script, FILE *picture)
{
    char *const words[] = {"gnuplot", "--default-settings", "-", NULL};
    posix_spawn_file_actions_t actions;
    pid_t pid;
    int status = 0;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, fileno(script), STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, fileno(picture), STDOUT_FILENO);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    errno = posix_spawnp(&pid, words[0], &actions, NULL, words, environ);
    posix_spawn_file_actions_destroy(&actions);
    if (errno)
        return -1;
    while (waitpid(pid, &status, 0) < 0 && errno == EINTR)
        ;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128;
}

static Status draw(Output *o, FILE *script, GnuplotScript write, const void *user, Err *err)
{
    write(script, user);
    if (fflush(script) != 0 || fseek(script, 0, SEEK_SET) != 0)
        return fail(err, STATUS_IO, "the script for gnuplot could not be written: %s", strerror(errno));
    const int status = run(script, o->stream);
    if (status == -1 || status == 127)
        return fail(err, STATUS_MISSING,
                    "%s: gnuplot, which draws it, cannot be started; install it (Debian: apt install gnuplot-nox), or "
                    "take the numbers by --csv and --history",
                    o->path);
    if (status != 0)
        return fail(err, STATUS_IO, "%s: gnuplot ended with status %d and drew no picture", o->path, status);
    return STATUS_OK;
}

Status gnuplot_draw(const char *path, GnuplotScript write, const void *user, Err *err)
{
    Output o;
    TRY(output_open(&o, path, err));
    FILE *script = tmpfile();
    Status status = script ? draw(&o, script, write, user, err)
                           : fail(err, STATUS_IO, "no temporary file for gnuplot: %s", strerror(errno));
    if (script)
        fclose(script);
    if (status != STATUS_OK) {
        output_abandon(&o);
        return status;
    }
    return output_close(&o, err);
}
