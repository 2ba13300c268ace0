/* run/refine.h -- a design of a run polished, honestly: is the gain more than the spread?
 *
 *   1 surface and simulator in turn: the best that a response surface of the nearest simulations knows within a trust
 *     region is simulated (means over `members`) and joins the surface; half of the designs at most
 *   2 NLopt on the simulator, from the best so far
 *   3 design and result once more with members that neither has seen: gain and its standard error,
 *         error^2 = (spread_start^2 + spread_end^2) / members
 *     A gain counts where it is more than twice that; with a single member nothing is known of the spread.
 *
 * The other kept objectives may get worse by one spread of a single simulation, or by `slack`.
 *
 * Ownership  refine_design fills x, f, ... of the caller's Refined; refined_free releases what it allocated
 * Threads    call it from one thread; members share the subject's threads */
#ifndef IMTET_RUN_REFINE_H
#define IMTET_RUN_REFINE_H

#include "run/store.h"

typedef struct {
    const char *algorithm; /* polish/polish.h */
    size_t improve;
    const unsigned char *keep; /* (n_obj) */
    double slack;              /* share of the value; < 0: one spread */
    long members;              /* of a tower; others are asked once */
    size_t max_evals;          /* designs tried on the simulator, those all steps together */
    double max_seconds;        /* 0: no limit */
    int (*go_on)(void *user);  /* asked before each simulation, NULL: yes; 0: STATUS_STOPPED and nothing is refined */
    void *user;
} RefineConfig;

typedef struct {
    double *x, *f_start, *f, *spread_start, *spread; /* (n_var), (n_obj) natural; of step 3 */
    double gain, gain_error;               /* in the improved objective, > 0 is better; error NAN: not known */
    double foreseen;                       /* gain that the surface promised; NAN: no surface */
    double violation;                      /* of the user's limits */
    size_t n_evaluated, n_failed, n_tried; /* in all; of them failed; proposed by the surface */
    double seconds;
    int has_changed; /* 0: nothing better was found, x is the design itself */
} Refined;

/* The design in row `row` of the run, with the settings that it was made with. */
Status refine_design(const Saved *h, size_t row, const RefineConfig *config, Refined *out, Err *err);
void refined_free(Refined *r);

/* Gain beyond doubt, or no spread known and any gain. */
int refined_counts(const Refined *r);

/* As a run stores it; borrows x, f and spread. */
StoredDesign refined_design(const Refined *r);

/* Stored beside the designs of the search, as `polished`; the id that it got. Nobody may be working on the run. */
Status refined_store(const char *folder, const Refined *r, long *id, Err *err);

/* Spread-out designs of the front, the knee first, then the farthest from those chosen: rows of h, at most n; returns
 * how many. improve (NULL: not wanted): the objective in which each is best compared with the front; polished designs
 * are then left out. */
size_t refine_choose(const Saved *h, size_t n, size_t rows[], size_t improve[]);

#endif
