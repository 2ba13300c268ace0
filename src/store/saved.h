/* store/saved.h -- a run as its database tells it: settings, every evaluation, the front, how it came about.
 *
 * For reading only, also while the run goes on. Rows are in the order of their ids: designs of the search are numbered
 * 1, 2, ... as they were asked for, polished ones from POLISHED_FIRST on. A simulation of a generation that is still
 * under way (or was cut short) has kind KIND_UNFINISHED; it is on no front yet.
 *
 * Repeats    a design that was simulated again has the mean of its answers in F (store/repeats.h)
 * Values     natural signs and units, as in front.csv; NAN where there is none (failed, or spread not known)
 * Front      feasible, ok, and nobody dominates it, polished designs included; `entered` and `left` tell of the search
 *            alone in which generations a design was on its front: entered <= g < left
 * Ownership  saved_read allocates, saved_free releases (an empty Saved is fine)
 * Errors     no database there: STATUS_MISSING; damaged: STATUS_IO */
#ifndef IMTET_STORE_SAVED_H
#define IMTET_STORE_SAVED_H

#include "moga/search.h"
#include "store/database.h"
#include "simulator/schema.h"
#include "settings/settings.h"

enum { POLISHED_FIRST = 1000001, NEVER = -1 };

typedef struct {
    long id, generation, entered, left; /* NEVER */
    EvaluationKind kind;
    int ok, on_front;
    long members;     /* simulations behind F; 0: a repeat, or not known */
    double violation; /* of the user's limits */
    Verdict verdict;
} SavedRow;

typedef struct {
    long number, simulated, failed, front, predicted;
    double surrogate_error; /* NAN: no surface */
    double hypervolume;     /* share of a box about the first sample that the front dominates; results/README.md */
    double seconds;         /* of work on the run until then, all sessions together */
    char finished[24];      /* UTC */
} SavedGeneration;

/* One start of `imtet optimize`. */
typedef struct {
    char started[24], ended[24], host[72], stopped[128]; /* ended, stopped: empty while it runs or when it was killed */
    long pid, threads, simulated_before;
    double seconds;                         /* that it lasted, as far as it told */
    double search_s, waited_s, surrogate_s; /* of the search; of it waiting for simulations, at the surrogate; NAN */
    int is_final;                           /* there was nothing more to do */
} SavedSession;

typedef struct {
    char *provenance; /* JSON */
    Settings settings;
    Schema schema;
    size_t n, n_front, n_failed, n_repeats, n_generations, n_sessions;
    SavedRow *row;               /* (n) */
    double *X, *F, *spread;      /* (n, n_var) (n, n_obj) (n, n_obj) */
    double *answer;              /* (n, n_obj) of this very simulation */
    SavedGeneration *generation; /* (n_generations) */
    SavedSession *session;       /* (n_sessions) */
    long planned_evals;
    long tried_to_polish; /* spread-out designs, at the end of a search of polished_at simulations */
    long polished_at;
    void *state; /* (n_state bytes) of the search at the end of the last generation; NULL: none is finished yet */
    size_t n_state;
} Saved;

/* The database of a run's folder; 1 where there is one. */
int saved_path(const char *folder, char path[], size_t size);

Status saved_read(Saved *h, const char *folder, Err *err);
Status saved_load(Saved *h, Database *d, Err *err);

/* The evaluations first..last into a Saved that has a schema and no rows yet. */
Status saved_load_rows(Saved *h, Database *d, long first, long last, Err *err);
void saved_free(Saved *h);

/* As if nothing had been polished: the front is that of the search. */
void saved_drop_polished(Saved *h);

/* Row of that design, or h->n. */
size_t saved_find(const Saved *h, long id);

#endif
