/* sim/fast/kernel.h -- the work space of the fast engine, and its kernel compiled once per instruction set. */
#ifndef IMTET_SIM_FAST_KERNEL_H
#define IMTET_SIM_FAST_KERNEL_H

#include "sim/fast/fast.h"
#include "sim/fast/vec.h"
#include "sim/flow.h"

/* The vectors below are storage only to fast.c: each kernel reads them in its own width, and every array is padded to
 * the widest. */
enum {
    PAD = 8,
    LEVEL_MAX = 24, /* the shortest step is 2^-24 of a sampling interval */
    FLOORS_PAD_MAX = FLOORS_MAX,
    MODES_PAD_MAX = 2 * FLOORS_MAX
};

/* Responses of w (and w') at the end of a step to unit forces: (n, n_pad) each. */
enum { RAMP_W, BUBBLE_W, RAMP_V, BUBBLE_V, RESPONSES };

typedef struct {
    double h;         /* [s] */
    double speed_max; /* [m/s] fine enough for contacts up to here */
    int has_flow, has_response;
    vec *coef;        /* (FLOW_ROWS, m_pad) */
    vec *slow;        /* (m_pad) 1: the Hermite cubic follows this mode, 0: it does not */
    vec *kappa;       /* (m_pad) error of the cubic, or 1, per unit of amplitude */
    vec *kappa_accel; /* (m_pad) the same for -2 zeta w q' - w^2 q */
    vec *cubic;       /* (m_pad) what the cubic misses of w on any floor, per unit of a mode's amplitude */
    vec *parabola, *parabola_accel; /* (m_pad) what the parabola misses of the mode, of its acceleration */
    double *response;               /* (RESPONSES, n, n_pad) */
    v4 *reply; /* (n, n) of floor i to floor j: d (w1_i, w1_i') / d (F, M) of j, its force at the end and mean force */
} Level;

typedef struct FastWork {
    void *store;
    const SimModel *model;
    int n, n_pad, nb_pad, m_pad; /* building modes first, padded apart: core modes start at nb_pad */
    int nc;                      /* core modes that are kept */
    int nf, mf, bf;              /* n_pad, m_pad, nb_pad in vectors of LANES */
    double base;                 /* [s] the interval that the levels divide */
    Level level[LEVEL_MAX + 1];

    /* modes */
    vec *omega, *zeta, *gamma, *wd_inverse, *decay, *flex, *q, *v, *load, *work, *ground; /* (m_pad) */
    vec *drift; /* (m_pad) how far the equation of motion was missed, summed over the steps */
    vec *work1, *ground1, *drift1;
    vec *most, *most_drift; /* (m_pad) largest |R| of a mode over the floors, over the storeys */
    vec *q1, *v1, *amplitude, *qa, *va, *qb, *vb, *za, *ja, *zb, *jb, *bound, *bound_a; /* (m_pad) */
    double *R, *R_abs, *D_abs; /* (m_pad, n_pad) of the floors, of their distances from the floor below */
    double *RT;                /* (n_pad, m_pad) */

    /* floors */
    vec *w, *wd, *w1, *wd1, *f0, *f1, *fb, *gap; /* (n_pad) */
    vec *c0, *c0d, *c1, *c1d;                    /* (n_pad) the core's part of w in flight */
    vec *u0, *u0d, *u1, *u1d, *a0, *a0d, *a1, *a1d, *e_u, *e_w, *e_a, *reach_a; /* (n_pad) */
    vec *peak_u, *peak_d, *peak_a;                                              /* (n_pad); padding is out of reach */
    vec *seen[3][3]; /* [start, middle, end of a contact step][u, drift, accel] (n_pad) */
    int rises[3];    /* [u, drift, accel] may this contact step raise a peak? */
    int landed;      /* 0: in flight, w, w' and what is seen are not current */
    double v0[FLOORS_PAD_MAX];
    int side[FLOORS_PAD_MAX];  /* 0 open, +1 or -1 touching */
    uint64_t floors, touching; /* bit j: floor j is one, touches */
    int flight_level;          /* where the next flight is tried */
    int may_glide;             /* all modes swing: below critical damping, with a frequency */
    long glide_from;           /* the interval from which a glide is tried ... */
    long glide_wish;           /* ... and over how many */
    int touch_level;           /* where the next contact step is tried */
    int may_grow;              /* the last contact step could have been twice as long */
    double energy_scale;       /* [J] */
    double speed;              /* [m/s] largest |w'| */
    double shortest_at_1;      /* [s] shortest Hertz contact of any floor at 1 m/s */
    const FastKnobs *knobs;

    const EngineOptions *options;

    double now; /* [s] start of the step under way */

    /* books */
    double contact_lost, contact_clamped, deepest;
    long impacts, floored, steps, flights, forces;
} FastWork;

typedef void FastKernel(FastWork *k, const SimModel *model, const Motion *motion, const EngineOptions *options,
                        const FastKnobs *knobs, SimResult *result);

FastKernel fast_kernel_base, fast_kernel_avx2, fast_kernel_avx512;

#endif
