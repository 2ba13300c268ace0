/* imtet.h -- the search for a Pareto front by few evaluations, as a library: ask for designs, tell what they are worth.
 *
 *   minimise (or maximise) F(x),   G(x) <= 0,   lower <= x <= upper
 *
 *     #include <imtet.h>
 *     double X[8 * 2], F[8 * 2];
 *     long ids[8];
 *     size_t n;
 *     imtet_error error;
 *     imtet_search *s;
 *     imtet_status bad;
 *     const char *settings[] = {"search.max_evals=200", "search.seed=1", NULL};
 *     imtet_search_options o = {.size = sizeof o, .variables = 2, .objectives = 2, .settings = settings};
 *     bad = imtet_search_create(&o, &s, &error);
 *     while (!bad && !(bad = imtet_search_ask(s, 8, ids, X, &n, &error)) && n > 0) {
 *         for (size_t i = 0; i < n; i++) evaluate(X + 2 * i, F + 2 * i);
 *         bad = imtet_search_tell(s, n, ids, F, NULL, NULL, &error);
 *     }
 *     if (bad) fprintf(stderr, "%s\n", error.text);
 *     imtet_search_free(&s);
 *
 * Link with `pkg-config --cflags --libs imtet`. The simulator of towers: imtet_scene.h.
 *
 * Shapes     X (n, variables), F (n, objectives), G (n, constraints), row-major. F has natural signs: `senses` says
 *            which objectives are to be large. Whole numbers and choices are numbers too: choice:a|b is 0 or 1
 * Look-ahead which answers a design is chosen from follows from its id alone: those to all but the last ones before it
 *            (search.ahead), which may be under way. So several designs can be asked for at once, 24 and more of 192
 *            evaluations or more; ask gives fewer than it is asked for, or none, where more answers are to be known
 *            first. A design that will never be told holds the search up: tell that it failed. Ids are 1, 2, ... in the
 *            order of asking
 * The same   options and answers give the same designs, to the last bit, in whatever portions they are asked for, in
 *            whatever order they are told, saved and loaded in between or not, at any number of threads: those of
 *            `imtet optimize` with the same settings. On processors of several kinds: with OPENBLAS_CORETYPE=Haswell in
 *            the environment, as the program has it; a search that is loaded on others goes on with other designs
 * Failures   a design that failed is told with a reason in words. The search avoids designs like it. Where
 *            search.failures_max designs in a row have failed, ask says so once, and goes on when it is called again.
 *            Where none has succeeded when the search is done, its front is IMTET_INTERNAL, with the commonest reason
 * Ownership  a search belongs to the caller, who frees it; what is passed in is copied, what comes out is written into
 *            the caller's arrays
 * Threads    any: calls on one search exclude each other, searches do not know of each other. Between two calls no
 *            thread of the library runs. Not across fork: a child loads a saved search. While designs are chosen, or a
 *            scene opened, the OpenBLAS of this process has one thread
 * Errors     every function that can fail returns an imtet_status and writes a sentence into *error (NULL: not wanted):
 *            what, where, what to do. State is unchanged. A NULL handle is an error too, as free leaves it. Where a
 *            function succeeds the sentence is empty, but for a note of imtet_search_load */
#ifndef IMTET_H
#define IMTET_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Semantic: functions and fields of one major version stay; below 1, of one minor version. */
#define IMTET_VERSION "0.2.0"
#define IMTET_API     __attribute__((visibility("default")))

typedef enum {
    IMTET_OK,
    IMTET_MISUSED,  /* the call makes no sense */
    IMTET_BAD_DATA, /* a number, a setting or a file holds something that cannot be used */
    IMTET_MISSING,  /* a file is not there or cannot be read */
    IMTET_UNMET,    /* no design meets the limits */
    IMTET_INTERNAL, /* the library failed, or every evaluation does */
    IMTET_NO_MEMORY,
    IMTET_IO, /* a file could not be written */
    IMTET_STOPPED
} imtet_status;

typedef struct {
    imtet_status status;
    char text[480]; /* one sentence in UTF-8, or empty */
} imtet_error;

/* Of the library at hand: IMTET_VERSION of its own header. */
IMTET_API const char *imtet_version(void);

typedef struct imtet_search imtet_search;

typedef struct {
    size_t size;                  /* sizeof(imtet_search_options), so that later versions may add fields */
    size_t variables, objectives; /* 1 at least */
    size_t constraints;           /* G <= 0; 100 at most */
    const double *lower, *upper;  /* (variables) finite; NULL: 0 and 1 */
    const char *kinds;            /* real, log, int or choice:WORD|WORD, one for all variables or a comma
                                                list; NULL: real */
    const char *senses;           /* min or max, one for all objectives or a comma list; NULL: min */
    size_t starts;                /* designs to begin with, */
    const double *start;          /* (starts, variables), moved into the box */
    const char *const *settings;  /* "search.KEY=VALUE" as `imtet settings` lists them, NULL behind the last;
                                                NULL: none. search.max_evals, seed, population, initial,
                                                max_hours, stop_after, failures_max, surrogate,
                                                ahead, threads (of the search itself), aspire (objectives are
                                                f1, f2, ...: "search.aspire=f1 0.5,f2 3") */
} imtet_search_options;

/* A new search; *out is NULL where it fails. */
IMTET_API imtet_status imtet_search_create(const imtet_search_options *options, imtet_search **out, imtet_error *error);

/* Up to n designs that nobody has asked for: their ids (n), X (n, variables), and how many. *found is 0 where the
 * search is done, or waits for answers. Where new ones are to be chosen it takes some 10 ms to seconds. */
IMTET_API imtet_status imtet_search_ask(imtet_search *search, size_t n, long ids[], double X[], size_t *found,
                                        imtet_error *error);

/* What n designs are worth, in any order: F (n, objectives), G (n, constraints; NULL without constraints), failed (n):
 * NULL, or why it failed, and then its F and G are not read; failed NULL: all succeeded. An id is one that ask has
 * given. After a load it may also be one from before the save that has no answer yet, whether ask has given it again or
 * not; it is then not given again. The call is refused as a whole where an id is another one, stands there twice or was
 * told before, or where a number is not finite. */
IMTET_API imtet_status imtet_search_tell(imtet_search *search, size_t n, const long ids[], const double F[],
                                         const double G[], const char *const failed[], imtet_error *error);

typedef struct {
    size_t size; /* sizeof(imtet_search_state) */
    size_t variables, objectives, constraints;
    size_t told, failed;         /* designs */
    size_t under_way;            /* given by ask and not told */
    size_t ready;                /* chosen, and not given yet: ask has so many without another answer */
    size_t left;                 /* of search.max_evals, less what is told and under way */
    int done;                    /* 1: nothing more will be asked for */
    const char *why;             /* it is done, in words; empty */
    const char *senses;          /* as in its options, and */
    const double *lower, *upper; /* (variables), until it is freed */
} imtet_search_state;

/* How far it is. Looks whether the search is done, for which it may choose designs, as ask does. */
IMTET_API imtet_status imtet_search_look(imtet_search *search, imtet_search_state *state, imtet_error *error);

typedef enum { IMTET_FRONT, IMTET_TOLD } imtet_set;

/* Designs by ascending ids: those told that keep all constraints and are dominated by no other, or all that are told.
 * ids (max), X (max, variables), F (max, objectives; NAN where it failed), G (max, constraints), each NULL where it is
 * not wanted; *found: how many there are, of which the first `max` are written. */
IMTET_API imtet_status imtet_search_designs(imtet_search *search, imtet_set which, size_t max, long ids[], double X[],
                                            double F[], double G[], size_t *found, imtet_error *error);

/* All of it into a file, which is replaced when the new one is whole on the disk; the one before is kept as PATH.prev.
 * Whatever is under way is asked for again, with the same ids, by the search that loads it. On other BLAS kernels than
 * those it was saved with it goes on with other designs: error->text says so beside IMTET_OK. */
IMTET_API imtet_status imtet_search_save(imtet_search *search, const char *path, imtet_error *error);
IMTET_API imtet_status imtet_search_load(const char *path, imtet_search **out, imtet_error *error);

/* Frees it and makes the handle NULL, which every call knows. NULL is fine. */
IMTET_API void imtet_search_free(imtet_search **search);

#ifdef __cplusplus
}
#endif

#endif
