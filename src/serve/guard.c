#include "serve/guard.h"

#include <errno.h>
#include <sys/random.h>

Status guard_token(char token[TOKEN_TEXT], Err *err)
{
    unsigned char bytes[(TOKEN_TEXT - 1) / 2];
    if (getrandom(bytes, sizeof bytes, 0) != (ssize_t)sizeof bytes)
        return fail(err, STATUS_INTERNAL, "no random bytes for the address: %s", strerror(errno));
    for (size_t i = 0; i < sizeof bytes; i++)
        snprintf(token + 2 * i, 3, "%02x", bytes[i]);
    return STATUS_OK;
}

int guard_host(const char *host)
{
    static const char *const NAMES[] = {"127.0.0.1", "localhost"};
    for (size_t i = 0; host && i < N_OF(NAMES); i++) {
        const size_t n = strlen(NAMES[i]);
        const char *port = host + n + 1;
        if (strncmp(host, NAMES[i], n) == 0 &&
            (!host[n] || (host[n] == ':' && *port && strspn(port, "0123456789") == strlen(port))))
            return 1;
    }
    return 0;
}

int guard_origin(const char *origin, const char *host)
{
    static const char SCHEME[] = "http://";
    const size_t n = sizeof SCHEME - 1;
    return !origin || (host && strncmp(origin, SCHEME, n) == 0 && strcmp(origin + n, host) == 0);
}

/* Digits up to the next slash or comma; *at moves behind it. */
static int take_number(const char **at, long *number)
{
    const size_t n = strspn(*at, "0123456789");
    if (n == 0 || n > 9 || ((*at)[n] && !strchr("/,", (*at)[n])))
        return 0;
    *number = strtol(*at, NULL, 10);
    *at += n + ((*at)[n] != 0);
    return 1;
}

PathVerdict guard_path(const char *token, const char *url, ServePath *out)
{
    unsigned char differs = 0;
    *out = (ServePath){.run = -1};
    if (url[0] != '/' || strnlen(url + 1, TOKEN_TEXT) < TOKEN_TEXT - 1)
        return PATH_NONE;
    for (size_t i = 0; i < TOKEN_TEXT - 1; i++) /* in a time that does not depend on how much of it is right */
        differs |= (unsigned char)(token[i] ^ url[1 + i]);
    if (differs)
        return PATH_NONE;
    const char *at = url + TOKEN_TEXT;
    if (*at != '/')
        return *at ? PATH_UNKNOWN : PATH_UNENDED;
    at++;
    if (take_number(&at, &out->run) && at[-1] != '/')
        return at[-1] == ',' ? PATH_UNKNOWN : PATH_UNENDED;
    const size_t n = strspn(at, "abcdefghijklmnopqrstuvwxyz-");
    if (n >= WORD_MAX)
        return PATH_UNKNOWN;
    memcpy(out->word, at, n);
    at += n;
    if (*at != '/' || n == 0)
        return *at ? PATH_UNKNOWN : PATH_OK;
    at++;
    do
        if (out->n_numbers == PATH_NUMBERS || !take_number(&at, &out->number[out->n_numbers++]))
            return PATH_UNKNOWN;
    while (at[-1] == ',');
    return at[-1] == '/' ? PATH_UNKNOWN : PATH_OK;
}
