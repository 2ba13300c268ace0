/* serve/serve.h -- a small web server on the loopback that shows runs: the page of the report, and what only a program
 * behind it can show.
 *
 *   GET  /TOKEN/                    to the run that was started last
 *   GET  /TOKEN/runs                [status of every run] (serve/answers.h), with its number in "at"
 *   GET  /TOKEN/RUN/                the page (report/report.h); RUN: a number
 *   GET  /TOKEN/RUN/events          server-sent events: the status, whenever it changes
 *   GET  /TOKEN/RUN/front           front and growth as they are now
 *   GET  /TOKEN/RUN/importance      total Sobol indices of variables for objectives
 *   GET  /TOKEN/RUN/design/ID       a design simulated (serve/on_demand.h)
 *   GET  /TOKEN/RUN/scene           what the page simulates with (report/what_if.h)
 *   GET  /TOKEN/RUN/notes           what was noted of designs (store/notes.h);  POST: {"id": N, "text": T}
 *   POST /TOKEN/RUN/kept            {"x": [...]} of what-if is simulated and stored in the run (serve/on_demand.h)
 *   POST /TOKEN/RUN/move            {"name": N}, null: the run is removed; of a folder of runs
 *   GET  /TOKEN/RUN/against/OTHER,...   up to four runs
 *
 * HEAD is GET without the body; /TOKEN and /TOKEN/RUN lead to the addresses with a slash. No GET writes to a
 * run. A request that is refused gets a status and {"error": words}: 403 token, Host or Origin, 404, 405,
 * 413. A run that was made anew in the place of another is served as it is now.
 *
 * Bounds    PEERS_MAX connections, fewer where few files may be open; of those that wait for a request half as many,
 *           for each further one the one that has waited longest goes; HEAD_MAX bytes of headers, BODY_MAX of body
 * Library   libmicrohttpd, a thread for each connection
 * Life cycle  serve_open -> serve_url ... -> serve_close
 * Errors    no such run: STATUS_MISSING; the port is taken: STATUS_IO */
#pragma once

#include "study/record_paths.h"

enum { PEERS_MAX = 256, HEAD_MAX = 16 << 10, BODY_MAX = 32 << 10 };

typedef struct Server Server;

typedef struct {
    const char *folder; /* a run, or a folder of runs */
    int port;           /* 0: any that is free */
    RecordPaths moved;
} ServeOptions;

Status serve_open(Server **out, const ServeOptions *o, Err *err);
const char *serve_url(const Server *s);
int serve_port(const Server *s);
void serve_close(Server *s); /* NULL is fine; answers under way are finished */
