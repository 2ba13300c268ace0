/* imtet.h -- the search for a Pareto front by few evaluations, as a library: ask for designs, tell their objectives.
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
 *            which objectives are maximised. Whole numbers and choices are numbers too: choice:a|b is 0 or 1
 * Look-ahead the id of a design alone decides which answers it is chosen from: all but the last ones before it
 *            (search.ahead), which may be under way. So several designs can be asked for at once: five or more for
 *            each objective, three with noise, three in all with int or choice, fewer of a small budget; fewer than n,
 *            or none, are given where the search must know more answers first. A design that is never told holds the
 *            search up: tell that it failed. Ids are 1, 2, ... in the order of asking
 * Repeatable the same options and answers give the same designs, to the last bit, and those of `imtet optimize` with
 *            the same settings. Portions, order of telling, saving and loading, and the number of threads change
 *            nothing. Processors of different kinds need OPENBLAS_CORETYPE=Haswell in the environment, as the program
 *            sets it; without it a search that is loaded on another kind continues with other designs
 * Failures   a design that failed is told with a reason in words. The search avoids designs like it. When
 *            search.failures_max designs in a row have failed, ask says so once, and continues when it is called again.
 *            If no design has succeeded at the end, asking for the front gives IMTET_INTERNAL and the commonest reason
 * Ownership  a search belongs to the caller, who frees it. Inputs are copied; outputs are written into the caller's
 *            arrays
 * Threads    any: calls on one search exclude each other, searches are independent. Between two calls no thread of the
 *            library runs. A search does not survive fork: a child loads a saved one. While designs are chosen, or a
 *            scene is opened, the OpenBLAS of this process uses one thread
 * Errors     every function that can fail returns an imtet_status and writes a sentence into *error (NULL: not wanted):
 *            what, where, what to do. State is unchanged. A NULL handle, as free leaves it, is an error too. On success
 *            the sentence is empty, except for a note of imtet_search_load */
#ifndef IMTET_H
#define IMTET_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Semantic versioning: functions and fields stay within a major version; below 1, within a minor version. */
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

/* The version of the library that is linked: IMTET_VERSION of its own header. */
IMTET_API const char *imtet_version(void);

typedef struct imtet_search imtet_search;

typedef struct {
    size_t size;                  /* sizeof(imtet_search_options), so that later versions may add fields */
    size_t variables, objectives; /* 1 at least */
    size_t constraints;           /* G <= 0; 100 at most */
    const double *lower, *upper;  /* (variables) finite; NULL: 0 and 1 */
    const char *kinds;            /* real, log, int, list:4|5|8 or choice:WORD|WORD, one for all or a comma
                                                list; NULL: real */
    const char *senses;           /* min or max, one for all objectives or a comma list; NULL: min */
    size_t starts;                /* number of initial designs, */
    const double *start;          /* (starts, variables), moved into the box */
    const char *const *settings;  /* "search.KEY=VALUE" as `imtet settings` lists them, NULL behind the last;
                                                NULL: none. search.max_evals, seed, population, initial,
                                                max_hours, stop_after, failures_max, surrogate,
                                                ahead, threads (of the search itself), aspire (objectives are
                                                f1, f2, ...: "search.aspire=f1 0.5,f2 3") */
} imtet_search_options;

/* A new search; *out is NULL where it fails. */
IMTET_API imtet_status imtet_search_create(const imtet_search_options *options, imtet_search **out, imtet_error *error);

/* Gives up to n new designs: ids (n), X (n, variables), and their number. *found is 0 where the search is done, or
 * waits for answers. A call that chooses new designs takes some 10 ms to seconds. */
IMTET_API imtet_status imtet_search_ask(imtet_search *search, size_t n, long ids[], double X[], size_t *found,
                                        imtet_error *error);

/* Tells the results of n designs, in any order: F (n, objectives), G (n, constraints; NULL without constraints),
 * failed (n): NULL, or why the design failed, and then its F and G are not read; failed NULL: all succeeded. Ids are
 * those of ask. After a load they may also be ids from before the save without an answer; ask does not give these
 * again. The whole call is refused where an id is unknown, appears twice or was told before, or where a number is not
 * finite. */
IMTET_API imtet_status imtet_search_tell(imtet_search *search, size_t n, const long ids[], const double F[],
                                         const double G[], const char *const failed[], imtet_error *error);

typedef struct {
    size_t size; /* sizeof(imtet_search_state) */
    size_t variables, objectives, constraints;
    size_t told, failed;         /* designs */
    size_t under_way;            /* given by ask and not told */
    size_t ready;                /* ask has so many designs without another answer */
    size_t left;                 /* search.max_evals less told and under_way */
    int done;                    /* 1: the search asks for nothing more */
    const char *why;             /* why it is done, in words; else empty */
    const char *senses;          /* as in the options; this and the next two are valid until the search is freed */
    const double *lower, *upper; /* (variables) */
} imtet_search_state;

/* Reports progress. To find out whether the search is done it may choose designs, as ask does. */
IMTET_API imtet_status imtet_search_look(imtet_search *search, imtet_search_state *state, imtet_error *error);

typedef enum { IMTET_FRONT, IMTET_TOLD } imtet_set;

/* Gives designs by ascending ids: the told feasible ones that no other dominates, or all that are told.
 * ids (max), X (max, variables), F (max, objectives; NAN where a design failed), G (max, constraints), each NULL where
 * it is not wanted; *found: how many there are, of which the first `max` are written. */
IMTET_API imtet_status imtet_search_designs(imtet_search *search, imtet_set which, size_t max, long ids[], double X[],
                                            double F[], double G[], size_t *found, imtet_error *error);

/* Saves the search to a file, which is replaced when the new one is whole on the disk; the save before is kept as
 * PATH.prev. A loaded search asks for the designs under way again, with the same ids. On other BLAS kernels than those
 * it was saved with, it continues with other designs: error->text says so beside IMTET_OK. */
IMTET_API imtet_status imtet_search_save(imtet_search *search, const char *path, imtet_error *error);
IMTET_API imtet_status imtet_search_load(const char *path, imtet_search **out, imtet_error *error);

/* Frees the search and sets the handle to NULL, which every call refuses. A NULL handle is fine here. */
IMTET_API void imtet_search_free(imtet_search **search);

#ifdef __cplusplus
}
#endif

#endif
