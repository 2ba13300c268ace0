/* api/handle.h -- what is behind an imtet_search, for its calls (search.c) and its file (saved.c).
 *
 *   designs   row i of the table has id i + 1, its number in the search: what was ever asked for, with the answer where
 *             it is told
 *
 * Life cycle  handle_create -> handle_open -> calls ... -> handle_free
 * Threads     the lock is held by every call */
#pragma once

#include <pthread.h>

#include "api/failure.h"
#include "evaluate/schema.h"
#include "moga/search.h"
#include "settings/settings.h"

typedef enum { DESIGN_FREE, DESIGN_OUT, DESIGN_TOLD } DesignPlace;

typedef struct {
    DesignPlace place;
    int is_named; /* in the answers at hand */
} AskedDesign;

struct imtet_search {
    pthread_mutex_t lock;
    pid_t process; /* that made it */
    Settings settings;
    Schema schema; /* senses of the objectives */
    Problem problem;
    SearchConfig config;
    double *lower, *upper, *given;
    size_t n_given;
    VariableKind *kind;
    Steps *steps;
    double aspire[OBJECTIVES_MAX];
    Search *search;
    EvaluationTable table; /* extra: the constraint values */
    AskedDesign *design;   /* (table.n) */
    size_t room, n_told;
    size_t n_entered, n_state; /* of a saved one: rows that have entered its search, whose state is */
    unsigned char *state;      /* (n_state), until it is open */
    double began;              /* [s] of the clock */
    int is_over;
    StopReason reason;
    size_t next;    /* no design before it is free */
    size_t known;   /* designs of the file it was loaded from, any of which may have been asked for */
    size_t failing; /* of the last that were told, in a row, */
    size_t failed;  /* up to this row */
};

/* An empty search of that shape, for handle_open; lower, upper and given are to be filled. Where it fails *out is what
 * there is of it, for handle_free. */
Status handle_create(imtet_search **out, const Settings *s, size_t n_given, Err *err);

/* Room for one more design, at the end of the table. */
Status handle_add(imtet_search *s, const double x[], Err *err);

/* Bounds, kinds and settings are there, and of a saved search designs and state. */
Status handle_open(imtet_search *s, Err *err);
void handle_free(imtet_search *s); /* NULL is fine */

/* The search as bytes in a file, beside which it is written first. Of one that cannot be read *out is what there is of
 * it, for handle_free. */
Status saved_write(imtet_search *s, const char *path, Err *err);
Status saved_read(imtet_search **out, const char *path, Err *err);
