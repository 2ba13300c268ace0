/* moga/constants.h -- every tuned constant of the search, one a line.
 *
 * docs/measured/constants.csv has their sources and what turning each off costs. What follows from a definition or
 * guards against overflow stands where it is used. */
#pragma once

/* -- generation.c: initial sample ---------------------------------------------------------------------------------- */

enum { INITIAL_PER_VARIABLE = 4 }; /* size of the initial sample: this n_var + offset, half of the budget at most */
enum { INITIAL_OFFSET = 12 };      /* ... */

/* -- common.h: look-ahead: questions whose answers are not known yet when the next ones are made ------------------- */

enum { AHEAD = 5 };        /* for each objective, at least: so many directions are searched side by side */
enum { AHEAD_FEW = 3 };    /* ... of noisy designs or of several parts; in all with whole numbers or choices */
enum { AHEAD_SHARE = 24 }; /* questions / this, where that is more */

/* -- state.c: reference vectors of infill ------------------------------------------------------------------------- */

enum { VECTORS = 200 }; /* or the population, where that is more */

/* -- offspring.c --------------------------------------------------------------------------------------------------- */

enum { INNER_GENERATIONS = 10 };       /* of variation and selection on the surrogate between two batches */
enum { DESCENTS_PER_DESIGN = 2 };      /* descents on the surrogate for each design of a batch */
enum { SWAPS = 12 };                   /* designs beside each descent, of problems with choices or whole numbers */
static const double PROBE_SHARE = 0.3; /* of a batch, for probes, times the share of objectives with waves */

/* -- surrogate.c: descents, Rprop in the unit cube ----------------------------------------------------------------- */

enum { DESCENT_STEPS = 20 };                   /* steps of a descent */
static const double DESCENT_STEP_FIRST = 0.02; /* first step in each variable; the longest is ten times as long */
static const double SUCCESS_POWER = 2.0;       /* of the predicted success in the weight of a gain */
static const double SUCCESS_MIN = 0.5;         /* predicted success below which a failure is predicted */
static const double PENALTY = 10.0;            /* weight of violated limits, in their ranges, and of failures */

/* -- surrogate.c: fit ---------------------------------------------------------------------------------------------- */

static const double R2_MIN = 0.3;  /* mean leave-one-out R2 of the objectives below which no surrogate is used */
enum { RETUNE_SHARE = 10 };        /* tuned again when n has grown by n / this; by twice that beyond surrogate_max */
enum { SPREAD_CENTRES_SHARE = 4 }; /* beyond surrogate_max: centres / this are spread over all evaluations */

/* -- infill.c: criteria -------------------------------------------------------------------------------------------- */

static const double PBI_THETA = 5.0;     /* weight of the distance from the vector */
static const double RAY_START = 1.1;     /* reference point of the hypervolume scalarisation, in widths of the front */
static const double RAY_SOFTNESS = 0.05; /* of the soft maximum in a ray's derivative, in widths of the front */

/* -- offspring.c: infill selection --------------------------------------------------------------------------------- */

static const double CREDIT_WEIGHT = 0.1; /* of one step in the running means of what criteria gain */
static const double OPTIMISM = 1.0;      /* errors by which a prediction is lowered where its gain is measured */

/* -- screening.c --------------------------------------------------------------------------------------------------- */

enum { SCREENED_PER_FINISHED = 5 }; /* designs screened for each that is finished */
enum { LEVEL_PAIRS = 8 };           /* finished first: with fewer the cheap level stands for the whole evaluation */
static const double LEVEL_TAU_MIN = 0.5; /* mean of Kendall's tau between the levels below which nothing is screened */

/* -- replication.c: replication of noisy designs ------------------------------------------------------------------- */

enum { REPLICATE_AFTER = 18 };               /* evaluations per variable before the first replicate */
static const double NOISE_NEGLIGIBLE = 1e-3; /* standard deviation, in ranges of the front, that ends replication */
enum { NOISE_SAMPLE = 8 };                   /* replicates before it may end */
