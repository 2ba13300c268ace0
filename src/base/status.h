/* base/status.h -- one list of what can go wrong, its words and the exit code it becomes.
 *
 * Every function that can fail returns a Status and writes one sentence into the caller's Err: what, where (file,
 * line, key), the number that was found and what to do. Only main and src/cmd print or exit.
 *
 * Threads  an Err belongs to one thread; nothing here is shared. */
#pragma once

/* Headers of the C library that nearly every file needs. */
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/*    name           exit  words                                                  (exit codes as in sysexits.h) */
#define STATUS_LIST(X)                                                                                                 \
    X(OK, 0, "ok")                                                                                                     \
    X(USAGE, 2, "the command line is not understood")                                                                  \
    X(BAD_DATA, 65, "a file or a setting holds something that cannot be used")                                         \
    X(MISSING, 66, "an input file is not there or cannot be read")                                                     \
    X(UNMET, 69, "no design meets the limits")                                                                         \
    X(INTERNAL, 70, "the program failed")                                                                              \
    X(NO_MEMORY, 71, "out of memory")                                                                                  \
    X(IO, 74, "a file could not be written")                                                                           \
    X(STOPPED, 75, "stopped before the end; it can be resumed")

typedef enum {
#define X(name, exit_code, words) STATUS_##name,
    STATUS_LIST(X)
#undef X
        STATUS_COUNT
} Status;

/* A second code for callers that must decide more finely; they never decide by the words. */
typedef enum {
    SUB_NONE,
    SUB_DAMAGED,   /* a run's database that is not what was written */
    SUB_NO_RUN,    /* ... that is none of a run */
    SUB_EMPTY,     /* ... of no bytes */
    SUB_RAGGED,    /* a line of a table with another number of cells than those above */
    SUB_NO_NUMBER, /* a cell that is no number */
    SUB_NO_RECORD  /* a file that holds no acceleration */
} ErrSub;

typedef struct {
    Status code;
    ErrSub sub;
    char text[480];
} Err;

/* Writes the sentence, without invisible characters (base/visible.h), and returns code, so that
 * `return fail(err, STATUS_IO, "...")` reads as one thought. One that is too long ends in "...". */
__attribute__((format(printf, 3, 4))) Status fail(Err *err, Status code, const char *format, ...);
__attribute__((format(printf, 4, 5))) Status fail_sub(Err *err, Status code, ErrSub sub, const char *format, ...);

/* Of a file or a setting that holds something that cannot be used: STATUS_BAD_DATA; of the command line:
 * STATUS_USAGE. */
#define bad_data(err, ...) fail(err, STATUS_BAD_DATA, __VA_ARGS__)
#define misused(err, ...)  fail(err, STATUS_USAGE, __VA_ARGS__)

/* "no memory for N WHAT", or of one "no memory for WHAT". */
Status fail_memory(Err *err, size_t n, const char *what);

/* What a system call's errno amounts to: STATUS_NO_MEMORY, or else `otherwise`. */
Status status_of_errno(int why, Status otherwise);

/* Of an input that could not be opened, by errno: "PATH: there is no folder FOLDER", "PATH: there is no such file or
 * folder", or the cause; STATUS_MISSING, or where memory was refused STATUS_NO_MEMORY. */
Status fail_missing(Err *err, const char *path);

/* "PATH: WHAT: CAUSE", by errno: STATUS_IO, or where memory was refused STATUS_NO_MEMORY. */
Status fail_errno(Err *err, const char *path, const char *what);

const char *status_words(Status code);
int status_exit_code(Status code);

/* The word of list[0..n) nearest to `word`: the shortest that begins with it, else by edit distance; NULL: none is near
 * enough to be meant. */
const char *nearest_word(const char *word, const char *const list[], int n);

/* "WHERE: WORD is no NOUN; did you mean ...?", or all of the list where none is near. */
Status fail_no_word(Err *err, Status code, const char *where, const char *word, const char *noun,
                    const char *const list[], int n);

#define TRY(expr)                                                                                                      \
    do {                                                                                                               \
        Status try_status_ = (expr);                                                                                   \
        if (try_status_ != STATUS_OK)                                                                                  \
            return try_status_;                                                                                        \
    } while (0)

/* The next of several steps whose end has something to release: taken where all before it went well. */
#define THEN(status, expr)                                                                                             \
    do {                                                                                                               \
        if ((status) == STATUS_OK)                                                                                     \
            (status) = (expr);                                                                                         \
    } while (0)

#define N_OF(array)  (sizeof(array) / sizeof *(array)) /* elements */
#define MIN_OF(a, b) ((a) < (b) ? (a) : (b))
#define MAX_OF(a, b) ((a) > (b) ? (a) : (b))

/* As much of a text as the array has room for, with its zero. */
#define text_copy(array, text) ((void)snprintf(array, sizeof(array), "%s", text))

/* Zeroed memory for n of what the pointer points to; where it is refused the function returns, as by TRY. what: of the
 * many, "designs", or with n = 1 of one, "a run". */
#define TRY_ROOM(pointer, n, what, err)                                                                                \
    do {                                                                                                               \
        (pointer) = calloc((size_t)(n), sizeof *(pointer));                                                            \
        if (!(pointer))                                                                                                \
            return fail_memory(err, (size_t)(n), what);                                                                \
    } while (0)
