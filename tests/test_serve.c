/* imtet serve, asked by raw sockets: whom it answers, what it refuses, that a run does not know of it, how it ends. Its
 * page in a browser: test_browser.c. */
#include "runs.h"

#include <arpa/inet.h>
#include <errno.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/time.h>

#include "serve/guard.h"
#include "serve/serve.h"
#include "serve/watch.h"

enum { ANSWER_MAX = 4 << 20 };
/* Below the 15 s after which the server closes a connection that says nothing. */
static const double LATE_S = 12;
#define SMALL                                                                                                          \
    "optimize configs/quick.ini --set search.max_evals=60 --set search.population=16 --set search.initial=40 "         \
    "--threads 1 --set sim.duration_s=15 "

typedef struct {
    pid_t pid; /* 0: this process */
    int port;
    char token[TOKEN_TEXT], said[PATH_MAX];
    Server *own;
} Served;

static Served server; /* that is asked */

/* -- the server as a process --------------------------------------------------------------------------------------- */

static void take_address(const char *url)
{
    assert_int_equal(sscanf(url, "http://127.0.0.1:%d/%48[0-9a-f]/", &server.port, server.token), 2);
}

/* `imtet serve FOLDER` with at most so many open files, whose address is in `said` as soon as it listens; SIGINT ends
 * it. */
static void serve_with(const char *folder, int files_max)
{
    char *text = NULL, *at = NULL;
    sigset_t ends;
    posix_spawn_file_actions_t files;
    posix_spawnattr_t signals;
    char script[] = "ulimit -n $2; exec \"$0\" serve \"$1\"", shell[] = "/bin/sh";
    char *words[] = {shell, "-c", script, getenv("IMTET"), there(folder), brief("%d", files_max), NULL};
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, path_of("served", server.said),
                                     O_WRONLY | O_CREAT | O_TRUNC, 0600);
    sigemptyset(&ends);
    sigaddset(&ends, SIGINT);
    posix_spawnattr_init(&signals);
    posix_spawnattr_setsigdefault(&signals, &ends);
    posix_spawnattr_setflags(&signals, POSIX_SPAWN_SETSIGDEF);
    assert_int_equal(posix_spawn(&server.pid, words[0], &files, &signals, words, environ), 0);
    posix_spawn_file_actions_destroy(&files);
    posix_spawnattr_destroy(&signals);
    for (int i = 0; i < 600 && !at; i++) {
        rest(0.1);
        free(text);
        text = text_of(server.said);
        at = strstr(text, "Ctrl-C");
    }
    assert_non_null(at);
    take_address(strstr(text, "http://"));
    free(text);
}

static void serve(const char *folder)
{
    serve_with(folder, 1024);
}

/* The same within this process: a fault of memory is seen. */
static Served serve_here(const char *folder)
{
    const Served before = server;
    const ServeOptions options = {.folder = there(folder)};
    CHECK_OK(serve_open(&server.own, &options, &err), &err);
    take_address(serve_url(server.own));
    return before;
}

static void end_here(Served before)
{
    serve_close(server.own);
    server = before;
}

static int end_server(void)
{
    assert_int_equal(kill(server.pid, SIGINT), 0);
    return wait_end(server.pid);
}

/* -- requests ------------------------------------------------------------------------------------------------------ */

static int dial(void)
{
    const struct sockaddr_in there = {
        .sin_family = AF_INET, .sin_port = htons((uint16_t)server.port), .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    const struct timeval patience = {.tv_sec = 600};
    const int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    assert_at_most(0, fd);
    setsockopt(fd, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    assert_int_equal(connect(fd, (const struct sockaddr *)&there, sizeof there), 0);
    return fd;
}

static void say(int fd, const char *text)
{
    for (size_t n = strlen(text); n > 0;) {
        const ssize_t sent = send(fd, text, n, MSG_NOSIGNAL);
        if (sent <= 0)
            return; /* the server has closed: its answer says why */
        text += sent;
        n -= (size_t)sent;
    }
}

/* Up to the end of the connection. */
static char *hear(int fd)
{
    char *text = calloc(1, ANSWER_MAX);
    size_t n = 0;
    assert_non_null(text);
    for (ssize_t got; n < ANSWER_MAX - 1 && (got = recv(fd, text + n, ANSWER_MAX - 1 - n, 0)) > 0;)
        n += (size_t)got;
    close(fd);
    return text;
}

static int code_of(const char *answer)
{
    int code = 0; /* closed without an answer */
    sscanf(answer, "HTTP/1.1 %d", &code);
    return code;
}

/* One request: %T in `path` is the token; headers end with \r\n each. */
static char *ask(const char *method, const char *path, const char *headers, const char *body)
{
    char request[4096], url[2048] = "";
    for (const char *p = path; *p; p++)
        if (p[0] == '%' && p[1] == 'T') {
            strcat(url, server.token);
            p++;
        } else
            strncat(url, p, 1);
    snprintf(request, sizeof request, "%s %s HTTP/1.1\r\n%s%sConnection: close\r\n\r\n", method, url,
             strstr(headers, "Host:") ? "" : "Host: 127.0.0.1\r\n", headers);
    const int fd = dial();
    say(fd, request);
    say(fd, body);
    return hear(fd);
}

static char *post(const char *path, const char *body)
{
    return ask("POST", path, brief("Content-Length: %zu\r\n", strlen(body)), body);
}

static void expect_code(int wanted, const char *method, const char *path, const char *headers)
{
    FREED char *answer = ask(method, path, headers, "");
    if (code_of(answer) != wanted)
        fail_msg("%s %s with %s: %.200s, wanted %d", method, path, headers, answer, wanted);
}

static json_t *json_of_answer(char *answer)
{
    json_error_t error;
    char *body = strstr(answer, "\r\n\r\n");
    assert_int_equal(code_of(answer), 200);
    json_t *all = json_loads(body + 4, 0, &error);
    if (!all)
        fail_msg("%s: %.200s", error.text, body);
    free(answer);
    return all;
}

static json_t *ask_json(const char *path)
{
    return json_of_answer(ask("GET", path, "", ""));
}

static json_t *post_json(const char *path, json_t *question)
{
    FREED char *body = json_dumps(question, JSON_REAL_PRECISION(17));
    json_t *answer = json_of_answer(post(path, body));
    json_decref(question);
    return answer;
}

/* -- whom it answers ----------------------------------------------------------------------------------------------- */

TEST(a_request_without_the_token_is_refused)
{
    char almost[64];
    expect_code(200, "GET", "/%T/0/", "");
    expect_code(302, "GET", "/%T/", "");
    snprintf(almost, sizeof almost, "/%s/0/", server.token);
    almost[48] = almost[48] == '0' ? '1' : '0';
    expect_code(403, "GET", almost, "");
    expect_code(403, "GET", "/", "");
    expect_code(403, "GET", "/0/", "");
    expect_code(403, "GET", "/%", "");
}

TEST(a_foreign_host_or_origin_is_refused)
{
    FOR_EACH (const char *, refused, "Host: evil.example\r\n", "Host: 127.0.0.1.evil.example\r\n",
              "Host: localhost:80x\r\n", "Host: 127.0.0.2\r\n", "Host: 127.0.0.1\r\nOrigin: http://evil.example\r\n",
              "Host: 127.0.0.1\r\nOrigin: null\r\n", "Host: 127.0.0.1\r\nOrigin: https://127.0.0.1\r\n",
              "Host: 127.0.0.1:8000\r\nOrigin: http://127.0.0.1:8001\r\n")
        expect_code(403, "GET", "/%T/0/front", *refused);
    expect_code(200, "GET", "/%T/0/front", "Host: localhost:1234\r\n");
    expect_code(200, "GET", "/%T/0/front", "Host: 127.0.0.1:8000\r\nOrigin: http://127.0.0.1:8000\r\n");
}

TEST(no_request_leads_to_a_file)
{
    FOR_EACH (const char *, path, "/%T/../../etc/passwd", "/%T/0/../../../etc/passwd", "/%T/%2e%2e/%2e%2e/etc/passwd",
              "/%T/0/..%2f..%2frun.sqlite", "/%T/0/run.sqlite", "/%T//etc/passwd", "/%T/0/design/1/../2",
              "/%T/0/design/-1", "/%T/0/design/99999999999999999999", "/%T/99/", "/%T/0/front/1", "/%T/0/runs",
              "/%T/front", "/%T/0/%00")
        expect_code(404, "GET", *path, "");
}

static void expect_header(const char *wanted, const char *method, const char *path)
{
    FREED char *answer = ask(method, path, "", "");
    if (!strstr(answer, wanted))
        fail_msg("%s %s: %.300s, wanted %s", method, path, answer, wanted);
}

TEST(every_address_says_which_methods_it_knows)
{
    FOR_EACH (const char *, method, "PUT", "DELETE", "OPTIONS", "PATCH", "TRACE")
        expect_code(405, *method, "/%T/0/front", "");
    FOR_EACH (const char *, read_only, "/%T/", "/%T/runs", "/%T/0/", "/%T/0/front", "/%T/0/events", "/%T/0/design/1",
              "/%T/0/against/1", "/%T/0/scene") {
        expect_code(405, "POST", *read_only, "Content-Length: 0\r\n");
        expect_header("\r\nAllow: GET, HEAD\r\n", "POST", *read_only);
    }
    expect_header("\r\nAllow: GET, HEAD, POST\r\n", "PUT", "/%T/0/notes");
    expect_code(400, "POST", "/%T/0/notes", "Content-Length: 0\r\n");
    expect_header("\r\nAllow: POST\r\n", "GET", "/%T/0/kept");
    expect_code(400, "POST", "/%T/0/move", "Content-Length: 0\r\n");
    expect_code(404, "POST", "/%T/0/nothing", "Content-Length: 0\r\n");
}

TEST(head_is_get_without_a_body)
{
    FOR_EACH (const char *, path, "/%T/0/", "/%T/runs", "/%T/0/events") {
        FREED char *answer = ask("HEAD", *path, "", "");
        assert_int_equal(code_of(answer), 200);
        assert_string_equal(strstr(answer, "\r\n\r\n"), "\r\n\r\n");
    }
    expect_code(403, "HEAD", "/0/", "");
}

TEST(an_address_without_its_last_slash_leads_to_the_one_with_it)
{
    expect_header(brief("\r\nLocation: %s/\r\n", server.token), "GET", "/%T");
    expect_header("\r\nLocation: 0/\r\n", "GET", "/%T/0");
    expect_code(302, "GET", "/%T/0", "");
    expect_code(403, "GET", "/%T0", "Origin: http://evil.example\r\n");
}

/* -- bounds -------------------------------------------------------------------------------------------------------- */

TEST(what_is_too_large_is_not_read)
{
    enum { MUCH = 1 << 20 };
    FREED char *much = malloc(MUCH + 1);
    memset(much, 'x', MUCH);
    much[MUCH] = 0;
    expect_code(413, "POST", "/%T/0/notes", "Content-Length: 1000000000\r\n");
    expect_code(413, "GET", "/%T/0/front", "Content-Length: 5\r\n");
    int fd = dial();
    FREED char *long_one = formatted("GET /%s/0/ HTTP/1.1\r\nHost: localhost\r\nX: %s\r\n\r\n", server.token, much);
    say(fd, long_one);
    FREED char *answer = hear(fd);
    assert_true(code_of(answer) == 0 || code_of(answer) >= 400);
    fd = dial();
    say(fd, brief("POST /%s/0/notes HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\n\r\n", server.token));
    for (int i = 0; i < 40; i++) { /* of a thousand bytes each: 8 more than are allowed */
        say(fd, "3e8\r\n");
        say(fd, much + MUCH - 1000);
        say(fd, "\r\n");
    }
    say(fd, "0\r\n\r\n");
    shutdown(fd, SHUT_WR);
    FREED char *refusal = hear(fd);
    assert_int_equal(code_of(refusal), 413);
    expect_code(200, "GET", "/%T/0/front", "");
}

/* Requests that come byte by byte, more of them than there is room for, each begun anew when it is ended: whoever asks
 * properly is answered. */
TEST(a_slow_flood_leaves_others_answered)
{
    enum { SLOW = 300 };
    const Served before = serve_here("runs");
    int fd[SLOW], n_ended = 0;
    char byte;
    for (int i = 0; i < SLOW; i++)
        fd[i] = dial();
    for (int round = 0; round < 5; round++) {
        for (int i = 0; i < SLOW; i++) {
            say(fd[i], round == 0 ? "POST /" : "x");
            if (recv(fd[i], &byte, 1, MSG_DONTWAIT) == 0) {
                n_ended++;
                close(fd[i]);
                fd[i] = dial();
            }
        }
        const double start = clock_seconds();
        expect_code(200, "GET", "/%T/0/front", "");
        assert_less(clock_seconds() - start, LATE_S);
    }
    assert_less(SLOW / 4, n_ended);
    for (int i = 0; i < SLOW; i++)
        close(fd[i]);
    end_here(before);
}

static size_t threads_of_server(void)
{
    char line[256];
    size_t n = 0;
    FILE *f = opened(brief("/proc/%d/status", (int)server.pid), "r");
    while (fgets(line, sizeof line, f))
        sscanf(line, "Threads: %zu", &n);
    fclose(f);
    return n;
}

TEST(a_thousand_connections_leave_room_for_one_that_asks)
{
    enum { MANY = 1000 };
    struct rlimit files;
    int fd[MANY];
    getrlimit(RLIMIT_NOFILE, &files);
    files.rlim_cur = files.rlim_max < 2048 ? files.rlim_max : 2048;
    setrlimit(RLIMIT_NOFILE, &files);
    for (int i = 0; i < MANY; i++)
        fd[i] = dial();
    const double start = clock_seconds();
    expect_code(200, "GET", "/%T/0/front", "");
    assert_less(clock_seconds() - start, LATE_S);
    assert_at_most(threads_of_server(), PEERS_MAX + 8);
    for (int i = 0; i < MANY; i++)
        close(fd[i]);
    expect_code(200, "GET", "/%T/0/front", "");
}

static double processor_s(void)
{
    long user, kernel;
    FILE *f = opened(brief("/proc/%d/stat", (int)server.pid), "r");
    assert_int_equal(fscanf(f, "%*d (%*[^)]) %*c %*d %*d %*d %*d %*d %*u %*u %*u %*u %*u %ld %ld", &user, &kernel), 2);
    fclose(f);
    return (double)(user + kernel) / (double)sysconf(_SC_CLK_TCK);
}

static double seconds_of(const struct rusage *used)
{
    return (double)(used->ru_utime.tv_sec + used->ru_stime.tv_sec) +
           1e-6 * (double)(used->ru_utime.tv_usec + used->ru_stime.tv_usec);
}

/* At the limit of open files nothing could be accepted, again and again. */
TEST(where_few_files_may_be_open_a_flood_costs_nothing_and_others_are_answered)
{
    enum { MANY = 100 };
    const Served before = server;
    int fd[MANY];
    serve_with("runs", 64);
    expect_code(200, "GET", "/%T/0/front", "");
    const double spent = processor_s();
    for (int i = 0; i < MANY; i++)
        fd[i] = dial();
    rest(2);
    assert_less(processor_s() - spent, 0.5);
    expect_code(200, "GET", "/%T/0/front", "");
    for (int i = 0; i < MANY; i++)
        close(fd[i]);
    assert_int_equal(end_server(), 0);
    server = before;
}

/* -- answers ------------------------------------------------------------------------------------------------------- */

/* With which the page simulates: the test page_engine holds what comes of it against the program. */
TEST(the_scene_of_a_run_has_bounds_steps_and_the_options_of_one_simulation)
{
    json_auto_t *one = ask_json("/%T/0/scene"), *several = ask_json("/%T/3/scene");
    json_t *values = json_object_get(several, "values");
    const double plates[] = {0.01, 0.02, 0.03};
    assert_int_equal(json_integer_value(json_object_get(one, "simulations")), 1);
    assert_string_equal(json_string_value(json_object_get(one, "options")), "");
    assert_true(strlen(json_string_value(json_object_get(one, "scene"))) > 1000);
    assert_true(json_array_size(values) == 22 && json_is_null(json_array_get(values, 0)));
    for (size_t i = 0; i < 3; i++)
        assert_true(json_number_value(json_array_get(json_array_get(values, 20), i)) == plates[i]);
    assert_in_range(json_integer_value(json_object_get(several, "simulations")), 2, 100);
    assert_non_null(strstr(json_string_value(json_object_get(several, "options")), "sim.replicates=1"));
}

TEST(two_runs_are_measured_in_one_box)
{
    json_auto_t *both = ask_json("/%T/0/against/1"), *again = ask_json("/%T/1/against/0");
    for (size_t r = 0; r < 2; r++) {
        const json_t *one = json_array_get(json_object_get(both, "runs"), r);
        const json_t *v = json_object_get(one, "volume");
        assert_less(1, json_array_size(v));
        for (size_t g = 1; g < json_array_size(v); g++)
            assert_at_most(json_number_value(json_array_get(v, g - 1)), json_number_value(json_array_get(v, g)));
        assert_true(json_equal(one, json_array_get(json_object_get(again, "runs"), 1 - r)));
    }
    assert_int_equal(json_array_size(json_object_get(both, "differences")), 0); /* another seed */
    json_auto_t *others = ask_json("/%T/0/against/3"), *three = ask_json("/%T/0/against/1,3");
    json_t *differs = json_object_get(others, "differences"), *runs = json_object_get(three, "runs"), *key;
    size_t i, n_records = 0;
    json_array_foreach(differs, i, key) n_records += strcmp(json_string_value(key), "motion.records") == 0;
    assert_int_equal(n_records, 1);
    assert_int_equal(json_array_size(runs), 3);
    assert_true(json_equal(json_object_get(json_array_get(runs, 1), "f"),
                           json_object_get(json_array_get(json_object_get(both, "runs"), 1), "f")));
    assert_true(json_equal(json_object_get(three, "differences"), differs));
    expect_code(404, "GET", "/%T/0/against/1,", "");
    expect_code(404, "GET", "/%T/0,1/front", "");
    expect_code(404, "GET", "/%T/0/against/1,1,1,1", "");
    expect_code(404, "GET", "/%T/0/design/1,2", "");
    expect_code(400, "GET", "/%T/0/against/2", ""); /* other objectives */
    expect_code(404, "GET", "/%T/0/against/9", "");
    expect_code(404, "GET", "/%T/2/scene", ""); /* no tower */
    expect_code(404, "GET", "/%T/2/design/1", "");
}

TEST(the_page_is_the_report_with_live_parts)
{
    FREED char *page = ask("GET", "/%T/0/", "", "");
    char *policy = strstr(page, "Content-Security-Policy\" content=\"");
    assert_non_null(policy);
    assert_words(policy, "connect-src 'self'");
    assert_null(strstr(page, server.token));
    *strchr(policy + 40, '"') = 0;
    assert_words(policy, "!unsafe-inline", "!'unsafe-eval");
    assert_words_in(output_of("status @/runs --json"), "\"finished\"");
}

/* -- the run ------------------------------------------------------------------------------------------------------- */

/* The run is halted until every page has been told of it. */
TEST(a_run_has_the_same_bytes_with_ten_pages_looking_on)
{
    char byte;
    int fd[10];
    FREED char *command =
        formatted("exec '%s' " SMALL "--out '%s/watched' >/dev/null 2>&1", getenv("IMTET"), place.folder);
    char *words[] = {"sh", "-c", command, NULL};
    const Served before = server;
    pid_t pid;
    assert_int_equal(posix_spawnp(&pid, "sh", NULL, NULL, words, environ), 0);
    for (int i = 0; i < 6000 && access(brief("%s/settings.ini", there("watched")), F_OK) != 0; i++)
        rest(0.01);
    kill(pid, SIGSTOP);
    serve("watched");
    for (int i = 0; i < 10; i++) {
        fd[i] = dial();
        say(fd[i], brief("GET /%s/0/events HTTP/1.1\r\nHost: localhost\r\n\r\n", server.token));
    }
    for (int i = 0; i < 10; i++)
        assert_int_equal(recv(fd[i], &byte, 1, MSG_PEEK), 1);
    kill(pid, SIGCONT);
    int status = 0;
    while (waitpid(pid, &status, WNOHANG) == 0) {
        free(ask("GET", "/%T/0/", "", ""));
        free(ask("GET", "/%T/0/front", "", ""));
        rest(0.05);
    }
    assert_int_equal(status, 0);
    assert_true(WIFEXITED(end_server()));
    for (int i = 0; i < 10; i++) {
        assert_words_in(hear(fd[i]), "\"state\":\"running\"");
    }
    assert_same_run("runs/a", "watched");
    server = before;
}

static char *sums(void)
{
    expect_shell("cd '%s/runs' && find . -type f ! -name '*-shm' ! -name '*-wal' | sort | xargs sha256sum > ../sums && "
                 "ls -R > ../names && cat ../names ../sums > ../all",
                 place.folder);
    return read_in_place("all");
}

TEST(nothing_of_a_run_is_written)
{
    FREED char *before = sums();
    OWNED(table_free) Table front = table_of("runs/a/front.csv");
    json_auto_t *design = ask_json(brief("/%%T/0/design/%.0f", front.values[0]));
    assert_same_number(json_integer_value(json_object_get(design, "id")), (json_int_t)front.values[0]);
    json_decref(ask_json("/%T/runs"));
    assert_text(sums(), before);
}

static void refuse_note(int wanted, const char *note)
{
    FREED char *answer = post("/%T/1/notes", note);
    assert_int_equal(code_of(answer), wanted);
}

TEST(notes_are_of_designs_of_the_run_and_lie_beside_it)
{
    OWNED(table_free) Table front = table_of("runs/b/front.csv");
    const int id = (int)front.values[0];
    json_auto_t *notes = post_json("/%T/1/notes", json_pack("{s:i, s:s}", "id", id, "text", "<b>good</b>"));
    json_auto_t *again = ask_json("/%T/1/notes");
    assert_string_equal(json_string_value(json_object_get(notes, brief("%d", id))), "<b>good</b>");
    assert_true(json_equal(notes, again));
    FREED char *page = ask("GET", "/%T/1/", "", "");
    assert_words(page, "good", "!<b>good"); /* no markup of a note is the page's */
    refuse_note(404, "{\"id\": 987654, \"text\": \"none\"}");
    refuse_note(400, "{\"id\": \"knee\", \"text\": \"none\"}");
    json_auto_t *none = post_json("/%T/1/notes", json_pack("{s:i, s:s}", "id", id, "text", ""));
    assert_int_equal(json_object_size(none), 0);
    write_in_place("runs/b/notes.json", "[1]"); /* by hand, and wrong: stays as it is */
    expect_code(400, "GET", "/%T/1/notes", "");
    refuse_note(400, brief("{\"id\": %d, \"text\": \"other\"}", id));
    assert_words_in(ask("GET", "/%T/1/", "", ""), "HTTP/1.1 200", "notes.json:1: is no object of notes");
    assert_text(read_in_place("runs/b/notes.json"), "[1]");
    assert_int_equal(unlink(there("runs/b/notes.json")), 0);
}

static void copy(const char *from, const char *to)
{
    expect_shell("cd '%s' && mkdir -p odd && rm -rf '%s' && cp -r '%s' '%s'", place.folder, to, from, to);
}

/* Resumed, a run that has got a design of a page does what it would have done without it. */
TEST(a_kept_design_is_of_the_run_and_never_of_its_search)
{
    char *rows[2];
    OWNED(table_free) Table front = table_of("runs/a/front.csv");
    json_t *x = json_array();
    for (size_t j = 0; j < 22; j++)
        json_array_append_new(x, json_real(front.values[1 + j] * (j ? 1 : 0.999)));
    copy("runs/a", "odd/0");
    copy("runs/a", "odd/1");
    const Served before = serve_here("odd/1");
    json_decref(post_json("/%T/0/kept", json_pack("{s:o}", "x", x)));
    end_here(before);
    for (int i = 0; i < 2; i++) {
        expect(0, "", brief("optimize @/odd/%d/settings.ini --max-evals 70 --out @/odd/%d", i, i));
        expect_shell("cd '%s' && '%s' export odd/%d --all --csv all && grep -c ',kept,' all | grep -qx %d && grep -v "
                     "',kept,' all | cut -d, -f2,4- > rows && rm -r odd/%d",
                     place.folder, getenv("IMTET"), i, i, i);
        rows[i] = read_in_place("rows");
    }
    assert_string_equal(rows[0], rows[1]);
    free(rows[0]);
    free(rows[1]);
}

/* Every listing names it with its reason, and none waits for it. */
TEST(a_run_that_cannot_be_read_holds_up_no_listing)
{
    copy("runs/a", "odd/a");
    copy("runs/a", "odd/broken");
    write_in_place("odd/broken/run.sqlite", "no database");
    const Served before = serve_here("odd");
    json_decref(ask_json("/%T/runs"));
    double least = HUGE_VAL;
    for (int i = 0; i < 10 && least > 1; i++) { /* that waited would take 2 s, each time */
        const double start = clock_seconds();
        json_decref(ask_json("/%T/runs"));
        least = fmin(least, clock_seconds() - start);
    }
    assert_less(least, 1);
    json_auto_t *runs = ask_json("/%T/runs");
    assert_int_equal(json_array_size(runs), 2);
    assert_string_equal(json_string_value(json_object_get(json_array_get(runs, 1), "state")), "unreadable");
    assert_less(20, strlen(json_string_value(json_object_get(json_array_get(runs, 1), "reason"))));
    end_here(before);
}

/* The state of the one run that is served, as all are listed; to be released. */
static json_t *state_now(char state[32])
{
    json_auto_t *runs = ask_json("/%T/runs");
    json_t *run = json_array_get(runs, 0);
    snprintf(state, 32, "%s", json_string_value(json_object_get(run, "state")));
    return json_incref(run);
}

TEST(a_run_that_is_gone_is_said_to_be_unreadable_beside_its_last_numbers)
{
    char word[32];
    copy("runs/a", "odd/gone");
    const Served before = serve_here("odd/gone");
    json_auto_t *was = state_now(word), *is = NULL;
    assert_string_equal(word, "finished");
    expect_shell("rm -r '%s'", there("odd/gone"));
    for (int i = 0; i < 600 && strcmp(word, "unreadable") != 0; i++) {
        rest(0.05);
        json_decref(is);
        is = state_now(word);
    }
    assert_string_equal(word, "unreadable");
    assert_non_null(strstr(json_string_value(json_object_get(is, "reason")), "gone"));
    assert_true(json_equal(json_object_get(was, "front"), json_object_get(is, "front")));
    expect_code(200, "GET", "/%T/0/front", "");
    end_here(before);
}

/* The run d judges designs by several simulations, a by one. */
TEST(a_run_made_anew_in_the_place_of_another_is_served_as_it_is_now)
{
    copy("runs/a", "odd/a");
    const Served before = serve_here("odd/a");
    json_auto_t *bounds = ask_json("/%T/0/scene");
    assert_int_equal(json_integer_value(json_object_get(bounds, "simulations")), 1);
    copy("runs/d", "odd/a");
    OWNED(table_free) Table front = table_of("runs/d/front.csv");
    size_t n = 0;
    for (int i = 0; i < 600 && n != front.n_rows; i++) { /* until it is read again */
        rest(0.05);
        json_auto_t *now = ask_json("/%T/0/front");
        n = json_array_size(json_object_get(now, "ids"));
    }
    assert_int_equal(n, front.n_rows);
    json_auto_t *anew = ask_json("/%T/0/scene");
    assert_in_range(json_integer_value(json_object_get(anew, "simulations")), 2, 100);
    end_here(before);
}

/* Nothing changes in its folder: a later version is one that was read again because the first was released. */
TEST(a_run_that_is_not_asked_for_any_more_is_released)
{
    Watch *w;
    View first, again, kept;
    const RecordPaths moved = {0};
    CHECK_OK(watch_open(&w, there("runs/a"), &moved, &err), &err);
    CHECK_OK(watch_take(w, 0, 0.1, &first, &err), &err);
    CHECK_OK(watch_take(w, 0, 0.1, &again, &err), &err);
    assert_ptr_equal(first.snapshot, again.snapshot);
    watch_give(&again);
    again = first;
    for (int i = 0; i < 200 && again.version == first.version; i++) { /* until the watch has looked for the unasked */
        rest(0.3);
        CHECK_OK(watch_take(w, 0, 0.1, &again, &err), &err);
        if (again.version == first.version)
            watch_give(&again);
    }
    assert_less(first.version, again.version);
    CHECK_OK(watch_take(w, 0, 60, &kept, &err), &err);
    watch_give(&kept);
    assert_same_number(first.snapshot->run.n_front, again.snapshot->run.n_front); /* whoever holds it has it */
    watch_give(&first);
    watch_give(&again);
    rest(0.7);
    CHECK_OK(watch_take(w, 0, 60, &first, &err), &err);
    assert_int_equal(first.version, again.version); /* kept for a minute */
    watch_give(&first);
    watch_close(w);
}

/* -- ends ---------------------------------------------------------------------------------------------------------- */

TEST(what_cannot_be_served_is_said)
{
    expect(66, "no-such-run", "serve no-such-run");
    expect(66, "is no run, and holds none", "serve docs");
    expect(2, "--port", "serve @/runs/a --port 0");
    expect(74, "no server", brief("serve @/runs/a --port %d", server.port));
}

TEST(ctrl_c_ends_it_while_pages_look_on)
{
    char byte;
    int fd[4];
    FREED char *text = formatted("GET /%s/0/events HTTP/1.1\r\nHost: localhost\r\n\r\n", server.token);
    for (int i = 0; i < 4; i++) {
        fd[i] = dial();
        say(fd[i], i < 3 ? text : "GET /");
    }
    assert_int_equal(recv(fd[0], &byte, 1, 0), 1);
    const double start = clock_seconds();
    const int status = end_server();
    assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 0);
    assert_less(clock_seconds() - start, LATE_S);
    for (int i = 0; i < 4; i++)
        close(fd[i]);
    serve("runs");
}

/* Each takes a while, and pages that wait for them have gone. */
TEST(ctrl_c_does_not_wait_for_the_questions_in_the_queue)
{
    enum { QUESTIONS = 8 };
    const Served before = server;
    write_in_place("long.ini", SIX_FLOORS_INI "stretch = 300\n[search]\n"
                                              "initial = 4\npopulation = 4\nmax_evals = 400\nthreads = 1\n");
    const pid_t pid = start("long.ini", "long/run");
    while (finished_in("long/run") < 4)
        rest(0.05);
    kill(pid, SIGKILL);
    wait_end(pid);
    int fd[QUESTIONS];
    serve("long");
    json_auto_t *front = ask_json("/%T/0/front");
    json_t *ids = json_object_get(front, "ids");
    const double before_one = processor_s();
    assert_true(json_array_size(ids) >= 2);
    json_decref(ask_json(brief("/%%T/0/design/%lld", json_integer_value(json_array_get(ids, 0)))));
    const double before_all = processor_s(), one = before_all - before_one;
    for (int i = 0; i < QUESTIONS; i++) {
        fd[i] = dial();
        say(fd[i], brief("GET /%s/0/design/%d HTTP/1.1\r\nHost: localhost\r\n\r\n", server.token, i + 1));
    }
    while (processor_s() - before_all < 0.2 * one) /* until it is at work */
        rest(0.02);
    struct rusage used;
    getrusage(RUSAGE_CHILDREN, &used);
    const double others = seconds_of(&used);
    assert_int_equal(end_server(), 0);
    getrusage(RUSAGE_CHILDREN, &used);
    assert_less(seconds_of(&used) - others - before_all, 0.5 * QUESTIONS * one);
    for (int i = 0; i < QUESTIONS; i++)
        close(fd[i]);
    server = before;
}

static void begin(void)
{
    FOR_EACH (const char *, each, "--out @/runs/a", "--out @/runs/b --set search.seed=2", "--out @/runs/c " DTLZ2(4, 2),
              "--out @/runs/d --set design.step_thickness_m=0.01,0.02,0.03 --set search.max_evals=24 --set "
              "sim.duration_s=12 --set search.initial=16 --set search.population=8 --set sim.replicates=2 --set "
              "search.fidelity=replicates --set sim.gap_tolerance_m=0.003 --set sim.uncertain=restitution=0.05 --set "
              "motion.records=builtin:elcentro-like --set motion.pga_g=0 --set motion.factor=0.5")
        free(output_of(SMALL "%s", *each));
    serve("runs");
}

static int finish(void **state)
{
    end_server();
    return clear_place(state);
}

SUITE_FILLED(prepare, begin, finish)
