/* serve/guard.h -- whom the server answers: who knows the token and asks this machine by its own name.
 *
 *   token    192 random bits (getrandom) in every path, compared in constant time
 *   Host     127.0.0.1 or localhost: a foreign name that resolves to the loopback (DNS rebinding) is refused. At any
 *            port: the browser at the other end of an ssh tunnel names that of the tunnel, and a page of another port
 *            has another Origin
 *   Origin   none, or http://HOST of the same request: other pages of the same browser are refused
 *   path     /TOKEN/WORD, /TOKEN/RUN/WORD or /TOKEN/RUN/WORD/NUMBER,NUMBER..., all of digits: nothing of a request
 *            ever becomes a path of the disk
 *
 * Threads  pure functions
 * Source   OWASP, Cross-Site Request Forgery Prevention; RFC 6454 (Origin), RFC 9110 (Host) */
#pragma once

#include "base/status.h"

enum { TOKEN_TEXT = 49, WORD_MAX = 16, PATH_NUMBERS = 3 };

Status guard_token(char token[TOKEN_TEXT], Err *err);

/* NULL: the header is not there. */
int guard_host(const char *host);
int guard_origin(const char *origin, const char *host);

typedef struct {
    long run;            /* -1: none */
    char word[WORD_MAX]; /* of a-z and -; empty: none */
    size_t n_numbers;
    long number[PATH_NUMBERS]; /* (n_numbers) */
} ServePath;

/* NONE: the token is wrong; UNENDED: /TOKEN or /TOKEN/RUN, whose pages end with a slash. */
typedef enum { PATH_NONE, PATH_UNKNOWN, PATH_UNENDED, PATH_OK } PathVerdict;
PathVerdict guard_path(const char *token, const char *url, ServePath *out);
