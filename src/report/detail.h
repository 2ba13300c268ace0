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

enum { SPECTRUM_FREQUENCIES = 72, SPECTRUM_TIMES = 320 };

/* Amplitude of the floor's displacement by frequency and time (wavelet). */
typedef struct {
    double f[SPECTRUM_FREQUENCIES], t[SPECTRUM_TIMES];       /* [Hz] equidistant in their logarithm, [s] */
    double amplitude[SPECTRUM_FREQUENCIES * SPECTRUM_TIMES]; /* (f, t) [m] */
} Spectrogram;

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
    History history[2];    /* SCENE_IMPACT, SCENE_NO_CORE */
    Spectrogram *spectrum; /* (2) the same */
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

/* Morlet amplitude spectrum of a signal over time.
 *
 *   A(f, t) = |2 sum_k g_k u_k exp(-2 pi i f (t_k - t))| / sum_k g_k,   g_k = exp(-(t_k - t)^2 / (2 s^2)),
 *   s = WAVELET_CYCLES / (2 pi f),   |t_k - t| <= 4 s
 *
 * Morlet's wavelet, scaled so that a steady swing of amplitude a at frequency f shows as a. Before its first and after
 * its last sample the signal is taken as zero. Threads  no state */
static const double WAVELET_CYCLES = 6;

/* u (n) every dt [s]; f (n_f) [Hz] below 1/(2 dt); t (n_t) [s]; amplitude (n_f, n_t) in the unit of u. */
void wavelet(size_t n, double dt, const double u[], size_t n_f, const double f[], size_t n_t, const double t[],
             double amplitude[]);
