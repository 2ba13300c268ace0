#include "report/pictures.h"

#include <errno.h>
#include <spawn.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/json.h"
#include "base/text.h"
#include "report/panels.h"
#include "report/report_json.h"
#include "store/output.h"

extern char **environ;

/* ---- the browser ----------------------------------------------------------------------------------------------- */

/* Has the first browser that is there do what the option says. Its exit status; 128: ended by a signal; -1: there is
 * none. */
static int start(const char *option, const char *page, FILE *out, FILE *faults)
{
    static const char *const BROWSERS[] = {"chromium", "chromium-browser", "google-chrome"};
    posix_spawn_file_actions_t actions;
    pid_t pid;
    int status = 0;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", 0, 0);
    posix_spawn_file_actions_adddup2(&actions, fileno(out), STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, fileno(faults), STDERR_FILENO);
    errno = ENOENT;
    for (size_t i = 0; errno && i < N_OF(BROWSERS); i++) {
        const char *const words[] = {BROWSERS[i],
                                     "--headless",
                                     "--no-sandbox",
                                     "--disable-gpu",
                                     "--no-pdf-header-footer",
                                     "--window-size=1400,1000",
                                     option,
                                     page,
                                     NULL};
        errno = posix_spawnp(&pid, words[0], &actions, NULL, (char *const *)words, environ);
    }
    posix_spawn_file_actions_destroy(&actions);
    if (errno)
        return -1;
    while (waitpid(pid, &status, 0) < 0 && errno == EINTR)
        ;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128;
}

static Status missing(const char *path, Err *err)
{
    return fail(err, STATUS_MISSING,
                "%s: Chromium, which draws it, cannot be started; install it (Debian: apt install chromium)", path);
}

Status browser_check(const char *path, Err *err)
{
    FILE *unread = tmpfile();
    const int status = unread ? start("--version", NULL, unread, unread) : -1;
    if (unread)
        fclose(unread);
    return status == 0 ? STATUS_OK : missing(path, err);
}

/* ---- a page and what comes of it ------------------------------------------------------------------------------- */

/* run is taken over. A page of its own beside path, of which nothing is left. drawn NULL: it becomes a PDF at path,
 * else what it is when its scripts have run. */
static Status draw(json_t *run, const Report *rows, const char *body, const char *path, char **drawn, Err *err)
{
    char page[PATH_MAX], whole[PATH_MAX] = "", option[PATH_MAX + 32] = "--dump-dom";
    size_t room = 0;
    if (!drawn)
        snprintf(option, sizeof option, "--print-to-pdf=%s", path);
    snprintf(page, sizeof page, "%.4000s.XXXXXX.html", strcmp(path, "-") == 0 ? "imtet" : path);
    const int fd = mkstemps(page, (int)strlen(".html"));
    FILE *file = fd < 0 ? NULL : fdopen(fd, "w"), *out = tmpfile(), *faults = tmpfile();
    Status status = file && out && faults ? page_write(file, run, rows, body, err)
                                          : fail_errno(err, path, "no temporary file for its page");
    if (!(file && out && faults))
        json_decref(run);
    if (file && fclose(file) != 0 && status == STATUS_OK)
        status = fail_errno(err, page, "cannot be written");
    const int ended = status == STATUS_OK ? start(option, realpath(page, whole), out, faults) : 0;
    if (ended < 0)
        status = missing(path, err);
    if (out)
        rewind(out);
    if (status == STATUS_OK && (ended != 0 || (drawn && getdelim(drawn, &room, 0, out) <= 0)))
        status = fail(err, STATUS_IO, "%s: Chromium ended with status %d and drew nothing", path, ended);
    if (fd >= 0)
        unlink(page);
    if (out)
        fclose(out);
    if (faults)
        fclose(faults);
    return status;
}

Status page_print(json_t *run, const char *body, const char *path, Err *err)
{
    return draw(run, NULL, body, path, NULL, err);
}

/* The bytes of what the page calls `name`: <pre id="NAME">BASE64</pre>; path is left alone where there is none. */
static Status save(const char *drawn, const char *name, const char *path, int inside, Err *err)
{
    static const char DIGITS[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    char head[64];
    unsigned bits = 0;
    int n = 0;
    Output o;
    snprintf(head, sizeof head, "<pre id=\"%s\">", name);
    const char *at = strstr(drawn, head), *digit;
    if (!at)
        return fail(err, STATUS_IO, "%s: Chromium did not draw it", path);
    TRY(inside ? output_open_inside(&o, path, err) : output_open(&o, path, err));
    for (at += strlen(head); *at && (digit = strchr(DIGITS, *at)); at++) {
        bits = bits << 6 | (unsigned)(digit - DIGITS);
        n += 6;
        if (n >= 8)
            fputc((int)(bits >> (n -= 8) & 255), o.stream);
    }
    return output_close(&o, err);
}

/* ---- pictures -------------------------------------------------------------------------------------------------- */

Status drawing_save(const char *name, json_t *data, int width, const char *path, Err *err)
{
    char *drawn = NULL, picture[40];
    json_t *drawings = json_object(), *none = json_of("objectives=%p variables=%p words=%p limited=%p", json_array(),
                                                      json_array(), json_array(), json_array());
    json_object_set_new(drawings, name, data);
    snprintf(picture, sizeof picture, "%s.svg", name);
    json_t *run = json_of("schema=%p drawings=%p paper=%p", none, drawings, json_pack("[[si]]", name, width));
    Status status = draw(run, NULL, "", path, &drawn, err);
    THEN(status, save(drawn, picture, path, 0, err));
    free(drawn);
    return status;
}

/* Which reports have it. */
typedef enum { WITH_PAIRS, WITH_GROWTH, WITH_DETAIL, WITH_HISTORIES, WITH_ELSEWHERE } Condition;

static const struct {
    const char *name;
    int width; /* [px] of the SVG */
    Condition wants;
} PICTURES[] = {{"front", 1200, WITH_PAIRS},
                {"growth", 700, WITH_GROWTH},
                {"gaps", 900, WITH_DETAIL},
                {"peaks", 1200, WITH_DETAIL},
                {"modes", 1200, WITH_DETAIL},
                {"energies", 1200, WITH_HISTORIES},
                {"displacement", 1200, WITH_HISTORIES},
                {"elsewhere", 1000, WITH_ELSEWHERE}};

static int is_there(const Report *r, Condition wanted)
{
    const Detail *d = &r->detail;
    size_t n = 0;
    for (size_t i = 0; i < r->run->n_generations; i++)
        n += isfinite(r->run->generation[i].hypervolume) != 0;
    const int there[] = {[WITH_PAIRS] = r->run->schema.n_obj > 1,
                         [WITH_GROWTH] = n > 1,
                         [WITH_DETAIL] = r->has_detail && d->result[SCENE_IMPACT].outcome == RUN_OK,
                         [WITH_HISTORIES] = r->has_detail && d->history[0].n > 1 && d->history[1].n > 1,
                         [WITH_ELSEWHERE] = d->n_elsewhere > 0};
    return there[wanted];
}

/* Both kinds of every picture that the page was asked for. */
Status pictures_of(const Report *r, const char *folder, Err *err)
{
    static const char *const KINDS[] = {"svg", "png"};
    char *drawn = NULL, path[PATH_MAX];
    json_t *names = json_array();
    for (size_t i = 0; i < N_OF(PICTURES); i++)
        if (is_there(r, PICTURES[i].wants))
            json_array_append_new(names, json_pack("[si]", PICTURES[i].name, PICTURES[i].width));
    if (mkdir(folder, 0777) != 0 && errno != EEXIST) {
        json_decref(names);
        return fail_errno(err, folder, "cannot be made a folder");
    }
    snprintf(path, sizeof path, "%.4000s/page", folder);
    Status status = draw(json_put(report_json(r), "paper=%p", names), r, "", path, &drawn, err);
    for (size_t i = 0; i < 2 * N_OF(PICTURES) && status == STATUS_OK; i++) {
        char name[64];
        snprintf(name, sizeof name, "%s.%s", PICTURES[i / 2].name, KINDS[i % 2]);
        if (!is_there(r, PICTURES[i / 2].wants))
            continue;
        status = snprintf(path, sizeof path, "%s/%s", folder, name) < (int)sizeof path
                     ? save(drawn, name, path, 1, err)
                     : fail(err, STATUS_IO, "%.200s...: the path is too long", folder);
    }
    free(drawn);
    return status;
}
