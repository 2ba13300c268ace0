#include "report/gnuplot.h"

#include <errno.h>

#include "report/program.h"
#include "store/output.h"

void gnuplot_number(FILE *script, double value)
{
    if (isfinite(value))
        fprintf(script, "%.8g ", value);
    else
        fputs("NaN ", script);
}

void gnuplot_quote(FILE *script, const char *text)
{
    fputs(*text == '\'' ? "' " : "'", script); /* it takes three ' in a row for an empty text and another one */
    for (; *text; text++) {
        if (*text == '\'')
            fputc('\'', script); /* '' stands for ' */
        if ((unsigned char)*text >= ' ')
            fputc(*text, script);
    }
    fputc('\'', script);
}

/* The sentence that says what is wrong: the last line that it wrote, behind the script's line and a mark under it. */
static void last_line(FILE *faults, char text[200])
{
    char line[200];
    text[0] = 0;
    rewind(faults);
    while (fgets(line, sizeof line, faults)) {
        line[strcspn(line, "\r\n")] = 0;
        const char *words = line + strspn(line, " \t^");
        if (*words)
            snprintf(text, 200, "%s", words);
    }
}

static Status draw(Output *o, FILE *script, FILE *faults, GnuplotScript write, const void *user, Err *err)
{
    char fault[200];
    write(script, user);
    if (fflush(script) != 0 || fseek(script, 0, SEEK_SET) != 0)
        return fail(err, STATUS_IO, "the script for gnuplot could not be written: %s", strerror(errno));
    char *const words[] = {"gnuplot", "--default-settings", "-", NULL};
    const int status = program_run(words, script, o->stream, faults);
    if (status == -1 || status == 127)
        return fail(err, STATUS_MISSING,
                    "%s: gnuplot, which draws it, cannot be started; install it (Debian: apt install gnuplot-nox), or "
                    "take the numbers by --csv and --history",
                    o->path);
    last_line(faults, fault);
    if (status != 0)
        return fail(err, STATUS_IO, "%s: gnuplot ended with status %d and drew no picture: %s", o->path, status,
                    fault[0] ? fault : "it does not say why");
    return STATUS_OK;
}

Status gnuplot_draw(const char *path, GnuplotScript write, const void *user, Err *err)
{
    Output o;
    TRY(output_open_inside(&o, path, err));
    FILE *script = tmpfile(), *faults = tmpfile();
    Status status = script && faults ? draw(&o, script, faults, write, user, err)
                                     : fail(err, STATUS_IO, "no temporary file for gnuplot: %s", strerror(errno));
    if (faults)
        fclose(faults);
    if (script)
        fclose(script);
    return output_end(&o, status, err);
}
