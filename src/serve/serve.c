#include "serve/serve.h"

#include <arpa/inet.h>
#include <errno.h>
#include <microhttpd.h>
#include <pthread.h>
#include <sys/resource.h>
#include <sys/socket.h>

#include "base/json.h"
#include "report/report_json.h"
#include "report/what_if.h"
#include "serve/answers.h"
#include "serve/guard.h"
#include "store/notes.h"

/* FILES_OWN: of the process beside its connections. */
enum { STALL_S = 15, EVENT_MAX = 2048, FILES_OWN = 40, PACKED_MIN = 16384 };
static const double BEAT_S = 5; /* between events at most */

/* A run is kept in memory after a page asked for it, after all were listed. */
static const double PAGE_S = 60, GLANCE_S = 2;

struct Server {
    char token[TOKEN_TEXT], url[TOKEN_TEXT + 48];
    int port;
    RecordPaths moved;
    Watch *watch;
    struct MHD_Daemon *daemon;
    pthread_mutex_t notes; /* of all runs */
    pthread_mutex_t mutex; /* of the rest */
    int waiting[PEERS_MAX /
                2];         /* (n_waiting) sockets, in the order in which they began to wait for a request; -1: none */
    size_t n_waiting, next; /* next: the place of the one that comes */
};

typedef struct Route Route;

/* What came in so far. */
typedef struct {
    ServePath path;
    const Route *route;
    int is_too_large;
    size_t n;
    char body[BODY_MAX];
} Request;

typedef struct Stream Stream;

typedef struct {
    unsigned code;
    const char *type;
    char *text;                 /* malloc'd */
    Stream *stream;             /* in the place of the text */
    char place[TOKEN_TEXT + 8]; /* of a redirection; empty: none */
    const char *allow;          /* methods; NULL: not said */
} Answer;

typedef struct {
    Server *server;
    const Request *request;
    size_t run;          /* of the path, if it has one; */
    View view;           /* as it is now */
    const json_t *given; /* the body; NULL: it is no JSON */
} Visit;

/* -- connections --------------------------------------------------------------------------------------------------- */

static int socket_of(struct MHD_Connection *c)
{
    return MHD_get_connection_info(c, MHD_CONNECTION_INFO_CONNECTION_FD)->connect_fd;
}

/* A request that does not come, or comes byte by byte, holds a connection: where as many wait as there is room for, the
 * one that has waited longest is ended. */
static void set_waiting(Server *s, int fd, int waits)
{
    pthread_mutex_lock(&s->mutex);
    for (size_t i = 0; i < s->n_waiting; i++)
        if (s->waiting[i] == fd)
            s->waiting[i] = -1;
    if (waits) {
        int *place = &s->waiting[s->next++ % s->n_waiting];
        if (*place >= 0)
            shutdown(*place, SHUT_RDWR);
        *place = fd;
    }
    pthread_mutex_unlock(&s->mutex);
}

static void note_connection(void *user, struct MHD_Connection *c, void **, enum MHD_ConnectionNotificationCode what)
{
    set_waiting(user, socket_of(c), what == MHD_CONNECTION_NOTIFY_STARTED);
}

static void note_completed(void *user, struct MHD_Connection *c, void **request, enum MHD_RequestTerminationCode)
{
    free(*request);
    *request = NULL;
    set_waiting(user, socket_of(c), 1);
}

/* -- answers ------------------------------------------------------------------------------------------------------- */

static ssize_t read_events(void *user, uint64_t position, char *out, size_t room);

/* A long text goes as gzip, where the client takes it: a page of two thousand designs is 1.5 MB, a third of it packed.
 * What cannot be packed stays. */
static enum MHD_Result send_answer(struct MHD_Connection *c, Answer *a)
{
    const char *takes = MHD_lookup_connection_value(c, MHD_HEADER_KIND, MHD_HTTP_HEADER_ACCEPT_ENCODING);
    size_t n = a->text ? strlen(a->text) : 0;
    char *packed = NULL;
    if (n >= PACKED_MIN && takes && strstr(takes, "gzip") && !strstr(takes, "gzip;q=0"))
        packed = gzip_bytes(a->text, n, &n);
    if (packed) {
        free(a->text);
        a->text = packed;
    }
    const char *const HEADERS[][2] = {{MHD_HTTP_HEADER_CONTENT_TYPE, a->type},
                                      {MHD_HTTP_HEADER_LOCATION, a->place[0] ? a->place : NULL},
                                      {MHD_HTTP_HEADER_ALLOW, a->allow},
                                      {MHD_HTTP_HEADER_CONTENT_ENCODING, packed ? "gzip" : NULL},
                                      {"Cache-Control", "no-store"},
                                      {"X-Content-Type-Options", "nosniff"},
                                      {"Referrer-Policy", "no-referrer"},
                                      {"Cross-Origin-Resource-Policy", "same-origin"},
                                      {"Cross-Origin-Opener-Policy", "same-origin"},
                                      {"X-Frame-Options", "DENY"}};
    struct MHD_Response *r =
        a->stream ? MHD_create_response_from_callback(MHD_SIZE_UNKNOWN, EVENT_MAX, read_events, a->stream, free)
                  : MHD_create_response_from_buffer(n, a->text, MHD_RESPMEM_MUST_FREE);
    if (!r) {
        free(a->stream);
        free(a->text);
        return MHD_NO;
    }
    for (size_t i = 0; i < N_OF(HEADERS); i++)
        if (HEADERS[i][1])
            MHD_add_response_header(r, HEADERS[i][0], HEADERS[i][1]);
    const enum MHD_Result sent = MHD_queue_response(c, a->code, r);
    MHD_destroy_response(r);
    return sent;
}

static const char JSON_TYPE[] = "application/json", PAGE_TYPE[] = "text/html; charset=utf-8";

/* Takes the reference. */
static Status answer_json(json_t *all, Answer *a)
{
    a->text = json_dumps(all, JSON_COMPACT | JSON_REAL_PRECISION(6));
    json_decref(all);
    return STATUS_OK;
}

static const char REFUSED[] =
    "<!DOCTYPE html><html lang=\"en\"><head><meta charset=\"utf-8\"><title>imtet: %u</title></head><body><h1>%u: "
    "%s</h1>"
    "<p>The address that <code>imtet serve</code> printed when it started leads to the newest run; every run links to "
    "the others.</p></body></html>\n";

/* A page for a person, who asks for one, JSON for a script. */
static Answer refusal(struct MHD_Connection *c, unsigned code, const char *words)
{
    const char *wanted = MHD_lookup_connection_value(c, MHD_HEADER_KIND, MHD_HTTP_HEADER_ACCEPT);
    Answer a = {.code = code, .type = PAGE_TYPE};
    char said[sizeof(Err)];
    text_copy(said, words);
    for (char *p = said; (p = strpbrk(p, "<&")); *p = ' ') /* of a path, say */
        ;
    if (wanted && strstr(wanted, "text/html") && asprintf(&a.text, REFUSED, code, code, said) > 0)
        return a;
    a.type = JSON_TYPE;
    answer_json(json_of("error=%s", words), &a);
    return a;
}

static Answer redirection(const char *place)
{
    Answer a = {.code = MHD_HTTP_FOUND, .type = "text/plain"};
    snprintf(a.place, sizeof a.place, "%s/", place);
    return a;
}

/* -- what is shown ------------------------------------------------------------------------------------------------- */

static const char NO_FRONT[] =
    "<!DOCTYPE html><html lang=\"en\"><head><meta charset=\"utf-8\"><meta http-equiv=\"refresh\" content=\"1\">"
    "<title>imtet</title></head><body><h1>No front</h1><p>%zu designs simulated, %zu failed: %s.</p>"
    "<p>This page looks again every second.</p></body></html>\n";

/* The report of a run that has a front; before, how far the search is, by a page that looks again. */
static Status show_page(Visit *v, Answer *a, Err *err)
{
    const Snapshot *snapshot = v->view.snapshot;
    Err why = {0};
    a->type = PAGE_TYPE;
    if (snapshot->run.n_front > 0)
        return report_live(&snapshot->run, &a->text, err);
    const int is_over = snapshot->standing.state == RUN_FINISHED && run_why_empty(&snapshot->run, &why) == STATUS_UNMET;
    return asprintf(&a->text, NO_FRONT, snapshot->standing.progress.simulated, snapshot->standing.n_failed,
                    is_over ? "no design meets search.limits" : "no design is on a front yet") > 0
               ? STATUS_OK
               : fail_memory(err, 1, "a page");
}

static Status show_front(Visit *v, Answer *a, Err *)
{
    return answer_json(answer_front(v->view.snapshot), a);
}

/* Which variables move which objectives. */
static Status show_importance(Visit *v, Answer *a, Err *err)
{
    const Run *run = &v->view.snapshot->run;
    Importance m = {0};
    TRY(importance_of(run, &m, err));
    const Status status = answer_json(importance_json(&m, &run->schema), a);
    importance_free(&m);
    return status;
}

static Status show_design(Visit *v, Answer *a, Err *err)
{
    return on_demand_design(v->view.snapshot->on_demand, &v->view.snapshot->run, v->request->path.number[0], &a->text,
                            err);
}

static Status show_scene(Visit *v, Answer *a, Err *err)
{
    return on_demand_scene(v->view.snapshot->on_demand, &v->view.snapshot->run, &a->text, err);
}

static Status show_notes(Visit *v, Answer *a, Err *err)
{
    json_t *notes;
    TRY(notes_read(v->view.snapshot->run.folder, &notes, err));
    return answer_json(notes, a);
}

/* Of a design of the run, 0: of the run; what is noted then is the answer. */
static Status take_note(Visit *v, Answer *a, Err *err)
{
    const Run *run = &v->view.snapshot->run;
    const json_t *id = json_object_get(v->given, "id");
    const char *text = json_string_value(json_object_get(v->given, "text"));
    Status status = STATUS_OK;
    if (!json_is_integer(id) || !text)
        status = bad_data(err, "a note is {\"id\": number, \"text\": words}");
    else if (json_integer_value(id) != 0 && run_find(run, json_integer_value(id)) == run->table.n)
        status = fail(err, STATUS_MISSING, "%s: has no design %lld", run->folder, json_integer_value(id));
    pthread_mutex_lock(&v->server->notes);
    THEN(status, notes_put(run->folder, json_integer_value(id), text, err));
    pthread_mutex_unlock(&v->server->notes);
    TRY(status);
    return show_notes(v, a, err);
}

/* A design that was kept of what-if: its id in the run. */
static Status keep_design(Visit *v, Answer *a, Err *err)
{
    const Snapshot *snapshot = v->view.snapshot;
    const json_t *x = json_object_get(v->given, "x");
    const size_t n = json_array_size(x);
    double values[DESIGN_VARIABLES_MAX];
    long id = 0;
    for (size_t j = 0; j < n && j < DESIGN_VARIABLES_MAX; j++)
        values[j] = json_number_value(json_array_get(x, j));
    TRY(on_demand_keep(snapshot->on_demand, &snapshot->run, n, values, &id, err));
    return answer_json(json_of("id=%ld", id), a);
}

/* The fronts of this run and the others that the path names, in one box. */
static Status show_against(Visit *v, Answer *a, Err *err)
{
    Watch *w = v->server->watch;
    const ServePath *path = &v->request->path;
    View other[PATH_NUMBERS] = {0};
    const Snapshot *snapshot[PATH_NUMBERS + 1] = {v->view.snapshot};
    const char *name[PATH_NUMBERS + 1] = {watch_name(w, v->run)};
    json_t *all = NULL;
    Status status = STATUS_OK;
    for (size_t i = 0; i < path->n_numbers && status == STATUS_OK; i++) {
        status = path->number[i] >= (long)watch_n(w) ? fail(err, STATUS_MISSING, "there is no run %ld", path->number[i])
                                                     : watch_take(w, path->number[i], PAGE_S, &other[i], err);
        snapshot[i + 1] = other[i].snapshot;
        name[i + 1] = status == STATUS_OK ? watch_name(w, path->number[i]) : NULL;
    }
    THEN(status, answer_against(path->n_numbers + 1, snapshot, name, &all, err));
    for (size_t i = 0; i < path->n_numbers; i++)
        watch_give(&other[i]);
    TRY(status);
    return answer_json(all, a);
}

/* -- all runs ------------------------------------------------------------------------------------------------------ */

/* Every run, unreadable ones with the reason. */
static Status show_runs(Visit *v, Answer *a, Err *)
{
    Watch *w = v->server->watch;
    json_t *list = json_array();
    watch_find(w);
    for (size_t i = 0; i < watch_n(w); i++) {
        View view;
        Err why = {0};
        if (!watch_name(w, i))
            continue;
        if (watch_take(w, i, GLANCE_S, &view, &why) != STATUS_OK)
            view.why = why;
        json_t *notes = NULL, *one = answer_status(&view, watch_name(w, i));
        if (view.snapshot)
            notes_read(view.snapshot->run.folder, &notes, &why);
        json_put(one, "at=%ld note=%s", i, json_string_value(json_object_get(notes, "0")));
        json_decref(notes);
        watch_give(&view);
        json_array_append_new(list, one);
    }
    return answer_json(list, a);
}

/* Another name for the run, or none: then it is removed. */
static Status move_run(Visit *v, Answer *a, Err *err)
{
    const json_t *name = json_object_get(v->given, "name");
    TRY(json_is_string(name) || json_is_null(name)
            ? watch_move(v->server->watch, v->run, json_string_value(name), err)
            : bad_data(err, "wanted is {\"name\": words}, or null to remove the run"));
    return show_runs(v, a, err);
}

/* The run whose last session began last. */
static Status show_newest(Visit *v, Answer *a, Err *)
{
    Watch *w = v->server->watch;
    size_t newest = 0;
    char number[24], latest[24] = "";
    for (size_t i = 0; i < watch_n(w); i++) {
        View view;
        if (watch_take(w, i, GLANCE_S, &view, &(Err){0}) != STATUS_OK)
            continue;
        const Run *run = &view.snapshot->run;
        const char *started = run->n_sessions > 0 ? run->session[run->n_sessions - 1].started : "";
        if (strcmp(started, latest) >= 0) {
            text_copy(latest, started);
            newest = i;
        }
        watch_give(&view);
    }
    snprintf(number, sizeof number, "%zu", newest);
    *a = redirection(number);
    return STATUS_OK;
}

/* -- events -------------------------------------------------------------------------------------------------------- */

struct Stream {
    Server *server;
    size_t run;
    long seen; /* version */
};

/* The next event, or a comment that keeps the connection alive, in one piece: an event that has no room is left out. */
static ssize_t read_events(void *user, uint64_t, char *out, size_t room)
{
    Stream *e = user;
    Watch *w = e->server->watch;
    View view = watch_next(w, e->run, e->seen, BEAT_S);
    if (!view.snapshot && watch_is_stopped(w))
        return MHD_CONTENT_READER_END_OF_STREAM;
    json_t *status = view.snapshot ? answer_status(&view, watch_name(w, e->run)) : NULL;
    char *text = status ? json_dumps(status, JSON_COMPACT | JSON_REAL_PRECISION(6)) : NULL;
    const size_t n = text ? strlen(text) : 0, whole = n + sizeof "data: \n\n";
    const int sent = text && whole <= room ? snprintf(out, room, "data: %s\n\n", text) : snprintf(out, room, ":\n\n");
    e->seen = view.version;
    free(text);
    json_decref(status);
    watch_give(&view);
    return sent;
}

static Status show_events(Visit *v, Answer *a, Err *err)
{
    Stream *e;
    TRY_ROOM(e, 1, "events", err);
    *e = (Stream){.server = v->server, .run = v->run};
    a->type = "text/event-stream";
    a->stream = e;
    return STATUS_OK;
}

/* -- requests ------------------------------------------------------------------------------------------------------ */

typedef Status (*ShowFn)(Visit *v, Answer *a, Err *err);

struct Route {
    const char *word;
    int has_run;
    size_t n_numbers; /* at most, and one if not 0 */
    ShowFn get, post; /* NULL: not known */
};

static const Route ROUTES[] = {{"", 0, 0, show_newest, NULL},
                               {"runs", 0, 0, show_runs, NULL},
                               {"", 1, 0, show_page, NULL},
                               {"events", 1, 0, show_events, NULL},
                               {"front", 1, 0, show_front, NULL},
                               {"importance", 1, 0, show_importance, NULL},
                               {"design", 1, 1, show_design, NULL},
                               {"scene", 1, 0, show_scene, NULL},
                               {"notes", 1, 0, show_notes, take_note},
                               {"kept", 1, 0, NULL, keep_design},
                               {"move", 1, 0, NULL, move_run},
                               {"against", 1, PATH_NUMBERS, show_against, NULL}};

/* The answer to a request that is whole. */
static enum MHD_Result respond(Server *s, struct MHD_Connection *c, const char *method, const Request *r)
{
    const Route *route = r->route;
    const ShowFn show = strcmp(method, "POST") == 0 ? route->post : route->get;
    json_t *given = json_loadb(r->body, r->n, JSON_REJECT_DUPLICATES, NULL);
    Visit v = {.server = s, .request = r, .run = route->has_run ? r->path.run : 0, .given = given};
    Answer a = {.code = MHD_HTTP_OK, .type = JSON_TYPE};
    Err err = {0};
    set_waiting(s, socket_of(c), 0);
    Status status = STATUS_OK;
    if (v.run >= watch_n(s->watch))
        status = fail(&err, STATUS_MISSING, "there is no such run");
    else if (route->has_run)
        status = watch_take(s->watch, v.run, PAGE_S, &v.view, &err);
    THEN(status, show(&v, &a, &err));
    watch_give(&v.view);
    json_decref(given);
    if (status != STATUS_OK)
        a = refusal(c,
                    status == STATUS_MISSING    ? MHD_HTTP_NOT_FOUND
                    : status == STATUS_BAD_DATA ? MHD_HTTP_BAD_REQUEST
                                                : MHD_HTTP_INTERNAL_SERVER_ERROR,
                    err.text);
    if (a.stream && strcmp(method, "HEAD") == 0) { /* libmicrohttpd would send the end of its chunks */
        free(a.stream);
        a.stream = NULL;
    }
    return send_answer(c, &a);
}

/* Whether a request is refused, or sent elsewhere, before its body is read: a->code. */
static void judge(const Server *s, struct MHD_Connection *c, const char *url, const char *method, Request *r, Answer *a)
{
    const char *host = MHD_lookup_connection_value(c, MHD_HEADER_KIND, MHD_HTTP_HEADER_HOST);
    const char *origin = MHD_lookup_connection_value(c, MHD_HEADER_KIND, MHD_HTTP_HEADER_ORIGIN);
    const char *length = MHD_lookup_connection_value(c, MHD_HEADER_KIND, MHD_HTTP_HEADER_CONTENT_LENGTH);
    const int posts = strcmp(method, "POST") == 0, gets = strcmp(method, "GET") == 0 || strcmp(method, "HEAD") == 0;
    const PathVerdict verdict = guard_path(s->token, url, &r->path);
    const ServePath *p = &r->path;
    for (const Route *at = ROUTES; at < ROUTES + N_OF(ROUTES) && verdict == PATH_OK; at++)
        if (strcmp(p->word, at->word) == 0 && at->has_run == (p->run >= 0) &&
            (at->n_numbers > 0) == (p->n_numbers > 0) && p->n_numbers <= at->n_numbers)
            r->route = at;
    if (!guard_host(host) || !guard_origin(origin, host) || verdict == PATH_NONE)
        *a = refusal(c, MHD_HTTP_FORBIDDEN, "refused");
    else if (verdict == PATH_UNENDED)
        *a = redirection(strrchr(url, '/') + 1);
    else if (!r->route)
        *a = refusal(c, MHD_HTTP_NOT_FOUND, "there is no such part");
    else if (!(gets ? r->route->get : posts ? r->route->post : NULL)) {
        *a = refusal(c, MHD_HTTP_METHOD_NOT_ALLOWED, "this method is not known here");
        a->allow = !r->route->get ? "POST" : r->route->post ? "GET, HEAD, POST" : "GET, HEAD";
    } else if (length && strtoull(length, NULL, 10) > (posts ? BODY_MAX : 0))
        *a = refusal(c, MHD_HTTP_CONTENT_TOO_LARGE, "too large");
}

/* Called when the headers are there, for every piece of the body, and at its end. */
static enum MHD_Result handle(void *user, struct MHD_Connection *c, const char *url, const char *method, const char *,
                              const char *piece, size_t *n_piece, void **request)
{
    Server *s = user;
    Request *r = *request;
    Answer a = {0};
    if (!r) {
        r = *request = calloc(1, sizeof *r);
        if (!r)
            return MHD_NO;
        judge(s, c, url, method, r, &a);
        return a.code ? send_answer(c, &a) : MHD_YES;
    }
    if (*n_piece == 0 && !r->is_too_large)
        return respond(s, c, method, r);
    if (*n_piece == 0) {
        a = refusal(c, MHD_HTTP_CONTENT_TOO_LARGE, "too large");
        return send_answer(c, &a);
    }
    r->is_too_large |= *n_piece > sizeof r->body - r->n; /* chunks: what is too much is dropped, until it is ended */
    if (!r->is_too_large) {
        memcpy(r->body + r->n, piece, *n_piece);
        r->n += *n_piece;
    }
    *n_piece = 0;
    return MHD_YES;
}

/* -- life ---------------------------------------------------------------------------------------------------------- */

__attribute__((format(printf, 2, 0))) static void say_nothing(void *user, const char *format, va_list list)
{
    (void)user;
    (void)format;
    (void)list;
}

/* Nothing of a path is unescaped: none that we know has a %. */
static size_t leave_escaped(void *, struct MHD_Connection *, char *text)
{
    return strlen(text);
}

Status serve_open(Server **out, const ServeOptions *o, Err *err)
{
    const struct sockaddr_in here = {
        .sin_family = AF_INET, .sin_port = htons((uint16_t)o->port), .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    struct rlimit files;
    unsigned n = PEERS_MAX;
    Server *s;
    *out = NULL;
    TRY_ROOM(s, 1, "a server", err);
    s->moved = o->moved;
    memset(s->waiting, -1, sizeof s->waiting);
    pthread_mutex_init(&s->mutex, NULL);
    pthread_mutex_init(&s->notes, NULL);
    Status status = guard_token(s->token, err);
    THEN(status, watch_open(&s->watch, o->folder, &s->moved, err));

    /* Where few files may be open (ulimit -n) there are fewer connections: at the limit of files nothing could be
     * accepted. */
    if (getrlimit(RLIMIT_NOFILE, &files) == 0 && files.rlim_cur <= FILES_OWN + PEERS_MAX)
        n = files.rlim_cur > FILES_OWN + 2 ? (unsigned)files.rlim_cur - FILES_OWN : 2;
    s->n_waiting = n / 2;
    if (status == STATUS_OK)
        s->daemon = MHD_start_daemon(
            MHD_USE_INTERNAL_POLLING_THREAD | MHD_USE_THREAD_PER_CONNECTION | MHD_USE_POLL | MHD_USE_ERROR_LOG,
            (uint16_t)o->port, NULL, NULL, handle, s, MHD_OPTION_EXTERNAL_LOGGER, say_nothing, NULL,
            MHD_OPTION_UNESCAPE_CALLBACK, leave_escaped, NULL, MHD_OPTION_SOCK_ADDR, &here, MHD_OPTION_CONNECTION_LIMIT,
            n, MHD_OPTION_CONNECTION_TIMEOUT, STALL_S, MHD_OPTION_CONNECTION_MEMORY_LIMIT, HEAD_MAX,
            MHD_OPTION_NOTIFY_CONNECTION, note_connection, s, MHD_OPTION_NOTIFY_COMPLETED, note_completed, s,
            MHD_OPTION_END);
    if (!s->daemon) {
        THEN(status, fail(err, STATUS_IO, "127.0.0.1:%d: no server: %s", o->port, strerror(errno)));
        serve_close(s);
        return status;
    }
    s->port = MHD_get_daemon_info(s->daemon, MHD_DAEMON_INFO_BIND_PORT)->port;
    snprintf(s->url, sizeof s->url, "http://127.0.0.1:%d/%s/", s->port, s->token);
    *out = s;
    return STATUS_OK;
}

const char *serve_url(const Server *s)
{
    return s->url;
}

int serve_port(const Server *s)
{
    return s->port;
}

void serve_close(Server *s)
{
    if (!s)
        return;
    if (s->watch)
        watch_stop(s->watch); /* streams end */
    if (s->daemon)
        MHD_stop_daemon(s->daemon);
    if (s->watch)
        watch_close(s->watch);
    pthread_mutex_destroy(&s->mutex);
    pthread_mutex_destroy(&s->notes);
    free(s);
}
