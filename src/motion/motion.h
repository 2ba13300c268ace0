/* motion/motion.h -- a ground acceleration history, linear between equidistant samples.
 *
 *   a(t) = accel[k] + (accel[k+1] - accel[k]) (t - t_k) / dt,   t_k = k dt,   k = 0..n-1,   duration (n-1) dt
 *
 * Life cycle  motion_load or motion_open (motion/motion_scale.h) -> motion_prepare -> ... -> motion_free
 *             (an empty Motion may be freed)
 * Ownership   accel, force and force_rows belong to the Motion
 * Units       SI; the unit of a file is converted once, here
 * Threads     read-only after motion_prepare */
#pragma once

#include "base/status.h"
#include "motion/options.h"

typedef struct {
    double *accel;      /* [m/s2] (n) */
    double *force;      /* [N] (n, n_force) on floors 1..n_force, linear between samples too; none after the last */
    int n_force;        /* 0: none */
    double *force_rows; /* (n_force_rows, 1 + n_force) as read, time [s] first, until motion_scale has placed them */
    size_t n_force_rows;
    size_t n;
    double dt_s;
    double scale,
        stretch;      /* what motion_prepare and motion_scale multiplied the record and its time by; 0: as recorded */
    char name[128];   /* as given by the user: a path or builtin:NAME */
    char format[32];  /* what the reader took it for: "csv", "at2", ..., "builtin" */
    char channel[64]; /* its name in the file; empty where it has none */
    char processed[320];  /* what was done to the samples of the file; empty: nothing */
    char warning[240];    /* what does not fit in the file; empty: nothing */
    int is_corrected;     /* by the agency, as the file says: its displacement means something */
    uint64_t file_hash;   /* FNV-1a of the file's bytes, or of the generated samples; 0: at rest */
    uint64_t forces_hash; /* the same of the forces; 0: there are none */
} Motion;

/* t -> stretch t; then scaled so that max |accel| = pga_g * 9.81 m/s2 (pga_g = 0: as recorded). */
Status motion_prepare(Motion *m, double pga_g, double stretch, Err *err);

double motion_peak(const Motion *m); /* [m/s2] */

static inline double motion_duration(const Motion *m) /* [s] */
{
    return (double)(m->n - 1) * m->dt_s;
}

/* [s] Until 99.5 % of int a^2 dt has passed, and three periods of a building, whose first is `period`. All of a motion
 * with forces on floors: they may come late, on a ground that is at rest. */
double motion_strong_part(const Motion *m, double period);

/* "peak 0.348 g", of a motion that was scaled or stretched "peak 0.3 g (0.348 g x 0.862, time x 3.1)". */
enum { MOTION_PEAK_TEXT_MAX = 96 };
void motion_peak_text(const Motion *m, char text[MOTION_PEAK_TEXT_MAX]);
void motion_free(Motion *m);
