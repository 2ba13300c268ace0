/* api/handle.h -- what is behind an imtet_search, for its calls (search.c) and its file (saved.c).
 *
 * Threads  the lock is held by every call */
#pragma once

#include <pthread.h>
#include <sys/types.h>

#include "api/asking.h"
#include "api/failure.h"
#include "evaluate/schema.h"
#include "settings/settings.h"

struct imtet_search {
    pthread_mutex_t lock;
    pid_t process; /* that made it */
    Settings settings;
    Schema schema; /* senses of the objectives */
    double *lower, *upper, *given;
    size_t n_given;
    VariableKind *kind;
    double aspire[OBJECTIVES_MAX];
    Asking asking;
    size_t next;    /* no design before it is free */
    size_t known;   /* designs of the file it was loaded from, any of which may have been asked for */
    size_t failing; /* of the last that were told, in a row, */
    size_t failed;  /* up to this row */
};

/* An empty search of that shape, for handle_open; lower, upper and given are to be filled. */
Status handle_create(imtet_search **out, const Settings *s, size_t n_given, Err *err);

/* Bounds, kinds and settings are there, and perhaps designs. */
Status handle_open(imtet_search *s, Err *err);
void handle_free(imtet_search *s); /* NULL is fine */

/* The search as bytes in a file, beside which it is written first. */
Status saved_write(imtet_search *s, const char *path, Err *err);
Status saved_read(imtet_search **out, const char *path, Err *err);
