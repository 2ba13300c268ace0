/* report/detail.h -- one design of the tower looked at closely: simulated again as the run did it, beside its baselines
 * (analysis/baselines.h), then on other earthquakes.
 *
 * Ownership  detail_make allocates, detail_free releases (a zeroed Detail is fine) */
#pragma once

#include "report/history.h"
#include "analysis/baselines.h"
#include "analysis/ladder.h"
#include "study/record_paths.h"

typedef struct Settings Settings;

typedef struct {
    char record[128];
    double pga_g, scale, stretch;
    SimResult with_core, no_core;
} Elsewhere;

typedef struct {
    const struct Run *run; /* as in DetailOptions */
    size_t row;
    int n_floors, floor;         /* floor from 0: whose displacement is followed */
    double storey_m[FLOORS_MAX]; /* heights */
    double gap_m[FLOORS_MAX], thickness_m[FLOORS_MAX], bumper_n_m[FLOORS_MAX]; /* the last 0: steel on steel */
    GapSides gap_sides;
    char protection[PROTECTION_MAX];
    double gap_side_m[SIDES][FLOORS_MAX]; /* right, left; INFINITY: nothing there; gap_m: the smaller */
    double building_hz[FLOORS_MAX], core_hz[FLOORS_MAX];
    char record[128];
    double pga_g, scale, stretch, duration_s;
    SimResult result[N_SCENES];  /* by SceneKind, under the first record */
    double error[N_MEASURES];    /* of the design, bound or sd, the larger (analysis/estimate.h); NAN: not known */
    Baseline baseline[N_SCENES]; /* under all records of the run, by its rule */
    size_t n_records;            /* of the run */
    SimResult *by_record;        /* (n_records) the design under each of them; NULL: there is one */
    double standard_error[N_MEASURES]; /* of what those are by its rule (evaluate/replicates.h); NAN: there is one */
    Ladder *ladder;                    /* of the design; NULL: not asked for, or `no_ladder` says why there is none */
    Err no_ladder;
    char *verdict; /* report/verdict.h; NULL: not asked for, or not to be had */
    /* until the floor's displacement stays below 2 % of its peak */
    Track history[2]; /* SCENE_IMPACT, SCENE_NO_CORE */
    size_t n_elsewhere;
    Elsewhere *elsewhere; /* (n_elsewhere) */
} Detail;

/* Other earthquakes: `other` is how they are read, scaled and simulated, its motion.record replaced by each name. */
typedef struct {
    RecordPaths moved;     /* where the run's own records are now */
    int with_ladder;       /* of the engine fast: which effects the design needs, and the verdict */
    const struct Run *run; /* whose row it is */
    size_t row;
    int without_devices; /* only no core and rigidly connected beside it: no parameters are searched for */
    const Settings *other;
    size_t n_records;
    const char *const *records;
} DetailOptions;

/* s: settings of the run; x (n_var) the design. */
Status detail_make(const Settings *s, int n_var, const double x[], const DetailOptions *options, Detail *out, Err *err);
void detail_free(Detail *d);
